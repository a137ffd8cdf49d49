//! Warnings about valid but probably unintended settings in `[plane]`.

use super::super::Scenario;
use super::super::law::LawSetup;
use super::{PlaneSetup, RobotGroup, Start};
use crate::radio::RadioParams;
use crate::world::plane::{Solid, Solids, contains};
use staya_controller::agent::{GAMMA_OF_TWO, Goals, LawSettings};
use staya_controller::lattice::{Algorithm, LatticeParams};

const NAMED: usize = 3;

type Loop = Vec<[f64; 2]>;

/// O(robots x walls + sides of a closed wall squared).
pub(in super::super) fn remarks(scenario: &Scenario, setup: &PlaneSetup) -> Vec<String> {
    let (loops, tick_s) = (loops(&setup.solids), scenario.tick_s());
    let gains = |group: &RobotGroup| match &group.law {
        LawSetup::BuiltIn(LawSettings::Lattice(lattice)) => {
            unstable(&lattice.params, &scenario.radio, scenario.step_s())
        }
        _ => None,
    };
    let mut remarks: Vec<_> = setup.kinds().filter_map(gains).collect();
    remarks.extend(setup.kinds().filter_map(|group| long_tick(group, tick_s)));
    remarks.extend(setup.kinds().filter_map(|group| late_news(group, scenario)));
    remarks.extend(loops.iter().filter_map(|corners| crossing(corners)));
    let robots = || setup.starts.iter().enumerate();
    let is = |trouble: &dyn Fn(&RobotGroup, &Start, [f64; 3]) -> bool| {
        let robots = robots().filter(|(index, start)| {
            let group = setup.group(*index);
            goal(group, start).is_some_and(|goal_m| trouble(group, start, goal_m))
        });
        named(robots.map(|(index, _)| index + 1))
    };
    let largest_m = setup.kinds().map(|group| group.radius_m).fold(0.0, f64::max);
    let solids = Solids::new(setup.solids.clone(), largest_m);
    let in_obstacle = is(&|group, _, goal_m| {
        let least_m = group.radius_m - group.tolerance_m;
        solids.near(goal_m, group.radius_m).any(|solid| solid.distance_m(goal_m) < least_m)
    });
    let shut = is(&|_, start, goal_m| {
        let is_inside = |corners: &[[f64; 2]], [x, y, _]: [f64; 3]| contains(corners, [x, y]);
        loops.iter().any(|corners| is_inside(corners, start.position_m) != is_inside(corners, goal_m))
    });
    let in_space = is(&|group, start, goal_m| {
        let is_plane = !group.safety.flies() && !group.safety.is_none();
        is_plane && (goal_m[2] - start.position_m[2]).abs() > group.tolerance_m
    });
    let troubles = [
        (in_obstacle, "nearer to an obstacle than the body's radius and cannot be reached"),
        (shut, "on the other side of a closed wall and cannot be reached"),
        (in_space, "at another height, and this safety layer keeps to the plane: give safety = \"fly\""),
    ];
    remarks.extend(
        troubles
            .into_iter()
            .filter_map(|(robots, what)| Some(format!("plane.robots: the goal of {} is {what}", robots?))),
    );
    remarks
}

/// Warns of a flock whose gains are too high for its radio, or squeeze it.
fn unstable(params: &LatticeParams<f32>, radio: &RadioParams, step_s: f64) -> Option<String> {
    let (delay_s, rate_hz) = radio.news(step_s);
    let news_s = delay_s + 1.0 / rate_hz;
    let (gain, pull) = (f64::from(params.alpha.position), f64::from(params.gamma.position));
    if news_s > 1.001 * f64::from(params.oldest_news_s()) {
        let bearable = params.stable_for(delay_s as f32, rate_hz as f32).alpha.position;
        return Some(format!(
            "plane.lattice.c1_alpha = {gain}: the flock will shake itself apart, since robots hear of each other up to \
             {news_s:.2} s late; at most {bearable:.2} bears that, and is taken if you leave the field out"
        ));
    }
    (params.algorithm == Algorithm::Two && gain < 0.99 * f64::from(GAMMA_OF_TWO) * pull).then(|| {
        format!(
            "plane.lattice.c1_gamma = {pull}: in algorithm 2 it squeezes a large flock until robots coincide; give at most \
             c1_alpha / {GAMMA_OF_TWO} = {:.3}",
            gain / f64::from(GAMMA_OF_TWO)
        )
    })
}

/// Final position of a robot that goes straight to a stationary goal.
fn goal(group: &RobotGroup, start: &Start) -> Option<[f64; 3]> {
    let last = start.places.last()?;
    (group.law.goals() == Goals::Waypoints && last.velocity_mps == [0.0; 3]).then_some(last.position_m)
}

fn named(robots: impl Iterator<Item = usize>) -> Option<String> {
    let numbers: Vec<_> = robots.collect();
    let (first, rest) = numbers.split_at(numbers.len().min(NAMED));
    let mut text: Vec<_> = first.iter().map(usize::to_string).collect();
    if !rest.is_empty() {
        text.push(format!("{} more", rest.len()));
    }
    let last = text.pop()?;
    let robots = if numbers.len() == 1 { "robot" } else { "robots" };
    Some(if text.is_empty() { format!("{robots} {last}") } else { format!("{robots} {} and {last}", text.join(", ")) })
}

/// Warns of undetected collisions if a robot moves more than its width in a tick.
fn long_tick(group: &RobotGroup, tick_s: f64) -> Option<String> {
    let (speed_mps, wide_m) = (group.abilities.max_speed_mps, 2.0 * group.radius_m);
    let way_m = speed_mps * tick_s;
    (way_m > wide_m).then(|| {
        format!(
            "tick_s = {tick_s}: at {speed_mps} m/s a robot goes {way_m:.2} m in a tick, more than its body's {wide_m:.2} m, and can be \
             through another one unseen; at most {:.3} would do",
            wide_m / speed_mps
        )
    })
}

/// Warns of robots that stand beside each other, since each may be far away when it is heard.
fn late_news(group: &RobotGroup, scenario: &Scenario) -> Option<String> {
    let inflation = group.safety.orca()?.inflation;
    let (delay_s, _) = scenario.radio.news(scenario.step_s());
    let unknown_s = (delay_s - scenario.step_s()).max(0.0);
    let (growth_mps, radius_m) = (f64::from(inflation.growth_mps), group.radius_m);
    let swerve_m = group.abilities.max_acceleration_mps2 * unknown_s * unknown_s / 2.0;
    let way_m = (growth_mps * unknown_s).min(swerve_m);
    (scenario.robots.len() > 1 && way_m > radius_m).then(|| {
        format!(
            "radio.delay_ms and jitter_ms: a robot may go {way_m:.2} m before its next beacon counts, more than its radius \
             of {radius_m:.2} m; others do not approach within that distance, and a crowd may stand; \
             {:.2} m/s or less would do (max_speed_mps, and inflation_mps if you give it)",
            radius_m / unknown_s
        )
    })
}

fn loops(solids: &[Solid]) -> Vec<Loop> {
    let mut loops = Vec::new();
    let mut chain = Loop::new();
    let mut end = None;
    for solid in solids {
        let &Solid::Wall([from, to]) = solid else {
            (chain, end) = (Loop::new(), None);
            continue;
        };
        if end != Some(from) {
            chain.clear();
        }
        chain.push(from);
        end = Some(to);
        if chain.len() > 2 && chain.first() == Some(&to) {
            loops.push(std::mem::take(&mut chain));
            end = None;
        }
    }
    loops
}

/// Side of the line from `a` to `b` on which a point lies: positive on the left.
fn side(a: [f64; 2], b: [f64; 2], point: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0])
}

fn crossing(corners: &[[f64; 2]]) -> Option<String> {
    let count = corners.len();
    let ends = |index: usize| (corners[index], corners[(index + 1) % count]);
    let cross = |one: usize, other: usize| {
        let ((a, b), (c, d)) = (ends(one), ends(other));
        side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
    };
    let mut pairs = (0..count).flat_map(|one| (one + 2..count).map(move |other| (one, other)));
    let (one, other) = pairs.find(|&(one, other)| cross(one, other))?;
    let [x, y] = corners[0];
    Some(format!(
        "plane.wall: sides {} and {} of the closed wall that begins at [{x}, {y}] cross, so its inside is undefined",
        one + 1,
        other + 1
    ))
}
