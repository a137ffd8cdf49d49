use super::*;
use crate::cost::Gain;
use crate::grid::{BLOCKED, Norm, Window};
use crate::time::{Duration, Instant};
use proptest::prelude::*;
use std::vec;
use std::vec::Vec;

const GAINS: Gains = Gains { a0: Gain::ONE, a3: Gain::from_int(3), norm: Norm::Euclidean };

type Map = LandMap<1024>;

fn at(x: i16, y: i16) -> Cell {
    Cell::new(x, y)
}

fn seeing(map: &mut Map, robot: Cell, corner: Cell, side: u16, u: u8) {
    let cells = vec![u; usize::from(side) * usize::from(side)];
    map.see(&Window::new(&cells, corner, side, side).unwrap(), robot);
}

fn tiles() -> impl Strategy<Value = [u8; PATCH_TILES]> {
    any::<[u8; PATCH_TILES]>()
}

#[test]
fn a_tile_is_known_when_half_of_it_is_seen_and_has_the_nearest_price() {
    let flat = [5; 8];
    let half = Window::new(&flat, at(0, 0), 4, 2).unwrap();
    assert_eq!(Tile::seen(&half, at(0, 0)).unwrap().ticks_16(), Some(80));
    let less = Window::new(&flat[..4], at(0, 0), 4, 1).unwrap();
    assert_eq!(Tile::seen(&less, at(0, 0)), None);
    let walls = [BLOCKED; 16];
    let walls = Window::new(&walls, at(-4, -4), 4, 4).unwrap();
    assert_eq!(Tile::seen(&walls, at(-1, -1)).unwrap().ticks_16(), Some(512));
    assert_eq!(Tile::new(0).ticks_16(), Some(16));
    assert_eq!(Tile::UNKNOWN.ticks_16(), None);
}

#[test]
fn a_tile_grows_older_until_it_is_forgotten() {
    let mut tile = Tile::new(48);
    for age in 0..AGES {
        assert_eq!((tile.age(), tile.ticks_16()), (age, Some(48)));
        tile = tile.older();
    }
    assert_eq!(tile, Tile::UNKNOWN);
    assert_eq!(tile.older(), Tile::UNKNOWN);
}

#[test]
fn a_map_forgets_with_time_and_tolerates_a_wrapping_clock() {
    let mut map = Map::new();
    let params = MapParams { forget_after: Duration::from_millis(16_000) };
    let mut now = Instant::from_micros(u32::MAX - 5_000_000);
    map.age(&params, now);
    seeing(&mut map, at(5, 5), at(0, 0), 8, 3);
    for second in 0..16 {
        assert_eq!(map.get(at(0, 0)).age(), second);
        now = now + Duration::from_millis(1000);
        map.age(&params, now);
    }
    assert_eq!(map.get(at(0, 0)), Tile::UNKNOWN);
    assert_eq!(map.say(), None, "nothing is left to tell");
}

#[test]
fn tiles_outside_the_square_are_forgotten_and_the_rest_stay() {
    let mut map = Map::new();
    seeing(&mut map, at(0, 0), at(-20, -20), 40, 3);
    seeing(&mut map, at(60, 0), at(58, 0), 4, 7);
    assert_eq!(map.get(at(4, 0)).ticks_16(), Some(48));
    assert_eq!(map.get(at(-5, 0)), Tile::UNKNOWN);
    assert_eq!(map.get(at(4 - 32, 0)), Tile::UNKNOWN);
    seeing(&mut map, at(i16::MAX, i16::MIN), at(i16::MAX - 3, i16::MIN), 4, 2);
    assert_eq!(map.get(at(4, 0)), Tile::UNKNOWN);
}

#[test]
fn new_tiles_are_sent_first_and_all_are_repeated_in_turn() {
    let mut map = Map::new();
    assert_eq!(map.say(), None);
    seeing(&mut map, at(16, 8), at(0, 0), 40, 3);
    let mut other = Map::new();
    seeing(&mut other, at(16, 8), at(100, 100), 4, 3);
    for _ in 0..24 {
        other.hear(&map.say().unwrap());
    }
    let known =
        |map: &Map| (0..10).flat_map(|y| (0..10).map(move |x| at(x, y))).filter(|&t| map.get(t).is_known()).count();
    assert_eq!((known(&map), known(&other)), (100, 100));
    // In one of the next two messages, wherever it lies.
    seeing(&mut map, at(16, 8), at(36, 36), 4, 9);
    let told = [map.say().unwrap(), map.say().unwrap()];
    assert!(
        told.iter()
            .any(|patch| patch.iter().any(|(place, tile)| place == at(9, 9) && tile.ticks_16() == Some(144 - 16)))
    );
    let mut late = Map::new();
    seeing(&mut late, at(16, 8), at(100, 100), 4, 3);
    for _ in 0..24 {
        late.hear(&map.say().unwrap());
    }
    assert_eq!(known(&late), 100);
}

#[test]
fn own_observations_override_messages_until_they_are_old() {
    let mut map = Map::new();
    let params = MapParams { forget_after: Duration::from_millis(16_000) };
    map.age(&params, Instant::from_micros(0));
    seeing(&mut map, at(2, 2), at(0, 0), 4, 2);
    let lie = LandPatch::from_bytes(at(0, 0), [15; PATCH_TILES]);
    map.hear(&lie);
    assert_eq!(map.get(at(0, 0)).ticks_16(), Some(32));
    assert_eq!(map.get(at(1, 0)).ticks_16(), Some(512), "what it has not seen it believes");
    map.age(&params, Instant::from_micros(4_000_000));
    map.hear(&lie);
    assert_eq!(map.get(at(0, 0)).ticks_16(), Some(512));
    seeing(&mut map, at(2, 2), at(0, 0), 8, 2);
    assert_eq!([map.get(at(0, 0)), map.get(at(1, 0))].map(Tile::ticks_16), [Some(32); 2]);
}

#[test]
fn a_map_of_capacity_zero_works() {
    let mut map = LandMap::<0>::new();
    let cells = [1; 16];
    map.see(&Window::new(&cells, at(0, 0), 4, 4).unwrap(), at(0, 0));
    map.hear(&LandPatch::from_bytes(at(0, 0), [1; PATCH_TILES]));
    map.age(&MapParams::default(), Instant::from_micros(0));
    assert_eq!((map.say(), map.get(at(0, 0))), (None, Tile::UNKNOWN));
    map.look(&GAINS, at(9, 9), &mut |_| panic!("it knows nothing"));
}

/// Above the price of a straight line.
fn surplus_of(outlook: &dyn Outlook, cell: Cell) -> i64 {
    const STRAIGHT: u32 = 1 << 31;
    i64::from(outlook.price(cell, STRAIGHT)) - i64::from(STRAIGHT)
}

fn surplus(map: &Map, cell: Cell, target: Cell) -> Option<i64> {
    let mut surplus = None;
    map.look(&GAINS, target, &mut |outlook| surplus = Some(surplus_of(outlook, cell)));
    surplus
}

#[test]
fn a_hill_on_the_way_costs_and_a_valley_saves() {
    let mut map = Map::new();
    assert_eq!(surplus(&map, at(0, 0), at(40, 0)), None);
    seeing(&mut map, at(0, 0), at(60, 60), 4, 3);
    assert_eq!(surplus(&map, at(0, 0), at(40, 0)), Some(0), "far from all that is known");
    // A ridge from north to south: 8 of 40 cells at 9 instead of 3 ticks.
    for y in -12..12 {
        seeing(&mut map, at(0, 0), at(16, 4 * y), 8, 9);
    }
    let over = surplus(&map, at(-2, 2), at(42, 2)).unwrap();
    let ticks = over as f64 / f64::from(crate::cost::TICK);
    assert!((30.0..70.0).contains(&ticks), "{ticks}");
    assert_eq!(surplus(&map, at(40, 2), at(56, 2)), Some(0));
    let mut valley = Map::new();
    for x in 0..10 {
        seeing(&mut valley, at(0, 0), at(4 * x, 0), 4, 1);
    }
    assert!(surplus(&valley, at(2, 2), at(38, 2)).unwrap() < 0);
}

#[test]
fn any_target_and_extreme_gains_give_finite_costs() {
    let mut map = Map::new();
    seeing(&mut map, at(0, 0), at(-20, -20), 40, 255);
    for target in [at(i16::MIN, i16::MAX), at(i16::MAX, i16::MAX), at(0, 0), at(-1, 500)] {
        for gain in [Gain::ZERO, Gain::from_sixteenths(u16::MAX)] {
            let gains = Gains { a0: gain, a3: gain, norm: Norm::Chebyshev };
            map.look(&gains, target, &mut |outlook| {
                let _ = surplus_of(outlook, at(i16::MIN, i16::MAX)) + surplus_of(outlook, at(3, 3));
            });
        }
    }
}

proptest! {
    #[test]
    fn merging_is_commutative_associative_and_idempotent(a: u8, b: u8, c: u8) {
        let [a, b, c] = [a, b, c].map(|byte| LandPatch::from_bytes(at(0, 0), [byte; PATCH_TILES]).tiles[0]);
        let same = |a: Tile, b: Tile| a == b || !a.is_known() && !b.is_known();
        prop_assert!(same(a.merged(b), b.merged(a)));
        prop_assert!(same(a.merged(b).merged(c), a.merged(b.merged(c))));
        prop_assert_eq!(a.merged(a), a);
        prop_assert!(a.merged(b).age() <= a.age().max(b.age()));
    }

    #[test]
    fn neither_order_nor_repetition_nor_loss_of_repeated_packets_matters(
        patches in prop::collection::vec((-40..40_i16, -40..40_i16, tiles()), 1..8),
        order in prop::collection::vec(0..8_usize, 0..20),
    ) {
        let patches: Vec<LandPatch> =
            patches.into_iter().map(|(x, y, bytes)| LandPatch::from_bytes(at(x, y), bytes)).collect();
        let mut maps = [Map::new(), Map::new()];
        for map in &mut maps {
            seeing(map, at(0, 0), at(0, 0), 11, 4);
        }
        let [once, often] = &mut maps;
        patches.iter().for_each(|patch| once.hear(patch));
        order.iter().filter_map(|&n| patches.get(n)).for_each(|patch| often.hear(patch));
        patches.iter().rev().for_each(|patch| often.hear(patch));
        for place in (-16..16).flat_map(|y| (-16..16).map(move |x| at(x, y))) {
            prop_assert_eq!(once.get(place), often.get(place));
        }
    }

    #[test]
    fn a_patch_of_any_bytes_round_trips_and_stays_within_the_map(x: i16, y: i16, bytes in tiles()) {
        let patch = LandPatch::from_bytes(at(x, y), bytes);
        prop_assert_eq!(patch.bytes(), bytes);
        let mut map = Map::new();
        seeing(&mut map, at(0, 0), at(0, 0), 11, 4);
        map.hear(&patch);
        let said = map.say().unwrap();
        prop_assert!(said.corner.chebyshev(at(0, 0)) <= 16 + 8);
        map.look(&GAINS, at(100, 100), &mut |outlook| {
            let most = i64::from(crate::cost::TICK) * 1000 * 32 * 4;
            assert!(surplus_of(outlook, at(0, 0)).abs() < most);
        });
    }
}
