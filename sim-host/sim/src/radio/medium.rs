//! Packets on the air in one tick, indexed by the sender's position.

use super::Counts;
use super::border::Sent;
use super::params::RadioParams;
use rayon::prelude::*;
use staya_controller::agent::OUTBOX;
use staya_controller::rand::Rng;
use staya_controller::robot::RobotId;
use staya_controller::wire::{Frame, Wire};
use staya_mavlink::any::AnyWire;
use std::ops::Add;

const PACKET: u32 = 0x0052_0001;

#[derive(Clone, Copy, Debug)]
pub(super) struct Packet {
    pub(super) sender: RobotId,
    pub(super) number: u32,
    pub(super) key: u64,
    pub(super) from_m: [f64; 3],
    /// Location of its bytes: index of the [`Part`], start and length.
    part: u32,
    start: u32,
    length: u16,
    /// Index in [`Part::frames`], or [`UNREAD`].
    frame: u32,
}

impl Packet {
    pub(super) const fn len(&self) -> usize {
        self.length as usize
    }
}

/// Marks a packet that each receiver must decode itself.
const UNREAD: u32 = u32::MAX;

const PART: usize = 1024;

#[derive(Clone, Debug, Default)]
struct Part {
    bytes: Vec<u8>,
    frames: Vec<Frame>,
    queue: Vec<(u32, Packet)>,
    counts: Counts,
}

impl Part {
    fn clear(&mut self) {
        self.bytes.clear();
        self.frames.clear();
        self.queue.clear();
        self.counts = Counts::default();
    }

    /// Appends the bytes of a packet and, with a `wire`, its frame. Returns start, length and the
    /// index of the frame.
    fn push(&mut self, bytes: &[u8], wire: Option<&AnyWire>) -> (u32, u16, u32) {
        let start = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        let frame = wire.and_then(|wire| {
            // Without its delimiter a frame would continue in the next packet.
            self.bytes.push(1);
            let frame = wire.next_frame(&mut &self.bytes[start..]).and_then(|frame| wire.clone().decode(frame).ok());
            self.bytes.pop();
            frame
        });
        let number = self.frames.len() as u32;
        let number = if frame.is_some() { number } else { UNREAD };
        self.frames.extend(frame);
        (start as u32, bytes.len() as u16, number)
    }
}

/// Token buckets of the bandwidth limit, in millionths of a byte.
#[derive(Clone, Debug)]
struct Buckets {
    per_tick: u64,
    capacity: u64,
    tokens: Vec<u64>,
}

#[derive(Clone, Debug)]
pub(super) struct Medium {
    wire: AnyWire,
    /// Receivers have keys, so that each must decode each frame itself.
    has_keys: bool,
    seed: u64,
    range_m: f64,
    torus_m: Option<[f64; 2]>,
    buckets: Option<Buckets>,
    parts: Vec<Part>,
    /// Sorted by cell, then by sender and number.
    packets: Vec<Packet>,
    /// End of each cell's packets in `packets`.
    ends: Vec<u32>,
    lattice: Lattice,
}

#[derive(Clone, Copy, Debug, Default)]
struct Lattice {
    corner_m: [f64; 2],
    side_m: f64,
    columns: usize,
    rows: usize,
}

impl Medium {
    pub(super) fn new(params: &RadioParams, seed: u64, tick_us: u32, robots: usize) -> Self {
        let buckets = params.bandwidth_bytes_per_s.map(|bytes_per_s| {
            let capacity = u64::from(bytes_per_s).max(OUTBOX as u64) * 1_000_000;
            Buckets { per_tick: u64::from(bytes_per_s) * u64::from(tick_us), capacity, tokens: vec![capacity; robots] }
        });
        Self {
            wire: AnyWire::new(params.format),
            has_keys: false,
            seed,
            range_m: params.range_m,
            torus_m: None,
            buckets,
            parts: Vec::new(),
            packets: Vec::new(),
            ends: Vec::new(),
            lattice: Lattice::default(),
        }
    }

    pub(super) const fn set_range_m(&mut self, range_m: f64) {
        self.range_m = range_m;
    }

    pub(super) const fn set_keys(&mut self, has_keys: bool) {
        self.has_keys = has_keys;
    }

    pub(super) const fn set_torus_m(&mut self, torus_m: Option<[f64; 2]>) {
        self.torus_m = torus_m;
    }

    pub(super) const fn range_m(&self) -> f64 {
        self.range_m
    }

    pub(super) fn tokens(&self, index: usize) -> Option<u64> {
        self.buckets.as_ref().map(|buckets| buckets.tokens[index])
    }

    /// Fails unless both have a limit or both have none.
    pub(super) fn set_tokens(&mut self, index: usize, tokens: Option<u64>) -> bool {
        match (&mut self.buckets, tokens) {
            (Some(buckets), Some(tokens)) => buckets.tokens[index] = tokens.min(buckets.capacity),
            (None, None) => {}
            _ => return false,
        }
        true
    }

    pub(super) fn fill(
        &mut self,
        tick: u32,
        ids: impl Fn(usize) -> RobotId + Sync,
        positions_m: &[[f64; 3]],
        outboxes: &[&[u8]],
    ) -> Counts {
        self.lattice = Lattice::over(positions_m, self.range_m);
        if let Some(buckets) = &mut self.buckets {
            buckets.refill();
        }
        self.parts.resize_with(outboxes.len().div_ceil(PART), Part::default);
        let mut buckets: Vec<_> = match &mut self.buckets {
            Some(buckets) => buckets.tokens.chunks_mut(PART).map(Some).collect(),
            None => self.parts.iter().map(|_| None).collect(),
        };
        let (wire, lattice, seed, has_keys) = (&self.wire, &self.lattice, self.seed, self.has_keys);
        let parts = (&mut self.parts, &mut buckets, outboxes.par_chunks(PART)).into_par_iter().enumerate();
        parts.for_each(|(number, (part, tokens, outboxes))| {
            part.clear();
            for (at, outbox) in outboxes.iter().enumerate().filter(|(_, outbox)| !outbox.is_empty()) {
                let index = number * PART + at;
                let (sender, from_m) = (ids(index), positions_m[index]);
                let key = Rng::keyed(seed, PACKET, sender.0, tick).next_u64();
                let cell = lattice.cell(from_m) as u32;
                for (place, bytes) in (0..).zip(packets(wire, outbox)) {
                    let tokens = tokens.as_deref_mut().map(|tokens| &mut tokens[at]);
                    if tokens.is_some_and(|tokens| !take(tokens, bytes.len())) {
                        part.counts.throttled += 1;
                        continue;
                    }
                    let (start, length, frame) = part.push(bytes, (!has_keys).then_some(wire));
                    let packet =
                        Packet { sender, number: place, key, from_m, part: number as u32, start, length, frame };
                    part.counts.sent += 1;
                    part.queue.push((cell, packet));
                }
            }
        });
        self.sort();
        self.parts.iter().map(|part| part.counts).fold(Counts::default(), Add::add)
    }

    pub(super) fn sent(&self) -> impl Iterator<Item = (&Packet, &[u8])> {
        let queue = self.parts.iter().flat_map(|part| &part.queue);
        queue.map(|(_, packet)| (packet, self.bytes(packet)))
    }

    pub(super) fn add(&mut self, tick: u32, elsewhere: &[Sent]) {
        if elsewhere.is_empty() {
            return;
        }
        // They form a separate part, which the next tick removes.
        let mut part = Part::default();
        let number = self.parts.len() as u32;
        for Sent { sender, number: place, from_m, bytes } in elsewhere {
            let key = Rng::keyed(self.seed, PACKET, sender.0, tick).next_u64();
            let (start, length, frame) = part.push(bytes, (!self.has_keys).then_some(&self.wire));
            let (sender, from_m) = (*sender, *from_m);
            let packet = Packet { sender, number: *place, key, from_m, part: number, start, length, frame };
            part.queue.push((self.lattice.cell(from_m) as u32, packet));
        }
        self.parts.push(part);
        self.sort();
    }

    /// New senders have full token buckets.
    pub(super) fn resize(&mut self, robots: usize) {
        if let Some(buckets) = &mut self.buckets {
            buckets.tokens.resize(robots, buckets.capacity);
        }
    }

    fn sort(&mut self) {
        let cells = self.lattice.columns * self.lattice.rows;
        let queue = || self.parts.iter().flat_map(|part| &part.queue);
        self.ends.clear();
        self.ends.resize(cells + 1, 0);
        for &(cell, _) in queue() {
            self.ends[cell as usize + 1] += 1;
        }
        // Converts counts to starts; placing the packets converts these to ends.
        let mut begin = 0;
        for end in &mut self.ends {
            begin += *end;
            *end = begin;
        }
        self.packets.clear();
        if let Some(&(_, filler)) = queue().next() {
            self.packets.resize(begin as usize, filler);
        }
        for &(cell, packet) in queue() {
            let at = &mut self.ends[cell as usize];
            self.packets[*at as usize] = packet;
            *at += 1;
        }
    }

    /// Packets in range of a position, sorted by sender and number, without those of `own`.
    pub(super) fn heard_at(&self, at_m: [f64; 3], own: RobotId, heard: &mut Vec<u32>) {
        heard.clear();
        self.add_heard_at(at_m, own, heard);
        if let Some(torus_m) = self.torus_m {
            let near = images(at_m, torus_m).filter(|&image_m| self.lattice.is_within(image_m, self.range_m));
            near.for_each(|image_m| self.add_heard_at(image_m, own, heard));
        }
        heard.sort_unstable_by_key(|&at| {
            let packet = self.packet(at);
            (packet.sender, packet.number)
        });
        // A packet that is in range more than once around the torus is received once.
        heard.dedup();
    }

    fn add_heard_at(&self, at_m: [f64; 3], own: RobotId, heard: &mut Vec<u32>) {
        let reach = self.range_m * self.range_m;
        for cells in self.lattice.around(at_m) {
            let begin = match cells.start {
                0 => 0,
                first => self.ends[first - 1],
            };
            let end = self.ends[cells.end - 1];
            for at in begin..end {
                let packet = &self.packets[at as usize];
                let [dx, dy, dz] = [0, 1, 2].map(|axis| packet.from_m[axis] - at_m[axis]);
                if packet.sender != own && dx * dx + dy * dy + dz * dz <= reach {
                    heard.push(at);
                }
            }
        }
    }

    pub(super) fn packets(&self) -> &[Packet] {
        &self.packets
    }

    pub(super) fn packet(&self, at: u32) -> &Packet {
        &self.packets[at as usize]
    }

    pub(super) fn bytes(&self, packet: &Packet) -> &[u8] {
        let bytes = &self.parts[packet.part as usize].bytes;
        &bytes[packet.start as usize..][..packet.length.into()]
    }

    /// The packet's frame, if any receiver decodes these bytes to it, whatever bytes follow.
    pub(super) fn frame(&self, packet: &Packet) -> Option<&Frame> {
        self.parts[packet.part as usize].frames.get(packet.frame as usize)
    }
}

/// Estimated number of ordered pairs of senders and receivers in range, for robots at these
/// positions. O(n).
pub(super) fn pairs_in_range(positions_m: &[[f64; 3]], range_m: f64) -> f64 {
    let lattice = Lattice::over(positions_m, range_m);
    let cells = lattice.columns * lattice.rows;
    let mut counts = vec![0.0_f64; cells];
    for position_m in positions_m {
        counts[lattice.cell(*position_m)] += 1.0;
    }
    let block = 9.0 * lattice.side_m * lattice.side_m;
    let share = if cells == 1 { 1.0 } else { (core::f64::consts::PI * range_m * range_m / block).min(1.0) };
    let near = |at_m: &[f64; 3]| lattice.around(*at_m).map(|cells| counts[cells].iter().sum::<f64>()).sum::<f64>();
    positions_m.iter().map(|at_m| near(at_m) * share).sum()
}

/// Splits an outbox into packets: a frame with its delimiter, if the format has one.
fn packets<'a>(wire: &AnyWire, outbox: &'a [u8]) -> impl Iterator<Item = &'a [u8]> {
    let mut rest = outbox;
    std::iter::from_fn(move || {
        let before = rest;
        wire.next_frame(&mut rest)?;
        Some(&before[..before.len() - rest.len()])
    })
}

/// Images of a position on a torus, shifted by at most one period along each of its two axes.
fn images([x, y, z]: [f64; 3], [width, height]: [f64; 2]) -> impl Iterator<Item = [f64; 3]> {
    let turns = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [i, j])).filter(|turns| *turns != [0, 0]);
    turns.map(move |[i, j]| [x + f64::from(i) * width, y + f64::from(j) * height, z])
}

impl Lattice {
    fn over(positions_m: &[[f64; 3]], range_m: f64) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for position in positions_m {
            for axis in 0..2 {
                low[axis] = low[axis].min(position[axis]);
                high[axis] = high[axis].max(position[axis]);
            }
        }
        if positions_m.is_empty() {
            return Self::default();
        }
        let extent = [high[0] - low[0], high[1] - low[1]];
        let longest = extent[0].max(extent[1]);
        let per_side = libm::sqrt(positions_m.len() as f64);
        let side_m = range_m.max(longest / (2.0 * per_side)).max(f64::MIN_POSITIVE);
        let count = |length: f64| (length / side_m) as usize + 1;
        Self { corner_m: low, side_m, columns: count(extent[0]), rows: count(extent[1]) }
    }

    fn is_within(&self, at_m: [f64; 3], reach_m: f64) -> bool {
        let counts = [self.columns, self.rows];
        (0..2).all(|axis| {
            let off_m = at_m[axis] - self.corner_m[axis];
            off_m >= -reach_m && off_m <= counts[axis] as f64 * self.side_m + reach_m
        })
    }

    fn column_and_row(&self, at_m: [f64; 3]) -> (usize, usize) {
        let index = |axis: usize| ((at_m[axis] - self.corner_m[axis]) / self.side_m) as usize;
        (index(0).min(self.columns - 1), index(1).min(self.rows - 1))
    }

    fn cell(&self, at_m: [f64; 3]) -> usize {
        let (column, row) = self.column_and_row(at_m);
        row * self.columns + column
    }

    /// The cells around a position, as up to three ranges of consecutive cells.
    fn around(&self, at_m: [f64; 3]) -> impl Iterator<Item = std::ops::Range<usize>> + use<> {
        let (column, row) = self.column_and_row(at_m);
        let columns = self.columns;
        let last_row = (row + 1).min(self.rows - 1);
        let (first, last) = (column.saturating_sub(1), (column + 1).min(columns - 1));
        (row.saturating_sub(1)..=last_row).map(move |row| row * columns + first..row * columns + last + 1)
    }
}

impl Buckets {
    fn refill(&mut self) {
        for tokens in &mut self.tokens {
            *tokens = (*tokens + self.per_tick).min(self.capacity);
        }
    }
}

fn take(tokens: &mut u64, bytes: usize) -> bool {
    let price = bytes as u64 * 1_000_000;
    let enough = *tokens >= price;
    if enough {
        *tokens -= price;
    }
    enough
}
