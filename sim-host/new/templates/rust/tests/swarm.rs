//! The law in the simulator. Every robot runs it with its own safety layer, and knows others only
//! by radio.

use my_swarm::MyLaw;
use staya_sim::engine::simulate_own;
use staya_sim::scenario::{Overrides, Scenario};
use std::{ops::ControlFlow, path::Path};

#[test]
fn all_arrive_and_none_overlap() {
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/scenario.toml"));
    for seed in 1..=3 {
        let overrides = Overrides { seed: Some(seed), ..Overrides::default() };
        let scenario = Scenario::load(file, &overrides).unwrap_or_else(|error| panic!("{error}"));
        let law = |_robot| MyLaw::new(0.5, 0.02, 0.6);
        let outcome = simulate_own(&scenario, law, |_, _| ControlFlow::Continue(())).expect("a scenario with [plane]");
        assert_eq!(outcome.arrived, scenario.robots.len(), "seed {seed}: arrived after {} s", outcome.seconds);
        assert_eq!(outcome.collisions, 0, "seed {seed}: bodies overlap");
    }
}
