use crate::cost::Gain;
use crate::grid::{Cell, Norm, UNIT, Window};
use crate::land::cost_to_go::{CostToGo, Header, MOST};
use crate::land::{LandMap, LandPatch, PATCH_TILES, TILE, Tile};
use proptest::prelude::*;
use std::vec;
use std::vec::Vec;

const GOAL: Cell = Cell::new(33, 30);
/// Two nodes per tile of 40 x 40 cells, which begin within a tile.
const HEADER: Header = Header { nodes: [20; 2], cells: [40; 2], origin: Cell::new(2, 1), goal: GOAL, unit: 0 };

fn map_of(ticks: impl Fn(Cell) -> Option<u8>) -> LandMap<256> {
    let middle = Cell::new(20, 20);
    let mut map = LandMap::around(middle);
    for at in (0..11).flat_map(|y| (0..11).map(move |x| Cell::new(x, y))) {
        if let Some(ticks) = ticks(at) {
            let corner = Cell::new(at.x * TILE, at.y * TILE);
            map.see(&Window::new(&[ticks; 16], corner, 4, 4).unwrap(), middle);
        }
    }
    map
}

fn table<const T: usize>(map: &LandMap<T>, header: &Header, norm: Norm) -> Option<CostToGo<Vec<u8>>> {
    let mut bytes = vec![0xAA; header.length()];
    let length = map.write_costs(header, Gain::from_int(3), norm, &mut bytes)?;
    assert_eq!(length, bytes.len());
    Some(CostToGo::from_bytes(bytes).expect("sound"))
}

fn ticks(table: &CostToGo<Vec<u8>>, x: i16, y: i16) -> f64 {
    table.at(Cell::new(x, y)) as f64 / f64::from(256 * UNIT)
}

#[test]
fn on_even_land_the_time_is_that_of_a_straight_line() {
    let even = map_of(|_| Some(4));
    for (norm, diagonal) in [(Norm::Chebyshev, 1.0), (Norm::Euclidean, 99.0 / 70.0)] {
        let table = table(&even, &HEADER, norm).expect("a table");
        let header = table.header();
        assert_eq!(Header { unit: 0, ..*header }, HEADER);
        for (x, y) in [(33, 30), (2, 1), (41, 40), (33, 2), (5, 30), (20, 17), (34, 31)] {
            let (dx, dy) = (f64::from((x - GOAL.x).abs()), f64::from((y - GOAL.y).abs()));
            let expected = 4.0 * (dx.max(dy) - dx.min(dy) + diagonal * dx.min(dy));
            let found = ticks(&table, x, y);
            assert!((found - expected).abs() < 8.0, "{norm:?} {x} {y}: {found}, not {expected}");
        }
    }
}

#[test]
fn a_ridge_is_passed_through_its_gap_and_never_around_the_land() {
    // Two tiles wide, open in the north; the land ends in its middle, and beside it is easy ground.
    let ridge = |at: Cell| if (4..6).contains(&at.x) && at.y < 8 { 30 } else { 1 };
    let open = table(&map_of(|_| Some(1)), &HEADER, Norm::Euclidean).expect("a table");
    let around = table(&map_of(|at| Some(ridge(at))), &HEADER, Norm::Euclidean).expect("a table");
    let extra = |x, y| ticks(&around, x, y) - ticks(&open, x, y);
    assert!(extra(6, 10) > 8.0, "{}", extra(6, 10));
    assert!(extra(6, 38).abs() < 3.0 && extra(38, 4).abs() < 3.0);
    assert!(ticks(&around, 6, 10) > ticks(&around, 12, 33));
    let narrow = Header { cells: [40, 28], goal: Cell::new(33, 20), ..HEADER };
    let across = table(&map_of(|at| Some(ridge(at))), &narrow, Norm::Euclidean).expect("a table");
    assert!(ticks(&across, 6, 10) > 8.0 * 25.0, "{}", ticks(&across, 6, 10));
}

#[test]
fn unknown_tiles_cost_what_is_supposed_of_them() {
    let nothing = map_of(|at| (at == Cell::new(0, 10)).then_some(1));
    let table = table(&nothing, &HEADER, Norm::Chebyshev).expect("a table");
    let found = ticks(&table, 5, 10);
    assert!((found - 3.0 * 28.0).abs() < 6.0, "{found}");
}

#[test]
fn a_goal_or_land_beyond_the_square_of_tiles_has_finite_times() {
    let map = map_of(|_| Some(2));
    let wide = Header { nodes: [255, 2], cells: [9000, 40], goal: Cell::new(8000, 30), ..HEADER };
    let table = table(&map, &wide, Norm::Euclidean).expect("a table");
    assert!(ticks(&table, 10, 10) > ticks(&table, 38, 10));
}

#[test]
fn what_has_no_table_is_refused() {
    let map = map_of(|_| Some(2));
    let refused = |header: Header| table(&map, &header, Norm::Euclidean).is_none();
    assert!(!refused(HEADER));
    assert!(refused(Header { goal: Cell::new(42, 30), ..HEADER }), "off the land");
    assert!(refused(Header { nodes: [1, 20], ..HEADER }) && refused(Header { cells: [40, 1], ..HEADER }));
    let few = map.write_costs(&HEADER, Gain::ONE, Norm::Euclidean, &mut vec![0; HEADER.length() - 1]);
    assert_eq!(few, None);
    assert!(table(&LandMap::<256>::new(), &HEADER, Norm::Euclidean).is_none(), "no tile was ever known");
    assert!(table(&LandMap::<0>::around(GOAL), &HEADER, Norm::Euclidean).is_none());
}

#[test]
fn a_base_station_merges_patches_without_seeing_anything() {
    let mut base = LandMap::<1024>::around(Cell::new(48, 48));
    assert_eq!(base.get(Cell::new(9, 9)), Tile::UNKNOWN);
    let patch = LandPatch { corner: Cell::new(8, 8), tiles: [Tile::new(64); PATCH_TILES] };
    base.hear(&patch);
    assert_eq!(base.get(Cell::new(9, 9)).ticks_16(), Some(64));
}

proptest! {
    #[test]
    fn any_map_gives_a_sound_table_or_none(
        patches in prop::collection::vec((-70..70_i16, -70..70_i16, any::<[u8; PATCH_TILES]>()), 0..4),
        nodes in any::<[u8; 2]>(),
        cells in any::<[u16; 2]>(),
        (x, y, dx, dy) in (any::<i16>(), any::<i16>(), 0..200_i16, 0..200_i16),
        unknown: u16,
        is_far: bool,
    ) {
        let mut map = LandMap::<256>::around(Cell::new(0, 0));
        patches.iter().for_each(|&(x, y, bytes)| map.hear(&LandPatch::from_bytes(Cell::new(x, y), bytes)));
        let origin = if is_far { Cell::new(x, y) } else { Cell::new(x >> 9, y >> 9) };
        let goal = Cell::new(origin.x.saturating_add(dx), origin.y.saturating_add(dy));
        let header = Header { nodes, cells, origin, goal, unit: 0 };
        let mut bytes = vec![0; header.length()];
        let norm = if is_far { Norm::Chebyshev } else { Norm::Euclidean };
        if let Some(length) = map.write_costs(&header, Gain::from_sixteenths(unknown), norm, &mut bytes) {
            let table = CostToGo::from_bytes(&bytes[..length]).expect("sound");
            let most = u64::from(table.header().unit) * u64::from(MOST);
            prop_assert!(table.at(Cell::new(x, y)) <= most && table.header().goal == goal);
        }
    }
}
