//! Control of a goal flock by the coordinates of its goals (V. E. and V. V. Pavlovsky, PAV,
//! conclusion): sub-goals, a goal that moves, or one so far away that it is a direction.
//!
//! A leg of the way begins at the start and with each order of `[[plane.order]]` for the first
//! goal. The crowd's place is its centroid.

use super::{Kind, Probe};
use staya_controller::agent::{GoalFlockSettings, LawSettings};
use staya_sim::engine::{Moment, Outcome};
use staya_sim::metrics::flock::FlockMeter;
use staya_sim::nearby::Space;
use staya_sim::record::RobotRow;
use staya_sim::scenario::Scenario;
use std::ops::ControlFlow;

pub const KIND: Kind = Kind {
    name: "tracking",
    measures: &[
        ("passed", "share of the robots that came within the arrival distance of the first goal, least of all legs"),
        ("miss_m", "least distance of the crowd from the first goal, largest of all legs"),
        ("lag_m", "mean distance of the crowd from the first goal, from 20 s after the begin of a leg on"),
        ("off_rad", "mean angle between the crowd's velocity and the first goal, likewise"),
        ("speed", "mean speed of the crowd over the highest, likewise"),
        ("together", "least share of the robots in the largest group (links up to 4 R_MinDist), likewise"),
        ("at_first", "share of the robots within the arrival distance of the first goal at the end"),
        ("at_one", "the same of the goal with the most robots"),
    ],
    new: |scenario| Box::new(Tracking { state: State::new(scenario) }),
};

/// Turns and starts take a part of this.
const SETTLED_S: f64 = 20.0;
/// Largest distance in a group, in R_MinDist: the paper's R_nbh.
const LINK: f64 = 4.0;

/// `None` if the robots are not a goal flock.
struct Tracking {
    state: Option<State>,
}

struct State {
    arrival_m: f64,
    max_speed_mps: f64,
    /// Ticks of orders for the first goal.
    orders: Vec<u32>,
    groups: FlockMeter<2>,
    legs: Vec<Leg>,
    begin_s: f64,
    /// Distance, angle and speed, summed over moments.
    sums: [f64; 3],
    moments: u32,
    together: Option<f64>,
    at_goals: Vec<usize>,
}

struct Leg {
    has_passed: Vec<bool>,
    miss_m: f64,
}

impl State {
    fn new(scenario: &Scenario) -> Option<Self> {
        let plane = scenario.plane()?;
        let group = plane.group(0);
        let Some(LawSettings::GoalFlock(GoalFlockSettings { params, arrival_m, .. })) = group.law.built_in() else {
            return None;
        };
        let unit_m = f64::from(params.min_distance_m);
        Some(Self {
            arrival_m: f64::from(*arrival_m),
            max_speed_mps: group.abilities.max_speed_mps,
            orders: plane.orders.iter().filter(|order| order.index == 0).map(|order| order.tick).collect(),
            groups: FlockMeter::new(unit_m, LINK * unit_m, Space::OPEN),
            legs: Vec::new(),
            begin_s: 0.0,
            sums: [0.0; 3],
            moments: 0,
            together: None,
            at_goals: Vec::new(),
        })
    }

    fn look(&mut self, moment: &Moment<'_>, places_m: &[[f64; 2]], velocities_mps: &[[f64; 2]]) {
        let flat = |[x, y, _]: [f64; 3]| [x, y];
        let goals_m: Vec<[f64; 2]> = moment.goals_m.into_iter().flatten().map(flat).collect();
        let Some(&goal_m) = goals_m.first() else { return };
        let (row, robots) = (moment.row, places_m.len());
        let leg = self.orders.iter().filter(|tick| **tick < row.tick).count();
        if self.legs.len() <= leg {
            self.legs.resize_with(leg + 1, || Leg { has_passed: vec![false; robots], miss_m: f64::INFINITY });
            self.begin_s = row.time_s;
        }
        let near = |place: &[f64; 2], goal: &[f64; 2]| distance(*place, *goal) <= self.arrival_m;
        self.at_goals = goals_m.iter().map(|goal| places_m.iter().filter(|place| near(place, goal)).count()).collect();
        let (center_m, velocity_mps) = (mean(places_m), mean(velocities_mps));
        let off_m = distance(center_m, goal_m);
        if let Some(leg) = self.legs.last_mut() {
            leg.miss_m = leg.miss_m.min(off_m);
            leg.has_passed.iter_mut().zip(places_m).for_each(|(has, place)| *has |= near(place, &goal_m));
        }
        if row.time_s - self.begin_s < SETTLED_S {
            return;
        }
        let [east, north] = [0, 1].map(|axis| goal_m[axis] - center_m[axis]);
        let [vx, vy] = velocity_mps;
        let angle = libm::atan2(vx * north - vy * east, vx * east + vy * north).abs();
        let now = [off_m, angle, libm::hypot(vx, vy) / self.max_speed_mps];
        self.sums.iter_mut().zip(now).for_each(|(sum, now)| *sum += now);
        self.moments += 1;
        let largest = self.groups.look(places_m, velocities_mps).map_or(0, |measure| measure.largest_component);
        let share = largest as f64 / robots as f64;
        self.together = Some(self.together.map_or(share, |least| least.min(share)));
    }

    fn values(&self) -> Vec<Option<f64>> {
        let robots = self.legs.first().map_or(0, |leg| leg.has_passed.len()) as f64;
        let passed = |leg: &Leg| leg.has_passed.iter().filter(|has| **has).count() as f64 / robots;
        let mut values = vec![
            self.legs.iter().map(passed).reduce(f64::min),
            self.legs.iter().map(|leg| leg.miss_m).reduce(f64::max),
        ];
        values.extend(self.sums.map(|sum| (self.moments > 0).then(|| sum / f64::from(self.moments))));
        let share = |at: Option<&usize>| at.map(|at| *at as f64 / robots);
        values.extend([self.together, share(self.at_goals.first()), share(self.at_goals.iter().max())]);
        values
    }
}

fn distance([x, y]: [f64; 2], [u, v]: [f64; 2]) -> f64 {
    libm::hypot(x - u, y - v)
}

fn mean(vectors: &[[f64; 2]]) -> [f64; 2] {
    let sum = vectors.iter().fold([0.0; 2], |sum, vector| [sum[0] + vector[0], sum[1] + vector[1]]);
    sum.map(|c| c / vectors.len() as f64)
}

impl Probe for Tracking {
    fn tick(&mut self, moment: &Moment<'_>, robots: &[RobotRow]) -> ControlFlow<()> {
        if let Some(state) = &mut self.state {
            let flat = |[x, y, _]: [f64; 3]| [x, y];
            let motion = |robot: &RobotRow| (flat(robot.motion.position_m), flat(robot.motion.velocity_mps));
            let (places_m, velocities_mps): (Vec<_>, Vec<_>) = robots.iter().map(motion).unzip();
            state.look(moment, &places_m, &velocities_mps);
        }
        ControlFlow::Continue(())
    }

    fn values(&self, _: &Scenario, _: &Outcome) -> Vec<Option<f64>> {
        self.state.as_ref().map_or(vec![None; KIND.measures.len()], State::values)
    }
}
