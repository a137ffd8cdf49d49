//! Robots that negotiate in the simulator.

use staya_tests::{run, scenario};

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
