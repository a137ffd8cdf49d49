//! Packets that arrive in a later tick. Their bytes are kept once for all receivers.

use super::append;
use super::medium::{Medium, Packet};
use serde::{Deserialize, Serialize};
use staya_controller::robot::RobotId;
use std::collections::{HashMap, VecDeque};

/// Marks a held packet with the bytes that were sent.
const AS_SENT: u32 = u32::MAX;

/// A delayed packet at one receiver.
#[derive(Clone, Copy, Debug)]
struct Held {
    /// Tick in which it was sent.
    sent: u32,
    /// Time from the beginning of that tick to its arrival, microseconds.
    after_us: u32,
    /// Its number in that tick's [`Kept`].
    packet: u32,
    /// Start of its bytes in [`Late::damaged`], or [`AS_SENT`].
    damaged: u32,
    copy: u8,
}

/// Delayed packets of one receiver. Arrivals are ordered by time, then as they were sent.
#[derive(Clone, Debug, Default)]
pub(super) struct Late {
    held: Vec<Held>,
    damaged: Vec<u8>,
    /// Receives the damaged bytes of packets that remain; swapped with `damaged`.
    spare: Vec<u8>,
}

/// A delayed packet with its own bytes, for checkpoints and other ranks.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Saved {
    due_us: u64,
    sender: RobotId,
    sent: u32,
    number: u32,
    copy: u32,
    start: u32,
    length: u32,
}

/// The packets of the last ticks, until the last receiver has them.
#[derive(Clone, Debug, Default)]
pub(super) struct Air {
    tick_us: u64,
    /// Sorted by tick.
    ticks: VecDeque<Kept>,
}

/// The packets of one tick.
#[derive(Clone, Debug, Default)]
struct Kept {
    tick: u32,
    packets: Vec<KeptPacket>,
    bytes: Vec<u8>,
    /// Numbers of the packets that [`Air::add`] added.
    added: HashMap<(RobotId, u32), u32>,
}

/// Bytes of memory that one packet at one receiver takes while it is held.
pub(super) const HELD_BYTES: usize = size_of::<Held>();

#[derive(Clone, Copy, Debug)]
struct KeptPacket {
    sender: RobotId,
    number: u32,
    start: u32,
    length: u16,
}

impl Late {
    /// Holds a packet of this tick. `damage` gets its bytes and returns whether it changed them,
    /// which is returned.
    pub(super) fn hold(
        &mut self,
        tick: u32,
        after_us: u32,
        (at, bytes): (u32, &[u8]),
        copy: u8,
        damage: impl FnOnce(&mut [u8]) -> bool,
    ) -> bool {
        let start = self.damaged.len();
        self.damaged.extend_from_slice(bytes);
        let is_damaged = damage(&mut self.damaged[start..]);
        if !is_damaged {
            self.damaged.truncate(start);
        }
        let damaged = if is_damaged { start as u32 } else { AS_SENT };
        if self.held.len() == self.held.capacity() {
            // There are many of these lists.
            self.held.reserve_exact(1 + self.held.len() / 8);
        }
        self.held.push(Held { sent: tick, after_us, packet: at, damaged, copy });
        is_damaged
    }

    /// Moves the packets that arrive until `now_us` to an inbox.
    pub(super) fn release(&mut self, now_us: u64, air: &Air, inbox: &mut Vec<u8>) {
        if self.held.is_empty() {
            return;
        }
        self.held.sort_by_key(|held| held.due_us(air));
        let due = self.held.partition_point(|held| held.due_us(air) <= now_us);
        for held in &self.held[..due] {
            append(inbox, self.bytes(held, air).1);
        }
        self.held.drain(..due);
        if self.damaged.is_empty() {
            return;
        }
        self.spare.clear();
        for held in self.held.iter_mut().filter(|held| held.damaged != AS_SENT) {
            let start = self.spare.len() as u32;
            let length = air.packet(held).map_or(0, |(_, packet)| packet.length);
            self.spare.extend_from_slice(own(&self.damaged, held, length));
            held.damaged = start;
        }
        std::mem::swap(&mut self.damaged, &mut self.spare);
    }

    fn bytes<'a>(&'a self, held: &Held, air: &'a Air) -> (Option<KeptPacket>, &'a [u8]) {
        match air.packet(held) {
            Some((kept, packet)) if held.damaged == AS_SENT => (Some(packet), kept.bytes(packet)),
            Some((_, packet)) => (Some(packet), own(&self.damaged, held, packet.length)),
            None => (None, &[]),
        }
    }

    /// The held packets, and their bytes.
    pub(super) fn saved(&self, air: &Air) -> (Vec<Saved>, Vec<u8>) {
        let mut bytes = Vec::new();
        let saved = self.held.iter().filter_map(|held| {
            let (packet, own) = self.bytes(held, air);
            let KeptPacket { sender, number, .. } = packet?;
            let (start, length) = (bytes.len() as u32, own.len() as u32);
            bytes.extend_from_slice(own);
            let Held { sent, copy, .. } = *held;
            Some(Saved { due_us: held.due_us(air), sender, sent, number, copy: copy.into(), start, length })
        });
        let saved = saved.collect();
        (saved, bytes)
    }

    /// Fails if a packet has no bytes, or no time or length that a radio has.
    pub(super) fn restored(saved: &[Saved], bytes: &[u8], air: &mut Air) -> Result<Self, &'static str> {
        let mut late = Self::default();
        for &Saved { due_us, sender, sent, number, copy, start, length } in saved {
            let own = bytes.get(start as usize..).and_then(|bytes| bytes.get(..length as usize));
            let own = own.ok_or("a packet that is held back has no bytes")?;
            let after_us = due_us.checked_sub(u64::from(sent) * air.tick_us).and_then(|us| u32::try_from(us).ok());
            let unlike = "a packet that is held back is none of this radio";
            let (Some(after_us), Ok(copy), Ok(_)) = (after_us, u8::try_from(copy), u16::try_from(length)) else {
                return Err(unlike);
            };
            let (packet, sent_bytes) = air.add(sent, sender, number, own);
            let same = sent_bytes == own;
            if !same && sent_bytes.len() != own.len() {
                return Err(unlike);
            }
            late.hold(sent, after_us, (packet, own), copy, |_| !same);
        }
        Ok(late)
    }
}

fn own<'a>(damaged: &'a [u8], held: &Held, length: u16) -> &'a [u8] {
    damaged.get(held.damaged as usize..).and_then(|bytes| bytes.get(..length.into())).unwrap_or_default()
}

impl Held {
    fn due_us(&self, air: &Air) -> u64 {
        u64::from(self.sent) * air.tick_us + u64::from(self.after_us)
    }
}

impl Air {
    pub(super) fn new(tick_us: u32) -> Self {
        Self { tick_us: tick_us.into(), ticks: VecDeque::new() }
    }

    /// Keeps the packets of `tick`, and forgets those of more than `ticks` ticks before it.
    pub(super) fn keep(&mut self, tick: u32, medium: &Medium, ticks: u32) {
        let mut kept = Kept::default();
        while self.ticks.front().is_some_and(|front| front.tick.saturating_add(ticks) < tick) {
            kept = self.ticks.pop_front().unwrap_or_default();
        }
        kept.clear(tick);
        for packet in medium.packets() {
            let Packet { sender, number, .. } = *packet;
            kept.push(sender, number, medium.bytes(packet));
        }
        self.ticks.push_back(kept);
    }

    /// Number and bytes of a packet; a packet that was added before keeps its first bytes.
    fn add(&mut self, tick: u32, sender: RobotId, number: u32, bytes: &[u8]) -> (u32, &[u8]) {
        let at = self.ticks.binary_search_by_key(&tick, |kept| kept.tick).unwrap_or_else(|at| {
            self.ticks.insert(at, Kept { tick, ..Kept::default() });
            at
        });
        let kept = &mut self.ticks[at];
        let packet = match kept.added.get(&(sender, number)) {
            Some(packet) => *packet,
            None => {
                let packet = kept.push(sender, number, bytes);
                kept.added.insert((sender, number), packet);
                packet
            }
        };
        (packet, kept.bytes(kept.packets[packet as usize]))
    }

    #[cfg(test)]
    pub(super) fn bytes(&self) -> usize {
        self.ticks.iter().map(|kept| kept.bytes.len()).sum()
    }

    fn packet(&self, held: &Held) -> Option<(&Kept, KeptPacket)> {
        let at = self.ticks.binary_search_by_key(&held.sent, |kept| kept.tick).ok()?;
        let kept = &self.ticks[at];
        Some((kept, *kept.packets.get(held.packet as usize)?))
    }
}

impl Kept {
    fn clear(&mut self, tick: u32) {
        self.tick = tick;
        self.packets.clear();
        self.bytes.clear();
        self.added.clear();
    }

    fn push(&mut self, sender: RobotId, number: u32, bytes: &[u8]) -> u32 {
        let (start, length) = (self.bytes.len() as u32, bytes.len() as u16);
        self.bytes.extend_from_slice(bytes);
        self.packets.push(KeptPacket { sender, number, start, length });
        self.packets.len() as u32 - 1
    }

    fn bytes(&self, packet: KeptPacket) -> &[u8] {
        &self.bytes[packet.start as usize..][..packet.length.into()]
    }
}
