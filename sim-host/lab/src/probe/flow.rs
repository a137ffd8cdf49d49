//! Two crowds that pass the line x = 0 in opposite directions.

use super::{Kind, Probe};
use staya_sim::engine::{Moment, Outcome};
use staya_sim::record::RobotRow;
use staya_sim::scenario::Scenario;
use std::ops::ControlFlow;

pub const KIND: Kind = Kind {
    name: "flow",
    measures: &[
        ("from_west", "robots from the west that passed"),
        ("from_east", "robots from the east that passed"),
        ("per_s", "robots that cross the line, over the time from the first to the last"),
        ("turns", "changes of direction between two that pass; 1: one crowd after the other"),
    ],
    new: |scenario| {
        let plane = scenario.plane().into_iter();
        let robot = plane.flat_map(|plane| {
            let side = |(index, start): (usize, &staya_sim::scenario::Start)| Crosser {
                side: start.position_m[0].signum(),
                radius_m: plane.group(index).radius_m,
                has_crossed: false,
                has_passed: false,
            };
            plane.starts.iter().enumerate().map(side)
        });
        Box::new(Flow { robots: robot.collect(), last: 0.0, turns: 0, crossings_s: None })
    },
};

struct Crosser {
    side: f64,
    radius_m: f64,
    has_crossed: bool,
    has_passed: bool,
}

struct Flow {
    robots: Vec<Crosser>,
    last: f64,
    turns: u32,
    /// The first and the last time at which a robot's centre crossed the line for the first time.
    crossings_s: Option<[f64; 2]>,
}

impl Probe for Flow {
    fn tick(&mut self, moment: &Moment<'_>, rows: &[RobotRow]) -> ControlFlow<()> {
        let now_s = moment.row.time_s;
        for (robot, row) in self.robots.iter_mut().zip(rows) {
            if !robot.has_crossed && row.motion.position_m[0] * robot.side < 0.0 {
                robot.has_crossed = true;
                let [first_s, _] = self.crossings_s.unwrap_or([now_s; 2]);
                self.crossings_s = Some([first_s, now_s]);
            }
            // Beyond the line by a radius, so that a robot pushed back and forth counts once.
            if !robot.has_passed && row.motion.position_m[0] * robot.side < -robot.radius_m {
                robot.has_passed = true;
                self.turns += u32::from(self.last != 0.0 && self.last != robot.side);
                self.last = robot.side;
            }
        }
        ControlFlow::Continue(())
    }

    fn values(&self, _: &Scenario, _: &Outcome) -> Vec<Option<f64>> {
        let from = |side: f64| self.robots.iter().filter(|robot| robot.has_passed && robot.side == side).count() as f64;
        let crossed = self.robots.iter().filter(|robot| robot.has_crossed).count() as f64;
        // The definition of pedpy 1.5, with one window for the whole run.
        let per_s = self.crossings_s.filter(|[first_s, last_s]| last_s > first_s);
        let per_s = per_s.map(|[first_s, last_s]| crossed / (last_s - first_s));
        vec![Some(from(-1.0)), Some(from(1.0)), per_s, Some(f64::from(self.turns))]
    }
}
