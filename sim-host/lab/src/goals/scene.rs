//! Random places of robots, goals and obstacles, a function of the run's number, in R_MinDist.

use super::setting::Setting;
use super::{Plan, STARTS};
use crate::arena::{distance_m, starts, ticks, uniform};
use anyhow::{Context as _, Result, bail};
use staya_controller::rand::Rng;
use staya_sim::scenario::{Start, Target};
use staya_sim::world::plane::Solid;

const MIDDLE: [f64; 2] = [70.0, 0.0];
const AROUND: f64 = 25.0;
/// Largest distance from the middle, and smallest distance from each other.
const GOAL_FIELD: [f64; 2] = [40.0, 25.0];
const MOVED: [f64; 2] = [90.0, 20.0];
const LAST: f64 = 50.0;
const ROOM: f64 = 3.0;
const RADII: [f64; 2] = [1.0, 3.0];
const TRIES: u32 = 1000;

#[derive(Clone, Debug)]
pub struct Scene {
    pub starts: Vec<Start>,
    pub solids: Vec<Solid>,
    goals_m: Vec<[f64; 3]>,
    velocity_mps: [f64; 3],
    moves: Option<(u32, [f64; 3])>,
    step_s: f64,
}

impl Scene {
    pub fn new(plan: &Plan, setting: &Setting, run: u32) -> Result<Self> {
        let unit = plan.min_distance_m;
        let goals_m = goals(plan, setting, run)?;
        let velocity_mps = [0.0, setting.goal_speed_mps, 0.0];
        let targets: Vec<Target> = goals_m.iter().map(|&position_m| Target { position_m, velocity_mps }).collect();
        let side = setting.start_half() * unit;
        let starts = starts(
            setting.robots,
            unit,
            &targets,
            |robot| Rng::keyed(plan.seed, STARTS, run, robot),
            |rng| {
                let place = [uniform(rng, -side, side), uniform(rng, -side, side), 0.0];
                (place, [0.0; 3])
            },
        )
        .with_context(|| format!("{} robots find no room; give fewer", setting.robots))?;
        let moves_at = ticks(plan.seconds / 4.0, plan.step_s);
        let moved_m = [MOVED[0] * unit, MOVED[1] * unit, 0.0];
        Ok(Self {
            starts,
            solids: solids(plan, setting, run)?,
            goals_m,
            velocity_mps,
            moves: plan.moves_goal.then_some((moves_at, moved_m)),
            step_s: plan.step_s,
        })
    }

    #[must_use]
    pub fn goals_at(&self, tick: u32) -> Vec<[f64; 3]> {
        let after = |place_m: [f64; 3], since: u32| {
            let span_s = f64::from(tick.saturating_sub(since)) * self.step_s;
            std::array::from_fn(|axis| place_m[axis] + self.velocity_mps[axis] * span_s)
        };
        let mut goals_m: Vec<[f64; 3]> = self.goals_m.iter().map(|&place_m| after(place_m, 0)).collect();
        if let Some((at, place_m)) = self.moves.filter(|(at, _)| tick > *at) {
            goals_m[0] = after(place_m, at);
        }
        goals_m
    }

    /// The tick of the operator's order, and the new goal.
    #[must_use]
    pub fn order(&self) -> Option<(u32, Target)> {
        self.moves.map(|(tick, position_m)| (tick, Target { position_m, velocity_mps: self.velocity_mps }))
    }
}

/// Straight distance from the middle of the start to the edge of the goals' middle, in R_MinDist.
/// Random goals are about as far away.
pub fn way(setting: &Setting) -> f64 {
    MIDDLE[0] - setting.arrival()
}

pub fn middle_m(goals_m: &[[f64; 3]]) -> [f64; 3] {
    let mean = |axis: usize| goals_m.iter().map(|goal| goal[axis]).sum::<f64>() / goals_m.len() as f64;
    [mean(0), mean(1), 0.0]
}

fn goals(plan: &Plan, setting: &Setting, run: u32) -> Result<Vec<[f64; 3]>> {
    let unit = plan.min_distance_m;
    let place_m = |x: f64, y: f64| [(MIDDLE[0] + x) * unit, (MIDDLE[1] + y) * unit, 0.0];
    if !plan.random_goals {
        let around = if setting.goals == 1 { 0.0 } else { AROUND };
        let at = |goal: u32| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(goal) / f64::from(setting.goals));
            place_m(around * cos, around * sin)
        };
        return Ok((0..setting.goals).map(at).collect());
    }
    let [within, apart] = GOAL_FIELD;
    let mut goals_m: Vec<[f64; 3]> = Vec::new();
    let mut rng = Rng::keyed(plan.seed, STARTS + 3, run, 0);
    while goals_m.len() < setting.goals as usize {
        let is_apart = |at: [f64; 3]| goals_m.iter().all(|other| distance_m(*other, at) >= apart * unit);
        let draws = (0..TRIES).map(|_| [uniform(&mut rng, -within, within), uniform(&mut rng, -within, within)]);
        let found = draws
            .filter(|[x, y]| x * x + y * y <= within * within)
            .map(|[x, y]| place_m(x, y))
            .find(|&at| is_apart(at));
        goals_m.push(found.with_context(|| format!("{} goals find no room at random; give fewer", setting.goals))?);
    }
    Ok(goals_m)
}

/// Discs with gaps between the start and the goals. The paper has some without description.
fn solids(plan: &Plan, setting: &Setting, run: u32) -> Result<Vec<Solid>> {
    let unit = plan.min_distance_m;
    let half = setting.start_half();
    let first = half + ROOM;
    let mut discs: Vec<([f64; 3], f64)> = Vec::new();
    for number in 0..setting.obstacles {
        let mut rng = Rng::keyed(plan.seed, STARTS + 2, run, number);
        let drawn = (0..TRIES).find_map(|_| {
            let radius = uniform(&mut rng, RADII[0], RADII[1]);
            let (west, east) = (first + radius, LAST - radius);
            let center = [uniform(&mut rng, west, east), uniform(&mut rng, -half, half), 0.0];
            let is_free = |&(other, size): &([f64; 3], f64)| distance_m(other, center) >= radius + size + ROOM;
            (west < east && discs.iter().all(is_free)).then_some((center, radius))
        });
        let Some(disc) = drawn else {
            bail!(
                "{} obstacles find no room before the goals; give fewer, fewer robots, or a smaller start side",
                setting.obstacles
            );
        };
        discs.push(disc);
    }
    let solid =
        |(center, radius): ([f64; 3], f64)| Solid::Ball { center_m: center.map(|c| c * unit), radius_m: radius * unit };
    Ok(discs.into_iter().map(solid).collect())
}
