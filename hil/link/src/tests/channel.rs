mod bench;
mod world;

use self::bench::{Bench, Faults, LIMITS};
use self::world::{World, inbox};
use super::{in_plane, on_grid};
use crate::frame::VERSION;
use crate::message::{StepInputs, StepResult};
use crate::port::{Asked, Event, Limits, Next, Port, PortError};
use crate::robot::{Controller, Large, Robot, Small};
use crate::surroundings::{PackedSurroundings, pack};
use proptest::prelude::*;
use staya_controller::agent::*;
use staya_controller::geom::{Position, Vec2};
use staya_controller::obstacle::Obstacle;
use staya_controller::time::Instant;
use staya_controller::wire::Postcard;
use staya_mavlink::any::AnyWire;
use std::vec::Vec;

fn decide(controller: &mut impl Controller, step: &StepInputs<'_>) -> StepResult {
    controller.step(step).expect("fits");
    controller.result().expect("a robot")
}

/// Compares a thousand steps with a controller without a line.
fn thousand_steps<B: Controller + Default>(
    faults: Faults,
    seed: u64,
    (setup, task): (&Setup, Option<&Task>),
    mut plain: impl FnMut(&AnyInputs<'_, f32>, &StepInputs<'_>) -> (Command<f32>, u64),
) -> Bench<B> {
    let mut bench = Bench::<B>::new(faults, seed);
    bench.configure(setup, task);
    let mut world = World::START;
    let mut moved = false;
    for tick in 0..1000 {
        let scene = world.scene(tick);
        let plane = matches!(setup.law, LawSettings::Waypoint(_));
        let inputs = scene.inputs(&world, plane);
        let capacities = Large::new().capacities();
        let capacities = crate::capacities::Capacities { inbox_bytes: 1024, ..capacities };
        let mut packed = [0; 64];
        let (step, _) =
            capacities.fit(tick, scene.now, &inputs, &<AnyWire>::new(setup.format), &mut packed).expect("fits");
        let result = bench.step(&step).expect("no reset");
        let (command, digest) = plain(&inputs, &step);
        assert_eq!(result.outputs.command, command, "step {tick}");
        assert_eq!(result.digest, digest, "step {tick}");
        let before = (world.position, world.cell);
        world.follow(&command);
        moved |= before != (world.position, world.cell);
    }
    assert!(moved, "a robot that stands proves little");
    bench
}

const BAD: Faults = Faults { lost: 10, repeated: 10, flipped: 10, cut: 5, delay_us: 50_000 };

fn to_the_east() -> Task {
    let waypoint = Waypoint::fixed(Position::from_mm([30_000, 500, 0]));
    Task::Waypoints([(0, waypoint)].into_iter().collect())
}

#[test]
fn steps_over_a_faulty_line_equal_those_of_a_local_agent() {
    let (setup, task) = (in_plane(), to_the_east());
    let (on_grid, to_a_cell) = on_grid(5);
    for (setup, task) in [(setup, task), (on_grid, to_a_cell)] {
        for (faults, seed) in [(Faults::default(), 1), (BAD, 2), (BAD, 3)] {
            let agent: Option<AnyAgent<f32, CELLS, VISITS, NEIGHBORS, HALF_PLANES, Postcard, LEARNED>> = setup.agent();
            let mut agent = agent.expect("postcard");
            agent.assign(&task).expect("a task for it");
            let mut workspace = GridWorkspace::new();
            let bench = thousand_steps::<Large>(faults, seed, (&setup, Some(&task)), |inputs, step| {
                let out = agent.step(inputs, step.now, &mut workspace);
                (out.command, agent.digest())
            });
            let (host, device) = (bench.port.counts(), bench.session.counts());
            assert_eq!(device.steps, 1000);
            if faults.lost == 0 {
                // The first greeting crosses the device's own hello.
                assert_eq!((host.resent, host.damaged, device.damaged), (1, 0, 0));
            } else {
                assert!(host.resent > 100 && host.damaged > 20 && host.stale > 20, "{host:?}");
                let seen = [device.repeated, device.stale, device.damaged];
                assert!(seen.iter().all(|count| *count > 20), "{device:?}");
            }
        }
    }
}

#[test]
fn fixed_point_steps_over_a_faulty_line_equal_those_of_the_shadow() {
    let (setup, task) = (in_plane(), to_the_east());
    let mut shadow = Small::new();
    shadow.configure(&setup, Some(&task), &[]).expect("fits");
    thousand_steps::<Small>(BAD, 4, (&setup, Some(&task)), |_, step| {
        let result = decide(&mut shadow, step);
        (result.outputs.command, result.digest)
    });
}

#[test]
fn reset_of_the_device_is_detected_and_it_rejoins() {
    let (setup, task) = (in_plane(), to_the_east());
    for (faults, by_host) in [(Faults::default(), false), (BAD, false), (Faults::default(), true), (BAD, true)] {
        let mut bench = Bench::<Large>::new(faults, 5);
        bench.configure(&setup, Some(&task));
        let (mut resets, mut done) = (0, 0);
        let mut shadow = Large::new();
        shadow.configure(&setup, Some(&task), &[]).expect("fits");
        for tick in 0..300 {
            let inbox = inbox(tick);
            let packed = pack(&Obstacle::Wall([Vec2::new(9.0, 1.0), Vec2::new(9.0, -1.0)]));
            let step = StepInputs {
                tick,
                now: Instant::from_micros(tick * 100_000),
                state: KinematicState::default(),
                cell: None,
                window: None,
                surroundings: Some(PackedSurroundings { max_speed_mps: 1.0, in_cell: None, obstacles: &packed }),
                inbox: &inbox,
            };
            if tick % 100 == 50 {
                if by_host {
                    bench.port.restart(bench.now);
                    assert_eq!(bench.wait(), Ok(Event::Restarted));
                    assert!(bench.boot > 1 && bench.session.controller().agent().is_none());
                } else {
                    bench.reset();
                    assert_eq!(bench.step(&step), None, "step {tick}: a reset does not answer");
                }
                resets += 1;
                let mut again = setup.clone();
                again.agent.boot = resets;
                let digest = bench.configure(&again, Some(&task));
                assert_eq!(shadow.configure(&again, Some(&task), &[]), Ok(digest));
                continue;
            }
            let result = bench.step(&step).expect("no reset");
            assert!(result.is_identical(&decide(&mut shadow, &step)), "step {tick}");
            done += 1;
        }
        assert_eq!((resets, done), (3, 297));
    }
}

fn nothing_new(tick: u32) -> StepInputs<'static> {
    StepInputs {
        tick,
        now: Instant::from_micros(tick * 100_000),
        state: KinematicState::default(),
        cell: Some(CellState::default()),
        window: None,
        surroundings: None,
        inbox: &[],
    }
}

fn median_and_p99(faults: Faults, seed: u64) -> (u64, u64) {
    let mut bench = Bench::<Large>::new(Faults { lost: 0, ..faults }, seed);
    bench.port.set_limits(Limits { resend_after_us: 500_000, give_up_after_us: 10_000_000 });
    bench.configure(&in_plane(), None);
    (bench.there.faults, bench.back.faults) = (faults, faults);
    let mut took_us: Vec<u64> = (0..2000)
        .map(|tick| {
            let since = bench.now;
            bench.step(&nothing_new(tick)).expect("no reset");
            bench.now - since
        })
        .collect();
    took_us.sort_unstable();
    (took_us[999], took_us[1979])
}

/// One step in a hundred is sent three times.
#[test]
fn lost_frame_costs_round_trips_and_not_the_longest_wait() {
    for delay_us in [1, 2000, 20_000] {
        for seed in 0..3 {
            let lossy = Faults { lost: 5, delay_us, ..Faults::default() };
            let (median_us, p99_us) = median_and_p99(lossy, seed);
            // The host polls at most once a millisecond.
            assert!(p99_us <= 3100 + 11 * median_us, "delay {delay_us}: {median_us} {p99_us}");
            let (_, most_us) = median_and_p99(Faults { lost: 0, ..lossy }, seed);
            assert!(most_us <= 2 * (100 + u64::from(delay_us)), "nothing waits without a loss: {most_us}");
        }
    }
}

#[test]
fn silent_device_times_out_with_the_request_and_the_waiting_time() {
    let deaf = Faults { lost: 100, ..Faults::default() };
    let mut bench = Bench::<Small>::new(deaf, 1);
    bench.port.greet(0);
    let error = bench.wait().expect_err("no device");
    let (asked, waited_us) = (Asked::Hello, LIMITS.give_up_after_us);
    assert_eq!(error, PortError::Silent { asked, attempts: 60, waited_us });
    assert_eq!(std::format!("{error}"), "no answer to greeting within 1200 ms (60 attempts)");
    assert_eq!(bench.port.poll(bench.now), Ok(Next::Idle));
    let mut bench = Bench::<Small>::new(Faults::default(), 1);
    bench.configure(&in_plane(), None);
    bench.there.faults = deaf;
    bench.port.step(&nothing_new(77), bench.now).expect("fits");
    let error = bench.wait().expect_err("cut off");
    assert_eq!(std::format!("{error}"), "no answer to step 77 within 1200 ms (60 attempts)");
}

#[test]
fn device_of_another_version_is_reported() {
    let mut bench = Bench::<Small>::new(Faults::default(), 1);
    let other = VERSION + 1;
    let mut content = std::vec![other, 0x81, 1, 2];
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI).checksum(&content);
    content.extend(crc.to_le_bytes());
    let mut foreign = cobs::encode_vec(&content);
    foreign.push(0);
    bench.port.greet(0);
    bench.back.on_the_way.clear();
    bench.back.send(&foreign, 0);
    let error = bench.wait().expect_err("another version");
    assert_eq!(error, PortError::Version { device: other });
    let versions = std::format!("version {other} of the link, this host version {VERSION}:");
    assert!(std::format!("{error}").contains(&versions));
}

#[test]
fn refusal_names_the_request_and_the_reason() {
    let mut bench = Bench::<Small>::new(Faults::default(), 1);
    bench.port.greet(0);
    assert!(matches!(bench.wait(), Ok(Event::Hello(_))));
    let (setup, task) = on_grid(9);
    bench.port.configure(&setup, Some(&task), &[], bench.now).expect("fits");
    let error = bench.wait().expect_err("too far");
    let text = std::format!("{error}");
    assert_eq!(text, "the device answers to setup: Capacity: a search of 441 cells, and room for 169");
    let panic = crate::session::fault_frame(crate::message::FaultKind::Panic, "at main.rs:3");
    bench.port.configure(&setup, None, &[], bench.now).expect("fits");
    let mut errors = Vec::new();
    for byte in panic.bytes() {
        errors.extend(bench.port.receive(*byte, 0).err());
    }
    assert_eq!(std::format!("{}", errors[0]), "the device answers to setup: Panic: at main.rs:3");
}

#[test]
fn requests_longer_than_the_buffer_are_not_sent() {
    let mut port = Port::<64>::new(1, LIMITS);
    assert!(port.configure(&in_plane(), None, &[], 0).is_err());
    assert_eq!(port.poll(0), Ok(Next::Idle));
}

proptest! {
    #[test]
    fn line_faults_change_no_result(
        seed: u64,
        lost in 0_u32..40,
        repeated in 0_u32..60,
        flipped in 0_u32..30,
        cut in 0_u32..20,
        delay_us in 0_u32..100_000,
    ) {
        let faults = Faults { lost, repeated, flipped, cut, delay_us };
        let (setup, task) = (in_plane(), to_the_east());
        let mut bench = Bench::<Large>::new(faults, seed);
        let mut shadow: Robot<f32, CELLS, VISITS, NEIGHBORS, HALF_PLANES, 32, AnyWire> = Robot::new();
        let digest = bench.configure(&setup, Some(&task));
        prop_assert_eq!(shadow.configure(&setup, Some(&task), &[]), Ok(digest));
        for tick in 0..20 {
            let now = Instant::from_micros(tick * 100_000);
            let inbox = inbox(tick);
            let surroundings = Some(PackedSurroundings { max_speed_mps: 1.0, in_cell: None, obstacles: &[] });
            let step = StepInputs {
                tick, now, state: KinematicState::default(), cell: None, window: None, surroundings, inbox: &inbox,
            };
            let result = bench.step(&step).expect("no reset");
            prop_assert!(result.is_identical(&decide(&mut shadow, &step)));
        }
    }
}
