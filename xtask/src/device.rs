//! Microcontrollers, and what compiles for them: rustup's targets or Debian's packages.

use crate::apt::Tools;
use crate::repo::{Repo, Words as _, output_of};
use crate::report::skipped;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A microcontroller that there is firmware for.
pub struct Part {
    /// As in `hil/firmware` and on the command line.
    pub name: &'static str,
    /// The target that its code is compiled for.
    pub target: &'static str,
    /// The emulator that runs it, and its options for the machine.
    pub emulator: &'static str,
    pub machine: &'static str,
}

/// Every part.
pub const PARTS: [Part; 3] = [
    Part {
        name: "stm32f405",
        target: "thumbv7em-none-eabihf",
        emulator: "qemu-system-arm",
        machine: "-machine netduinoplus2",
    },
    Part { name: "nrf51", target: "thumbv6m-none-eabi", emulator: "qemu-system-arm", machine: "-machine microbit" },
    Part {
        name: "riscv32",
        target: "riscv32imac-unknown-none-elf",
        emulator: "qemu-system-riscv32",
        // Without firmware of the machine's own, which would be loaded over ours.
        machine: "-machine virt -bios none",
    },
];

/// The part with an FPU and room for all of the controller.
pub const STM32F405: &Part = &PARTS[0];

/// The names of [`PARTS`].
pub const NAMES: [&str; 3] = [PARTS[0].name, PARTS[1].name, PARTS[2].name];

/// The part of this name.
pub fn part(name: &str) -> Result<&'static Part, String> {
    PARTS.iter().find(|part| part.name == name).ok_or_else(|| format!("the parts are {}", NAMES.join(", ")))
}

/// Debian's packaged Rust, which can build `core` from source for any target.
const DEBIAN: Tools = Tools {
    packages: "rustc-web cargo-web rust-web-src lld",
    programs: "rustc cargo ld.lld",
    question: "for bin in /usr/bin \"$1\"; do
        core=$(\"$bin/rustc\" --print sysroot)/lib/rustlib/src/rust/library/core/src/lib.rs
        if [ -f \"$bin/cargo\" ] && [ -f \"$bin/ld.lld\" ] && [ -f \"$core\" ]; then echo \"$bin\"; exit; fi
    done; exit 1",
    ways: "unpack",
};
const REMEDY: &str = "run `rustup target add thumbv7em-none-eabihf thumbv6m-none-eabi riscv32imac-unknown-none-elf`";

/// Where `core` for a microcontroller comes from.
#[derive(Clone)]
pub enum Toolchain {
    /// The toolchain that runs this program has the target.
    Own,
    /// Debian's packages, whose programs are in this folder, build it from source.
    Debian(PathBuf),
}

/// Finds toolchains; looks for Debian's packages (and fetches them) once, and only if a target
/// needs them.
#[derive(Default)]
pub struct Toolchains {
    debian: Option<Result<PathBuf, String>>,
}

impl Toolchains {
    /// The toolchain for a target. Without one a part is skipped; the error says why there is none,
    /// and what to do.
    pub fn find(&mut self, repo: &Repo, target: &str) -> anyhow::Result<Toolchain> {
        let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
        let folder = output_of(repo.command(rustc).args(["--print", "target-libdir", "--target", target]));
        if folder.is_some_and(|folder| Path::new(&folder).is_dir()) {
            return Ok(Toolchain::Own);
        }
        let find = || {
            DEBIAN.prepare(repo).map_err(|reason| format!("{reason}; or {REMEDY}"))?;
            repo.answer(DEBIAN.question).map(PathBuf::from).ok_or_else(|| REMEDY.into())
        };
        self.debian.get_or_insert_with(find).clone().map(Toolchain::Debian).map_err(skipped)
    }
}

impl Toolchain {
    /// Cargo for a target, with its subcommand and the arguments of this line.
    pub fn cargo(&self, repo: &Repo, target: &str, line: &str) -> Command {
        let (subcommand, arguments) = line.split_once(' ').unwrap_or((line, ""));
        let mut command = match self {
            Self::Own => repo.cargo(subcommand),
            Self::Debian(bin) => {
                let mut command = repo.command(bin.join("cargo"));
                // Cargo and rustup tell their children which toolchain runs; that is another one
                // here.
                for (name, _) in std::env::vars_os().filter(|(name, _)| names_a_toolchain(&name.to_string_lossy())) {
                    command.env_remove(name);
                }
                command.args([subcommand, "-Zbuild-std=core"]);
                command.env("RUSTC", bin.join("rustc")).env("RUSTC_BOOTSTRAP", "1");
                // The targets ask for Rust's own copy of the linker, which Debian does not have.
                let linker = format!("CARGO_TARGET_{}_LINKER", target.to_uppercase().replace(['-', '.'], "_"));
                command.env(linker, "ld.lld").env("CARGO_TARGET_DIR", self.target_folder(repo));
                command
            }
        };
        command.args(["--target", target]).words(arguments);
        // The same for every command: another level rebuilds everything that logs.
        if std::env::var_os("DEFMT_LOG").is_none() {
            command.env("DEFMT_LOG", "info");
        }
        command
    }

    /// Where it builds: two compilers in one folder would rebuild everything at each change.
    pub fn target_folder(&self, repo: &Repo) -> PathBuf {
        match self {
            Self::Own => repo.target.clone(),
            Self::Debian(_) => repo.target.join("debian"),
        }
    }
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
}
