//! The plotted figures of all ticks, for the plots of pages (`PROTOCOL.md`, `figures`).

use crate::frame::Figures;
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde_json::json;

const MOST: usize = 1 << 16;

/// Figures by tick. Above the limit every second row is dropped, and added from then on.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    rows: Vec<(u32, [f32; 8])>,
    every: u32,
    /// Number of the first row that pages do not have.
    unsent: usize,
}

impl Default for Series {
    fn default() -> Self {
        Self { rows: Vec::new(), every: 1, unsent: 0 }
    }
}

impl Series {
    /// Drops rows from this tick on.
    pub fn put(&mut self, tick: u32, figures: &Figures) {
        self.forget_from(tick);
        if !tick.is_multiple_of(self.every) {
            return;
        }
        self.rows.push((tick, figures.plotted()));
        if self.rows.len() > MOST && self.every <= u32::MAX / 2 {
            self.every *= 2;
            let every = self.every;
            self.rows.retain(|(tick, _)| tick.is_multiple_of(every));
            self.unsent = self.unsent.div_ceil(2);
        }
    }

    pub fn forget_from(&mut self, tick: u32) {
        self.rows.truncate(self.rows.partition_point(|(known, _)| *known < tick));
        self.unsent = self.unsent.min(self.rows.len());
    }

    pub const fn has_unsent(&self) -> bool {
        self.unsent < self.rows.len()
    }

    /// The rows that pages do not have, which they get with this message.
    pub fn unsent(&mut self) -> String {
        let rows = &self.rows[std::mem::replace(&mut self.unsent, self.rows.len())..];
        self.message(rows)
    }

    /// All rows.
    pub fn all(&self) -> String {
        self.message(&self.rows)
    }

    fn message(&self, rows: &[(u32, [f32; 8])]) -> String {
        let apart = self.rows.windows(2).map(|pair| pair[1].0 - pair[0].0).max();
        let mut bytes = Vec::with_capacity(rows.len() * 36);
        for (tick, figures) in rows {
            bytes.extend(tick.to_le_bytes());
            figures.iter().for_each(|figure| bytes.extend(figure.to_le_bytes()));
        }
        let every = apart.unwrap_or(1).max(self.every);
        json!({ "type": "figures", "every": every, "rows": BASE64_STANDARD.encode(bytes) }).to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ticks(message: &str) -> (u64, Vec<u32>) {
        let message: serde_json::Value = serde_json::from_str(message).expect("JSON");
        let rows = BASE64_STANDARD.decode(message["rows"].as_str().expect("a text")).expect("base64");
        let ticks = rows.chunks_exact(36).map(|row| u32::from_le_bytes([row[0], row[1], row[2], row[3]]));
        (message["every"].as_u64().expect("a number"), ticks.collect())
    }

    #[test]
    fn pages_get_each_row_once_and_new_rows_replace_old_ones() {
        let (mut series, figures) = (Series::default(), Figures::default());
        (0..5).for_each(|tick| series.put(tick, &figures));
        assert_eq!(ticks(&series.unsent()), (1, vec![0, 1, 2, 3, 4]));
        assert!(!series.has_unsent());
        series.put(2, &figures);
        series.put(3, &figures);
        assert_eq!(ticks(&series.unsent()), (1, vec![2, 3]));
        assert_eq!(ticks(&series.all()), (1, vec![0, 1, 2, 3]));
    }

    #[test]
    fn a_long_series_thins_out_evenly() {
        let (mut series, figures) = (Series::default(), Figures::default());
        (0..200_000).for_each(|tick| series.put(tick, &figures));
        let (every, ticks) = ticks(&series.all());
        assert!(ticks.len() <= MOST && ticks.len() > MOST / 2 && ticks[0] == 0);
        assert!(ticks.windows(2).all(|pair| u64::from(pair[1] - pair[0]) == every));
    }
}
