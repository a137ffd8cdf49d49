use super::*;
use staya_sim::engine;
use staya_sim::scenario::Source;

fn trip(set: &str, seed: u64) -> Result<Trip, String> {
    let text = "name = 't'\nticks = 60000\nterrain.natural.width = 60\nterrain.natural.height = 60\nterrain.natural.obstacles = 40\n\
        robots.list = [{ start = [1, 1], goal = [58, 58] }]\n";
    let text = format!("{text}{set}");
    let source = Source::new(Path::new("t.toml"), &text).unwrap();
    Trip::read(&Given { source, measures: &[], seed }).map_err(|error| error.to_string())
}

#[test]
fn with_learned_costs_the_robot_takes_the_time_of_the_engine_and_without_them_sometimes_another() {
    let mut differ = 0;
    for seed in 1..=12 {
        let learning = trip("study = {}", seed).unwrap();
        let outcome = engine::simulate(&learning.scenario, |_, _| std::ops::ControlFlow::Continue(())).unwrap();
        assert_eq!(outcome.arrival_times, [Some(learning.walk().0.cost)], "seed {seed}");
        differ += u32::from(trip("study = { learned = 0 }", seed).unwrap().walk().0 != learning.walk().0);
    }
    assert!((1..12).contains(&differ), "{differ}");
}

#[test]
fn robot_that_sees_the_whole_map_loses_nothing_and_shuffled_land_has_equal_entropy() {
    let values = |set: &str| trip(set, 3).unwrap().measured().values;
    let whole = values("study = { radius = 60 }");
    assert_eq!((whole["arrived"], whole["loss_percent"], whole["length_percent"]), (Some(1.0), Some(0.0), Some(0.0)));
    let [hills, shuffled] = [false, true].map(|is| values(&format!("terrain.natural.shuffled = {is}")));
    assert_eq!(hills["entropy"], shuffled["entropy"]);
    assert!(hills["total_edge"] < shuffled["total_edge"]);
    assert!(hills["loss_percent"] > Some(0.0));
}

#[test]
fn robot_goes_around_parked_ones_and_the_picture_shows_both_ways() {
    let trip = trip("study = { parked = 300 }", 5).unwrap();
    assert_eq!(trip.parked.len(), 300);
    let (walk, walker, best) = trip.walk();
    assert!(walk.arrived && walker.path().iter().all(|cell| trip.parked.binary_search(cell).is_err()));
    let dir = tempfile::tempdir().unwrap();
    trip.drawn("t").write(&dir.path().join("way")).unwrap();
    let svg = std::fs::read_to_string(dir.path().join("way.svg")).unwrap();
    for part in ["by window: ", "fastest: ", "its window halfway, ", "cost 1 to "] {
        assert!(svg.contains(part), "{part}");
    }
    assert_ne!(walker.path(), best.unwrap().cells);
}

#[test]
fn wrong_parameters_are_named() {
    for (set, expected) in [
        ("study = { radius = 127 }", "study.radius: a window of radius 127"),
        ("study = { parked = 1801 }", "study.parked: 1801 parked robots on 3600 cells"),
        ("study = { learned = 5 }", "give 0, 64 or 256"),
        ("study = { radios = 5 }", "radios"),
    ] {
        let error = trip(set, 1).err().unwrap();
        assert!(error.contains(expected), "{error}");
    }
}
