use super::*;
use crate::walk::Walker;
use staya_controller::grid::{BLOCKED, Dir, Window};
use staya_controller::robot::RobotId;
use staya_controller::route::{CostField, ExitRule, Router};
use staya_sim::world::{MoveRules, World};

fn plan() -> Plan {
    Plan {
        lands: vec![Land::Natural(6), Land::Natural(20)],
        runs: 20,
        size: 40,
        params: RouteParams {
            radius: 5,
            exit: ExitRule::Best,
            norm: Norm::Euclidean,
            corner_cutting: false,
            a0: Gain::ONE,
            a1: Gain::from_int(2),
            a2: Gain::from_int(3),
            a3: Gain::from_int(3),
        },
        seed: 1,
        ..Plan::default()
    }
}

fn all(plan: &Plan) -> Vec<Vec<Run>> {
    plan.carry_out(|_| true).unwrap()
}

fn mean_loss(results: &[Vec<Run>]) -> f64 {
    let runs = results.iter().flatten();
    let losses: Vec<f64> = runs.map(|run| run.walks[0].cost as f64 / run.optimal_cost as f64 - 1.0).collect();
    staya_stats::mean(&losses).unwrap()
}

#[test]
fn results_are_equal_on_one_thread_and_on_four() {
    let plan = Plan { runs: 80, sweep: vec![(Coefficient::A3, Gain::ONE)], parked: 10, ..plan() };
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| {
            let results = all(&plan);
            let report = serde_json::to_string(&plan.report(&results)).unwrap();
            (results, report)
        })
    };
    assert_eq!(on(1), on(4));
}

#[test]
fn small_experiment_matches_its_recorded_results() {
    let results = all(&Plan { runs: 3, ..plan() });
    let numbers: Vec<_> = results
        .iter()
        .flatten()
        .map(|run| {
            let walk = run.walks[0];
            [run.total_edge, run.optimal_cost, run.optimal_length, walk.cost, walk.length]
        })
        .collect();
    let pinned = [
        [975, 4032, 4032, 4032, 4032],
        [937, 6622, 4500, 6779, 4657],
        [882, 6921, 4401, 8556, 5432],
        [1518, 10818, 5142, 14835, 4459],
        [1446, 6299, 3991, 6299, 3991],
        [1486, 6950, 4582, 6950, 4582],
    ];
    assert_eq!(numbers, pinned);
}

#[test]
fn no_robot_is_faster_than_the_optimum_though_some_paths_are_shorter() {
    let plan = Plan { runs: 100, ..plan() };
    let results = all(&plan);
    let runs = || results.iter().flatten();
    let shortest = 37 * u64::from(Dir::NorthEast.length(Norm::Euclidean));
    for run in runs() {
        let walk = run.walks[0];
        assert!(walk.arrived);
        assert!(walk.cost >= run.optimal_cost);
        assert!(walk.length >= shortest && run.optimal_length >= shortest);
    }
    assert!(runs().any(|run| run.walks[0].cost > run.optimal_cost));
    // The optimum goes around terrain that the robot crosses.
    assert!(runs().any(|run| run.walks[0].length < run.optimal_length));
}

#[test]
fn window_over_the_whole_land_gives_the_optimum() {
    for replan in [Replan::EachCell, Replan::UntilChanged] {
        let mut plan = Plan { size: 30, replan, ..plan() };
        plan.params.radius = 29;
        for run in all(&plan).iter().flatten() {
            assert_eq!(run.walks[0].cost, run.optimal_cost);
        }
    }
}

#[test]
fn larger_windows_and_the_better_exit_rule_lose_less() {
    let plan = Plan { runs: 100, ..plan() };
    let with = |radius, exit| {
        let params = RouteParams { radius, exit, ..plan.params };
        let plan = Plan { params, ..plan.clone() };
        mean_loss(&all(&plan))
    };
    let usual = with(5, ExitRule::Best);
    assert!(with(9, ExitRule::Best) < usual);
    assert!(with(3, ExitRule::Best) > usual);
    assert!(with(5, ExitRule::Ray) > usual);
}

#[test]
fn early_end_keeps_the_first_runs_of_every_point() {
    let plan = Plan { runs: 150, ..plan() };
    let some = plan.carry_out(|done| done < 100).unwrap();
    let full = all(&plan);
    for (some, full) in some.iter().zip(&full) {
        assert_eq!(some[..], full[..some.len()]);
    }
    let made: usize = some.iter().map(Vec::len).sum();
    assert!((100..plan.total()).contains(&made), "{made}");
    let none = plan.carry_out(|_| false).unwrap();
    assert!(plan.report(&none).points.is_empty());
    assert!(plan.example(&none).unwrap().is_none());
}

#[test]
fn sweep_uses_the_same_landscapes() {
    let plan = Plan {
        sweep: vec![
            (Coefficient::A3, Gain::from_int(1)),
            (Coefficient::A3, plan().params.a3),
            (Coefficient::A1, Gain::from_int(9)),
        ],
        ..plan()
    };
    let runs = all(&plan);
    let results = plan.by_land(&runs);
    for run in results.iter().flatten() {
        let [own, _, same, lonely] = run.walks[..] else { panic!("one walk per variant") };
        assert_eq!(own, same);
        assert_eq!(own, lonely, "a1 has no effect on a robot alone");
    }
    assert!(results.iter().flatten().any(|run| run.walks[0] != run.walks[1]));
    let report = plan.report(&runs);
    assert_eq!(report.sweep[1].value, 3.0);
    let own = report.points[0].time_loss_percent.unwrap().summary.mean;
    assert_eq!(report.sweep[1].points[0].time_loss_percent, Some(own));
}

#[test]
fn shuffled_land_has_the_classes_of_natural_land_and_more_edges() {
    let plan = plan();
    for run in 0..5 {
        let of = |land| Metrics::of(&plan.landscape(land, run).unwrap());
        let (natural, shuffled) = (of(Land::Natural(20)), of(Land::Shuffled(20)));
        assert_eq!(natural.entropy, shuffled.entropy);
        assert!(shuffled.total_edge > natural.total_edge * 3 / 2);
    }
}

#[test]
fn robots_go_around_parked_ones() {
    let plan = Plan { parked: 300, ..plan() };
    let results = all(&plan);
    let example = plan.example(&results).unwrap().unwrap();
    assert_eq!(example.parked.len(), 300);
    assert!(example.way.iter().all(|cell| !example.parked.contains(cell)));
    assert!(example.run.walks[0].arrived);
    assert_eq!(example.way.first(), Some(&plan.start()));
    assert_eq!(example.way.last(), Some(&plan.target()));
    let alone = all(&Plan { parked: 0, ..plan });
    assert!(mean_loss(&results) > mean_loss(&alone));
}

#[test]
fn robot_without_a_free_move_stays() {
    let land = Terrain::from_cells(3, 3, vec![1, BLOCKED, 1, BLOCKED, BLOCKED, 1, 1, 1, 1]).unwrap();
    let mut walker = Walker::<25>::default();
    let (from, to) = (Cell::new(0, 0), Cell::new(2, 2));
    let mut task = Task { land: &land, parked: &[], from, to };
    let params = plan().params;
    let walled = walker.walk(&task, &params, Replan::EachCell);
    assert_eq!(walled, Walk::default());
    let flat = Terrain::flat(3, 3);
    let around = [Cell::new(0, 1), Cell::new(1, 0), Cell::new(1, 1)];
    task = Task { land: &flat, parked: &around, ..task };
    for replan in [Replan::EachCell, Replan::UntilChanged] {
        assert_eq!(walker.walk(&task, &params, replan), Walk::default());
    }
    task.to = from;
    let there = walker.walk(&task, &params, Replan::EachCell);
    assert!(there.arrived && there.moves == 0);
}

#[test]
fn robot_that_cannot_arrive_gives_up() {
    let mut cells = vec![1; 64];
    for at in [54, 55, 62] {
        cells[at] = BLOCKED;
    }
    let land = Terrain::from_cells(8, 8, cells).unwrap();
    let task = Task { land: &land, parked: &[], from: Cell::new(0, 0), to: Cell::new(7, 7) };
    let walk = Walker::<169>::default().walk(&task, &plan().params, Replan::EachCell);
    assert!(!walk.arrived);
    assert!(walk.moves <= 20 * 16);
}

#[test]
fn path_matches_that_of_a_robot_that_gets_only_its_window() {
    let plan = plan();
    for run in 0..10 {
        let land = plan.landscape(Land::Natural(20), run).unwrap();
        let starts = [(RobotId(1), plan.start())];
        let world = World::new(land.clone(), MoveRules::default(), 0, starts).unwrap();
        let mut router = Router::<64>::new();
        let mut field = CostField::<169>::new();
        let mut buffer = Vec::new();
        let (mut here, to) = (plan.start(), plan.target());
        let mut way = vec![here];
        while here != to {
            router.observe(&plan.params, here, to);
            let window: Window<'_> = world.window(here, 5, &mut buffer).unwrap();
            let weights = router.weights(&plan.params, &mut field, &window, here, to, []);
            here = here + weights.unwrap().best().unwrap().offset();
            way.push(here);
        }
        let mut walker = Walker::<CELLS>::default();
        let task = Task { land: &land, parked: &[], from: plan.start(), to };
        walker.walk(&task, &plan.params, Replan::EachCell);
        assert_eq!(walker.path(), way);
    }
}

#[test]
fn report_agrees_with_the_runs() {
    let run = |arrived, cost, length| Run {
        entropy: 1.0,
        total_edge: 800,
        optimal_cost: 7000,
        optimal_length: 700,
        walks: vec![Walk { arrived, cost, length, moves: 9 }],
    };
    let plan = Plan { lands: vec![Land::Natural(5)], ..plan() };
    let report = plan.report(&[vec![run(true, 10_500, 630), run(true, 7000, 770), run(false, 99_999, 9999)]]);
    let point = &report.points[0];
    assert_eq!((point.runs, point.arrived), (3, 2));
    let [time, length] = [point.time_loss_percent, point.length_loss_percent].map(Option::unwrap);
    assert_eq!((time.summary.mean, time.summary.median), (25.0, 25.0));
    assert_eq!(length.summary.mean, 10.0, "10 % shorter and 10 % longer");
    assert_eq!(point.length_excess_percent, Some(0.0));
    assert_eq!((point.total_edge, point.total_edge_density), (800.0, 0.5));
    let arrivals = point.arrivals.as_ref().unwrap();
    assert_eq!((arrivals.mean_ticks, arrivals.counts.iter().sum()), (125.0, 2));
    assert!(arrivals.norton_rice.is_none() && arrivals.goodness.is_none());
}

#[test]
fn invalid_plans_are_refused_with_a_remedy() {
    let message = |plan: Plan| plan.carry_out(|_| true).unwrap_err().to_string();
    let radius = |radius| Plan { params: RouteParams { radius, ..plan().params }, ..plan() };
    assert!(message(Plan { runs: 0, ..plan() }).contains("1 or more"));
    assert!(message(Plan { lands: vec![], ..plan() }).contains("number of obstacles"));
    assert!(message(Plan { size: 3, ..plan() }).contains("must be 4..=2000"));
    assert!(message(Plan { size: 2001, ..plan() }).contains("must be 4..=2000"));
    assert!(message(Plan { classes: 0, ..plan() }).contains("number of classes"));
    assert!(message(Plan { parked: 801, ..plan() }).contains("801 parked robots on 1600 cells"));
    assert!(message(radius(0)).contains("must be 1..=31"));
    assert!(message(radius(32)).contains("must be 1..=31"));
    let lands = vec![Land::Natural(10), Land::Natural(1601)];
    let crowded = message(Plan { lands, ..plan() });
    assert!(crowded.contains("1601 obstacles on 1600 cells"), "{crowded}");
}

#[test]
fn smallest_land_and_most_obstacles_work() {
    let plan = Plan {
        lands: vec![Land::Natural(0), Land::Natural(16), Land::Shuffled(16), Land::Uniform],
        runs: 2,
        size: 4,
        parked: 8,
        ..plan()
    };
    let report = plan.measure().unwrap();
    assert_eq!(report.points.len(), 4);
    assert_eq!(report.points[1].entropy, 0.0);
}

#[test]
fn pictures_are_drawn_for_both_kinds_of_land() {
    let dir = tempfile::tempdir().unwrap();
    let draw = |lands| {
        let plan = Plan {
            lands,
            runs: 12,
            sweep: vec![(Coefficient::A3, Gain::ONE), (Coefficient::A3, Gain::from_int(6))],
            ..plan()
        };
        let results = all(&plan);
        let files = plan.draw(&results, &plan.report(&results), dir.path()).unwrap();
        let name = |file: &std::path::PathBuf| file.file_name().unwrap().to_str().unwrap().to_owned();
        assert!(files.iter().all(|file| std::fs::metadata(file).unwrap().len() > 1000));
        files.iter().map(name).collect::<Vec<_>>().join(" ")
    };
    assert_eq!(
        draw(plan().lands),
        "figure3.svg figure3.png figure4b.svg figure4b.png \
         example-natural.svg example-natural.png sweep-a3.svg sweep-a3.png"
    );
    assert_eq!(
        draw(vec![Land::Shuffled(20), Land::Uniform]),
        "figure2.svg figure2.png figure4a.svg figure4a.png \
         example-uniform.svg example-uniform.png sweep-a3.svg sweep-a3.png"
    );
}
