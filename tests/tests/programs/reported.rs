//! Cases from reports by users. The table of `tests/cases/README.md` has the source and the right
//! value of each; `cargo xtask clients` and the tests of the Python package run those of `clients`
//! and `python`.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

const KINDS: [&str; 3] = ["maps", "scenes", "cli"];

/// A row of the table: the file of the case, and the code in its last cell.
struct Case<'a> {
    file: &'a str,
    right: Vec<&'a str>,
}

/// The cases of [`KINDS`]. A row without a file continues the one before.
fn cases(table: &str) -> Vec<Case<'_>> {
    let mut cases = Vec::<Case<'_>>::new();
    for line in table.lines().filter_map(|line| line.strip_prefix('|')?.strip_suffix('|')) {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let [file, .., right] = &cells[..] else { continue };
        let right = right.split('`').skip(1).step_by(2);
        match cases.last_mut() {
            Some(last) if file.is_empty() => last.right.extend(right),
            _ => cases.push(Case { file: file.split(',').next().unwrap_or_default(), right: right.collect() }),
        }
    }
    let is_here = |file: &str| KINDS.iter().any(|kind| file.split_once('/').is_some_and(|(start, _)| start == *kind));
    cases.retain(|case| is_here(case.file));
    cases
}

/// The value at a path such as `arrivals.0.reason`.
fn at<'v>(json: &'v Value, path: &str) -> &'v Value {
    path.split('.').fold(json, |value, step| match step.parse::<usize>() {
        Ok(index) => &value[index],
        Err(_) => &value[step],
    })
}

/// Whether a condition such as `arrived = 2` or `collisions <= 0` holds.
fn holds(json: &Value, condition: &str) -> bool {
    let (path, sign, wanted) = ["<=", ">=", "="]
        .iter()
        .find_map(|sign| condition.split_once(sign).map(|(path, wanted)| (path.trim(), *sign, wanted.trim())))
        .unwrap_or_else(|| panic!("{condition}: write FIELD = VALUE, <= or >="));
    let value = at(json, path);
    match (value.as_f64(), wanted.parse::<f64>()) {
        (Some(value), Ok(wanted)) => match sign {
            "<=" => value <= wanted,
            ">=" => value >= wanted,
            _ => (value - wanted).abs() < 5e-5,
        },
        _ => sign == "=" && value.as_str() == Some(wanted),
    }
}

/// The fault in the answer to a case.
fn fault(folder: &Path, case: &Case<'_>) -> Option<String> {
    let out = tempfile::tempdir().expect("temporary folder");
    let mut command = Command::new(staya_tests::program());
    if Path::new(case.file).extension().is_some_and(|end| end == "toml") {
        command.args(["run", case.file, "--json", "--quiet", "--out"]).arg(out.path().join("out"));
    } else {
        command.args(["terrain", "metrics", case.file, "--json"]);
    }
    let output = command.current_dir(folder).stdin(Stdio::null()).output().expect("staya starts");
    let (stdout, stderr) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    if let [refusal] = case.right[..]
        && let Some(refusal) = refusal.strip_prefix("refused: ")
    {
        let is_refused = output.status.code() == Some(1) && stderr.contains(refusal);
        return (!is_refused).then(|| format!("not refused with {refusal:?}: {stderr}{stdout}"));
    }
    if !output.status.success() {
        return Some(stderr.into_owned());
    }
    let json: Value = serde_json::from_str(&stdout).expect("one JSON object");
    let wrong = case.right.iter().flat_map(|right| right.split(',')).find(|condition| !holds(&json, condition))?;
    Some(format!("{wrong} does not hold: {json:#}"))
}

#[test]
fn reported_cases_have_the_right_values() {
    let folder = staya_tests::root().join("tests/cases");
    let table = fs::read_to_string(folder.join("README.md")).expect("the table");
    let cases = cases(&table);
    assert!(cases.len() >= 30, "{} cases", cases.len());
    let faults = cases.iter().filter_map(|case| {
        assert!(!case.right.is_empty(), "{}: write its right value as `FIELD = VALUE` or `refused: TEXT`", case.file);
        Some(format!("{}: {}\n", case.file, fault(&folder, case)?))
    });
    let faults: String = faults.collect();
    assert!(faults.is_empty(), "{faults}");
}

/// A file belongs to a case if the table or another file of the folder names it.
#[test]
fn every_file_belongs_to_a_reported_case() {
    let folder = staya_tests::root().join("tests/cases");
    let table = fs::read_to_string(folder.join("README.md")).expect("the table");
    for kind in KINDS {
        let files: Vec<_> = fs::read_dir(folder.join(kind)).expect(kind).flatten().map(|file| file.path()).collect();
        let texts: Vec<String> = files.iter().filter_map(|file| fs::read_to_string(file).ok()).collect();
        for file in &files {
            let name = file.file_name().and_then(|name| name.to_str()).expect("a plain name");
            let is_named = table.contains(&format!("{kind}/{name}")) || texts.iter().any(|text| text.contains(name));
            assert!(is_named, "{kind}/{name}");
        }
    }
}

/// Pandas and spreadsheets do not read the columns of hashes as numbers (`606634e5`, `00012345`).
#[test]
fn hashes_in_rows_are_not_numbers() {
    let out = tempfile::tempdir().expect("temporary folder");
    let mut command = Command::new(staya_tests::program());
    command.args(["sweep", "cli/hashes.toml", "--quiet", "--out"]).arg(out.path().join("out"));
    let output = command.current_dir(staya_tests::root().join("tests/cases")).output().expect("staya starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let rows = fs::read_to_string(out.path().join("out/rows.csv")).expect("rows.csv");
    let mut lines = rows.lines();
    let names: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let columns = ["trace_hash", "plan", "crc32"].map(|name| names.iter().position(|known| *known == name));
    let mut digits = 0;
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        for column in columns {
            let cell = cells[column.expect("a column of hashes")];
            let hash = cell.strip_prefix('h').unwrap_or_else(|| panic!("{line}: {cell}"));
            assert!(matches!(hash.len(), 8 | 16) && hash.chars().all(|c| c.is_ascii_hexdigit()), "{line}: {cell}");
            digits += usize::from(hash.parse::<f64>().is_ok());
        }
    }
    assert!(digits > 0, "no hash would have been a number");
}
