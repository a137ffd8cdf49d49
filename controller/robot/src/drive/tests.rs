use super::*;
use proptest::prelude::*;
use staya_controller::agent::{Command, KinematicState};
use staya_controller::geom::{Position, Vec2, Vec3};
use staya_controller::scalar::{Q16, Scalar};
use staya_controller::time::Duration;

const SPAN: Duration = Duration::from_millis(50);

fn twist<S: Scalar>(parts: [f64; 3]) -> Twist<S> {
    let [forward_mps, left_mps, turn_radps] = parts.map(|part| S::from_f64(part).unwrap());
    Twist { forward_mps, left_mps, turn_radps }
}

fn at_once(speed_mps: f64) -> Limits<f64> {
    Limits { speed_mps, acceleration_mps2: f64::MAX }
}

fn near(a: &Twist<f64>, b: &Twist<f64>, tolerance: f64) -> bool {
    let d = [a.forward_mps - b.forward_mps, a.left_mps - b.left_mps, a.turn_radps - b.turn_radps];
    d.iter().all(|d| d.abs() <= tolerance)
}

#[test]
fn wheels_turn_in_the_expected_directions() {
    let two = Differential::new(0.2).unwrap();
    assert_eq!(two.wheels(&twist([0.5, 0.0, 1.0])), [0.4, 0.6]);
    assert_eq!(two.wheels(&twist([0.0, 9.0, 0.0])), [0.0, 0.0], "it cannot go sideways");
    let four = Mecanum::new(0.3, 0.2).unwrap();
    assert_eq!(four.wheels(&twist([1.0, 0.0, 0.0])), [1.0; 4]);
    assert_eq!(four.wheels(&twist([0.0, 1.0, 0.0])), [-1.0, 1.0, 1.0, -1.0]);
    assert_eq!(four.wheels(&twist([0.0, 0.0, 1.0])), [-0.25, 0.25, -0.25, 0.25]);
    let three = Omni::<f64, 3>::new(0.0, 0.1).unwrap();
    let [nose, left, right] = three.wheels(&twist([1.0, 0.0, 0.0]));
    let half = 3f64.sqrt() / 2.0;
    assert!(nose.abs() < 1e-12 && (left + half).abs() < 1e-12 && (right - half).abs() < 1e-12);
    let [nose, left, right] = three.wheels(&twist([0.0, 1.0, 2.0]));
    assert!((nose - 1.2).abs() < 1e-12 && (left + 0.3).abs() < 1e-12);
    assert!((right + 0.3).abs() < 1e-12);
}

#[test]
fn invalid_dimensions_are_refused() {
    let two = Differential::new(0.2).unwrap();
    let mixer = |speed_mps, acceleration_mps2| {
        let limits = Limits { speed_mps, acceleration_mps2 };
        Mixer::new(two, limits)
    };
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(LookAhead::new(bad).is_none());
        assert!(Differential::new(bad).is_none());
        assert!(Omni::<f32, 3>::new(0.0, bad).is_none());
        assert!(Mecanum::new(bad, 0.0).is_none());
        assert!(mixer(bad, 1.0).is_none());
    }
    assert!(mixer(1.0, 0.0).is_none() && mixer(1.0, f32::NAN).is_none());
    assert!(mixer(1.0, f32::MAX).is_some());
    assert!(Omni::<f32, 4>::new(f32::NAN, 1.0).is_none());
}

#[test]
fn commands_without_a_velocity_stop() {
    assert_eq!(wished_velocity(&Command::<f32>::Hold), Vec2::ZERO);
    let moves = heapless::Vec::from_slice(&[staya_controller::grid::Dir::East]).unwrap();
    assert_eq!(wished_velocity(&Command::<f32>::Move(moves)), Vec2::ZERO);
    let velocity = Command::Velocity(Vec3::new(1.0, 2.0, 3.0));
    assert_eq!(wished_velocity(&velocity), Vec2::new(1.0, 2.0));
}

#[test]
fn angles_wrap_to_the_half_open_interval() {
    fn check<S: Scalar>() {
        let pi = S::PI;
        assert_eq!(wrap_angle(pi), pi);
        assert_eq!(wrap_angle(-pi), pi);
        assert_eq!(wrap_angle(S::ZERO), S::ZERO);
        for turns in -9..=9 {
            let angle = S::ONE + (pi + pi) * S::from_i32(turns);
            let off = (wrap_angle(angle) - S::ONE).to_f64();
            assert!(off.abs() < 1e-3, "{turns} {off}");
        }
    }
    check::<f32>();
    check::<f64>();
    check::<Q16>();
    assert!(wrap_angle(f32::NAN).is_nan());
}

#[test]
fn excessive_speed_keeps_the_curve_and_nan_stops() {
    let mut mixer = Mixer::new(Differential::new(0.2).unwrap(), at_once(0.5)).unwrap();
    assert_eq!(mixer.mix(&twist([0.9, 0.0, 1.0]), SPAN), [0.4, 0.5]);
    for bad in [f64::NAN, f64::INFINITY, f64::MAX] {
        let senseless = Twist { forward_mps: bad, turn_radps: bad, left_mps: 0.0 };
        let rims = mixer.mix(&senseless, SPAN);
        assert!(rims.iter().all(|rim| rim.abs() <= 0.5), "{bad}: {rims:?}");
        assert!(bad == f64::MAX || rims == [0.0; 2], "{bad}: {rims:?}");
    }
}

#[test]
fn speed_builds_up_within_the_acceleration_and_the_emergency_stop_does_not_wait() {
    let limits = Limits { speed_mps: 1.0f32, acceleration_mps2: 2.0 };
    let mut mixer = Mixer::new(Differential::new(0.2).unwrap(), limits).unwrap();
    let ahead = twist([1.0, 0.0, 0.0]);
    let tenth = Duration::from_millis(100);
    assert_eq!(mixer.mix(&ahead, tenth), [0.2, 0.2]);
    assert_eq!(mixer.mix(&ahead, Duration::ZERO), [0.2, 0.2]);
    assert_eq!(mixer.mix(&ahead, Duration::from_millis(-9)), [0.2, 0.2]);
    assert_eq!(mixer.mix(&ahead, Duration::MAX), [1.0, 1.0]);
    let nonsense = twist::<f32>([0.0; 3]);
    let nonsense = Twist { turn_radps: f32::NAN, ..nonsense };
    let rims = mixer.mix(&nonsense, tenth);
    assert!(rims.iter().all(|rim| (rim - 0.8).abs() < 1e-6));
    mixer.stop();
    assert_eq!(mixer.mix(&twist([0.0; 3]), Duration::ZERO), [0.0; 2]);
}

#[test]
fn a_robot_sent_sideways_turns_and_one_sent_back_reverses() {
    let ahead = LookAhead::new(0.1f64).unwrap();
    let north = Vec2::new(0.0, 0.3);
    let turn = ahead.twist(north, 0.0);
    assert!(near(&turn, &twist([0.0, 0.0, 3.0]), 1e-12));
    let along = ahead.twist(north, core::f64::consts::FRAC_PI_2);
    assert!(near(&along, &twist([0.3, 0.0, 0.0]), 1e-12));
    let back = ahead.twist(north, -core::f64::consts::FRAC_PI_2);
    assert!(near(&back, &twist([-0.3, 0.0, 0.0]), 1e-12));
    assert_eq!(ahead.radius(0.25), 0.35);
}

#[test]
fn the_point_ahead_moves_when_the_robot_turns() {
    let ahead = LookAhead::new(0.5f64).unwrap();
    let axle = KinematicState { position: Position::from_mm([1000, 2000, 3]), velocity_mps: Vec3::new(0.1, 0.0, 0.0) };
    let point = ahead.state(&axle, 0.0, 2.0);
    assert_eq!(point.position.mm, [1500, 2000, 3]);
    assert_eq!(point.velocity_mps, Vec3::new(0.1, 1.0, 0.0));
    assert_eq!(ahead.state(&axle, f64::NAN, 0.0).position, axle.position);
}

#[test]
fn duties_skip_the_dead_band_and_round_symmetrically() {
    let motor = Calibration { full_mps: 0.5f32, dead_duty: 0.2, still_mps: 0.01, is_inverted: false };
    assert_eq!(motor.duty(0.5), FULL);
    assert_eq!(motor.duty(7.0), FULL);
    assert_eq!(motor.duty(0.25), 19660);
    assert_eq!(motor.duty(0.01), 0);
    assert!(motor.duty(0.011) > 6553, "more than the dead part");
    for bad in [0.0, -0.0, f32::NAN, f32::INFINITY] {
        assert_eq!(motor.duty(bad), 0);
    }
    let other = Calibration { is_inverted: true, ..motor };
    for speed in [0.5, 0.25, 0.02, -0.3, 1e30] {
        assert_eq!(motor.duty(-speed), -motor.duty(speed));
        assert_eq!(other.duty(speed), -motor.duty(speed));
    }
    let fixed = Calibration::linear(Q16::HALF);
    assert_eq!(fixed.duty(Q16::ONE), FULL);
    assert_eq!(fixed.duty(Q16::from_ratio(1, 4)), 16384);
    let senseless = Calibration::linear(0.0f32);
    assert_eq!(senseless.duty(1.0), 0, "its speed is unknown");
}

#[test]
fn rim_speeds_follow_from_turns() {
    assert!((rim_speed(0.03f64, 100.0, 60.0) - 0.314_159_265).abs() < 1e-8);
    assert_eq!(rim_speed(0.03f32, 100.0, 0.0), 0.0);
}

proptest! {
    #[test]
    fn wheel_speeds_reproduce_the_wished_motion(parts in any::<[i8; 3]>(), arm in 0.02f64..2.0, first in -4.0f64..4.0) {
        let wish = twist(parts.map(|part| f64::from(part) / 50.0));
        let two = Differential::new(arm).unwrap();
        let no_side = Twist { left_mps: 0.0, ..wish };
        prop_assert!(near(&two.twist(&two.wheels(&wish)), &no_side, 1e-9));
        let mecanum = Mecanum::new(arm, arm / 2.0).unwrap();
        prop_assert!(near(&mecanum.twist(&mecanum.wheels(&wish)), &wish, 1e-9));
        let three = Omni::<f64, 3>::new(first, arm).unwrap();
        prop_assert!(near(&three.twist(&three.wheels(&wish)), &wish, 1e-9));
        let four = Omni::<f64, 4>::new(first, arm).unwrap();
        prop_assert!(near(&four.twist(&four.wheels(&wish)), &wish, 1e-9));
        let rounded = Omni::<Q16, 3>::new(Q16::from_f64(first).unwrap(), Q16::from_f64(arm + 0.1).unwrap()).unwrap();
        let fixed = twist::<Q16>(parts.map(|part| f64::from(part) / 50.0));
        let got = rounded.twist(&rounded.wheels(&fixed));
        let off = [got.forward_mps - fixed.forward_mps, got.left_mps - fixed.left_mps, got.turn_radps - fixed.turn_radps];
        prop_assert!(off.iter().all(|off| off.to_f64().abs() < 4e-3), "{off:?}");
    }

    #[test]
    fn saturation_slows_down_without_distortion(parts in any::<[i8; 3]>(), top in 0.1f64..3.0) {
        let wish = twist(parts.map(|part| f64::from(part) / 20.0));
        let kinematics = Omni::<f64, 4>::new(0.5, 0.2).unwrap();
        let mut mixer = Mixer::new(kinematics, at_once(top)).unwrap();
        let rims = mixer.mix(&wish, SPAN);
        prop_assert!(rims.iter().all(|rim| rim.abs() <= top));
        let got = mixer.kinematics().twist(&rims);
        let length = |t: &Twist<f64>| t.forward_mps.abs() + t.left_mps.abs() + t.turn_radps.abs();
        let factor = if length(&wish) > 0.0 { length(&got) / length(&wish) } else { 1.0 };
        prop_assert!(factor <= 1.0 + 1e-12);
        let slower = Twist {
            forward_mps: wish.forward_mps * factor,
            left_mps: wish.left_mps * factor,
            turn_radps: wish.turn_radps * factor,
        };
        prop_assert!(near(&got, &slower, 1e-9));
        let needed = kinematics.wheels(&wish).iter().fold(0.0f64, |a, b| a.max(b.abs()));
        prop_assert!(needed <= top || rims.iter().any(|rim| rim.abs() > top - 1e-9), "no slower than it must");
    }

    #[test]
    fn no_rim_exceeds_its_acceleration_for_any_bits(
        bits in proptest::collection::vec(any::<[u32; 3]>(), 1..20),
        spans in proptest::collection::vec(-100_000i32..100_000, 20),
    ) {
        let limits = Limits { speed_mps: 0.5f32, acceleration_mps2: 1.5 };
        let mut mixer = Mixer::new(Mecanum::new(0.2, 0.2).unwrap(), limits).unwrap();
        let mut before = [0.0f32; 4];
        for (bits, span) in bits.iter().zip(spans) {
            let [forward_mps, left_mps, turn_radps] = bits.map(f32::from_bits);
            let span = Duration::from_micros(span);
            let now = mixer.mix(&Twist { forward_mps, left_mps, turn_radps }, span);
            let most = 1.5 * span.as_micros().max(0) as f32 * 1e-6 + 1e-6;
            for (now, before) in now.iter().zip(before) {
                prop_assert!(now.abs() <= 0.5 && (now - before).abs() <= most);
            }
            before = now;
        }
    }

    #[test]
    fn mirrored_motions_mirror_the_wheels(v in any::<[i8; 2]>(), heading in -3.0f64..3.0) {
        let v = Vec2::new(f64::from(v[0]) / 100.0, f64::from(v[1]) / 100.0);
        let mirrored = Vec2::new(v.x, -v.y);
        let (ahead, two) = (LookAhead::new(0.1).unwrap(), Differential::new(0.2).unwrap());
        let [left, right] = two.wheels(&ahead.twist(v, heading));
        let [other_left, other_right] = two.wheels(&ahead.twist(mirrored, -heading));
        prop_assert!((left - other_right).abs() < 1e-12 && (right - other_left).abs() < 1e-12);
        let four = Mecanum::new(0.2, 0.2).unwrap();
        let [fl, fr, rl, rr] = four.wheels(&Twist::holonomic(v, heading, 0.3));
        let other = four.wheels(&Twist::holonomic(mirrored, -heading, -0.3));
        for (a, b) in [fr, fl, rr, rl].iter().zip(other) {
            prop_assert!((a - b).abs() < 1e-12);
        }
    }

    #[test]
    fn the_point_ahead_has_exactly_the_demanded_velocity(angle in -3.2f64..3.2, heading in -3.2f64..3.2, d in 0.03f64..0.5) {
        let ahead = LookAhead::new(d).unwrap();
        let speed = ahead.max_speed(0.6, 0.2);
        let (sin, cos) = Scalar::sin_cos(angle);
        let wish = Vec2::new(cos, sin) * speed;
        let mut mixer = Mixer::new(Differential::new(0.2).unwrap(), at_once(0.6)).unwrap();
        let rims = mixer.mix(&ahead.twist(wish, heading), SPAN);
        let body = mixer.kinematics().twist(&rims);
        let (sin, cos) = Scalar::sin_cos(heading);
        let axle = KinematicState {
            position: Position::ORIGIN,
            velocity_mps: Vec3::new(cos, sin, 0.0) * body.forward_mps,
        };
        let point = ahead.state(&axle, heading, body.turn_radps).velocity_mps.xy();
        prop_assert!((point - wish).norm() < 1e-9, "{point:?} {wish:?}");
    }

    #[test]
    fn a_holonomic_body_has_the_world_velocity_at_any_heading(v in any::<[i8; 2]>(), heading in -7.0f64..7.0) {
        let v = Vec2::new(f64::from(v[0]), f64::from(v[1]));
        let seen = Twist::holonomic(v, heading, 0.0);
        let (sin, cos) = Scalar::sin_cos(heading);
        let back = Vec2::new(seen.forward_mps, seen.left_mps).rotate(cos, sin);
        prop_assert!((back - v).norm() < 1e-9);
    }

    #[test]
    fn duties_grow_with_the_speed(a: u32, b: u32, dead in 0.0f32..0.9) {
        let (a, b) = (f32::from_bits(a).abs(), f32::from_bits(b).abs());
        prop_assume!(a < b && b.is_finite());
        let motor = Calibration { full_mps: 0.7, dead_duty: dead, still_mps: 0.02, is_inverted: false };
        prop_assert!(0 <= motor.duty(a) && motor.duty(a) <= motor.duty(b));
    }
}

mod pins {
    use super::*;
    use embedded_hal_mock::eh1::MockError;
    use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as PinStep};
    use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as PwmStep};
    use std::io::ErrorKind;
    use std::vec::Vec;

    fn failed() -> MockError {
        MockError::Io(ErrorKind::NotConnected)
    }

    fn pwm(max: u16, duties: &[u16]) -> Pwm {
        let steps = duties.iter().map(|duty| PwmStep::set_duty_cycle(*duty));
        let steps: Vec<_> = [PwmStep::max_duty_cycle(max)].into_iter().chain(steps).collect();
        Pwm::new(&steps)
    }

    #[test]
    fn power_is_off_while_the_direction_pin_changes() {
        for (duty, state, power) in [
            (FULL, State::High, 1000),
            (-FULL, State::Low, 1000),
            (i16::MIN, State::Low, 1000),
            (16384, State::High, 500),
            (0, State::High, 0),
        ] {
            let pin = Pin::new(&[PinStep::set(state)]);
            let mut motor = SignMagnitude::new(pwm(1000, &[0, power]), pin);
            motor.set(duty).unwrap();
            let (mut pwm, mut pin) = motor.release();
            pwm.done();
            pin.done();
        }
    }

    #[test]
    fn a_dead_direction_pin_leaves_the_motor_without_power() {
        let pin = Pin::new(&[PinStep::set(State::Low).with_error(failed())]);
        let mut motor = SignMagnitude::new(pwm(255, &[0]), pin);
        assert_eq!(motor.set(-1), Err(MotorError::Pin(failed())));
        let (mut pwm, mut pin) = motor.release();
        pwm.done();
        pin.done();
    }

    #[test]
    fn two_pins_encode_ahead_back_and_coast() {
        for (duty, ahead, back, power) in [
            (FULL, State::High, State::Low, u16::MAX),
            (-FULL, State::Low, State::High, u16::MAX),
            (0, State::Low, State::Low, 0),
        ] {
            let (mut a, mut b) = (Pin::new(&[PinStep::set(ahead)]), Pin::new(&[PinStep::set(back)]));
            let mut channel = pwm(u16::MAX, &[0, power]);
            let mut motor = TwoPins::new(channel.clone(), a.clone(), b.clone());
            motor.set(duty).unwrap();
            channel.done();
            a.done();
            b.done();
        }
    }

    #[test]
    fn the_idle_side_of_a_bridge_is_switched_off_first() {
        let idle = Pwm::new(&[PwmStep::set_duty_cycle(0)]);
        let mut motor = HBridge::new(idle, pwm(999, &[999]));
        motor.set(-FULL).unwrap();
        let (mut ahead, mut back) = motor.release();
        ahead.done();
        back.done();
        let idle = Pwm::new(&[PwmStep::set_duty_cycle(0).with_error(failed())]);
        let mut motor = HBridge::new(Pwm::new(&[]), idle);
        assert_eq!(motor.set(FULL), Err(failed()));
        let (mut ahead, mut back) = motor.release();
        ahead.done();
        back.done();
    }

    #[test]
    fn if_one_motor_fails_the_others_stop() {
        let steps = |steps: &[PwmStep]| Pwm::new(steps);
        let max = || PwmStep::max_duty_cycle(100);
        let set = PwmStep::set_duty_cycle;
        let left = HBridge::new(steps(&[max(), set(50), max(), set(0)]), steps(&[set(0), set(0)]));
        let broken = || steps(&[set(0).with_error(failed()), set(0).with_error(failed())]);
        let right = HBridge::new(steps(&[]), broken());
        let third = HBridge::new(steps(&[max(), set(0)]), steps(&[set(0)]));
        let linear = Calibration::linear(1.0f32);
        let mut wheels = Wheels::new([(left, linear), (right, linear), (third, linear)]);
        assert_eq!(wheels.turn(&[0.5, 0.5, 0.5]), Err(failed()));
        for motor in wheels.release() {
            let (mut ahead, mut back) = motor.release();
            ahead.done();
            back.done();
        }
    }
}
