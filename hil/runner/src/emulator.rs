//! An emulated part: one QEMU process with its UART on a socket. The socket is the standard input
//! (`-chardev socket,fd=0`), which needs neither a file name nor a network port. Semihosting, for
//! the firmware's logs, uses the standard output.

use crate::note::{Note, NoteError};
use crate::part::{Machine, Part};
use crate::printable::printable;
use std::fs::File;
use std::io::{self, Read};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr, Command, Stdio};
use std::sync::{Arc, Mutex, PoisonError};

const COMPLAINTS: usize = 2048;
/// Kills the emulator when the thread that started it ends; part of util-linux.
const GUARD: &str = "/usr/bin/setpriv";

/// Reason why an emulator cannot be started.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "each text says it")]
pub enum EmulatorError {
    #[error(
        "{program} is missing: on Debian run, as root, `apt-get install {package}`, or `cargo xtask qemu` in Staya's repository"
    )]
    NoEmulator { program: &'static str, package: &'static str },
    #[error("no firmware in {}: `cargo xtask firmware {build}` makes it", .elf.display())]
    NoFirmware { elf: PathBuf, build: String },
    #[error(transparent)]
    Firmware(#[from] NoteError),
    #[error("cannot start {program}: {source}")]
    Start { program: &'static str, source: io::Error },
    #[error("cannot write the log {}: {source}", .path.display())]
    Log { path: PathBuf, source: io::Error },
}

/// A running emulator, which is killed on drop.
#[derive(Debug)]
pub struct Emulator {
    child: Child,
    complaints: Arc<Mutex<String>>,
}

/// One instruction takes 1 ns of the emulated clock.
pub fn command(part: Part, program: &Path, elf: &Path) -> Command {
    let (_, machine, _) = part.machine();
    // Its own process group: Ctrl-C reaches the runner alone, which shuts it down.
    let mut command = if Path::new(GUARD).is_file() {
        let mut command = Command::new(GUARD);
        command.args(["--pdeathsig", "KILL"]).arg(program);
        command
    } else {
        Command::new(program)
    };
    command.process_group(0);
    command.args(machine);
    command.args(["-display", "none", "-monitor", "none", "-nodefaults"]);
    command.args(["-icount", "shift=0"]);
    command.args(["-semihosting-config", "enable=on,target=native"]);
    command.args(["-chardev", "socket,id=uart,fd=0"]);
    command.args(["-serial", "chardev:uart", "-kernel"]).arg(elf);
    command
}

/// Logs go to the file `log`, if given.
pub fn start(machine: Machine, elf: &Path, log: Option<&Path>) -> Result<(Emulator, UnixStream), EmulatorError> {
    let part = machine.part;
    let (program, _, package) = part.machine();
    if !elf.is_file() {
        return Err(EmulatorError::NoFirmware { elf: elf.to_owned(), build: machine.build() });
    }
    Note::check(elf, part, None)?;
    let Some(path) = find_emulator(program) else {
        return Err(EmulatorError::NoEmulator { program, package });
    };
    let failed = |source| EmulatorError::Start { program, source };
    let (ours, theirs) = UnixStream::pair().map_err(failed)?;
    let log = match log {
        Some(path) => {
            let file = File::create(path).map_err(|source| EmulatorError::Log { path: path.to_owned(), source })?;
            Stdio::from(file)
        }
        None => Stdio::null(),
    };
    let mut command = command(part, &path, elf);
    command.stdin(Stdio::from(OwnedFd::from(theirs)));
    command.stdout(log).stderr(Stdio::piped());
    let mut child = command.spawn().map_err(failed)?;
    let complaints = Arc::default();
    if let Some(stderr) = child.stderr.take() {
        let complaints = Arc::clone(&complaints);
        std::thread::spawn(move || listen(stderr, &complaints));
    }
    Ok((Emulator { child, complaints }, ours))
}

/// Finds an emulator in the `PATH` or where `cargo xtask qemu` unpacks it, beside the folder of
/// this program (`target/release/staya`, `target/debug/deps/a-test`).
#[must_use]
pub fn find_emulator(program: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let here = std::env::current_exe().unwrap_or_default();
    let targets = here.ancestors().skip(2).take(2);
    std::env::split_paths(&path)
        .chain(targets.map(|target| target.join("tools/bin")))
        .map(|folder| folder.join(program))
        .find(|program| program.is_file())
}

fn listen(mut stderr: ChildStderr, complaints: &Mutex<String>) {
    let mut buffer = [0; 512];
    while let Ok(count @ 1..) = stderr.read(&mut buffer) {
        let text = String::from_utf8_lossy(buffer.get(..count).unwrap_or(&[]));
        let mut complaints = complaints.lock().unwrap_or_else(PoisonError::into_inner);
        if complaints.len() < COMPLAINTS {
            complaints.push_str(&text);
        }
    }
}

impl Emulator {
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Exit status and error output; `None` while it runs.
    pub fn epitaph(&mut self) -> Option<String> {
        // The socket closes shortly before the process can be waited for.
        for _ in 0..50 {
            if let Ok(Some(status)) = self.child.try_wait() {
                let complaints = self.complaints.lock().unwrap_or_else(PoisonError::into_inner);
                let lines: Vec<String> = complaints.trim().lines().map(printable).collect();
                return Some(format!("the emulator ended ({status}) {}", lines.join("\n")));
            }
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
        None
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        // Errors mean that it has already ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_firmware_error_names_the_build_command() {
        let error = start(Part::Microbit.into(), Path::new("no/nrf51/lockstep"), None).expect_err("none");
        let text = error.to_string();
        assert!(text.contains("no/nrf51/lockstep"), "{text}");
        assert!(text.contains("cargo xtask firmware nrf51"), "{text}");
    }

    #[test]
    fn missing_program_error_names_its_package() {
        assert!(find_emulator("sh").is_some() && find_emulator("qemu-system-abacus").is_none());
        let (program, _, package) = Part::Riscv32.machine();
        let text = EmulatorError::NoEmulator { program, package }.to_string();
        assert!(text.contains("qemu-system-riscv32 is missing"), "{text}");
        assert!(text.contains("apt-get install qemu-system-misc"), "{text}");
    }

    #[test]
    fn each_part_has_its_machine_and_its_uart_on_the_socket() {
        for (part, machine) in Part::ALL.into_iter().zip(["netduinoplus2", "microbit", "virt"]) {
            let command = command(part, Path::new("qemu"), Path::new("x.elf"));
            let arguments: Vec<_> = command.get_args().filter_map(|a| a.to_str()).collect();
            for expected in [machine, "shift=0", "socket,id=uart,fd=0", "x.elf"] {
                assert!(arguments.contains(&expected), "{arguments:?}");
            }
        }
    }
}
