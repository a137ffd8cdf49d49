//! One agent of full size under heavy load: a full table of near neighbours with random velocities,
//! other ones in each step, and scenes that a search found. Not a proof of the worst case.

use crate::hash::Hashes;
use crate::land::WINDOW;
#[cfg(feature = "all-cases")]
use crate::negotiation;
use crate::plane::STEP;
use crate::scene;
use crate::{Probe, Summary};
use heapless::Vec;
use serde::Serialize;
use staya_controller::agent::{
    Agent, AgentConfig, BoidsGuidance, CELLS, CellState, FormationGuidance, GoalFlockGuidance, Grid, GridOrder,
    GridPayload, GridWorkspace, InPlane, Inputs, KinematicState, LatticeGuidance, Law, OnGrid, OrcaSafety, Outputs,
    Protocol, RouteGuidance, Safety, TEMPLATE, Unguarded, VISITS, Waypoint, WaypointGuidance, WaypointOrder, Waypoints,
};
#[cfg(feature = "all-cases")]
use staya_controller::agent::{FlySafety, PushOutSafety};
use staya_controller::boids::BoidsParams;
use staya_controller::formation::{FormationParams, Prediction};
use staya_controller::geom::{Position, Vec2, Vec3};
use staya_controller::goal_flock::GoalParams;
use staya_controller::grid::{Cell, Dir, Window};
use staya_controller::lattice::LatticeParams;
use staya_controller::neighbor::StalenessInflation;
use staya_controller::obstacle::Obstacle;
use staya_controller::orca::{Analytic, AvoidParams, HalfSpaces, VoxelTable2k};
#[cfg(feature = "all-cases")]
use staya_controller::push_out::PushOutParams;
use staya_controller::rand::Rng;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::route::RouteParams;
use staya_controller::scalar::Scalar;
use staya_controller::template::Template;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::{Beacon, Content as _, Header, Message, Postcard, encode};

const STEPS: u32 = 64;
const OBSTACLES: usize = 4;
const PURPOSE: u32 = u32::from_be_bytes(*b"wrst");
const RADIUS_MM: i32 = 150;
/// A number in the middle, so that templates name robots on both sides.
const OWN: RobotId = RobotId(5);

type Inbox = Vec<u8, { 16 * Beacon::MAX_FRAME_LEN }>;

/// The behaviour of the agent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorstCase {
    /// A search of the whole window.
    Route,
    /// Formation among eight neighbours of the template.
    Formation,
    /// Like [`WorstCase::Formation`], with a search for the prediction of each neighbour.
    FormationReflexive,
    /// ORCA in a crowd in which mostly no velocity is permitted, half-planes by formula.
    OrcaAnalytic,
    /// The scenes in which a search found the longest steps of [`WorstCase::OrcaAnalytic`].
    OrcaFound,
    /// Like [`WorstCase::OrcaAnalytic`], with half-planes from the table.
    OrcaTemplate2k,
    /// ORCA in space, in such a crowd.
    #[cfg(feature = "all-cases")]
    Fly,
    /// Push-out in such a crowd.
    #[cfg(feature = "all-cases")]
    PushOut,
    /// The alpha flock with all robots in range.
    Lattice,
    /// The goal flock with all robots in range.
    GoalFlock,
    /// Boids with all robots in range.
    Boids,
    /// Negotiation with 15 robots in long corridors, half of them not heard in a step.
    #[cfg(feature = "all-cases")]
    Negotiation,
}

impl WorstCase {
    /// All cases.
    pub const ALL: &[Self] = &[
        Self::Route,
        Self::Formation,
        Self::FormationReflexive,
        Self::OrcaAnalytic,
        Self::OrcaFound,
        Self::OrcaTemplate2k,
        #[cfg(feature = "all-cases")]
        Self::Fly,
        #[cfg(feature = "all-cases")]
        Self::PushOut,
        Self::Lattice,
        Self::GoalFlock,
        Self::Boids,
        #[cfg(feature = "all-cases")]
        Self::Negotiation,
    ];

    /// Name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Route => "worst_route",
            Self::Formation => "worst_formation",
            Self::FormationReflexive => "worst_formation_reflexive",
            Self::OrcaAnalytic => "worst_orca_analytic",
            Self::OrcaFound => "worst_orca_found",
            Self::OrcaTemplate2k => "worst_orca_template_2k",
            #[cfg(feature = "all-cases")]
            Self::Fly => "worst_fly",
            #[cfg(feature = "all-cases")]
            Self::PushOut => "worst_push_out",
            Self::Lattice => "worst_lattice",
            Self::GoalFlock => "worst_goal_flock",
            Self::Boids => "worst_boids",
            #[cfg(feature = "all-cases")]
            Self::Negotiation => "worst_negotiation",
        }
    }

    /// Runs 64 steps (of a found scene 7) with `N` neighbours (at most eight on the grid) and at
    /// most `K` half-planes.
    pub fn run<S: Scalar, P: Probe<S>, const N: usize, const K: usize>(self, probe: &mut P) -> Summary {
        match self {
            Self::Route => on_grid::<S, _, P, N>(RouteGuidance::<CELLS, VISITS>::new(RouteParams::default()), probe),
            Self::Formation => on_grid::<S, _, P, N>(formation(Prediction::Constant), probe),
            Self::FormationReflexive => on_grid::<S, _, P, N>(formation(Prediction::Reflexive), probe),
            Self::OrcaAnalytic => worst_orca::<S, _, P, N, K>(Analytic, probe),
            Self::OrcaFound => scene::found::<S, _, P, N, K>(Analytic, probe),
            Self::OrcaTemplate2k => worst_orca::<S, _, P, N, K>(VoxelTable2k, probe),
            #[cfg(feature = "all-cases")]
            Self::Fly => {
                let safety = FlySafety::<S, K>::in_space(AvoidParams::default(), inflation());
                in_crowd::<S, _, _, P, N>(waypoint(), safety, probe)
            }
            #[cfg(feature = "all-cases")]
            Self::PushOut => {
                let safety = PushOutSafety::new(PushOutParams::new(S::from_milli(400)));
                in_crowd::<S, _, _, P, N>(waypoint(), safety, probe)
            }
            Self::Lattice => {
                let guidance = sent(LatticeGuidance::new(LatticeParams::new(S::ONE), true));
                in_crowd::<S, _, _, P, N>(guidance, Unguarded, probe)
            }
            Self::GoalFlock => {
                let params = GoalParams::new(S::HALF, S::ONE);
                let guidance = sent(GoalFlockGuidance::new(params, S::ONE, 3));
                in_crowd::<S, _, _, P, N>(guidance, Unguarded, probe)
            }
            Self::Boids => {
                let params =
                    BoidsParams::new(S::from_milli(50), S::from_i32(30), S::from_ratio(1, 20), S::from_ratio(1, 50));
                let guidance = BoidsGuidance::new(params, S::ONE);
                in_crowd::<S, _, _, P, N>(guidance, Unguarded, probe)
            }
            #[cfg(feature = "all-cases")]
            Self::Negotiation => negotiation::worst::<S, P, N>(probe),
        }
    }
}

fn inflation<S: Scalar>() -> StalenessInflation<S> {
    StalenessInflation { growth_mps: S::HALF, max_m: S::from_milli(300) }
}

fn waypoint<S: Scalar>() -> WaypointGuidance<S> {
    sent(WaypointGuidance::new(S::ONE, S::from_milli(10)))
}

/// The law with a waypoint. Boids accept none.
fn sent<S: Scalar, G: Law<S, Protocol = Waypoints>>(mut law: G) -> G {
    let goal = Waypoint::fixed(Position::from_mm([9000, 500, 0]));
    let _ = law.order(&WaypointOrder::first(goal));
    law
}

/// Runs [`WorstCase::OrcaAnalytic`] with half-planes of neighbours from `source`.
pub fn worst_orca<S: Scalar, H: HalfSpaces<S> + Serialize, P: Probe<S>, const N: usize, const K: usize>(
    source: H,
    probe: &mut P,
) -> Summary {
    let safety = OrcaSafety::<S, K, H>::with_source(AvoidParams::default(), inflation(), source);
    in_crowd::<S, _, _, P, N>(waypoint(), safety, probe)
}

fn about(rng: &mut Rng, most: u32) -> i32 {
    rng.below(2 * most + 1).cast_signed() - most.cast_signed()
}

fn say<const N: usize>(step: u32, inbox: &mut Inbox, mut beacon: impl FnMut(u32, &mut Rng) -> Beacon) {
    inbox.clear();
    let numbers = (1..).filter(|number| *number != OWN.0);
    for number in numbers.take(N) {
        let mut rng = Rng::keyed(2, PURPOSE, number, step);
        // A sender may have moved anywhere meanwhile.
        let header = Header { boot: 0, sender: RobotId(number), sequence: step as u16 * 64 };
        let _ = encode(header, &Message::Beacon(beacon(number, &mut rng)), inbox);
    }
}

#[inline(never)]
fn in_crowd<S, G, A, P, const N: usize>(law: G, safety: A, probe: &mut P) -> Summary
where
    S: Scalar,
    G: for<'a> Law<S, Surroundings<'a> = InPlane<'a, S>, Workspace = ()>,
    A: Safety<S>,
    Agent<S, G, N, A>: Serialize,
    P: Probe<S>,
{
    let config = AgentConfig { seed: 1, latency: STEP, ..AgentConfig::new(OWN, S::from_milli(RADIUS_MM), STEP) };
    let mut agent = Agent::<S, G, N, A>::new(&config, law, safety, Postcard);
    let mut summary = Summary::of::<Agent<S, G, N, A>, ()>();
    let (mut hashes, mut inbox) = (Hashes::new(), Inbox::new());
    for step in 0..STEPS {
        say::<N>(step, &mut inbox, |_, rng| Beacon {
            position_mm: [about(rng, 900), about(rng, 900), about(rng, 300)],
            velocity_mmps: [about(rng, 700), about(rng, 700), about(rng, 200)].map(|v| v as i16),
            radius_mm: RADIUS_MM.unsigned_abs() as u16,
            mode: Mode::Cruise,
            protocol: G::Protocol::ID,
            ..Beacon::default()
        });
        let mut rng = Rng::keyed(2, PURPOSE, 0, step);
        let mut metres = |most| S::from_milli(about(&mut rng, most));
        let velocity_mps = Vec3::new(metres(700), metres(700), S::ZERO);
        let mut obstacles = Vec::<Obstacle<S>, OBSTACLES>::new();
        while !obstacles.is_full() {
            let end = Vec2::new(metres(900), metres(900));
            let other = end + Vec2::new(metres(900), metres(900));
            let _ = obstacles.push(Obstacle::Wall([end, other]));
        }
        let inputs = Inputs {
            state: KinematicState { position: Position::ORIGIN, velocity_mps },
            surroundings: InPlane { max_speed_mps: S::ONE, obstacles: &obstacles },
            inbox: &inbox,
        };
        let now = Instant::from_micros(0) + STEP.saturating_mul(step.cast_signed());
        let mut out = Outputs::default();
        probe.step(&mut agent, &inputs, now, &mut (), &mut out);
        hashes.step(&out, agent.digest());
        summary.count(&out);
    }
    summary.ticks = STEPS;
    hashes.put(&mut summary);
    summary
}

const PLACES: [Cell; 9] = [
    Cell::new(0, 0),
    Cell::new(-3, 0),
    Cell::new(-6, 0),
    Cell::new(0, -3),
    Cell::new(-3, -3),
    Cell::new(-6, -3),
    Cell::new(0, -6),
    Cell::new(-3, -6),
    Cell::new(-6, -6),
];
const EDGES: [(u16, u16); 12] =
    [(0, 1), (1, 2), (3, 4), (4, 5), (6, 7), (7, 8), (0, 3), (1, 4), (2, 5), (3, 6), (4, 7), (5, 8)];
const LEADERS: [u32; 9] = [0, 1, 2, 1, 2, 3, 4, 5, 6];
const TOP: Cell = Cell::new(50, 50);
const GOAL: Cell = Cell::new(98, 98);
const MIDDLE: usize = 4;

fn formation(prediction: Prediction) -> FormationGuidance<CELLS, VISITS, TEMPLATE> {
    let params = FormationParams { prediction, ..FormationParams::default() };
    // A test counts its robots.
    let template = Template::from_graph(&PLACES, &EDGES, MIDDLE, 2).unwrap_or_default();
    FormationGuidance::new(RouteParams::default(), params, template)
}

#[inline(never)]
fn on_grid<S, G, P, const N: usize>(guidance: G, probe: &mut P) -> Summary
where
    S: Scalar,
    G: for<'a> Law<S, Surroundings<'a> = OnGrid<'a>, Protocol = Grid, Workspace = GridWorkspace<CELLS>>,
    Agent<S, G, N>: Serialize,
    P: Probe<S>,
{
    let config = AgentConfig { seed: 1, ..AgentConfig::new(OWN, S::ZERO, STEP) };
    let mut agent = Agent::<S, G, N>::new(&config, guidance, Unguarded, Postcard);
    let cell = TOP + PLACES.get(MIDDLE).copied().unwrap_or_default();
    agent.order(&GridOrder::Goal(GOAL + (cell - TOP)));
    let mut workspace = GridWorkspace::new();
    let mut summary = Summary::of::<Agent<S, G, N>, GridWorkspace<CELLS>>();
    let (mut hashes, mut inbox) = (Hashes::new(), Inbox::new());
    for step in 0..STEPS {
        let mut rng = Rng::keyed(2, PURPOSE, 0, step);
        let mut land = Vec::<u8, WINDOW>::new();
        while !land.is_full() {
            let _ = land.push(1 + rng.below(9) as u8);
        }
        say::<8>(step, &mut inbox, |number, rng| {
            let index = number.saturating_sub(1) as usize;
            let place = PLACES.get(index).copied().unwrap_or_default();
            let payload = GridPayload {
                // Off its place, so that prediction must search.
                cell: TOP + place + Cell::new(about(rng, 1) as i16, i16::from(number != 1)),
                target: GOAL + place,
                busy_ms: 0,
                heading: Dir::NorthEast,
                slot: index as u8,
                leader: RobotId(LEADERS.get(index).copied().unwrap_or(0)),
            };
            let (protocol, payload) = payload.encode(Grid::ID).unwrap_or_default();
            Beacon { mode: Mode::Cruise, protocol, payload, ..Beacon::default() }
        });
        let inputs = Inputs {
            state: KinematicState::default(),
            surroundings: OnGrid {
                cell: CellState { cell, busy: Duration::ZERO },
                window: Window::new(&land, cell - Cell::new(5, 5), 11, 11),
            },
            inbox: &inbox,
        };
        let now = Instant::from_micros(0) + STEP.saturating_mul(step.cast_signed());
        let mut out = Outputs::default();
        probe.step(&mut agent, &inputs, now, &mut workspace, &mut out);
        hashes.step(&out, agent.digest());
        summary.count(&out);
    }
    summary.ticks = STEPS;
    hashes.put(&mut summary);
    summary
}
