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
mod grid;
mod ground;
mod hash;
mod plane;
mod simulate;

pub use grid::Grid;
pub use ground::{Ground, Words};
pub use plane::PlaneGround;
pub use simulate::{Moment, Outcome, simulate};

use crate::metrics::{Arrivals, Keeping};
use crate::radio::Radio;
use crate::record::{PacketCounts, RobotRow, TickRow};
use crate::scenario::{Fault, Robot, Scenario};
use hash::Chain;
use rayon::prelude::*;
use staya_controller::agent::{
    Agent, AgentConfig, Command, Guidance, Inputs, NEIGHBORS, OUTBOX, Safety,
};
use staya_controller::grid::Cell;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::{Mode, RobotId};

/// Robots that a thread takes at least at a time: less would cost more in handing out than in work.
const BATCH: usize = 64;

/// A robot's computer.
#[derive(Debug)]
struct Computer<G, A> {
    agent: Agent<f32, G, NEIGHBORS, A>,
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
pub struct Status {
    /// What it is doing.
    pub mode: Mode,
    /// Whom it follows.
    pub leader: RobotId,
    /// The cell that it heads for.
    pub target: Cell,
}

/// Makes the guidance and the safety layer of a robot by its number in [`Scenario::robots`].
type Brains<G, A> = Box<dyn Fn(usize) -> (G, A) + Send + Sync>;

/// A scenario in motion on ground `W`. `G` is the guidance of all its robots, `A` their safety layer.
pub struct Engine<W, G, A> {
    seed: u64,
    tick_us: u32,
    tick: u32,
    robots: Vec<Robot>,
    faults: Vec<Fault>,
    brains: Brains<G, A>,
    ground: W,
    radio: Radio,
    computers: Vec<Computer<G, A>>,
    commands: Vec<Command<f32>>,
    statuses: Vec<Status>,
    chains: Vec<Chain>,
    positions_m: Vec<[f64; 2]>,
    arrivals: Arrivals,
    collisions: u64,
    packets: PacketCounts,
    throttled: u64,
}

impl<W, G, A> Engine<W, G, A>
where
    W: Ground,
    G: Guidance<f32, Workspace: Default> + Send,
    A: Safety<f32> + Send,
{
    /// The scenario before its first tick, on `ground`. `brains(i)` makes guidance and safety layer of robot number `i` in
    /// [`Scenario::robots`], at its first start and at each restart.
    pub fn new(
        scenario: &Scenario,
        ground: W,
        brains: impl Fn(usize) -> (G, A) + Send + Sync + 'static,
    ) -> Self {
        let robots = scenario.robots.clone();
        let ids = robots.iter().map(|robot| robot.id);
        let mut engine = Self {
            seed: scenario.seed,
            tick_us: scenario.tick_us,
            tick: 0,
            faults: scenario.faults.clone(),
            brains: Box::new(brains),
            radio: Radio::new(&scenario.radio, scenario.seed, scenario.tick_us, ids),
            ground,
            computers: Vec::new(),
            commands: vec![Command::Hold; robots.len()],
            statuses: Vec::new(),
            chains: robots.iter().map(|robot| Chain::new(robot.id)).collect(),
            positions_m: vec![[0.0; 2]; robots.len()],
            arrivals: Arrivals::new(robots.len()),
            collisions: 0,
            packets: PacketCounts::default(),
            throttled: 0,
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
        engine
    }

    /// Computer number `index`, started now.
    fn start(&self, index: usize, boot: u8) -> Computer<G, A> {
        let tick = Duration::from_micros(i32::try_from(self.tick_us).unwrap_or(i32::MAX));
        let mut config = AgentConfig {
            boot,
            ..AgentConfig::new(self.robots[index].id, self.seed, tick)
        };
        self.ground.configure(&mut config);
        let (guidance, safety) = (self.brains)(index);
        let mut agent = Agent::guarded(&config, guidance, safety);
        self.ground.assign(index, self.tick, &mut agent);
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

        self.ground.advance(self.tick, &self.commands);
        self.collisions += self.ground.count_collisions(self.tick);
        self.observe();
        let keeping = self.ground.keeping(true);
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
        let (tick, tick_us) = (self.tick, self.tick_us);
        let (ground, radio) = (&self.ground, &self.radio);
        let orders = ground.orders(tick);
        let scratch = || (G::Workspace::default(), W::Scratch::default(), Vec::new());
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
                |(workspace, senses, heard), (index, (computer, command, status, position_m))| {
                    let [x, y, _] = ground.motion(index, tick).position_m;
                    *position_m = [x, y];
                    computer.outbox.clear();
                    *command = Command::Hold;
                    if tick < computer.down_until {
                        (status.mode, status.leader) = (Mode::Fault, RobotId::NOBODY);
                        return 0;
                    }
                    let clock = tick.wrapping_sub(computer.epoch).wrapping_mul(tick_us);
                    // What arrived while it was down, it never heard.
                    let has_just_restarted = computer.boot > 0 && computer.epoch == tick;
                    let delivered = match has_just_restarted {
                        true => &[],
                        false => radio.inbox(index),
                    };
                    let inbox = match orders {
                        None => delivered,
                        Some(orders) => {
                            heard.clear();
                            heard.extend_from_slice(delivered);
                            heard.extend_from_slice(orders);
                            heard
                        }
                    };
                    let inputs = Inputs {
                        inbox,
                        ..ground.sense(index, tick, senses)
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
        let (ground, tick) = (&self.ground, self.tick);
        for (index, status) in self.statuses.iter().enumerate() {
            self.chains[index].extend(&ground.words(index, tick, status));
            let arrival = ground.arrival(index, tick, status);
            self.arrivals
                .note(index, arrival.is_some(), arrival.unwrap_or(0));
        }
    }

    /// The swarm's line of the record before the first tick.
    fn first_row(&mut self) -> TickRow {
        let keeping = self.ground.keeping(false);
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
        self.statuses
            .iter()
            .enumerate()
            .map(|(index, status)| RobotRow {
                id: self.robots[index].id.0,
                motion: self.ground.motion(index, self.tick),
                mode: status.mode,
                leader: status.leader.0,
                target: status.target,
                formation_error_cells: self.ground.formation_error(index) as f32,
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

    /// The ground with its bodies.
    #[must_use]
    pub const fn ground(&self) -> &W {
        &self.ground
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
            formation: self.ground.mean_keeping(),
            clearance: self.ground.clearance(),
            trace_hash: hash::sum(&self.chains),
        }
    }
}

#[cfg(test)]
mod tests;
