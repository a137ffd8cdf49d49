//! A program of the firmware in the emulator of its part, from its start to its end.

use crate::apt::Tools;
use crate::device::{PARTS, Part};
use crate::firmware::{self, Profile};
use crate::repo::{Repo, output_of, shown};
use crate::session::Session;
use std::path::Path;
use std::process::Stdio;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

/// After so long a program counts as hanging: the longest takes a minute on a busy machine.
const PATIENCE: Duration = Duration::from_secs(600);

/// The machine that the part's emulator models.
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

/// A step with programs of the firmware on a part: builds them, all if none is named. Skipped if
/// program or emulator is missing.
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
    s.report.step_with(name, prepare(&s.repo, part), |()| work(&s.repo));
}

/// Runs a program that ends by itself, with the part's UART on one of QEMU's devices, `none` or
/// `stdio`; what it printed. Each instruction takes a nanosecond of the part's time.
pub fn run(repo: &Repo, part: &Part, elf: &Path, line: &str) -> Result<String, String> {
    run_with(repo, part, elf, line, &[])
}

/// [`run`] with arguments for the program.
pub fn run_with(repo: &Repo, part: &Part, elf: &Path, line: &str, arguments: &[&str]) -> Result<String, String> {
    let arguments: String = arguments.iter().map(|argument| format!(",arg={argument}")).collect();
    let mut command = repo.command(part.emulator);
    command
        .args(machine(part))
        .args(["-icount", "shift=0", "-display", "none"])
        .args(["-monitor", "none", "-serial", line])
        .args(["-semihosting-config", &format!("enable=on,target=native{arguments}")])
        .arg("-kernel")
        .arg(elf);
    println!("$ {}", shown(&command));
    let child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let child = child.map_err(|error| format!("cannot start {}: {error}", part.emulator))?;
    let (ended, waiting) = mpsc::channel::<()>();
    let mut kill = repo.command("kill");
    kill.arg(child.id().to_string());
    let watch = thread::spawn(move || {
        let hangs = waiting.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout);
        hangs && kill.status().is_ok()
    });
    let output = child.wait_with_output().map_err(|error| error.to_string())?;
    drop(ended);
    let hung = watch.join().unwrap_or_default();
    let [said, complaints] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    if output.status.success() && !hung {
        return Ok(said);
    }
    print!("{said}");
    let reason = if hung { format!("did not end within {} s", PATIENCE.as_secs()) } else { output.status.to_string() };
    let last = said.lines().last().unwrap_or_default();
    Err(format!("{reason}; {last} {}", complaints.lines().next().unwrap_or_default()))
}
