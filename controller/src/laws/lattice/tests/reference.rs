use super::super::ReferenceMotion;
use crate::flock::fixtures::vec3;

const EAST: [f64; 3] = [6.0, 0.0, 0.0];

fn wanted(motion: ReferenceMotion<f64>, offset: [f64; 3]) -> f64 {
    let velocity = motion.wanted(vec3(offset), vec3(EAST));
    assert_eq!((velocity.y, velocity.z), (0.0, 0.0));
    velocity.x
}

#[test]
fn only_behind_a_resting_reference_the_velocity_fades() {
    let resting = ReferenceMotion::Resting(70.0);
    let expected = [(50.0, 6.0), (0.0, 6.0), (-35.0, 3.0), (-69.3, 0.06), (-70.0, 0.0), (-1e9, 0.0)];
    for (offset, speed) in expected {
        for side in [0.0, -400.0] {
            let got = wanted(resting, [offset, side, 3.0]);
            assert!((got - speed).abs() < 1e-9, "{offset}: {got}");
            assert_eq!(wanted(ReferenceMotion::Static, [offset, side, 3.0]), 6.0);
            assert_eq!(wanted(ReferenceMotion::Dynamic, [offset, side, 3.0]), 6.0);
        }
    }
}

#[test]
fn a_resting_distance_of_zero_rests_at_the_reference_and_invalid_input_gives_zero() {
    for none in [0.0, -1.0, f64::NAN] {
        assert_eq!(wanted(ReferenceMotion::Resting(none), [-1.0, 0.0, 0.0]), 0.0);
        assert_eq!(wanted(ReferenceMotion::Resting(none), [1.0, 0.0, 0.0]), 6.0);
    }
    let stands = ReferenceMotion::Resting(70.0).wanted(vec3([-5.0, 0.0, 0.0]), vec3([0.0; 3]));
    assert_eq!(stands, vec3::<f64>([0.0; 3]));
}

#[test]
fn boolean_flags_and_motions_have_equal_digests() {
    use crate::digest::digest;
    assert_eq!(digest(&ReferenceMotion::<f32>::Static), digest(&false));
    assert_eq!(digest(&ReferenceMotion::<f32>::Dynamic), digest(&true));
    let resting = |within: f32| digest(&ReferenceMotion::Resting(within));
    assert_ne!(resting(7.0), resting(8.0));
}
