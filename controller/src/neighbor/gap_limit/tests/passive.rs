//! A neighbour that does not give way: the own robot stands before the two can touch.

use super::*;
use crate::robot::Mode;

/// How the neighbour moves: straight on, or anywhere at up to 1 m/s within its acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Course {
    Straight,
    Hunting,
    Random(u32),
}

struct Scene {
    mode: Mode,
    /// Of the own robot and the neighbour, m/s^2.
    most: [f64; 2],
    apart_m: f64,
    course: Course,
    /// Steps in which the neighbour is heard.
    heard: fn(i32) -> bool,
}

impl Scene {
    /// The deepest overlap in steps in which the neighbour alone would not close the gap, metres.
    fn run<S: Scalar>(&self, wish: impl Fn(i32) -> Vec3<f64>) -> f64 {
        let [own_most, most] = self.most;
        let mut own = Mover::<S>::new(1, [0.0; 3], own_most);
        let mut other = Mover::<S>::new(2, [self.apart_m, 0.03, 0.0], most);
        if self.course == Course::Straight {
            other.body.velocity_mps = Vec3::new(-0.7, 0.0, 0.0).cast();
        }
        let mut deepest = 0.0_f64;
        let mut said = None;
        for step in 1..=120 {
            let heard = said.filter(|_| step == 2 || (self.heard)(step));
            let heard: StdVec<_> = heard.into_iter().collect();
            own = own.decide(step, if step == 1 { Vec3::ZERO } else { wish(step) }, &heard);
            let wish = match self.course {
                Course::Straight => other.body.velocity_mps.cast(),
                Course::Hunting => (own.at_m - other.at_m).normalized().unwrap_or(Vec3::ZERO),
                Course::Random(seed) => {
                    let angle = f64::from(Rng::keyed(1, seed, 0, (step / 4) as u32).below(6283)) / 1e3;
                    Vec3::new(libm::cos(angle), libm::sin(angle), 0.0)
                }
            };
            other.body.velocity_mps = other.body.reach(wish.cast());
            said = Some(Neighbor { mode: self.mode, ..other.news(step) });
            let [own_mps, other_mps] = [&own, &other].map(|mover| mover.body.velocity_mps.cast::<f64>());
            let offset_m = other.at_m - own.at_m;
            let approach_m = -other_mps.dot(offset_m.normalized().unwrap_or(Vec3::ZERO)) * 0.1;
            let left_m = offset_m.norm() - 2.0 * RADIUS_M - approach_m.max(0.0);
            own.at_m += own_mps * 0.1;
            other.at_m += other_mps * 0.1;
            if left_m >= 0.0 {
                deepest = deepest.min((other.at_m - own.at_m).norm() - 2.0 * RADIUS_M);
            }
        }
        deepest
    }
}

fn modes() -> impl Strategy<Value = Mode> {
    prop_oneof![Just(Mode::Fault), Just(Mode::Passive)]
}

fn courses() -> impl Strategy<Value = Course> {
    prop_oneof![Just(Course::Straight), Just(Course::Hunting), any::<u32>().prop_map(Course::Random)]
}

/// Any wishes, mostly towards the neighbour.
fn towards(seed: u32) -> impl Fn(i32) -> Vec3<f64> {
    move |step| wishes(seed, 0.0, 2)(step, 1)
}

proptest! {
    /// An up-to-date state says what the neighbour does in the next step, if it drives straight on.
    #[test]
    fn no_robot_runs_into_a_passive_one_that_is_heard(
        seed in any::<u32>(), mode in modes(), apart_m in 0.4..3.0_f64,
        most in prop_oneof![Just(f64::MAX), 1.0..4.0_f64],
        other_most in 0.3..4.0_f64,
    ) {
        let scene = Scene { mode, most: [most, other_most], apart_m, course: Course::Straight, heard: |_| true };
        let deepest = scene.run::<f64>(towards(seed));
        prop_assert!(deepest > -5e-3, "{}", deepest);
        let deepest = scene.run::<Q16>(towards(seed));
        prop_assert!(deepest > -5e-3, "fixed: {}", deepest);
    }

    /// Without inertia the ball of a silent neighbour contains every course at 1 m/s.
    #[test]
    fn no_robot_runs_into_a_silent_passive_one(
        seed in any::<u32>(), mode in modes(), apart_m in 0.4..6.0_f64, course in courses(),
    ) {
        let scene = Scene { mode, most: [f64::MAX; 2], apart_m, course, heard: |_| false };
        let deepest = scene.run::<f64>(towards(seed));
        prop_assert!(deepest > -1e-4, "{}", deepest);
        let deepest = scene.run::<Q16>(towards(seed));
        prop_assert!(deepest > -1e-3, "fixed: {}", deepest);
    }

    /// The ball of a silent body grows by the own acceleration: the neighbour's is not known.
    #[test]
    fn no_robot_with_inertia_runs_into_a_silent_one_that_is_not_more_agile(
        seed in any::<u32>(), mode in modes(), apart_m in 0.6..6.0_f64, course in courses(), most in 0.5..4.0_f64,
        share in 0.1..1.0_f64,
    ) {
        let scene = Scene { mode, most: [most, most * share], apart_m, course, heard: |_| false };
        let deepest = scene.run::<f64>(towards(seed));
        prop_assert!(deepest > -5e-3, "{}", deepest);
    }
}

/// The speed of a robot that wishes to drive east at 1 m/s, from 0.5 m/s. The neighbour is
/// `apart_m` east of it, drives at `mps` and was last heard `age` steps ago.
fn follows(mode: Mode, (apart_m, mps): (f64, f64), most: f64, age: i32) -> f64 {
    let mut own = Mover::<f64>::new(1, [0.0; 3], most);
    own.body.velocity_mps = Vec3::new(0.5, 0.0, 0.0);
    let mut other = Mover::<f64>::new(2, [apart_m, 0.0, 0.0], most);
    other.body.velocity_mps = Vec3::new(mps, 0.0, 0.0);
    let news = Neighbor { mode, ..other.news(0) };
    own.decide(age, Vec3::new(1.0, 0.0, 0.0), &[news]).body.velocity_mps.x
}

#[test]
fn a_robot_uses_the_whole_gap_to_a_passive_one() {
    let (parked, still) = (Mode::Hold, Mode::Fault);
    for (mode, apart_m, mps, wanted) in [
        // Of a gap of 0.197 m, half in a step of 0.1 s, or all of it.
        (parked, 0.5, 0.0, 0.985),
        (still, 0.5, 0.0, 1.0),
        // It comes by 0.07 m up to now, and by as much in the step: 0.057 m are left.
        (still, 0.5, -0.7, 0.57),
    ] {
        let got = follows(mode, (apart_m, mps), f64::MAX, 1);
        assert!((got - wanted).abs() < 2e-3, "{mode:?} {mps}: {got}");
    }
}

/// Bodies of 2 m/s^2, which brake from 1 m/s for 0.5 s: the gap must last for the step and for half
/// of that.
#[test]
fn a_robot_brakes_for_the_approach_of_the_other() {
    // A neighbour that leaves needs no way to stand: half of 0.297 m.
    let got = follows(Mode::Hold, (0.5, 1.0), 2.0, 1);
    assert!((got - 0.1485 / 0.35).abs() < 2e-3, "{got}");
    // Silent for 0.3 s, it may be 0.12 m nearer, and come at 0.8 m/s while the own body brakes.
    let got = follows(Mode::Fault, (1.05, 0.0), 2.0, 4);
    assert!((got - (0.627 - 0.8 * 0.6) / 0.35).abs() < 2e-3, "{got}");
}
