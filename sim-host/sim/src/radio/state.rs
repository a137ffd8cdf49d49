//! Saves and restores the mutable state of the radio.

use super::late::{Late, Saved};
use super::{BLOCK, Counts, Radio};
use serde::{Deserialize, Serialize};

#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct End {
    inbox: Vec<u8>,
    held: Vec<Saved>,
    bytes: Vec<u8>,
    tokens: Option<u64>,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Weather {
    loss_q32: u32,
    range_m: f64,
    total: Counts,
}

impl Radio {
    pub(crate) fn end(&self, index: usize) -> impl Serialize {
        let receiver = &self.receivers[index];
        let (held, bytes) = receiver.late.as_ref().map(|late| late.saved(&self.air)).unwrap_or_default();
        (self.inbox(index).to_vec(), held, bytes, self.medium.tokens(index))
    }

    /// Fails if the state belongs to another radio, or is invalid.
    pub(crate) fn set_end(&mut self, index: usize, end: End) -> Result<(), &'static str> {
        let End { inbox, held, bytes, tokens } = end;
        let late = Late::restored(&held, &bytes, &mut self.air)?;
        if !self.medium.set_tokens(index, tokens) {
            return Err("the bandwidth is bounded there or here, but not in both");
        }
        let receiver = &mut self.receivers[index];
        // The previous content is removed in the next tick.
        let inboxes = &mut self.inboxes[index / BLOCK];
        let (packets, begin) = (inboxes.packets.len() as u32, inboxes.bytes.len() as u32);
        inboxes.bytes.extend_from_slice(&inbox);
        receiver.packets = packets..packets;
        receiver.bytes = begin..inboxes.bytes.len() as u32;
        receiver.late = (!held.is_empty()).then(|| Box::new(late));
        Ok(())
    }

    pub(crate) const fn weather(&self) -> Weather {
        Weather { loss_q32: self.fates.loss_q32(), range_m: self.medium.range_m(), total: self.total }
    }

    pub(crate) const fn set_weather(&mut self, weather: Weather) {
        self.fates.set_loss_q32(weather.loss_q32);
        self.medium.set_range_m(weather.range_m);
        self.total = weather.total;
    }
}
