use super::*;
use crate::engine::simulate;
use crate::scenario::Overrides;
use crate::terrain::ros;
use staya_controller::grid::{UNIT, Window};
use std::ops::ControlFlow;
use std::path::Path;

fn parse(land: &str, rest: &str, file: &Path) -> Scenario {
    let text = format!("name = \"t\"\nticks = 2000\n[terrain]\n{land}\n{rest}");
    Scenario::parse(&text, file, &Overrides::default()).expect("a good scenario")
}

const NATURAL: &str = "natural = { width = 46, height = 40, classes = 9, obstacles = 12 }";

fn sharing(land: &str) -> Scenario {
    let rest = "[maps]\nshare = true\nforget_after_s = 160\n[robots.scattered]\ncount = 12\nleast = 20\n\
        [radio]\nrange_m = inf\n";
    parse(land, rest, Path::new("t.toml"))
}

/// A map of one tile, seen with this price.
fn seen(at: Cell, ticks: u8) -> LandMap<256> {
    let corner = Cell::new(at.x * TILE, at.y * TILE);
    let mut map = LandMap::new();
    map.see(&Window::new(&[ticks; 16], corner, 4, 4).expect("fits"), corner);
    map
}

#[test]
fn the_newer_price_wins_and_of_equally_new_ones_the_dearer() {
    let mut merged = Remembered::new(&sharing(NATURAL)).expect("maps are shared");
    let at = Cell::new(2, 3);
    assert_eq!((merged.get(at), merged.share()), (Tile::UNKNOWN, 0.0));
    for (tick, ticks, expected) in [(5, 3, 48), (5, 7, 112), (5, 2, 112), (4, 9, 112), (6, 1, 16)] {
        merged.merge(&seen(at, ticks), tick);
        assert_eq!(merged.get(at).ticks_16(), Some(expected), "{ticks} in tick {tick}");
    }
    assert_eq!(merged.share(), 1.0 / 120.0, "12 x 10 tiles");
    assert_eq!(merged.get(Cell::new(-1, 3)), Tile::UNKNOWN);
    assert_eq!(merged.get(Cell::new(12, 3)), Tile::UNKNOWN);
    assert_eq!(merged.on_board().get(at), merged.get(at));
    let alone = parse(NATURAL, "[robots.scattered]\ncount = 2\nleast = 9\n", Path::new("t.toml"));
    assert_eq!(Remembered::new(&alone), None, "no robot shares a map");
}

#[test]
fn a_tile_of_the_map_has_its_price_on_average_and_unknown_ones_that_of_unknown_land() {
    let scenario = sharing(NATURAL);
    let mut merged = Remembered::new(&scenario).expect("maps are shared");
    // Half of the cells cost 2 ticks, the others 1.
    let mut map = LandMap::<256>::new();
    let mut cells = [1; 16];
    cells[..8].fill(2);
    map.see(&Window::new(&cells, Cell::new(8, 8), 4, 4).expect("fits"), Cell::new(8, 8));
    merged.merge(&map, 0);
    let land = merged.map(&scenario.land.terrain);
    let mean = |at: Cell| {
        let cells = (0..4).flat_map(|y| (0..4).map(move |x| Cell::new(at.x * 4 + x, at.y * 4 + y)));
        cells.map(|cell| f64::from(land.get(cell))).sum::<f64>() / 16.0
    };
    assert_eq!([mean(Cell::new(2, 2)), mean(Cell::new(5, 5))], [1.5, 3.0]);
    assert_eq!(mean(Cell::new(3, 2)), 33.0 / 16.0, "beside 1.5 ticks, of 3 supposed");
    assert_eq!((land.width(), land.height()), (46, 40));
}

#[test]
fn robots_fill_the_map_and_the_next_one_goes_by_it() {
    let scenario = sharing(NATURAL);
    let mut merged = Remembered::new(&scenario).expect("maps are shared");
    let mut shares = Vec::new();
    let outcome = simulate(&scenario, |moment, _| {
        merged.look(moment);
        shares.push(merged.share());
        ControlFlow::Continue(())
    });
    assert_eq!(outcome.expect("placed").arrived, 12);
    assert!(shares.windows(2).all(|pair| pair[0] <= pair[1]), "nothing is forgotten");
    assert!(*shares.last().expect("ticks") > 0.6, "{shares:?}");
    // The prices are those of the land.
    let (land, map) = (&scenario.land.terrain, merged.map(&scenario.land.terrain));
    let off = |at: Cell| {
        (0..4)
            .map(|x| f64::from(map.get(at + Cell::new(x, x))) - f64::from(land.get(at + Cell::new(x, x))))
            .sum::<f64>()
    };
    let known = cells([11, 10]).filter(|&at| merged.get(at).is_known());
    assert!(known.map(|at| off(Cell::new(at.x * 4, at.y * 4)).abs() / 4.0).all(|off| off < 2.0));

    let dir = tempfile::tempdir().expect("a folder");
    ros::save(&map, &dir.path().join("map.yaml")).expect("it can be written");
    let next =
        "[robots]\nlist = [{ start = [1, 1], goal = [44, 38] }]\n[scouting]\nmap = \"map.yaml\"\nmodel_bytes = 1024\n";
    let next = parse(NATURAL, next, &dir.path().join("t.toml"));
    assert_eq!(*next.land.known.as_ref().expect("a table").map, map);
    let outcome = simulate(&next, |_, _| ControlFlow::Continue(())).expect("placed");
    assert!(outcome.arrival_times[0].is_some_and(|time| time < 400 * u64::from(UNIT)), "{:?}", outcome.arrival_times);
}
