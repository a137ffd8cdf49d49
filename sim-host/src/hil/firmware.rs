//! What emulated devices run: ELF files that `cargo xtask firmware` makes.

use anyhow::{Context as _, Result, bail};
use staya_runner::{Part, find_emulator};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

/// Names the folder of firmware, as `--firmware` does.
const VARIABLE: &str = "STAYA_FIRMWARE";

/// The folder with firmware for these parts: the one that is given; or, started by cargo in the repository, the repository's, where
/// this builds what is missing or old and fetches the emulators; or the first of [`places`] that has it all.
///
/// # Errors
/// Firmware that is not there, with where it was looked for and what to do.
pub fn folder(parts: &[Part], given: Option<&Path>) -> Result<PathBuf> {
    let given = given.map(Path::to_owned);
    let named = || std::env::var_os(VARIABLE).map(PathBuf::from);
    let places = match (given.or_else(named), repository_of_cargo()) {
        (Some(folder), _) => vec![folder],
        (None, Some(root)) => {
            prepare(&root, parts)?;
            vec![target(&root).join("firmware")]
        }
        (None, None) => places(),
    };
    first_with_all(parts, places)
}

/// The first of these folders that has the firmware of all parts.
fn first_with_all(parts: &[Part], places: Vec<PathBuf>) -> Result<PathBuf> {
    let mut text = String::from("no firmware:");
    for place in places {
        match parts.iter().find(|part| !part.elf(&place).is_file()) {
            None => return Ok(place),
            Some(part) => write!(text, "\n  {} is not there", part.elf(&place).display())?,
        }
    }
    let names: Vec<&str> = parts.iter().map(|part| part.firmware_name()).collect();
    bail!(
        "{text}\nIn a clone of Staya's repository `cargo xtask firmware --bin lockstep {}` makes it, in CLONE/target/firmware; \
         then add `--firmware CLONE/target/firmware` here, or set {VARIABLE} to that folder",
        names.join(" ")
    );
}

/// Where firmware is looked for when nobody says where: in the repository around the working folder, beside the folder of this
/// program (`target/release/staya` has it in `target/firmware`), among the user's data.
fn places() -> Vec<PathBuf> {
    let here = std::env::current_dir().unwrap_or_default();
    let repository = here.ancestors().find(|folder| is_repository(folder)).map(target);
    let program = std::env::current_exe().ok();
    let beside = program.as_deref().and_then(|program| program.ancestors().nth(2));
    let data = std::env::var_os("XDG_DATA_HOME").map(PathBuf::from);
    let home = || Some(Path::new(&std::env::var_os("HOME")?).join(".local/share"));
    let data = data.or_else(home).map(|data| data.join("staya"));
    let mut places: Vec<PathBuf> = [repository, beside.map(Path::to_owned), data]
        .into_iter()
        .flatten()
        .map(|folder| folder.join("firmware"))
        .collect();
    places.dedup();
    places
}

/// The repository, if cargo started this program there.
fn repository_of_cargo() -> Option<PathBuf> {
    std::env::var_os("CARGO")?;
    let manifest = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR")?);
    let root = manifest.parent()?;
    is_repository(root).then(|| root.to_owned())
}

fn is_repository(folder: &Path) -> bool {
    folder.join("xtask/Cargo.toml").is_file() && folder.join("hil/firmware").is_dir()
}

fn target(root: &Path) -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| root.join("target"), |folder| std::path::absolute(&folder).unwrap_or_else(|_| folder.into()))
}

/// Brings the repository's firmware for these parts up to date, and fetches the emulators.
fn prepare(root: &Path, parts: &[Part]) -> Result<()> {
    let names: Vec<&str> = parts.iter().map(|part| part.firmware_name()).collect();
    if names.is_empty() {
        return Ok(());
    }
    let folder = target(root).join("firmware");
    if parts.iter().any(|part| !part.elf(&folder).is_file()) {
        eprintln!("staya: building the firmware for {}; the first time takes some minutes", names.join(", "));
    }
    let began = Instant::now();
    xtask(root, &[&["firmware", "--bin", "lockstep"], names.as_slice()].concat())?;
    for part in parts {
        let elf = part.elf(&folder);
        eprintln!("staya: {} is up to date, after {:.0} s", elf.display(), began.elapsed().as_secs_f64());
    }
    if !parts.iter().all(|part| find_emulator(part.emulator()).is_some()) {
        eprintln!("staya: fetching the emulators; this takes a minute");
        xtask(root, &["qemu"])?;
    }
    Ok(())
}

/// One of the repository's own commands; what it prints goes to standard error, all of it only if it fails.
fn xtask(root: &Path, arguments: &[&str]) -> Result<()> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let line = format!("cargo xtask {}", arguments.join(" "));
    eprintln!("staya: {line}");
    let mut command = Command::new(cargo);
    // What cargo told this program about its package is not true of the next one.
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
        eprintln!("staya: {}", skipped.trim());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_folder_with_all_firmware_is_taken() {
        let top = tempfile::tempdir().expect("a folder");
        let [one, two, both] = ["one", "two", "both"].map(|name| top.path().join(name));
        let parts = [Part::Stm32f405, Part::Microbit];
        for (folder, part) in [(&one, parts[0]), (&two, parts[1]), (&both, parts[0]), (&both, parts[1])] {
            let elf = part.elf(folder);
            std::fs::create_dir_all(elf.parent().expect("a parent")).expect("a folder");
            std::fs::write(elf, "").expect("a file");
        }
        let places = vec![one.clone(), two.clone(), both.clone()];
        assert_eq!(first_with_all(&parts, places).expect("found"), both);
        assert_eq!(first_with_all(&parts[1..], vec![one.clone(), two.clone()]).expect("found"), two);
        let error = first_with_all(&parts, vec![one.clone(), two.clone()]).expect_err("not there").to_string();
        for text in [
            parts[1].elf(&one).display().to_string(),
            parts[0].elf(&two).display().to_string(),
            String::from("cargo xtask firmware --bin lockstep stm32f405 nrf51"),
            String::from("--firmware"),
            String::from(VARIABLE),
        ] {
            assert!(error.contains(&text), "{error}");
        }
    }
}
