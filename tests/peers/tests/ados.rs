//! Staya's drones beside those of `ados-swarm`. `examples/ados.rs` prints more runs.

use ados_swarm::scenarios;
use staya_peers::drones::{Ados, FLOOR_M, Outcome, Scene, Staya, run};

fn assert_apart(scene: &Scene, name: &str) -> Outcome {
    let outcome = run::<Staya>(scene);
    assert!(outcome.least_m >= FLOOR_M && outcome.climb_m < 1e-9, "{name}: {outcome:?}");
    outcome
}

#[test]
fn the_plant_is_that_of_the_peer() {
    let own = scenarios::separation_collision_course();
    let here = run::<Ados>(&Scene::collision_course());
    assert!((own.min_separation_m - here.least_m).abs() < 1e-3, "{own:?}, {here:?}");
    let dropped_s = run::<Ados>(&Scene::beacon_loss()).dropped_s;
    assert_eq!(dropped_s, Some(scenarios::beacon_loss().drop_delay_s));
}

#[test]
fn drones_sent_towards_each_other_stay_apart_without_a_climb() {
    assert_apart(&Scene::collision_course(), "collision course");
}

#[test]
fn a_flock_arrives_before_that_of_the_peer() {
    let outcome = assert_apart(&Scene::flock(0), "flock");
    let peer_s = run::<Ados>(&Scene::flock(0)).arrival_s.expect("arrives");
    assert!(outcome.arrival_s.is_some_and(|arrival_s| arrival_s < peer_s), "{outcome:?}, peer {peer_s} s");
}

#[test]
fn a_wedge_of_goals_has_little_error() {
    let outcome = assert_apart(&Scene::stations(0), "wedge");
    assert!(outcome.error_m <= 0.1, "{outcome:?}");
}

#[test]
fn a_dead_drone_is_known_as_lost_after_three_seconds() {
    let outcome = run::<Staya>(&Scene::beacon_loss());
    assert!(outcome.dropped_s.is_some_and(|dropped_s| dropped_s <= 3.0), "{outcome:?}");
}

#[test]
fn drones_exchange_places_above_the_floor() {
    for seed in 0..3 {
        for (drones, radius_m) in [(4, 20.0), (8, 30.0), (12, 40.0)] {
            let scene = Scene::circle(drones, radius_m, seed);
            let cases = [("", scene.clone()), ("loss", scene.clone().lossy(0.3, seed)), ("death", scene.deadly(seed))];
            for (case, scene) in cases {
                let outcome = assert_apart(&scene, &format!("{drones} drones, seed {seed}, {case}"));
                assert!(outcome.arrival_s.is_some(), "{drones} drones, seed {seed}, {case}: {outcome:?}");
            }
        }
    }
}
