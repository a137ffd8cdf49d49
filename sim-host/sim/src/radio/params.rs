//! Parameters of a radio: the `[radio]` table of a scenario.

use serde::Deserialize;
use staya_controller::wire::Format;

/// Bursts of loss: a Gilbert-Elliott channel, good or bad, for each ordered pair of robots. Its
/// state changes between ticks, as a Markov chain with the given share and mean length.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Burst {
    /// Share of time for which the channel is bad, 0 to 1 (less than 1).
    pub share: f64,
    /// Mean time for which it stays bad, ms; at least a tick divided by (1 - share).
    pub mean_ms: f64,
    /// Probability that a packet is lost while the channel is bad. Default: 1.
    #[serde(default = "certain")]
    pub loss: f64,
}

const fn certain() -> f64 {
    1.0
}

/// The radio of a scenario, equal for all robots. Defaults: a perfect radio of 100 m.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct RadioParams {
    /// Wire format: `postcard` (Staya's frames) or `mavlink` (MAVLink 2, ids up to 254).
    pub format: Format,
    /// Farthest distance at which a packet can be received, metres; `inf` for unlimited range.
    pub range_m: f64,
    /// Probability that a receiver loses a packet, 0 to 1.
    pub loss: f64,
    /// Bursts of loss, in addition to `loss`.
    pub burst: Option<Burst>,
    /// Time from sending to arrival, ms. A packet is read in the receiver's first step after its
    /// arrival, hence never in the tick in which it was sent.
    pub delay_ms: f64,
    /// Longest additional delay, ms; uniform and independent for each packet.
    pub jitter_ms: f64,
    /// Probability that a packet arrives twice, 0 to 1.
    pub duplicate: f64,
    /// Probability that a packet is delayed so that later ones overtake it, 0 to 1.
    pub reorder: f64,
    /// Longest delay by `reorder`, ms; uniform.
    pub reorder_ms: f64,
    /// Probability that a transmitted bit flips, 0 to 1.
    pub bit_error_rate: f64,
    /// Bytes per second that a robot may send; further packets are dropped and counted as
    /// throttled. A silent robot saves the bytes of one second (at least 256). Default: no limit.
    pub bandwidth_bytes_per_s: Option<u32>,
    /// Spans `[from, to]` of seconds after the start during which every packet is lost.
    pub blackout_s: Vec<[f64; 2]>,
}

impl Default for RadioParams {
    fn default() -> Self {
        Self {
            format: Format::Postcard,
            range_m: 100.0,
            loss: 0.0,
            burst: None,
            delay_ms: 0.0,
            jitter_ms: 0.0,
            duplicate: 0.0,
            reorder: 0.0,
            reorder_ms: 500.0,
            bit_error_rate: 0.0,
            bandwidth_bytes_per_s: None,
            blackout_s: Vec::new(),
        }
    }
}
