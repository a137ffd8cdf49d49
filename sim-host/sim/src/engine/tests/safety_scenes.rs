//! Random scenes of basic situations. Even seeds were used while the rules were written, odd seeds
//! were not.

use super::*;
use staya_controller::rand::Rng;
use std::fmt::Write as _;

/// Draws of a scene.
struct Draw(Rng);

impl Draw {
    fn new(kind: u32, seed: u32) -> Self {
        Self(Rng::keyed(u64::from(kind), seed, 0, 0))
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.0.below(1_000_001)) / 1e6
    }

    fn whole(&mut self, low: u32, high: u32) -> u32 {
        low + self.0.below(high - low + 1)
    }
}

fn scenario(text: &str) -> Scenario {
    Scenario::parse(text, Path::new("scene.toml"), &Overrides::default())
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Places at least `apart` from each other.
fn places(draw: &mut Draw, count: u32, half_m: f64, apart_m: f64) -> Vec<[f64; 2]> {
    let mut all = Vec::<[f64; 2]>::new();
    while all.len() < count as usize {
        let place = [draw.within(-half_m, half_m), draw.within(-half_m, half_m)];
        let is_free = all.iter().all(|other| (other[0] - place[0]).hypot(other[1] - place[1]) > apart_m);
        if is_free {
            all.push(place);
        }
    }
    all
}

/// Robots that cross an area, of which some go down on the way. Radios reach one third of the area
/// to all of it.
fn deaths(seed: u32) -> String {
    let mut draw = Draw::new(1, seed);
    let count = draw.whole(3, 16);
    let (radius_m, speed_mps) = (draw.within(0.1, 0.5), draw.within(0.3, 2.0));
    let half_m = 4.0 * radius_m * f64::from(count).sqrt() + draw.within(2.0, 8.0);
    let (starts, goals) =
        (places(&mut draw, count, half_m, 2.5 * radius_m), places(&mut draw, count, half_m, 2.5 * radius_m));
    let ticks = (8.0 * half_m / speed_mps / 0.1) as u32;
    let mut text = format!(
        "name = \"deaths\"\nseed = {seed}\nticks = {ticks}\ntick_s = 0.1\n[radio]\nrange_m = {}\nloss = {}\n\
         [plane]\nradius_m = {radius_m}\nmax_speed_mps = {speed_mps}\n[plane.robots]\nlist = [\n",
        draw.within(0.7 * half_m, 3.0 * half_m),
        draw.within(0.0, 0.3),
    );
    for ([x, y], [gx, gy]) in starts.iter().zip(&goals) {
        let _ = writeln!(text, "{{ start_m = [{x}, {y}], goal_m = [{gx}, {gy}] }},");
    }
    text += "]\n";
    for _ in 0..draw.whole(1, 8.min(count - 1)) {
        let robot = draw.whole(1, count);
        let at_s = draw.within(0.5, 2.0 * half_m / speed_mps);
        let _ = writeln!(text, "[[fault]]\nrobot = {robot}\nat_s = {at_s:.1}\ndown_s = 1000");
    }
    text
}

/// Scenes of [`deaths`] in which a robot meets a dead one from which it had received nothing.
const UNHEARD: [u32; 3] = [21, 40, 61];

#[test]
fn robots_do_not_drive_over_dead_robots_that_they_have_heard() {
    let mut overlaps = Vec::new();
    let mut scenes = 0;
    for seed in 0..100 {
        let text = deaths(seed);
        // Two faults of one robot may overlap in time; such scenes are not drawn again.
        let Ok(scene) = Scenario::parse(&text, Path::new("scene.toml"), &Overrides::default()) else { continue };
        let outcome = simulate(&scene, |_, _| ControlFlow::Continue(())).expect("placed");
        let gap_m = outcome.clearance.expect("bodies").bodies_m;
        scenes += 1;
        if outcome.collisions > 0 {
            overlaps.push((seed, outcome.collisions, gap_m));
        }
    }
    assert!(scenes > 80, "{scenes}");
    // Robots that were out of radio range when another one died do not know of it.
    let known: Vec<_> = overlaps.iter().map(|&(seed, ..)| seed).collect();
    assert_eq!(known, UNHEARD, "{overlaps:?}");
}

/// One robot with inertia on its way to a goal.
fn lone(seed: u32) -> (String, f64, f64) {
    let mut draw = Draw::new(2, seed);
    let (speed, most, way) = (draw.within(0.3, 12.0), draw.within(0.3, 6.0), draw.within(1.0, 150.0));
    let angle = draw.within(0.0, 6.28);
    let (step, radius) = (f64::from(draw.whole(2, 20)) / 100.0, draw.within(0.1, 1.0));
    let full = speed * speed / most;
    let least_s = if way > full { way / speed + speed / most } else { 2.0 * (way / most).sqrt() };
    let text = format!(
        "name = \"lone\"\nseed = {seed}\nticks = {}\ntick_s = {step}\n[plane]\nradius_m = {radius}\n\
         max_speed_mps = {speed}\nmax_acceleration_mps2 = {most}\ntolerance_m = 0.02\n[plane.robots]\n\
         list = [{{ start_m = [0, 0], goal_m = [{}, {}] }}]\n",
        (3.0 * least_s / step) as u32 + 100,
        way * angle.cos(),
        way * angle.sin(),
    );
    (text, way, least_s)
}

#[test]
fn a_lone_robot_with_inertia_stops_at_its_goal_in_time() {
    for seed in 0..200 {
        let (text, way, least_s) = lone(seed);
        let scene = scenario(&text);
        let mut farthest = 0.0_f64;
        let outcome = simulate(&scene, |_, robots| {
            for row in robots {
                let [x, y, _] = row.motion.position_m;
                farthest = farthest.max(x.hypot(y));
            }
            ControlFlow::Continue(())
        });
        let outcome = outcome.expect("placed");
        assert_eq!(outcome.arrived, 1, "seed {seed}\n{text}");
        assert!(farthest - way < 0.03, "seed {seed}: overshoot {} m\n{text}", farthest - way);
        let slack_s = 1.05 * least_s + 4.0 * scene.tick_s();
        assert!(outcome.seconds <= slack_s, "seed {seed}: {} s, least {least_s} s\n{text}", outcome.seconds);
    }
}

/// Bodies with inertia that cross in one place from all sides.
fn crossing(seed: u32) -> String {
    let mut draw = Draw::new(3, seed);
    let (count, radius_m) = (draw.whole(3, 8), draw.within(0.2, 3.0));
    let brake_s = draw.within(1.0, 6.0);
    let speed = draw.within(0.5, 8.0) * radius_m;
    let most = speed / brake_s;
    let ring_m = (2.0 * speed * brake_s).max(1.5 * radius_m * f64::from(count)) * draw.within(1.0, 1.5);
    let mut text = format!(
        "name = \"crossing\"\nseed = {seed}\nticks = {}\ntick_s = 0.1\n[plane]\nradius_m = {radius_m}\n\
         max_speed_mps = {speed}\nmax_acceleration_mps2 = {most}\n[plane.robots]\nlist = [\n",
        (30.0 * ring_m / speed / 0.1) as u32
    );
    for i in 0..count {
        let angle = f64::from(i) / f64::from(count) * std::f64::consts::TAU + draw.within(-0.2, 0.2);
        let [x, y] = [ring_m * angle.cos(), ring_m * angle.sin()];
        let _ = writeln!(text, "{{ start_m = [{x}, {y}], goal_m = [{}, {}] }},", -x, -y);
    }
    text + "]\n"
}

#[test]
fn bodies_with_inertia_cross_without_contact() {
    let mut failed = Vec::new();
    for seed in 0..40 {
        let scene = scenario(&crossing(seed));
        let outcome = simulate(&scene, |_, _| ControlFlow::Continue(())).expect("placed");
        let gap_m = outcome.clearance.expect("bodies").bodies_m;
        if outcome.collisions > 0 || outcome.arrived < scene.robots.len() {
            failed.push((seed, outcome.collisions, gap_m, outcome.arrived, scene.robots.len()));
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}

/// A convoy of two or more, and a robot that drives towards it and goes down ahead of it.
fn convoy(seed: u32) -> String {
    let mut draw = Draw::new(4, seed);
    let (count, radius_m, speed) = (draw.whole(2, 4), draw.within(0.1, 0.5), draw.within(0.3, 2.0));
    let range_m = draw.within(10.0, 40.0) * radius_m;
    let dies_m = draw.within(5.0 * radius_m, 0.7 * range_m);
    let far_m = range_m * draw.within(1.0, 2.0);
    let spacing_m = draw.within(2.5, 5.0) * radius_m;
    let mut text = format!(
        "name = \"convoy\"\nseed = {seed}\nticks = {}\ntick_s = 0.1\n[radio]\nrange_m = {range_m}\n\
         [plane]\nradius_m = {radius_m}\nmax_speed_mps = {speed}\n[plane.robots]\nlist = [\n",
        (20.0 * far_m / speed / 0.1) as u32
    );
    for i in 0..count {
        let x = -spacing_m * f64::from(i);
        let _ = writeln!(text, "{{ start_m = [{x}, 0], goal_m = [{}, 0] }},", x + 3.0 * far_m);
    }
    let _ = writeln!(text, "{{ start_m = [{far_m}, {}], goal_m = [{}, 0] }},\n]", draw.within(-0.1, 0.1), -3.0 * far_m);
    // They approach at twice the speed.
    let at_s = (far_m - dies_m) / (2.0 * speed);
    text + &format!("[[fault]]\nrobot = {}\nat_s = {:.1}\ndown_s = 10000\n", count + 1, at_s.max(0.3))
}

#[test]
fn a_convoy_does_not_drive_over_a_robot_that_died_ahead() {
    let mut overlaps = Vec::new();
    for seed in 0..100 {
        let scene = scenario(&convoy(seed));
        let outcome = simulate(&scene, |_, _| ControlFlow::Continue(())).expect("placed");
        let gap_m = outcome.clearance.expect("bodies").bodies_m;
        if outcome.collisions > 0 {
            overlaps.push((seed, outcome.collisions, gap_m));
        }
    }
    // In scene 1 the second robot of the convoy had received no beacon of the robot that died.
    assert_eq!(overlaps.iter().map(|&(seed, ..)| seed).collect::<Vec<_>>(), [1], "{overlaps:?}");
}
