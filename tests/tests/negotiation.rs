//! Robots that negotiate in the simulator.

use staya_sim::scenario::{Overrides, Scenario};
use staya_tests::{root, run, scenario};

#[test]
fn robots_pass_each_other_in_a_corridor_at_any_loss() {
    for loss in [0.0, 0.1, 0.3, 0.6] {
        for seed in 1..=5 {
            let mut scenario = scenario("corridor", None);
            scenario.seed = seed;
            scenario.radio.loss = loss;
            let (outcome, _) = run(&scenario);
            assert_eq!((outcome.arrived, outcome.collisions), (4, 0), "seed {seed}, loss {loss}");
        }
    }
}

#[test]
fn a_crowd_arrives_sooner_by_negotiation_than_by_routes() {
    let file = root().join("scenarios/moving-ai-20.toml");
    let text = std::fs::read_to_string(&file).unwrap().replace("count = 20", "count = 60");
    for seed in 4..=6 {
        let run = |law: &str| {
            let overrides = Overrides { seed: Some(seed), ticks: None };
            run(&Scenario::parse(&format!("{text}{law}"), &file, &overrides).unwrap()).0
        };
        let (by_routes, negotiated) = (run(""), run("[law]\nname = \"negotiation\"\n"));
        assert_eq!((negotiated.arrived, negotiated.collisions), (60, 0), "seed {seed}");
        assert!(negotiated.ticks < by_routes.ticks, "seed {seed}: {} and {}", negotiated.ticks, by_routes.ticks);
    }
}
