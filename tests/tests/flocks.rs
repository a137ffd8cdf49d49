//! Golden tables of small flock experiments; `cargo xtask bless golden` rewrites them.

use crate::crossing::table;
use staya_lab::sweep::{Figure, Plan};
use staya_sim::metrics::flock::{FlockMeter, polarisation};
use staya_sim::nearby::Space;
use staya_sim::record::RobotRow;
use staya_sim::scenario::{Overrides, Scenario};
use staya_tests::{golden, root, run};

/// Values of a measure, a run each.
fn column(plan: &Plan, all: &[Vec<Figure>], measure: &str) -> Vec<Option<f64>> {
    let column = plan.measures().iter().position(|name| name == measure).expect("a measure");
    all.iter().map(|figures| figures[column].0).collect()
}

#[test]
fn golden_experiment_flock() {
    let (mut text, mut gaps) = (String::new(), Vec::new());
    let orca: &[&str] = &["plane.safety=orca", "plane.orca.horizon_s=0.3", "plane.orca.wall_horizon_s=0.3"];
    let none: &[&str] = &["plane.safety=none"];
    for (figure, knows, safety, scenarios) in [
        ("flock", "packets", none, "scenario=free,rendezvous"),
        ("fragments", "packets", none, ""),
        ("courses", "packets", none, "scenario=split,squeeze"),
        ("flock", "packets", orca, "scenario=free"),
        ("fragments", "packets", orca, ""),
        ("courses", "packets", orca, "scenario=split,squeeze"),
        ("flock", "packets", &["plane.safety=fly", "plane.orca.horizon_s=0.3"], "scenario=rendezvous"),
        ("flock", "all", none, "scenario=free"),
        ("fragments", "all", none, ""),
    ] {
        let knows = format!("study.knows={knows}");
        let scenarios = Some(scenarios).filter(|scenarios| !scenarios.is_empty());
        let few: Vec<&str> = scenarios.into_iter().chain([&*knows, "plane.robots.cloud.count=24"]).collect();
        let (plan, table, all) = table(&format!("olf/{figure}"), &[&few, safety].concat(), 1);
        text += &table;
        let parts = (0..).zip(column(&plan, &all, "flock.parts")).filter(|(_, parts)| *parts != Some(1.0));
        gaps.extend(parts.map(|_| format!("{figure}: more than one component")));
    }
    gaps.dedup();
    golden("experiment-flock", &text, &gaps);
}

#[test]
fn golden_experiment_closing() {
    let (mut text, mut gaps) = (String::new(), Vec::new());
    for figure in ["staya/closing", "staya/closing-boids"] {
        let (plan, table, all) = table(figure, &["plane.safety=none,orca"], 1);
        text += &table;
        let is_behind_orca = |run: u64| plan.values_of(run).contains(&"orca".to_owned());
        let mut overlaps = (0..).zip(column(&plan, &all, "collisions")).filter(|(run, _)| is_behind_orca(*run));
        gaps.extend(
            overlaps.any(|(_, overlaps)| overlaps != Some(0.0)).then(|| "robots behind ORCA overlap".to_owned()),
        );
    }
    golden("experiment-closing", &text, &gaps);
}

#[test]
fn golden_experiment_goals() {
    let (mut text, mut missing) = (String::new(), false);
    for knows in [
        ["study.knows=all", "plane.safety=push_out", "plane.push_out.min_distance_m=10"],
        ["study.knows=packets", "plane.safety=push_out", "plane.push_out.min_distance_m=8"],
        ["study.knows=packets", "plane.safety=none,orca", "plane.sight_m=20"],
    ] {
        let few = [
            "plane.goal_flock.k1=50,150",
            "k2=0,50",
            "neighborhood_m=40",
            "plane.robots.cloud.count=30",
            "plane.robots.cloud.from_m[0]=-110",
            "plane.robots.cloud.to_m[0]=110",
            "plane.robots.cloud.from_m[1]=-110",
            "plane.robots.cloud.to_m[1]=110",
            "ticks=1200",
        ];
        let (plan, table, all) = table("pav/goals", &[&knows[..], &few].concat(), 1);
        text += &table;
        missing |= column(&plan, &all, "company.arrived").into_iter().any(|arrived| arrived != Some(1.0));
    }
    golden("experiment-goals", &text, missing.then(|| "not all robots arrive".to_owned()).as_slice());
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
    let plane = scenario.plane_mut().expect("a plane");
    plane.groups.iter_mut().for_each(|group| group.flock = 0);
    assert_eq!(two_flocks(&scenario).1, None);
}
