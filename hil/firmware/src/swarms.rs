//! Canned swarms, of which a part with little flash runs some only.

use crate::runtime;
use staya_cases::{Case, Summary, Unmeasured};
use staya_controller::scalar::Q16;

/// Runs a swarm in fixed point, and prints its line.
// Inlined, so that a program contains only those swarms that it names.
#[inline(always)]
pub fn replay(case: Case) {
    print(case.name(), "Q16", &case.run::<Q16, _>(&mut Unmeasured));
}

/// Prints the line of a swarm in `tests/golden/cases.txt`.
pub fn print(name: &str, number: &str, summary: &Summary) {
    runtime::print(format_args!("{name} {number} {summary}\n"));
}
