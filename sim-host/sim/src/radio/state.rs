//! What of the radio changes while it is used: to be kept, and moved.

use super::{BLOCK, Counts, Held, Late, Radio};
use serde::{Deserialize, Serialize};

/// One robot's end of the radio.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct End {
    inbox: Vec<u8>,
    held: Vec<Held>,
    bytes: Vec<u8>,
    /// What it may still send; `None`: as much as it likes.
    tokens: Option<u64>,
}

/// What is of the whole radio.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Weather {
    loss_q32: u32,
    range_m: f64,
    total: Counts,
}

impl Radio {
    /// The end of robot number `index`.
    pub(crate) fn end(&self, index: usize) -> impl Serialize {
        let receiver = &self.receivers[index];
        let (held, bytes) = receiver.late.as_ref().map_or((&[][..], &[][..]), |late| (&late.held, &late.bytes));
        (self.inbox(index), held, bytes, self.medium.tokens(index))
    }

    /// Puts it back.
    ///
    /// # Errors
    /// It is of another radio, or of none.
    pub(crate) fn set_end(&mut self, index: usize, end: End) -> Result<(), &'static str> {
        let End { inbox, held, bytes, tokens } = end;
        let is_there = |held: &Held| {
            let end = u64::from(held.start) + u64::from(held.length);
            end <= bytes.len() as u64
        };
        if !held.iter().all(is_there) {
            return Err("a packet that is held back has no bytes");
        }
        if !self.medium.set_tokens(index, tokens) {
            return Err("the bandwidth is bounded there or here, but not in both");
        }
        let receiver = &mut self.receivers[index];
        // What lay there before goes with the next tick.
        let inboxes = &mut self.inboxes[index / BLOCK];
        let begin = inboxes.len() as u32;
        inboxes.extend_from_slice(&inbox);
        receiver.inbox = begin..inboxes.len() as u32;
        receiver.late = (!held.is_empty()).then(|| Box::new(Late { held, bytes, spare: Vec::new() }));
        Ok(())
    }

    /// What is of all ends together.
    pub(crate) const fn weather(&self) -> Weather {
        Weather { loss_q32: self.fates.loss_q32(), range_m: self.medium.range_m(), total: self.total }
    }

    /// Puts it back.
    pub(crate) const fn set_weather(&mut self, weather: Weather) {
        self.fates.set_loss_q32(weather.loss_q32);
        self.medium.set_range_m(weather.range_m);
        self.total = weather.total;
    }
}
