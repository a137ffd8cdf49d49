//! Compares scenarios/README.md with the code.

use super::*;
use crate::own_law::Site;
use staya_controller::negotiation::Moves;

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

/// Why a default is not a value of its field.
fn refused(line: &Line, value: &str) -> Option<String> {
    let text = format!("value = {value}");
    let table = match toml::de::DeTable::parse(&text) {
        Ok(table) => table,
        Err(error) => return Some(error.message().to_owned()),
    };
    let node = table.get_ref().get("value")?;
    let out = line.limits.as_ref().and_then(|limits| limits.check_node(node).err());
    let word = node.get_ref().as_str().filter(|word| !line.words.is_empty() && !line.words.contains(word));
    let wrong = (line.reads)(node).err().or(out).map(|wrong| wrong.what);
    wrong.or(word.map(|word| format!("{word} is none of {:?}", line.words)))
}

#[test]
fn each_default_is_a_value_that_its_field_accepts() {
    let mut fields = Vec::new();
    paths(ScenarioFile::lines(), "", &mut fields);
    let mut values = 0;
    for (path, line) in &fields {
        if let Usual::Value(value) = &line.default {
            assert_eq!(refused(line, value), None, "{path} = {value}");
            values += 1;
        }
        let shown = format!("{} {}", line.default, line.doc);
        let rust = ["::", "()", "..=", "[`"].into_iter().find(|mark| shown.contains(mark));
        assert_eq!(rust, None, "{path}: {shown} is Rust");
    }
    assert!(values > 100, "only {values}");
    // Rust, and values of other fields, are refused.
    let line = |of: &str| &fields.iter().find(|(path, _)| path == of).expect("a field").1;
    for (field, value) in [
        ("plane.safety", "SafetyKind::Orca"),
        ("plane.safety", "\"orka\""),
        ("fault", "Vec::new()"),
        ("plane.lattice.algorithm", "4"),
        ("plane.max_acceleration_mps2", "f64::INFINITY"),
        ("grid.route.exit", "\"door\""),
    ] {
        assert!(refused(line(field), value).is_some(), "{field} = {value}");
    }
    for (field, value) in [("plane.safety", "\"orca\""), ("fault", "[]"), ("plane.max_acceleration_mps2", "inf")] {
        assert_eq!(line(field).default, Usual::Value(value.to_owned()), "{field}");
    }
}

#[test]
fn only_laws_that_can_stand_there_are_listed() {
    let mut fields = Vec::new();
    paths(ScenarioFile::lines(), "", &mut fields);
    for (law, _) in laws().iter().filter(|(law, _)| *law != "convoy") {
        for (place, site) in
            [("grid", Site::Cells), ("plane", Site::PlaneOverCells), ("plane.group", Site::PlaneOverCells)]
        {
            let setup = LawSetup::by_name(law, Moves::EIGHT, Some(1.0)).expect("a law");
            let is_listed = fields.iter().any(|(path, _)| *path == format!("{place}.{law}"));
            let has_rows = fields.iter().any(|(path, _)| path.ends_with(&format!(".{law}")));
            assert_eq!(is_listed, has_rows && setup.fits(site), "{place}.{law}");
        }
    }
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

#[test]
fn the_range_of_bodies_is_that_of_the_parameter() {
    let mut fields = Vec::new();
    paths(ScenarioFile::lines(), "", &mut fields);
    let parameter = parameters().into_iter().find(|row| row.name == "radius_m").expect("a parameter");
    for field in ["plane.radius_m", "plane.group.radius_m", "plane.intruder.radius_m"] {
        let (_, line) = fields.iter().find(|(path, _)| path == field).unwrap_or_else(|| panic!("no {field}"));
        assert_eq!(line.limits, Some(Limits::new(0.001..=65.0, "metres")));
        assert_eq!(line.limits, Some(Limits::of(parameter)));
    }
}
