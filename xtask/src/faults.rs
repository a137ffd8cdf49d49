//! Firmware that goes wrong says why over its line, and starts anew with its count of starts kept.

use crate::device::Toolchains;
use crate::emulate;
use crate::firmware::{self, PARTS, Part, Profile};
use crate::repo::Repo;
use crate::report::Report;

/// One step per part.
pub fn run(repo: &Repo, report: &mut Report, toolchains: &mut Toolchains) {
    for part in &PARTS {
        let name = format!("faults on the {}", part.name);
        if !firmware::build_step(repo, report, toolchains, part, Profile::Firmware) {
            report.skip(&name, "there is no firmware");
            continue;
        }
        match emulate::prepare(repo, part) {
            Err(reason) => report.skip(&name, &reason),
            Ok(()) => {
                report.step(&name, || {
                    let elf = Profile::Firmware.elf(repo, part, "faults");
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
