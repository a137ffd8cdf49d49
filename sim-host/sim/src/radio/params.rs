//! Parameters of a radio: the `[radio]` table of a scenario.

use crate::{defaults, names, table};
use staya_controller::wire::Format;

table! {
    /// Bursts of loss: a Gilbert-Elliott channel, good or bad, for each ordered pair of robots. Its
    /// state changes between ticks, as a Markov chain with the given share and mean length.
    #[derive(Copy, PartialEq)]
    pub struct Burst {
        /// Share of time for which the channel is bad, 0 to 1 (less than 1).
        pub share: f64, 0.0..=0.99, "(share of time)";
        /// Mean time for which it stays bad, ms; at least a tick divided by (1 - share).
        pub mean_ms: f64;
        /// Probability that a packet is lost while the channel is bad. Default: 1.
        pub loss: f64 = 1.0, 0.0..=1.0, "probability";
    }
}

table! {
    /// Land that stands in the way of the radio: a packet arrives if the straight line between the
    /// two antennas passes above the land between the cells of the two robots.
    #[derive(Copy, PartialEq)]
    pub struct Shadow {
        /// How much higher each class of the land is than the one below it, metres.
        pub class_m: f64, 0.0..=1e6, "metres";
        /// Height of the antennas above the land, metres.
        pub antenna_m: f64, 0.0..=1e6, "metres";
        /// Height of impassable cells, metres; `inf`: nothing passes. Default: inf.
        pub wall_m: f64 = f64::INFINITY, 0.0..=f64::INFINITY, "metres";
    }
}

table! {
    /// `[[radio.fault]]`: a fault of single radios or links, in addition to all other losses. A
    /// packet that several faults concern must pass each of them.
    #[derive(PartialEq)]
    pub struct RadioFault {
        /// Ids of the robots whose packets are lost. Default: all senders.
        pub from: Option<Vec<u32>>;
        /// Ids of the robots that do not receive them. Default: all receivers.
        pub to: Option<Vec<u32>>;
        /// Whether packets in the opposite direction, from `to` to `from`, are lost too. Default:
        /// false.
        pub both_ways: bool = false;
        /// Probability that such a packet is lost. Default: 1, a dead radio or link.
        pub loss: f64 = 1.0, 0.0..=1.0, "probability";
        /// Begin of the fault, seconds after the start. Default: 0.
        pub at_s: f64 = 0.0, 0.0..=1e9, "seconds";
        /// Duration of the fault, seconds. Default: until the end.
        pub for_s: Option<f64>, 0.0..=1e9, "seconds";
    }
}

table! {
    /// The radio of a scenario, equal for all robots except for faults. Defaults: a perfect radio
    /// of 100 m.
    #[derive(PartialEq)]
    pub struct RadioParams {
        /// Wire format: `postcard` (Staya's frames) or `mavlink` (MAVLink 2, ids up to 254).
        pub format: Format = Format::Postcard;
        /// Farthest distance at which a packet can be received, metres; `inf` for unlimited range.
        pub range_m: f64 = 100.0, 0.0..=f64::INFINITY, "metres";
        /// Land that stands in the way. Default: none does.
        pub shadow: Option<Shadow>;
        /// Probability that a receiver loses a packet, 0 to 1.
        pub loss: f64 = 0.0, 0.0..=1.0, "probability";
        /// Bursts of loss, in addition to `loss`.
        pub burst: Option<Burst>;
        /// Time from sending to arrival, ms. A packet is read in the receiver's first step after
        /// its arrival, hence never in the tick in which it was sent.
        pub delay_ms: f64 = 0.0, 0.0..=600_000.0, "milliseconds";
        /// Longest additional delay, ms; uniform and independent for each packet.
        pub jitter_ms: f64 = 0.0, 0.0..=600_000.0, "milliseconds";
        /// Probability that a packet arrives twice, 0 to 1.
        pub duplicate: f64 = 0.0, 0.0..=1.0, "probability";
        /// Probability that a packet is delayed so that later ones overtake it, 0 to 1.
        pub reorder: f64 = 0.0, 0.0..=1.0, "probability";
        /// Longest delay by `reorder`, ms; uniform.
        pub reorder_ms: f64 = 500.0, 0.0..=600_000.0, "milliseconds";
        /// Probability that a transmitted bit flips, 0 to 1.
        pub bit_error_rate: f64 = 0.0, 0.0..=1.0, "probability";
        /// Bytes per second that a robot may send; further packets are dropped and counted as
        /// throttled. A silent robot saves the bytes of one second (at least 256). Default: no
        /// limit.
        pub bandwidth_bytes_per_s: Option<u32>;
        /// Spans `[from, to]` of seconds after the start during which every packet is lost.
        pub blackout_s: Vec<[f64; 2]> = Vec::new();
        /// Beacons of the robots of a formation that each of them relays behind its own, for those
        /// that distance or land hides. Default: 0.
        pub relays: u8 = 0;
        /// Faults of single radios and links.
        pub fault: Vec<RadioFault> = Vec::new();
    }
}

defaults!(RadioParams, RadioFault);
names!(Format);

/// A probability as Q0.32; `u32::MAX` means always.
pub(super) fn q32(probability: f64) -> u32 {
    (probability * 4_294_967_296.0) as u32
}
