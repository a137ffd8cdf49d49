//! The canned swarms on every target: the same hashes.

use crate::device::Toolchains;
use crate::emulate;
use crate::firmware::{self, Profile};
use crate::part::{PARTS, Part};
use crate::repo::{Repo, output_of, run as run_command, shown};
use crate::report::Report;
use std::fs;

/// What all must give: `case number hash steps` in each line. The tests on the host compare it too, and write it.
const TABLE: &str = "tests/golden/cases.txt";
/// Steps of one agent in the worst company, with more neighbours than the small part has room for.
const WORST: &str = "worst_";

/// Host in release (in debug the golden test does it), then the parts.
pub fn run(repo: &Repo, report: &mut Report, toolchains: &mut Toolchains) {
    report.step("canned swarms on the host, release", || {
        let example = ["--package", "staya-cases", "--example", "hashes"];
        let build = ["build", "--quiet", "--locked", "--release"];
        run_command(repo.cargo(&build).args(example))?;
        let mut host = repo.cargo(&["run", "--quiet", "--locked", "--release"]);
        host.args(example);
        println!("$ {}", shown(&host));
        let output = output_of(&mut host).ok_or("does not run")?;
        compare(repo, &output, |_| true)
    });
    for part in &PARTS {
        for profile in profiles(part) {
            on_part(repo, report, toolchains, part, *profile, &[]);
        }
    }
}

/// Programs that show on each part what matters most: devices in lockstep, canned swarms; and, on the part that has room for all
/// of the controller, that no panic is reachable.
pub fn run_short(repo: &Repo, report: &mut Report, toolchains: &mut Toolchains) {
    for part in &PARTS {
        let bins: &[&str] = match part.name {
            "stm32f405" => &["lockstep", "replay", "nopanic"],
            _ => &["lockstep", "replay"],
        };
        on_part(repo, report, toolchains, part, Profile::Firmware, bins);
    }
}

/// The part with an FPU also without optimisation: there an operation too many or too few would show.
fn profiles(part: &Part) -> &'static [Profile] {
    match part.name {
        "stm32f405" => &[Profile::Firmware, Profile::Debug],
        _ => &[Profile::Firmware],
    }
}

/// The programs of `bins` (all if it names none), then the canned swarms.
fn on_part(
    repo: &Repo,
    report: &mut Report,
    toolchains: &mut Toolchains,
    part: &Part,
    profile: Profile,
    bins: &[&str],
) {
    let name = match profile {
        Profile::Firmware => format!("canned swarms on the {}", part.name),
        Profile::Debug => format!("canned swarms on the {}, debug", part.name),
    };
    if !firmware::build_some(repo, report, toolchains, part, profile, bins) {
        return report.skip(&name, "there is no firmware");
    }
    match emulate::prepare(repo, part) {
        Err(reason) => report.skip(&name, &reason),
        Ok(()) => {
            report.step(&name, || {
                let output = emulate::run(repo, part, &profile.elf(repo, part, "replay"))?;
                compare(repo, &output, |row| is_for(part, row))
            });
        }
    }
}

/// Whether a row of the table is for a part: the one without FPU and with little flash computes in fixed point only.
fn is_for(part: &Part, row: &str) -> bool {
    let mut words = row.split(' ');
    let (case, number) = (words.next().unwrap_or(""), words.next());
    let is_small = number == Some("Q16") && !case.starts_with(WORST);
    part.name != "nrf51" || is_small
}

/// Compares with the rows of the table that `wanted` names, in order.
fn compare(repo: &Repo, output: &str, wanted: impl Fn(&str) -> bool) -> Result<(), String> {
    let table = fs::read_to_string(repo.root.join(TABLE)).map_err(|e| format!("{TABLE}: {e}"))?;
    let wanted: Vec<&str> = table.lines().filter(|row| wanted(row)).collect();
    let faults = differences(&wanted, &output.lines().collect::<Vec<_>>());
    println!("{} rows, {} differ", wanted.len(), faults.len());
    match faults.first() {
        None => Ok(()),
        Some(first) => {
            for fault in &faults {
                println!("{fault}");
            }
            Err(format!("{} rows differ, first: {first}", faults.len()))
        }
    }
}

fn differences(wanted: &[&str], got: &[&str]) -> Vec<String> {
    let rows = wanted.len().max(got.len());
    let row = |table: &[&str], at: usize| table.get(at).copied().unwrap_or("(none)").to_string();
    (0..rows)
        .map(|at| (row(wanted, at), row(got, at)))
        .filter(|(wanted, got)| wanted != got)
        .map(|(wanted, got)| format!("wanted {wanted}, got {got}"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::part::part;

    #[test]
    fn every_row_that_differs_or_is_missing_is_told() {
        let table = ["a f32 1 2", "b f32 3 4"];
        assert!(differences(&table, &table).is_empty());
        let got = differences(&table, &["a f32 1 2", "b f32 9 4"]);
        assert_eq!(got, ["wanted b f32 3 4, got b f32 9 4"]);
        assert_eq!(differences(&table, &table[..1]).len(), 1);
        assert_eq!(differences(&table[..1], &table).len(), 1);
    }

    #[test]
    fn the_small_part_computes_in_fixed_point_only() {
        let [large, small] = ["stm32f405", "nrf51"].map(|name| part(name).unwrap());
        for (row, is_small) in [
            ("route f32 0 1", false),
            ("route Q16 0 1", true),
            ("orca_template_2k Q16 0 1", true),
            ("worst_route Q16 0 1", false),
        ] {
            assert!(is_for(large, row));
            assert_eq!(is_for(small, row), is_small, "{row}");
        }
    }
}
