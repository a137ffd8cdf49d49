use crate::error::SweepError;
use crate::study::Given;
use crate::study::movingai::MovingAi;
use crate::study::{Job, Study as _};
use staya_sim::scenario::Source;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const MAP: &str = "type octile\nheight 3\nwidth 4\nmap\n....\n.@@.\n...S\n";

fn files(rows: &[&str], map: &str) -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let queries: String = rows.iter().map(|row| format!("0\tmaps/x/a.map\t{}\n", row.replace(' ', "\t"))).collect();
    std::fs::write(dir.path().join("a.map.scen"), format!("version 1\n{queries}")).unwrap();
    std::fs::write(dir.path().join("a.map"), map).unwrap();
    let plan = dir.path().join("plan.toml");
    (dir, plan)
}

fn read(plan: &Path, parameters: &str) -> Result<Job, SweepError> {
    let text = format!("[study]\nscen = 'a.map.scen'\n{parameters}");
    MovingAi.read(&Given { source: Source::new(plan, &text)?, measures: &[], seed: 0 })
}

fn answers(rows: &[&str], map: &str, parameters: &str) -> BTreeMap<String, Option<f64>> {
    let (_dir, plan) = files(rows, map);
    read(&plan, parameters).unwrap()(&|_| true).unwrap().values
}

#[test]
fn right_lengths_are_found_and_wrong_ones_are_reported() {
    // Around the wall without cutting its corners; over swamp at the cost of ground; no move.
    let right = ["4 3 0 0 3 2 5", "4 3 0 2 3 2 3", "4 3 2 2 2 2 0"];
    let good = answers(&right, MAP, "radius = 0");
    let exact = [("queries", 3.0), ("arrived", 3.0), ("without_route", 0.0), ("most_percent", 0.0)];
    exact.into_iter().for_each(|(name, value)| assert_eq!(good[name], Some(value), "{name}"));
    assert!(good["price_error_percent"].unwrap() < 1e-9);
    for wrong in ["4 3 0 0 3 2 4.9", "4 3 0 0 3 2 5.1", "4 3 2 2 2 2 1"] {
        let bad = answers(&[wrong], MAP, "radius = 0");
        assert!(bad["price_error_percent"].unwrap() > 1.0, "{wrong}");
    }
    let near = answers(&right, MAP, "radius = 1");
    assert_eq!((near["price_error_percent"], near["without_route"]), (None, None));
}

#[test]
fn mismatched_files_and_wrong_parameters_are_named() {
    let message = |plan: &PathBuf, parameters: &str| read(plan, parameters).err().unwrap().to_string();
    let (dir, plan) = files(&["4 3 0 0 3 2 5", "4 4 0 0 3 2 5"], MAP);
    assert!(message(&plan, "").contains("query 2 is for a map of 4 x 4"));
    let (_dir, walled) = files(&["4 3 0 0 1 1 5"], MAP);
    assert!(message(&walled, "").contains("query 1 starts or ends in a wall"));
    assert!(message(&walled, "visits = 5").contains("starts or ends"));
    let (_dir, good) = files(&["4 3 0 0 3 2 5"], MAP);
    assert!(message(&good, "visits = 5").contains("study.visits: a memory of 5 cells; give 16, 64, 256 or 1024"));
    assert!(message(&good, "learned = 5").contains("give 0, 64 or 256"));
    assert!(message(&good, "a3 = -1").contains("study.a3: -1 is out of range"));
    assert!(message(&good, "radios = 1").contains("radios"));
    let (_dir, empty) = files(&[], MAP);
    assert!(message(&empty, "").contains("no queries"));
    std::fs::remove_file(dir.path().join("a.map")).unwrap();
    assert!(message(&plan, "").contains("maps/x/a.map is not beside it"));
    assert!(message(&plan, "map = 'other.map'").contains("other.map"));
}

fn open(width: usize, height: usize) -> String {
    format!("type octile\nheight {height}\nwidth {width}\nmap\n{}", (".".repeat(width) + "\n").repeat(height))
}

#[test]
fn map_too_large_for_the_search_is_planned_optimally() {
    let query = "300 260 298 0 298 200 200";
    let answer = answers(&[query], &open(300, 260), "radius = 0");
    assert_eq!((answer["arrived"], answer["without_route"]), (Some(1.0), Some(0.0)));
    assert!(answer["price_error_percent"].unwrap() < 0.01);
}

#[test]
fn window_beyond_the_size_of_a_search_is_refused() {
    let is_read = |width: usize, height: usize, radius: u8| {
        let (_dir, plan) = files(&[&format!("{width} {height} 0 0 1 0 1")], &open(width, height));
        read(&plan, &format!("radius = {radius}")).err().map(|error| error.to_string())
    };
    for (width, height, radius) in [(253, 253, 127), (256, 250, 127), (512, 512, 0), (1000, 1000, 126)] {
        assert_eq!(is_read(width, height, radius), None);
    }
    for (width, height) in [(254, 253), (257, 10)] {
        let error = is_read(width, height, 127).unwrap();
        assert!(error.contains("give at most 126"), "{error}");
    }
}
