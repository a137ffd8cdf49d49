//! Whether the robots of a formation know of each other.

use super::{Kind, Probe};
use staya_controller::robot::RobotId;
use staya_sim::engine::{Moment, Outcome, Saves};
use staya_sim::record::RobotRow;
use staya_sim::scenario::Scenario;
use std::ops::{ControlFlow, Range};

pub const KIND: Kind = Kind {
    name: "touch",
    measures: &[(
        "share",
        "share of ticks, until a robot arrives, in which the first robot of each formation knows of all \
         others and they of it",
    )],
    new: |scenario| {
        let member = |robot: &staya_sim::scenario::Robot| robot.id;
        Box::new(Touch {
            ids: scenario.robots.iter().map(member).collect(),
            formations: scenario.formations.iter().map(|formation| formation.members()).collect(),
            ticks: 0,
            in_touch: 0,
        })
    },
};

struct Touch {
    ids: Vec<RobotId>,
    formations: Vec<Range<usize>>,
    ticks: u32,
    in_touch: u32,
}

impl Touch {
    fn is_in_touch(&self, run: &dyn Saves, members: &Range<usize>) -> bool {
        let knows = |index: usize, id: RobotId| run.known(index).contains(&id);
        let first = members.start;
        members.clone().skip(1).all(|other| knows(first, self.ids[other]) && knows(other, self.ids[first]))
    }
}

impl Probe for Touch {
    fn tick(&mut self, moment: &Moment<'_>, _: &[RobotRow]) -> ControlFlow<()> {
        // At the start no robot has sent anything.
        if moment.row.tick == 0 || moment.arrived > 0 {
            return ControlFlow::Continue(());
        }
        if let Some(run) = moment.run {
            self.ticks += 1;
            self.in_touch += u32::from(self.formations.iter().all(|members| self.is_in_touch(run, members)));
        }
        ControlFlow::Continue(())
    }

    fn values(&self, _: &Scenario, _: &Outcome) -> Vec<Option<f64>> {
        let is_measured = self.ticks > 0 && !self.formations.is_empty();
        vec![is_measured.then(|| f64::from(self.in_touch) / f64::from(self.ticks))]
    }
}
