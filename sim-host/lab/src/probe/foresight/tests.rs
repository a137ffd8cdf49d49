use super::*;
use proptest::prelude::*;
use staya_sim::terrain::change::ChangeKind;
use staya_sim::terrain::generate::{LandPlan, natural};
use staya_sim::terrain::optimal;
use std::num::NonZeroU32;

const MOVES: (Norm, bool) = (Norm::Euclidean, false);
const ENDS: [Cell; 2] = [Cell::new(1, 1), Cell::new(28, 28)];

fn land(seed: u64) -> Terrain {
    natural(&LandPlan { width: 30, height: 30, classes: 9, seed }, 8, Norm::Euclidean).expect("it fits")
}

#[test]
fn static_land_gives_the_fastest_route() {
    for seed in 0..8 {
        let mut land = land(seed);
        for at in 0..25 {
            land.set(Cell::new(at, 29 - at), BLOCKED);
        }
        for corner_cutting in [false, true] {
            let best = optimal::route(&land, ENDS[0], ENDS[1], Norm::Euclidean, corner_cutting).expect("a way").cost;
            let moves = (Norm::Euclidean, corner_cutting);
            let least = Foresight::default().least_cost((&land, &[], seed), ENDS, moves, 1 << 30);
            assert_eq!(least, Some(best));
        }
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
    assert_eq!(foresight.least_cost((&road, &changes, 0), ends, MOVES, 1 << 20), Some(12 * 70));
    // If the cell takes 200 ticks, waiting for its opening is faster.
    let road = Terrain::from_cells(5, 1, vec![1, 1, 200, 1, 1]).expect("fits");
    let least = foresight.least_cost((&road, &changes, 0), ends, MOVES, 1 << 20);
    assert_eq!(least, Some(19 * 70 + 1 + 3 * 70));
    assert_eq!(foresight.least_cost((&road, &changes, 0), ends, MOVES, 19 * 70), None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn foresight_is_faster_than_the_initially_fastest_route(seed: u64, draws in 1_u32..60) {
        let mut now = land(seed);
        let kind = ChangeKind::Drift { cells: None, draws, step: 1, classes: 9 };
        let changes = [LandChange { first: 1, every: NonZeroU32::new(1), kind }];
        let [from, to] = ENDS;
        let route = optimal::route(&now, from, to, Norm::Euclidean, false).expect("a way");
        let first = now.clone();
        let (mut cost, mut tick) = (0_u64, 0);
        for pair in route.cells.windows(2) {
            while u64::from(tick) <= cost.div_ceil(u64::from(UNIT)) {
                change(&mut now, &changes, seed, tick, |_, _| ());
                tick += 1;
            }
            let dir = Dir::between(pair[0], pair[1]).expect("adjacent");
            cost += u64::from(dir.length(Norm::Euclidean)) * u64::from(now.get(pair[1]));
        }
        let least = Foresight::default().least_cost((&first, &changes, seed), ENDS, MOVES, cost);
        prop_assert!(least.is_some_and(|least| least <= cost));
    }
}
