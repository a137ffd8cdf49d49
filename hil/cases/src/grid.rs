use crate::hash::Hashes;
use crate::land::{Land, WINDOW};
use crate::medium::{Faults, Medium};
use crate::{Probe, Summary};
use heapless::Vec;
use serde::Serialize;
use staya_controller::agent::{
    Agent, CELLS, CellState, Command, FormationGuidance, GridWorkspace, Inputs, KinematicState, Law, OnGrid, Outputs,
    RouteGuidance, Unguarded,
};
use staya_controller::geom::{Position, Vec3};
use staya_controller::grid::{BLOCKED, Cell, Norm, UNIT};
use staya_controller::robot::Mode;
use staya_controller::scalar::Scalar;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::{Postcard, Wire};

/// Table size in the plane; on the grid the table holds all robots.
pub(crate) const KNOWN: usize = 8;
const VISITS: usize = 32;
const TEMPLATE: usize = ROBOTS;
pub(crate) const ROBOTS: usize = 4;

pub(crate) type Route = RouteGuidance<CELLS, VISITS>;
pub(crate) type Formation = FormationGuidance<CELLS, VISITS, TEMPLATE>;
pub(crate) type GridAgent<S, G, W = Postcard, const N: usize = ROBOTS> = Agent<S, G, N, Unguarded, W>;

/// With [`UNIT`] milliseconds, crossing times need no division.
pub(crate) const TICK: Duration = Duration::from_millis(UNIT.cast_signed());

pub(crate) struct Walker<S: Scalar, G: Law<S>, W = Postcard, const N: usize = ROBOTS> {
    pub(crate) agent: GridAgent<S, G, W, N>,
    pub(crate) cell: Cell,
    pub(crate) free_at_ms: u32,
}

pub(crate) struct Scene {
    pub(crate) land: Land,
    pub(crate) faults: Faults,
    pub(crate) ticks: u32,
}

pub(crate) fn instant(tick: u32) -> Instant {
    Instant::from_micros(0) + TICK.saturating_mul(tick.cast_signed())
}

/// Not inlined, so that the workspace is built in place: a small part has no memory for two.
#[inline(never)]
pub(crate) fn workspace() -> GridWorkspace<CELLS> {
    GridWorkspace::new()
}

/// `N`: robots; `SEATS`: senders of the medium, the last of which is `commander`. It writes an
/// operator's packets of a tick, which robots receive like each other's.
#[inline(never)]
pub(crate) fn run<S, G, W, P, const N: usize, const SEATS: usize, const BYTES: usize>(
    scene: &Scene,
    walkers: &mut Vec<Walker<S, G, W, N>, N>,
    medium: &mut Medium<W, SEATS, BYTES>,
    workspace: &mut G::Workspace,
    mut commander: impl FnMut(u32, &mut Vec<u8, BYTES>),
    probe: &mut P,
) -> Summary
where
    S: Scalar,
    G: for<'a> Law<S, Surroundings<'a> = OnGrid<'a>>,
    GridAgent<S, G, W, N>: Serialize,
    W: Wire,
    P: Probe<S>,
{
    let mut hashes = Hashes::new();
    let mut summary = Summary::of::<GridAgent<S, G, W, N>, G::Workspace>();
    let mut out = Outputs::default();
    let mut commands: [Command<S>; N] = [const { Command::Hold }; N];
    for tick in 0..scene.ticks {
        let mut inbox = Vec::new();
        commander(tick, &mut inbox);
        medium.send(N, &inbox);
        for (index, (walker, command)) in walkers.iter_mut().zip(&mut commands).enumerate() {
            medium.hear(index, tick, &mut inbox);
            step(scene, walker, tick, &inbox, workspace, probe, &mut out);
            hashes.step(&out, walker.agent.digest());
            summary.count(&out);
            medium.send(index, &out.outbox);
            *command = core::mem::take(&mut out.command);
        }
        medium.turn();
        // Refused bodies try again after the others, as in the simulator.
        let mut has_moved = true;
        while core::mem::take(&mut has_moved) {
            for (index, command) in commands.iter_mut().enumerate() {
                if let Command::Move(moves) = command
                    && advance(scene, walkers, index, moves, tick)
                {
                    *command = Command::Hold;
                    has_moved = true;
                }
            }
        }
        for walker in walkers.iter() {
            hashes.commands.bytes(&walker.cell.x.to_le_bytes());
            hashes.commands.bytes(&walker.cell.y.to_le_bytes());
        }
        summary.ticks = tick.saturating_add(1);
        let arrived = walkers.iter().filter(|w| w.agent.mode() == Mode::Arrived);
        summary.arrived = arrived.count() as u32;
        summary.overlaps = summary.overlaps.saturating_add(overlaps(walkers));
        if summary.arrived as usize == walkers.len() {
            break;
        }
    }
    hashes.put(&mut summary);
    summary
}

#[inline(never)]
fn step<S, G, W, P, const N: usize>(
    scene: &Scene,
    walker: &mut Walker<S, G, W, N>,
    tick: u32,
    inbox: &[u8],
    workspace: &mut G::Workspace,
    probe: &mut P,
    out: &mut Outputs<S>,
) where
    S: Scalar,
    G: for<'a> Law<S, Surroundings<'a> = OnGrid<'a>>,
    W: Wire,
    P: Probe<S>,
{
    let mut cells = Vec::<u8, WINDOW>::new();
    let Cell { x, y } = walker.cell;
    let now_ms = tick.saturating_mul(UNIT);
    let busy_ms = walker.free_at_ms.saturating_sub(now_ms);
    let inputs = Inputs {
        state: KinematicState {
            position: Position::from_mm([i32::from(x) * 1000, i32::from(y) * 1000, 0]),
            velocity_mps: Vec3::ZERO,
        },
        surroundings: OnGrid {
            cell: CellState { cell: walker.cell, busy: Duration::from_millis(busy_ms.cast_signed()) },
            window: scene.land.window(walker.cell, &mut cells),
        },
        inbox,
    };
    probe.step(&mut walker.agent, &inputs, instant(tick), workspace, out);
}

/// Returns whether the body moved.
fn advance<S: Scalar, G: Law<S>, W, const N: usize>(
    scene: &Scene,
    walkers: &mut [Walker<S, G, W, N>],
    index: usize,
    moves: &[staya_controller::grid::Dir],
    tick: u32,
) -> bool {
    let now_ms = tick.saturating_mul(UNIT);
    let Some(from) = walkers.get(index).map(|walker| walker.cell) else {
        return false;
    };
    let land = |cell: Cell| scene.land.at(cell);
    let is_open = |dir: &staya_controller::grid::Dir| {
        let step = dir.offset();
        let to = from + step;
        let corners = [from + Cell::new(step.x, 0), from + Cell::new(0, step.y)];
        land(to) != BLOCKED
            && corners.iter().all(|corner| land(*corner) != BLOCKED)
            && walkers.iter().all(|walker| walker.cell != to)
    };
    let Some(dir) = moves.iter().copied().find(is_open) else {
        return false;
    };
    let to = from + dir.offset();
    let crossing_ms = dir.length(Norm::Euclidean).saturating_mul(land(to).into());
    if let Some(walker) = walkers.get_mut(index)
        && walker.free_at_ms <= now_ms
    {
        // A body that leaves in its first free tick keeps the rest of that tick (KUZ eq. 6).
        let is_going_on = now_ms.saturating_sub(walker.free_at_ms) < UNIT;
        let start_ms = if is_going_on { walker.free_at_ms } else { now_ms };
        walker.free_at_ms = start_ms.saturating_add(crossing_ms);
        walker.cell = to;
        return true;
    }
    false
}

fn overlaps<S: Scalar, G: Law<S>, W, const N: usize>(walkers: &[Walker<S, G, W, N>]) -> u32 {
    let mut count = 0;
    for (index, one) in walkers.iter().enumerate() {
        let others = walkers.iter().skip(index.saturating_add(1));
        count += others.filter(|other| other.cell == one.cell).count() as u32;
    }
    count
}
