//! The file of settings, and values that the reader refuses.

use _staya::settings;
use staya_controller::grid::Norm;
use staya_tests::printed;

#[test]
fn golden_settings_are_those_of_the_tables() {
    printed("sim-host/python/python/staya/settings.py", &settings::page());
}

#[test]
fn settings_without_values_have_the_defaults_of_the_laws() {
    let lattice = settings::lattice("spacing_m = 2").expect("sound");
    assert_eq!((lattice.params.alpha.position, lattice.params.gamma.position), (10.0, 2.0));
    // The pull grows with the size of the flock, so the law has less of it.
    let second = settings::lattice("spacing_m = 2\nalgorithm = 2").expect("sound");
    assert!((second.params.gamma.position - 0.2).abs() < 1e-6);
    let goal = settings::goal("speed_mps = 1\nmin_distance_m = 0.5").expect("sound");
    assert_eq!((goal.neighborhood_m, goal.speed_mps), (2.0, 1.0));
    assert_eq!(settings::orca("", false).expect("sound").0, Default::default());
    let route = settings::route("replan = \"until_changed\"", Norm::Chebyshev, true).expect("sound");
    assert_eq!((route.params.norm, route.params.corner_cutting), (Norm::Chebyshev, true));
}

#[test]
fn contradictions_and_missing_values_are_refused() {
    for (error, wanted) in [
        (
            settings::lattice("").map(drop),
            "missing `spacing_m`: distance of neighbours in the lattice (d); give 0.01 to 100 metres",
        ),
        (settings::goal("min_distance_m = 1").map(drop), "missing `speed_mps`: preferred speed; give 0 to 32 m/s"),
        (
            settings::goal("speed_mps = 1\nmin_distance_m = 1\nneighborhood_m = 1").map(drop),
            "neighborhood_m: less than 2 min_distance_m; give more, or leave it out",
        ),
        (
            settings::lattice("spacing_m = 1\nrepulsion = 1").map(drop),
            "repulsion: less than the attraction; give at least the attraction",
        ),
        (
            settings::lattice("spacing_m = 1\nalgorithm = 1.5").map(drop),
            "algorithm: 1.5 is not a whole number; give 2, or another whole number",
        ),
        (
            settings::orca("downwash = 2", false).map(drop),
            "downwash: unknown field `downwash`; this table has `horizon_s`, `wall_horizon_s`, `share`, `margin_m`, \
                `lean_rad`, `patience_radii` (help(staya.settings) lists all fields)",
        ),
        (
            settings::orca("margin = 1", false).map(drop),
            "margin: unknown field `margin`; the field is called `margin_m` now (help(staya.settings) lists all fields)",
        ),
        (
            settings::boids("crowded_m = 1").map(drop),
            "missing `closest_m`: farthest neighbour that counts; give 0 to 10000 metres",
        ),
    ] {
        assert_eq!(error, Err(wanted.to_owned()));
    }
}
