//! A fleet whose devices are threads of this process.

mod common;

use common::{Mischief, Scene, config, device, live, now};
use serialport::SerialPort;
use staya_controller::agent::{Setup, Task};
use staya_controller::scalar::NumberFormat;
use staya_controller::wire::Format;
use staya_link::capacities::Capacities;
use staya_link::message::{StepInputs, StepResult};
use staya_link::refusal::Refusal;
use staya_link::robot::{Controller, LARGE_INBOX, Large, SMALL_INBOX, Small};
use staya_link::session::content_bytes;
use staya_runner::{Answer, Cause, Channel, DeviceConfig, Fleet, LineFaults, Options, Reset};
use std::sync::atomic::Ordering;
use std::time::Duration;

const LARGE: usize = content_bytes(169, 32, LARGE_INBOX);
const SMALL: usize = content_bytes(169, 16, SMALL_INBOX);

fn large(mischief: Mischief) -> Channel {
    device::<Large, LARGE>(Large::new, "stm32f405", mischief)
}

fn small(mischief: Mischief) -> Channel {
    device::<Small, SMALL>(Small::new, "nrf51", mischief)
}

fn options() -> Options {
    Options { resend_after: Duration::from_millis(20), ..Options::new("nowhere".into()) }
}

fn one(config: DeviceConfig, channel: Channel) -> Fleet {
    Fleet::over(vec![(config, channel)], options()).expect("it starts")
}

fn four(change: impl Fn(&mut DeviceConfig)) -> Fleet {
    let lines = (1..=4).map(|robot| {
        let mut config = config(robot, "thread");
        change(&mut config);
        let well = Mischief::default();
        (config, if robot <= 2 { large(well) } else { small(well) })
    });
    Fleet::over(lines.collect(), options()).expect("they start")
}

fn tick(fleet: &mut Fleet, tick: u32) -> Vec<Answer> {
    for index in 0..fleet.len() {
        let scene = Scene::new(index as u32 + 1, tick);
        fleet.send(index, tick, now(tick), &scene.inputs());
    }
    fleet.collect()
}

fn decided(answer: Answer) -> StepResult {
    match answer {
        Answer::Decided(result) => *result,
        other => panic!("{other:?}"),
    }
}

fn run(fleet: &mut Fleet, ticks: u32) -> Vec<Vec<u64>> {
    let digests = |t| {
        let answers = tick(fleet, t);
        assert_eq!(answers.len(), fleet.len());
        answers.into_iter().map(|answer| decided(answer).digest).collect()
    };
    (0..ticks).map(digests).collect()
}

#[test]
fn devices_of_two_kinds_decide_like_their_shadows_and_are_counted() {
    let mut fleet = four(|_| {});
    run(&mut fleet, 200);
    for (statistics, robot) in fleet.statistics().into_iter().zip(1..) {
        assert_eq!((statistics.robot, statistics.steps), (robot, 200));
        assert_eq!((statistics.mismatches, statistics.resets), (0, 0));
        let part = if robot <= 2 { "stm32f405" } else { "nrf51" };
        assert_eq!((statistics.part.as_str(), statistics.firmware.as_str()), (part, "a thread"));
        let round_trip = statistics.round_trip_us.expect("200 of them");
        assert!(round_trip.median <= round_trip.p99 && round_trip.p99 <= round_trip.max);
        assert!(statistics.sent_bytes > 200 * 100 && statistics.received_bytes > 200 * 50);
        assert_eq!(statistics.instructions, None, "a thread is not an emulator");
    }
}

/// Pseudo-terminals replace the board's port.
#[test]
fn robot_behind_a_serial_port_decides_like_its_shadow() {
    let (board, port) = serialport::TTYPort::pair().expect("pseudo-terminals");
    let device = format!("serial:{},baud=1000000", port.name().expect("a path"));
    let mut configs = vec![config(1, &device)];
    configs[0].resets = vec![Reset { tick: 20, down_ticks: 2 }];
    std::thread::spawn(|| {
        live::<Large, LARGE>(Large::new, "stm32f405", Mischief::default(), board);
    });
    let mut fleet = Fleet::start(configs, options()).expect("it starts");
    drop(port);
    let mut down = 0;
    for t in 0..50 {
        match tick(&mut fleet, t).pop().expect("one") {
            Answer::Down => down += 1,
            answer => drop(decided(answer)),
        }
    }
    assert_eq!(down, 2);
    let statistics = &fleet.statistics()[0];
    assert_eq!((statistics.steps, statistics.mismatches), (48, 0));
    assert_eq!(statistics.device, device);
}

#[test]
fn line_faults_change_no_decision() {
    let clean = run(&mut four(|_| {}), 100);
    let mut fleet = four(|config| {
        config.faults = LineFaults { loss: 0.1, bit_errors: 2e-5, delay: Duration::from_micros(300), seed: 5 };
    });
    assert_eq!(run(&mut fleet, 100), clean);
    let resent: u64 = fleet.statistics().iter().map(|s| s.resent).sum();
    let damaged: u64 = fleet.statistics().iter().map(|s| s.damaged).sum();
    assert!(resent > 40 && damaged > 4, "{resent} {damaged}");
}

#[test]
fn scheduled_reset_takes_the_given_number_of_steps_and_the_robot_rejoins() {
    let reset = |tick, down_ticks| Reset { tick, down_ticks };
    let runs: Vec<_> = (0..2)
        .map(|_| {
            let mut fleet = four(|config| {
                if config.setup.agent.id.0.is_multiple_of(2) {
                    config.resets = vec![reset(10, 3), reset(20, 1)];
                }
            });
            let mut digests = Vec::new();
            for t in 0..40 {
                for (index, answer) in tick(&mut fleet, t).into_iter().enumerate() {
                    let is_down = matches!(t, 10..=12 | 20) && index % 2 == 1;
                    match answer {
                        Answer::Down => assert!(is_down, "robot {} at {t}", index + 1),
                        answer => {
                            assert!(!is_down, "robot {} at {t}", index + 1);
                            digests.push(decided(answer).digest);
                        }
                    }
                }
            }
            let resets: Vec<u64> = fleet.statistics().iter().map(|s| s.resets).collect();
            assert_eq!(resets, [0, 2, 0, 2]);
            digests
        })
        .collect();
    assert_eq!(runs[0], runs[1], "runs repeat");
}

#[test]
fn device_that_resets_by_itself_is_down_for_a_step_and_rejoins() {
    let mischief = Mischief { resets_at: Some(30), ..Mischief::default() };
    let mut fleet = one(config(1, "thread"), large(mischief));
    let mut down = Vec::new();
    for t in 0..60 {
        match tick(&mut fleet, t).pop().expect("one") {
            Answer::Down => down.push(t),
            answer => drop(decided(answer)),
        }
    }
    // Step 30 finds the device without its state.
    assert_eq!(down, [30]);
    let statistics = &fleet.statistics()[0];
    assert_eq!((statistics.resets, statistics.steps), (1, 59));
}

/// A device that computes wrongly from its fiftieth step on.
struct Wrong {
    controller: Large,
    steps: u32,
}

impl Controller for Wrong {
    fn number(&self) -> NumberFormat {
        self.controller.number()
    }

    fn capacities(&self) -> Capacities {
        self.controller.capacities()
    }

    fn configure(&mut self, setup: &Setup, task: Option<&Task>, law: &[u8]) -> Result<u64, Refusal> {
        self.controller.configure(setup, task, law)
    }

    fn step(&mut self, inputs: &StepInputs<'_>) -> Result<(), Refusal> {
        self.steps += 1;
        self.controller.step(inputs)
    }

    fn result(&self) -> Option<StepResult> {
        let mut result = self.controller.result()?;
        if self.steps >= 50 {
            result.digest ^= 1;
            result.outputs.received += 1;
        }
        Some(result)
    }

    fn forget(&mut self) {
        self.controller.forget();
    }
}

#[test]
fn first_difference_is_found_and_both_results_are_printed() {
    let new = || Wrong { controller: Large::new(), steps: 0 };
    let channel = device::<Wrong, LARGE>(new, "stm32f405", Mischief::default());
    let mut fleet = one(config(1, "qemu:stm32f405"), channel);
    run(&mut fleet, 49);
    let Some(Answer::Mismatch(mismatch)) = tick(&mut fleet, 49).pop() else {
        panic!("the fiftieth step differs");
    };
    assert_eq!(mismatch.tick, 49);
    let text = mismatch.to_string();
    assert!(text.starts_with("robot 1 on qemu:stm32f405 differs at step 49:"), "{text}");
    let (device, host) = (&mismatch.on_device, &mismatch.in_shadow);
    for digest in [device.digest, host.digest] {
        assert!(text.contains(&format!("{digest:016x}")), "{text}");
    }
    let marked: Vec<&str> = text.lines().filter(|line| line.starts_with('*')).collect();
    assert_eq!(marked.len(), 2, "{text}");
    assert!(marked[0].contains("digest") && marked[1].contains("heard"), "{text}");
    assert_eq!(fleet.statistics()[0].mismatches, 1);
}

fn cause(answers: Vec<Answer>) -> String {
    match answers.into_iter().next() {
        Some(Answer::Failed(error)) => error.to_string(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn silent_device_error_names_the_step_and_the_waiting_time() {
    let mischief = Mischief { silent_at: Some(7), ..Mischief::default() };
    let options = Options { step_limit: Duration::from_millis(100), ..options() };
    let mut fleet = Fleet::over(
        vec![(config(1, "qemu:microbit"), small(mischief)), (config(2, "thread"), large(Mischief::default()))],
        options,
    )
    .expect("they start");
    run(&mut fleet, 7);
    let mut answers = tick(&mut fleet, 7);
    let _ = decided(answers.pop().expect("two"));
    let text = cause(answers);
    let known = "robot 1 on qemu:microbit: no answer to step 7 within ";
    assert!(text.starts_with(known) && text.ends_with(" attempts)"), "{text}");
    let mut answers = tick(&mut fleet, 8);
    let _ = decided(answers.pop().expect("two"));
    assert_eq!(cause(answers), "robot 1 on qemu:microbit: it was given up before");
}

#[test]
fn second_step_before_the_first_is_collected_is_an_error() {
    let mut fleet = one(config(1, "thread"), large(Mischief::default()));
    for t in 0..2 {
        let scene = Scene::new(1, t);
        fleet.send(0, t, now(t), &scene.inputs());
    }
    let text = cause(fleet.collect());
    assert!(text.ends_with("still busy with the last step: collect its answer first"), "{text}");
}

#[test]
fn lost_device_is_named_in_the_error() {
    let mischief = Mischief { leaves_at: Some(3), ..Mischief::default() };
    let mut fleet = one(config(5, "thread"), large(mischief));
    run(&mut fleet, 3);
    let text = cause(tick(&mut fleet, 3));
    assert_eq!(text, "robot 5 on thread: the line is closed");
}

#[test]
fn device_that_never_answers_is_an_error_of_the_start() {
    let mischief = Mischief { silent_at: Some(0), ..Mischief::default() };
    let options = Options { start_limit: Duration::from_millis(60), ..options() };
    let lines = vec![(config(1, "thread"), large(mischief))];
    let error = Fleet::over(lines, options).expect_err("no device answers").to_string();
    assert!(error.starts_with("robot 1 on thread: no answer to greeting within "), "{error}");
}

#[test]
fn setup_that_does_not_fit_is_an_error_of_the_start() {
    let mut config = config(2, "thread");
    if let staya_controller::agent::LawSettings::Route(route) = &mut config.setup.law {
        route.params.radius = 6;
    }
    let lines = vec![(config, small(Mischief::default()))];
    let error = Fleet::over(lines, options()).expect_err("too far").to_string();
    let text = "robot 2 on thread: the device answers to setup: Capacity: a search of 225 cells, and room for 169";
    assert_eq!(error, text);
}

#[test]
fn robots_decide_alike_in_mavlink_and_postcard() {
    let digests = |format: Format| {
        let lines = (1..=2).map(|robot| {
            let mut config = config(robot, "thread");
            config.setup.format = format;
            let well = Mischief::default();
            (config, if robot == 1 { large(well) } else { small(well) })
        });
        let mut fleet = Fleet::over(lines.collect(), options()).expect("they start");
        let mut digests = Vec::new();
        for t in 0..200 {
            for index in 0..2 {
                let scene = Scene::over(format, index as u32 + 1, t);
                fleet.send(index, t, now(t), &scene.inputs());
            }
            for answer in fleet.collect() {
                let result = decided(answer);
                digests.push((result.digest, result.outputs.received));
            }
        }
        digests
    };
    let mavlink = digests(Format::Mavlink);
    assert!(mavlink.iter().all(|(_, received)| *received > 0));
    assert_eq!(mavlink, digests(Format::Postcard));
}

#[test]
fn inputs_beyond_the_capacities_are_cut_for_both_alike_and_counted() {
    let mut fleet = one(config(1, "thread"), small(Mischief::default()));
    for t in 0..20 {
        let mut scene = Scene::new(1, t);
        for other in 200..230 {
            scene.hear(other, t);
        }
        for far in 0..30 {
            scene.see(2.0 + far as f32);
        }
        fleet.send(0, t, now(t), &scene.inputs());
        let result = decided(fleet.collect().pop().expect("one"));
        let heard = result.outputs.received + result.outputs.rejected;
        assert!((10..30).contains(&heard), "{heard} of 34");
    }
    let statistics = &fleet.statistics()[0];
    assert_eq!(statistics.cut_obstacles, 20 * (32 - 16));
    assert!(statistics.cut_inbox_bytes > 20 * 300, "{statistics:?}");
}

#[test]
fn stop_ends_the_wait() {
    let mischief = Mischief { silent_at: Some(0), ..Mischief::default() };
    let patient = Options { start_limit: Duration::from_secs(3600), ..options() };
    patient.stop.store(true, Ordering::Relaxed);
    let lines = vec![(config(1, "thread"), large(mischief))];
    let error = Fleet::over(lines, patient).expect_err("stopped");
    assert!(matches!(*error.cause, Cause::Stopped));
}

#[test]
fn unknown_devices_and_missing_firmware_are_errors_of_the_start() {
    for (device, pieces) in [
        ("qemu:z80", ["`qemu:z80` is not a device", "qemu:riscv32"]),
        ("qemu:stm32f405", ["nowhere/stm32f405/lockstep", "cargo xtask firmware stm32f405"]),
        ("serial:/dev/nothing-there", ["cannot open /dev/nothing-there", "; "]),
    ] {
        let error = Fleet::start(vec![config(3, device)], options()).expect_err(device).to_string();
        assert!(error.starts_with(&format!("robot 3 on {device}: ")), "{error}");
        for piece in pieces {
            assert!(error.contains(piece), "{error}");
        }
    }
}
