//! Bodies that follow their commands at once.

use crate::grid::KNOWN;
use crate::hash::Hashes;
use crate::land::{Land, WINDOW};
use crate::medium::{Faults, INBOX, Medium};
use crate::{Probe, Summary};
use heapless::Vec;
use serde::Serialize;
use staya_controller::agent::{
    Agent, CellState, Command, InCell, InCells, InPlane, Inputs, KinematicState, Law, OnGrid, Outputs, Safety,
};
use staya_controller::geom::{Position, Vec2, Vec3};
use staya_controller::grid::GridFrame;
use staya_controller::obstacle::{Obstacle, grid_walls};
use staya_controller::robot::Mode;
use staya_controller::scalar::Scalar;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::Postcard;

const OBSTACLES: usize = 8;
pub(crate) const STEP: Duration = Duration::from_millis(100);
const CELL_MM: i32 = 1000;

pub(crate) type PlaneAgent<S, G, A> = Agent<S, G, KNOWN, A>;

pub(crate) struct Mover<S: Scalar, G: Law<S>, A> {
    pub(crate) agent: PlaneAgent<S, G, A>,
    pub(crate) position: Position,
    pub(crate) velocity_mps: Vec3<S>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Solid {
    /// Ends, millimetres.
    Wall([[i32; 2]; 2]),
    /// Centre and radius, millimetres.
    Ball([i32; 3], i32),
    /// Height, millimetres.
    Floor(i32),
}

pub(crate) struct Scene<S> {
    pub(crate) solids: &'static [Solid],
    pub(crate) land: Option<Land>,
    pub(crate) max_speed_mps: S,
    /// Bodies whose centres are nearer than this overlap.
    pub(crate) apart_mm: i32,
    pub(crate) faults: Faults,
    pub(crate) ticks: u32,
}

pub(crate) fn instant(tick: u32) -> Instant {
    Instant::from_micros(0) + STEP.saturating_mul(tick.cast_signed())
}

#[inline(never)]
pub(crate) fn run<S, G, A, P, const R: usize>(
    scene: &Scene<S>,
    movers: &mut Vec<Mover<S, G, A>, R>,
    workspace: &mut G::Workspace,
    probe: &mut P,
) -> Summary
where
    S: Scalar,
    G: for<'a> Law<S, Surroundings<'a>: From<InCells<'a, S>>>,
    A: Safety<S>,
    PlaneAgent<S, G, A>: Serialize,
    P: Probe<S>,
{
    let mut medium = Medium::<_, R>::new(Postcard, scene.faults);
    let mut hashes = Hashes::new();
    let mut summary = Summary::of::<PlaneAgent<S, G, A>, G::Workspace>();
    let mut inbox = Vec::<u8, INBOX>::new();
    let mut out = Outputs::default();
    for tick in 0..scene.ticks {
        // After all have decided, so that packets and positions belong to one moment.
        for (index, mover) in movers.iter_mut().enumerate() {
            medium.hear(index, tick, &mut inbox);
            step(scene, mover, tick, &inbox, workspace, probe, &mut out);
            hashes.step(&out, mover.agent.digest());
            summary.count(&out);
            medium.send(index, &out.outbox);
            mover.velocity_mps = match out.command {
                Command::Velocity(velocity_mps) => velocity_mps,
                Command::Hold | Command::Move(_) => Vec3::ZERO,
            };
        }
        medium.turn();
        let step_s = S::from_micro(STEP.as_micros());
        for mover in movers.iter_mut() {
            let way = mover.velocity_mps * step_s;
            mover.position = mover.position.moved(way).unwrap_or(mover.position);
            hashes.commands.position(mover.position);
        }
        summary.ticks = tick.saturating_add(1);
        let arrived = movers.iter().filter(|m| m.agent.mode() == Mode::Arrived);
        summary.arrived = arrived.count() as u32;
        summary.overlaps = summary.overlaps.saturating_add(overlaps(scene, movers));
        if summary.arrived as usize == movers.len() {
            break;
        }
    }
    hashes.put(&mut summary);
    summary.apart_mm = apart(movers);
    summary
}

#[inline(never)]
fn step<S, G, A, P>(
    scene: &Scene<S>,
    mover: &mut Mover<S, G, A>,
    tick: u32,
    inbox: &[u8],
    workspace: &mut G::Workspace,
    probe: &mut P,
    out: &mut Outputs<S>,
) where
    S: Scalar,
    G: for<'a> Law<S, Surroundings<'a>: From<InCells<'a, S>>>,
    A: Safety<S>,
    P: Probe<S>,
{
    let mut cells = Vec::<u8, WINDOW>::new();
    let mut obstacles = Vec::<Obstacle<S>, OBSTACLES>::new();
    for solid in scene.solids {
        // A test shows that no scene has more obstacles than fit.
        let _ = obstacles.push(seen(solid, mover.position));
    }
    let frame = GridFrame { origin_m: Vec2::ZERO, cell_m: S::from_milli(CELL_MM) };
    let place_m = mover.position.since::<S>(Position::ORIGIN).xy();
    let cell = frame.cell(place_m).unwrap_or_default();
    let window = scene.land.and_then(|land| land.window(cell, &mut cells));
    if let Some(window) = &window {
        obstacles = grid_walls(window, &frame, place_m, S::from_i32(3));
    }
    let inputs = Inputs {
        state: KinematicState { position: mover.position, velocity_mps: mover.velocity_mps },
        surroundings: G::Surroundings::from(InCells {
            grid: OnGrid { cell: CellState { cell, busy: Duration::ZERO }, window },
            plane: InPlane { max_speed_mps: scene.max_speed_mps, obstacles: &obstacles },
            in_cell: InCell { offset_m: place_m - frame.center(cell), cell_m: frame.cell_m },
        }),
        inbox,
    };
    probe.step(&mut mover.agent, &inputs, instant(tick), workspace, out);
}

fn seen<S: Scalar>(solid: &Solid, from: Position) -> Obstacle<S> {
    match *solid {
        Solid::Wall(ends_mm) => {
            Obstacle::Wall(ends_mm.map(|[x, y]| Position::from_mm([x, y, 0]).since::<S>(from).xy()))
        }
        Solid::Ball(center_mm, radius_mm) => {
            Obstacle::Ball { center_m: Position::from_mm(center_mm).since(from), radius_m: S::from_milli(radius_mm) }
        }
        Solid::Floor(height_mm) => Obstacle::Plane {
            normal: Vec3::new(S::ZERO, S::ZERO, S::ONE),
            distance_m: from.since::<S>(Position::from_mm([0, 0, height_mm])).z,
        },
    }
}

fn overlaps<S: Scalar, G: Law<S>, A>(scene: &Scene<S>, movers: &[Mover<S, G, A>]) -> u32 {
    let least = u64::from(scene.apart_mm.unsigned_abs());
    pairs(movers).filter(|squared| *squared < least * least).count() as u32
}

fn apart<S: Scalar, G: Law<S>, A>(movers: &[Mover<S, G, A>]) -> [u32; 2] {
    let millimetres = |squared: Option<u64>| squared.unwrap_or(0).isqrt() as u32;
    [pairs(movers).min(), pairs(movers).max()].map(millimetres)
}

fn pairs<S: Scalar, G: Law<S>, A>(movers: &[Mover<S, G, A>]) -> impl Iterator<Item = u64> {
    movers.iter().enumerate().flat_map(move |(index, one)| {
        let others = movers.iter().skip(index.saturating_add(1));
        others.map(|other| {
            let both = one.position.mm.iter().zip(other.position.mm);
            both.map(|(a, b)| u64::from(a.abs_diff(b)).pow(2)).sum()
        })
    })
}
