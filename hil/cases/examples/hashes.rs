//! Prints `case scalar hash steps` for each case and scalar: the table that every target must give.

use staya_cases::{Case, Unmeasured, Worst};
use staya_controller::scalar::{Q16, Scalar};

fn main() {
    print::<f32>("f32");
    print::<Q16>("Q16");
}

fn print<S: Scalar>(scalar: &str) {
    for case in Case::ALL {
        let summary = case.run::<S, _>(&mut Unmeasured);
        let (name, hash, steps) = (case.name(), summary.hash, summary.steps);
        println!("{name} {scalar} {hash:016x} {steps}");
    }
    for case in Worst::ALL {
        let summary = case.run::<S, _, 16, 32>(&mut Unmeasured);
        let (name, hash, steps) = (case.name(), summary.hash, summary.steps);
        println!("{name} {scalar} {hash:016x} {steps}");
    }
}
