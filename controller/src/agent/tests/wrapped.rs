//! Tests that wrappers forward all functions of [`Teamwork`] to the law inside.

use super::*;
use crate::flock::boids::BoidsParams;
use crate::land::{LandPatch, PATCH_TILES};
use crate::parameters::Parameters;

#[derive(Default)]
struct Listener {
    redirected: bool,
    stopped: Option<bool>,
    assigned: Option<(u8, bool)>,
    land: usize,
}

impl Teamwork for Listener {
    fn redirect(&mut self) {
        self.redirected = true;
    }

    fn note_stop(&mut self, is_asked: bool) {
        self.stopped = Some(is_asked);
    }

    fn assign_template(&mut self, part: &TemplateAssignment, is_restarted: bool) -> bool {
        self.assigned = Some((part.slot, is_restarted));
        true
    }

    fn hear_land(&mut self, _: &LandPatch) {
        self.land += 1;
    }

    fn say_land(&mut self, _: Instant) -> Option<LandPatch> {
        Some(LandPatch::from_bytes(Cell::new(8, 8), [0; PATCH_TILES]))
    }

    fn goal_offset(&self) -> Cell {
        Cell::new(7, 8)
    }

    fn needs(&self, id: RobotId) -> bool {
        id == RobotId(9)
    }
}

fn passes_orders_on<L: Teamwork>(law: &mut L, inside: impl Fn(&L) -> &Listener) {
    law.redirect();
    assert!(inside(law).redirected);
    for asked in [true, false] {
        law.note_stop(asked);
        assert_eq!(inside(law).stopped, Some(asked));
    }
    let (to, offset, entries) = (RobotId(1), Cell::default(), heapless::Vec::new());
    let part = TemplateAssignment { to, version: 1, part: 0, parts: 1, slot: 3, offset, entries };
    assert!(law.assign_template(&part, true));
    assert_eq!(inside(law).assigned, Some((3, true)));
    assert_eq!((law.goal_offset(), law.needs(RobotId(9)), law.needs(RobotId(1))), (Cell::new(7, 8), true, false));
}

fn passes_land_on<L: Teamwork>(law: &mut L, inside: impl Fn(&L) -> &Listener) {
    law.hear_land(&LandPatch::from_bytes(Cell::new(0, 0), [0; PATCH_TILES]));
    assert_eq!(inside(law).land, 1);
    assert_eq!(law.say_land(tick(0)).map(|patch| patch.corner), Some(Cell::new(8, 8)));
}

#[test]
fn the_operator_wrapper_forwards_all() {
    let mut law = Commanded::new(Listener::default(), 1.0_f32, 0.1);
    passes_orders_on(&mut law, Commanded::inside);
    passes_land_on(&mut law, Commanded::inside);
}

#[test]
fn the_wrapper_for_any_surroundings_forwards_all() {
    let mut law = AnyWorld(Listener::default());
    passes_orders_on(&mut law, |law| &law.0);
    passes_land_on(&mut law, |law| &law.0);
}

#[test]
fn the_map_wrapper_forwards_all_but_map_patches() {
    let mut law = MapSharing::<_, 0>::new(Listener::default(), None);
    passes_orders_on(&mut law, MapSharing::inside);
    law.hear_land(&LandPatch::from_bytes(Cell::new(0, 0), [0; PATCH_TILES]));
    assert_eq!((law.inside().land, law.say_land(tick(0))), (0, None));
}

#[test]
fn the_tracking_wrapper_forwards_all() {
    let mut law = NeighborTracking::<f32, _>::new(Listener::default(), None);
    passes_orders_on(&mut law, NeighborTracking::inside);
    passes_land_on(&mut law, NeighborTracking::inside);
}

/// A law of which all answers are the same.
#[derive(Clone, Copy)]
struct Answers(bool);

impl Teamwork for Answers {}

impl Guidance<f32> for Answers {
    type Input<'a> = InPlane<'a, f32>;
    type Destination = Roams;
    type Workspace = ();
    type Payload = ();

    fn decide(
        &mut self,
        _: &GuidanceInput<'_, f32>,
        _: &InPlane<'_, f32>,
        _: &mut Rng,
        (): &mut (),
    ) -> Result<Decision<f32>, BadInput> {
        Err(BadInput)
    }

    fn goes_to_cells(&self) -> bool {
        self.0
    }

    fn goes_by_velocity(&self) -> bool {
        self.0
    }

    fn has_own_goal(&self) -> bool {
        self.0
    }

    fn assign_waypoint(&mut self, _: u8, _: &Waypoint<f32>) -> bool {
        self.0
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        if self.0 {
            visit(&mut BoidsParams::paper(1.0_f32));
        }
    }
}

fn passes_answers_on<L: Guidance<f32>>(mut law: L, answer: bool) {
    assert_eq!([law.goes_to_cells(), law.goes_by_velocity(), law.has_own_goal()], [answer; 3]);
    assert_eq!(law.assign_waypoint(0, &super::plane::place(0, 0)), answer);
    let mut is_visited = false;
    law.parameters(&mut |table| is_visited |= table.index("crowded_m").is_some());
    assert_eq!(is_visited, answer);
}

#[test]
fn wrappers_forward_the_answers_of_the_law() {
    for answer in [true, false] {
        passes_answers_on(AnyWorld(Answers(answer)), answer);
        passes_answers_on(MapSharing::<_, 0>::new(Answers(answer), None), answer);
        passes_answers_on(NeighborTracking::<f32, _>::new(Answers(answer), None), answer);
        passes_answers_on(Commanded::new(Answers(answer), 1.0_f32, 0.1), answer);
    }
}

#[test]
fn a_law_without_teamwork_accepts_no_template() {
    let (to, offset, entries) = (RobotId(1), Cell::default(), heapless::Vec::new());
    let part = TemplateAssignment { to, version: 1, part: 0, parts: 1, slot: 3, offset, entries };
    assert!(!Answers(true).assign_template(&part, false));
    assert_eq!((Answers(true).goal_offset(), Answers(true).needs(RobotId(9))), (Cell::default(), false));
}
