//! State of an alpha flock at the end of a run.

use super::{Kind, Probe};
use staya_controller::agent::GuidanceSetup;
use staya_sim::engine::{Moment, Outcome};
use staya_sim::metrics::flock::FlockMeter;
use staya_sim::record::RobotRow;
use staya_sim::scenario::Scenario;
use staya_sim::world::plane::Solid;
use std::ops::ControlFlow;

pub const KIND: Kind = Kind {
    name: "flock",
    measures: &[
        ("parts", "connected parts of the flock at the end; links are up to 1.2 spacings long"),
        ("past", "robots east of all balls at the end"),
    ],
    new: |_| Box::new(Flock::default()),
};

#[derive(Default)]
struct Flock {
    positions_m: Vec<[f64; 3]>,
    velocities_mps: Vec<[f64; 3]>,
}

impl Probe for Flock {
    fn tick(&mut self, _: &Moment<'_>, robots: &[RobotRow]) -> ControlFlow<()> {
        let motion = |robot: &RobotRow| (robot.motion.position_m, robot.motion.velocity_mps);
        (self.positions_m, self.velocities_mps) = robots.iter().map(motion).unzip();
        ControlFlow::Continue(())
    }

    fn values(&self, scenario: &Scenario, _: &Outcome) -> Vec<Option<f64>> {
        let Some(plane) = &scenario.plane else { return vec![None; KIND.measures.len()] };
        let spacing_m = match &plane.group(0).guidance {
            GuidanceSetup::Lattice { params, .. } => Some(f64::from(params.spacing_m)),
            _ => None,
        };
        let state = spacing_m.and_then(|spacing_m| {
            let mut meter = FlockMeter::<3>::new(spacing_m, 1.2 * spacing_m, plane.space());
            meter.look(&self.positions_m, &self.velocities_mps)
        });
        let ends = plane.solids.iter().filter_map(|solid| match solid {
            Solid::Ball { center_m, radius_m } => Some(center_m[0] + radius_m),
            _ => None,
        });
        let past = ends.reduce(f64::max).map(|x| self.positions_m.iter().filter(|place| place[0] > x).count() as f64);
        vec![state.map(|state| state.components as f64), past]
    }
}
