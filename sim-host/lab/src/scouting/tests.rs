use super::*;
use crate::optimal;
use crate::walk::{Task, Walker};
use proptest::prelude::*;
use staya_controller::grid::{Norm, UNIT};
use staya_sim::terrain::change::change;

fn small() -> Plan {
    Plan { runs: 4, size: 30, obstacles: 8, map_radius: 10, ..Plan::default() }
}

fn land(seed: u64, size: u16) -> Terrain {
    let plan = generate::LandPlan { width: size, height: size, classes: CLASSES, seed };
    natural_by(&plan, 8, Norm::Euclidean, Hills::Even).expect("it fits")
}

const ENDS: [Cell; 2] = [Cell::new(1, 1), Cell::new(28, 28)];

#[test]
fn static_land_gives_the_fastest_route_and_the_path_of_the_route_experiment() {
    for seed in 0..8 {
        let land = land(seed, 30);
        let [from, to] = ENDS;
        let best = optimal::route(&land, from, to, Norm::Euclidean, false).expect("a way").cost;
        let least = Foresight::default().least_cost((&land, &[], seed), ENDS, Norm::Euclidean, 1 << 30);
        assert_eq!(least, Some(best));
        let params = RouteParams::default();
        let task = Task { land: &land, parked: &[], from, to };
        let expected = Walker::<{ crate::route::CELLS }>::default().walk(&task, &params, Replan::EachCell);
        let knowledge = Knowledge { map: None, sight: 5 };
        let run = Scout::default().walk((&land, &[], seed), ENDS, &knowledge, &params, Replan::EachCell);
        assert_eq!((run.cost, run.moves as usize, run.arrived), (expected.cost, expected.moves, true));
    }
}

#[test]
fn correct_map_equals_sight_of_the_same_radius() {
    for seed in 0..4 {
        let land = land(seed, 30);
        let params = RouteParams { radius: 12, ..RouteParams::default() };
        let [near, far] = [(Some(&land), 3), (None, 12)].map(|(map, sight)| {
            Scout::default().walk((&land, &[], seed), ENDS, &Knowledge { map, sight }, &params, Replan::EachCell)
        });
        assert_eq!((near.cost, near.moves, near.remembered), (far.cost, far.moves, 0));
    }
}

#[test]
fn foresight_waits_for_a_gate() {
    // The third cell is slow until tick 3, then closed until tick 20.
    let road = Terrain::from_cells(5, 1, vec![1, 1, 9, 1, 1]).expect("fits");
    let kind =
        |class, lasts| ChangeKind::Become { cells: vec![(Cell::new(2, 0), 1)], class, lasts: NonZeroU32::new(lasts) };
    let changes = [LandChange { first: 3, every: None, kind: kind(0, 17) }];
    let ends = [Cell::new(0, 0), Cell::new(4, 0)];
    let mut foresight = Foresight::default();
    assert_eq!(foresight.least_cost((&road, &changes, 0), ends, Norm::Euclidean, 1 << 20), Some(12 * 70));
    // If the cell takes 200 ticks, waiting for its opening is faster.
    let road = Terrain::from_cells(5, 1, vec![1, 1, 200, 1, 1]).expect("fits");
    let least = foresight.least_cost((&road, &changes, 0), ends, Norm::Euclidean, 1 << 20);
    assert_eq!(least, Some(19 * 70 + 1 + 3 * 70));
    assert_eq!(foresight.least_cost((&road, &changes, 0), ends, Norm::Euclidean, 19 * 70), None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn no_robot_is_faster_than_perfect_knowledge(seed: u64, draws in 0_u32..60, sight in 1_u8..8, unknown in 0.0..1.0_f64) {
        let land = land(seed, 30);
        let changes = drifting(&land, f64::from(draws) / 900.0);
        let map = Scouted { unknown, wrong: 1.0 - unknown, patch_cells: 2, assumed: 3, seed }.map(&land);
        let mut foresight = Foresight::default();
        for map in [None, Some(&map)] {
            let params = RouteParams { radius: 9, ..RouteParams::default() };
            let knowledge = Knowledge { map, sight };
            let run = Scout::default().walk((&land, &changes, seed), ENDS, &knowledge, &params, Replan::EachCell);
            prop_assert!(run.arrived);
            let least = foresight.least_cost((&land, &changes, seed), ENDS, params.norm, run.cost);
            prop_assert!(least.is_some_and(|least| least <= run.cost), "{least:?} {}", run.cost);
        }
    }

    #[test]
    fn foresight_is_faster_than_the_initially_fastest_route(seed: u64, draws in 1_u32..60) {
        let mut now = land(seed, 30);
        let changes = drifting(&now, f64::from(draws) / 900.0);
        let [from, to] = ENDS;
        let route = optimal::route(&now, from, to, Norm::Euclidean, false).expect("a way");
        let first = now.clone();
        let (mut cost, mut tick) = (0_u64, 0);
        for pair in route.cells.windows(2) {
            while u64::from(tick) <= cost.div_ceil(u64::from(UNIT)) {
                change(&mut now, &changes, seed, tick, |_, _| ());
                tick += 1;
            }
            let dir = staya_controller::grid::Dir::between(pair[0], pair[1]).expect("adjacent");
            cost += u64::from(dir.length(Norm::Euclidean)) * u64::from(now.get(pair[1]));
        }
        let least = Foresight::default().least_cost((&first, &changes, seed), ENDS, Norm::Euclidean, cost);
        prop_assert!(least.is_some_and(|least| least <= cost));
    }
}

#[test]
fn rows_and_tables_have_a_row_per_knowledge_and_drift() {
    let plan = Plan { drifts: vec![0.0, 0.02], ..small() };
    let runs = plan.carry_out(|_| true).expect("good");
    assert_eq!(runs.len(), 8 * 2);
    let report = plan.report(&runs);
    let text = report.to_string();
    for known in ["\nsight ", "\nmap ", "\nfar sight "] {
        assert!(text.matches(known).count() >= 2, "{text}");
    }
    assert!(report.points.iter().all(|point| point.arrived == 4 && point.time_loss_percent >= Some(0.0)));
    for runs in runs.chunks(2).map(|pair| &pair[0]) {
        assert!(runs.iter().map(|run| run.least_cost).eq(self_least(&plan)));
    }
    fn self_least(plan: &Plan) -> Vec<u64> {
        (0..plan.runs).map(|run| plan.run_one(&mut Scratch::default(), 0, run).expect("good").least_cost).collect()
    }
}

#[test]
fn invalid_plans_are_refused_with_the_permitted_range() {
    let refused = |plan: Plan| plan.check().unwrap_err().to_string();
    assert!(refused(Plan { runs: 0, ..small() }).contains("make 1 or more"));
    assert!(refused(Plan { drifts: vec![], ..small() }).contains("give one share"));
    assert!(refused(Plan { unknown: vec![1.5], ..small() }).contains("1.5 is not a share"));
    assert!(refused(Plan { map_radius: 4, ..small() }).contains("--map-radius 5 or more"));
    assert!(refused(Plan { size: 3, ..small() }).contains("its side must be 4"));
    assert!(refused(Plan { obstacles: 901, ..small() }).contains("901 obstacles on 900 cells"));
}
