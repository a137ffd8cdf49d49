use super::super::*;

#[test]
fn the_nose_points_along_the_velocity_and_the_wings_are_level() {
    let velocities: [[f64; 3]; 7] = [
        [3.0, 0.0, 0.0],
        [0.0, -2.0, 0.5],
        [-1.0, 4.0, -9.0],
        [0.0, 0.0, 7.0],
        [0.0, 0.0, -7.0],
        [1e-200, 2e-200, 1e-200],
        [-1e200, 0.0, 1e200],
    ];
    for velocity in velocities {
        let [r1, r2, r3] = attitude(velocity).expect("it moves");
        let speed = velocity.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        let scaled = velocity.map(|c| c / speed);
        assert!((dot(r1, scaled) - length(scaled)).abs() < 1e-12, "{velocity:?}: {r1:?}");
        for (a, b, product) in
            [(r1, r1, 1.0), (r2, r2, 1.0), (r3, r3, 1.0), (r1, r2, 0.0), (r1, r3, 0.0), (r2, r3, 0.0)]
        {
            assert!((dot(a, b) - product).abs() < 1e-12, "{velocity:?}: {a:?} {b:?}");
        }
        let cross = [r1[1] * r2[2] - r1[2] * r2[1], r1[2] * r2[0] - r1[0] * r2[2], r1[0] * r2[1] - r1[1] * r2[0]];
        assert!(length(minus(cross, r3)) < 1e-12 && r2[2] == 0.0 && r3[2] >= 0.0, "{velocity:?}: {r2:?} {r3:?}");
    }
    assert_eq!(attitude([0.0, 2.0, 0.0]), Some([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]));
    for none in [[0.0; 3], [f64::NAN, 1.0, 0.0], [f64::INFINITY, 1.0, 0.0]] {
        assert_eq!(attitude(none), None);
    }
}
