//! Ticks: every robot's own [`Agent`] between one world and one radio. Read [`Engine::step`] first.
//!
//! A tick has two phases. First all robots decide, in parallel: each gets its own pose and cell, the
//! land around it and the bytes that the radio delivered, and nothing else. Then the radio carries
//! what they sent and the world moves their bodies. What a robot does in a tick can therefore
//! reach another one in the next tick at the earliest, and neither the number of threads nor the
//! order of robots matters.
//!
//! [`simulate`] runs a whole scenario with the guidance that it asks for.

mod body;
mod hash;
mod simulate;

pub use simulate::{Moment, Outcome, simulate};

use crate::metrics::{Arrivals, FormationMeter, Keeping};
use crate::radio::Radio;
use crate::record::{PacketCounts, RobotRow, TickRow};
use crate::scenario::{Fault, Robot, Scenario};
use crate::world::{Misplaced, World};
use body::Kinematics;
use hash::Chain;
use rayon::prelude::*;
use staya_controller::agent::{
    Agent, AgentConfig, CellState, Command, Guidance, Inputs, NEIGHBORS, OUTBOX,
};
use staya_controller::grid::{Cell, UNIT};
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::{Mode, RobotId};

/// Robots that a thread takes at least at a time: less would cost more in handing out than in work.
const BATCH: usize = 64;

/// A robot's computer.
#[derive(Debug)]
struct Computer<G> {
    agent: Agent<f32, G, NEIGHBORS>,
    outbox: heapless::Vec<u8, OUTBOX>,
    /// Counts its starts.
    boot: u8,
    /// The tick at which its clock showed 0.
    epoch: u32,
    /// Down before this tick.
    down_until: u32,
}

/// What the rest of the engine needs to know of a robot after its decision.
#[derive(Clone, Copy, Debug)]
struct Status {
    mode: Mode,
    leader: RobotId,
    target: Cell,
}

/// A scenario in motion. `G` is the guidance of all its robots.
pub struct Engine<G> {
    seed: u64,
    tick_us: u32,
    radius: u8,
    tick: u32,
    robots: Vec<Robot>,
    faults: Vec<Fault>,
    guidance: Box<dyn Fn(usize) -> G + Send + Sync>,
    world: World,
    radio: Radio,
    kinematics: Kinematics,
    computers: Vec<Computer<G>>,
    commands: Vec<Command<f32>>,
    statuses: Vec<Status>,
    chains: Vec<Chain>,
    positions_m: Vec<[f64; 2]>,
    meter: Option<FormationMeter>,
    arrivals: Arrivals,
    collisions: u64,
    packets: PacketCounts,
    throttled: u64,
}

impl<G> Engine<G>
where
    G: Guidance<f32, Workspace: Default> + Send,
{
    /// The scenario before its first tick. `guidance(i)` makes the guidance of robot number `i` in
    /// [`Scenario::robots`], at its first start and at each restart.
    ///
    /// # Errors
    /// When two robots start in one cell or one starts in a wall; a scenario that was read from a
    /// file is known to have neither.
    pub fn new(
        scenario: &Scenario,
        guidance: impl Fn(usize) -> G + Send + Sync + 'static,
    ) -> Result<Self, Misplaced> {
        let robots = scenario.robots.clone();
        let starts = robots.iter().map(|robot| (robot.id, robot.start));
        let world = World::new(
            scenario.terrain.clone(),
            scenario.rules,
            scenario.seed,
            starts,
        )?;
        let ids = robots.iter().map(|robot| robot.id);
        let meter = scenario.formation.as_ref().map(|graph| {
            FormationMeter::new(graph, scenario.formation_params.eps, world.terrain())
        });
        let mut engine = Self {
            seed: scenario.seed,
            tick_us: scenario.tick_us,
            radius: scenario.route.params.radius,
            tick: 0,
            faults: scenario.faults.clone(),
            guidance: Box::new(guidance),
            radio: Radio::new(&scenario.radio, scenario.seed, scenario.tick_us, ids),
            kinematics: Kinematics::new(world.terrain(), scenario.tick_s()),
            computers: Vec::new(),
            commands: vec![Command::Hold; robots.len()],
            statuses: Vec::new(),
            chains: robots.iter().map(|robot| Chain::new(robot.id)).collect(),
            positions_m: vec![[0.0; 2]; robots.len()],
            meter,
            arrivals: Arrivals::new(robots.len()),
            collisions: 0,
            packets: PacketCounts::default(),
            throttled: 0,
            world,
            robots,
        };
        engine.computers = (0..engine.robots.len())
            .map(|index| engine.start(index, 0))
            .collect();
        let waiting = |robot: &Robot| Status {
            mode: Mode::Idle,
            leader: RobotId::NOBODY,
            target: robot.goal,
        };
        engine.statuses = engine.robots.iter().map(waiting).collect();
        Ok(engine)
    }

    /// Computer number `index`, started now.
    fn start(&self, index: usize, boot: u8) -> Computer<G> {
        let robot = &self.robots[index];
        let tick = Duration::from_micros(i32::try_from(self.tick_us).unwrap_or(i32::MAX));
        let config = AgentConfig {
            boot,
            ..AgentConfig::new(robot.id, self.seed, tick)
        };
        let mut agent = Agent::new(&config, (self.guidance)(index));
        agent.assign_goal(robot.goal);
        Computer {
            agent,
            outbox: heapless::Vec::new(),
            boot,
            epoch: self.tick,
            down_until: self.tick,
        }
    }

    /// One tick. Returns what the swarm as a whole looks like after it.
    pub fn step(&mut self) -> TickRow {
        self.apply_faults();
        let rejected = self.decide();

        let computers = &self.computers;
        let outbox = |index: usize| computers[index].outbox.as_slice();
        let carried = self.radio.carry(self.tick, &self.positions_m, outbox);
        let packets = PacketCounts {
            sent: carried.sent,
            delivered: carried.delivered,
            lost: carried.lost,
            corrupted: carried.corrupted,
            rejected,
        };
        self.packets += packets;
        self.throttled += carried.throttled;

        self.world.advance(self.tick, &self.commands);
        self.collisions += self.world.count_collisions(self.tick);
        self.observe();
        let meter = self.meter.as_mut();
        let keeping = meter.map(|meter| meter.measure(self.world.bodies()));
        self.tick += 1;
        self.row(keeping, packets)
    }

    /// Takes computers down whose fault begins; who comes up again has forgotten everything but its
    /// number, its parameters and its task.
    fn apply_faults(&mut self) {
        for at in 0..self.faults.len() {
            let fault = self.faults[at];
            let found = self.robots.binary_search_by_key(&fault.robot, |r| r.id);
            let Ok(index) = found.as_ref().copied() else {
                continue;
            };
            if fault.from_tick == self.tick {
                let computer = &mut self.computers[index];
                computer.down_until = computer.down_until.max(fault.to_tick);
            }
            let ends = fault.to_tick == self.tick;
            if ends && self.computers[index].down_until == self.tick {
                let boot = self.computers[index].boot.wrapping_add(1);
                self.computers[index] = self.start(index, boot);
            }
        }
    }

    /// Phase one: everybody decides. Returns how many frames were refused.
    fn decide(&mut self) -> u64 {
        let (tick, tick_us, radius) = (self.tick, self.tick_us, self.radius);
        let (world, radio, kinematics) = (&self.world, &self.radio, &self.kinematics);
        let now_units = u64::from(tick) * u64::from(UNIT);
        let scratch = || (G::Workspace::default(), Vec::new());
        let work = (
            &mut self.computers,
            &mut self.commands,
            &mut self.statuses,
            &mut self.positions_m,
        );
        work.into_par_iter()
            .enumerate()
            .with_min_len(BATCH)
            .map_init(
                scratch,
                |(workspace, cells), (index, (computer, command, status, position_m))| {
                    let body = &world.bodies()[index];
                    let pose = kinematics.pose(world, body, now_units);
                    *position_m = pose.position_m;
                    computer.outbox.clear();
                    *command = Command::Hold;
                    if tick < computer.down_until {
                        (status.mode, status.leader) = (Mode::Fault, RobotId::NOBODY);
                        return 0;
                    }
                    let clock = tick.wrapping_sub(computer.epoch).wrapping_mul(tick_us);
                    // What arrived while it was down, it never heard.
                    let has_just_restarted = computer.boot > 0 && computer.epoch == tick;
                    let inputs = Inputs {
                        pose: pose.into(),
                        cell: Some(CellState {
                            cell: body.cell,
                            busy: busy(body.free_at, now_units, tick_us),
                        }),
                        window: world.window(body.cell, radius, cells),
                        surroundings: None,
                        inbox: if has_just_restarted {
                            &[]
                        } else {
                            radio.inbox(index)
                        },
                    };
                    let agent = &mut computer.agent;
                    let out = agent.step(&inputs, Instant::from_micros(clock), workspace);
                    computer.outbox = out.outbox;
                    *command = out.command;
                    *status = Status {
                        mode: agent.mode(),
                        leader: agent.leader(),
                        target: agent.target().unwrap_or(status.target),
                    };
                    u64::from(out.rejected)
                },
            )
            .sum()
    }

    /// Takes note of where everybody is after phase two.
    fn observe(&mut self) {
        let bodies = self.world.bodies().iter().zip(&self.statuses);
        for (index, (body, status)) in bodies.enumerate() {
            self.chains[index].extend(self.tick, body, status.mode);
            let is_there = status.mode == Mode::Arrived && body.cell == status.target;
            self.arrivals.note(index, is_there, body.free_at);
        }
    }

    /// The swarm's line of the record before the first tick.
    fn first_row(&mut self) -> TickRow {
        let meter = self.meter.as_mut();
        let keeping = meter.map(|meter| meter.look(self.world.bodies()));
        self.row(keeping, PacketCounts::default())
    }

    /// The swarm's line of the record, with `packets` of the tick that is over.
    fn row(&self, keeping: Option<Keeping>, packets: PacketCounts) -> TickRow {
        TickRow {
            tick: self.tick,
            time_s: self.seconds(),
            formation_error_per_agent: keeping.map_or(f64::NAN, |k| k.error_per_agent),
            graph_distance: keeping.map_or(f64::NAN, |k| k.graph_distance),
            packets,
        }
    }

    /// The robots' lines of the record, by rising number, as of now.
    pub fn rows(&self) -> impl Iterator<Item = RobotRow> {
        let now_units = u64::from(self.tick) * u64::from(UNIT);
        let errors = self.meter.as_ref().map_or(&[][..], FormationMeter::errors);
        let bodies = self.world.bodies().iter().zip(&self.statuses);
        bodies.enumerate().map(move |(index, (body, status))| {
            let pose = self.kinematics.pose(&self.world, body, now_units);
            let error = errors.get(index).copied().unwrap_or(f64::NAN);
            RobotRow {
                id: body.id.0,
                cell: body.cell,
                position_m: pose.position_m,
                mode: status.mode,
                leader: status.leader.0,
                target: status.target,
                formation_error_cells: error as f32,
            }
        })
    }

    /// Ticks done.
    #[must_use]
    pub const fn ticks(&self) -> u32 {
        self.tick
    }

    /// Simulated time, seconds.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        f64::from(self.tick) * f64::from(self.tick_us) / 1e6
    }

    /// Whether all robots stand at their targets and know it.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.arrivals.is_complete()
    }

    /// The world.
    #[must_use]
    pub const fn world(&self) -> &World {
        &self.world
    }

    /// What came of it so far.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        Outcome {
            ticks: self.tick,
            seconds: self.seconds(),
            arrived: self.arrivals.count(),
            arrival_times: self.arrivals.times().to_vec(),
            collisions: self.collisions,
            packets: self.packets,
            throttled: self.throttled,
            formation: self.meter.as_ref().and_then(FormationMeter::mean),
            trace_hash: hash::sum(&self.chains),
        }
    }
}

/// Time until a body that is free at `free_at` may leave, at `now_units`; rounded up, so that it is
/// never 0 too early.
fn busy(free_at: u64, now_units: u64, tick_us: u32) -> Duration {
    let left = free_at.saturating_sub(now_units);
    let micros = (left * u64::from(tick_us)).div_ceil(u64::from(UNIT));
    Duration::from_micros(i32::try_from(micros).unwrap_or(i32::MAX))
}

#[cfg(test)]
mod tests;
