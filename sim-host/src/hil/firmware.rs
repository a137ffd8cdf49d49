//! What emulated devices run: ELF files that `cargo xtask firmware` makes.

use anyhow::{Context as _, Result, bail};
use staya_runner::Part;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The folder with firmware for these parts. Started by cargo in the repository, it builds what is missing or old, and installs the
/// emulators where that is possible; started otherwise, it looks beside the folder of this program.
///
/// # Errors
/// Firmware or an emulator that is not there, with what to do.
pub fn folder(parts: &[Part], given: Option<&Path>) -> Result<PathBuf> {
    let folder = match (given, repository()) {
        (Some(folder), _) => folder.to_owned(),
        (None, Some(root)) => {
            prepare(&root, parts)?;
            target(&root).join("firmware")
        }
        (None, None) => beside_this_program()?,
    };
    for part in parts {
        let file = part.elf(&folder);
        if !file.is_file() {
            let name = part.firmware_name();
            bail!(
                "no firmware {} for qemu:{}: `cargo xtask firmware {name}` makes it, or name its folder with --firmware",
                file.display(),
                part.name()
            );
        }
    }
    Ok(folder)
}

/// The repository, if cargo started this program there.
fn repository() -> Option<PathBuf> {
    std::env::var_os("CARGO")?;
    let manifest = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR")?);
    let root = manifest.parent()?.to_path_buf();
    root.join("xtask/Cargo.toml").is_file().then_some(root)
}

fn target(root: &Path) -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(
        || root.join("target"),
        |folder| std::path::absolute(&folder).unwrap_or_else(|_| folder.into()),
    )
}

/// `target/release/staya` has its firmware in `target/firmware`.
fn beside_this_program() -> Result<PathBuf> {
    let program = std::env::current_exe().context("cannot tell where this program is")?;
    let target = program.ancestors().nth(2);
    Ok(target.unwrap_or(&program).join("firmware"))
}

fn prepare(root: &Path, parts: &[Part]) -> Result<()> {
    let names: Vec<&str> = parts.iter().map(|part| part.firmware_name()).collect();
    if names.is_empty() {
        return Ok(());
    }
    xtask(root, &[&["firmware"], names.as_slice()].concat())?;
    let needs_emulator = parts.iter().any(|part| !runs(part.emulator()));
    if needs_emulator {
        xtask(root, &["qemu"])?;
    }
    Ok(())
}

/// Whether a program can be started.
fn runs(program: &str) -> bool {
    let mut command = Command::new(program);
    let command = command.arg("--version").stdin(Stdio::null());
    let ended = command.stdout(Stdio::null()).stderr(Stdio::null()).status();
    ended.is_ok_and(|status| status.success())
}

/// One of the repository's own commands; what it prints goes to standard error, all of it only if it fails.
fn xtask(root: &Path, arguments: &[&str]) -> Result<()> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let line = format!("cargo xtask {}", arguments.join(" "));
    eprintln!("staya: {line}");
    let mut command = Command::new(cargo);
    // What cargo told this program about its package is not true of the next one.
    for (name, _) in std::env::vars_os() {
        let is_cargos = name.to_str().is_some_and(|name| {
            name.starts_with("CARGO_PKG_") || name.starts_with("CARGO_MANIFEST_")
        });
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
    for skipped in said
        .lines()
        .filter(|line| line.contains("no toolchain") || line.contains("no qemu"))
    {
        eprintln!("staya: {}", skipped.trim());
    }
    Ok(())
}
