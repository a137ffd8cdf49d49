//! Random scenes of one robot and obstacles that it must go around: balls, convex polygons, pairs
//! and rows of them, doors behind or before them, cups and hooks. Seeds from 0 and from [`UNSEEN`]
//! were looked at while the rule was written, and starts are in sight of the shapes.
//!
//! Limits are in units of the shortest way, which [`shortest`] finds in a graph of visible points.

use super::safety_scenes::{Draw, UNSEEN, scenario, seeds};
use super::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write as _;

type P = [f64; 2];

/// Start and goal are at most this far from the shapes; the robot sees 10 m far.
const SEEN_M: f64 = 9.0;
/// How many times the shortest way a robot may take.
const MOST: f64 = 1.3;

#[derive(Clone, Debug)]
enum Shape {
    Ball(P, f64),
    /// Points, and whether the last is joined to the first.
    Chain(Vec<P>, bool),
}

impl Shape {
    fn moved(&self, by: P) -> Self {
        let add = |p: &P| [p[0] + by[0], p[1] + by[1]];
        match self {
            Self::Ball(center, radius) => Self::Ball(add(center), *radius),
            Self::Chain(points, is_closed) => Self::Chain(points.iter().map(add).collect(), *is_closed),
        }
    }

    fn walls(&self) -> Vec<[P; 2]> {
        match self {
            Self::Ball(..) => Vec::new(),
            Self::Chain(points, is_closed) => {
                let next = points.iter().cycle().skip(1);
                let all = points.iter().zip(next).map(|(from, to)| [*from, *to]);
                all.take(if *is_closed { points.len() } else { points.len() - 1 }).collect()
            }
        }
    }

    fn contains(&self, p: P) -> bool {
        match self {
            Self::Ball(center, radius) => apart(*center, p) < *radius,
            Self::Chain(_, false) => false,
            Self::Chain(..) => {
                let crosses = |[a, b]: &[P; 2]| {
                    (a[1] > p[1]) != (b[1] > p[1]) && p[0] < (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]) + a[0]
                };
                self.walls().iter().filter(|wall| crosses(wall)).count() % 2 == 1
            }
        }
    }

    /// The space between two shapes, metres; negative if they overlap.
    fn gap(&self, other: &Self) -> f64 {
        match (self, other) {
            (Self::Ball(a, one), Self::Ball(b, two)) => apart(*a, *b) - one - two,
            (Self::Ball(center, radius), chain) | (chain, Self::Ball(center, radius)) => {
                let distances = chain.walls().into_iter().map(|wall| to_wall(*center, wall) - radius);
                if chain.contains(*center) { -1.0 } else { distances.fold(f64::INFINITY, f64::min) }
            }
            (one, two) => {
                let (a, b) = (one.walls(), two.walls());
                let pairs = a.iter().flat_map(|wall| b.iter().map(|other| between(*wall, *other)));
                let is_inside = one.contains(b[0][0]) || two.contains(a[0][0]);
                if is_inside { -1.0 } else { pairs.fold(f64::INFINITY, f64::min) }
            }
        }
    }
}

/// Least and greatest x and y.
fn bounds(shapes: &[Shape]) -> [P; 2] {
    let points = shapes.iter().flat_map(|shape| match shape {
        Shape::Ball([x, y], r) => vec![[x - r, y - r], [x + r, y + r]],
        Shape::Chain(points, _) => points.clone(),
    });
    let start = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    points.fold(start, |[low, high], p| [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]])
}

fn apart(a: P, b: P) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

fn to_wall(p: P, [a, b]: [P; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let squared = dx * dx + dy * dy;
    let along = (p[0] - a[0]) * dx + (p[1] - a[1]) * dy;
    let share = if squared > 0.0 { (along / squared).clamp(0.0, 1.0) } else { 0.0 };
    apart(p, [a[0] + dx * share, a[1] + dy * share])
}

/// The distance of two segments.
fn between(u: [P; 2], v: [P; 2]) -> f64 {
    let side = |a: P, b: P, c: P| (b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0]);
    let crosses = |u: [P; 2], v: [P; 2]| side(u[0], u[1], v[0]) != side(u[0], u[1], v[1]);
    if crosses(u, v) && crosses(v, u) {
        return 0.0;
    }
    to_wall(u[0], v).min(to_wall(u[1], v)).min(to_wall(v[0], u)).min(to_wall(v[1], u))
}

struct Scene {
    shapes: Vec<Shape>,
    start: P,
    goal: P,
    radius: f64,
    speed: f64,
    tick_s: f64,
}

fn scaled(draw: &mut Draw, low: f64, high: f64) -> f64 {
    libm::exp(draw.within(libm::log(low), libm::log(high)))
}

/// A scene without obstacles, of a robot of some size and speed.
fn robot(draw: &mut Draw) -> Scene {
    let radius = scaled(draw, 0.1, 0.6);
    let speed = draw.within(1.2, 5.0) * radius;
    let tick_s = if draw.whole(0, 1) == 0 { 0.1 } else { 0.05 };
    Scene { shapes: Vec::new(), start: [0.0; 2], goal: [0.0; 2], radius, speed, tick_s }
}

impl Scene {
    /// Start and goal before and behind the shapes, which the robot sees at once; exactly in the
    /// middle, or anywhere.
    fn across(mut self, draw: &mut Draw, shapes: Vec<Shape>) -> Self {
        let [low, high] = bounds(&shapes);
        let (middle, half) = ((low[1] + high[1]) / 2.0, (high[1] - low[1]) / 2.0);
        let off = |draw: &mut Draw| draw.within(1.5 * self.radius, half.clamp(4.0 * self.radius, SEEN_M)) + self.radius;
        let (before, behind) = (off(draw), off(draw));
        let aside = if draw.whole(0, 1) == 0 { [0.0; 2] } else { [0; 2].map(|_| draw.within(-half, half)) };
        (self.start, self.goal) = ([low[0] - before, middle + aside[0]], [high[0] + behind, middle + aside[1]]);
        self.shapes = shapes;
        self
    }

    fn text(&self) -> String {
        let at = |[x, y]: P| format!("[{x:.9}, {y:.9}]");
        let seconds = 4.0 * shortest(self).unwrap_or(100.0) / self.speed;
        let mut text = format!(
            "name = \"round\"\nticks = {}\ntick_s = {}\n[plane]\nradius_m = {}\nmax_speed_mps = {}\ntolerance_m = {}\n\
             [[plane.robots.list]]\nstart_m = {}\ngoal_m = {}\n",
            (seconds / self.tick_s) as u32,
            self.tick_s,
            self.radius,
            self.speed,
            0.3 * self.radius,
            at(self.start),
            at(self.goal),
        );
        for shape in &self.shapes {
            let _ = match shape {
                Shape::Ball(center, radius) => {
                    writeln!(text, "[[plane.ball]]\ncenter_m = {}\nradius_m = {radius}", at(*center))
                }
                Shape::Chain(points, is_closed) => {
                    let points: Vec<_> = points.iter().map(|point| at(*point)).collect();
                    writeln!(text, "[[plane.wall]]\nclosed = {is_closed}\npoints_m = [{}]", points.join(", "))
                }
            };
        }
        text
    }
}

/// The length of the shortest way of the body, at most half a percent too long; `None` if there is
/// none. It leads over points around the grown obstacles.
fn shortest(scene: &Scene) -> Option<f64> {
    let r = scene.radius;
    let walls: Vec<_> = scene.shapes.iter().flat_map(Shape::walls).collect();
    let is_far = |u: [P; 2], v: [P; 2]| {
        let beyond = |u: [P; 2], v: [P; 2], axis: usize| u[0][axis].min(u[1][axis]) > v[0][axis].max(v[1][axis]) + r;
        (0..2).any(|axis| beyond(u, v, axis) || beyond(v, u, axis))
    };
    let is_free = |leg: [P; 2]| {
        walls.iter().all(|wall| is_far(leg, *wall) || between(leg, *wall) >= r - 1e-6)
            && scene.shapes.iter().all(|shape| match shape {
                Shape::Ball(center, radius) => to_wall(*center, leg) >= radius + r - 1e-6,
                Shape::Chain(..) => true,
            })
    };
    let mut nodes = vec![scene.start, scene.goal];
    let mut arc = |center: P, radius: f64, from: f64, span: f64, most: f64| {
        let count = libm::ceil(span / most).max(1.0);
        let radius = radius / libm::cos(span / count / 2.0) + 1e-9;
        for step in 0..count as u32 {
            let angle = from + span / count * (f64::from(step) + 0.5);
            let place = [center[0] + radius * libm::cos(angle), center[1] + radius * libm::sin(angle)];
            if is_free([place; 2]) {
                nodes.push(place);
            }
        }
    };
    for shape in &scene.shapes {
        let (points, is_closed) = match shape {
            Shape::Ball(center, radius) => {
                arc(*center, radius + r, 0.0, TAU, if *radius > 3.0 * r { 0.13 } else { 0.26 });
                continue;
            }
            Shape::Chain(points, is_closed) => (points, *is_closed),
        };
        let count = points.len();
        for (index, &center) in points.iter().enumerate() {
            let toward = |other: usize| {
                let [x, y] = points[other % count];
                libm::atan2(y - center[1], x - center[0])
            };
            let before = (index > 0 || is_closed).then(|| toward(index + count - 1));
            let after = (index + 1 < count || is_closed).then(|| toward(index + 1));
            match (before, after) {
                (Some(a), Some(b)) => {
                    let turn = if b < a { b - a + TAU } else { b - a };
                    let (from, span) = if turn >= PI { (a, turn - PI) } else { (b, PI - turn) };
                    arc(center, r, from + FRAC_PI_2, span, 0.35);
                }
                (Some(end), None) | (None, Some(end)) => arc(center, r, end + FRAC_PI_2, PI, 0.35),
                (None, None) => {}
            }
        }
    }
    let mut ways = vec![f64::INFINITY; nodes.len()];
    let mut is_done = vec![false; nodes.len()];
    ways[0] = 0.0;
    loop {
        let total = |at: &usize| ways[*at] + apart(nodes[*at], scene.goal);
        let open = (0..nodes.len()).filter(|at| !is_done[*at] && ways[*at].is_finite());
        let at = open.min_by(|one, other| total(one).total_cmp(&total(other)))?;
        if at == 1 {
            return Some(ways[1]);
        }
        is_done[at] = true;
        for next in 0..nodes.len() {
            let way = ways[at] + apart(nodes[at], nodes[next]);
            if !is_done[next] && way < ways[next] && is_free([nodes[at], nodes[next]]) {
                ways[next] = way;
            }
        }
    }
}

/// A ball, a regular polygon, an ellipse or another convex polygon around the origin.
fn convex(draw: &mut Draw, size: f64) -> Shape {
    let turn = draw.within(0.0, TAU);
    let (sin, cos) = (libm::sin(turn), libm::cos(turn));
    let place = |angle: f64, flat: f64| {
        let (x, y) = (size * libm::cos(angle), flat * size * libm::sin(angle));
        [x * cos - y * sin, x * sin + y * cos]
    };
    let even = |count: u32, flat: f64| (0..count).map(|k| place(f64::from(k) / f64::from(count) * TAU, flat)).collect();
    match draw.whole(0, 4) {
        0 => Shape::Ball([0.0; 2], size),
        1 | 2 => Shape::Chain(even(draw.whole(3, 64), 1.0), true),
        3 => Shape::Chain(even(draw.whole(8, 64), draw.within(0.05, 1.0)), true),
        _ => {
            let mut angles: Vec<_> = (0..draw.whole(3, 12)).map(|_| draw.within(0.0, TAU)).collect();
            angles.sort_by(f64::total_cmp);
            let flat = draw.within(0.2, 1.0);
            Shape::Chain(angles.into_iter().map(|angle| place(angle, flat)).collect(), true)
        }
    }
}

fn ball(seed: u32) -> Scene {
    let mut draw = Draw::new(101, seed);
    let scene = robot(&mut draw);
    let size = scaled(&mut draw, 0.5, 20.0);
    scene.across(&mut draw, vec![Shape::Ball([0.0; 2], size)])
}

/// A side or a corner across the way, or turned.
fn regular(seed: u32) -> Scene {
    let mut draw = Draw::new(102, seed);
    let scene = robot(&mut draw);
    let (size, count) = (scaled(&mut draw, 1.0, 20.0), draw.whole(3, 64));
    let turn = if draw.whole(0, 1) == 0 { f64::from(draw.whole(0, 1)) / 2.0 } else { draw.within(0.0, 1.0) };
    let angles = (0..count).map(|k| (f64::from(k) + turn) / f64::from(count) * TAU + PI);
    let points = angles.map(|angle| [size * libm::cos(angle), size * libm::sin(angle)]).collect();
    scene.across(&mut draw, vec![Shape::Chain(points, true)])
}

fn any_convex(seed: u32) -> Scene {
    let mut draw = Draw::new(103, seed);
    let scene = robot(&mut draw);
    let size = scaled(&mut draw, 0.7, 20.0);
    let shape = convex(&mut draw, size);
    scene.across(&mut draw, vec![shape])
}

/// Shapes across the way with gaps of these radii.
fn row(draw: &mut Draw, count: u32, sizes: P, gaps: P) -> Vec<Shape> {
    let mut row: Vec<Shape> = Vec::new();
    for _ in 0..count {
        let size = scaled(draw, sizes[0], sizes[1]);
        let (shape, gap) = (convex(draw, size), draw.within(gaps[0], gaps[1]));
        let (x, mut y, mut step) = (draw.within(-0.3, 0.3) * size, 0.0, size);
        if !row.is_empty() {
            y = bounds(&row)[1][1] - bounds(std::slice::from_ref(&shape))[0][1] + gap + 0.1;
            while step > 1e-4 {
                let moved = shape.moved([x, y - step]);
                if row.iter().all(|other| other.gap(&moved) >= gap) { y -= step } else { step /= 2.0 }
            }
        }
        row.push(shape.moved([x, y]));
    }
    row
}

/// Two shapes with a gap that the robot does not fit through.
fn pair(seed: u32) -> Scene {
    let mut draw = Draw::new(104, seed);
    let scene = robot(&mut draw);
    let gaps = [0.05, 1.9].map(|gap| gap * scene.radius);
    let shapes = row(&mut draw, 2, [0.5, 8.0], gaps);
    scene.across(&mut draw, shapes)
}

/// Three to five shapes; in half of the scenes the robot fits through some gaps.
fn rows(seed: u32) -> Scene {
    let mut draw = Draw::new(105, seed);
    let scene = robot(&mut draw);
    let most = if draw.whole(0, 1) == 0 { 1.9 } else { 6.0 };
    let (count, gaps) = (draw.whole(3, 5), [0.05, most].map(|gap| gap * scene.radius));
    let shapes = row(&mut draw, count, [0.5, 3.0], gaps);
    scene.across(&mut draw, shapes)
}

/// A shape before or behind a door in a long wall.
fn door(seed: u32) -> Scene {
    let mut draw = Draw::new(107, seed);
    let mut scene = robot(&mut draw);
    let r = scene.radius;
    let (half, size) = (draw.within(1.2, 6.0) * r, scaled(&mut draw, 0.5, 4.0));
    let shape = convex(&mut draw, size);
    let [low, high] = bounds(std::slice::from_ref(&shape));
    let (gap, aside) = (draw.within(2.3, 10.0) * r, draw.within(-1.0, 1.0) * size * f64::from(draw.whole(0, 1)));
    let shape = shape.moved([if draw.whole(0, 1) == 0 { -gap - high[0] } else { gap - low[0] }, aside]);
    let depth = f64::from(draw.whole(0, 1)) * draw.within(0.2, 2.0) * r;
    let [low, high] = bounds(std::slice::from_ref(&shape));
    let [before, behind] = [0; 2].map(|_| draw.within(2.0, 20.0) * r);
    let off = f64::from(draw.whole(0, 1));
    scene.start = [low[0].min(-depth) - before, aside + off * draw.within(-1.0, 1.0) * size];
    scene.goal = [high[0].max(depth) + behind, off * draw.within(-6.0, 6.0) * r];
    let wall = |near: f64, far: f64| match depth {
        0.0 => Shape::Chain(vec![[0.0, near], [0.0, far]], false),
        _ => Shape::Chain(vec![[-depth, far], [-depth, near], [depth, near], [depth, far]], false),
    };
    scene.shapes = vec![wall(half, 40.0), wall(-half, -40.0), shape];
    scene
}

/// A robot in a cup or a hook, square or round, with its goal behind the bottom.
fn cup(seed: u32) -> Scene {
    let mut draw = Draw::new(108, seed);
    let mut scene = robot(&mut draw);
    let r = scene.radius;
    let half = draw.within(2.5, 12.0) * r.min(0.35);
    let [a, b] = [0; 2].map(|_| draw.within(0.0, 1.0) * (20.0 * r).min(8.0));
    let mut points = vec![[-a, half], [0.0, half], [0.0, -half], [-b, -half]];
    match draw.whole(0, 3) {
        0 => {}
        1 => points.insert(0, [-a, half + draw.within(0.5, 3.0) * half]),
        2 => points.insert(0, [-a, half - draw.within(0.1, 0.9) * (half - 1.3 * r).max(0.1)]),
        _ => {
            let count = draw.whole(3, 16);
            let angles = (0..=count).map(|k| FRAC_PI_2 - PI * f64::from(k) / f64::from(count));
            points = angles.map(|angle| [half * libm::cos(angle), half * libm::sin(angle)]).collect();
            points.insert(0, [-a, half]);
            points.push([-b, -half]);
        }
    }
    let deep = a.max(b).max(1.5 * r);
    let start = [-draw.within(0.0, 1.2) * deep - 1.5 * r, draw.within(-1.0, 1.0) * (half - 1.4 * r)];
    let goal = [half + draw.within(2.0, 20.0) * r, draw.within(-1.5, 1.5) * half];
    let turn = draw.within(0.0, TAU);
    let (sin, cos) = (libm::sin(turn), libm::cos(turn));
    let turned = |[x, y]: P| [x * cos - y * sin, x * sin + y * cos];
    (scene.start, scene.goal) = (turned(start), turned(goal));
    scene.shapes = vec![Shape::Chain(points.into_iter().map(turned).collect(), false)];
    scene
}

/// The seeds of late robots, and how many scenes have a way.
fn late(all: impl Iterator<Item = u32>, make: fn(u32) -> Scene) -> (Vec<u32>, usize) {
    let (mut late, mut count) = (Vec::new(), 0);
    for seed in all {
        let scene = make(seed);
        let Some(way) = shortest(&scene) else {
            continue;
        };
        count += 1;
        let text = scene.text();
        let outcome = simulate(&scenario(&text), |_, _| ControlFlow::Continue(())).expect("placed");
        assert_eq!(outcome.collisions, 0, "seed {seed}\n{text}");
        // It listens for seven steps.
        let most_s = MOST * way / scene.speed + 8.0 * scene.tick_s;
        if outcome.arrived < 1 || outcome.seconds > most_s {
            late.push(seed);
        }
    }
    (late, count)
}

/// Prints the late ones of both ranges of seeds; at most `most` of both together.
fn check(name: &str, many: u32, most: usize, make: fn(u32) -> Scene) {
    let (seen, scenes) = late(seeds(many).filter(|seed| *seed < UNSEEN), make);
    let (unseen, others) = late(seeds(many).filter(|seed| *seed >= UNSEEN), make);
    println!("{name}: late {} of {scenes} {seen:?}, and {} of {others} {unseen:?}", seen.len(), unseen.len());
    assert!(scenes + others > many as usize, "{name}: too few scenes have a way");
    assert!(seen.len() + unseen.len() <= most, "{name}");
}

#[test]
fn a_lone_robot_goes_around_a_ball_in_1_3_times_the_shortest_time() {
    check("ball", 30, 0, ball);
}

#[test]
fn a_lone_robot_goes_around_a_regular_polygon_in_1_3_times_the_shortest_time() {
    check("regular", 30, 0, regular);
}

#[test]
fn a_lone_robot_goes_around_a_convex_shape_in_1_3_times_the_shortest_time() {
    check("convex", 30, 0, any_convex);
}

#[test]
fn nearly_all_lone_robots_go_around_two_shapes_without_a_gap_in_that_time() {
    check("pair", 20, 3, pair);
}

#[test]
fn nearly_all_lone_robots_pass_a_row_of_shapes_in_that_time() {
    check("row", 5, 1, rows);
}

#[test]
fn nearly_all_lone_robots_pass_a_shape_and_a_door_in_that_time() {
    check("door", 20, 1, door);
}

#[test]
fn a_lone_robot_leaves_a_cup_or_a_hook_in_that_time() {
    check("cup", 30, 0, cup);
}
