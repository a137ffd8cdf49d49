//! Tests that wrappers forward all functions of [`Teamwork`] to the law inside.

use super::*;
use crate::land::{LandPatch, PATCH_TILES};

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
