//! A program of the firmware in the emulator of its part, from its start to its end.

use crate::apt::Tools;
use crate::device::{PARTS, Part};
use crate::firmware::{self, Profile};
use crate::repo::{Repo, output_of, shown};
use crate::session::Session;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// After so long a program counts as hanging: the longest takes a minute on a busy machine.
const PATIENCE: Duration = Duration::from_secs(600);

/// What the part's emulator is told to be.
fn machine(part: &Part) -> &'static [&'static str] {
    match part.name {
        "stm32f405" => &["-machine", "netduinoplus2"],
        "nrf51" => &["-machine", "microbit"],
        // Without firmware of the machine's own, which would be loaded over ours.
        _ => &["-machine", "virt", "-bios", "none"],
    }
}

/// Debian's packages of both emulators.
const QEMU: Tools =
    Tools { packages: &["qemu-system-arm", "qemu-system-misc"], programs: &["qemu-system-arm", "qemu-system-riscv32"] };

/// The command that fetches the emulators.
pub fn run_command(s: &mut Session) {
    for part in &PARTS {
        s.report.step(&format!("the emulator of the {}", part.name), || prepare(&s.repo, part));
    }
}

/// Makes sure that the part's emulator is there: unpacks it on Debian.
pub fn prepare(repo: &Repo, part: &Part) -> Result<(), String> {
    QEMU.prepare(repo, || output_of(repo.command(part.emulator).arg("--version")).is_some())
}

/// A step with programs of the firmware on a part: builds them, all if none is named. Skipped if program or emulator is missing.
pub fn on_part(
    s: &mut Session,
    name: &str,
    part: &Part,
    (profile, bins): (Profile, &[&str]),
    work: impl FnOnce(&Repo) -> Result<(), String>,
) {
    if !firmware::build(s, part, profile, bins) {
        return s.report.skip(name, "there is no firmware");
    }
    match prepare(&s.repo, part) {
        Err(reason) => s.report.skip(name, &reason),
        Ok(()) => drop(s.report.step(name, || work(&s.repo))),
    }
}

/// Runs a program that ends by itself, with the part's UART on one of QEMU's devices, `none` or `stdio`; what it printed. Each instruction
/// takes a nanosecond of the part's time.
pub fn run(repo: &Repo, part: &Part, elf: &Path, line: &str) -> Result<String, String> {
    let mut command = repo.command(part.emulator);
    command
        .args(machine(part))
        .args(["-icount", "shift=0", "-display", "none"])
        .args(["-monitor", "none", "-serial", line])
        .args(["-semihosting-config", "enable=on,target=native"])
        .arg("-kernel")
        .arg(elf)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    println!("$ {}", shown(&command));
    let mut child = command.spawn().map_err(|error| format!("cannot start {}: {error}", part.emulator))?;
    let output = reader(child.stdout.take());
    let complaints = reader(child.stderr.take());
    let ended = wait(&mut child);
    let output = output.join().unwrap_or_default();
    let complaints = complaints.join().unwrap_or_default();
    match ended {
        Ok(()) => Ok(output),
        Err(reason) => {
            print!("{output}");
            let first = complaints.lines().next().unwrap_or_default();
            let last = output.lines().last().unwrap_or_default();
            Err(format!("{reason}; {last} {first}"))
        }
    }
}

fn reader(pipe: Option<impl Read + Send + 'static>) -> thread::JoinHandle<String> {
    thread::spawn(move || {
        let mut text = Vec::new();
        if let Some(mut pipe) = pipe {
            // What came before an error still says something.
            let _ = pipe.read_to_end(&mut text);
        }
        String::from_utf8_lossy(&text).into_owned()
    })
}

/// Waits for the end, and brings it about when it does not come.
fn wait(child: &mut Child) -> Result<(), String> {
    let start = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(status)) if status.success() => return Ok(()),
            Ok(Some(status)) => return Err(status.to_string()),
            Ok(None) if start.elapsed() < PATIENCE => thread::sleep(Duration::from_millis(20)),
            Ok(None) => {
                let _ = child.kill();
                let _ = child.wait();
                return Err(format!("did not end within {} s", PATIENCE.as_secs()));
            }
            Err(error) => return Err(error.to_string()),
        }
    }
}
