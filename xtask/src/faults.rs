//! Firmware that goes wrong says why over its line, and starts anew with its count of starts kept.

use crate::device::Toolchains;
use crate::emulate;
use crate::firmware::{self, Profile};
use crate::part::{PARTS, Part};
use crate::repo::Repo;
use crate::report::Report;

/// The program.
const BIN: &str = "faults";

/// One step per part.
pub fn run(repo: &Repo, report: &mut Report, toolchains: &mut Toolchains) {
    run_on(repo, report, toolchains, &PARTS.each_ref());
}

/// The command: these parts, or all if none is named.
pub fn run_command(repo: &Repo, report: &mut Report, parts: &[&Part]) {
    let all = PARTS.each_ref();
    let parts = if parts.is_empty() { &all } else { parts };
    run_on(repo, report, &mut Toolchains::default(), parts);
}

fn run_on(repo: &Repo, report: &mut Report, toolchains: &mut Toolchains, parts: &[&Part]) {
    for part in parts {
        let name = format!("faults on the {}", part.name);
        if !firmware::build_some(repo, report, toolchains, part, Profile::Firmware, &[BIN]) {
            report.skip(&name, "there is no firmware");
            continue;
        }
        match emulate::prepare(repo, part) {
            Err(reason) => report.skip(&name, &reason),
            Ok(()) => {
                report.step(&name, || {
                    let elf = Profile::Firmware.elf(repo, part, BIN);
                    // The program ends with 0 only at its third start.
                    let said = emulate::run_on_line(repo, part, &elf, "stdio")?;
                    misses(part, &said).map_or(Ok(()), |text| Err(format!("nothing of `{text}`")))
                });
            }
        }
    }
}

/// The first thing that should have been said in this order and was not.
fn misses(part: &Part, said: &str) -> Option<String> {
    let expected = [
        String::from("faults.rs:"),
        format!(": on purpose on {}", part.name),
        String::from("exception of the processor at 0x"),
    ];
    let mut rest = said;
    for text in expected {
        match rest.split_once(text.as_str()) {
            Some((_, after)) => rest = after,
            None => return Some(text),
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_or_in_another_order_is_told() {
        let part = &PARTS[0];
        let panic = "\0..faults.rs:20: on purpose on stm32f405..\0";
        let trap = "\0..exception of the processor at 0x08000b1a..\0";
        assert_eq!(misses(part, &format!("{panic}{trap}")), None);
        assert!(misses(part, panic).is_some_and(|text| text.starts_with("exception")));
        assert!(misses(part, &format!("{trap}{panic}")).is_some());
        assert!(misses(&PARTS[1], &format!("{panic}{trap}")).is_some());
    }
}
