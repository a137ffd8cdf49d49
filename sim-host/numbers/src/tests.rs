use super::*;
use staya_sim::scenario::Overrides;
use std::ops::ControlFlow;
use std::path::Path;

fn shipped(name: &str, settings: &[(&str, &str)]) -> Scenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").join(name).with_extension("toml");
    let settings: Vec<_> =
        settings.iter().map(|(field, value)| format!("{field}={value}").parse().expect(field)).collect();
    Scenario::load_with(&path, &Overrides::default(), &settings).expect(name)
}

fn run(scenario: &Scenario) -> Result<Outcome, String> {
    simulate(scenario, &mut |_, _| ControlFlow::Continue(()))
}

#[test]
fn robots_outside_the_engine_decide_as_those_inside() {
    for name in ["six-robots", "six-discs", "swap-circle", "goal-flock", "boids"] {
        let scenario = shipped(name, &[("ticks", "40")]);
        let robots = OnHost::new(0..scenario.robots.len(), || robot(NumberFormat::F32), Box::new(|_| Vec::new()));
        let watch: &mut Watch<'_> = &mut |_, _| ControlFlow::Continue(());
        let outside = simulate_with(&scenario, Some(Box::new(robots)), watch).expect("free starts");
        assert_eq!(outside, run(&scenario).expect("free starts"), "{name}");
    }
}

#[test]
fn each_format_decides_otherwise_and_arrives() {
    let whole = |numbers: &str| run(&shipped("swap-circle", &[("numbers", numbers)])).expect("it suits");
    let [single, others @ ..] = ["f32", "fast32", "q16", "f64"].map(whole);
    for (other, numbers) in others.iter().zip(["fast32", "q16", "f64"]) {
        assert_ne!(other.trace_hash, single.trace_hash, "{numbers}");
        assert_eq!((other.arrived, other.collisions), (single.arrived, 0), "{numbers}");
    }
}

#[test]
fn on_the_grid_all_formats_decide_alike() {
    let whole =
        |numbers: &str| run(&shipped("six-robots", &[("numbers", numbers), ("ticks", "80")])).expect("it suits");
    let single = whole("f32");
    for numbers in ["fast32", "q16", "f64"] {
        assert_eq!(whole(numbers).trace_hash, single.trace_hash, "{numbers}");
    }
}

#[test]
fn what_is_not_available_is_refused_by_name() {
    for (name, settings, what) in [
        ("sensing-swap", &[][..], "plane.sensing is not available with numbers = \"q16\"; remove it"),
        ("swap-voxel", &[], "plane.orca.model is not available"),
        ("out-of-phase", &[], "[clocks] is not available"),
    ] {
        let settings = [settings, &[("numbers", "q16")]].concat();
        let error = run(&shipped(name, &settings)).expect_err(name);
        assert!(error.starts_with(what), "{name}: {error}");
    }
    let alone = simulate_with(&shipped("swap-circle", &[("numbers", "q16")]), None, &mut |_, _| ControlFlow::Break(()));
    let error = alone.expect_err("not in the engine").to_string();
    assert!(error.contains("`q16`") && error.contains("staya hil"), "{error}");
}
