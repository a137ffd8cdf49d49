//! Structures that arise in a crowd in the plane: places relative to each other, as in a lattice of
//! triangles.

use super::{Kind, Probe};
use staya_sim::engine::{Moment, Outcome};
use staya_sim::record::RobotRow;
use staya_sim::scenario::Scenario;
use std::ops::ControlFlow;

pub const KIND: Kind = Kind {
    name: "structure",
    measures: &[
        ("hexatic", "mean hexatic order of robots at the end: 1 if its six nearest are every 60 degrees around each"),
        ("first_hexatic", "the same at the start"),
        ("uneven", "standard deviation over mean of the distances to the nearest robot at the end"),
        ("first_uneven", "the same at the start"),
    ],
    new: |_| Box::new(Structure { first: None, last_m: Vec::new() }),
};

/// Neighbours of a place in a lattice of triangles.
const AROUND: usize = 6;

struct Structure {
    first: Option<[Option<f64>; 2]>,
    last_m: Vec<[f64; 2]>,
}

/// Hexatic order and unevenness; `None` with too few robots. O(n^2).
fn order(places_m: &[[f64; 2]]) -> [Option<f64>; 2] {
    let count = places_m.len();
    if count <= AROUND {
        return [None; 2];
    }
    let (mut hexatic, mut nearest) = (0.0, Vec::new());
    for (robot, [x, y]) in places_m.iter().enumerate() {
        let others = places_m.iter().enumerate().filter(|(other, _)| *other != robot);
        let mut offsets: Vec<[f64; 2]> = others.map(|(_, place)| [place[0] - x, place[1] - y]).collect();
        offsets.sort_by(|a, b| libm::hypot(a[0], a[1]).total_cmp(&libm::hypot(b[0], b[1])));
        let sum = offsets[..AROUND].iter().fold([0.0; 2], |sum, [x, y]| {
            let (sin, cos) = libm::sincos(AROUND as f64 * libm::atan2(*y, *x));
            [sum[0] + cos, sum[1] + sin]
        });
        hexatic += libm::hypot(sum[0], sum[1]) / AROUND as f64;
        nearest.push(libm::hypot(offsets[0][0], offsets[0][1]));
    }
    let mean = nearest.iter().sum::<f64>() / count as f64;
    let variance = nearest.iter().map(|length| (length - mean) * (length - mean)).sum::<f64>() / count as f64;
    [Some(hexatic / count as f64), Some(libm::sqrt(variance) / mean).filter(|ratio| ratio.is_finite())]
}

impl Probe for Structure {
    fn tick(&mut self, _: &Moment<'_>, robots: &[RobotRow]) -> ControlFlow<()> {
        self.last_m.clear();
        self.last_m.extend(robots.iter().map(|robot| [robot.motion.position_m[0], robot.motion.position_m[1]]));
        self.first.get_or_insert_with(|| order(&self.last_m));
        ControlFlow::Continue(())
    }

    fn values(&self, _: &Scenario, _: &Outcome) -> Vec<Option<f64>> {
        let ([hexatic, uneven], [first_hexatic, first_uneven]) = (order(&self.last_m), self.first.unwrap_or_default());
        vec![hexatic, first_hexatic, uneven, first_uneven]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lattice_is_hexatic_and_even_and_a_row_of_pairs_is_not() {
        let lattice: Vec<[f64; 2]> = (0..20)
            .flat_map(|row| (0..20).map(move |column| (row, column)))
            .map(|(row, column)| [f64::from(column) + 0.5 * f64::from(row), 0.75_f64.sqrt() * f64::from(row)])
            .collect();
        let [hexatic, uneven] = order(&lattice).map(Option::unwrap);
        assert!(hexatic > 0.85 && uneven < 1e-9, "{hexatic} {uneven}");
        let pairs: Vec<[f64; 2]> =
            (0..40).map(|robot| [f64::from(robot / 2) * (2.0 + f64::from(robot % 2)), 0.0]).collect();
        assert!(order(&pairs)[1].unwrap() > 0.1);
        let square: Vec<[f64; 2]> = (0..400).map(|robot| [f64::from(robot % 20), f64::from(robot / 20)]).collect();
        assert!(order(&square)[0].unwrap() < 0.7);
        assert_eq!(order(&lattice[..6]), [None; 2]);
    }
}
