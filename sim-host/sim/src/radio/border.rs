//! Transmission of packets between MPI ranks.

use super::{BLOCK, Counts, End, Inboxes, Radio, Receiver};
use crate::terrain::Terrain;
use serde::{Deserialize, Serialize};
use staya_controller::robot::RobotId;

/// A transmitted packet, in the form sent to other ranks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sent {
    pub(crate) sender: RobotId,
    /// Index among the sender's packets of this tick, throttled packets included.
    pub(crate) number: u32,
    pub(crate) from_m: [f64; 3],
    pub(crate) bytes: Vec<u8>,
}

impl Radio {
    /// First half of [`Radio::carry`]: transmits the packets of this rank.
    pub(crate) fn send<'a>(
        &mut self,
        tick: u32,
        positions_m: &[[f64; 3]],
        outbox: impl Fn(usize) -> &'a [u8],
    ) -> Counts {
        let positions_m = &positions_m[..self.receivers.len()];
        let outboxes: Vec<_> = (0..self.receivers.len()).map(outbox).collect();
        let receivers = &self.receivers;
        self.medium.fill(tick, |index| receivers[index].id, positions_m, &outboxes)
    }

    /// Packets of this rank that other ranks need, selected by their position.
    pub fn sent(&self, is_heard: impl Fn([f64; 3]) -> bool) -> impl Iterator<Item = Sent> {
        self.medium.sent().filter(move |(packet, _)| is_heard(packet.from_m)).map(|(packet, bytes)| Sent {
            sender: packet.sender,
            number: packet.number,
            from_m: packet.from_m,
            bytes: bytes.to_vec(),
        })
    }

    /// Second half of [`Radio::carry`]: delivers packets of this rank and from `elsewhere`; `land`
    /// may stand in the way.
    pub fn receive(
        &mut self,
        tick: u32,
        positions_m: &[[f64; 3]],
        land: Option<&Terrain>,
        elsewhere: &[Sent],
        sent: Counts,
    ) -> Counts {
        if !self.receivers.is_empty() {
            self.medium.add(tick, elsewhere);
        }
        self.deliver(tick, positions_m, land, sent)
    }

    /// Replaces the packet totals and returns the previous ones.
    pub const fn replace_total(&mut self, total: Counts) -> Counts {
        std::mem::replace(&mut self.total, total)
    }

    /// Farthest distance at which a packet can be received, metres.
    pub const fn range_m(&self) -> f64 {
        self.medium.range_m()
    }

    /// Inserts a receiver with an empty inbox at `index`; later indices increase by one.
    pub fn admit(&mut self, index: usize, id: RobotId) {
        let behind = self.take_from(index);
        self.push(id, None);
        behind.into_iter().for_each(|(id, end)| self.push(id, Some(end)));
    }

    /// Removes receiver `index`. The last of the first `robots` receivers takes its index; the
    /// indices of receivers after them decrease by one.
    pub fn dismiss(&mut self, index: usize, robots: usize) {
        let mut behind = self.take_from(robots - 1).into_iter();
        if let Some((id, end)) = behind.next()
            && index + 1 < robots
        {
            self.receivers[index] = Receiver { id, ..Receiver::default() };
            self.put(index, end);
        }
        behind.for_each(|(id, end)| self.push(id, Some(end)));
    }

    fn take_from(&mut self, index: usize) -> Vec<(RobotId, End)> {
        let bytes = |index| postcard::to_stdvec(&self.end(index)).expect("memory takes every byte");
        let end = |index| postcard::from_bytes(&bytes(index)).expect("these bytes are an end");
        let taken = (index..self.receivers.len()).map(|index| (self.receivers[index].id, end(index))).collect();
        self.receivers.truncate(index);
        self.resize();
        taken
    }

    fn push(&mut self, id: RobotId, end: Option<End>) {
        self.receivers.push(Receiver { id, ..Receiver::default() });
        self.resize();
        if let Some(end) = end {
            self.put(self.receivers.len() - 1, end);
        }
    }

    fn resize(&mut self) {
        self.medium.resize(self.receivers.len());
        self.inboxes.resize_with(self.receivers.len().div_ceil(BLOCK), Inboxes::default);
    }

    fn put(&mut self, index: usize, end: End) {
        self.set_end(index, end).expect("it is of this radio");
    }
}
