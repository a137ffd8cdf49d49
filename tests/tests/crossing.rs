//! Golden tables of swaps and doorways, as the commands print them.

use staya_controller::agent::SafetyKind;
use staya_papers::crossing::{Conditions, doorway, swap};
use staya_papers::experiment::Experiment as _;
use staya_tests::golden;

#[test]
fn golden_swap() {
    let plan = swap::Plan { robots: vec![2, 3, 4, 8, 12, 16, 24, 32], ..swap::Plan::default() };
    golden("swap", &plan.measure().expect("a sound plan").to_string());
}

#[test]
fn golden_swap_by_template_with_noise_and_losses() {
    let plan = swap::Plan {
        robots: vec![6, 12],
        noise_m: 0.05,
        seeds: 3,
        conditions: Conditions { safety: SafetyKind::Template2k, loss: 0.1, ..Conditions::default() },
        ..swap::Plan::default()
    };
    golden("swap-template", &plan.measure().expect("a sound plan").to_string());
}

#[test]
fn golden_doorway() {
    let plan = doorway::Plan { widths_m: vec![0.8, 1.3], robots: 6, ..doorway::Plan::default() };
    golden("doorway-experiment", &plan.measure().expect("a sound plan").to_string());
}
