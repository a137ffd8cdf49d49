//! Random scenes of basic situations. Seeds from 0 were looked at while the rules were written.
//! Seeds from [`UNSEEN`] were run only afterwards.

use super::*;
use staya_controller::rand::Rng;
use std::fmt::Write as _;

const UNSEEN: u32 = 1000;

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

/// One robot with inertia on its way to a goal.
fn lone(seed: u32) -> (String, f64, f64) {
    let mut draw = Draw::new(2, seed);
    let (speed, most, way) = (draw.within(0.3, 12.0), draw.within(0.3, 6.0), draw.within(1.0, 150.0));
    let angle = draw.within(0.0, std::f64::consts::TAU);
    let (step, radius) = (f64::from(draw.whole(2, 20)) / 100.0, draw.within(0.1, 1.0));
    let full = speed * speed / most;
    let least_s = if way > full { way / speed + speed / most } else { 2.0 * libm::sqrt(way / most) };
    let text = format!(
        "name = \"lone\"\nseed = {seed}\nticks = {}\ntick_s = {step}\n[plane]\nradius_m = {radius}\n\
         max_speed_mps = {speed}\nmax_acceleration_mps2 = {most}\ntolerance_m = 0.02\n[plane.robots]\n\
         list = [{{ start_m = [0, 0], goal_m = [{}, {}] }}]\n",
        (3.0 * least_s / step) as u32 + 100,
        way * libm::cos(angle),
        way * libm::sin(angle),
    );
    (text, way, least_s)
}

#[test]
fn a_lone_robot_with_inertia_stops_at_its_goal_in_time() {
    for seed in (0..200).chain(UNSEEN..UNSEEN + 200) {
        let (text, way, least_s) = lone(seed);
        let scene = scenario(&text);
        let mut farthest = 0.0_f64;
        let outcome = simulate(&scene, |_, robots| {
            for row in robots {
                let [x, y, _] = row.motion.position_m;
                farthest = farthest.max(libm::hypot(x, y));
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
        let [x, y] = [ring_m * libm::cos(angle), ring_m * libm::sin(angle)];
        let _ = writeln!(text, "{{ start_m = [{x}, {y}], goal_m = [{}, {}] }},", -x, -y);
    }
    text + "]\n"
}

#[test]
fn bodies_with_inertia_cross_without_contact() {
    let mut failed = Vec::new();
    for seed in (0..40).chain(UNSEEN..UNSEEN + 40) {
        let scene = scenario(&crossing(seed));
        let outcome = simulate(&scene, |_, _| ControlFlow::Continue(())).expect("placed");
        let gap_m = outcome.clearance.expect("bodies").bodies_m;
        if outcome.collisions > 0 || outcome.arrived < scene.robots.len() {
            failed.push((seed, outcome.collisions, gap_m, outcome.arrived, scene.robots.len()));
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}
