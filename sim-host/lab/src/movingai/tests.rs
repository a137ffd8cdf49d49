use super::*;
use staya_controller::grid::{BLOCKED, Cell};

const MAP: &str = "type octile\nheight 3\nwidth 4\nmap\n....\n.@@.\n...S\n";

fn files(rows: &[&str]) -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let scen = dir.path().join("a.map.scen");
    let queries: String = rows.iter().map(|row| format!("0\tmaps/x/a.map\t{}\n", row.replace(' ', "\t"))).collect();
    std::fs::write(&scen, format!("version 1\n{queries}")).unwrap();
    std::fs::write(dir.path().join("a.map"), MAP).unwrap();
    (dir, scen)
}

fn report(rows: &[&str], sight: Sight) -> Report {
    let (_dir, scen) = files(rows);
    let benchmark = Benchmark::load(&scen, None).unwrap();
    let robots = Robots::new(sight);
    Plan { benchmark, robots }.measure().unwrap()
}

#[test]
fn right_lengths_are_found_and_wrong_ones_are_reported() {
    // Around the wall without cutting its corners; over swamp at the cost of ground; no move.
    let right = ["4 3 0 0 3 2 5", "4 3 0 2 3 2 3", "4 3 2 2 2 2 0"];
    let good = report(&right, Sight::Map);
    assert_eq!((good.answered, good.arrived, good.without_price), (3, 3, Some(0)));
    assert!(good.worst_price_error_percent.unwrap() < 1e-9);
    assert_eq!(good.loss_percent.unwrap().max, 0.0);
    for wrong in ["4 3 0 0 3 2 4.9", "4 3 0 0 3 2 5.1", "4 3 2 2 2 2 1"] {
        let bad = report(&[wrong], Sight::Map);
        assert!(bad.worst_price_error_percent.unwrap() > 1.0, "{wrong}");
    }
    let near = report(&right, Sight::Radius(1));
    assert_eq!(near.worst_price_error_percent, None);
    assert_eq!(near.without_price, None);
}

#[test]
fn mismatched_files_are_named() {
    let message = |scen: &Path, map: Option<&Path>| Benchmark::load(scen, map).unwrap_err().to_string();
    let (dir, scen) = files(&["4 3 0 0 3 2 5", "4 4 0 0 3 2 5"]);
    let size = message(&scen, None);
    assert!(size.contains("query 2 is for a map of 4 x 4"), "{size}");
    let (_dir, walled) = files(&["4 3 0 0 1 1 5"]);
    assert!(message(&walled, None).contains("query 1 starts or ends in a wall"));
    let (_dir, empty) = files(&[]);
    assert!(message(&empty, None).contains("no queries"));
    std::fs::remove_file(dir.path().join("a.map")).unwrap();
    let missing = message(&scen, None);
    assert!(missing.contains("maps/x/a.map is not beside it"), "{missing}");
    assert!(message(&dir.path().join("none.scen"), None).contains("none.scen"));
    let other = dir.path().join("other.map");
    assert!(message(&scen, Some(&other)).contains("other.map"));
}

#[test]
fn map_too_large_for_the_search_is_planned_optimally() {
    let mut land = Terrain::flat(300, 260);
    (0..299).for_each(|x| land.set(Cell::new(x, 100), BLOCKED));
    let [start, goal] = [Cell::new(298, 0), Cell::new(298, 200)];
    let optimal_length = 198.0 + 2.0 * std::f64::consts::SQRT_2;
    let query = Query { bucket: 0, map: "a.map".into(), width: 300, height: 260, start, goal, optimal_length };
    let benchmark = Benchmark { map: "a.map".into(), land, queries: vec![query] };
    let report = Plan { benchmark, robots: Robots::new(Sight::Map) }.measure().unwrap();
    assert_eq!((report.arrived, report.without_price), (1, Some(0)));
    assert!(report.worst_price_error_percent.unwrap() < 0.01, "{report}");
}

#[test]
fn window_beyond_the_size_of_a_search_is_refused() {
    let benchmark =
        |width, height| Benchmark { map: "a.map".into(), land: Terrain::flat(width, height), queries: vec![] };
    let answer = |width, height, sight| {
        let (benchmark, robots) = (benchmark(width, height), Robots::new(sight));
        Plan { benchmark, robots }.carry_out(|_| true).map_err(|error| error.to_string())
    };
    assert!(answer(253, 253, Sight::Map).is_ok());
    assert!(answer(256, 250, Sight::Map).is_ok());
    assert!(answer(512, 512, Sight::Map).is_ok());
    assert!(answer(1000, 1000, Sight::Radius(126)).is_ok());
    for (width, height) in [(254, 253), (257, 10)] {
        let error = answer(width, height, Sight::Radius(127)).unwrap_err();
        assert!(error.contains("choose a smaller radius"), "{error}");
    }
}
