//! The parameters of a running robot: what a scenario starts with, an operator may set.

use staya_controller::agent::LayerSettings;
use staya_controller::negotiation::Moves;
use staya_controller::parameters::{Absent, Parameter, Parameters};
use staya_sim::engine::operated;
use staya_sim::scenario::{LawSetup, Line, Overrides, Read as _, Scenario, ScenarioFile, Usual, laws, parameters};
use staya_tests::{golden, root};
use std::fs;

fn accepts_its_own_values(scenario: &Scenario) -> usize {
    let mut swarm = operated(scenario).unwrap_or_else(|error| panic!("{}: {error}", scenario.name));
    let mut tried = 0;
    for index in 0..scenario.robots.len().min(60) {
        for (row, value) in swarm.parameters(index) {
            let name = row.name;
            if matches!(name, "radius_m" | "tolerance_m") && value == 0.0 {
                // Robots in cells have neither.
                continue;
            }
            let place = format!("{}: robot {index}: {name} = {value}", scenario.name);
            assert_eq!(swarm.set_parameter(index, name, value), Ok(()), "{place}");
            assert_eq!(swarm.parameter(index, name), Some(value), "{place}");
            tried += 1;
        }
    }
    tried
}

#[test]
fn an_operator_can_set_each_value_of_each_scenario() {
    let files = fs::read_dir(root().join("scenarios")).expect("scenarios").map(|file| file.expect("a file").path());
    let mut tried = 0;
    for path in files.filter(|path| path.extension().is_some_and(|is| is == "toml")) {
        if ["million", "scale", "scale-plane"].iter().any(|name| path.file_stem().is_some_and(|stem| stem == *name)) {
            continue;
        }
        let overrides = Overrides { seed: None, ticks: Some(1) };
        let scenario = Scenario::load(&path, &overrides).unwrap_or_else(|error| panic!("{error}"));
        tried += accepts_its_own_values(&scenario);
    }
    assert!(tried > 5_000, "only {tried}");
}

/// The ends of the ranges that a file accepts.
#[test]
fn an_operator_can_set_the_ends_of_a_files_ranges() {
    let plane = "name = \"t\"\nticks = 1\ntick_s = 0.1\n[plane]\nradius_m = 0.2\nmax_speed_mps = 1\n\
        robots = { list = [{ start_m = [0, 0] }] }\n";
    let cells = "name = \"t\"\nticks = 1\ntick_s = 1\n[terrain]\nuniform = { width = 90, height = 90, classes = 1 }\n\
        [robots]\nformation = { rows = 2, columns = 2, start = [5, 5], goal = [50, 50] }\n";
    let of = |base: &str, rest: &str| {
        let scenario = Scenario::parse(&format!("{base}{rest}"), root().as_path(), &Overrides::default());
        let tried = accepts_its_own_values(&scenario.unwrap_or_else(|error| panic!("{rest}: {error}")));
        assert!(tried > 3, "{rest}");
    };
    for rest in [
        "tolerance_m = 10000\norca = { horizon_s = 60, wall_horizon_s = 60, share = 1, margin_m = 10 }\n",
        "tolerance_m = 0.001\norca = { horizon_s = 2, wall_horizon_s = 0.01, share = 0, margin_m = 0 }\n",
        "law = \"boids\"\nboids = { crowded_m = 1000, closest_m = 10000, max_turn = 3.15, max_turn_away = 3.15 }\n",
        "law = \"goal_flock\"\ngoal_flock = { min_distance_m = 1000, neighborhood_m = 10000, k1 = 1000, k2 = -1000 }\n",
        "law = \"lattice\"\nlattice = { spacing_m = 100, c1_alpha = 1000, c1_beta = 10000, c1_gamma = 1000, obstacle_ratio = 4 }\n",
    ] {
        of(plane, rest);
    }
    for rest in [
        "[grid.formation]\nhalt_cells = 937\nresume_cells = 936\nplace_gain = 4095\na0 = 4095\na3 = 4095\n",
        "[grid.formation]\nwaits = false\n",
    ] {
        of(cells, rest);
    }
}

/// The value of a row in the settings of laws and layers that have it, unless it depends on others.
fn default(name: &str) -> Option<f32> {
    let mut found = None;
    let mut look = |table: &mut dyn Parameters| {
        let index = table.index(name).filter(|index| table.table()[*index].absent == Absent::Default);
        found = found.or_else(|| table.get(index?));
    };
    for (law, _) in laws() {
        LawSetup::by_name(law, Moves::EIGHT, Some(1.0)).expect("a law").tables(&mut look);
    }
    for (layer, _) in LayerSettings::ALL {
        LayerSettings::by_name(layer).expect("a layer").tables(&mut look);
    }
    found
}

#[test]
fn each_name_for_mavlink_clients_stands_for_one_row() {
    let mut names: Vec<&str> = parameters().into_iter().map(|row| row.mavlink).collect();
    let rows = names.len();
    names.sort_unstable();
    names.dedup();
    assert!(names.len() == rows && rows > 40, "{} names of {rows} rows", names.len());
}

/// The list that the pages refer to.
#[test]
fn golden_list_of_parameters() {
    let mut list = String::from("name            MAVLink         unit      range          default  description\n");
    for Parameter { name, mavlink, unit, range: [least, greatest], what, .. } in parameters() {
        let default = default(name).map_or_else(String::new, |value| format!("{value:.3}"));
        let default = default.trim_end_matches('0').trim_end_matches('.');
        let range = format!("{least} to {greatest}");
        list += &format!("{name:<15} {mavlink:<15} {unit:<9} {range:<14} {default:<8} {what}\n");
    }
    golden("parameters", &list, &[]);
}

fn list_fields(lines: Vec<Line>, table: &str, list: &mut String) {
    for Line { name, doc, kind, limits, words, default, inner, .. } in lines {
        let limits = limits.map_or_else(String::new, |limits| format!(", {limits}"));
        let words = words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(", ");
        let words = if words.is_empty() { words } else { format!(", {words}") };
        let default = if default == Usual::None { String::new() } else { format!(", default {default}") };
        *list += &format!("{table}{name}: {kind}{limits}{words}{default}; {}\n", doc.trim());
        list_fields(inner, &format!("{table}{name}."), list);
    }
}

/// All fields of scenario files, from their tables and from those of the parameters.
#[test]
fn golden_list_of_scenario_fields() {
    let mut list = String::new();
    list_fields(ScenarioFile::lines(), "", &mut list);
    golden("scenario-fields", &list, &[]);
}
