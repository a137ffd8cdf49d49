//! The operator's key server: sends the swarm's next key to each robot, encrypted with the robot's
//! own key, and collects confirmations.

use super::state::{Reader, StateError, write};
use super::transmitter::Transmitter;
use crate::radio;
use crate::scenario::{Roll, Scenario};
use crate::world::plane::Disc;
use staya_controller::auth::Master;
use staya_controller::robot::RobotId;
use staya_controller::wire::{KeyPhase, OperatorWire, Postcard, Wire as _};
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// Steps of the robots between two attempts to reach robots that have not answered.
const AGAIN_STEPS: u32 = 5;
/// Attempts after which all robots are contacted again, since one of them may have restarted.
const ROUNDS: u32 = 20;

pub(super) struct KeyServer {
    wire: OperatorWire<{ radio::PEERS }>,
    place_m: [f64; 2],
    robots: Vec<RobotId>,
    rolls: VecDeque<Roll>,
    revoked: BTreeSet<RobotId>,
    generation: u16,
    phase: KeyPhase,
    /// Tick at which this phase ends even without all confirmations.
    until: u32,
    overlap_ticks: u32,
    again_ticks: u32,
    held: BTreeMap<RobotId, (u16, KeyPhase)>,
    outbox: Vec<u8>,
}

impl KeyServer {
    /// The key server of a scenario; `None` if robots have no keys of their own.
    pub(super) fn new(scenario: &Scenario) -> Option<Self> {
        let keeping = scenario.key_rotation()?;
        let (_, id) = radio::operator(scenario.radio.format, scenario.key(), 1);
        let wire = OperatorWire::at_start(Master::new(&keeping.master), id, 0)?;
        Some(Self {
            wire,
            place_m: keeping.place_m,
            robots: scenario.numbered().iter().map(|robot| robot.id).collect(),
            rolls: keeping.rolls.iter().cloned().collect(),
            revoked: BTreeSet::new(),
            generation: 0,
            phase: KeyPhase::Forget,
            until: 0,
            overlap_ticks: keeping.overlap_ticks,
            again_ticks: AGAIN_STEPS.saturating_mul(scenario.clocks.step_ticks),
            held: BTreeMap::new(),
            outbox: Vec::new(),
        })
    }
}

impl Transmitter for KeyServer {
    /// It never appears in a frame.
    fn id(&self) -> RobotId {
        RobotId(u32::MAX - 1_000_000)
    }

    fn place_m(&self, _: &[Disc]) -> [f64; 3] {
        let [x, y] = self.place_m;
        [x, y, 0.0]
    }

    fn outbox(&self) -> &[u8] {
        &self.outbox
    }

    fn save(&self, bytes: &mut Vec<u8>) {
        let Self { wire, rolls, revoked, generation, phase, until, held, .. } = self;
        write(&(wire, rolls.len(), (revoked, generation, phase, until, held)), bytes);
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
        let (wire, rolls_left, rest): (Box<_>, usize, _) = from.read("the key server")?;
        self.wire = *wire;
        self.rolls.drain(..self.rolls.len().saturating_sub(rolls_left));
        (self.revoked, self.generation, self.phase, self.until, self.held) = rest;
        Ok(())
    }

    fn act(&mut self, tick: u32, inbox: &[u8], _: &[Disc]) {
        self.outbox.clear();
        let mut rest = inbox;
        while let Some(frame) = Postcard.next_frame(&mut rest) {
            if let Ok((robot, held)) = self.wire.hear(frame) {
                self.held.insert(robot, (held.generation, held.phase));
            }
        }
        while let Some(roll) = self.rolls.front().filter(|roll| roll.tick <= tick) {
            self.revoked.extend(roll.revoke.iter().copied());
            self.rolls.pop_front();
            (self.generation, self.phase) = (self.generation + 1, KeyPhase::Hear);
            self.until = tick + self.overlap_ticks;
        }
        if self.generation == 0 {
            return;
        }
        let wanted = (self.generation, self.phase);
        let is_done = |robot: &RobotId| self.held.get(robot).is_some_and(|held| *held >= wanted);
        let all: Vec<_> = self.robots.iter().copied().filter(|robot| !self.revoked.contains(robot)).collect();
        if (all.iter().all(is_done) || tick >= self.until) && self.phase != KeyPhase::Forget {
            self.phase = if self.phase == KeyPhase::Hear { KeyPhase::Speak } else { KeyPhase::Forget };
            self.until = tick + self.overlap_ticks;
            return;
        }
        if !tick.is_multiple_of(self.again_ticks) {
            return;
        }
        let tells_all = tick.is_multiple_of(self.again_ticks.saturating_mul(ROUNDS));
        let late = all.iter().filter(|robot| tells_all || !is_done(robot));
        let mut frame = heapless::Vec::<u8, 64>::new();
        for &robot in late {
            frame.clear();
            if self.wire.send_key(robot, self.generation, self.phase, &mut frame).is_ok() {
                self.outbox.extend_from_slice(&frame);
            }
        }
    }
}
