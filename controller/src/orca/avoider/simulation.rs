//! Simulated swarms of avoiders with a perfect radio, rounded to millimetres.

use super::*;
use crate::geom::{Position, Vec3};
use crate::orca::fixtures::rng_of;
use crate::robot::{Mode, RobotId};
use std::vec::Vec;

type V = [f64; 2];

struct Run {
    radius_m: f64,
    step_s: f64,
    walls: Vec<[V; 2]>,
    /// Paths lead through it if start and goal lie on different sides.
    door_x: Option<f64>,
    robots: Vec<Robot>,
    time_s: f64,
    clearance_m: f64,
    wall_clearance_m: f64,
    /// Whether each passage was eastwards, in order.
    passed: Vec<bool>,
}

struct Robot {
    at: V,
    velocity: V,
    goal: V,
    arrived_s: Option<f64>,
    avoider: Avoider<f32, 24>,
}

const SPEED: f64 = 0.5;

fn sub(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1]]
}

fn length(v: V) -> f64 {
    libm::hypot(v[0], v[1])
}

fn millimetres(v: V) -> Position {
    Position::from_metres([v[0], v[1], 0.0]).unwrap()
}

fn from_wall(at: V, [a, b]: [V; 2]) -> f64 {
    let along = sub(b, a);
    let ahead = sub(at, a);
    let t = (ahead[0] * along[0] + ahead[1] * along[1]) / length(along) / length(along);
    let t = t.clamp(0.0, 1.0);
    length([ahead[0] - along[0] * t, ahead[1] - along[1] * t])
}

impl Run {
    fn new(radius_m: f64, ways: &[(V, V)]) -> Self {
        let robot = |&(at, goal): &(V, V)| Robot {
            at,
            velocity: [0.0; 2],
            goal,
            arrived_s: None,
            avoider: Avoider::new(AvoidParams::default()),
        };
        Self {
            radius_m,
            step_s: 0.05,
            walls: Vec::new(),
            door_x: None,
            robots: ways.iter().map(robot).collect(),
            time_s: 0.0,
            clearance_m: f64::MAX,
            wall_clearance_m: f64::MAX,
            passed: Vec::new(),
        }
    }

    fn until(&mut self, most_s: f64) -> usize {
        let arrived = |run: &Self| run.robots.iter().filter(|r| r.arrived_s.is_some()).count();
        let mut tick = 0;
        while self.time_s < most_s && arrived(self) < self.robots.len() {
            self.step(tick);
            tick += 1;
        }
        arrived(self)
    }

    fn slowest_s(&self) -> f64 {
        let times = self.robots.iter().map(|r| r.arrived_s.unwrap_or(f64::MAX));
        times.fold(0.0, f64::max)
    }

    fn step(&mut self, tick: u32) {
        let commands: Vec<V> = (0..self.robots.len()).map(|k| self.decide(k, tick)).collect();
        self.time_s += self.step_s;
        for (robot, velocity) in self.robots.iter_mut().zip(commands) {
            let before = robot.at[0];
            robot.velocity = velocity;
            robot.at = [0, 1].map(|k| robot.at[k] + velocity[k] * self.step_s);
            if let Some(x) = self.door_x
                && (before < x) != (robot.at[0] < x)
            {
                self.passed.push(robot.at[0] > before);
            }
            if length(sub(robot.goal, robot.at)) < 0.05 && robot.arrived_s.is_none() {
                robot.arrived_s = Some(self.time_s);
            }
        }
    }

    fn decide(&mut self, own: usize, tick: u32) -> V {
        let me = &self.robots[own];
        let here = millimetres(me.at);
        let mut nearby = Vec::new();
        for (k, other) in self.robots.iter().enumerate() {
            let distance = length(sub(other.at, me.at));
            if k == own || distance > 3.0 {
                continue;
            }
            self.clearance_m = self.clearance_m.min(distance - 2.0 * self.radius_m);
            let speed = other.velocity.map(|v| libm::round(v * 1000.0) / 1000.0);
            nearby.push(Nearby {
                id: RobotId(k as u32 + 1),
                offset_m: millimetres(other.at).since::<f32>(here),
                velocity_mps: Vec3::new(speed[0] as f32, speed[1] as f32, 0.0),
                radius_m: self.radius_m as f32,
                gives_way: true,
                mode: if other.arrived_s.is_some() { Mode::Arrived } else { Mode::Cruise },
                is_stranger: false,
            });
        }
        nearby.sort_by_key(|other| (other.offset_m.length_key(), other.id));
        nearby.truncate(16);
        let mut obstacles = Vec::new();
        for ends in &self.walls {
            let distance = from_wall(me.at, *ends);
            self.wall_clearance_m = self.wall_clearance_m.min(distance - self.radius_m);
            if distance < 6.0 {
                let end = |at: V| millimetres(at).since::<f32>(here).xy();
                obstacles.push(Obstacle::Wall(ends.map(end)));
            }
        }
        let goal = sub(me.goal, me.at);
        let mut way = goal;
        if let Some(x) = self.door_x
            && (me.at[0] < x) != (me.goal[0] < x)
        {
            way = sub([x + 0.05 * (me.goal[0] - x).signum(), 0.0], me.at);
        }
        let pace = SPEED.min(length(way) / self.step_s) / length(way).max(1e-9);
        let vector = |v: V| Vec2::new(v[0] as f32, v[1] as f32);
        let body = Body {
            id: RobotId(own as u32 + 1),
            velocity_mps: vector(me.velocity).extend(0.0),
            radius_m: self.radius_m as f32,
            max_speed_mps: SPEED as f32,
            max_acceleration_mps2: f32::MAX,
            step_s: self.step_s as f32,
        };
        let mut rng = rng_of(own as u32 + 1, tick);
        let wish = vector(way.map(|c| c * pace));
        let avoider = &mut self.robots[own].avoider;
        let solution = avoider.velocity(&body, wish, Some(vector(goal)), &nearby, &obstacles, &mut rng);
        [solution.velocity_mps.x, solution.velocity_mps.y].map(f64::from)
    }
}

fn noise(rng: &mut Rng, most: f64) -> f64 {
    (f64::from(rng.below(2001)) / 1000.0 - 1.0) * most
}

/// Robots on a circle swap places. Returns the slowest time over the free time.
fn swap(count: u32, noise_m: f64, seed: u64) -> f64 {
    let circle_m = (0.1 * f64::from(count)).max(2.0);
    let mut rng = Rng::keyed(seed, 1, count, 0);
    let ways: Vec<(V, V)> = (0..count)
        .map(|k| {
            let angle = core::f64::consts::TAU * f64::from(k) / f64::from(count);
            let at = [libm::cos(angle), libm::sin(angle)].map(|c| c * circle_m);
            let start = at.map(|c| c + noise(&mut rng, noise_m));
            (start, at.map(|c| -c))
        })
        .collect();
    let mut run = Run::new(0.15, &ways);
    let free_s = 2.0 * circle_m / SPEED;
    let arrived = run.until(3.0 * free_s);
    assert_eq!(arrived, count as usize, "{count} robots, seed {seed}");
    let least = run.clearance_m;
    assert!(least >= 0.0, "{count} robots, seed {seed}: {least}");
    run.slowest_s() / free_s
}

#[test]
fn robots_on_a_circle_swap_within_one_and_a_half_times_the_free_time() {
    for count in [2, 3, 4, 7, 12, 20, 21, 32, 64] {
        let ratio = swap(count, 0.0, 0);
        assert!(ratio <= 1.5, "{count}: {ratio}");
    }
}

#[test]
fn the_swap_does_not_depend_on_exact_positions() {
    for count in [4, 6, 8, 12, 16, 24] {
        for (noise_m, seed) in [(0.005, 1), (0.005, 2), (0.05, 1), (0.05, 2), (0.05, 3)] {
            let ratio = swap(count, noise_m, seed);
            assert!(ratio <= 1.5, "{count}, {noise_m}, seed {seed}: {ratio}");
        }
    }
}

fn doorway(width_m: f64, depth_m: f64, each: u32, seed: u64) -> Run {
    let rows = each.div_ceil(4).max(5);
    let (far, half, side) = (8.0 + depth_m / 2.0, width_m / 2.0, f64::from(rows));
    let mut rng = Rng::keyed(seed, 2, each, 0);
    let mut ways = Vec::new();
    for side in [-1.0, 1.0] {
        let middle = f64::from(rows - 1) / 2.0;
        let spot = |k: u32| [2.5 + depth_m / 2.0 + f64::from(k % 4) * 1.2, (f64::from(k / 4) - middle) * 1.6];
        for k in 0..each {
            let start = spot(k);
            let goal = spot(each - 1 - k);
            let start = [side * start[0], start[1]].map(|c| c + noise(&mut rng, 0.05));
            ways.push((start, [-side * goal[0], goal[1]]));
        }
    }
    let mut run = Run::new(0.3, &ways);
    run.door_x = Some(0.0);
    run.walls = std::vec![
        [[-far, -side], [far, -side]],
        [[-far, side], [far, side]],
        [[-far, -side], [-far, side]],
        [[far, -side], [far, side]],
    ];
    for x in [-depth_m / 2.0, depth_m / 2.0] {
        run.walls.push([[x, -side], [x, -half]]);
        run.walls.push([[x, half], [x, side]]);
    }
    for y in [-half, half] {
        run.walls.push([[-depth_m / 2.0, y], [depth_m / 2.0, y]]);
    }
    run
}

fn all_pass(width_m: f64, depth_m: f64, each: u32, within_s: f64) -> Run {
    let mut run = doorway(width_m, depth_m, each, 1);
    let arrived = run.until(within_s);
    assert_eq!(arrived, run.robots.len(), "{width_m} {depth_m}");
    assert!(run.clearance_m >= 0.0, "{}", run.clearance_m);
    assert!(run.wall_clearance_m >= 0.0, "{}", run.wall_clearance_m);
    run
}

#[test]
fn two_crowds_take_turns_at_a_door_for_one() {
    for depth_m in [0.0, 0.2] {
        let run = all_pass(0.8, depth_m, 20, 400.0);
        // Robots of one direction follow each other: each change takes as long as two robots.
        assert!(run.slowest_s() < 120.0, "{}", run.slowest_s());
        let changes = run.passed.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert!((1..=8).contains(&changes), "{:?}", run.passed);
    }
}

#[test]
fn two_crowds_pass_together_at_a_door_for_two() {
    let run = all_pass(1.3, 0.0, 20, 200.0);
    assert!(run.slowest_s() < 150.0, "{}", run.slowest_s());
}

#[test]
fn two_robots_swap_through_the_narrowest_door() {
    all_pass(0.7, 0.0, 1, 40.0);
    all_pass(0.7, 0.5, 1, 50.0);
}

#[test]
fn a_crowd_passes_although_each_robot_sees_less_than_half_of_it() {
    all_pass(1.0, 0.0, 30, 500.0);
}

#[test]
fn directions_take_turns_in_a_passage_of_thirty_radii() {
    for seed in [1, 2] {
        let mut run = doorway(0.8, 9.0, 4, seed);
        assert_eq!(run.until(200.0), 8, "seed {seed}");
        assert!(run.clearance_m >= 0.0 && run.wall_clearance_m >= 0.0, "seed {seed}");
    }
}

#[test]
fn a_robot_behind_a_wall_heads_for_the_door_from_afar() {
    let mut run = doorway(1.0, 0.0, 1, 1);
    run.door_x = None;
    run.robots.truncate(1);
    run.robots[0].at = [-4.0, 4.5];
    run.robots[0].goal = [4.0, 4.5];
    assert_eq!(run.until(40.0), 1);
    for x in [3.2, 6.6] {
        run.walls.push([[x, -5.0], [x, -0.5]]);
        run.walls.push([[x, 0.5], [x, 5.0]]);
    }
    run.robots[0].goal = [7.4, 3.0];
    run.robots[0].arrived_s = None;
    run.robots[0].at = [-4.0, 4.5];
    assert_eq!(run.until(100.0), 1);
}
