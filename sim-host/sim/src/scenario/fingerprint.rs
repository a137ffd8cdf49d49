//! A hash of everything that determines a run.

use super::{KeyRotation, KnownLand, Land, Scenario, Scouting, Trust};
use staya_controller::auth::Key;
use std::fmt::{self, Debug, Write as _};

struct Fingerprint(u64);

impl Fingerprint {
    fn mix(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3);
        }
    }

    fn add(&mut self, value: &impl Debug) {
        // Writing to a hash cannot fail.
        let _ = writeln!(self, "{value:?}");
    }

    fn key(&mut self, key: Option<&Key>) {
        self.add(&key.is_some());
        self.mix(key.map_or(&[][..], |key| key.as_bytes()));
    }
}

impl fmt::Write for Fingerprint {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.mix(text.as_bytes());
        Ok(())
    }
}

impl Scenario {
    /// Hash of all fields that influence a run: scenarios with equal fingerprints run identically
    /// for as long as both last. Excludes name, ticks and output for people. O(cells + robots).
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        let Self {
            name: _,
            seed,
            ticks: _,
            tick_us,
            clocks,
            land: Land { terrain, changes, scouting, known },
            radio,
            robots,
            formations,
            movement,
            laws,
            trust: Trust { misnumbered, keys, plausibility },
            events,
            origin: _,
        } = self;
        let mut all = Fingerprint(0xCBF2_9CE4_8422_2325);
        all.mix(terrain.cells());
        all.add(&(terrain.width(), terrain.height(), terrain.cell_m, terrain.origin_m, changes));
        if let Some(Scouting { map, sight }) = scouting {
            all.mix(map.cells());
            all.add(sight);
        }
        if let Some(KnownLand { map, bytes, moves }) = known {
            all.mix(map.cells());
            all.add(&(bytes, moves));
        }
        all.add(&clocks);
        all.add(&(seed, tick_us, radio, robots, formations, movement, laws, events, misnumbered, plausibility));
        // `Debug` output hides secrets.
        let rotation = keys.as_ref().and_then(|keys| keys.rotation.as_ref());
        all.key(keys.as_ref().map(|keys| &keys.key));
        all.key(rotation.map(|rotation| &rotation.master));
        if let Some(KeyRotation { master: _, place_m, overlap_ticks, rolls }) = rotation {
            all.add(&(place_m, overlap_ticks, rolls));
        }
        all.0
    }
}
