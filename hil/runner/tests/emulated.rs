//! Fleets of emulated parts, with the firmware of `cargo xtask firmware` in `$STAYA_FIRMWARE`, or
//! in `firmware` beside the build folder. `cargo xtask test` runs two parts, with `--all` all.

mod common;

use common::{Scene, config, now};
use staya_controller::wire::Format;
use staya_runner::{Answer, Fleet, LineFaults, Options, Part, Reset, Statistics};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::time::Duration;

fn firmware() -> PathBuf {
    if let Some(folder) = std::env::var_os("STAYA_FIRMWARE") {
        return folder.into();
    }
    let program = std::env::current_exe().expect("this test's path");
    let target = program.ancestors().nth(3).expect("a target folder");
    target.join("firmware")
}

/// `$STAYA_PARTS` (`stm32f405,nrf51`); all if it is unset.
fn parts() -> Vec<Part> {
    let wanted = std::env::var("STAYA_PARTS");
    let is_wanted = |part: &Part| match &wanted {
        Ok(names) => names.split(',').any(|name| name == part.firmware_name()),
        Err(_) => true,
    };
    let parts: Vec<Part> = Part::ALL.into_iter().filter(is_wanted).collect();
    assert!(!parts.is_empty(), "STAYA_PARTS names no part: {wanted:?}");
    parts
}

fn options() -> Options {
    Options { step_limit: Duration::from_secs(60), start_limit: Duration::from_secs(60), ..Options::new(firmware()) }
}

fn send(fleet: &mut Fleet, tick: u32) {
    for index in 0..fleet.len() {
        let scene = Scene::new(index as u32 + 1, tick);
        fleet.send(index, tick, now(tick), &scene.inputs());
    }
}

fn run(fleet: &mut Fleet, ticks: u32) -> Vec<u32> {
    let mut down = vec![0; fleet.len()];
    for tick in 0..ticks {
        send(fleet, tick);
        let answers = fleet.collect();
        assert_eq!(answers.len(), down.len());
        for (answer, down) in answers.into_iter().zip(&mut down) {
            match answer {
                Answer::Decided(_) => {}
                Answer::Down => *down += 1,
                Answer::Mismatch(mismatch) => panic!("{mismatch}"),
                Answer::Failed(error) => panic!("{error}"),
            }
        }
    }
    down
}

fn print(statistics: &Statistics) {
    let Statistics {
        device, round_trip_us, instructions, stack_bytes, resent, sent_bytes, received_bytes, steps, ..
    } = statistics;
    println!(
        "{device}: {steps} steps, round trip {round_trip_us:?} us, instructions {instructions:?}, \
        stack {stack_bytes}, resent {resent}, {} bytes a step",
        (sent_bytes + received_bytes) / steps.max(&1)
    );
}

/// A zombie process does not count.
fn is_alive(process: u32) -> bool {
    let state = std::fs::read_to_string(Path::new("/proc").join(process.to_string()).join("stat"));
    state.is_ok_and(|state| state.contains("(qemu") && !state.contains(") Z"))
}

#[test]
fn every_part_decides_like_its_shadow() {
    let parts = parts().into_iter().cycle().take(6);
    let configs = parts.zip(1..).map(|(part, robot)| config(robot, &format!("qemu:{}", part.name())));
    let mut fleet = Fleet::start(configs.collect(), options()).expect("they start");
    assert_eq!(run(&mut fleet, 100), [0; 6]);
    for statistics in fleet.statistics() {
        print(&statistics);
        assert_eq!((statistics.steps, statistics.mismatches, statistics.resets), (100, 0, 0));
        assert!(statistics.instructions.is_some_and(|spread| spread.median > 1000));
        assert!(statistics.stack_bytes > 100);
    }
}

#[test]
fn every_part_speaks_mavlink() {
    let configs = parts().into_iter().zip(1..).map(|(part, robot)| {
        let mut config = config(robot, &format!("qemu:{}", part.name()));
        config.setup.format = Format::Mavlink;
        config
    });
    let mut fleet = Fleet::start(configs.collect(), options()).expect("they start");
    for tick in 0..40 {
        for index in 0..fleet.len() {
            let scene = Scene::over(Format::Mavlink, index as u32 + 1, tick);
            fleet.send(index, tick, now(tick), &scene.inputs());
        }
        for answer in fleet.collect() {
            let Answer::Decided(result) = answer else {
                panic!("{answer:?}");
            };
            assert!(result.outputs.received > 0);
        }
    }
}

#[test]
fn emulated_parts_restart_on_request_and_rejoin_over_a_faulty_line() {
    let configs = parts().into_iter().zip(1..).map(|(part, robot)| {
        let mut config = config(robot, &format!("qemu:{}", part.name()));
        config.faults = LineFaults { loss: 0.05, bit_errors: 1e-5, delay: Duration::from_millis(1), seed: 9 };
        config.resets = vec![Reset { tick: 20, down_ticks: 5 }];
        config
    });
    let mut fleet = Fleet::start(configs.collect(), options()).expect("they start");
    assert_eq!(run(&mut fleet, 60), vec![5; parts().len()]);
    for statistics in fleet.statistics() {
        print(&statistics);
        assert_eq!((statistics.steps, statistics.mismatches, statistics.resets), (55, 0, 1));
    }
}

#[test]
fn emulators_end_with_their_fleet_even_on_panic() {
    let configs = || vec![config(1, "qemu:microbit"), config(2, "qemu:stm32f405")];
    let fleet = Fleet::start(configs(), options()).expect("they start");
    let processes = fleet.processes();
    assert_eq!(processes.len(), 2);
    assert!(processes.iter().all(|process| is_alive(*process)));
    drop(fleet);
    assert!(!processes.iter().any(|process| is_alive(*process)));
    let (sender, receiver) = std::sync::mpsc::channel();
    let panicking = std::thread::spawn(move || {
        let fleet = Fleet::start(configs(), options()).expect("they start");
        sender.send(fleet.processes()).expect("the receiver exists");
        panic!("in the middle of a run");
    });
    let processes = receiver.recv().expect("two of them");
    assert!(panicking.join().is_err());
    assert!(!processes.iter().any(|process| is_alive(*process)));
}

#[test]
fn killed_emulator_is_named_in_the_error() {
    let configs = vec![config(1, "qemu:microbit")];
    let mut fleet = Fleet::start(configs, options()).expect("it starts");
    run(&mut fleet, 3);
    let process = fleet.processes()[0].to_string();
    let killed = std::process::Command::new("kill").args(["-KILL", &process]).status();
    assert!(killed.is_ok_and(|status| status.success()));
    send(&mut fleet, 3);
    let answer = fleet.collect().pop();
    let Some(Answer::Failed(error)) = answer else {
        panic!("{answer:?}");
    };
    let text = error.to_string();
    assert!(text.starts_with("robot 1 on qemu:microbit: the emulator ended"), "{text}");
}

#[test]
fn killed_runner_leaves_no_emulator() {
    const WAITS: &str = "STAYA_RUNNER_WAITS";
    if std::env::var_os(WAITS).is_some() {
        // The runner to be killed; it ends by itself otherwise.
        let fleet = Fleet::start(vec![config(1, "qemu:microbit")], options()).expect("it starts");
        println!("\nemulator {}", fleet.processes()[0]);
        std::thread::sleep(Duration::from_secs(120));
        return;
    }
    let program = std::env::current_exe().expect("this test's path");
    let mut runner = std::process::Command::new(program)
        .args(["--exact", "killed_runner_leaves_no_emulator", "--nocapture"])
        .env(WAITS, "1")
        .env("STAYA_FIRMWARE", firmware())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .expect("this test starts itself");
    let said = BufReader::new(runner.stdout.take().expect("piped")).lines();
    let mut said = said.map_while(Result::ok);
    let process = said.find_map(|line| line.strip_prefix("emulator ")?.parse().ok());
    let process = process.expect("it names the emulator");
    assert!(is_alive(process));
    runner.kill().expect("it runs");
    runner.wait().expect("it ended");
    let is_over = (0..100).any(|_| {
        std::thread::sleep(Duration::from_millis(50));
        !is_alive(process)
    });
    assert!(is_over, "emulator {process} lives on");
}
