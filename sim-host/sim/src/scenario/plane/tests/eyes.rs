//! `[plane.eyes]`.

use super::*;
use crate::world::plane::Eyes;

const EYES: &str = "[plane.eyes]\nrange_m = 3\n";

fn eyes(text: &str) -> Eyes {
    parse(text).unwrap_or_else(|error| panic!("{error}\n{text}")).eyes.expect("eyes")
}

#[test]
fn minimal_sensors_have_the_documented_defaults() {
    let found = eyes(&format!("{HEAD}tick_s = 0.05\n{PLANE}{EYES}{TWO}"));
    assert_eq!((found.noise_m, found.every_ticks, found.delay_ticks), (0.0, 1, 0));
    assert!(found.is_occluded && found.has_beacons && !found.sees_names);
    let tracking = found.tracking;
    assert_eq!((tracking.gate, tracking.margin, tracking.acceleration_mps2), (4.0, 2.0, 4.0));
    assert_eq!(tracking.forget, Duration::from_millis(200));
    assert!(parse(&format!("{HEAD}{PLANE}{TWO}")).expect("good").eyes.is_none());
}

#[test]
fn rare_and_late_detections_are_remembered_longer() {
    let found = eyes(&format!("{HEAD}tick_s = 0.05\n{PLANE}{EYES}every_ticks = 4\ndelay_ticks = 2\n{TWO}"));
    assert_eq!(found.tracking.forget, Duration::from_millis(14 * 50));
}

#[test]
fn invalid_sensors_are_refused_with_a_remedy() {
    let cases = [
        (format!("{PLANE}[plane.eyes]\nrange_m = 0\n{TWO}"), "plane.eyes.range_m"),
        (format!("{PLANE}{EYES}noise_m = -1\n{TWO}"), "plane.eyes.noise_m"),
        (format!("{PLANE}{EYES}noise_m = nan\n{TWO}"), "plane.eyes.noise_m"),
        (format!("{PLANE}{EYES}every_ticks = 0\n{TWO}"), "plane.eyes.every_ticks"),
        (format!("{PLANE}{EYES}delay_ticks = 1001\n{TWO}"), "plane.eyes.delay_ticks"),
        (format!("{PLANE}{EYES}gate = 0\n{TWO}"), "plane.eyes.gate"),
        (format!("{PLANE}{EYES}margin = -1\n{TWO}"), "plane.eyes.margin"),
        (format!("{PLANE}{EYES}forget_s = 0\n{TWO}"), "plane.eyes.forget_s"),
        (format!("{PLANE}{EYES}acceleration_mps2 = 0\n{TWO}"), "plane.eyes.acceleration_mps2"),
        (
            format!(
                "{LAND}{PLANE}guidance = \"route\"\n{EYES}[robots]\nlist = [{{ start = [1, 1], goal = [5, 5] }}]\n"
            ),
            "goes by cells",
        ),
        (
            format!(
                "{PLANE}guidance = \"boids\"\nsafety = \"none\"\ntorus_m = [50, 50]\n{EYES}[plane.boids]\ncrowded_m = 1\n\
                 closest_m = 5\n[plane.robots]\nlist = [{{ start_m = [1, 1] }}]\n"
            ),
            "torus",
        ),
    ];
    for (text, place) in cases {
        let error = parse(&format!("{HEAD}{text}")).expect_err(&text).to_string();
        assert!(error.contains(place) && error.contains("s.toml"), "{place}: {error}");
    }
}
