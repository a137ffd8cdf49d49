//! The radio: transmits bytes between robots, and loses, delays, duplicates and damages them.
//!
//! A packet is a frame of the robots' wire format, with its delimiter if there is one. Only bit
//! errors and bandwidth depend on its bytes. All random effects on a packet are a function of
//! (seed, tick, sender, number within the tick, receiver), so that neither threads nor the order of
//! robots matter.

mod border;
mod fate;
mod fault;
mod late;
mod medium;
mod params;
mod shadow;
mod state;
mod wire;

#[doc(hidden)]
pub use border::Sent;
pub use params::{Burst, RadioFault, RadioParams, Shadow};
pub(crate) use state::{End, Weather};
pub use wire::{HostWire, LAST_START, PEERS, keep_up, operator, own_wire, ring_wire, wire};

use crate::terrain::Terrain;
use fate::{Fates, Verdict};
use late::{Air, Late};
use medium::Medium;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use staya_controller::robot::RobotId;
use staya_controller::wire::Frame;
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
    /// Failed receptions: loss, bursts, blackouts, faults of radios.
    pub lost: u64,
    /// Receptions with at least one flipped bit; also counted as delivered.
    pub damaged: u64,
}

impl Add for Counts {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            sent: self.sent + other.sent,
            throttled: self.throttled + other.throttled,
            delivered: self.delivered + other.delivered,
            lost: self.lost + other.lost,
            damaged: self.damaged + other.damaged,
        }
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

#[derive(Clone, Debug, Default)]
struct Receiver {
    id: RobotId,
    /// Ranges of its inbox in its block's [`Inboxes`].
    packets: Range<u32>,
    bytes: Range<u32>,
    late: Option<Box<Late>>,
    log: Option<Vec<(RobotId, Reception)>>,
}

const BLOCK: usize = 64;

/// The inboxes of [`BLOCK`] receivers.
#[derive(Clone, Debug, Default)]
struct Inboxes {
    /// Numbers in the [`Medium`] of packets that were already decoded.
    packets: Vec<u32>,
    bytes: Vec<u8>,
}

/// Frames and bytes that a robot received for its next step.
#[derive(Clone, Copy, Debug)]
pub struct Inbox<'a> {
    medium: &'a Medium,
    packets: &'a [u32],
    /// The bytes behind the decoded frames: from the first piece on that is damaged, late, sealed
    /// or no frame.
    pub bytes: &'a [u8],
}

impl<'a> Inbox<'a> {
    /// An inbox without frames.
    pub const fn cleared(self) -> Self {
        Self { packets: &[], bytes: &[], ..self }
    }

    /// The first frames, decoded.
    pub fn frames(self) -> impl Iterator<Item = &'a Frame> {
        self.packets.iter().filter_map(move |&at| self.medium.frame(self.medium.packet(at)))
    }

    /// Number of the first frames.
    pub const fn packets(self) -> usize {
        self.packets.len()
    }

    /// Length of the first frames, bytes.
    pub fn frame_bytes(self) -> usize {
        self.packets.iter().map(|&at| self.medium.packet(at).len()).sum()
    }

    /// The pieces of all received bytes.
    pub fn pieces(self) -> impl Iterator<Item = &'a [u8]> {
        let packets = self.packets.iter().map(move |&at| self.medium.bytes(self.medium.packet(at)));
        packets.chain([self.bytes])
    }

    /// All received bytes.
    #[must_use]
    pub fn to_vec(self) -> Vec<u8> {
        self.pieces().flatten().copied().collect()
    }
}

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
    /// Empty if no packet is delayed.
    air: Air,
    receivers: Vec<Receiver>,
    inboxes: Vec<Inboxes>,
    total: Counts,
    shadow: Option<Shadow>,
}

/// Bytes of a packet, measured for beacons of both wire formats.
const PACKET_BYTES: f64 = 40.0;

/// Estimated memory of the radio of robots at these positions, bytes, if each sends `per_tick`
/// packets in a tick and uses received ones when it sends. O(n).
#[must_use]
pub fn expected_bytes(params: &RadioParams, tick_us: u32, per_tick: f64, positions_m: &[[f64; 3]]) -> u64 {
    let fates = Fates::new(params, 0, tick_us);
    let held = fates.held_ticks() * late::HELD_BYTES as f64 * per_tick;
    let sent = f64::from(fates.longest_ticks().unwrap_or(0)) * per_tick * positions_m.len() as f64 * PACKET_BYTES;
    let arrived = (1.0 - params.loss) * medium::pairs_in_range(positions_m, params.range_m);
    (arrived * (PACKET_BYTES + held) + sent) as u64
}

impl Radio {
    /// Creates the radio for these robots with ticks of `tick_us` microseconds.
    #[must_use]
    pub fn new(params: &RadioParams, seed: u64, tick_us: u32, robots: impl IntoIterator<Item = RobotId>) -> Self {
        let receivers: Vec<_> = robots.into_iter().map(|id| Receiver { id, ..Receiver::default() }).collect();
        Self {
            fates: Fates::new(params, seed, tick_us),
            medium: Medium::new(params, seed, tick_us, receivers.len()),
            air: Air::new(tick_us),
            inboxes: vec![Inboxes::default(); receivers.len().div_ceil(BLOCK)],
            receivers,
            total: Counts::default(),
            shadow: params.shadow,
        }
    }

    /// Places the radio on a torus with these sides, metres: packets cross its borders.
    #[must_use]
    pub const fn on_torus(mut self, torus_m: Option<[f64; 2]>) -> Self {
        self.medium.set_torus_m(torus_m);
        self
    }

    /// Sets whether the receivers have keys. Without keys a packet is decoded once for all of them.
    #[must_use]
    pub const fn with_keys(mut self, has_keys: bool) -> Self {
        self.medium.set_keys(has_keys);
        self
    }

    /// The inbox of robot `index` (in the order given to [`Radio::new`]) for its next step.
    #[must_use]
    pub fn inbox(&self, index: usize) -> Inbox<'_> {
        let (Receiver { packets, bytes, .. }, inboxes) = (&self.receivers[index], &self.inboxes[index / BLOCK]);
        Inbox {
            medium: &self.medium,
            packets: &inboxes.packets[packets.start as usize..packets.end as usize],
            bytes: &inboxes.bytes[bytes.start as usize..bytes.end as usize],
        }
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
    /// to robot `i`. Nothing stands in the way.
    ///
    /// O(n k) for k robots in range, in parallel; allocates 16 bytes per robot after warming up.
    ///
    /// # Panics
    /// If there are fewer positions than robots.
    pub fn carry<'a>(&mut self, tick: u32, positions_m: &[[f64; 3]], outbox: impl Fn(usize) -> &'a [u8]) -> Counts {
        let sent = self.send(tick, positions_m, outbox);
        self.deliver(tick, positions_m, None, sent)
    }

    fn deliver(&mut self, tick: u32, positions_m: &[[f64; 3]], land: Option<&Terrain>, sent: Counts) -> Counts {
        let positions_m = &positions_m[..self.receivers.len()];
        if let Some(ticks) = self.fates.longest_ticks() {
            self.air.keep(tick, &self.medium, ticks);
        }
        let (medium, fates, air) = (&self.medium, &self.fates, &self.air);
        let hills = self.shadow.and_then(|shadow| shadow.over(land));
        let blocks = (self.receivers.par_chunks_mut(BLOCK), positions_m.par_chunks(BLOCK), &mut self.inboxes);
        let received = blocks
            .into_par_iter()
            .map_init(Vec::new, |heard, (receivers, positions_m, inboxes)| {
                inboxes.packets.clear();
                inboxes.bytes.clear();
                let counts = receivers.iter_mut().zip(positions_m).map(|(receiver, &position_m)| {
                    medium.heard_at(position_m, receiver.id, heard);
                    if let Some(hills) = hills {
                        heard.retain(|&at| hills.are_below(medium.packet(at).from_m, position_m));
                    }
                    receiver.receive(tick, medium, heard, (fates, air), inboxes)
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
    fn receive(
        &mut self,
        tick: u32,
        medium: &Medium,
        heard: &[u32],
        (fates, air): (&Fates, &Air),
        inboxes: &mut Inboxes,
    ) -> Counts {
        let mut counts = Counts::default();
        let (packets, begin) = (inboxes.packets.len() as u32, inboxes.bytes.len());
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
            let damaged_before = counts.damaged;
            for copy in 0..copies {
                let after_us = fates.after_us(&mut draws);
                let bytes = medium.bytes(packet);
                let is_damaged = match after_us {
                    None if inboxes.bytes.len() == begin && !fates.damages() && medium.frame(packet).is_some() => {
                        append(&mut inboxes.packets, &[at]);
                        false
                    }
                    None => {
                        let start = inboxes.bytes.len();
                        append(&mut inboxes.bytes, bytes);
                        fates.damage(&mut draws, &mut inboxes.bytes[start..])
                    }
                    Some(after_us) => {
                        let late = self.late.get_or_insert_default();
                        late.hold(tick, after_us, (at, bytes), copy, |bytes| fates.damage(&mut draws, bytes))
                    }
                };
                counts.delivered += 1;
                counts.damaged += u64::from(is_damaged);
            }
            if let Some(log) = &mut self.log {
                let is_damaged = counts.damaged > damaged_before;
                log.push((packet.sender, if is_damaged { Reception::Damaged } else { Reception::Delivered }));
            }
        }
        if let Some(late) = &mut self.late {
            late.release(fates.next_step_us(tick), air, &mut inboxes.bytes);
        }
        self.packets = packets..inboxes.packets.len() as u32;
        self.bytes = begin as u32..inboxes.bytes.len() as u32;
        counts
    }
}

/// Appends to a buffer that grows by an eighth, because there are many of them.
fn append<T: Copy>(buffer: &mut Vec<T>, items: &[T]) {
    if buffer.capacity() - buffer.len() < items.len() {
        buffer.reserve_exact(items.len() + buffer.len() / 8);
    }
    buffer.extend_from_slice(items);
}

#[cfg(test)]
mod tests;
