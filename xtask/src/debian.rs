//! Debian's packaged Rust, which can build `core` from source for any target, where rustup's
//! targets are out of reach.

use crate::apt;
use crate::repo::{Repo, output_of};
use std::path::{Path, PathBuf};
use std::process::Command;

const PACKAGES: [&str; 4] = ["rustc-web", "cargo-web", "rust-web-src", "lld"];
const PROGRAMS: [&str; 3] = ["rustc", "cargo", "ld.lld"];
/// What a person without these packages should run; either line is enough.
const REMEDY: &str = "run `rustup target add thumbv7em-none-eabihf thumbv6m-none-eabi \
    riscv32imac-unknown-none-elf` \
    or, on Debian, as root `apt-get update && apt-get install rustc-web cargo-web rust-web-src lld`";

/// Debian's Rust, with the sources of `core`.
#[derive(Clone)]
pub struct Rust {
    /// The folder of its programs.
    bin: PathBuf,
}

/// Finds the packages, or unpacks them. The error says why they are not there, and what to do.
pub fn prepare(repo: &Repo) -> Result<Rust, String> {
    let find = || {
        let places = [PathBuf::from("/usr/bin"), repo.tools()];
        let mut found = places.into_iter().map(|bin| Rust { bin });
        found.find(|rust| rust.is_complete(repo))
    };
    if let Some(rust) = find() {
        return Ok(rust);
    }
    println!("\nNo installed toolchain has the targets, and Debian's packages are not complete.");
    apt::unpack(repo, &PACKAGES, &PROGRAMS)
        .map_err(|reason| format!("no toolchain for microcontrollers ({reason}); {REMEDY}"))?;
    find().ok_or_else(|| format!("Debian's Rust lacks the sources of core; {REMEDY}"))
}

impl Rust {
    /// Its cargo with these arguments, with its rustc, allowed to build `core`, in a target folder of its own: two compilers in
    /// one folder would build everything anew at each change.
    pub fn cargo(&self, repo: &Repo, arguments: &[&str]) -> Command {
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
            .env("CARGO_TARGET_DIR", target_folder(repo));
        command
    }

    /// Whether compiler, cargo, linker and the sources of `core` are all there.
    fn is_complete(&self, repo: &Repo) -> bool {
        let sysroot = output_of(repo.command(self.bin.join("rustc")).args(["--print", "sysroot"]));
        let sources = sysroot.map(|root| Path::new(&root).join("lib/rustlib/src/rust/library/core/src/lib.rs"));
        let programs = PROGRAMS.iter().all(|program| self.bin.join(program).is_file());
        programs && sources.is_some_and(|sources| sources.is_file())
    }
}

/// Where Debian's cargo builds.
pub fn target_folder(repo: &Repo) -> PathBuf {
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
}
