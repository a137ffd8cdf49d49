//! The canned swarms on every target: the same hashes. And firmware that goes wrong on purpose.

use crate::device::{PARTS, Part, STM32F405};
use crate::emulate::{self, on_part};
use crate::firmware::{DEBUG, FIRMWARE, Profile};
use crate::prelude::*;
use regex::Regex;

/// The golden rows: `case number commands bytes digest steps` in each line. The tests on the host
/// compare it too, and write it.
pub const TABLE: &str = "tests/golden/cases.txt";
/// Steps of one agent in the worst company, with more neighbours than the small part has room for.
const WORST: &str = "worst_";

/// Host in release (in debug the golden test does it), then the parts.
pub fn run(s: &mut Session) {
    s.report.step("canned swarms on the host, release", || {
        let mut host = s.repo.cargo("run --quiet --locked --release --package staya-cases --example hashes");
        let mut output = String::new();
        run_reading(&mut host, |row| output += &format!("{row}\n"))?;
        compare(&s.repo, &output, |_| true)
    });
    for part in &PARTS {
        replay(s, part, FIRMWARE, &[]);
    }
    // Without optimisation an operation too many or too few would show.
    replay(s, STM32F405, DEBUG, &[]);
}

/// The programs that tests on emulated parts need, for these parts: devices in lockstep, canned
/// swarms.
pub fn run_short(s: &mut Session, parts: &[Part]) {
    for part in parts {
        replay(s, part, FIRMWARE, &["lockstep", "replay", "replay_rest"]);
    }
}

/// The programs of `bins` (all if it names none), then the canned swarms.
fn replay(s: &mut Session, part: &Part, profile: &Profile, bins: &[&str]) {
    let name = format!("canned swarms on the {}{}", part.name, profile.suffix);
    on_part(s, &name, part, (profile, bins), |repo| {
        let run = |bin| emulate::run(repo, part, &profile.elf(repo, part, bin), "none", &[]);
        let mut output = run("replay")?;
        if is_small(part) {
            output += &run("replay_rest")?;
        }
        compare(repo, &output, |row| is_for(part, row))
    });
}

/// Firmware that goes wrong says why over its line, and starts again with its count of starts kept;
/// on these parts.
pub fn faults(s: &mut Session, parts: impl IntoIterator<Item = &'static Part>) {
    for part in parts {
        on_part(s, &format!("faults on the {}", part.name), part, (FIRMWARE, &["faults"]), |repo| {
            // The program ends with 0 only at its third start.
            let said = emulate::run(repo, part, &FIRMWARE.elf(repo, part, "faults"), "stdio", &[])?;
            ensure!(is_told(part, &said), "what went wrong is not said: {said}");
            Ok(())
        });
    }
}

/// Whether the program said what went wrong: first a panic, then an exception.
fn is_told(part: &Part, said: &str) -> bool {
    let places = [r"faults\.rs:", &format!(": on purpose on {}", part.name), "exception of the processor at 0x"];
    Regex::new(&format!("(?s){}", places.join(".*"))).is_ok_and(|places| places.is_match(said))
}

/// The swarm whose agents do not fit the RAM of the small part.
const LARGE: &str = "negotiation";

/// Without FPU, and with little flash: it computes in fixed point only, and the swarms are in two
/// programs.
fn is_small(part: &Part) -> bool {
    part.name == "nrf51"
}

/// Whether a row of the table is for a part.
fn is_for(part: &Part, row: &str) -> bool {
    let mut words = row.split(' ');
    let (case, number) = (words.next().unwrap_or(""), words.next());
    !is_small(part) || number == Some("Q16") && !case.starts_with(WORST) && case != LARGE
}

/// Compares with the rows of the table that `wanted` names, in order.
fn compare(repo: &Repo, output: &str, wanted: impl Fn(&str) -> bool) -> Result<()> {
    let table = files::read(&repo.root.join(TABLE))?;
    let wanted: Vec<&str> = table.lines().filter(|row| wanted(row)).collect();
    println!("{} rows", wanted.len());
    none_of(&differences(&wanted, &output.lines().collect::<Vec<_>>()), "rows differ")
}

fn differences(wanted: &[&str], got: &[&str]) -> Vec<String> {
    let row = |table: &[&str], at: usize| table.get(at).copied().unwrap_or("(none)").to_string();
    let rows = (0..wanted.len().max(got.len())).map(|at| (row(wanted, at), row(got, at)));
    rows.filter(|(wanted, got)| wanted != got).map(|(wanted, got)| format!("wanted {wanted}, got {got}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_that_differs_or_is_missing_is_reported() {
        let table = ["a f32 1 2", "b f32 3 4"];
        assert!(differences(&table, &table).is_empty());
        let got = differences(&table, &["a f32 1 2", "b f32 9 4"]);
        assert_eq!(got, ["wanted b f32 3 4, got b f32 9 4"]);
        assert_eq!(differences(&table, &table[..1]).len(), 1);
        assert_eq!(differences(&table[..1], &table).len(), 1);
    }

    #[test]
    fn the_small_part_computes_in_fixed_point_only() {
        let [large, small] = [STM32F405, &PARTS[1]];
        for (row, is_small) in [
            ("route f32 0 1", false),
            ("route Q16 0 1", true),
            ("orca_template_2k Q16 0 1", true),
            ("worst_route Q16 0 1", false),
            ("negotiation Q16 0 1", false),
        ] {
            assert!(is_for(large, row));
            assert_eq!(is_for(small, row), is_small, "{row}");
        }
    }

    #[test]
    fn missing_and_reordered_lines_are_reported() {
        let part = &PARTS[0];
        let panic = "\0..faults.rs:20: on purpose on stm32f405..\0";
        let trap = "\0..exception of the processor at 0x08000b1a..\0";
        assert!(is_told(part, &format!("{panic}{trap}")));
        assert!(!is_told(part, panic) && !is_told(part, &format!("{trap}{panic}")));
        assert!(!is_told(&PARTS[1], &format!("{panic}{trap}")));
    }
}
