//! The simulation loop, with one [`Agent`] per robot. [`simulate`] runs a whole scenario.
//!
//! A tick ([`Engine::step`]) has two phases. In the first, all robots that are due decide in
//! parallel: by default in each tick, otherwise as the scenario's [`Clocks`] say. Each robot sees
//! only its own pose and cell, the land around it and the bytes that the radio delivered. In the
//! second, the radio transmits the frames and the world moves the bodies. An action therefore
//! affects other robots in the next tick at the earliest, and neither the number of threads nor the
//! order of robots matters.
//!
//! [`Clocks`]: crate::scenario::Clocks

mod attacker;
mod body;
mod checkpoint_interval;
mod clock;
mod decide;
mod external;
mod faults;
mod grid;
mod ground;
#[doc(hidden)]
pub mod hash;
mod inspect;
mod intervene;
mod intruder;
mod key_server;
mod laws;
mod operator;
mod plane;
mod report;
mod roster;
mod safety;
mod simulate;
mod state;
mod status;
mod transmitter;
mod transmitters;
mod witness;

pub use crate::own_law::{Own, OwnLaw, add_law};
pub use crate::world::Misplaced;
pub use checkpoint_interval::CheckpointInterval;
use decide::Tick;
use external::External;
pub use external::{Decision, ExternalController};
pub use grid::Grid;
pub use ground::{AnyGround, Ground, Senses, StateWords, View};
pub use inspect::{Choice, Inspection, Known, Permitted, SeenLand, known};
pub use laws::{Agents, HostLaw, HostSafety, ScenarioLaw, Table, WIDE, WrongWorld, agents, agents_with, own_agents};
pub use operator::{Observation, operated};
pub use plane::PlaneGround;
pub use safety::ScenarioSafety;
pub use simulate::{Moment, Outcome, StartError, Watch, simulate, simulate_from, simulate_own, simulate_with};
pub use state::{Reader, Saves, StateError};
pub use status::{End, EndBody, Status};

use crate::metrics::waits::Waits;
use crate::metrics::{Arrivals, FormationMeters, FormationQuality, Member, in_cells};
use crate::radio::{self, HostWire, Radio};
use crate::record::{Motion, PacketCounts, TickRow};
use crate::scenario::{Fault, Formation, Intervention, Robot, Scenario};
use crate::terrain::change::LandChange;
use crate::world::plane::CommandAge;
use clock::{Clock, Timing};
use hash::StateHash;
use operator::Operator;
use rayon::prelude::*;
use roster::Roster;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{Agent, AgentConfig, Command, Event, NEIGHBORS, Setup, Task};
use staya_controller::neighbor::Tracker;
use staya_controller::robot::RobotId;
use staya_controller::scalar::NumberFormat;
use staya_controller::wire::Ring;
use std::collections::{HashMap, VecDeque};
use std::ops::Range;
pub use transmitter::Transmitter;
use transmitters::transmitters;

/// Smallest number of robots per parallel task; smaller tasks cost more to schedule than to run.
const BATCH: usize = 64;

/// An agent of this process; it has a tracker if the scenario's robots have sensors.
pub type HostAgent = Agent<f32, HostLaw, NEIGHBORS, HostSafety, HostWire, Option<Box<Tracker<f32>>>>;

/// A robot's computer.
#[derive(Debug, Serialize, Deserialize)]
pub struct OnboardComputer {
    /// `None`: the controller is external.
    agent: Option<HostAgent>,
    /// Frames of the last step, without spare capacity.
    #[serde(skip)]
    outbox: Vec<u8>,
    #[serde(skip)]
    events: Vec<Event>,
    /// Bytes that wait for its next decision: those of the operator, and if it is not due, all
    /// that arrive.
    mail: Vec<u8>,
    /// Restarts so far; frames carry the low byte as boot number, as from a counter in flash.
    starts: u32,
    clock: Clock,
    down_until: u32,
    sent_bytes: u64,
    heard_bytes: u64,
}

/// A running scenario. An operator may observe it and command its robots between ticks.
///
/// Robots have the numbers of [`Scenario::robots`]. Fields are public for `staya-mpi`, which steps
/// a part of a world in each process.
pub struct Engine {
    roster: Roster,
    tick_us: u32,
    timing: Timing,
    #[doc(hidden)]
    pub tick: u32,
    /// All robots of the scenario, sorted by id.
    pub robots: Vec<Robot>,
    /// Indices in `robots` of the robots in this process (all, unless other MPI ranks hold some),
    /// in the order of all per-robot lists below.
    pub here: Vec<u32>,
    faults: Vec<Fault>,
    changes: Vec<LandChange>,
    /// Pending interventions, sorted by tick.
    pub interventions: VecDeque<(u32, Intervention)>,
    /// Robot ranges of the formations, whose goals move together.
    shapes: Vec<Range<usize>>,
    #[doc(hidden)]
    pub ground: AnyGround,
    /// Robots have no transmitter.
    is_mute: bool,
    meter: Option<FormationMeters>,
    #[doc(hidden)]
    pub radio: Radio,
    #[doc(hidden)]
    pub computers: Vec<OnboardComputer>,
    #[doc(hidden)]
    pub commands: Vec<Command<f32>>,
    /// Ages of the commands in this tick.
    #[doc(hidden)]
    pub ages: Vec<CommandAge>,
    #[doc(hidden)]
    pub statuses: Vec<Status>,
    #[doc(hidden)]
    pub chains: Vec<StateHash>,
    /// Positions of the robots and the other transmitters, in this order.
    pub positions_m: Vec<[f64; 3]>,
    /// Transmitters outside the swarm.
    pub others: Vec<Box<dyn Transmitter>>,
    /// Keys of robots on other ranks that attackers take over in this tick.
    pub taken: HashMap<RobotId, Ring>,
    external: Option<External>,
    operator: Option<Operator>,
    /// Record row of the last tick.
    row: TickRow,
    #[doc(hidden)]
    pub arrivals: Arrivals,
    #[doc(hidden)]
    pub waits: Waits,
    #[doc(hidden)]
    pub collisions: u64,
    #[doc(hidden)]
    pub packets: PacketCounts,
    #[doc(hidden)]
    pub throttled: u64,
}

impl Engine {
    /// Creates the engine before the first tick of `scenario`. Each start of robot `i` calls
    /// `agents(i)` for its law and safety layer.
    ///
    /// # Errors
    /// Two robots start in one cell, one starts in a wall, or they compute in another number format
    /// than `f32`.
    pub fn new(scenario: &Scenario, agents: Agents) -> Result<Self, Misplaced> {
        if scenario.laws.numbers != NumberFormat::F32 {
            return Err(Misplaced::Numbers(scenario.laws.numbers));
        }
        let here = (0..scenario.robots.len() as u32).collect();
        Ok(Self::part(scenario, AnyGround::new(scenario)?, agents, here, true))
    }

    /// Creates the engine for the robots with the indices `here` in [`Scenario::robots`], whose
    /// bodies `ground` has in this order. With `has_others`, this process also simulates the
    /// transmitters outside the swarm.
    pub fn part(scenario: &Scenario, ground: AnyGround, agents: Agents, here: Vec<u32>, has_others: bool) -> Self {
        let robots = scenario.robots.clone();
        let intruders = ground.view(0).intruders;
        let others = if has_others { transmitters(scenario, intruders) } else { Vec::new() };
        let ids = here.iter().map(|&number| robots[number as usize].id);
        let ids = ids.chain(others.iter().map(|other| other.id()));
        let mut positions_m = vec![[0.0; 3]; here.len()];
        positions_m.extend(others.iter().map(|other| other.place_m(intruders)));
        let mut engine = Self {
            roster: Roster::new(scenario, agents),
            tick_us: scenario.tick_us,
            timing: Timing::new(scenario),
            tick: 0,
            faults: scenario.events.faults.clone(),
            changes: scenario.land.changes.clone(),
            interventions: scenario.events.interventions.iter().cloned().collect(),
            shapes: scenario.formations.iter().map(Formation::members).collect(),
            is_mute: scenario.sensing().is_some_and(|sensing| !sensing.has_beacons),
            meter: FormationMeters::new(scenario),
            radio: Radio::new(&scenario.radio, scenario.seed, scenario.tick_us, ids)
                .on_torus(scenario.torus_m())
                .with_keys(scenario.key().is_some()),
            ground,
            computers: Vec::new(),
            commands: vec![Command::Hold; here.len()],
            ages: vec![CommandAge::default(); here.len()],
            statuses: Vec::new(),
            chains: here.iter().map(|&number| StateHash::new(robots[number as usize].id)).collect(),
            positions_m,
            others,
            taken: HashMap::new(),
            external: None,
            operator: None,
            row: TickRow::default(),
            arrivals: Arrivals::new(here.len()),
            waits: Waits::new(here.len()),
            collisions: 0,
            packets: PacketCounts::default(),
            throttled: 0,
            robots,
            here,
        };
        let computers = engine.here.iter().enumerate().map(|(index, &number)| {
            let clock = engine.timing.first(scenario, number as usize);
            OnboardComputer { clock, ..engine.start(index, 0) }
        });
        engine.computers = computers.collect();
        engine.statuses = engine.here.iter().map(|&number| Status::before(&engine.robots[number as usize])).collect();
        engine
    }

    fn id(&self, index: usize) -> RobotId {
        self.robots[self.number(index)].id
    }

    fn number(&self, index: usize) -> usize {
        self.here[index] as usize
    }

    fn setup(&self, index: usize, starts: u32) -> (AgentConfig<f32>, Task) {
        let (config, task) = self.ground.setup(self.number(index), self.tick);
        (self.roster.config(config, starts), task)
    }

    fn start(&self, index: usize, starts: u32) -> OnboardComputer {
        let (config, task) = self.setup(index, starts);
        let previous = self.computers.get(index).and_then(|computer| computer.agent.as_ref());
        let agent = self.roster.agent(self.number(index), (&config, starts), &task, previous);
        self.computer(Some(agent), starts)
    }

    #[doc(hidden)]
    pub fn computer(&self, agent: Option<HostAgent>, starts: u32) -> OnboardComputer {
        OnboardComputer {
            agent,
            outbox: Vec::new(),
            events: Vec::new(),
            mail: Vec::new(),
            starts,
            clock: Clock::new(self.tick),
            down_until: self.tick,
            sent_bytes: 0,
            heard_bytes: 0,
        }
    }

    fn restart(&mut self, index: usize, starts: u32) {
        self.ground.forget(index);
        let (config, task) = self.setup(index, starts);
        let robots = self.external.as_mut().and_then(|external| {
            let found = external.robots.iter().find(|(robot, ..)| *robot == index);
            let (_, law, safety) = found?;
            let setup = Setup { agent: config, law: law.clone(), safety: *safety, format: self.roster.format };
            external.controllers.start(index, setup, task);
            Some(())
        });
        self.computers[index] = match robots {
            Some(()) => self.computer(None, starts),
            None => self.start(index, starts),
        };
    }

    /// Runs one tick. Returns the swarm's record row.
    pub fn step(&mut self) -> TickRow {
        self.change_land();
        self.apply_interventions();
        self.apply_faults();
        let refused = self.decide();
        self.transmit();
        let sent = self.send();
        let land = self.ground.view(self.tick).terrain;
        let carried = self.radio.receive(self.tick, &self.positions_m, land, &[], sent);
        let packets = self.count(refused, carried);

        self.collisions += self.ground.advance(self.tick, &self.commands, &self.ages);
        self.observe();
        let members: Vec<_> = self.members().collect();
        let quality = self.formation_quality(&members, true);
        self.tick += 1;
        #[cfg(test)]
        self.check_gaps();
        self.row = self.row(quality, packets);
        self.row
    }

    /// Members of formations in this process; none if there is no formation.
    pub fn members(&self) -> impl Iterator<Item = Member> {
        let view = self.ground.view(self.tick);
        let cell_m = view.terrain.map(|land| land.cell_m).filter(|_| self.meter.is_some());
        let has_bodies = view.clearance.is_some();
        let indices = cell_m.into_iter().flat_map(|cell_m| (0..self.here.len()).map(move |index| (index, cell_m)));
        indices.map(move |(index, cell_m)| {
            let Motion { cell, position_m: [x, y, _], .. } = self.ground.motion(index, self.tick);
            let at = if has_bodies { [x / cell_m, y / cell_m] } else { in_cells(cell) };
            Member { at, is_down: self.is_down(index) }
        })
    }

    /// Quality of the formations, if any; `members` are those of all processes, in the order of
    /// robots. `counts` adds it to the run's statistics.
    pub fn formation_quality(&mut self, members: &[Member], counts: bool) -> Option<FormationQuality> {
        let meter = self.meter.as_mut().filter(|_| !members.is_empty())?;
        Some(if counts { meter.measure(members) } else { meter.look(members) })
    }

    /// Transmits the frames of this process.
    pub fn send(&mut self) -> radio::Counts {
        let (computers, others) = (&self.computers, &self.others);
        let outbox = |index: usize| match computers.get(index) {
            Some(computer) => computer.outbox.as_slice(),
            None => others[index - computers.len()].outbox(),
        };
        self.radio.send(self.tick, &self.positions_m, outbox)
    }

    /// Adds a tick's packets to the totals.
    pub fn count(&mut self, refused: PacketCounts, carried: radio::Counts) -> PacketCounts {
        let packets = PacketCounts {
            sent: carried.sent,
            delivered: carried.delivered,
            lost: carried.lost,
            damaged: carried.damaged,
            ..refused
        };
        self.packets += packets;
        self.throttled += carried.throttled;
        packets
    }

    /// First phase: the robots that are due decide. Returns the numbers of refused frames only.
    pub fn decide(&mut self) -> PacketCounts {
        self.send_out();
        let mut refused = self.decide_here();
        refused.rejected += self.collect();
        refused
    }

    /// Records the state of all robots after the second phase.
    pub fn observe(&mut self) {
        let (ground, tick, statuses) = (&*self.ground, self.tick, &self.statuses);
        let chains = self.chains.par_iter_mut().enumerate().with_min_len(BATCH);
        chains.for_each(|(index, chain)| chain.extend(&ground.words(index, tick, &statuses[index])));
        self.arrivals.note(|index| ground.arrival(index, tick, &statuses[index]));
        for (index, status) in statuses.iter().enumerate() {
            self.waits.note(index, status.wait);
        }
    }
}

#[cfg(test)]
mod tests;
