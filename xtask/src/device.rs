//! Microcontrollers, and what compiles for them: rustup's targets or Debian's packages.

use crate::apt::Tools;
use crate::repo::{Repo, output_of};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A microcontroller that there is firmware for.
pub struct Part {
    /// As in `hil/firmware` and on the command line.
    pub name: &'static str,
    /// The target that its code is compiled for.
    pub target: &'static str,
    /// The emulator that runs it.
    pub emulator: &'static str,
}

/// Every part.
pub const PARTS: [Part; 3] = [
    Part { name: "stm32f405", target: "thumbv7em-none-eabihf", emulator: "qemu-system-arm" },
    Part { name: "nrf51", target: "thumbv6m-none-eabi", emulator: "qemu-system-arm" },
    Part { name: "riscv32", target: "riscv32imac-unknown-none-elf", emulator: "qemu-system-riscv32" },
];

/// The part with an FPU and room for all of the controller.
pub const STM32F405: &Part = &PARTS[0];

/// The parts of these names; all of them without names.
pub fn parts(names: &[&str]) -> Vec<&'static Part> {
    PARTS.iter().filter(|part| names.is_empty() || names.contains(&part.name)).collect()
}

/// Debian's packaged Rust, which can build `core` from source for any target.
const DEBIAN: Tools =
    Tools { packages: &["rustc-web", "cargo-web", "rust-web-src", "lld"], programs: &["rustc", "cargo", "ld.lld"] };
const REMEDY: &str = "run `rustup target add thumbv7em-none-eabihf thumbv6m-none-eabi riscv32imac-unknown-none-elf`";

/// Where `core` for a microcontroller comes from.
pub enum Toolchain {
    /// The toolchain that runs this program has the target.
    Own,
    /// Debian's packages build it from source.
    Debian(Debian),
}

/// Finds toolchains; looks for Debian's packages (and fetches them) once, and only if a target
/// needs them.
#[derive(Default)]
pub struct Toolchains {
    debian: Option<Result<Debian, String>>,
}

impl Toolchains {
    /// The toolchain for a target. The error says why there is none, and what to do.
    pub fn find(&mut self, repo: &Repo, target: &str) -> Result<Toolchain, String> {
        if has_target(repo, target) {
            return Ok(Toolchain::Own);
        }
        let ready = self.debian.get_or_insert_with(|| prepare(repo));
        ready.clone().map(Toolchain::Debian)
    }
}

impl Toolchain {
    /// Cargo's subcommand for a target.
    pub fn cargo(&self, repo: &Repo, target: &str, subcommand: &str) -> Command {
        let mut command = match self {
            Self::Own => repo.cargo(&[subcommand]),
            Self::Debian(rust) => {
                let mut command = rust.cargo(repo, &[subcommand, "-Zbuild-std=core"]);
                // The targets ask for Rust's own copy of the linker, which Debian does not have.
                let target = target.to_uppercase().replace(['-', '.'], "_");
                command.env(format!("CARGO_TARGET_{target}_LINKER"), "ld.lld");
                command
            }
        };
        command.args(["--target", target]);
        // The same for every command: another level rebuilds everything that logs.
        if std::env::var_os("DEFMT_LOG").is_none() {
            command.env("DEFMT_LOG", "info");
        }
        command
    }

    /// Where it builds.
    pub fn target_folder(&self, repo: &Repo) -> PathBuf {
        match self {
            Self::Own => repo.target.clone(),
            Self::Debian(_) => debian_folder(repo),
        }
    }
}

/// Whether the toolchain that runs this program ships `core` for a target.
fn has_target(repo: &Repo, target: &str) -> bool {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let mut question = repo.command(rustc);
    question.args(["--print", "target-libdir", "--target", target]);
    output_of(&mut question).is_some_and(|folder| Path::new(&folder).is_dir())
}

/// Debian's Rust, with the sources of `core`.
#[derive(Clone)]
pub struct Debian {
    /// The folder of its programs.
    bin: PathBuf,
}

/// Finds the packages, or unpacks them. The error says why they are not there, and what to do.
fn prepare(repo: &Repo) -> Result<Debian, String> {
    let find = || {
        let places = [PathBuf::from("/usr/bin"), repo.tools()];
        places.into_iter().map(|bin| Debian { bin }).find(|rust| rust.is_complete(repo))
    };
    DEBIAN.prepare(repo, || find().is_some()).map_err(|reason| format!("{reason}; or {REMEDY}"))?;
    find().ok_or_else(|| String::from(REMEDY))
}

impl Debian {
    /// Its cargo with these arguments, with its rustc, allowed to build `core`, in a target folder
    /// of its own: two compilers in one folder would rebuild everything at each change.
    fn cargo(&self, repo: &Repo, arguments: &[&str]) -> Command {
        let mut command = repo.command(self.bin.join("cargo"));
        // Cargo and rustup tell their children which toolchain runs; that is another one here.
        for (name, _) in std::env::vars_os() {
            if name.to_str().is_some_and(names_a_toolchain) {
                command.env_remove(name);
            }
        }
        command
            .args(arguments)
            .env("RUSTC", self.bin.join("rustc"))
            .env("RUSTC_BOOTSTRAP", "1")
            .env("CARGO_TARGET_DIR", debian_folder(repo));
        command
    }

    /// Whether compiler, cargo, linker and the sources of `core` are all there.
    fn is_complete(&self, repo: &Repo) -> bool {
        let sysroot = output_of(repo.command(self.bin.join("rustc")).args(["--print", "sysroot"]));
        let sources = sysroot.map(|root| Path::new(&root).join("lib/rustlib/src/rust/library/core/src/lib.rs"));
        let programs = DEBIAN.programs.iter().all(|program| self.bin.join(program).is_file());
        programs && sources.is_some_and(|sources| sources.is_file())
    }
}

/// Where Debian's cargo builds.
fn debian_folder(repo: &Repo) -> PathBuf {
    repo.target.join("debian")
}

/// Whether an environment variable chooses a compiler, its flags or its libraries.
fn names_a_toolchain(variable: &str) -> bool {
    const NAMES: [&str; 5] =
        ["CARGO", "CARGO_ENCODED_RUSTFLAGS", "CARGO_BUILD_RUSTFLAGS", "CARGO_BUILD_TARGET", "LD_LIBRARY_PATH"];
    const BEGINNINGS: [&str; 4] = ["RUST", "CARGO_BUILD_RUSTC", "CARGO_PKG_", "CARGO_MANIFEST_"];
    NAMES.contains(&variable) || BEGINNINGS.iter().any(|start| variable.starts_with(start))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn toolchain_of_the_parent_does_not_leak() {
        for name in ["RUSTC", "RUSTUP_TOOLCHAIN", "RUSTC_WRAPPER", "CARGO", "CARGO_BUILD_RUSTC_WRAPPER"] {
            assert!(names_a_toolchain(name), "{name}");
        }
        for name in ["PATH", "HOME", "CARGO_HOME", "CARGO_BUILD_JOBS", "CARGO_HTTP_PROXY"] {
            assert!(!names_a_toolchain(name), "{name}");
        }
    }

    #[test]
    fn parts_are_found_by_their_names() {
        let names = |names: &[&str]| parts(names).iter().map(|part| part.name).collect::<Vec<_>>();
        assert_eq!(names(&["nrf51"]), ["nrf51"]);
        assert_eq!(names(&[]), PARTS.each_ref().map(|part| part.name));
    }
}
