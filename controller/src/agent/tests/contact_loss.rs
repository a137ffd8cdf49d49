//! Tests of radios that lose packets or fail, and of silent robots.

use super::plane::{Robot, STEP, in_plane, length, one_step_late, orca, place, step_number, waypoint};
use super::*;
use crate::neighbor::{PlausibilityLimits, StalenessInflation, Trace};
use crate::orca::AvoidParams;
use crate::rand::Rng;
use crate::scalar::Q16;
use crate::wire::{LostRobot, Message};

pub(super) type Mover<S> = Robot<S, WaypointGuidance<S>, OrcaSafety<S, 16>>;

/// Growth of 1 m/s, the speed of [`Robot`].
pub(super) fn safety<S: Scalar>() -> OrcaSafety<S, 16> {
    OrcaSafety::new(AvoidParams::default(), StalenessInflation { growth_mps: S::ONE, max_m: S::from_milli(200) })
}

fn circle<S: Scalar>(count: u32, seed: u32) -> Vec<Mover<S>> {
    let mover = |i: u32| {
        let mut rng = Rng::keyed(9, 9, seed, i);
        let angle = (f64::from(i) + f64::from(rng.below(20)) / 100.0) / f64::from(count) * core::f64::consts::TAU;
        let at_m = [2.0 * libm::cos(angle), 2.0 * libm::sin(angle)];
        let mut robot = Robot::new(&one_step_late(i + 1), waypoint(), safety(), at_m);
        let _ = robot.agent.order(&WaypointOrder::first(place(-(at_m[0] * 1e3) as i32, -(at_m[1] * 1e3) as i32)));
        robot
    };
    (0..count).map(mover).collect()
}

/// Runs until all have arrived. Returns the least gap and whether all arrived.
pub(super) fn run<S: Scalar>(
    robots: &mut [Mover<S>],
    steps: i32,
    mut is_lost: impl FnMut(i32, usize, usize) -> bool,
) -> (f64, bool) {
    let mut said = vec![Vec::new(); robots.len()];
    let mut least = f64::INFINITY;
    for n in 0..steps {
        let heard: Vec<Vec<u8>> = (0..robots.len())
            .map(|to| {
                let others = (0..said.len()).filter(|&from| from != to);
                let others: Vec<usize> = others.filter(|&from| !is_lost(n, from, to)).collect();
                others.into_iter().flat_map(|from| said[from].clone()).collect()
            })
            .collect();
        said = robots
            .iter_mut()
            .zip(&heard)
            .map(|(robot, inbox)| robot.step(step_number(n), inbox).outbox.to_vec())
            .collect();
        for (i, one) in robots.iter().enumerate() {
            for other in &robots[..i] {
                least = least.min(length([one.at_m[0] - other.at_m[0], one.at_m[1] - other.at_m[1]]) - 0.4);
            }
        }
        if robots.iter().all(|robot| robot.agent.mode() == Mode::Arrived) {
            return (least, true);
        }
    }
    (least, false)
}

#[test]
fn no_robots_touch_during_radio_outages() {
    fn check<S: Scalar>() {
        for (from, lasts) in [(8, 20), (16, 20), (24, 20), (12, 900), (20, 900)] {
            let mut robots = circle::<S>(6, from as u32);
            let ends = from + lasts;
            let (least, have_arrived) = run(&mut robots, ends + 1500, |n, _, _| (from..ends).contains(&n));
            assert!(least > -1e-3, "dead from step {from} for {lasts}: {least} m");
            assert!(have_arrived, "dead from step {from} for {lasts}");
        }
    }
    check::<f32>();
    check::<Q16>();
}

#[test]
fn no_robots_touch_at_up_to_30_percent_packet_loss() {
    fn check<S: Scalar>() {
        for loss in [1, 3] {
            for seed in 0..4 {
                let is_lost = |n: i32, from: usize, to: usize| {
                    Rng::keyed(seed.into(), 1, (from * 64 + to) as u32, n as u32).below(10) < loss
                };
                let (least, have_arrived) = run(&mut circle::<S>(6, seed), 600, is_lost);
                assert!(least > -1e-3 && have_arrived, "{loss} of 10, seed {seed}: {least} m");
            }
        }
    }
    check::<f32>();
    check::<Q16>();
}

/// At 1 m/s and ten steps per second a step is half a radius.
#[test]
fn no_robots_touch_in_a_crowd_with_long_steps() {
    for seed in 0..3 {
        let (least, have_arrived) = run(&mut circle::<f32>(10, seed), 900, |_, _, _| false);
        assert!(least > -1e-3 && have_arrived, "seed {seed}: {least} m");
    }
}

#[test]
fn a_dead_robot_in_the_way_is_remembered_and_avoided() {
    fn check<S: Scalar>() {
        let mover = |id, at_m: [f64; 2], to_mm: [i32; 2]| {
            let mut robot: Mover<S> = Robot::new(&one_step_late(id), waypoint(), safety(), at_m);
            let _ = robot.agent.order(&WaypointOrder::first(place(to_mm[0], to_mm[1])));
            robot
        };
        // The third robot keeps the first one in contact.
        let mut robots = vec![
            mover(1, [-8.0, 0.02], [8000, 20]),
            mover(2, [0.0, 0.0], [0, 0]),
            mover(3, [-4.0, 7.0], [-4000, 7000]),
        ];
        // The dead robot is lost after 3 s; the moving one is there after 8 s.
        let (least, have_arrived) = run(&mut robots, 400, |n, from, to| n >= 10 && (from == 1 || to == 1));
        assert!(least > 0.0 && have_arrived, "{least} m");
    }
    check::<f32>();
    check::<Q16>();
}

const DEFAULT: ContactLossPolicy<f32> = ContactLossPolicy { listen: Duration::ZERO, ..ContactLossPolicy::DEFAULT };

#[test]
fn a_robot_listens_before_it_moves() {
    let contact_loss = ContactLossPolicy { listen: STEP.saturating_mul(3), ..DEFAULT };
    let config = AgentConfig { contact_loss, ..in_plane(1) };
    let mut robot = Robot::new(&config, waypoint::<f32>(), orca(), [0.0; 2]);
    let _ = robot.agent.order(&WaypointOrder::first(place(90_000, 0)));
    for n in 0..6 {
        let wait = robot.step(step_number(n), &[]).wait;
        assert_eq!((length(robot.velocity_mps) > 0.0, wait), (n > 2, (n <= 2).then_some(Wait::Radio)), "step {n}");
    }
}

/// News of lost robots are limited as the own values of a sender are.
#[test]
fn a_lost_robot_that_was_told_is_a_ball_within_the_limits() {
    let plausibility = PlausibilityLimits { max_radius_m: 0.5, last: RobotId(20), ..PlausibilityLimits::<f32>::ANY };
    let mut robot = Robot::new(&AgentConfig { plausibility, ..in_plane(1) }, waypoint::<f32>(), orca(), [0.0; 2]);
    let told = |id: u32, x_mm: i32, radius_mm: u16| {
        let position_mm = [x_mm, 100, 0];
        Message::Lost(LostRobot { id: RobotId(id), is_lost: true, age_cs: 50, position_mm, radius_mm })
    };
    let messages = [told(20, 5000, 200), told(21, 5000, 200), told(0, 5000, 200), told(4, 7000, 900)];
    let _ = robot.step(step_number(100), &bytes(2, 0, 0, &messages));
    let lost: Vec<_> = robot.agent.link.table.lost().iter().collect();
    assert_eq!(lost.iter().map(|lost| lost.id.0).collect::<Vec<_>>(), [4, 20]);
    assert_eq!(lost.iter().map(|lost| lost.position.mm).collect::<Vec<_>>(), [[7000, 100, 0], [5000, 100, 0]]);
    assert_eq!(lost.iter().map(|lost| lost.radius_m).collect::<Vec<_>>(), [0.5, 0.2]);
    let age = lost[0].age(step_number(100)).map(Duration::as_micros);
    assert_eq!((age, lost[0].mode, lost[0].trace), (Some(500_000), Mode::Fault, Trace::Lost));
    // A state that is newer by a hundredth of a second or less is the same one.
    let mut place = |age_cs: u16, sequence: u16| {
        let newer = LostRobot { id: RobotId(4), is_lost: true, age_cs, position_mm: [9000, 100, 0], radius_mm: 200 };
        let _ = robot.step(step_number(100), &bytes(2, 0, sequence, &[Message::Lost(newer)]));
        robot.agent.link.table.lost()[0].position.mm[0]
    };
    assert_eq!([place(51, 10), place(49, 11), place(48, 12)], [7000, 7000, 9000]);
}

/// Beacons every half second, and a lag of 0.3 s: a robot of 1 m/s that falls silent may have
/// driven on for 0.8 m.
#[test]
fn a_robot_may_have_driven_on_for_a_beacon_period_and_the_lag() {
    let config = AgentConfig { beacon_period: STEP.saturating_mul(5), lag_s: 0.3, ..in_plane(1) };
    let mut robot = Robot::new(&config, waypoint::<f32>(), orca(), [0.0; 2]);
    let inbox = bytes(2, 0, 0, &[super::plane::body_at([-9000, 0], [1000, 0], Mode::Cruise)]);
    for n in 0..40 {
        let _ = robot.step(step_number(n), if n == 0 { &inbox } else { &[] });
    }
    let [lost] = robot.agent.link.table.lost() else { panic!("lost") };
    assert_eq!((lost.position.mm[0], lost.radius_m.to_milli()), (-8600, Some(600)));
}

/// Six seconds of silence. Returns speed, mode, and whether a loss was reported.
fn left_alone(hears: bool, silence: ContactLossPolicy<f32>) -> (f64, Mode, bool) {
    let config = AgentConfig { contact_loss: silence, ..in_plane(1) };
    let mut robot = Robot::new(&config, waypoint::<f32>(), orca(), [0.0; 2]);
    let _ = robot.agent.order(&WaypointOrder::first(place(90_000, 0)));
    let inbox = bytes(2, 0, 0, &[super::plane::body_at([-60_000, 0], [0, 0], Mode::Idle)]);
    let mut is_told = false;
    for n in 0..60 {
        let out = robot.step(step_number(n), if n == 0 && hears { &inbox } else { &[] });
        is_told |= out.events.contains(&Event::ContactLost);
    }
    (libm::round(1e6 * length(robot.velocity_mps)) / 1e6, robot.agent.mode(), is_told)
}

#[test]
fn a_robot_without_contact_stands_unless_it_may_be_alone() {
    let after = |alone_mps| ContactLossPolicy { stands_after: STEP.saturating_mul(50), alone_mps, ..DEFAULT };
    assert_eq!(left_alone(true, DEFAULT), (1.0, Mode::Cruise, true), "a minute is not over");
    assert_eq!(left_alone(true, after(0.0)), (0.0, Mode::Hold, true));
    assert_eq!(left_alone(true, after(0.25)), (0.25, Mode::Cruise, true));
    assert_eq!(left_alone(true, after(f32::MAX)), (1.0, Mode::Cruise, true));
    assert_eq!(
        left_alone(false, after(0.0)),
        (1.0, Mode::Cruise, false),
        "a robot that never heard another one is the first"
    );
    let expecting = ContactLossPolicy { expects_others: true, ..DEFAULT };
    assert_eq!(left_alone(false, expecting), (0.0, Mode::Hold, false), "others exist");
    assert_eq!(left_alone(true, expecting), (1.0, Mode::Cruise, true));
}

#[test]
fn a_robot_continues_when_contact_is_restored() {
    let silence = ContactLossPolicy { stands_after: STEP.saturating_mul(40), ..DEFAULT };
    let mut robot =
        Robot::new(&AgentConfig { contact_loss: silence, ..in_plane(1) }, waypoint::<f32>(), orca(), [0.0; 2]);
    let _ = robot.agent.order(&WaypointOrder::first(place(90_000, 0)));
    for n in 0..60 {
        let far = super::plane::body_at([-60_000, 0], [0, 0], Mode::Idle);
        let inbox = bytes(2, 0, n as u16, &[far]);
        let _ = robot.step(step_number(n), if n == 0 || n == 55 { &inbox } else { &[] });
        let goes = !(41..55).contains(&n);
        assert_eq!(length(robot.velocity_mps) > 0.9, goes, "step {n}");
    }
}
