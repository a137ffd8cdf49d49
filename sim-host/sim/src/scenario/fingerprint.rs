//! A hash of everything that determines a run.

use super::{FormationSetup, KeyRotation, Scenario, Scouting};
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
            files: _,
            tick_us,
            terrain,
            changes,
            scouting,
            rules,
            radio,
            robots,
            formations,
            parts: _,
            plane,
            law,
            route,
            maps,
            formation_law,
            sensing,
            faults,
            interventions,
            misnumbered,
            keys,
            plausibility,
            attacks,
            parameters: _,
        } = self;
        let mut all = Fingerprint(0xCBF2_9CE4_8422_2325);
        all.mix(terrain.cells());
        all.add(&(terrain.width(), terrain.height(), terrain.cell_m, terrain.origin_m));
        let published = match formation_law {
            FormationSetup::Published(params) => Some(params),
            _ => None,
        };
        let formation = formation_law.params();
        all.add(&(seed, tick_us, rules, radio, robots, formations.first(), plane, route, formation, published));
        all.add(&(faults, interventions, misnumbered, plausibility, attacks));
        if !changes.is_empty() {
            all.add(changes);
        }
        if formations.len() > 1 {
            all.add(formations);
        }
        if let Some(Scouting { map, sight }) = scouting {
            all.mix(map.cells());
            all.add(sight);
        }
        // Hashed only if set, so that fingerprints of scenarios without these features are stable.
        if let Some(law) = law {
            all.add(law);
        }
        if matches!(formation_law, FormationSetup::Lookahead(_)) {
            all.add(&true);
        }
        if let Some(maps) = maps {
            all.add(maps);
        }
        if let Some(sensing) = sensing {
            all.add(sensing);
        }
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
