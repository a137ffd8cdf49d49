//! Measures of the land at the start (A. V. Kuznetsov 2017, KUZ, section 4).

use super::{Kind, Probe};
use staya_sim::engine::Outcome;
use staya_sim::scenario::Scenario;
use staya_sim::terrain::metrics::{Metrics, obstacles_of_entropy};

pub const KIND: Kind = Kind {
    name: "land",
    measures: &[
        ("entropy", "configuration entropy S"),
        ("total_edge", "total edge TE"),
        ("total_edge_density", "total edge density TED"),
        ("obstacles_of_entropy", "N(S) by KUZ's formula with its constant corrected"),
    ],
    new: |_| Box::new(Land),
};

struct Land;

impl Probe for Land {
    fn values(&self, scenario: &Scenario, _: &Outcome) -> Vec<Option<f64>> {
        let Metrics { entropy, total_edge, total_edge_density, .. } = Metrics::of(&scenario.terrain);
        [entropy, total_edge as f64, total_edge_density, obstacles_of_entropy(entropy)].map(Some).to_vec()
    }
}
