use super::*;
use crate::measure::Measured;
use staya_sim::scenario::{Field, Source};

type Set<'a> = (&'a str, String);

fn read(scenario: &str, sets: &[Set<'_>], measures: &[&str], seed: u64) -> Result<Measured, String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../papers").join(scenario);
    let text = std::fs::read_to_string(&path).unwrap();
    let mut source = Source::new(&path, &text).unwrap();
    for (field, value) in sets {
        source.set(&Field::read(field).unwrap(), value).unwrap();
    }
    let measures: Vec<String> = measures.iter().map(ToString::to_string).collect();
    let given = Given { source, measures: &measures, seed };
    Flock.read(&given).map_err(|error| error.to_string())?(&|_| true)
}

fn sets<'a>(count: u32, ticks: u32, knows: &str) -> Vec<Set<'a>> {
    vec![
        ("plane.robots.cloud.count", count.to_string()),
        ("ticks", ticks.to_string()),
        ("study.knows", knows.to_owned()),
    ]
}

fn value(measured: &Measured, name: &str) -> f64 {
    measured.values[name].unwrap_or_else(|| panic!("{name}: {measured:?}"))
}

const ALL: [&str; 1] = ["flock.parts"];

#[test]
fn free_flock_forms_by_agents_and_by_the_law_alone_with_equal_energy() {
    let of = |knows| read("olf/flock/free.toml", &sets(30, 500, knows), &ALL, 1).unwrap();
    let [agents, law] = ["packets", "all"].map(of);
    for measured in [&agents, &law] {
        assert_eq!((value(measured, "flock.parts"), value(measured, "collisions")), (1.0, 0.0));
        assert!(value(measured, "flock.connected_from") < 250.0);
        assert!(value(measured, "flock.alpha_from") > value(measured, "flock.connected_from"));
        assert!(value(measured, "flock.deviation_energy") < 0.005);
    }
    // The law alone only loses energy. Lattices of equal energy may have different outlines.
    assert!(value(&law, "flock.hamiltonian_rise") < 1e-3);
    assert!((value(&agents, "flock.hamiltonian") / value(&law, "flock.hamiltonian") - 1.0).abs() < 0.01);
    assert_ne!(agents.trace_hash, law.trace_hash);
    assert_eq!(of("all").trace_hash, law.trace_hash);
}

#[test]
fn limits_of_the_law_alone_delay_the_flock() {
    let base = sets(30, 300, "all");
    let with = |field, value: &str| {
        read("olf/flock/free.toml", &[base.clone(), vec![(field, value.to_owned())]].concat(), &ALL, 1).unwrap()
    };
    let soon = value(&with("study.fastest_mps", "1e6"), "flock.connected_from");
    let slow = with("study.fastest_mps", "5.0").values["flock.connected_from"];
    assert!(slow.is_none_or(|late| late > soon + 50.0), "{soon} {slow:?}");
    assert_eq!(with("study.nearest", "0").values["flock.alpha_from"], None);
}

#[test]
fn without_a_reference_the_group_breaks_up() {
    let measured = read("olf/fragments/fragment.toml", &sets(40, 1000, "packets"), &ALL, 1).unwrap();
    assert!(value(&measured, "flock.parts") > 1.0 && value(&measured, "flock.connectivity") < 0.95);
}

#[test]
fn robots_meet_in_space_even_with_orca() {
    for safety in ["none", "fly"] {
        let sets = [sets(20, 1000, "packets"), vec![("plane.safety", safety.into())]].concat();
        let measured = read("olf/flock/rendezvous.toml", &sets, &ALL, 1).unwrap();
        assert_eq!((value(&measured, "flock.parts"), value(&measured, "collisions")), (1.0, 0.0), "{safety}");
    }
}

#[test]
fn resting_reference_gathers_a_flock_that_a_weak_fixed_one_leaves_apart() {
    let fixed = [
        ("plane.lattice.goal_moves", "false"),
        ("plane.robots.cloud.goals_m", "[[230, 60]]"),
        ("plane.robots.cloud.goal_velocity_mps", "[6, 0]"),
    ];
    let fixed = fixed.map(|(field, value)| (field, value.to_owned()));
    let at = |scenario, own: &[Set<'_>]| read(scenario, &[&sets(40, 4000, "all"), own].concat(), &ALL, 2).unwrap();
    let [apart, together] = [at("olf/courses/squeeze.toml", &fixed), at("olf/resting/squeeze.toml", &[])];
    assert!(value(&apart, "flock.parts") > 1.0);
    assert_eq!((value(&together, "flock.parts"), value(&together, "flock.past")), (1.0, 40.0));
    assert_eq!((value(&together, "flock.inside"), value(&apart, "flock.inside")), (0.0, 0.0));
}

/// The paper's order of gains, c1_alpha < c1_gamma < c1_beta.
#[test]
fn strong_fixed_reference_gathers_a_split_flock_without_overlap() {
    for scenario in ["olf/courses/split-static.toml", "olf/courses/squeeze-static.toml"] {
        let measured = read(scenario, &sets(24, 4000, "packets"), &ALL, 2).unwrap();
        let ends = ["flock.parts", "flock.past", "flock.inside", "collisions"].map(|name| value(&measured, name));
        assert_eq!(ends, [1.0, 24.0, 0.0, 0.0], "{scenario}");
    }
}

#[test]
fn rings_start_around_a_robot() {
    let rings = |rings: &str| {
        let sets = [sets(31, 200, "all"), vec![("study.rings.rings", rings.to_owned())]].concat();
        read("olf/ring/ring.toml", &sets, &ALL, 2)
    };
    let measured = rings("[2, 3]").unwrap();
    assert_eq!((value(&measured, "flock.parts"), value(&measured, "flock.crossings")), (2.0, 0.0));
    for wrong in ["[1, 3]", "[2, 2]"] {
        assert!(rings(wrong).unwrap_err().contains("study.rings"), "{wrong}");
    }
}

#[test]
fn goal_flock_gathers_and_arrives_by_agents_and_by_the_law_alone() {
    for knows in ["all", "packets"] {
        let of = |k2: i64| {
            let corner = |at: i64| format!("[{at}, {at}]");
            let own = vec![
                ("plane.goal_flock.k2", k2.to_string()),
                ("plane.robots.cloud.from_m", corner(-126)),
                ("plane.robots.cloud.to_m", corner(126)),
            ];
            let sets = [sets(40, 1300, knows), own].concat();
            read("pav/goals/scenario.toml", &sets, &["company.company"], 5).unwrap()
        };
        let [alone, group] = [of(0), of(50)];
        assert!(value(&group, "company.company") > value(&alone, "company.company") + 0.5, "{knows}");
        assert!(value(&group, "company.arrived") > 0.9 && value(&group, "company.gathered") == 1.0, "{knows}");
        assert!(value(&group, "company.half_gathered_s") > 40.0 && value(&group, "company.largest_share") < 0.9);
    }
}

#[test]
fn push_out_keeps_points_apart_with_exact_knowledge() {
    let sets = [
        sets(40, 900, "all"),
        vec![("plane.safety", "push_out".into()), ("plane.push_out.min_distance_m", "10".into())],
    ]
    .concat();
    let measured = read("pav/goals/scenario.toml", &sets, &["company.company"], 5).unwrap();
    assert_eq!(value(&measured, "collisions"), 0.0);
}

#[test]
fn starts_have_the_deviation_and_their_distance() {
    let mut rng = Rng::new(1);
    let drawn: Vec<f64> = (0..20_000).map(|_| normal(&mut rng, 3.0)).collect();
    let mean = drawn.iter().sum::<f64>() / 20_000.0;
    let variance = drawn.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 20_000.0;
    assert!(mean.abs() < 0.1 && (variance - 9.0).abs() < 0.3, "{mean} {variance}");
    let crowded = read("olf/flock/free.toml", &[("study.deviation_m", "[0.1, 0.1, 0.0]".into())], &ALL, 1);
    assert!(crowded.unwrap_err().contains("find no room"));
}

#[test]
fn other_laws_and_layers_have_no_exact_knowledge() {
    for (field, value) in [("plane.safety", "orca"), ("study.knows", "none")] {
        let error = read("pav/goals/scenario.toml", &[(field, value.into())], &ALL, 1).unwrap_err();
        assert!(error.contains("study.knows"), "{error}");
    }
}

#[test]
fn forests_and_goals_are_at_random_places_with_gaps() {
    let forest =
        Scattered { count: 30, radius_m: [2.0, 10.0], from_m: [135.0, -20.0], to_m: [230.0, 140.0], gap_m: 8.0 };
    for seed in 0..20 {
        let balls = forest.draw(30, Rng::new(seed)).unwrap();
        assert!(balls.iter().all(|(_, radius_m)| (2.0..10.0).contains(radius_m)));
        for (index, (center, radius)) in balls.iter().enumerate() {
            let gap = |other: &([f64; 3], f64)| distance_m(*center, other.0) - radius - other.1;
            assert!(balls[..index].iter().all(|other| gap(other) >= 8.0));
        }
    }
    assert_eq!(forest.draw(29, Rng::new(1)), None);
    let goals = "{ count = 2, from_m = [300, -400], to_m = [1100, 400], gap_m = 250 }";
    let of = |seed| {
        let sets = [sets(10, 900, "all"), vec![("study.goals", goals.to_owned())]].concat();
        read("pav/goals/scenario.toml", &sets, &["company.share_1", "company.share_2", "company.share_3"], seed)
            .unwrap()
    };
    let measured = of(3);
    assert_ne!(measured.trace_hash, of(4).trace_hash);
    assert!((value(&measured, "company.share_1") + value(&measured, "company.share_2") - 1.0).abs() < 1e-9);
    assert_eq!(measured.values["company.share_3"], None);
}

#[test]
fn operator_moves_a_goal_of_robots_with_exact_knowledge() {
    let order = "[{ at_s = 10, goal = 2, place_m = [300, 900] }]";
    let sets = [sets(12, 1500, "all"), vec![("plane.order", order.to_owned())]].concat();
    let of = |sets: &[_]| read("pav/goals/scenario.toml", sets, &["company.share_3"], 5).unwrap();
    let [moved, unmoved] = [of(&sets), of(&sets[..3])];
    assert_ne!(moved.trace_hash, unmoved.trace_hash);
    assert!(value(&moved, "company.arrived") > 0.5, "{moved:?}");
}

#[test]
fn groups_start_in_squares_that_face_each_other() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../papers/staya/closing/alpha-nine.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let given = Given { source: Source::new(&path, &text).unwrap(), measures: &[], seed: 2 };
    let run = Run::read(&given, given.parameters().unwrap()).unwrap();
    let starts = &run.scenario.plane().unwrap().starts;
    for (west, east) in starts[..9].iter().zip(&starts[9..]) {
        let [dx, dy] = [0, 1].map(|axis| east.position_m[axis] - west.position_m[axis]);
        assert!((dx - 42.0).abs() <= 0.1 && dy.abs() <= 0.6, "{dx} {dy}");
    }
    let one = [("study.squares.from_m", "[[0, 0]]".to_owned())];
    let error = read("staya/closing/alpha-nine.toml", &one, &ALL, 1).unwrap_err();
    assert!(error.contains("study.squares.from_m: there are more groups than squares"), "{error}");
}

#[test]
fn a_flock_follows_its_orders_only_if_the_goal_pulls() {
    let of = |k1: &str| {
        let sets = [("plane.robots.cloud.count", "20".to_owned()), ("plane.goal_flock.k1", k1.to_owned())];
        read("pav/path/sub-goals.toml", &sets, &["tracking.passed"], 3).unwrap()
    };
    let (led, free) = (of("50"), of("0"));
    assert_eq!((value(&led, "tracking.passed"), value(&free, "tracking.passed")), (1.0, 0.0));
    assert!(value(&led, "tracking.miss_m") < 20.0 && value(&free, "tracking.miss_m") > 300.0);
    assert_eq!(value(&led, "tracking.at_first"), value(&led, "tracking.at_one"));
}

#[test]
fn a_flock_that_votes_goes_to_one_goal_and_another_one_parts() {
    let of = |rule: &str| {
        let sets = [("study.votes", rule.to_owned()), ("study.first_goal", "0.6".to_owned())];
        value(&read("pav/voting/scenario.toml", &sets, &["tracking.at_first"], 5).unwrap(), "tracking.at_first")
    };
    assert_eq!(of("majority"), 1.0);
    assert!(of("shares") > 0.9 && of("none") < 0.6);
}

#[test]
fn energy_falls_among_obstacles_but_without_their_potential_it_rises() {
    let sets = [("tick_s", "0.01".to_owned()), ("ticks", "600".to_owned())];
    let measured = read("olf/energy/rest.toml", &sets, &["energy.rise"], 2).unwrap();
    assert!(value(&measured, "energy.rise") < 1e-5 && value(&measured, "energy.rise_without") > 1e-4, "{measured:?}");
    assert!(value(&measured, "energy.damping") <= 0.0 && value(&measured, "energy.least_damping") < -10.0);
    assert_eq!(value(&measured, "energy.held"), 1.0);
}

#[test]
fn the_centroid_follows_the_reference_alone_and_stress_is_the_force() {
    let sets =
        |algorithm: &str| [sets(20, 200, "all"), vec![("plane.lattice.algorithm", algorithm.to_owned())]].concat();
    let of = |algorithm| read("olf/flock/free.toml", &sets(algorithm), &["energy.center_off"], 1).unwrap();
    let (linear, bounded) = (of("2"), of("3"));
    assert!(value(&linear, "energy.center_off") < 1e-9 && value(&bounded, "energy.center_off") > 0.1);
    assert!(value(&linear, "energy.stress_off") < 1e-12 && value(&linear, "energy.stress") > 0.0);
}
