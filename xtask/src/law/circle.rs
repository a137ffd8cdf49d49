//! Circles in the trace of a run.

use crate::prelude::*;
use std::collections::BTreeMap;

/// The circle on which a robot moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    pub centre_m: [f64; 2],
    pub radius_m: f64,
    pub is_right: bool,
}

/// Lines of a robot between the three places that show its circle.
const APART: usize = 40;

/// The circle of each robot at the end of a `trace.csv`.
pub fn circles(trace: &str) -> Result<Vec<Circle>> {
    let mut lines = trace.lines();
    let names: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let column = |name| names.iter().position(|own| *own == name).with_context(|| format!("no column {name}"));
    let (robot, x, y) = (column("robot")?, column("x_m")?, column("y_m")?);
    let mut places: BTreeMap<&str, Vec<[f64; 2]>> = BTreeMap::new();
    for line in lines {
        let fields: Vec<&str> = line.split(',').collect();
        let number = |at: usize| fields.get(at).and_then(|field| field.parse().ok()).with_context(|| line.to_owned());
        places.entry(fields.get(robot).copied().unwrap_or_default()).or_default().push([number(x)?, number(y)?]);
    }
    ensure!(!places.is_empty(), "the trace has no robot");
    let last = |(robot, places): (&str, Vec<[f64; 2]>)| {
        let mut back = places.iter().rev().step_by(APART);
        let found = back.next().zip(back.next()).zip(back.next());
        let circle = found.and_then(|((end, middle), begin)| through(*begin, *middle, *end));
        circle.with_context(|| format!("robot {robot} does not turn"))
    };
    places.into_iter().map(last).collect()
}

/// The circle through three places; `None` if they are on a line.
fn through([x, y]: [f64; 2], middle: [f64; 2], end: [f64; 2]) -> Option<Circle> {
    let [[ax, ay], [bx, by]] = [middle, end].map(|[other_x, other_y]| [other_x - x, other_y - y]);
    let (turn, a, b) = (ax * by - ay * bx, ax * ax + ay * ay, bx * bx + by * by);
    let [to_x, to_y] = [by * a - ay * b, ax * b - bx * a].map(|length| length / (2.0 * turn));
    let radius_m = (to_x * to_x + to_y * to_y).sqrt();
    radius_m.is_finite().then_some(Circle { centre_m: [x + to_x, y + to_y], radius_m, is_right: turn < 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_places_show_a_circle_and_its_sense() {
        let circle = |is_right| Circle { centre_m: [1.0, 2.0], radius_m: 3.0, is_right };
        assert_eq!(through([4.0, 2.0], [1.0, 5.0], [-2.0, 2.0]), Some(circle(false)));
        assert_eq!(through([-2.0, 2.0], [1.0, 5.0], [4.0, 2.0]), Some(circle(true)));
        assert_eq!(through([0.0, 0.0], [1.0, 1.0], [2.0, 2.0]), None);
        assert_eq!(through([0.0, 0.0], [0.0, 0.0], [0.0, 0.0]), None);
    }

    #[test]
    fn robots_that_stand_or_have_few_lines_are_reported() {
        let header = "tick,robot,x_m,y_m\n";
        let stands: String = (0..200).map(|tick| format!("{tick},7,1.5,2\n")).collect();
        for trace in [header.to_owned(), format!("{header}0,7,1,2\n"), format!("{header}{stands}"), String::new()] {
            assert!(circles(&trace).is_err(), "{trace}");
        }
    }
}
