//! Robots that negotiate: a swarm, and one robot in the worst arrangement.

use crate::grid::{self, GridAgent, Scene, TICK, Walker};
use crate::hash::Hashes;
use crate::land::{Land, WINDOW};
use crate::medium::{Faults, Medium};
use crate::{Probe, Summary};
use heapless::Vec;
use staya_controller::agent::{
    Agent, AgentConfig, CELLS, CellState, GridOrder, GridWorkspace, Inputs, KinematicState, OnGrid, Outputs,
    Protocol as _, Unguarded,
};
use staya_controller::grid::{BLOCKED, Cell, Dir, Window};
use staya_controller::negotiation::{Manners, Negotiation, NegotiationGuidance, NegotiationPayload};
use staya_controller::negotiation::{Report, SIGHT, Said, Sight, Wish};
use staya_controller::rand::Rng;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::scalar::Scalar;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::{Beacon, Broadcast, Content as _, Header, Message, Postcard, encode};

type Guidance = NegotiationGuidance<16>;

const ROBOTS: usize = 8;
/// Two rooms and a corridor of three cells that is one robot wide.
const LAND: Land =
    Land { size: 13, roughness_log2: 1, walls: &[(5, 0, 5), (5, 7, 12), (6, 0, 5), (6, 7, 12), (7, 0, 5), (7, 7, 12)] };

/// Eight robots change rooms through the corridor, four from each side.
#[inline(never)]
pub(crate) fn swarm<S: Scalar, P: Probe<S>>(probe: &mut P) -> Summary {
    let scene = Scene { land: LAND, faults: Faults::default(), ticks: 400 };
    let mut walkers = Vec::new();
    add_robots(&mut walkers);
    let mut medium = Medium::<Postcard, ROBOTS, 800>::new(Postcard, scene.faults);
    grid::run(&scene, &mut walkers, &mut medium, &mut grid::workspace(), |_, _| {}, probe)
}

#[inline(never)]
fn add_robots<S: Scalar>(walkers: &mut Vec<Walker<S, Guidance, Postcard, ROBOTS>, ROBOTS>) {
    let west = [(1, 4), (3, 5), (3, 7), (1, 8)].map(|(x, y)| Cell::new(x, y));
    let pairs = west.into_iter().map(|cell| (cell, Cell::new(LAND.size - 1 - cell.x, cell.y)));
    let ends = pairs.flat_map(|(west, east)| [(west, east), (east, west)]);
    for (number, (cell, goal)) in (1..).zip(ends) {
        let config = AgentConfig { seed: 7, ..AgentConfig::new(RobotId(number), S::ZERO, TICK) };
        let mut agent = GridAgent::new(&config, Guidance::default(), Unguarded, Postcard);
        agent.order(&GridOrder::Goal(goal));
        let _ = walkers.push(Walker { agent, cell, free_at_ms: 0 });
    }
}

const STEPS: u32 = 64;
const PURPOSE: u32 = u32::from_be_bytes(*b"nego");
const OWN: RobotId = RobotId(5);
const OTHERS: u32 = 15;
/// The edge of the land that a robot remembers, cells from its own.
const EDGE: i16 = 31;
/// Beacons and reports of a step.
type Inbox = Vec<u8, 2048>;

/// Corridors from south to north that are connected alternately at their ends: the land with the
/// longest ways.
fn is_closed(cell: Cell) -> bool {
    let gap = if cell.x & 2 == 0 { EDGE - 1 } else { 1 - EDGE };
    cell.x & 1 == 1 && cell.y != gap || cell.y.abs() >= EDGE
}

/// An open cell at most so far from the middle.
fn open_cell(rng: &mut Rng, [columns, rows]: [u32; 2]) -> Cell {
    let mut about = |most: u32| rng.below(2 * most + 1) as i16 - most as i16;
    Cell::new(2 * about(columns), about(rows))
}

/// What 15 robots say in a step. Half of the beacons are lost, so that those of robots in other
/// cells are guessed. The reports tell all the land, as if their robots had come from far away.
fn hear(step: u32, inbox: &mut Inbox) {
    inbox.clear();
    for number in (1..).filter(|&number| number != OWN.0).take(OTHERS as usize) {
        let mut rng = Rng::keyed(2, PURPOSE, number, step);
        let mut sequence = step as u16 * 64;
        let mut say = |message: Message| {
            let _ = encode(Header { boot: 0, sender: RobotId(number), sequence }, &message, inbox);
            sequence += 1;
        };
        let (cell, goal) = (open_cell(&mut rng, [1, 4]), open_cell(&mut rng, [15, 30]));
        let along = if rng.below(2) == 0 { [Dir::North, Dir::South] } else { [Dir::South, Dir::North] };
        let mut wish = Wish::CLOSED;
        along.into_iter().zip([0, 2]).for_each(|(dir, lost)| wish.set(dir, lost));
        let waiting = rng.below(100) as u16;
        let said = Said { cell, goal, waiting, wish, step: step as u8, manners: Manners::default() };
        let payload = NegotiationPayload { said, by: Dir::Stay, busy: 0 };
        if rng.below(2) == 0 {
            let (protocol, payload) = payload.encode(Negotiation::ID).unwrap_or_default();
            say(Message::Beacon(Beacon { mode: Mode::Cruise, protocol, payload, ..Beacon::default() }));
        }
        let center = open_cell(&mut rng, [15, 30]);
        let mut report =
            Report { cell: Report::low(center), sight: Sight::new(center, is_closed), ..Report::default() };
        for number in 1..=8 {
            let _ = report.heard.push((number, rng.below(256) as u8));
        }
        if let Some((protocol, content)) = report.encode(Negotiation::ID) {
            say(Message::Broadcast(Broadcast { protocol, content }));
        }
    }
}

/// One robot among 15 others in corridors.
#[inline(never)]
pub(crate) fn worst<S: Scalar, P: Probe<S>, const N: usize>(probe: &mut P) -> Summary {
    type Crowded<S, const N: usize> = Agent<S, Guidance, N>;
    let config = AgentConfig { seed: 1, ..AgentConfig::new(OWN, S::ZERO, TICK) };
    let mut agent = Crowded::<S, N>::new(&config, Guidance::default(), Unguarded, Postcard);
    agent.order(&GridOrder::Goal(Cell::new(EDGE - 1, 0)));
    let mut summary = Summary::of::<Crowded<S, N>, GridWorkspace<CELLS>>();
    let mut workspace = grid::workspace();
    let (mut hashes, mut inbox) = (Hashes::new(), Inbox::new());
    let origin = Cell::new(-SIGHT, -SIGHT);
    let side = 2 * SIGHT + 1;
    let mut land = Vec::<u8, WINDOW>::new();
    for cell in (0..side).flat_map(|y| (0..side).map(move |x| origin + Cell::new(x, y))) {
        let _ = land.push(if is_closed(cell) { BLOCKED } else { 1 });
    }
    for step in 0..STEPS {
        hear(step, &mut inbox);
        let inputs = Inputs {
            state: KinematicState::default(),
            surroundings: OnGrid {
                cell: CellState { cell: Cell::default(), busy: Duration::ZERO },
                window: Window::new(&land, origin, side.unsigned_abs(), side.unsigned_abs()),
            },
            inbox: &inbox,
        };
        let mut out = Outputs::default();
        let now = Instant::from_micros(0) + TICK.saturating_mul(step.cast_signed());
        probe.step(&mut agent, &inputs, now, &mut workspace, &mut out);
        hashes.step(&out, agent.digest());
        summary.count(&out);
    }
    summary.ticks = STEPS;
    hashes.put(&mut summary);
    summary
}
