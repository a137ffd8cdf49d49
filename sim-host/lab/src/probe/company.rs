//! Group order of a goal flock on its way to the middle of its goals (V. E. and V. V. Pavlovsky,
//! PAV).
//!
//! Measures of order are averaged from 5 s on, until a tenth of the robots were at the middle,
//! because robots part from then on. A robot has gathered once its distance to the middle was at
//! most the arrival distance. Robots with K2 = 0 are independent, and their company is an effect of
//! the start and of the common goal, so compare with them. From a dense start robots are one group
//! without any K2, and a larger K2 draws them into clumps.

use super::{Kind, Probe};
use staya_controller::agent::{GOALS, GoalFlockSettings, LawSettings};
use staya_sim::engine::{Moment, Outcome};
use staya_sim::metrics::flock::{FlockMeter, polarisation};
use staya_sim::nearby::Space;
use staya_sim::record::RobotRow;
use staya_sim::scenario::Scenario;
use std::ops::ControlFlow;

pub const KIND: Kind = Kind {
    name: "company",
    measures: &[
        ("polarisation", "length of the mean direction on the way, 0 to 1; empty: it was over at once"),
        ("together", "share of the robots in the largest group on the way (linked within 2 R_MinDist)"),
        ("company", "robots within 4 R_MinDist of a robot on the way, mean"),
        ("spread", "radius of the crowd on the way over that at the start"),
        ("gathered", "share of the robots that came to the middle of the goals"),
        ("half_gathered_s", "when half of them had; empty: never"),
        ("arrived", "share of the robots at a goal at the end"),
        ("largest_share", "share of the most popular goal among these"),
        ("share_1", "share of the first goal among these"),
        ("share_2", "share of the second goal"),
        ("share_3", "share of the third goal"),
        ("share_4", "share of the fourth goal"),
    ],
    new: |scenario| Box::new(Company { state: State::new(scenario) }),
};

/// Robots start at rest, so nothing is measured before.
const WARM_UP_S: f64 = 5.0;
/// From this share of gathered robots on, robots part and crowd around the middle.
const WAY_ENDS: f64 = 0.1;
/// Largest distance in a group, in R_MinDist: the repulsion's range.
const LINK: f64 = 2.0;
/// In R_MinDist: the paper's R_nbh, independent of the run's, so that runs are comparable.
const COMPANY: f64 = 4.0;

/// `None` if the robots are not a goal flock.
struct Company {
    state: Option<State>,
}

struct State {
    arrival_m: f64,
    groups: FlockMeter<2>,
    company: FlockMeter<2>,
    has_gathered: Vec<bool>,
    half_gathered_s: Option<f64>,
    at_goals: Vec<usize>,
    first_spread_m: f64,
    /// Polarisation, group, company and spread, summed over looks.
    sums: [f64; 4],
    looks: u32,
}

impl State {
    fn new(scenario: &Scenario) -> Option<Self> {
        let plane = scenario.plane()?;
        let Some(LawSettings::GoalFlock(GoalFlockSettings { params, arrival_m, .. })) = plane.group(0).law.built_in()
        else {
            return None;
        };
        let unit_m = f64::from(params.min_distance_m);
        Some(Self {
            arrival_m: f64::from(*arrival_m),
            groups: FlockMeter::new(unit_m, LINK * unit_m, Space::OPEN),
            company: FlockMeter::new(unit_m, COMPANY * unit_m, Space::OPEN),
            has_gathered: vec![false; plane.starts.len()],
            half_gathered_s: None,
            at_goals: Vec::new(),
            first_spread_m: 0.0,
            sums: [0.0; 4],
            looks: 0,
        })
    }

    fn gathered(&self) -> usize {
        self.has_gathered.iter().filter(|has| **has).count()
    }

    fn look(&mut self, moment: &Moment<'_>, places_m: &[[f64; 2]], velocities_mps: &[[f64; 2]]) {
        let goals_m: Vec<[f64; 3]> = moment.goals_m.into_iter().flatten().collect();
        let middle_m = [0, 1].map(|axis| goals_m.iter().map(|goal| goal[axis]).sum::<f64>() / goals_m.len() as f64);
        self.at_goals = vec![0; goals_m.len()];
        for (&[x, y], has_gathered) in places_m.iter().zip(&mut self.has_gathered) {
            *has_gathered |= libm::hypot(x - middle_m[0], y - middle_m[1]) <= self.arrival_m;
            let off = goals_m.iter().map(|goal| libm::hypot(x - goal[0], y - goal[1])).enumerate();
            let nearest = off.min_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((goal, _)) = nearest.filter(|(_, off_m)| *off_m <= self.arrival_m + 0.01) {
                self.at_goals[goal] += usize::from(*has_gathered);
            }
        }
        let (robots, gathered) = (places_m.len() as f64, self.gathered() as f64);
        if 2.0 * gathered >= robots {
            self.half_gathered_s.get_or_insert(moment.row.time_s);
        }
        let spread_m = spread(places_m);
        if moment.row.tick == 0 {
            self.first_spread_m = spread_m;
        }
        if moment.row.time_s < WARM_UP_S || gathered >= WAY_ENDS * robots {
            return;
        }
        let on_way = velocities_mps.iter().zip(&self.has_gathered);
        let on_way: Vec<[f64; 2]> = on_way.filter(|(_, has)| !**has).map(|(v, _)| *v).collect();
        let largest = self.groups.look(places_m, velocities_mps).map_or(0, |measure| measure.largest_component);
        let pairs = self.company.look(places_m, velocities_mps).map_or(0, |measure| measure.edges);
        let now = [
            polarisation(&on_way),
            largest as f64 / robots,
            2.0 * pairs as f64 / robots,
            spread_m / self.first_spread_m,
        ];
        self.sums.iter_mut().zip(now).for_each(|(sum, now)| *sum += now);
        self.looks += 1;
    }

    fn values(&self) -> Vec<Option<f64>> {
        let robots = self.has_gathered.len() as f64;
        let arrived = self.at_goals.iter().sum::<usize>() as f64;
        let share = |at: Option<&usize>| at.map(|at| *at as f64 / arrived).filter(|share| share.is_finite());
        let mut values = self.sums.map(|sum| (self.looks > 0).then(|| sum / f64::from(self.looks))).to_vec();
        values.extend([
            Some(self.gathered() as f64 / robots),
            self.half_gathered_s,
            Some(arrived / robots),
            share(self.at_goals.iter().max()),
        ]);
        values.extend((0..GOALS).map(|goal| share(self.at_goals.get(goal))));
        values
    }
}

/// Root mean square distance from the centroid.
fn spread(places_m: &[[f64; 2]]) -> f64 {
    let count = places_m.len() as f64;
    let variance = |axis: usize| {
        let mean = places_m.iter().map(|place| place[axis]).sum::<f64>() / count;
        places_m.iter().map(|place| (place[axis] - mean) * (place[axis] - mean)).sum::<f64>() / count
    };
    libm::sqrt(variance(0) + variance(1))
}

impl Probe for Company {
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
