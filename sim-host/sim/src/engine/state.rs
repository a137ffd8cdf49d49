//! Saves and restores single robots and whole runs, in postcard format. The bytes contain keys.
//! Constant data is not saved: restore into an engine of the same scenario and program version.

use super::laws::shared_map;
use super::{Engine, OnboardComputer, Status};
use crate::engine::hash::StateHash;
use crate::engine::roster::Tuned;
use crate::metrics::{FormationMeters, waits};
use crate::radio::{End, Weather};
use crate::record::PacketCounts;
use crate::scenario::Fault;
use rayon::prelude::*;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{Agent, Command, MAP_TILES};
use staya_controller::land::LandMap;
use staya_controller::robot::RobotId;
use std::collections::HashMap;
use std::fmt;
use thiserror::Error;

/// A run that can be saved, and that shows what its robots know.
pub trait Saves {
    /// Appends the state of the run; see [`Engine::save`].
    ///
    /// # Errors
    /// See [`Engine::save`].
    fn save(&self, bytes: &mut Vec<u8>) -> Result<(), StateError>;

    /// The robots that robot `index` knows and does not count as lost. By default there are none.
    fn known(&self, index: usize) -> Vec<RobotId> {
        let _ = index;
        Vec::new()
    }

    /// Calls `each` with the map of every robot of this process that shares one, by index. By
    /// default there are none.
    fn shared_maps(&self, each: &mut dyn FnMut(&LandMap<MAP_TILES>)) {
        let _ = each;
    }
}

impl fmt::Debug for dyn Saves + '_ {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("run")
    }
}

impl Saves for Engine {
    fn save(&self, bytes: &mut Vec<u8>) -> Result<(), StateError> {
        Self::save(self, bytes)
    }

    fn known(&self, index: usize) -> Vec<RobotId> {
        Self::known(self, index)
    }

    fn shared_maps(&self, each: &mut dyn FnMut(&LandMap<MAP_TILES>)) {
        let agents = self.computers.iter().filter_map(|computer| computer.agent.as_ref());
        agents.filter_map(|agent| shared_map(agent.law())).for_each(each);
    }
}

/// The bytes are not a state, or not a state of this engine.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("byte {at}: {what}; {remedy}")]
pub struct StateError {
    /// Position in the bytes, from 0.
    pub at: usize,
    what: String,
    remedy: &'static str,
}

const REMEDY: &str = "take another checkpoint, or restart the run";
const SAME: &str = "restore it with the scenario, and the program, that made it";

impl StateError {
    fn new(at: usize, what: impl Into<String>, remedy: &'static str) -> Self {
        Self { at, what: what.into(), remedy }
    }

    /// Shifts the position by the number of bytes before this section.
    #[must_use]
    pub fn after(self, bytes: usize) -> Self {
        Self { at: self.at.saturating_add(bytes), ..self }
    }
}

/// Reads values in postcard format, with the position of errors.
pub struct Reader<'a> {
    all: &'a [u8],
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    const fn new(all: &'a [u8]) -> Self {
        Self { all, rest: all }
    }

    const fn at(&self) -> usize {
        self.all.len() - self.rest.len()
    }

    pub(super) fn read<T: DeserializeOwned>(&mut self, what: &str) -> Result<T, StateError> {
        let mut from = postcard::Deserializer::from_bytes(self.rest);
        let value = T::deserialize(&mut from);
        // Position at which decoding stopped; the start if it is unknown.
        let rest = from.finalize().unwrap_or(self.rest);
        let stopped_at = self.all.len() - rest.len();
        match value {
            Ok(value) => {
                self.rest = rest;
                Ok(value)
            }
            Err(postcard::Error::DeserializeUnexpectedEnd) => {
                let what = format!("{what} is cut off");
                Err(StateError::new(self.all.len(), what, REMEDY))
            }
            Err(_) => Err(StateError::new(stopped_at, format!("{what} makes no sense"), REMEDY)),
        }
    }

    /// The error for values that this engine cannot have.
    pub(super) fn unfit(&self, what: &'static str) -> StateError {
        StateError::new(self.at(), what, SAME)
    }
}

pub(super) fn write(value: &impl Serialize, bytes: &mut Vec<u8>) {
    // Cannot fail: all sequences have a length, and a `Vec` accepts every byte.
    let done = postcard::to_extend(value, std::mem::take(bytes));
    *bytes = done.expect("states have a form");
}

/// A robot apart from its number, its body and its radio; the last fields are those of its record.
type RobotState = (OnboardComputer, Status, StateHash, Command<f32>, Option<u64>, waits::Robot);

#[derive(Serialize, Deserialize)]
struct Whole {
    seed: u64,
    robots: usize,
    tick: u32,
    interventions: usize,
    faults: Vec<Fault>,
    tuned: Vec<Tuned>,
    collisions: u64,
    packets: PacketCounts,
    throttled: u64,
    waited: Vec<(u64, u32)>,
    weather: Weather,
    meter: Option<FormationMeters>,
}

impl Engine {
    /// Appends the mutable state of robot `index`: body, computer with agent and mail, hash,
    /// statistics and radio. Call it between ticks. O(bytes).
    ///
    /// # Panics
    /// If `index` is out of range.
    pub fn pack(&self, index: usize, bytes: &mut Vec<u8>) {
        let record = (self.arrivals.times()[index], self.waits.robot(index));
        let decided = (self.statuses[index], self.chains[index], &self.commands[index]);
        write(&(self.id(index), &self.computers[index], decided, record), bytes);
        self.ground.save_body(index, bytes);
        write(&self.radio.end(index), bytes);
    }

    /// Restores a robot from the bytes of [`Engine::pack`] in an engine of the same scenario, and
    /// returns how many it read. Until all robots are restored, two may be in one cell. O(bytes).
    ///
    /// # Errors
    /// The bytes are damaged or belong to another robot. The robot may then be partly restored.
    ///
    /// # Panics
    /// If `index` is out of range.
    pub fn unpack(&mut self, index: usize, bytes: &[u8]) -> Result<usize, StateError> {
        let mut from = Reader::new(bytes);
        let own = self.id(index);
        let id: RobotId = from.read("the number of a robot")?;
        if id != own {
            let what = format!("this is robot {}, not robot {}", id.0, own.0);
            return Err(StateError::new(0, what, SAME));
        }
        let (computer, status, chain, command, arrived, waits): RobotState = from.read("a robot")?;
        let number = self.number(index);
        self.ground.load_body(number, Some(index), &mut from)?;
        let end: End = from.read("an end of the radio")?;
        self.radio.set_end(index, end).map_err(|what| from.unfit(what))?;
        self.computers[index] = computer;
        (self.statuses[index], self.chains[index], self.commands[index]) = (status, chain, command);
        self.arrivals.set(index, arrived);
        self.waits.set_robot(index, waits);
        Ok(from.at())
    }

    /// Appends the whole run as it is between two ticks. O(bytes).
    ///
    /// # Errors
    /// Some robots have external controllers.
    pub fn save(&self, bytes: &mut Vec<u8>) -> Result<(), StateError> {
        if self.external.is_some() {
            return Err(StateError::new(bytes.len(), "some robots run elsewhere", "run all of them here"));
        }
        self.save_head(bytes);
        for index in 0..self.here.len() {
            self.pack(index, bytes);
        }
        write(&self.digest(), bytes);
        Ok(())
    }

    /// Writes the shared state and the transmitters outside the swarm; see [`Engine::save`].
    pub fn save_head(&self, bytes: &mut Vec<u8>) {
        let whole = Whole {
            seed: self.roster.seed,
            robots: self.robots.len(),
            tick: self.tick,
            interventions: self.interventions.len(),
            faults: self.faults.clone(),
            tuned: self.roster.tuned.clone(),
            collisions: self.collisions,
            packets: self.packets,
            throttled: self.throttled,
            waited: self.waits.ticks(),
            weather: self.radio.weather(),
            meter: self.meter.clone(),
        };
        write(&whole, bytes);
        self.ground.save_shared(bytes);
        let others = (self.here.len()..).zip(&self.others).map(|(end, other)| {
            let mut bytes = Vec::new();
            other.save(&mut bytes);
            write(&self.radio.end(end), &mut bytes);
            bytes
        });
        write(&others.collect::<Vec<_>>(), bytes);
    }

    /// Restores [`Engine::save`] in an engine of the same scenario before its first tick.
    ///
    /// # Errors
    /// The bytes are damaged or from another scenario or program. Discard the engine then.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), StateError> {
        let (at, digest) = self.restore_part(bytes)?;
        if digest == self.digest() { Ok(()) } else { Err(Self::differs(at)) }
    }

    /// Restores the robots and transmitters of this process. Returns position and value of the
    /// saved digest.
    pub fn restore_part(&mut self, bytes: &[u8]) -> Result<(usize, u64), StateError> {
        let mut from = Reader::new(bytes);
        if self.tick > 0 || self.external.is_some() {
            return Err(StateError::new(0, "this run is under way", "restore into one before its first tick"));
        }
        let whole: Whole = from.read("the head of the run")?;
        if (whole.seed, whole.robots) != (self.roster.seed, self.robots.len()) {
            let what = format!("it is of {} robots and seed {}", whole.robots, whole.seed);
            return Err(StateError::new(0, what, SAME));
        }
        let is_same = match (&self.meter, &whole.meter) {
            (Some(meter), Some(measured)) => meter.is_of(measured),
            (None, None) => true,
            _ => false,
        };
        if !is_same {
            return Err(StateError::new(0, "it is of another formation", SAME));
        }
        self.meter = whole.meter;
        self.ground.load_shared(&mut from)?;
        self.tick = whole.tick;
        let done = self.interventions.len().saturating_sub(whole.interventions);
        self.interventions.drain(..done);
        (self.faults, self.roster.tuned) = (whole.faults, whole.tuned);
        (self.collisions, self.packets, self.throttled) = (whole.collisions, whole.packets, whole.throttled);
        self.waits.set_ticks(&whole.waited);
        self.radio.set_weather(whole.weather);
        let others: Vec<Vec<u8>> = from.read("the transmitters")?;
        // Other MPI ranks may have the transmitters.
        if !self.others.is_empty() && self.others.len() != others.len() {
            return Err(from.unfit("it has other transmitters"));
        }
        let at = from.at().saturating_sub(others.iter().map(Vec::len).sum());
        for ((end, other), bytes) in (self.here.len()..).zip(&mut self.others).zip(&others) {
            let mut from = Reader::new(bytes);
            other.load(&mut from).map_err(|error| error.after(at))?;
            let state: End = from.read("an end of the radio").map_err(|error| error.after(at))?;
            self.radio.set_end(end, state).map_err(|what| from.unfit(what).after(at))?;
        }
        let here: HashMap<usize, usize> = (0..self.here.len()).map(|index| (self.number(index), index)).collect();
        for number in 0..self.robots.len() {
            let at = from.at();
            let read = match here.get(&number) {
                Some(&index) => self.unpack(index, from.rest),
                None => self.skip(number, from.rest),
            };
            from.rest = &from.rest[read.map_err(|error| error.after(at))?..];
        }
        let at = from.at();
        let digest: u64 = from.read("the digest of the robots")?;
        if !self.ground.is_sound() || !from.rest.is_empty() {
            return Err(StateError::new(at, "what was restored is not what was saved", SAME));
        }
        Ok((at, digest))
    }

    /// Returns the number of bytes read.
    fn skip(&mut self, number: usize, bytes: &[u8]) -> Result<usize, StateError> {
        let mut from = Reader::new(bytes);
        let _: (RobotId, RobotState) = from.read("a robot")?;
        self.ground.load_body(number, None, &mut from)?;
        let _: End = from.read("an end of the radio")?;
        Ok(from.at())
    }

    /// The error for a digest mismatch after restoring.
    pub fn differs(at: usize) -> StateError {
        StateError::new(at, "what was restored is not what was saved", SAME)
    }

    /// Digest of all agents.
    pub fn digest(&self) -> u64 {
        let agents = self.computers.par_iter().filter_map(|computer| computer.agent.as_ref());
        agents.map(Agent::digest).reduce(|| 0, u64::wrapping_add)
    }
}
