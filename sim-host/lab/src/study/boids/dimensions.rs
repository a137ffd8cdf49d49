//! Points that a search for the nearest neighbour visits in a k-d tree, over the dimension.
//!
//! STA, section 2.3: in 20 dimensions a k-d tree is not much faster than a search of all points.
//! Counted visits do not depend on the machine, and a visit costs a tree at least what it costs
//! the search of all points.

use super::searches::MidpointTree;
use super::{Given, Study};
use crate::error::SweepError;
use crate::measure::{Job, Measured, Watch};
use staya_controller::rand::Rng;
use staya_sim::nearby::{Search as _, Space};
use staya_sim::{defaults, table};

const POINTS: u32 = 0x0045_0303;
const QUERIES: u32 = 0x0045_0304;

/// The study.
#[derive(Debug)]
pub struct Dimensions;

table! {
    /// Parameters of a run.
    pub struct Parameters {
        /// 1 to 10, 12, 15, 20 or 30.
        pub dimension: u32 = 2;
        /// Points, uniform in the unit cube.
        pub points: u32 = 10_000, 1.0..=1e7, "";
        /// Queries at other such points.
        pub queries: u32 = 200, 1.0..=1e6, "";
    }
}

defaults!(Parameters);

impl Parameters {
    fn measure<const D: usize>(&self, seed: u64, watch: &Watch<'_>) -> Measured {
        let drawn = |purpose: u32, number: u32| -> [f64; D] {
            let mut rng = Rng::keyed(seed, purpose, number, 0);
            std::array::from_fn(|_| f64::from(rng.next_u32()) / 4_294_967_296.0)
        };
        let points: Vec<[f64; D]> = (0..self.points).map(|number| drawn(POINTS, number)).collect();
        let mut tree = MidpointTree::new(Space::OPEN);
        tree.rebuild(&points);
        let (mut visits, mut equal) = (0_u64, 0_u32);
        for number in 0..self.queries {
            if !watch(number) {
                return Measured { is_cut: true, ..Measured::default() };
            }
            let at = drawn(QUERIES, number);
            let found = tree.nearest(at);
            visits += found.visits;
            let squared =
                |point: &[f64; D]| (0..D).map(|axis| (point[axis] - at[axis]) * (point[axis] - at[axis])).sum();
            let least = points.iter().map(squared).fold(f64::INFINITY, f64::min);
            equal += u32::from(least == found.distance_squared);
        }
        let queries = f64::from(self.queries);
        let values = [
            ("visited_percent", 100.0 * visits as f64 / (queries * f64::from(self.points))),
            ("equal", f64::from(equal) / queries),
        ];
        Measured::of(values.map(|(name, value)| (name, Some(value))))
    }

    fn of_dimension(&self) -> Option<fn(&Self, u64, &Watch<'_>) -> Measured> {
        Some(match self.dimension {
            1 => Self::measure::<1>,
            2 => Self::measure::<2>,
            3 => Self::measure::<3>,
            4 => Self::measure::<4>,
            5 => Self::measure::<5>,
            6 => Self::measure::<6>,
            7 => Self::measure::<7>,
            8 => Self::measure::<8>,
            9 => Self::measure::<9>,
            10 => Self::measure::<10>,
            12 => Self::measure::<12>,
            15 => Self::measure::<15>,
            20 => Self::measure::<20>,
            30 => Self::measure::<30>,
            _ => return None,
        })
    }
}

impl Study for Dimensions {
    fn name(&self) -> &'static str {
        "dimensions"
    }

    fn measures(&self) -> Vec<(String, &'static str)> {
        [
            ("visited_percent", "points whose distance the tree computes, of all points, mean of the queries"),
            ("equal", "share of the queries whose distance is that of a search of all points"),
        ]
        .map(|(name, meaning)| (name.to_owned(), meaning))
        .to_vec()
    }

    fn read(&self, given: &Given<'_>) -> Result<Job, SweepError> {
        let (parameters, seed): (Parameters, _) = (given.parameters()?, given.seed);
        let Some(measure) = parameters.of_dimension() else {
            let what = format!("there is no tree in {} dimensions", parameters.dimension);
            return Err(given.error("dimension", what, "give 1 to 10, 12, 15, 20 or 30"));
        };
        Ok(Box::new(move |watch| Ok(measure(&parameters, seed, watch))))
    }
}
