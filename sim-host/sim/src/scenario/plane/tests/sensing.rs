use super::*;
use crate::world::plane::Sensing;

const SENSING: &str = "[plane.sensing]\nrange_m = 3\n";

fn sensing(text: &str) -> Sensing {
    parse(text).unwrap_or_else(|error| panic!("{error}\n{text}")).sensing().expect("sensing")
}

#[test]
fn minimal_sensors_have_the_documented_defaults() {
    let found = sensing(&format!("{HEAD}tick_s = 0.05\n{PLANE}{SENSING}{TWO}"));
    assert_eq!((found.noise_m, found.every_ticks, found.delay_ticks), (0.0, 1, 0));
    assert!(found.is_occluded && found.has_beacons && !found.sees_names);
    let tracking = found.tracking;
    assert_eq!((tracking.gate, tracking.margin, tracking.acceleration_mps2), (4.0, 2.0, 4.0));
    assert_eq!(tracking.forget, Duration::from_millis(200));
    assert!(parse(&format!("{HEAD}{PLANE}{TWO}")).expect("good").sensing().is_none());
}

#[test]
fn rare_and_late_detections_are_remembered_longer() {
    let found = sensing(&format!("{HEAD}tick_s = 0.05\n{PLANE}{SENSING}every_ticks = 4\ndelay_ticks = 2\n{TWO}"));
    assert_eq!(found.tracking.forget, Duration::from_millis(14 * 50));
}

#[test]
fn invalid_sensors_are_refused_with_a_remedy() {
    let cases = [
        (format!("{PLANE}[plane.sensing]\nrange_m = 0\n{TWO}"), "plane.sensing.range_m"),
        (format!("{PLANE}{SENSING}noise_m = -1\n{TWO}"), "plane.sensing.noise_m"),
        (format!("{PLANE}{SENSING}noise_m = nan\n{TWO}"), "plane.sensing.noise_m"),
        (format!("{PLANE}{SENSING}every_ticks = 0\n{TWO}"), "plane.sensing.every_ticks"),
        (format!("{PLANE}{SENSING}delay_ticks = 1001\n{TWO}"), "plane.sensing.delay_ticks"),
        (format!("{PLANE}{SENSING}gate = 0\n{TWO}"), "plane.sensing.gate"),
        (format!("{PLANE}{SENSING}margin = -1\n{TWO}"), "plane.sensing.margin"),
        (format!("{PLANE}{SENSING}forget_s = 0\n{TWO}"), "plane.sensing.forget_s"),
        (format!("{PLANE}{SENSING}acceleration_mps2 = 0\n{TWO}"), "plane.sensing.acceleration_mps2"),
        (
            format!("{LAND}{PLANE}law = \"route\"\n{SENSING}[robots]\nlist = [{{ start = [1, 1], goal = [5, 5] }}]\n"),
            "moves between cells",
        ),
        (
            format!(
                "{PLANE}law = \"boids\"\nsafety = \"none\"\ntorus_m = [50, 50]\n{SENSING}[plane.boids]\ncrowded_m = 1\n\
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
