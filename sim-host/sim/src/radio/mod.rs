//! The radio: transmits bytes between robots, and loses, delays, duplicates and damages them.
//!
//! A packet is a frame of the robots' wire format, with its delimiter if there is one. Only bit
//! errors and bandwidth depend on its bytes. All random effects on a packet are a function of
//! (seed, tick, sender, number within the tick, receiver), so that neither threads nor the order of
//! robots matter.

mod border;
mod fate;
mod medium;
mod params;
mod state;
mod wire;

#[doc(hidden)]
pub use border::Sent;
pub use params::{Burst, RadioParams};
pub(crate) use state::{End, Weather};
pub use wire::{HostWire, PEERS, operator, own_wire, ring_wire, wire};

use fate::{Fates, Verdict};
use medium::Medium;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use staya_controller::robot::RobotId;
use std::ops::{Add, AddAssign, Range};

/// Packet statistics; receptions are counted per receiver in range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Transmitted packets.
    pub sent: u64,
    /// Packets that exceeded a robot's bandwidth and were not transmitted.
    pub throttled: u64,
    /// Receptions, duplicates included.
    pub delivered: u64,
    /// Failed receptions: loss, bursts, blackouts.
    pub lost: u64,
    /// Receptions with at least one flipped bit; also counted as delivered.
    pub corrupted: u64,
}

impl Add for Counts {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            sent: self.sent + other.sent,
            throttled: self.throttled + other.throttled,
            delivered: self.delivered + other.delivered,
            lost: self.lost + other.lost,
            corrupted: self.corrupted + other.corrupted,
        }
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

/// A delayed packet at one receiver. Arrivals are ordered by time, then by sender.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
struct Held {
    due_us: u64,
    sender: RobotId,
    sent: u32,
    number: u32,
    copy: u32,
    start: u32,
    length: u32,
}

#[derive(Clone, Debug, Default)]
struct Receiver {
    id: RobotId,
    /// Range of its inbox in its block's [`Inboxes`].
    inbox: Range<u32>,
    late: Option<Box<Late>>,
    log: Option<Vec<(RobotId, Reception)>>,
}

#[derive(Clone, Debug, Default)]
struct Late {
    held: Vec<Held>,
    bytes: Vec<u8>,
    /// Receives the bytes of packets that remain; swapped with `bytes`.
    spare: Vec<u8>,
}

const BLOCK: usize = 64;

type Inboxes = Vec<u8>;

/// Fate of one packet at one receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reception {
    /// Received, now or later.
    Delivered,
    /// Not received.
    Lost,
    /// Received with flipped bits.
    Damaged,
}

/// The radio of a swarm.
#[derive(Clone, Debug)]
pub struct Radio {
    fates: Fates,
    medium: Medium,
    receivers: Vec<Receiver>,
    inboxes: Vec<Inboxes>,
    total: Counts,
}

impl Radio {
    /// Creates the radio for these robots with ticks of `tick_us` microseconds.
    #[must_use]
    pub fn new(params: &RadioParams, seed: u64, tick_us: u32, robots: impl IntoIterator<Item = RobotId>) -> Self {
        let receivers: Vec<_> = robots.into_iter().map(|id| Receiver { id, ..Receiver::default() }).collect();
        Self {
            fates: Fates::new(params, seed, tick_us),
            medium: Medium::new(params, seed, tick_us, receivers.len()),
            inboxes: vec![Inboxes::new(); receivers.len().div_ceil(BLOCK)],
            receivers,
            total: Counts::default(),
        }
    }

    /// Places the radio on a torus with these sides, metres: packets cross its borders.
    #[must_use]
    pub const fn on_torus(mut self, torus_m: Option<[f64; 2]>) -> Self {
        self.medium.set_torus_m(torus_m);
        self
    }

    /// Bytes that robot `index` (in the order given to [`Radio::new`]) received for its next step.
    #[must_use]
    pub fn inbox(&self, index: usize) -> &[u8] {
        let Range { start, end } = self.receivers[index].inbox;
        &self.inboxes[index / BLOCK][start as usize..end as usize]
    }

    /// Changes the loss probability and the range in metres; `None` keeps a value.
    pub fn change(&mut self, loss: Option<f64>, range_m: Option<f64>) {
        if let Some(loss) = loss {
            self.fates.set_loss(loss);
        }
        if let Some(range_m) = range_m {
            self.medium.set_range_m(range_m);
        }
    }

    /// Enables or disables the log of [`Radio::receptions`] from the next tick on.
    pub fn log_receptions(&mut self, wanted: bool) {
        for receiver in &mut self.receivers {
            receiver.log = wanted.then(Vec::new);
        }
    }

    /// Fate of the last tick's packets at robot `index`, with the sender's id.
    #[must_use]
    pub fn receptions(&self, index: usize) -> &[(RobotId, Reception)] {
        self.receivers[index].log.as_deref().unwrap_or_default()
    }

    /// Packet totals so far.
    #[must_use]
    pub fn total(&self) -> Counts {
        self.total
    }

    /// Transmits the packets of `tick`: replaces all inboxes with the packets that arrive before
    /// the next tick, and returns this tick's statistics. `positions_m[i]` and `outbox(i)` belong
    /// to robot `i`.
    ///
    /// O(n k) for k robots in range, in parallel; allocates 16 bytes per robot after warming up.
    ///
    /// # Panics
    /// If there are fewer positions than robots.
    pub fn carry<'a>(&mut self, tick: u32, positions_m: &[[f64; 2]], outbox: impl Fn(usize) -> &'a [u8]) -> Counts {
        let sent = self.send(tick, positions_m, outbox);
        self.deliver(tick, positions_m, sent)
    }

    fn deliver(&mut self, tick: u32, positions_m: &[[f64; 2]], sent: Counts) -> Counts {
        let positions_m = &positions_m[..self.receivers.len()];
        let (medium, fates) = (&self.medium, &self.fates);
        let blocks = (self.receivers.par_chunks_mut(BLOCK), positions_m.par_chunks(BLOCK), &mut self.inboxes);
        let received = blocks
            .into_par_iter()
            .map_init(Vec::new, |heard, (receivers, positions_m, inboxes)| {
                inboxes.clear();
                let counts = receivers.iter_mut().zip(positions_m).map(|(receiver, &position_m)| {
                    medium.heard_at(position_m, receiver.id, heard);
                    receiver.receive(tick, medium, heard, fates, inboxes)
                });
                counts.fold(Counts::default(), Add::add)
            })
            .reduce(Counts::default, Add::add);
        let counts = sent + received;
        self.total += counts;
        counts
    }
}

impl Receiver {
    fn receive(&mut self, tick: u32, medium: &Medium, heard: &[u32], fates: &Fates, inboxes: &mut Inboxes) -> Counts {
        let mut counts = Counts::default();
        let begin = inboxes.len();
        if let Some(log) = &mut self.log {
            log.clear();
        }
        for &at in heard {
            let packet = medium.packet(at);
            let mut draws = fates.draws(packet, self.id, tick);
            let Verdict::Arrives { copies } = fates.judge(&mut draws, packet, self.id, tick) else {
                counts.lost += 1;
                if let Some(log) = &mut self.log {
                    log.push((packet.sender, Reception::Lost));
                }
                continue;
            };
            let damaged_before = counts.corrupted;
            for copy in 0..copies {
                let due_us = fates.due_us(&mut draws, tick);
                let buffer = match due_us {
                    None => &mut *inboxes,
                    Some(_) => &mut self.late.get_or_insert_default().bytes,
                };
                let start = buffer.len();
                append(buffer, medium.bytes(packet));
                counts.delivered += 1;
                counts.corrupted += u64::from(fates.damage(&mut draws, &mut buffer[start..]));
                let length = (buffer.len() - start) as u32;
                if let (Some(due_us), Some(late)) = (due_us, &mut self.late) {
                    late.held.push(Held {
                        due_us,
                        sender: packet.sender,
                        sent: tick,
                        number: packet.number,
                        copy,
                        start: start as u32,
                        length,
                    });
                }
            }
            if let Some(log) = &mut self.log {
                let is_damaged = counts.corrupted > damaged_before;
                log.push((packet.sender, if is_damaged { Reception::Damaged } else { Reception::Delivered }));
            }
        }
        if let Some(late) = &mut self.late {
            late.release(fates.next_step_us(tick), inboxes);
        }
        self.inbox = begin as u32..inboxes.len() as u32;
        counts
    }
}

impl Late {
    fn release(&mut self, now_us: u64, inbox: &mut Inboxes) {
        if self.held.is_empty() {
            return;
        }
        self.held.sort_unstable();
        let due = self.held.partition_point(|held| held.due_us <= now_us);
        self.spare.clear();
        for (index, held) in self.held.iter_mut().enumerate() {
            let start = held.start as usize;
            let bytes = &self.bytes[start..start + held.length as usize];
            if index < due {
                append(inbox, bytes);
            } else {
                held.start = self.spare.len() as u32;
                self.spare.extend_from_slice(bytes);
            }
        }
        self.held.drain(..due);
        std::mem::swap(&mut self.bytes, &mut self.spare);
    }
}

/// Appends to a buffer that grows by an eighth, because there are many of them.
fn append(buffer: &mut Vec<u8>, bytes: &[u8]) {
    if buffer.capacity() - buffer.len() < bytes.len() {
        buffer.reserve_exact(bytes.len() + buffer.len() / 8);
    }
    buffer.extend_from_slice(bytes);
}

#[cfg(test)]
mod tests;
