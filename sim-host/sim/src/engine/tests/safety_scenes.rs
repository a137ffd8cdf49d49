//! Random scenes of basic situations. Seeds from 0 were looked at while the rules were written.
//! Seeds from [`UNSEEN`] were run only afterwards.

use super::*;
use staya_controller::rand::Rng;
use std::fmt::Write as _;

pub(super) const UNSEEN: u32 = 1000;

/// Draws of a scene.
pub(super) struct Draw(Rng);

impl Draw {
    pub(super) fn new(kind: u32, seed: u32) -> Self {
        Self(Rng::keyed(u64::from(kind), seed, 0, 0))
    }

    pub(super) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.0.below(1_000_001)) / 1e6
    }

    pub(super) fn whole(&mut self, low: u32, high: u32) -> u32 {
        low + self.0.below(high - low + 1)
    }
}

pub(super) fn scenario(text: &str) -> Scenario {
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
        // It listens for seven steps.
        let slack_s = 1.05 * least_s + 8.0 * scene.tick_s();
        assert!(outcome.seconds <= slack_s, "seed {seed}: {} s, least {least_s} s\n{text}", outcome.seconds);
    }
}

/// The end of a list of robots that exchange places across a circle.
fn across(draw: &mut Draw, count: u32, ring_m: f64) -> String {
    let mut list = String::new();
    for i in 0..count {
        let angle = f64::from(i) / f64::from(count) * std::f64::consts::TAU + draw.within(-0.2, 0.2);
        let [x, y] = [ring_m * libm::cos(angle), ring_m * libm::sin(angle)];
        let _ = writeln!(list, "{{ start_m = [{x}, {y}], goal_m = [{}, {}] }},", -x, -y);
    }
    list + "]\n"
}

/// Bodies with inertia that cross in one place from all sides.
fn crossing(seed: u32) -> String {
    let mut draw = Draw::new(3, seed);
    let (count, radius_m) = (draw.whole(3, 8), draw.within(0.2, 3.0));
    let brake_s = draw.within(1.0, 6.0);
    let speed = draw.within(0.5, 8.0) * radius_m;
    let most = speed / brake_s;
    let ring_m = (2.0 * speed * brake_s).max(1.5 * radius_m * f64::from(count)) * draw.within(1.0, 1.5);
    let text = format!(
        "name = \"crossing\"\nseed = {seed}\nticks = {}\ntick_s = 0.1\n[plane]\nradius_m = {radius_m}\n\
         max_speed_mps = {speed}\nmax_acceleration_mps2 = {most}\n[plane.robots]\nlist = [\n",
        (30.0 * ring_m / speed / 0.1) as u32
    );
    text + &across(&mut draw, count, ring_m)
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

/// Robots on random ways, one to eight of which die.
fn deaths(seed: u32) -> String {
    let mut draw = Draw::new(4, seed);
    let (count, dying) = (draw.whole(6, 20), draw.whole(1, 8));
    let (radius_m, speed) = (draw.within(0.1, 0.5), draw.within(0.4, 2.0));
    let side_m = radius_m * draw.within(3.0, 8.0) * libm::sqrt(f64::from(count)) + 2.0;
    let range_m = side_m * draw.within(0.3, 1.5) + 4.0 * speed;
    let loss = [0.0, 0.0, 0.1, 0.3][draw.whole(0, 3) as usize];
    let most = if draw.whole(0, 1) == 0 { "inf".to_owned() } else { format!("{}", speed / draw.within(0.2, 2.0)) };
    let lasts_s = 3.0 * side_m / speed + 20.0;
    let mut text = format!(
        "name = \"deaths\"\nseed = {seed}\nticks = {}\ntick_s = 0.1\n[radio]\nrange_m = {range_m}\nloss = {loss}\n\
         [plane]\nradius_m = {radius_m}\nmax_speed_mps = {speed}\nmax_acceleration_mps2 = {most}\n[plane.robots]\n\
         list = [\n",
        (lasts_s / 0.1) as u32
    );
    // Starts and goals on the points of two shuffled grids.
    let columns = libm::ceil(libm::sqrt(f64::from(count))) as u32;
    let places = |draw: &mut Draw| {
        let mut cells: Vec<u32> = (0..columns * columns).collect();
        for i in (1..cells.len()).rev() {
            cells.swap(i, draw.whole(0, i as u32) as usize);
        }
        let at = |n: u32| side_m * (f64::from(n) + 0.5) / f64::from(columns);
        let cells = cells.into_iter().take(count as usize);
        cells.map(|cell| [at(cell % columns), at(cell / columns)]).collect::<Vec<_>>()
    };
    let (starts, goals) = (places(&mut draw), places(&mut draw));
    for (start, goal) in starts.iter().zip(&goals) {
        let _ = writeln!(text, "{{ start_m = {start:?}, goal_m = {goal:?} }},");
    }
    text += "]\n";
    for robot in 1..=dying.min(count / 2) {
        let at_s = draw.within(0.1, 1.5) * side_m / speed;
        let _ = write!(text, "[[fault]]\nrobot = {robot}\nat_s = {at_s}\ndown_s = 100000\n");
    }
    text
}

/// Robots in convoy, and one that drives towards them and dies.
fn convoy(seed: u32, lag_s: f64) -> String {
    let mut draw = Draw::new(5, seed);
    let (radius_m, speed) = (draw.within(0.1, 0.5), draw.within(0.4, 2.0));
    let (count, range_m) = (draw.whole(1, 4), draw.within(8.0, 30.0));
    let gap_m = 2.0 * radius_m + draw.within(0.3, 2.0);
    let dies_m = range_m * draw.within(0.2, 0.7) + 4.0 * radius_m;
    let away_m = dies_m + draw.within(1.0, 10.0);
    let brake_s = if draw.whole(0, 1) == 0 { 0.0 } else { draw.within(0.2, 2.0) };
    // Robots listen for 0.3 s, then speed up.
    let dies_s = 0.3 + lag_s + (away_m - dies_m) / (2.0 * speed) + brake_s / 2.0;
    let most = if brake_s > 0.0 { format!("{}", speed / brake_s) } else { "inf".to_owned() };
    let mut text = format!(
        "name = \"convoy\"\nseed = {seed}\nticks = {}\ntick_s = 0.1\n[radio]\nrange_m = {range_m}\n[plane]\n\
         radius_m = {radius_m}\nmax_speed_mps = {speed}\nmax_acceleration_mps2 = {most}\n[plane.robots]\nlist = [\n",
        (2.5 * (away_m + 10.0) / speed / 0.1) as u32
    );
    for i in 0..count {
        let y = draw.within(-0.3, 0.3) * radius_m;
        let x = -f64::from(i) * gap_m;
        let _ = writeln!(text, "{{ start_m = [{x}, {y}], goal_m = [{}, {y}] }},", x + away_m + 10.0);
    }
    let _ = writeln!(text, "{{ start_m = [{away_m}, 0], goal_m = [-50, 0] }}]");
    let _ = write!(text, "[[fault]]\nrobot = {}\nat_s = {dies_s}\ndown_s = 100000\n", count + 1);
    text
}

/// As many seeds of each kind as the variable `SCENES` says, or `count`.
pub(super) fn seeds(count: u32) -> impl Iterator<Item = u32> {
    let count = std::env::var("SCENES").map_or(count, |text| text.parse().expect("a number"));
    (0..count).chain(UNSEEN..UNSEEN + count)
}

/// Runs scenes and describes those with overlaps.
fn overlaps(scenes: impl Iterator<Item = (u32, String)>) -> Vec<String> {
    let mut failed = Vec::new();
    for (seed, text) in scenes {
        let scene = scenario(&text);
        let outcome = simulate(&scene, |_, _| ControlFlow::Continue(())).expect("placed");
        if outcome.collisions > 0 {
            let gap_m = outcome.clearance.expect("bodies").bodies_m;
            failed.push(format!("seed {seed}: {} pairs, {gap_m:.3} m", outcome.collisions));
        }
    }
    failed
}

#[test]
fn no_robot_touches_one_that_died() {
    let convoys = overlaps(seeds(60).map(|seed| (seed, convoy(seed, 0.0))));
    let crowds = overlaps(seeds(60).map(|seed| (seed, deaths(seed))));
    assert!(convoys.is_empty() && crowds.is_empty(), "convoys {convoys:#?}\ncrowds {crowds:#?}");
}

/// Robots that cross in one place, with a radio that is slower than a step.
fn delayed(seed: u32) -> String {
    let mut draw = Draw::new(6, seed);
    let (count, radius_m) = (draw.whole(2, 8), draw.within(0.1, 1.0));
    let (speed, step_ms) = (draw.within(0.5, 4.0) * radius_m, draw.whole(2, 10) * 10);
    let ring_m = (8.0 * radius_m).max(2.0 * radius_m * f64::from(count)) * draw.within(1.0, 1.5);
    let text = format!(
        "name = \"delayed\"\nseed = {seed}\nticks = {}\ntick_s = {}\n[radio]\ndelay_ms = {}\n[plane]\n\
         radius_m = {radius_m}\nmax_speed_mps = {speed}\n[plane.robots]\nlist = [\n",
        (20.0 * ring_m / speed * 1000.0 / f64::from(step_ms)) as u32,
        f64::from(step_ms) / 1000.0,
        draw.whole(50, 400)
    );
    text + &across(&mut draw, count, ring_m)
}

#[test]
fn no_robots_touch_with_a_slow_radio() {
    let failed = overlaps(seeds(40).map(|seed| (seed, delayed(seed))));
    assert!(failed.is_empty(), "{failed:#?}");
}

fn lag_s(seed: u32) -> f64 {
    Draw::new(7, seed).within(0.05, 0.8)
}

/// The scene with bodies that follow their commands with a lag.
fn lagging(seed: u32, text: &str) -> String {
    let lag_s = lag_s(seed);
    text.replace("[plane]\n", &format!("[plane]\nlag_s = {lag_s}\n"))
}

#[test]
fn no_bodies_that_follow_late_touch() {
    let delayed = overlaps(seeds(30).map(|seed| (seed, lagging(seed, &delayed(seed)))));
    let crossings = overlaps(seeds(30).map(|seed| (seed, lagging(seed, &crossing(seed)))));
    let crowds = overlaps(seeds(30).map(|seed| (seed, lagging(seed, &deaths(seed)))));
    let convoys = overlaps(seeds(30).map(|seed| (seed, lagging(seed, &convoy(seed, lag_s(seed))))));
    assert!(
        [&delayed, &crossings, &crowds, &convoys].iter().all(|failed| failed.is_empty()),
        "delayed {delayed:#?}\ncrossings {crossings:#?}\ncrowds {crowds:#?}\nconvoys {convoys:#?}"
    );
}

#[test]
fn a_lone_body_that_follows_late_stops_at_its_goal() {
    for seed in seeds(60) {
        let (text, way, least_s) = lone(seed);
        let scene = scenario(&lagging(seed, &text));
        let (lag_s, mut farthest) = (lag_s(seed), 0.0_f64);
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
        // The last millimetres take a few time constants.
        let slack_s = 1.05 * least_s + 12.0 * lag_s + 4.0 * scene.tick_s();
        assert!(outcome.seconds <= slack_s, "seed {seed}: {} s, least {least_s} s, lag {lag_s}", outcome.seconds);
    }
}

/// All robots start while the radio is dead; they wait for its end.
#[test]
fn robots_that_expect_others_wait_for_the_end_of_a_blackout() {
    let failed =
        overlaps(seeds(20).map(|seed| (seed, delayed(seed).replace("[radio]\n", "[radio]\nblackout_s = [[0, 10]]\n"))));
    assert!(failed.is_empty(), "{failed:#?}");
}

/// The scene with robots that decide out of phase, by slow clocks, and sometimes late.
fn with_own_clocks(text: &str) -> String {
    let value = |key: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix(key)).expect("a field");
        line.parse::<f64>().expect("a number")
    };
    let (step_s, ticks) = (value("tick_s = "), value("ticks = "));
    let clocks = format!(
        "[clocks]\nstep_s = {step_s}\nphases = \"random\"\ndrift_ppm = 50\nlate = 0.02\nlate_s = {}\n[plane]\n",
        2.0 * step_s
    );
    text.replace(&format!("tick_s = {step_s}\n"), &format!("tick_s = {}\n", step_s / 8.0))
        .replace(&format!("ticks = {ticks}\n"), &format!("ticks = {}\n", 8.0 * ticks))
        .replacen("[plane]\n", &clocks, 1)
}

/// Prints the last arrivals with own clocks over those with equal phases.
#[test]
fn no_robots_with_clocks_of_their_own_touch() {
    let plain = |seed: u32| deaths(seed).split("[[fault]]").next().expect("a part").to_owned();
    let kinds: [(&str, &dyn Fn(u32) -> String); 4] = [
        ("robots on random ways", &plain),
        ("robots of which some die", &deaths),
        ("robots with a slow radio", &delayed),
        ("bodies with inertia", &crossing),
    ];
    for (name, scene) in kinds {
        let (mut ratios, mut failed) = (Vec::new(), Vec::new());
        for seed in seeds(10) {
            let run = |text: &str| {
                let scene = scenario(text);
                let outcome = simulate(&scene, |_, _| ControlFlow::Continue(())).expect("placed");
                (outcome.arrived == scene.robots.len(), outcome.seconds, outcome.collisions)
            };
            let text = scene(seed);
            let (equal, own) = (run(&text), run(&with_own_clocks(&text)));
            if own.2 > 0 {
                failed.push(seed);
            }
            if equal.0 && own.0 {
                ratios.push(libm::log(own.1 / equal.1));
            }
        }
        let mean = libm::exp(ratios.iter().sum::<f64>() / ratios.len().max(1) as f64);
        println!("{name}: last arrival {mean:.3} of that with equal phases, in {} scenes", ratios.len());
        assert!(failed.is_empty(), "{name}: overlaps in {failed:?}");
    }
}
