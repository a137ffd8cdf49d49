//! Pages with tables of laws, layers and their values, which come from the controller's tables; and
//! a search for copies of these elsewhere.

use staya_controller::agent::{LayerSettings, Motion};
use staya_controller::negotiation::Moves;
use staya_lab::claims;
use staya_lab::figure::{self, Figure};
use staya_sim::scenario::{LawSetup, Line, Read as _, ScenarioFile, Usual, laws, parameters};
use staya_tests::{END, printed_part, root};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// The tables of laws and layers in a table of scenario files, with their rows.
fn tables(place: &str) -> Vec<Line> {
    let place = ScenarioFile::lines().into_iter().find(|line| line.name == place).expect("a table");
    let is_named = |name: &str| LayerSettings::ALL.iter().chain(&laws()).any(|(known, _)| *known == name);
    place.inner.into_iter().filter(|line| is_named(line.name) && !line.inner.is_empty()).collect()
}

/// All of them, each once.
fn all_tables() -> Vec<Line> {
    let (on_grid, mut all) = (tables("grid"), tables("plane"));
    let missing = on_grid.into_iter().filter(|line| all.iter().all(|other| other.name != line.name));
    let missing: Vec<_> = missing.collect();
    all.extend(missing);
    all
}

/// Appends a line, wrapped at 100 columns.
fn wrap(text: &mut String, entry: &str) {
    let mut line = String::new();
    for word in entry.split(' ') {
        if line.len() + 1 + word.len() > 100 {
            let _ = writeln!(text, "{line}");
            line = String::from(" ");
        }
        let space = if line.is_empty() { "" } else { " " };
        line = format!("{line}{space}{word}");
    }
    let _ = writeln!(text, "{line}");
}

/// The rows of a table that another one of the page does not have.
fn table(line: &Line, others: &[Line]) -> String {
    let mut text = format!("**`{}`**\n\n", line.name);
    let known = |row: &Line| {
        let is_same = |other: &Line| other.name == row.name && other.default == row.default && other.doc == row.doc;
        others.iter().flat_map(|table| &table.inner).any(is_same)
    };
    for row in line.inner.iter().filter(|row| !known(row)) {
        let words: String = row.words.iter().map(|word| format!(", \"{word}\"")).collect();
        let default = match &row.default {
            Usual::None => String::new(),
            default => format!(" ({default})"),
        };
        wrap(&mut text, &format!("- `{}`{default}: {}{words}", row.name, row.doc.trim_end_matches('.')));
    }
    text
}

#[test]
fn golden_tables_of_laws_and_layers_in_the_page_of_scenarios() {
    let all = all_tables();
    let of = |names: &[&str], but: &[&str]| {
        let find = |name: &&str| all.iter().find(|line| line.name == *name).expect("a table");
        let others: Vec<Line> = all_tables().into_iter().filter(|line| but.contains(&line.name)).collect();
        names.iter().map(|name| table(find(name), &others)).collect::<Vec<_>>().join("\n")
    };
    let variants: &[&str] = &["formation_paper", "formation_lookahead"];
    let (route, formation): (&[_], &[_]) = (&["route"], &["route", "formation"]);
    let is_other =
        |name: &&str| !variants.contains(name) && !formation.contains(name) && !["orca", "push_out"].contains(name);
    let others: Vec<&str> = all.iter().map(|line| line.name).filter(is_other).collect();
    let texts = [of(route, &[]), of(&["formation"], route), of(variants, formation), of(&others, &[])];
    printed_part("scenarios/README.md", "laws", &texts.join("\n"));
    printed_part("scenarios/README.md", "layers", &of(&["orca", "push_out"], &[]));
}

#[test]
fn golden_list_of_laws_in_the_page_of_projects() {
    let mut text = String::new();
    for (name, what) in laws() {
        let law = LawSetup::by_name(name, Moves::EIGHT, Some(1.0)).expect("a law");
        let place = match (law.motion(), &law) {
            (Motion::Velocities, _) => "plane, space",
            (Motion::Cells, LawSetup::Published(_) | LawSetup::Lookahead(_)) => "grid",
            (Motion::Cells, _) => "grid, plane with land",
        };
        wrap(&mut text, &format!("- `{name}` ({place}): {what}"));
    }
    printed_part("docs/project.md", "laws", &text);
}

#[test]
fn golden_list_of_layers_in_the_page_of_projects() {
    let mut text = String::new();
    for (name, what) in LayerSettings::ALL {
        wrap(&mut text, &format!("- `{name}`: {what}"));
    }
    printed_part("docs/project.md", "layers", &text);
}

/// Papers with a table of claims in docs/results.md.
const PAPERS: [&str; 6] = ["kuz", "pav", "olf", "fvm", "sta", "staya/leaders"];

#[test]
fn golden_claims_of_papers_in_the_page_of_results() {
    let all = figure::all().expect("figures");
    for paper in PAPERS {
        let of_paper = |figure: &&Figure| format!("{}/", figure.place).starts_with(&format!("{paper}/"));
        let figures: Vec<_> = all.iter().filter(of_paper).cloned().collect();
        let table = claims::table(&figures).unwrap_or_else(|error| panic!("{error}"));
        printed_part("docs/results.md", &format!("claims of {}", paper.to_uppercase()), &table);
    }
}

/// Files that mention rows in prose or read them.
fn readers() -> Vec<PathBuf> {
    let mut all: Vec<PathBuf> =
        ["README.md", "ARCHITECTURE.md", "controller/c/include/staya.h"].map(|file| root().join(file)).into();
    let mut folders = ["docs", "scenarios", "sim-host/python/python/staya", "sim-host/sim/src/scenario"]
        .map(|name| root().join(name))
        .to_vec();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
            let path = entry.expect("an entry").path();
            let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
            // The page of laws has the table of its own law.
            let is_left_out = matches!(name, "tests" | "tests.rs" | "__pycache__" | "settings.py" | "laws.md");
            let ends = ["md", "rs", "py", "pyi"];
            if path.is_dir() && !is_left_out {
                folders.push(path);
            } else if !is_left_out
                && path.extension().and_then(|end| end.to_str()).is_some_and(|end| ends.contains(&end))
            {
                all.push(path);
            }
        }
    }
    all
}

/// The text without the parts that are printed.
fn by_hand(text: &str) -> String {
    let mut rest = text;
    let mut kept = String::new();
    while let Some((before, after)) = rest.split_once(": written by cargo xtask bless -->") {
        kept += before;
        rest = after.split_once(END).map_or("", |(_, after)| after);
    }
    kept + rest
}

/// Names, and numbers with their neighbours, of a text.
fn words(text: &str) -> Vec<String> {
    let text = text.replace("..=", " to ").replace('=', " = ");
    let is_inner = |c: char| c.is_alphanumeric() || "_.-=".contains(c);
    // Thousands have commas.
    let parts = text.split_whitespace().map(|word| {
        let joined: Vec<char> = word.chars().collect();
        let comma = |at: usize| {
            let digits = |range: std::ops::Range<usize>| {
                joined.get(range).is_some_and(|part| part.iter().all(char::is_ascii_digit))
            };
            joined[at] == ',' && at > 0 && digits(at - 1..at) && digits(at + 1..at + 4)
        };
        (0..joined.len()).filter(|at| !comma(*at)).map(|at| joined[at]).collect::<String>()
    });
    let names = parts.flat_map(|word| {
        let split: Vec<String> =
            word.split(|c| !is_inner(c)).map(|name| name.trim_end_matches('.').to_owned()).collect();
        split
    });
    names.filter(|name| !name.is_empty()).collect()
}

/// Whether a row is in a table of the controller or of a law; other fields have their ranges where
/// they are read.
fn is_parameter(name: &str) -> bool {
    let of_law = |law: &str| {
        let mut found = false;
        if let Some(mut law) = LawSetup::by_name(law, Moves::EIGHT, Some(1.0)) {
            law.tables(&mut |table| found |= table.index(name).is_some());
        }
        found
    };
    parameters().iter().any(|row| row.name == name) || laws().iter().any(|(law, _)| of_law(law))
}

/// Words after a name in which its range or default would be a copy.
const NEAR: usize = 14;

/// Copies of ranges and defaults of rows in a text; `is_code`: also after `=`.
fn copies(text: &str, tables: &[Line], is_code: bool) -> Vec<String> {
    let words = words(&by_hand(text));
    let number = |at: usize| words.get(at).and_then(|word| word.parse::<f64>().ok());
    let mut found = Vec::new();
    for row in tables.iter().flat_map(|table| &table.inner).filter(|row| is_parameter(row.name)) {
        let ends = row.limits.as_ref().map(|limits| limits.ends());
        let usual = match &row.default {
            Usual::Value(value) => value.parse::<f64>().ok(),
            _ => None,
        };
        for at in
            (0..words.len()).filter(|at| words[*at] == row.name || words[*at].ends_with(&format!(".{}", row.name)))
        {
            for next in at + 1..=at + NEAR {
                let second = if words.get(next + 1).is_some_and(|word| word == "to") { next + 2 } else { next + 1 };
                if ends.is_some() && number(next).zip(number(second)) == ends {
                    found.push(format!("{}: {:?}", row.name, &words[at..=second]));
                }
                let says = words
                    .get(next)
                    .is_some_and(|word| word.starts_with("default") || is_code && next <= at + 3 && word == "=");
                if says && usual.is_some() && number(next + 1) == usual {
                    found.push(format!("{}: {:?}", row.name, &words[at..=next + 1]));
                }
            }
        }
    }
    found.sort();
    found.dedup();
    found
}

/// Fields of other tables with the name of a row, and the same range or default.
const OTHERS: [(&str, &str); 2] = [("sim-host/sim/src/scenario/schema.rs", "share"), ("scenarios/README.md", "share")];

fn is_code(path: &Path) -> bool {
    path.extension().is_none_or(|end| end != "md")
}

#[test]
fn no_range_and_no_default_of_a_row_stands_a_second_time() {
    let tables = all_tables();
    let (mut searched, mut wrong) = (0, Vec::new());
    for path in readers() {
        let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let name = path.strip_prefix(root()).unwrap_or(&path).display().to_string();
        let found = copies(&text, &tables, is_code(&path));
        // A copy that is planted there is found.
        let planted = format!("{text}\n`wall_horizon_s` is the look-ahead for obstacles, 0.01 to 60 s.\n");
        assert!(copies(&planted, &tables, is_code(&path)).len() > found.len(), "{name}: the search finds nothing");
        let is_other =
            |copy: &&String| OTHERS.iter().any(|(file, row)| *file == name && copy.starts_with(&format!("{row}: ")));
        wrong.extend(found.iter().filter(|copy| !is_other(copy)).map(|copy| format!("{name}: {copy}")));
        searched += 1;
    }
    assert!(wrong.is_empty(), "these have what a table has: {wrong:#?}");
    assert!(searched > 60, "only {searched} files");
}

#[test]
fn copies_of_each_kind_are_found() {
    let tables = all_tables();
    for (text, is_code) in [
        ("| `patience` | longest wait, 0 to 30,000 decisions | |", false),
        ("`plane.orca.horizon_s`: seconds, 0.01 to 60.", false),
        ("Keep `share` between 0 and 1, by default 0.5.", false),
        ("pub horizon_s: Option<f64>, 0.01..=60.0, \"seconds\";", true),
        ("    wall_horizon_s: float = 1.0,", true),
        ("/** `spacing_m`: distance, metres, 0.01 to 100. */ float spacing_m;", true),
        ("_check.number(\"share\", share, 0.0, 1.0)", true),
    ] {
        assert!(!copies(text, &tables, is_code).is_empty(), "{text}");
    }
    for text in [
        "`horizon_s` of 0.5 to 2 s suits crowds.",
        "`plane.orca.wall_horizon_s = 1` in 1.",
        "<!-- laws: written by cargo xtask bless -->\n`horizon_s`, 0.01 to 60 s\n<!-- end -->\n",
    ] {
        assert_eq!(copies(text, &tables, false), Vec::<String>::new(), "{text}");
    }
}
