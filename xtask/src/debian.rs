//! Debian's packaged Rust, which can build `core` from source for any target, where rustup's
//! targets are out of reach.

use crate::repo::{Repo, output_of, run};
use std::path::{Path, PathBuf};
use std::process::Command;

const PACKAGES: [&str; 4] = ["rustc-web", "cargo-web", "rust-web-src", "lld"];
const RUSTC: &str = "/usr/bin/rustc";
const CARGO: &str = "/usr/bin/cargo";
/// What a person without these packages should run; either line is enough.
const REMEDY: &str = "run `rustup target add thumbv7em-none-eabihf thumbv6m-none-eabi \
    riscv32imac-unknown-none-elf` \
    or, on Debian, as root `apt-get update && apt-get install rustc-web cargo-web rust-web-src lld`";

/// Makes sure that the packages are there: installs them as root on Debian. The error says why
/// they are not, and what to do.
pub fn prepare(repo: &Repo) -> Result<(), String> {
    if is_complete(repo) {
        return Ok(());
    }
    println!("\nNo installed toolchain has the targets, and Debian's packages are not complete.");
    if !can_install(repo) {
        return Err(format!("no toolchain for microcontrollers; {REMEDY}"));
    }
    install(repo, &PACKAGES).map_err(|reason| format!("apt-get failed ({reason}); {REMEDY}"))?;
    if is_complete(repo) {
        Ok(())
    } else {
        let version = output_of(repo.command(RUSTC).arg("--version")).unwrap_or_default();
        Err(format!(
            "Debian's Rust ({version}) lacks the sources of core; {REMEDY}"
        ))
    }
}

/// Whether packages can be installed: as root on Debian.
pub fn can_install(repo: &Repo) -> bool {
    is_debian() && output_of(repo.command("id").arg("-u")).as_deref() == Some("0")
}

/// Installs packages. The error says why not.
pub fn install(repo: &Repo, packages: &[&str]) -> Result<(), String> {
    println!("Installing {}:", packages.join(", "));
    run(&mut apt_get(repo, &["update"]))?;
    // Nothing that is installed may have to go for it.
    let install = ["install", "--yes", "--no-install-recommends", "--no-remove"];
    run(apt_get(repo, &install).args(packages))
}

/// Debian's cargo with these arguments, with Debian's rustc, allowed to build `core`, in a target
/// folder of its own: two compilers in one folder would build everything anew at each change.
pub fn cargo(repo: &Repo, arguments: &[&str]) -> Command {
    let mut command = repo.command(CARGO);
    // Cargo and rustup tell their children which toolchain runs; that is another one here.
    for (name, _) in std::env::vars_os() {
        if name.to_str().is_some_and(names_a_toolchain) {
            command.env_remove(name);
        }
    }
    command
        .args(arguments)
        .env("RUSTC", RUSTC)
        .env("RUSTC_BOOTSTRAP", "1")
        .env("CARGO_TARGET_DIR", target_folder(repo));
    command
}

/// Where Debian's cargo builds.
pub fn target_folder(repo: &Repo) -> PathBuf {
    repo.target.join("debian")
}

/// Whether an environment variable chooses a compiler, its flags or its libraries.
fn names_a_toolchain(variable: &str) -> bool {
    const NAMES: [&str; 5] = [
        "CARGO",
        "CARGO_ENCODED_RUSTFLAGS",
        "CARGO_BUILD_RUSTFLAGS",
        "CARGO_BUILD_TARGET",
        "LD_LIBRARY_PATH",
    ];
    const BEGINNINGS: [&str; 4] = ["RUST", "CARGO_BUILD_RUSTC", "CARGO_PKG_", "CARGO_MANIFEST_"];
    NAMES.contains(&variable) || BEGINNINGS.iter().any(|start| variable.starts_with(start))
}

/// Whether Debian's compiler, cargo and the sources of `core` are all there.
fn is_complete(repo: &Repo) -> bool {
    let sysroot = output_of(repo.command(RUSTC).args(["--print", "sysroot"]));
    let sources = |root: String| {
        Path::new(&root)
            .join("lib/rustlib/src/rust/library/core/src/lib.rs")
            .is_file()
    };
    Path::new(CARGO).is_file() && sysroot.is_some_and(sources)
}

fn is_debian() -> bool {
    std::fs::read_to_string("/etc/os-release")
        .is_ok_and(|text| text.lines().any(|line| line == "ID=debian"))
}

/// apt-get that asks nothing and waits for another one to finish.
fn apt_get(repo: &Repo, arguments: &[&str]) -> Command {
    let mut command = repo.command("apt-get");
    command
        .args(["--quiet", "-o", "DPkg::Lock::Timeout=300"])
        .args(arguments)
        .env("DEBIAN_FRONTEND", "noninteractive");
    command
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn toolchain_of_the_parent_does_not_leak() {
        for name in [
            "RUSTC",
            "RUSTUP_TOOLCHAIN",
            "RUSTC_WRAPPER",
            "CARGO",
            "CARGO_BUILD_RUSTC_WRAPPER",
        ] {
            assert!(names_a_toolchain(name), "{name}");
        }
        for name in [
            "PATH",
            "HOME",
            "CARGO_HOME",
            "CARGO_BUILD_JOBS",
            "CARGO_HTTP_PROXY",
        ] {
            assert!(!names_a_toolchain(name), "{name}");
        }
    }
}
