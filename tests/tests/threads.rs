//! Results do not depend on the number of threads.

use staya_sim::engine::Outcome;
use staya_tests::{run, scenario};

fn on_threads(name: &str, ticks: Option<u32>, threads: usize) -> (Outcome, String) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("threads").install(|| {
        let (outcome, rows) = run(&scenario(name, ticks));
        // As text, in which NaN equals NaN.
        (outcome, format!("{rows:?}"))
    })
}

fn same_on_any_number(name: &str, ticks: Option<u32>) {
    let one = on_threads(name, ticks, 1);
    for threads in [2, 8] {
        let other = on_threads(name, ticks, threads);
        assert_eq!(other.0, one.0, "{name} on {threads} threads");
        assert!(other.1 == one.1, "{name} on {threads} threads: traces differ");
    }
}

#[test]
fn six_robots_with_a_bad_radio_do_not_depend_on_threads() {
    same_on_any_number("six-robots", None);
}

#[test]
fn faults_do_not_depend_on_threads() {
    same_on_any_number("blackout", None);
}

#[test]
fn robots_among_walls_do_not_depend_on_threads() {
    same_on_any_number("moving-ai-20", None);
}

#[test]
fn robots_that_share_maps_do_not_depend_on_threads() {
    same_on_any_number("shared-maps", Some(200));
}

#[test]
fn a_thousand_robots_do_not_depend_on_threads() {
    same_on_any_number("scale-small", Some(30));
}

#[test]
fn a_flock_in_the_plane_does_not_depend_on_threads() {
    same_on_any_number("boids", Some(60));
    same_on_any_number("goal-flock", Some(60));
}

#[test]
fn groups_with_different_laws_do_not_depend_on_threads() {
    same_on_any_number("groups", Some(200));
}

#[test]
fn a_thousand_discs_among_pillars_do_not_depend_on_threads() {
    same_on_any_number("scale-plane-small", Some(30));
}
