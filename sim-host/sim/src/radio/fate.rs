//! Loss, delay and damage of a packet on its way to one receiver.

use super::fault::Faults;
use super::medium::Packet;
use super::params::{Burst, RadioParams, q32};
use staya_controller::rand::Rng;
use staya_controller::robot::RobotId;

const LINK: u32 = 0x0052_0002;
const CHANNEL: u32 = 0x0052_0003;

pub(super) enum Verdict {
    Lost,
    Arrives { copies: u8 },
}

#[derive(Clone, Copy, Debug)]
struct Channel {
    /// Probability per tick that the state is redrawn, Q0.32.
    renewal: u32,
    /// Probability that a redrawn state is bad, Q0.32.
    share: u32,
    /// Probability of loss in the bad state, Q0.32.
    loss: u32,
}

#[derive(Clone, Debug)]
pub(super) struct Fates {
    seed: u64,
    tick_us: u64,
    loss: u32,
    channel: Option<Channel>,
    delay_us: u32,
    jitter_us: u32,
    duplicate: u32,
    reorder: u32,
    reorder_us: u32,
    /// ln(1 - bit error rate); 0: no errors.
    ln_intact: f64,
    blackouts: Vec<[f64; 2]>,
    faults: Faults,
}

impl RadioParams {
    /// Longest delay of a beacon, seconds, and received ones per second if sent every `period_s`.
    #[must_use]
    pub fn news(&self, period_s: f64) -> (f64, f64) {
        let burst = self.burst.as_ref().map_or(0.0, |burst| burst.share * burst.loss);
        let arriving = (1.0 - self.loss).max(0.0) * (1.0 - burst).max(0.0);
        ((self.delay_ms + self.jitter_ms) / 1000.0, arriving / period_s)
    }
}

impl Fates {
    /// Mean number of ticks for which a packet is held.
    pub(super) fn held_ticks(&self) -> f64 {
        if self.is_always_in_time() {
            return 0.0;
        }
        let mean_us = f64::from(self.delay_us) + f64::from(self.jitter_us) / 2.0;
        (mean_us / self.tick_us as f64).max(1.0)
    }

    pub(super) fn new(params: &RadioParams, seed: u64, tick_us: u32) -> Self {
        let us = |ms: f64| (ms * 1000.0) as u32;
        Self {
            seed,
            tick_us: u64::from(tick_us),
            loss: q32(params.loss),
            channel: params.burst.map(|burst| Channel::new(&burst, tick_us)),
            delay_us: us(params.delay_ms),
            jitter_us: us(params.jitter_ms),
            duplicate: q32(params.duplicate),
            reorder: q32(params.reorder),
            reorder_us: us(params.reorder_ms),
            ln_intact: libm::log1p(-params.bit_error_rate),
            blackouts: params.blackout_s.iter().map(|span| span.map(|s| s * 1e6)).collect(),
            faults: Faults::new(&params.fault),
        }
    }

    pub(super) fn set_loss(&mut self, loss: f64) {
        self.loss = q32(loss);
    }

    pub(super) const fn loss_q32(&self) -> u32 {
        self.loss
    }

    pub(super) const fn set_loss_q32(&mut self, loss: u32) {
        self.loss = loss;
    }

    pub(super) fn draws(&self, packet: &Packet, receiver: RobotId, tick: u32) -> Rng {
        Rng::keyed(packet.key, packet.number, receiver.0, tick)
    }

    pub(super) fn judge(&self, draws: &mut Rng, packet: &Packet, receiver: RobotId, tick: u32) -> Verdict {
        let now_us = (u64::from(tick) * self.tick_us) as f64;
        let silent = |span: &[f64; 2]| span[0] <= now_us && now_us < span[1];
        let burst_loss = self.channel.as_ref().map_or(0, |channel| {
            if channel.is_bad(self.seed, packet.sender, receiver, tick) { channel.loss } else { 0 }
        });
        if draws.chance_q32(self.loss)
            || (burst_loss > 0 && draws.chance_q32(burst_loss))
            || self.blackouts.iter().any(silent)
            || self.faults.remove(packet, receiver, now_us)
        {
            return Verdict::Lost;
        }
        let copies = 1 + u8::from(self.duplicate > 0 && draws.chance_q32(self.duplicate));
        Verdict::Arrives { copies }
    }

    const fn is_always_in_time(&self) -> bool {
        self.delay_us == 0 && self.jitter_us == 0 && self.reorder == 0
    }

    /// Ticks from the sending of a packet to its latest arrival; `None` if packets always arrive
    /// before the next step.
    pub(super) fn longest_ticks(&self) -> Option<u32> {
        let overtaken_us = if self.reorder == 0 { 0 } else { self.reorder_us };
        let longest_us = u64::from(self.delay_us) + u64::from(self.jitter_us) + u64::from(overtaken_us);
        let ticks = u32::try_from(longest_us / self.tick_us + 1).unwrap_or(u32::MAX);
        if self.is_always_in_time() { None } else { Some(ticks) }
    }

    /// In microseconds after the beginning of the tick; `None` if packets always arrive before the
    /// next step.
    pub(super) fn after_us(&self, draws: &mut Rng) -> Option<u32> {
        if self.is_always_in_time() {
            return None;
        }
        let mut after_us = self.delay_us.saturating_add(draws.below(self.jitter_us));
        if draws.chance_q32(self.reorder) {
            after_us = after_us.saturating_add(draws.below(self.reorder_us));
        }
        Some(after_us)
    }

    pub(super) fn next_step_us(&self, tick: u32) -> u64 {
        (u64::from(tick) + 1) * self.tick_us
    }

    /// Whether bits can flip.
    pub(super) fn damages(&self) -> bool {
        self.ln_intact != 0.0
    }

    /// Returns whether any bit flipped. The radio separates packets, so it spares the last byte.
    pub(super) fn damage(&self, draws: &mut Rng, packet: &mut [u8]) -> bool {
        if !self.damages() {
            return false;
        }
        let bytes = match packet {
            [bytes @ .., 0] => bytes,
            bytes => bytes,
        };
        let bits = bytes.len() as f64 * 8.0;
        let mut hit = false;
        // The number of intact bits before the next flip is geometric.
        let mut bit = 0.0;
        loop {
            let unit = ((draws.next_u64() >> 11) + 1) as f64 / (1_u64 << 53) as f64;
            bit += libm::floor(libm::log(unit) / self.ln_intact);
            if bit >= bits {
                return hit;
            }
            bytes[bit as usize / 8] ^= 1 << (bit as usize % 8);
            hit = true;
            bit += 1.0;
        }
    }
}

impl Channel {
    fn new(burst: &Burst, tick_us: u32) -> Self {
        // Probability per tick of leaving the bad state: q = renewal * (1 - share) = tick / mean.
        let leave = f64::from(tick_us) / (burst.mean_ms * 1000.0);
        Self { renewal: q32(leave / (1.0 - burst.share)), share: q32(burst.share), loss: q32(burst.loss) }
    }

    /// Walks back to the last redraw of the link's state: an exact Gilbert-Elliott channel without
    /// memory per link, for about mean * (1 - share) ticks of work.
    fn is_bad(&self, seed: u64, sender: RobotId, receiver: RobotId, tick: u32) -> bool {
        let link = Rng::keyed(seed, LINK, sender.0, receiver.0).next_u64();
        (0..=tick)
            .rev()
            .map(|at| (at, Rng::keyed(link, CHANNEL, 0, at)))
            .find_map(|(at, mut draws)| {
                let renewed = draws.chance_q32(self.renewal) || at == 0;
                renewed.then(|| draws.chance_q32(self.share))
            })
            .unwrap_or(false)
    }
}
