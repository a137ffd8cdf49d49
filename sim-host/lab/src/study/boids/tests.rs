use super::*;
use crate::sweep::Plan;
use crate::sweep::plan::Changes;
use staya_sim::scenario::Source;
use std::path::Path;

fn small(search: Method) -> Parameters {
    Parameters { boids: 60, search, steps: 12, all_pairs_up_to: 60, ..Parameters::default() }
}

const SEARCHES: [Method; 7] = [
    Method::AllPairs,
    Method::PairsOnce,
    Method::Cells,
    Method::Threads,
    Method::Tree,
    Method::MidpointTree,
    Method::Quadtree,
];

#[test]
fn all_searches_and_all_threads_give_the_same_trajectories() {
    let of = |search| small(search).measure(1, &|_| true);
    let hash = of(Method::Cells).trace_hash;
    assert_ne!(format!("{:016x}", small(Method::Cells).flock(60, 1).hash()), hash);
    for search in SEARCHES {
        let measured = of(search);
        assert_eq!((measured.trace_hash, measured.values["equal"]), (hash.clone(), Some(1.0)), "{search:?}");
        assert!(measured.values["neighbours"].unwrap() > 1.0);
        for boids in [1, 2] {
            let few = Parameters { boids, ..small(search) }.measure(1, &|_| true);
            assert_eq!(few.values["equal"], Some(1.0));
        }
    }
}

#[test]
fn flocks_match_their_recorded_hashes() {
    let mut flock = small(Method::Cells).flock(60, 1);
    let mut cells = Cells::new(flock.space, 150.0);
    (0..100).for_each(|_| flock.step(&mut cells));
    assert_eq!(format!("{:016x}", flock.hash()), "80d38a757c170a18");
}

#[test]
fn boids_align_and_stay_on_the_torus() {
    let mut flock = small(Method::Cells).flock(30, 1);
    assert!(flock.order() < 0.4, "{}", flock.order());
    let mut cells = Cells::new(flock.space, 150.0);
    (0..600).for_each(|_| flock.step_by_cells(&mut cells));
    assert!(flock.order() > 0.6, "{}", flock.order());
    let [width, height] = flock.sides();
    let is_inside = |&[x, y]: &[f32; 2]| (0.0..width).contains(&x) && (0.0..height).contains(&y);
    assert!(flock.places().iter().all(is_inside));
    assert!((width / height - 4.0 / 3.0).abs() < 1e-5);
}

#[test]
fn pairs_are_skipped_above_the_limit_and_a_stopped_run_has_no_row() {
    let many = Parameters { boids: 61, ..small(Method::AllPairs) };
    assert!(many.measure(1, &|_| true).values.is_empty());
    assert!(small(Method::Cells).measure(1, &|step| step < 5).is_cut);
}

#[test]
fn invalid_parameters_are_refused() {
    let read = |fields: &str| {
        let text = format!("name = 'b'\nstudy = 'boids'\n[set]\n{fields}");
        let plan = Plan::parse(&text, Path::new("b.toml"), &Changes::default());
        plan.map(drop).map_err(|error| error.to_string())
    };
    for (fields, expected) in [
        ("study.boids = 0", "study.boids: 0 is out of range; give 1 to 1000000"),
        ("study.steps = 0", "study.steps"),
        ("study.closest = -1", "study.closest: -1 is out of range; give a number above 0"),
        ("study.area_per_boid = inf", "study.area_per_boid"),
        ("study.max_turn = 3.2", "study.max_turn: 3.2 is out of range; give 0 to 3.14"),
        ("study.max_turn_away = -0.1", "study.max_turn_away"),
        ("study.search = 'luck'", "unknown value `luck`"),
        ("study.flocks = 2", "flocks"),
        ("radio.loss = 2", "there is no scenario"),
    ] {
        let error = read(fields).expect_err(fields);
        assert!(error.contains(expected), "{error}");
    }
    read("").expect("the paper's");
}

#[test]
fn a_flock_is_drawn_at_three_moments() {
    let source = Source::new(Path::new("b.toml"), "[study]\nboids = 4\nsteps = 20").expect("TOML");
    let given = Given { source, measures: &[], seed: 1 };
    let dir = tempfile::tempdir().expect("a folder");
    let files = Boids.draw(&given, "four boids", &dir.path().join("flock")).expect("drawn");
    assert_eq!(files.len(), 2);
    assert!(files.iter().all(|file| file.is_file()));
}
