//! Checkpoints of a run on ranks. Their bytes equal those of a run on one process, so either can
//! continue the other's, on any number of ranks.

use super::exchange::{RankError, decode, encode};
use super::ground::part_mut;
use super::outcome::{Part, nothing};
use super::run::Rank;
use serde::{Deserialize, Serialize};
use staya_controller::agent::Wait;
use staya_controller::names::Named;
use staya_sim::engine::{Engine, Saves, StateError};
use staya_sim::metrics::waits::WaitCount;
use staya_sim::radio::Counts;
use staya_sim::record::PacketCounts;
use staya_sim::world::plane::Clearance;

pub(super) struct Saved(Vec<u8>);

impl Saves for Saved {
    fn save(&self, bytes: &mut Vec<u8>) -> Result<(), StateError> {
        bytes.extend_from_slice(&self.0);
        Ok(())
    }
}

#[derive(Serialize, Deserialize)]
struct Share {
    part: Part,
    radio: Counts,
    digest: u64,
    /// State of each robot, with its index in the scenario.
    robots: Vec<(u32, Vec<u8>)>,
}

struct Totals {
    collisions: u64,
    packets: PacketCounts,
    throttled: u64,
    waited: Vec<(u64, u32)>,
    radio: Counts,
    clearance: Clearance,
}

impl Totals {
    fn none() -> Self {
        Self {
            collisions: 0,
            packets: PacketCounts::default(),
            throttled: 0,
            waited: vec![(0, 0); Wait::NAMES.len()],
            radio: Counts::default(),
            clearance: Clearance::FREE,
        }
    }

    fn exchange(self, engine: &mut Engine) -> Self {
        let waited = engine.waits.ticks();
        engine.waits.set_ticks(&self.waited);
        Self {
            collisions: std::mem::replace(&mut engine.collisions, self.collisions),
            packets: std::mem::replace(&mut engine.packets, self.packets),
            throttled: std::mem::replace(&mut engine.throttled, self.throttled),
            waited,
            radio: engine.radio.replace_total(self.radio),
            clearance: part_mut(&mut engine.ground).replace_clearance(self.clearance),
        }
    }
}

impl Rank<'_> {
    pub(super) fn save(&mut self) -> Result<Option<Saved>, RankError> {
        let engine = &self.engine;
        let robots = engine.here.iter().enumerate().map(|(index, &number)| {
            let mut bytes = Vec::new();
            engine.pack(index, &mut bytes);
            (number, bytes)
        });
        let robots = robots.collect();
        let share = Share { part: Part::of(engine), radio: engine.radio.total(), digest: engine.digest(), robots };
        let heard = self.wire.gather_first(encode(&share))?;
        if heard.is_empty() {
            return Ok(None);
        }
        let (mut robots, mut digest, mut radio) = (Vec::new(), 0_u64, Counts::default());
        let mut whole = nothing(self.engine.view().clearance.is_some());
        for (rank, bytes) in heard.iter().enumerate() {
            let share = decode::<Share>(rank, "its part of a checkpoint", bytes)?;
            share.part.add_to(&mut whole);
            robots.extend(share.robots);
            digest = digest.wrapping_add(share.digest);
            radio += share.radio;
        }
        robots.sort_unstable_by_key(|&(number, _)| number);
        let ticks = |&(_, wait): &(&str, Wait)| {
            let count = whole.waits.iter().find(|count: &&WaitCount| count.wait == wait);
            count.map_or((0, 0), |count| (count.robot_ticks, count.longest_ticks))
        };
        let totals = Totals {
            collisions: whole.collisions,
            packets: whole.packets,
            throttled: whole.throttled,
            waited: Wait::NAMES.iter().map(ticks).collect(),
            radio,
            clearance: whole.clearance.unwrap_or(Clearance::FREE),
        };
        // The head must contain the statistics of the whole run.
        let own = totals.exchange(&mut self.engine);
        let mut bytes = Vec::new();
        self.engine.save_head(&mut bytes);
        own.exchange(&mut self.engine);
        for (_, robot) in robots {
            bytes.extend_from_slice(&robot);
        }
        bytes.extend(encode(&digest));
        Ok(Some(Saved(bytes)))
    }

    /// Each rank takes its own robots, rank 0 the statistics.
    pub(super) fn restore(&mut self, bytes: &[u8]) -> Result<(), RankError> {
        let restored = self.engine.restore_part(bytes);
        if self.wire.rank() > 0 {
            Totals::none().exchange(&mut self.engine);
        }
        // A rank that cannot restore reports it to all, so that none waits.
        let own = restored.as_ref().ok().map(|_| self.engine.digest());
        let mut digest = Some(0_u64);
        for (rank, bytes) in self.wire.gather(encode(&own))?.iter().enumerate() {
            let theirs = decode::<Option<u64>>(rank, "a digest", bytes)?;
            digest = digest.zip(theirs).map(|(sum, one)| sum.wrapping_add(one));
        }
        let (at, saved) = restored?;
        if digest == Some(saved) { self.tell_region() } else { Err(Engine::differs(at).into()) }
    }
}
