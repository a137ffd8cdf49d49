use super::*;
use proptest::prelude::*;

fn place(latitude_deg: f64, longitude_deg: f64, altitude_m: f64) -> Global {
    Global { latitude_deg, longitude_deg, altitude_m }
}

fn origin(latitude_deg: f64, longitude_deg: f64, altitude_m: f64) -> Origin {
    Origin::new(place(latitude_deg, longitude_deg, altitude_m)).unwrap()
}

/// East and north by PROJ 9 (`+proj=cart` and `+proj=topocentric` on WGS 84).
#[test]
fn the_tangent_plane_equals_that_of_proj() {
    let moscow = (55.75, 37.62, 156.0);
    let canberra = (-35.363_262, 149.165_237, 584.0);
    let date_line = (0.0, 180.0, 0.0);
    for (from, latitude, longitude, [east, north]) in [
        (moscow, 55.751, 37.62, [0.0, 111.34]),
        (moscow, 55.75, 37.621, [62.7965, 0.0005]),
        (moscow, 55.66, 37.78, [10070.5391, -10008.8991]),
        (moscow, 56.65, 36.12, [-92004.0552, 101204.7782]),
        (canberra, -35.362_262, 149.165_237, [0.0, 110.9574]),
        (canberra, -35.453_262, 149.325_237, [14526.4164, -9997.9783]),
        (canberra, -34.463_262, 147.665_237, [-137817.2371, 98806.0097]),
        (date_line, 0.0, -179.999, [111.3195, 0.0]),
        (date_line, -0.09, -179.84, [17811.0736, -9951.6808]),
        (date_line, 0.9, 178.5, [-166939.703, 99512.838]),
    ] {
        let origin = origin(from.0, from.1, from.2);
        let found = origin.to_enu_m(&place(latitude, longitude, from.2 + 7.5)).unwrap();
        assert!((found[0] - east).abs() < 1e-4, "{found:?} {east}");
        assert!((found[1] - north).abs() < 1e-4, "{found:?} {north}");
        assert!((found[2] - 7.5).abs() < 1e-9, "level flight has a constant height");
    }
}

proptest! {
    #[test]
    fn round_trips_are_exact_to_a_millimetre(
        latitude in -89.9..89.9, longitude in -180.0..180.0, altitude in -400.0..9000.0,
        x in -100000.0..100000.0, y in -100000.0..100000.0, z in -500.0..5000.0,
    ) {
        let origin = origin(latitude, longitude, altitude);
        let back = origin.to_enu_m(&origin.to_global([x, y, z]).unwrap()).unwrap();
        for (there, back) in [x, y, z].into_iter().zip(back) {
            prop_assert!((there - back).abs() < 1e-3, "{there} {back}");
        }
    }

    #[test]
    fn message_integers_round_to_one_step(latitude in -90.0..90.0, longitude in -180.0..180.0) {
        let [lat, lon, alt] = place(latitude, longitude, 12.3456).to_e7();
        let back = Global::from_e7(lat, lon, alt);
        prop_assert!((back.latitude_deg - latitude).abs() <= 0.51e-7);
        prop_assert!((back.longitude_deg - longitude).abs() <= 0.51e-7);
        prop_assert_eq!(alt, 12_346);
    }
}

#[test]
fn invalid_positions_are_refused() {
    for [latitude, longitude, altitude] in
        [[90.1, 0.0, 0.0], [0.0, -180.1, 0.0], [f64::NAN, 0.0, 0.0], [0.0, f64::INFINITY, 0.0], [0.0, 0.0, 1e6]]
    {
        let place = place(latitude, longitude, altitude);
        assert_eq!(Origin::new(place), None);
        assert_eq!(origin(0.0, 0.0, 0.0).to_enu_m(&place), None);
    }
    let here = origin(55.0, 37.0, 0.0);
    assert_eq!(here.to_enu_m(&place(-55.0, -143.0, 0.0)), None, "other side of the Earth");
    assert_eq!(here.to_global([f64::NAN, 0.0, 0.0]), None);
    assert_eq!(here.to_global([0.0, FAR_M * 1.001, 0.0]), None);
    assert!(here.to_global([FAR_M, -FAR_M, 0.0]).is_some());
}

#[test]
fn ned_and_enu_are_inverse() {
    assert_eq!(ned([1.0, 2.0, 3.0]), [2.0, 1.0, -3.0]);
    assert_eq!(enu(ned([1.0, 2.0, 3.0])), [1.0, 2.0, 3.0]);
}

#[test]
fn texts_are_places_on_the_earth() {
    let zurich = "47.4, 8.5,488".parse::<Origin>().unwrap().place();
    assert_eq!((zurich.latitude_deg, zurich.altitude_m), (47.4, 488.0));
    for bad in ["", "1,2", "1,2,3,4", "91,0,0", "0,181,0", "a,b,c", "nan,0,0"] {
        assert!(bad.parse::<Origin>().is_err(), "{bad}");
    }
}
