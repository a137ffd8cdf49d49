//! Time and memory of a run, which depend on the machine. Plans that measure them make one run at a
//! time.

use super::process::{Usage, memory_bytes};
use super::{Kind, Probe};
use staya_sim::engine::{Moment, Outcome};
use staya_sim::record::RobotRow;
use staya_sim::scenario::Scenario;
use std::ops::ControlFlow;
use std::time::Instant;

pub const KIND: Kind = Kind {
    name: "cost",
    measures: &[
        ("wall_us", "wall time of a robot and tick, without the first two ticks"),
        ("processor_us", "processor time of all threads for a robot and tick; empty: not known"),
        ("bytes", "largest resident memory of a robot, without that before the run; empty: not known"),
    ],
    new: |_| Box::new(Cost { before: memory_bytes(), most: None, begun: None }),
};

/// Ticks in which memory is allocated and robots first hear of each other.
const WARM_UP: u32 = 2;

struct Cost {
    before: Option<u64>,
    most: Option<u64>,
    begun: Option<(Instant, Usage)>,
}

impl Probe for Cost {
    fn tick(&mut self, moment: &Moment<'_>, _: &[RobotRow]) -> ControlFlow<()> {
        if moment.row.tick == WARM_UP {
            self.begun = Some((Instant::now(), Usage::now()));
        }
        self.most = self.most.max(memory_bytes());
        ControlFlow::Continue(())
    }

    fn values(&self, scenario: &Scenario, outcome: &Outcome) -> Vec<Option<f64>> {
        let robots = scenario.robots.len() as f64;
        let robot_ticks = robots * f64::from(outcome.ticks.saturating_sub(WARM_UP));
        let per_us = |seconds: f64| seconds * 1e6 / robot_ticks;
        let times = self.begun.as_ref().filter(|_| robot_ticks > 0.0).map(|(wall, usage)| {
            [Some(wall.elapsed().as_secs_f64()), Usage::now().since(*usage)].map(|time| time.map(per_us))
        });
        let [wall, processor] = times.unwrap_or_default();
        let bytes = self.most.zip(self.before).map(|(most, before)| most.saturating_sub(before) as f64 / robots);
        vec![wall, processor, bytes]
    }
}
