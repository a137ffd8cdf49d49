//! Measurements on the way to the goals.

use super::Plan;
use super::scene::{Scene, middle_m};
use super::setting::Setting;
use crate::experiment::rows::{Each, Record};
use staya_sim::metrics::flock::{FlockMeter, gaps, polarisation};
use staya_sim::nearby::Space;

/// Robots start at rest, so nothing is measured before.
const WARM_UP_S: f64 = 5.0;
/// From this share of gathered robots on, robots part and crowd around the middle.
const WAY_ENDS: f64 = 0.1;
/// Largest distance in a group, in R_MinDist: the repulsion's range.
const LINK: f64 = 2.0;
/// In R_MinDist: the paper's R_nbh, independent of the run's, so that runs are comparable.
const COMPANY: f64 = 4.0;

pub(super) const MOMENTS: [f64; 6] = [0.0, 0.125, 0.25, 0.375, 0.5, 1.0];

/// Measurements of one run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Run {
    /// Means over the way; `None` if it ended before the first measurement.
    pub way: Option<Way>,
    /// Robots that reached the middle.
    pub gathered: usize,
    /// Time until half of the robots had gathered, seconds.
    pub half_gathered_s: Option<f64>,
    /// Robots at each goal at the end.
    pub at_goals: [usize; 4],
    /// Smallest distance of two centres, metres; infinite if all were beyond R_MinDist.
    pub least_pair_m: f64,
    /// Pairs of overlapping bodies, summed over ticks.
    pub overlaps: usize,
    /// Moments for pictures.
    pub frames: Vec<Frame>,
    /// Trace hash.
    pub hash: u64,
}

impl Record for Run {
    fn figures(&mut self, each: &mut Each<'_>) {
        let way = self.way;
        let part = |value: fn(&Way) -> f64| way.as_ref().map(value);
        let [mut polarisation, mut together, mut company, mut spread] =
            [part(|way| way.polarisation), part(|way| way.together), part(|way| way.company), part(|way| way.spread)];
        each("polarisation", "length of the mean direction on the way; empty: it was over at once", &mut polarisation);
        each("together", "share of the largest group on the way", &mut together);
        each("company", "robots within four R_MinDist of a robot on the way, mean", &mut company);
        each("spread", "radius of the crowd on the way over that at the start", &mut spread);
        self.way = match (polarisation, together, company, spread) {
            (Some(polarisation), Some(together), Some(company), Some(spread)) => {
                Some(Way { polarisation, together, company, spread })
            }
            _ => None,
        };
        let [first, second, third, fourth] = &mut self.at_goals;
        each("gathered", "robots that came to the middle", &mut self.gathered);
        each("half_gathered_s", "when half of them had; empty: never", &mut self.half_gathered_s);
        each("at_goal_1", "robots at the first goal at the end", first);
        each("at_goal_2", "robots at the second goal at the end", second);
        each("at_goal_3", "robots at the third goal at the end", third);
        each("at_goal_4", "robots at the fourth goal at the end", fourth);
        each("least_pair_m", "least distance of two centres; inf: more than R_MinDist", &mut self.least_pair_m);
        each("overlaps", "overlapping pairs, summed over ticks", &mut self.overlaps);
    }

    fn trace_hash(&mut self) -> Option<&mut u64> {
        Some(&mut self.hash)
    }
}

/// Means over ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Way {
    /// Of the robots that have not gathered yet.
    pub polarisation: f64,
    pub together: f64,
    /// Robots within four R_MinDist of a robot.
    pub company: f64,
    /// Root mean square distance from the centroid, divided by that at the start.
    pub spread: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    pub tick: u32,
    pub places_m: Vec<[f64; 2]>,
    pub velocities_mps: Vec<[f64; 2]>,
}

pub struct Watch<'a> {
    scene: &'a Scene,
    arrival_m: f64,
    radius_m: f64,
    min_distance_m: f64,
    step_s: f64,
    wanted: Vec<u32>,
    warm_up: u32,
    groups: FlockMeter<2>,
    company: FlockMeter<2>,
    has_gathered: Vec<bool>,
    places_m: Vec<[f64; 2]>,
    velocities_mps: Vec<[f64; 2]>,
    first_spread_m: f64,
    sum: Way,
    looks: u32,
    run: Run,
}

impl<'a> Watch<'a> {
    pub fn new(plan: &Plan, setting: &Setting, scene: &'a Scene, draws: bool) -> Self {
        let ticks = crate::arena::ticks(plan.seconds, plan.step_s);
        let at = |share: f64| libm::round(share * f64::from(ticks)) as u32;
        let unit = plan.min_distance_m;
        Self {
            scene,
            arrival_m: setting.arrival() * unit,
            radius_m: plan.radius_m(),
            min_distance_m: unit,
            step_s: plan.step_s,
            wanted: if draws { MOMENTS.map(at).to_vec() } else { Vec::new() },
            warm_up: crate::arena::ticks(WARM_UP_S, plan.step_s),
            groups: FlockMeter::new(unit, LINK * unit, Space::OPEN),
            company: FlockMeter::new(unit, COMPANY * unit, Space::OPEN),
            has_gathered: vec![false; scene.starts.len()],
            places_m: Vec::new(),
            velocities_mps: Vec::new(),
            first_spread_m: 0.0,
            sum: Way::default(),
            looks: 0,
            run: Run { least_pair_m: f64::INFINITY, ..Run::default() },
        }
    }

    pub fn look(&mut self, tick: u32, places_m: Vec<[f64; 2]>, velocities_mps: Vec<[f64; 2]>) {
        let goals_m = self.scene.goals_at(tick);
        let middle_m = middle_m(&goals_m);
        (self.places_m, self.velocities_mps) = (places_m, velocities_mps);
        self.run.at_goals = [0; 4];
        for (&[x, y], has_gathered) in self.places_m.iter().zip(&mut self.has_gathered) {
            let off_m = |place_m: [f64; 3]| libm::hypot(x - place_m[0], y - place_m[1]);
            *has_gathered |= off_m(middle_m) <= self.arrival_m;
            let nearest = (0..).zip(&goals_m).map(|(goal, &at)| (off_m(at), goal)).min_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((_, goal)) = nearest.filter(|(off, _): &(f64, usize)| *off <= self.arrival_m + 0.01) {
                self.run.at_goals[goal] += usize::from(*has_gathered);
            }
        }
        self.look_at_pairs();
        self.look_at_crowd(tick);
        if self.wanted.contains(&tick) {
            self.run.frames.push(Frame {
                tick,
                places_m: self.places_m.clone(),
                velocities_mps: self.velocities_mps.clone(),
            });
        }
    }

    fn look_at_pairs(&mut self) {
        let radius_m = self.radius_m;
        let radii = vec![radius_m; self.places_m.len()];
        let horizon_m = self.min_distance_m - 2.0 * radius_m;
        let gaps = gaps(&self.places_m, &radii, &[], horizon_m, Space::OPEN);
        self.run.overlaps += gaps.overlapping_pairs;
        if let Some(gap_m) = gaps.between_robots_m {
            self.run.least_pair_m = self.run.least_pair_m.min(gap_m + 2.0 * radius_m);
        }
    }

    fn look_at_crowd(&mut self, tick: u32) {
        let robots = self.has_gathered.len();
        self.run.gathered = self.has_gathered.iter().filter(|has| **has).count();
        if 2 * self.run.gathered >= robots && self.run.half_gathered_s.is_none() {
            self.run.half_gathered_s = Some(f64::from(tick) * self.step_s);
        }
        let spread_m = spread(&self.places_m);
        if tick == 0 {
            self.first_spread_m = spread_m;
        }
        if tick < self.warm_up || self.run.gathered as f64 >= WAY_ENDS * robots as f64 {
            return;
        }
        let on_way = self.velocities_mps.iter().zip(&self.has_gathered);
        let on_way: Vec<[f64; 2]> = on_way.filter(|(_, has)| !**has).map(|(v, _)| *v).collect();
        let groups = self.groups.look(&self.places_m, &self.velocities_mps);
        let largest = groups.map_or(0, |measure| measure.largest_component);
        let company = self.company.look(&self.places_m, &self.velocities_mps);
        let pairs = company.map_or(0, |measure| measure.edges);
        self.sum.polarisation += polarisation(&on_way);
        self.sum.together += largest as f64 / robots as f64;
        self.sum.company += 2.0 * pairs as f64 / robots as f64;
        self.sum.spread += spread_m / self.first_spread_m;
        self.looks += 1;
    }

    pub fn finish(mut self, hash: u64) -> Run {
        let looks = f64::from(self.looks);
        self.run.way = (self.looks > 0).then(|| Way {
            polarisation: self.sum.polarisation / looks,
            together: self.sum.together / looks,
            company: self.sum.company / looks,
            spread: self.sum.spread / looks,
        });
        self.run.hash = hash;
        self.run
    }
}

fn spread(places_m: &[[f64; 2]]) -> f64 {
    let count = places_m.len() as f64;
    let variance = |axis: usize| {
        let mean = places_m.iter().map(|place| place[axis]).sum::<f64>() / count;
        let squares = places_m.iter().map(|place| (place[axis] - mean) * (place[axis] - mean));
        squares.sum::<f64>() / count
    };
    libm::sqrt(variance(0) + variance(1))
}
