//! Drones with Staya's agents, which fly in the plane.

use super::{BEACON_STEPS, Body, FLOOR_M, LAG_S, Radio, SPEED_MPS, STEP_S, Scene, Swarm, Task as Wanted, Vector};
use staya_controller::agent::{
    AgentConfig, AnyAgent, AnyInputs, CELLS, CellState, Command, ContactLossPolicy, FormationSettings, GridWorkspace,
    InCell, InCells, InPlane, Inputs, KinematicState, LatticeSettings, LawSettings, LayerSettings, OnGrid,
    OrcaSettings, RouteSettings, Setup, Task, VISITS, Waypoint, WaypointSettings,
};
use staya_controller::geom::{Position, Vec2, Vec3};
use staya_controller::grid::{Cell, Window};
use staya_controller::lattice::{Algorithm, Gain, LatticeParams};
use staya_controller::neighbor::{Ages, StalenessInflation};
use staya_controller::orca::AvoidParams;
use staya_controller::robot::RobotId;
use staya_controller::template::Template;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::{Format, Postcard};

/// The largest swarm of the scenes, but for the drone itself.
const OTHERS: usize = 20;
const STEP: Duration = Duration::from_millis(100);
const BEACON_HZ: f32 = 1.0 / (BEACON_STEPS as f32 * STEP_S as f32);
const RANGE_M: f32 = 1000.0;
/// Side of a cell of a formation, metres.
const CELL_M: f64 = 4.0;
const VIEW: u16 = 11;
/// Distance of neighbours in a flock, metres.
const SPACING_M: f32 = 10.0;
/// Pull of the goal on a flock. `stable_for` would reduce it with the gains between robots,
/// although the goal is known without delay.
const C_GAMMA: f32 = 0.05;
/// Look-ahead of the collision avoidance, seconds; the default is 2.
const HORIZON_S: f32 = 3.0;

type Drone = AnyAgent<f32, CELLS, VISITS, OTHERS, { 2 * OTHERS }>;

/// Staya's drones.
pub struct Staya {
    task: Wanted,
    drones: Vec<Drone>,
    outboxes: Vec<Vec<u8>>,
    goals: Vec<Option<Vector>>,
    workspace: GridWorkspace<CELLS>,
}

fn setup(scene: &Scene, drone: usize) -> Setup {
    let beacon_period = STEP.saturating_mul(BEACON_STEPS as i32);
    let agent = AgentConfig {
        beacon_period,
        lag_s: LAG_S as f32,
        latency: STEP,
        ages: Ages { stale_after: beacon_period.saturating_mul(4), expire_after: beacon_period.saturating_mul(6) },
        contact_loss: ContactLossPolicy {
            listen: STEP.saturating_mul(BEACON_STEPS as i32 + 1),
            reach_m: RANGE_M,
            ..ContactLossPolicy::DEFAULT
        },
        ..AgentConfig::new(RobotId(drone as u32 + 1), (FLOOR_M / 2.0) as f32, STEP)
    };
    let speed_mps = scene.cruise_mps as f32;
    let law = match scene.task {
        Wanted::Goals => LawSettings::Waypoint(WaypointSettings { speed_mps, tolerance_m: 0.05 }),
        Wanted::Flock => {
            let params = LatticeParams { algorithm: Algorithm::Two, ..LatticeParams::new(SPACING_M) };
            let params = params.stable_for(STEP_S as f32, BEACON_HZ);
            let params = LatticeParams { gamma: Gain::critical(C_GAMMA), ..params };
            LawSettings::Lattice(LatticeSettings { params, ..LatticeSettings::default() })
        }
        Wanted::Wedge(spacing_m) => {
            let places = wedge(scene.starts_m.len(), spacing_m);
            let edges: Vec<_> = (1..places.len() as u16).map(|place| (place.saturating_sub(2), place)).collect();
            LawSettings::Formation(FormationSettings {
                route: RouteSettings { speed_mps: Some(speed_mps), ..RouteSettings::default() },
                template: Template::from_graph(&places, &edges, drone, 3).expect("a wedge"),
                ..FormationSettings::default()
            })
        }
    };
    let safety = LayerSettings::Orca(OrcaSettings {
        params: AvoidParams { horizon_s: HORIZON_S, ..AvoidParams::default() },
        inflation: StalenessInflation { growth_mps: SPEED_MPS as f32, max_m: (FLOOR_M / 2.0) as f32 },
    });
    Setup { agent, law, safety, format: Format::default() }
}

/// The places of a wedge in cells, its tip first.
fn wedge(drones: usize, spacing_m: f64) -> Vec<Cell> {
    let spacing = (spacing_m / CELL_M) as i16;
    let place = |drone: i16| {
        let rank = (drone + 1) / 2 * spacing;
        Cell::new(-rank, if drone % 2 == 0 { -rank } else { rank })
    };
    (0..drones as i16).map(place).collect()
}

fn cell(at_m: Vector) -> Cell {
    let of = |metres: f64| libm::floor(metres / CELL_M) as i16;
    Cell::new(of(at_m[0]), of(at_m[1]))
}

fn waypoint(at_m: Vector) -> Task {
    let waypoint = Waypoint::fixed(Position::from_metres(at_m).expect("a place"));
    Task::Waypoints([(0, waypoint)].into_iter().collect())
}

impl Swarm for Staya {
    fn new(scene: &Scene) -> Self {
        let count = scene.starts_m.len();
        Self {
            task: scene.task,
            drones: (0..count).map(|drone| setup(scene, drone).speaking(Postcard)).collect(),
            outboxes: vec![Vec::new(); count],
            goals: vec![None; count],
            workspace: GridWorkspace::new(),
        }
    }

    fn step(&mut self, step: u32, bodies: &[Body], goals: &[Vector], radio: &Radio) -> Vec<Vector> {
        let now = Instant::from_micros(step * STEP.as_micros().cast_unsigned());
        let land = [1; (VIEW * VIEW) as usize];
        let places = wedge(bodies.len(), if let Wanted::Wedge(spacing_m) = self.task { spacing_m } else { 0.0 });
        let mut outboxes = vec![Vec::new(); bodies.len()];
        let mut commands = vec![[0.0; 3]; bodies.len()];
        for (drone, body) in bodies.iter().enumerate().filter(|(_, body)| body.lives) {
            if self.goals[drone] != Some(goals[drone]) {
                self.goals[drone] = Some(goals[drone]);
                let task = match self.task {
                    Wanted::Wedge(_) => Task::Cell(cell(goals[drone]) + places[drone]),
                    Wanted::Goals | Wanted::Flock => waypoint(goals[drone]),
                };
                self.drones[drone].assign(&task).expect("a task of this law");
            }
            let heard = (0..bodies.len()).filter(|&from| from != drone && radio.delivers(step, from, drone));
            let inbox: Vec<u8> = heard.flat_map(|from| self.outboxes[from].iter().copied()).collect();
            let state = KinematicState {
                position: Position::from_metres(body.at_m).expect("a place"),
                velocity_mps: Vec3::new(body.mps[0] as f32, body.mps[1] as f32, body.mps[2] as f32),
            };
            let plane = InPlane { max_speed_mps: SPEED_MPS as f32, obstacles: &[] };
            let inputs: AnyInputs<'_, f32> = if let Wanted::Wedge(_) = self.task {
                let here = cell(body.at_m);
                let half = (VIEW / 2).cast_signed();
                let offset = |metres: f64, cell: i16| (metres - (f64::from(cell) + 0.5) * CELL_M) as f32;
                let surroundings = InCells {
                    grid: OnGrid {
                        cell: CellState { cell: here, busy: Duration::ZERO },
                        window: Window::new(&land, here - Cell::new(half, half), VIEW, VIEW),
                    },
                    plane,
                    in_cell: InCell {
                        offset_m: Vec2::new(offset(body.at_m[0], here.x), offset(body.at_m[1], here.y)),
                        cell_m: CELL_M as f32,
                    },
                };
                Inputs { state, surroundings: surroundings.into(), inbox: &inbox }
            } else {
                Inputs { state, surroundings: plane.into(), inbox: &inbox }
            };
            let out = self.drones[drone].step(&inputs, now, &mut self.workspace);
            outboxes[drone] = out.outbox.to_vec();
            if let Command::Velocity(Vec3 { x, y, z }) = out.command {
                commands[drone] = [x, y, z].map(f64::from);
            }
        }
        self.outboxes = outboxes;
        commands
    }

    fn knows(&self, _: u32, own: usize, other: usize) -> bool {
        self.drones[own].neighbors().iter().any(|known| known.id == RobotId(other as u32 + 1))
    }
}
