//! Golden tables of small flock experiments; `cargo xtask bless golden` rewrites them.

use staya_controller::agent::SafetyKind;
use staya_controller::names::Named as _;
use staya_lab::experiment::Experiment as _;
use staya_lab::flock::closing::Closing;
use staya_lab::flock::{Case, Plan, Reference};
use staya_lab::goals;
use staya_sim::metrics::flock::{FlockMeter, polarisation};
use staya_sim::nearby::Space;
use staya_sim::record::RobotRow;
use staya_sim::scenario::{Overrides, Scenario};
use staya_tests::{golden, root, run};
use std::fmt::Write as _;

#[test]
fn golden_experiment_flock() {
    let (mut text, mut gaps) = (String::new(), Vec::new());
    for safety in [SafetyKind::None, SafetyKind::Orca] {
        let plan = Plan {
            cases: Case::ALL.to_vec(),
            references: vec![Reference::Moving],
            runs: 1,
            robots: Some(24),
            safety,
            ..Plan::default()
        };
        let report = plan.measure().expect("a sound plan");
        writeln!(text, "safety {}", report.safety).expect("memory");
        for case in &report.cases {
            let run = &case.each[0];
            let end = run.end.expect("robots are somewhere");
            gaps.extend((end.components > 1).then(|| format!("{}: more than one component", case.case.name())));
            let pair = run.least_pair_over_d.unwrap_or(f64::INFINITY);
            let clear = run.least_clearance_over_d.unwrap_or(f64::INFINITY);
            writeln!(
                text,
                "{:<13} alpha from {:<10} parts {:>2}  R {:8.3} m  E~ {:.5}  K~ {:.5}  pair {pair:.4} d  clear {clear:.4} d  hash {}",
                case.case.name(),
                format!("{:?}", run.alpha.alpha_flocking),
                end.components,
                end.radius_m,
                end.deviation_energy,
                end.velocity_mismatch,
                run.trace_hash
            )
            .expect("memory");
        }
    }
    gaps.dedup();
    golden("experiment-flock", &text, &gaps);
}

#[test]
fn golden_experiment_closing() {
    let plan = Closing { speeds: vec![2.0, 8.0], runs: 2, ..Closing::default() };
    let report = plan.measure().expect("a sound plan");
    let mut text = String::new();
    for line in &report.lines {
        writeln!(
            text,
            "{:<6} {:<7} {} d/s  bare {:>3} overlaps, pair {:.4} d  ORCA {:>3} overlaps, pair {:.4} d",
            format!("{:?}", line.flock),
            format!("{:?}", line.sides),
            line.speed_over_d,
            line.bare.overlaps,
            line.bare.least_pair_over_d,
            line.orca.overlaps,
            line.orca.least_pair_over_d
        )
        .expect("memory");
    }
    let overlap = report.lines.iter().any(|line| line.orca.overlaps > 0);
    golden("experiment-closing", &text, overlap.then(|| "robots behind ORCA overlap".to_owned()).as_slice());
}

#[test]
fn golden_experiment_goals() {
    let all = goals::Knowledge::All;
    let packets = goals::Knowledge::Packets;
    let (mut text, mut gaps) = (String::new(), Vec::new());
    for (knowledge, safety) in [
        (all, SafetyKind::PushOut),
        (packets, SafetyKind::None),
        (packets, SafetyKind::Orca),
        (packets, SafetyKind::PushOut),
    ] {
        let plan = goals::Plan {
            k1: vec![50.0, 150.0],
            k2: vec![0.0, 50.0],
            neighborhoods_m: vec![40.0],
            robots: vec![30],
            knows: vec![knowledge],
            safeties: vec![safety],
            seconds: 150.0,
            step_s: 0.2,
            moves_goal: true,
            ..goals::Plan::default()
        };
        let report = plan.measure().expect("a sound plan");
        writeln!(text, "knows {}, safety {}", knowledge.name(), safety.name()).expect("memory");
        for point in &report.points {
            let of = |value: Option<f64>| value.unwrap_or(f64::NAN);
            gaps.extend((point.arrived < 1.0).then(|| "not all robots arrive".to_owned()));
            let is_bare = safety == SafetyKind::None;
            gaps.extend((point.overlaps > 0 && !is_bare).then(|| "robots behind a layer overlap".to_owned()));
            writeln!(
                text,
                "K1 {:>3}  K2 {:>2}  order {:.4}  together {:.4}  company {:.4}  spread {:.4}  gathered {:.3}  arrived {:.3}  pair {:.4}  overlaps {:>4}  hash {}",
                point.setting.k1,
                point.setting.k2,
                of(point.polarisation),
                of(point.together),
                of(point.company),
                of(point.spread),
                point.gathered,
                point.arrived,
                of(point.least_pair_over_min_distance),
                point.overlaps,
                point.trace_hash
            )
            .expect("memory");
        }
    }
    gaps.sort_unstable();
    gaps.dedup();
    golden("experiment-goals", &text, &gaps);
}

#[test]
fn a_settled_flock_stays_connected() {
    for seed in 1..4 {
        let scenario = seeded("late-flock", seed);
        assert_eq!(scenario.remarks(), Vec::<String>::new());
        let (_, rows) = run(&scenario);
        let mut meter = FlockMeter::new(0.7, 0.84, Space::OPEN);
        for (row, robots) in rows.iter().skip(rows.len() * 3 / 4) {
            let (places, velocities) = motions(robots);
            let measure = meter.look(&places, &velocities).expect("robots are somewhere");
            assert_eq!(measure.components, 1, "seed {seed}, tick {}", row.tick);
            let energies = (measure.deviation_energy, measure.velocity_mismatch);
            assert!(energies.0 < 0.005 && energies.1 < 0.002, "{energies:?}, seed {seed}, tick {}", row.tick);
        }
    }
}

fn seeded(name: &str, seed: u64) -> Scenario {
    let path = root().join("scenarios").join(format!("{name}.toml"));
    Scenario::load(&path, &Overrides { seed: Some(seed), ticks: None }).expect("sound")
}

fn motions(robots: &[RobotRow]) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    robots.iter().map(|robot| (robot.motion.position_m, robot.motion.velocity_mps)).unzip()
}

#[test]
fn a_squeezed_flock_passes_between_the_balls_and_reunites() {
    for seed in 2..4 {
        let (outcome, rows) = run(&seeded("flock-squeeze", seed));
        assert_eq!(outcome.collisions, 0, "seed {seed}");
        for (row, robots) in &rows {
            let (places, _) = motions(robots);
            // Outside of the gap between the balls at (15, 3) and (15, 10) with radius 2.5 m.
            let goes_round = places.iter().any(|[x, y, _]| (x - 15.0).abs() < 0.1 && !(5.5..7.5).contains(y));
            assert!(!goes_round, "seed {seed}, tick {}", row.tick);
        }
        let (places, velocities) = motions(&rows.last().expect("an end").1);
        assert!(places.iter().all(|[x, ..]| *x > 17.5), "seed {seed}: not all are through");
        let mut meter = FlockMeter::new(0.7, 0.84, Space::OPEN);
        assert_eq!(meter.look(&places, &velocities).expect("robots").components, 1, "seed {seed}");
    }
}

/// Within each component of the proximity graph, weighted by its robots.
fn order_within_parts(places: &[[f64; 3]], velocities: &[[f64; 3]], range_m: f64) -> f64 {
    let mut meter = FlockMeter::new(range_m, range_m, Space::OPEN);
    meter.look(places, velocities).expect("robots are somewhere");
    let mut part: Vec<usize> = (0..places.len()).collect();
    for &(one, other) in meter.edges() {
        let (from, to) = (part[one as usize], part[other as usize]);
        part.iter_mut().filter(|part| **part == from).for_each(|part| *part = to);
    }
    let order = |name: usize| {
        let members = part.iter().zip(velocities).filter(|(part, _)| **part == name);
        let own: Vec<[f64; 3]> = members.map(|(_, velocity)| *velocity).collect();
        polarisation(&own) * own.len() as f64
    };
    (0..places.len()).map(order).sum::<f64>() / places.len() as f64
}

#[test]
fn boids_of_a_component_align() {
    for seed in 1..5 {
        let (_, rows) = run(&seeded("boids", seed));
        let order = |(_, robots): &(_, Vec<RobotRow>)| {
            let (places, velocities) = motions(robots);
            order_within_parts(&places, &velocities, 20.0)
        };
        let [start, end] = [rows.first(), rows.last()].map(|row| order(row.expect("two moments")));
        assert!(start < 0.5 && end > 0.7, "seed {seed}: {start} at the start, {end} at the end");
    }
}

/// Number of overlaps, and the tick from which each flock is one component around its own goal.
fn two_flocks(scenario: &Scenario) -> (u64, Option<u32>) {
    let (outcome, rows) = run(scenario);
    let mut meter = FlockMeter::new(0.7, 0.84, Space::OPEN);
    let mut since = None;
    for (row, robots) in &rows {
        let is_there = robots.chunks(12).zip([4.5, -4.5_f64]).all(|(flock, goal_m)| {
            let (places, velocities) = motions(flock);
            let mean = |axis: usize| places.iter().map(|place| place[axis]).sum::<f64>() / 12.0;
            let off_m = (mean(0) - goal_m).abs().max(mean(1).abs());
            meter.look(&places, &velocities).is_some_and(|measure| measure.components == 1) && off_m < 0.5
        });
        since = if is_there { since.or(Some(row.tick)) } else { None };
    }
    (outcome.collisions, since)
}

#[test]
fn two_flocks_pass_without_losing_robots() {
    for seed in 1..4 {
        let (overlaps, since) = two_flocks(&seeded("two-flocks", seed));
        assert_eq!(overlaps, 0, "seed {seed}");
        assert!(since.is_some_and(|tick| tick < 4500), "seed {seed}: {since:?}");
    }
}

#[test]
fn two_groups_of_one_flock_merge_and_stop() {
    let mut scenario = seeded("two-flocks", 1);
    let plane = scenario.plane.as_mut().expect("a plane");
    plane.groups.iter_mut().for_each(|group| group.flock = 0);
    assert_eq!(two_flocks(&scenario).1, None);
}
