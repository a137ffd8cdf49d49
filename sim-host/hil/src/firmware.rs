use anyhow::{Context as _, Result, bail};
use staya_console::say;
use staya_controller::scalar::NumberFormat;
use staya_runner::{Machine, Note, find_emulator};
use staya_sim::shown::Shown as _;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

/// Equivalent of `--firmware`.
const VARIABLE: &str = "STAYA_FIRMWARE";

pub(crate) struct Program {
    /// Name of the host program, whose firmware is installed in `share/NAME/firmware`.
    pub(crate) name: &'static str,
    /// Expected name and version inside the firmware.
    pub(crate) says: String,
    pub(crate) made: Made,
}

pub(crate) enum Made {
    InRepository,
    InPackage(PathBuf),
}

/// Finds the folder with firmware for these machines, or one ELF file: the given path, the
/// environment variable, firmware installed beside this program or in the user's data folder, the
/// sources of this program. The last one builds outdated firmware and downloads the emulators.
pub(crate) fn find(machines: &[Machine], given: Option<&Path>, program: &Program) -> Result<PathBuf> {
    if machines.is_empty() {
        return Ok(PathBuf::new());
    }
    let named = std::env::var_os(VARIABLE).map(PathBuf::from);
    let mut looked = String::from("no firmware found:");
    let chosen = match (given, named) {
        (Some(folder), _) => Some(("--firmware", folder.to_owned())),
        (None, Some(folder)) => Some((VARIABLE, folder)),
        (None, None) => None,
    };
    if let Some((by, folder)) = chosen {
        return match lacking(machines, &folder) {
            None => checked(machines, folder, program),
            Some(elf) => {
                write!(looked, "\n  {} is missing ({by})", elf.shown())?;
                bail!("{looked}\n{}", remedy(machines, program))
            }
        };
    }
    for folder in installed(program.name) {
        match lacking(machines, &folder) {
            None => return checked(machines, folder, program),
            Some(elf) => write!(looked, "\n  {} is missing", elf.shown())?,
        }
    }
    let root = repository();
    let sources = match &program.made {
        Made::InRepository => root.as_deref(),
        Made::InPackage(folder) => root.as_deref().and(Some(folder.as_path())),
    };
    match (&root, sources.filter(|sources| sources.is_dir())) {
        (Some(root), Some(_)) => {
            let folder = prepare(root, machines, &program.made)?;
            match lacking(machines, &folder) {
                None => checked(machines, folder, program),
                Some(elf) => {
                    write!(looked, "\n  {} is missing, and no installed toolchain can build it", elf.shown())?;
                    bail!("{looked}\n{}", remedy(machines, program))
                }
            }
        }
        _ => {
            write!(looked, "\n  the sources of this program are no longer at {}", home().shown())?;
            bail!("{looked}\n{}", remedy(machines, program))
        }
    }
}

fn lacking(machines: &[Machine], folder: &Path) -> Option<PathBuf> {
    machines.iter().map(|machine| machine.elf(folder)).find(|elf| !elf.is_file())
}

fn checked(machines: &[Machine], folder: PathBuf, program: &Program) -> Result<PathBuf> {
    for machine in machines {
        Note::check(&machine.elf(&folder), machine.part, Some(&program.says))?;
    }
    Ok(folder)
}

fn remedy(machines: &[Machine], program: &Program) -> String {
    let commands = |what: &str| {
        let builds =
            builds(machines).into_iter().map(|build| format!("`cargo xtask firmware {what} {}`", build.join(" ")));
        builds.collect::<Vec<_>>().join(" and ")
    };
    match &program.made {
        Made::InRepository => format!(
            "In a clone of Staya's repository, {} builds it in CLONE/target/firmware; then add \
            `--firmware CLONE/target/firmware` here, or set {VARIABLE} to that folder. `cargo xtask install --prefix DIR` installs it \
            beside the program",
            commands("--bin lockstep")
        ),
        Made::InPackage(folder) => format!(
            "In a clone of Staya's repository, {} builds it in {folder}/target/firmware; \
            then add `--firmware {folder}/target/firmware` here, or set {VARIABLE} to that folder or to one ELF file",
            commands(&format!("--crate {}", folder.shown())),
            folder = folder.shown()
        ),
    }
}

/// Arguments of the builds, one for all usual number formats and one for each other one.
fn builds(machines: &[Machine]) -> Vec<Vec<&'static str>> {
    let mut builds: Vec<(Option<NumberFormat>, Vec<&str>)> = Vec::new();
    for machine in machines {
        let other = machine.other_numbers();
        let name = machine.part.firmware_name();
        match builds.iter_mut().find(|(numbers, _)| *numbers == other) {
            Some((_, names)) => names.push(name),
            None => builds.push((other, vec![name])),
        }
    }
    let numbers = |other: Option<NumberFormat>| other.map(|numbers| ["--numbers", numbers.name()]);
    builds.into_iter().map(|(other, names)| numbers(other).into_iter().flatten().chain(names).collect()).collect()
}

fn installed(name: &str) -> Vec<PathBuf> {
    let program = std::env::current_exe().ok();
    let beside = program.as_deref().and_then(|program| Some(program.ancestors().nth(2)?.join("share")));
    let data = std::env::var_os("XDG_DATA_HOME").map(PathBuf::from);
    let home = || Some(Path::new(&std::env::var_os("HOME")?).join(".local/share"));
    let places = [beside, data.or_else(home)].into_iter().flatten();
    let mut places: Vec<PathBuf> = places.map(|folder| folder.join(name).join("firmware")).collect();
    places.dedup();
    places
}

fn home() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.ancestors().nth(2).unwrap_or(here).to_owned()
}

/// The repository in which cargo started this program, or the one that it was built from.
fn repository() -> Option<PathBuf> {
    let started = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    let started = started.as_deref().and_then(Path::parent).map(Path::to_owned);
    [started, Some(home())].into_iter().flatten().find(|root| is_repository(root))
}

fn is_repository(folder: &Path) -> bool {
    folder.join("xtask/Cargo.toml").is_file() && folder.join("hil/firmware").is_dir()
}

fn target(root: &Path) -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| root.join("target"), |folder| std::path::absolute(&folder).unwrap_or_else(|_| folder.into()))
}

/// Rust targets of all parts; without them cargo also builds `core`.
const TARGETS: &str = "thumbv7em-none-eabihf thumbv6m-none-eabi riscv32imac-unknown-none-elf";

/// Builds outdated firmware, downloads the emulators, and returns the firmware's folder.
fn prepare(root: &Path, machines: &[Machine], made: &Made) -> Result<PathBuf> {
    let (folder, what) = match made {
        Made::InRepository => (target(root).join("firmware"), vec!["--bin", "lockstep"]),
        Made::InPackage(package) => {
            let text = package
                .to_str()
                .with_context(|| format!("{} is not valid UTF-8; rename the folder", package.shown()))?;
            (package.join("target/firmware"), vec!["--crate", text])
        }
    };
    if lacking(machines, &folder).is_some() {
        let names: Vec<String> = machines.iter().map(ToString::to_string).collect();
        say(&format!(
            "staya: building the firmware for {}; the first build takes some minutes, fewer after `rustup target add {TARGETS}`",
            names.join(", ")
        ));
    }
    let began = Instant::now();
    for build in builds(machines) {
        xtask(root, &[&["firmware"], what.as_slice(), build.as_slice()].concat())?;
    }
    for machine in machines {
        let elf = machine.elf(&folder);
        if elf.is_file() {
            say(&format!("staya: {} is up to date, after {:.0} s", elf.shown(), began.elapsed().as_secs_f64()));
        }
    }
    if !machines.iter().all(|machine| find_emulator(machine.part.emulator()).is_some()) {
        say("staya: downloading the emulators; this takes a minute");
        xtask(root, &["qemu"])?;
    }
    Ok(folder)
}

/// Its output goes to standard error, complete only if it fails.
fn xtask(root: &Path, arguments: &[&str]) -> Result<()> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let line = format!("cargo xtask {}", arguments.join(" "));
    say(&format!("staya: {line}"));
    let mut command = Command::new(cargo);
    // Cargo's variables describe this program's package, not that of the command.
    for (name, _) in std::env::vars_os() {
        let is_cargos =
            name.to_str().is_some_and(|name| name.starts_with("CARGO_PKG_") || name.starts_with("CARGO_MANIFEST_"));
        if is_cargos {
            command.env_remove(name);
        }
    }
    let output = command
        .args(["run", "--quiet", "--locked", "--package", "xtask", "--"])
        .args(arguments)
        .current_dir(root)
        .stdin(Stdio::null())
        .stderr(Stdio::inherit())
        .output()
        .with_context(|| format!("cannot start `{line}`"))?;
    let said = String::from_utf8_lossy(&output.stdout);
    if !output.status.success() {
        eprint!("{said}");
        bail!("`{line}` failed");
    }
    for skipped in said.lines().filter(|line| line.contains("no toolchain") || line.contains("no qemu")) {
        say(&format!("staya: {}", skipped.trim()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use staya_runner::Part;

    const MACHINES: [Machine; 2] =
        [Machine { part: Part::Stm32f405, numbers: None }, Machine { part: Part::Microbit, numbers: None }];

    fn folder(machines: &[Machine]) -> tempfile::TempDir {
        let top = tempfile::tempdir().expect("a folder");
        for machine in machines {
            let elf = machine.elf(top.path());
            std::fs::create_dir_all(elf.parent().expect("a parent")).expect("a folder");
            std::fs::write(elf, "").expect("a file");
        }
        top
    }

    fn program(made: Made) -> Program {
        Program { name: "staya", says: String::from("lockstep 0.1.0"), made }
    }

    #[test]
    fn a_given_path_must_exist_and_be_firmware() {
        let refusal =
            |given: &Path, made| find(&MACHINES, Some(given), &program(made)).expect_err("no firmware").to_string();
        let one = folder(&MACHINES[..1]);
        let text = refusal(one.path(), Made::InRepository);
        for piece in [
            MACHINES[1].elf(one.path()).display().to_string(),
            String::from("(--firmware)"),
            String::from("cargo xtask firmware --bin lockstep stm32f405 nrf51"),
            String::from("cargo xtask install"),
            String::from(VARIABLE),
        ] {
            assert!(text.contains(&piece), "{text}");
        }
        let text = refusal(one.path(), Made::InPackage(PathBuf::from("/my/law")));
        assert!(text.contains("cargo xtask firmware --crate /my/law stm32f405 nrf51"), "{text}");
        let both = folder(&MACHINES);
        let text = refusal(both.path(), Made::InRepository);
        assert!(text.contains("ELF file"), "{text}");
        let text = refusal(&MACHINES[0].elf(one.path()), Made::InRepository);
        assert!(text.contains("stm32f405/lockstep"), "{text}");
    }

    #[test]
    fn machines_of_one_number_format_are_built_together() {
        let machines =
            ["stm32f405", "stm32f405,numbers=q16", "microbit", "riscv32,numbers=q16", "riscv32,numbers=fast32"];
        let machines = machines.map(|text| text.parse::<Machine>().expect(text));
        let lines: Vec<String> = builds(&machines).into_iter().map(|build| build.join(" ")).collect();
        assert_eq!(lines, ["stm32f405 nrf51", "--numbers q16 stm32f405 riscv32", "--numbers fast32 riscv32"]);
    }

    #[test]
    fn boards_need_no_firmware_file() {
        assert!(find(&[], Some(Path::new("no/such/folder")), &program(Made::InRepository)).is_ok());
    }

    #[test]
    fn firmware_beside_the_program_is_found_first() {
        let places = installed("staya");
        let program = std::env::current_exe().expect("this test's path");
        let beside = program.ancestors().nth(2).expect("a folder").join("share/staya/firmware");
        assert_eq!(places.first(), Some(&beside));
    }
}
