use crate::grid::{self, Formation, GridAgent, ROBOTS, Route, Scene, TICK, Walker};
use crate::land::Land;
use crate::medium::{Faults, INBOX, Medium};
use crate::{Probe, Summary};
use heapless::Vec;
use serde::Serialize;
use staya_controller::agent::{
    AgentConfig, CELLS, Grid, GridMessage, GridOrder, GridWorkspace, Law, OnGrid, Protocol as _, TemplatePart,
    Unguarded,
};
use staya_controller::formation::{FormationParams, Prediction};
use staya_controller::grid::Cell;
use staya_controller::robot::RobotId;
use staya_controller::route::RouteParams;
use staya_controller::scalar::Scalar;
use staya_controller::template::Template;
use staya_controller::wire::{Addressed, Content as _, Header, Message, Postcard, Wire};

const LAND: Land = Land { size: 28, roughness_log2: 2, walls: &[(9, 7, 12), (18, 14, 19)] };
const OPERATOR: RobotId = RobotId(200);
const PLACES: [Cell; ROBOTS] = [Cell::new(0, 0), Cell::new(-3, 0), Cell::new(0, -3), Cell::new(-3, -3)];
const EDGES: [(u16, u16); 4] = [(0, 1), (0, 2), (1, 3), (2, 3)];
const START: Cell = Cell::new(5, 5);
const GOAL: Cell = Cell::new(24, 21);

fn config<S: Scalar>(index: usize) -> AgentConfig<S> {
    AgentConfig { seed: 7, ..AgentConfig::new(RobotId(index as u32 + 1), S::ZERO, TICK) }
}

#[inline(never)]
pub(super) fn route<S: Scalar, P: Probe<S>>(probe: &mut P) -> Summary {
    let scene = Scene { land: LAND, faults: Faults::default(), ticks: 300 };
    let mut walkers = Vec::new();
    add_travellers(&mut walkers);
    run(&scene, &mut walkers, Postcard, |_, _| {}, probe)
}

/// Runs robots that search windows. An operator has the last seat at the medium.
#[inline(never)]
fn run<S: Scalar, G, W: Wire, P: Probe<S>>(
    scene: &Scene,
    walkers: &mut Vec<Walker<S, G, W>, ROBOTS>,
    wire: W,
    commander: impl FnMut(u32, &mut Vec<u8, INBOX>),
    probe: &mut P,
) -> Summary
where
    G: for<'a> Law<S, Surroundings<'a> = OnGrid<'a>, Workspace = GridWorkspace<CELLS>>,
    GridAgent<S, G, W>: Serialize,
{
    let mut medium = Medium::<W, { ROBOTS + 1 }>::new(wire, scene.faults);
    let mut workspace = grid::workspace();
    grid::run(scene, walkers, &mut medium, &mut workspace, commander, probe)
}

/// Fills the caller's vector because a small part has no memory for two.
#[inline(never)]
fn add_travellers<S: Scalar>(walkers: &mut Vec<Walker<S, Route>, ROBOTS>) {
    let corners = [(4, 4), (23, 4), (4, 23), (23, 23)].map(|(x, y)| Cell::new(x, y));
    for (index, (cell, goal)) in corners.into_iter().zip(corners.into_iter().rev()).enumerate() {
        let guidance = Route::new(RouteParams::default());
        let mut agent = GridAgent::new(&config(index), guidance, Unguarded, Postcard);
        agent.order(&GridOrder::Goal(goal));
        let _ = walkers.push(Walker { agent, cell, free_at_ms: 0 });
    }
}

#[inline(never)]
pub(super) fn formation<S: Scalar, P: Probe<S>>(probe: &mut P) -> Summary {
    in_formation(Prediction::Constant, probe)
}

#[inline(never)]
pub(super) fn reflexive<S: Scalar, P: Probe<S>>(probe: &mut P) -> Summary {
    in_formation(Prediction::Reflexive, probe)
}

fn template(index: usize) -> Template<ROBOTS> {
    // A test shows that the robots keep their places.
    Template::from_graph(&PLACES, &EDGES, index, 2).unwrap_or_default()
}

#[inline(never)]
fn add_members<S: Scalar, W: Wire>(
    walkers: &mut Vec<Walker<S, Formation, W>, ROBOTS>,
    params: FormationParams,
    wire: &W,
    template: impl Fn(usize) -> Template<ROBOTS>,
) {
    for (index, place) in PLACES.into_iter().enumerate() {
        let guidance = Formation::new(RouteParams::default(), params, template(index));
        let _ = walkers.push(Walker {
            agent: GridAgent::new(&config(index), guidance, Unguarded, wire.clone()),
            cell: START + place,
            free_at_ms: 0,
        });
    }
}

fn in_formation<S: Scalar, P: Probe<S>>(prediction: Prediction, probe: &mut P) -> Summary {
    let params = FormationParams { prediction, ..FormationParams::default() };
    let mut walkers = Vec::new();
    add_members(&mut walkers, params, &Postcard, template);
    for (walker, place) in walkers.iter_mut().zip(PLACES) {
        walker.agent.order(&GridOrder::Goal(GOAL + place));
    }
    let scene = Scene { land: LAND, faults: Faults::default(), ticks: 300 };
    run(&scene, &mut walkers, Postcard, |_, _| {}, probe)
}

#[inline(never)]
pub(crate) fn packets<S: Scalar, W: Wire, P: Probe<S>>(wire: W, probe: &mut P) -> Summary {
    let scene = Scene {
        land: LAND,
        faults: Faults { seed: 5, loss: u32::MAX >> 3, flip: u32::MAX >> 4, twice: u32::MAX >> 3, fade: 0 },
        ticks: 400,
    };
    let mut walkers = Vec::new();
    add_members(&mut walkers, FormationParams::default(), &wire, |_| Template::default());
    let mut operator = Operator { wire: wire.clone(), sequence: 0 };
    run(&scene, &mut walkers, wire, |tick, out| operator.speak(tick, out), probe)
}

/// It repeats its orders, because it gets no acknowledgements.
struct Operator<W> {
    wire: W,
    sequence: u16,
}

impl<W: Wire> Operator<W> {
    /// Number of its only goal and of its only templates.
    const VERSION: u8 = 1;
    const STOP: core::ops::Range<u32> = 60..66;
    const RESUME: core::ops::Range<u32> = 80..90;

    fn speak(&mut self, tick: u32, out: &mut Vec<u8, INBOX>) {
        let index = (tick & 3) as usize;
        let to = RobotId(index as u32 + 1);
        let Template { slot, offset, entries } = template(index);
        if let Ok(parts) = TemplatePart::split(Self::VERSION, slot, offset, &entries) {
            // A tick has no room for both parts.
            let turn = (tick >> 2) as usize;
            for part in parts.filter(|part| usize::from(part.part) == turn & 1) {
                self.order(to, &GridOrder::Template { part, is_restarted: false }, out);
            }
        }
        self.order(RobotId::NONE, &GridOrder::FormationGoal(GOAL), out);
        if Self::STOP.contains(&tick) {
            self.send(1, &GridMessage::Stop { origin: OPERATOR, valid_ms: 30_000 }, out);
        }
        if Self::RESUME.contains(&tick) {
            self.send(2, &GridMessage::Resume { origin: OPERATOR }, out);
        }
    }

    fn order(&mut self, to: RobotId, order: &GridOrder, out: &mut Vec<u8, INBOX>) {
        if let Some(order) = Grid::order(to, Self::VERSION, order) {
            self.say(&order, out);
        }
    }

    /// Sends a message to the top leader.
    fn send(&mut self, number: u8, message: &GridMessage, out: &mut Vec<u8, INBOX>) {
        if let Some((protocol, content)) = message.encode(Grid::ID) {
            self.say(&Message::Law(Addressed { to: RobotId(1), number, protocol, content }), out);
        }
    }

    fn say(&mut self, message: &Message, out: &mut Vec<u8, INBOX>) {
        let header = Header { boot: 0, sender: OPERATOR, sequence: self.sequence };
        self.sequence = self.sequence.wrapping_add(1);
        let _ = self.wire.encode(header, message, out);
    }
}
