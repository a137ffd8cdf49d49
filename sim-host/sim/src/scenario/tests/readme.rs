//! Compares scenarios/README.md with the code.

use super::*;
use staya_controller::agent::parameters;
use staya_controller::cost::Gain;
use staya_controller::formation::{FormationParams, Prediction, Recovery};
use staya_controller::grid::UNIT;
use staya_controller::orca::AvoidParams;
use staya_controller::route::{ExitRule, Replan};
use staya_controller::shuffle::Sharpness;

/// The paths of all fields.
fn paths(lines: Vec<Line>, table: &str, all: &mut Vec<(String, Line)>) {
    for mut line in lines {
        let path = format!("{table}{}", line.name);
        paths(std::mem::take(&mut line.inner), &format!("{path}."), all);
        all.push((path, line));
    }
}

#[test]
fn every_field_is_in_the_table_of_the_readme() {
    // The page of maps lists the fields of `terrain.load`.
    let pages = [include_str!("../../../../../scenarios/README.md"), include_str!("../../../../../maps/README.md")];
    let mut fields = Vec::new();
    paths(ScenarioFile::lines(), "", &mut fields);
    // Other tests of this process add a law.
    fields.retain(|(path, _)| !path.contains(".convoy"));
    for (path, line) in &fields {
        let name = line.name;
        let words = [format!("`{name}`"), format!("`[{path}]`"), format!("`[[{path}]]`")];
        assert!(words.iter().any(|word| pages.iter().any(|page| page.contains(word))), "{path} is missing");
        assert!(!line.doc.is_empty(), "{path} has no documentation");
    }
    assert!(fields.len() > 200, "only {} were found", fields.len());
}

#[test]
fn every_scenario_is_in_the_list_of_the_readme() {
    let readme = include_str!("../../../../../scenarios/README.md");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let mut scenarios = 0;
    for file in fs::read_dir(folder).expect("the scenarios") {
        let path = file.expect("a file").path();
        if path.extension().is_some_and(|e| e == "toml") {
            let name = path.file_stem().and_then(|name| name.to_str());
            let in_list = format!("`{}`", name.expect("a name in UTF-8"));
            let mut rows = readme.lines().filter(|line| line.starts_with("| `"));
            assert!(rows.any(|row| row.contains(&in_list)), "{in_list} is missing");
            Scenario::load(&path, &Overrides::default()).unwrap_or_else(|error| panic!("{error}"));
            scenarios += 1;
        }
    }
    assert!(scenarios > 12, "only {scenarios} were found");
}

fn row_of(field: &str) -> &'static str {
    let readme = include_str!("../../../../../scenarios/README.md");
    let row = readme.lines().find(|line| line.starts_with(&format!("| `{field}`")));
    row.unwrap_or_else(|| panic!("no row of {field}"))
}

#[test]
fn the_ranges_in_the_readme_are_those_of_the_parameters() {
    for (field, name) in [
        ("radius_m", "radius_m"),
        ("horizon_s", "horizon_s"),
        ("share", "share"),
        ("a0", "a0"),
        ("place_gain", "place_gain"),
    ] {
        let parameter = parameters().find(|row| row.name == name).expect("a parameter");
        let [least, greatest] = parameter.range;
        assert!(row_of(field).contains(&format!("{least} to {greatest}")), "{field}");
    }
}

#[test]
fn the_range_of_bodies_is_that_of_the_parameter() {
    let mut fields = Vec::new();
    paths(ScenarioFile::lines(), "", &mut fields);
    let parameter = parameters().find(|row| row.name == "radius_m").expect("a parameter");
    for field in ["plane.radius_m", "plane.group.radius_m", "plane.intruder.radius_m"] {
        let (_, line) = fields.iter().find(|(path, _)| path == field).unwrap_or_else(|| panic!("no {field}"));
        assert_eq!(line.limits, Some(Limits::new(0.001..=65.0, "metres")));
        assert_eq!(line.limits, Some(Limits::of(parameter)));
    }
}

#[test]
fn the_defaults_in_the_readme_match_the_controller() {
    let last_column = |field: &str| {
        let column = row_of(field).trim_end_matches(" |").rsplit(" | ").next();
        column.expect("a column").replace('`', "")
    };
    let number = |gain: Gain| f64::from(gain.sixteenths()) / 16.0;
    let cells = |units: u16| format!("{:.2}", f64::from(units) / f64::from(UNIT));
    let (route, formation) = (RouteSettings::default(), FormationParams::default());
    let gains = [route.params.a0, route.params.a1, route.params.a2, route.params.a3];
    assert_eq!(last_column("a0"), gains.map(|gain| number(gain).to_string()).join(", "));
    assert_eq!(last_column("radius"), route.params.radius.to_string());
    assert_eq!((route.params.exit, route.replan), (ExitRule::Best, Replan::EachCell));
    assert_eq!((last_column("exit"), last_column("replan")), ("\"best\"".into(), "\"each_cell\"".into()));
    assert_eq!((last_column("halved_per_ticks"), route.sharpness), ("0".into(), Sharpness::Greedy));
    assert_eq!(last_column("eps_cells"), formation.eps.to_string());
    assert_eq!(last_column("place_gain"), number(formation.gain).to_string());
    assert_eq!(last_column("halt_cells"), format!("{}, halt_cells", cells(formation.halt_lag)));
    assert_eq!(formation.resume_lag, formation.halt_lag);
    assert_eq!(last_column("lead_cells"), formation.lead.to_string());
    let footprint = f64::from(formation.footprint) / 16.0;
    assert_eq!(last_column("footprint"), footprint.to_string());
    let orca = AvoidParams::<f32>::default();
    assert_eq!(last_column("wall_horizon_s"), orca.wall_horizon_s.to_string());
    assert_eq!((last_column("share"), last_column("margin_m")), (orca.share.to_string(), orca.margin_m.to_string()));
    assert_eq!((formation.prediction, formation.recovery), (Prediction::Constant, Recovery::Wait));
    assert_eq!((last_column("prediction"), last_column("recovery")), ("\"constant\"".into(), "\"wait\"".into()));
}
