//! The Moving AI benchmark: optimal lengths with the whole map, pinned arrivals with a window.

use staya_controller::cost::Gain;
use staya_lab::experiment::Experiment as _;
use staya_lab::movingai::{Answer, Benchmark, Learning, Plan, Report, Robots, Sight};
use std::path::{Path, PathBuf};

/// Percent; sqrt 2 as 99/70 deviates by 0.005 %.
const TOLERANCE_PERCENT: f64 = 0.1;

fn benchmark(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/movingai").join(name)
}

fn answers(scen: &Path, robots: &Robots) -> (Report, Vec<Answer>) {
    let plan = Plan { benchmark: Benchmark::load(scen, None).unwrap(), robots: *robots };
    let answers = plan.carry_out(|_| true).unwrap();
    (plan.report(&answers), answers.concat())
}

fn assert_optimal(scen: &Path, queries: usize) {
    let (_, answers) = answers(scen, &Robots::new(Sight::Map));
    assert_eq!(answers.len(), queries);
    for (query, answer) in answers.iter().enumerate() {
        let price = answer.price_error_percent().map(f64::abs);
        let is_priced = price.is_some_and(|error| error <= TOLERANCE_PERCENT);
        let is_walked = answer.arrived && answer.loss_percent().abs() <= TOLERANCE_PERCENT;
        assert!(is_priced && is_walked, "query {}: {answer:?}", query + 1);
    }
}

#[test]
fn pocket_is_left_by_shortest_paths() {
    // Along walls, over swamp, around corners, out of a dead end.
    let scen = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/pocket.map.scen");
    assert_optimal(&scen, 6);
}

#[test]
fn pocket_is_left_by_a_robot_that_sees_two_cells() {
    let scen = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/pocket.map.scen");
    let (report, answers) = answers(&scen, &Robots::new(Sight::Radius(2)));
    assert_eq!(report.arrived, 6);
    assert!(answers.iter().all(|answer| answer.loss_percent() > -TOLERANCE_PERCENT));
    assert!(report.loss_percent.unwrap().max > 10.0, "{report:?}");
}

#[test]
fn arena_is_crossed_at_the_optimal_lengths() {
    assert_optimal(&benchmark("arena.map.scen"), 160);
}

#[test]
fn den312d_is_crossed_at_the_optimal_lengths() {
    assert_optimal(&benchmark("den312d.map.scen"), 320);
}

/// Learning method, weight a3 in ticks, and largest mean loss on game maps, percent.
const LEARNERS: [(Learning, u16, Option<f64>); 4] = [
    (Learning::Cells256, 1, Some(80.0)),
    (Learning::Cells256, 3, Some(80.0)),
    (Learning::Cells64, 3, None),
    (Learning::None, 3, None),
];

/// Percent.
fn mean_loss_of_five_cells(name: &str, queries: usize, learning: Learning, a3: u16) -> f64 {
    let mut robots = Robots::new(Sight::Radius(5));
    (robots.learning, robots.params.a3) = (learning, Gain::from_int(a3));
    let (report, _) = answers(&benchmark(name), &robots);
    assert_eq!(report.arrived, queries, "{name}, {learning:?}");
    println!("{learning:?}, a3 = {a3}\n{report}");
    report.loss_percent.expect("all arrived").mean
}

#[test]
fn robots_that_see_five_cells_all_arrive() {
    for (learning, a3, loss) in LEARNERS {
        for (name, queries) in [("arena.map.scen", 160), ("den312d.map.scen", 320)] {
            let mean = mean_loss_of_five_cells(name, queries, learning, a3);
            assert!(loss.is_none_or(|most| mean <= most), "{name}, {learning:?}: {mean} %");
        }
    }
}

#[test]
#[ignore = "930 queries four times: 20 s"]
fn robots_that_see_five_cells_all_arrive_in_berlin() {
    for (learning, a3, _) in LEARNERS {
        mean_loss_of_five_cells("Berlin_0_256.map.scen", 930, learning, a3);
    }
}

#[test]
fn berlin_is_crossed_at_the_optimal_lengths_although_it_is_larger_than_the_search() {
    let (report, _) = answers(&benchmark("Berlin_0_256.map.scen"), &Robots::new(Sight::Map));
    assert_eq!((report.arrived, report.without_price), (report.queries, Some(0)));
    assert!(report.worst_price_error_percent.unwrap() <= 0.01, "{report}");
}
