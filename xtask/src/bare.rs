//! `cargo xtask bare`: the project's own way to emulators and compilers, proven on a bare Debian.
//!
//! debootstrap makes a root of its own with a C compiler and nothing else. A package in it excludes those of the emulators and of
//! Debian's Rust, as the `qemu-utils` of backports excludes the former. There this program, with the Rust that runs it, must find
//! emulators and compiler, and run firmware on emulated parts; with Python besides, it must find a browser and show it pages.
//! Afterwards exactly those packages must be installed that were before.

use crate::apt;
use crate::repo::{Repo, output_of, run};
use crate::report::Report;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const NAME: &str = "a bare Debian";
/// What a user has to have, as the README says, and Python, which alone would be installed.
const PREREQUISITES: &str = "gcc,libc6-dev,ca-certificates,python3,python3-venv";
/// Excludes what must be fetched.
const IN_THE_WAY: &str = "Package: in-the-way\n\
    Version: 1\n\
    Architecture: all\n\
    Maintainer: nobody <nobody@localhost>\n\
    Conflicts: qemu-system-common, rustc-web, lld\n\
    Description: excludes emulators and compilers, to see whether they are had all the same\n";
/// A script in the root, which puts repository and Rust in place and runs its argument there.
const SCRIPT: &str = "inside.sh";
const SCRIPT_TEXT: &str = r#"set -e
place() { mount --bind "$1" "$2"; mount -o "remount,bind,$3" "$2"; }
place "$REPO" "$BARE/repo" ro
place "$RUST" "$BARE/rust" ro
place "$CARGO" "$BARE/cargo" rw
mount -t proc proc "$BARE/proc"
exec chroot "$BARE" env --ignore-environment CI=true HOME=/root CARGO_HOME=/cargo CARGO_TARGET_DIR=/build \
    PATH=/rust/bin:/usr/sbin:/usr/bin:/sbin:/bin sh -ec "cd /repo; $1"
"#;
/// What must work there: parts with both emulators, and a browser.
const COMMANDS: [&str; 3] = ["qemu", "faults nrf51 riscv32", "browser"];
/// Lists what is installed.
const INSTALLED: [&str; 3] = ["dpkg-query", "--show", "--showformat=${Package} ${Version}\\n"];

/// Makes the root and runs the commands in it.
pub fn run_command(repo: &Repo, report: &mut Report) {
    let bare = match Bare::find(repo) {
        Ok(bare) => bare,
        Err(reason) => return report.skip(NAME, &reason),
    };
    if !report.step(NAME, || bare.make(repo)) {
        return;
    }
    let before = bare.installed(repo);
    for command in COMMANDS {
        let line = format!("cargo xtask {command}");
        report.command(&format!("{line}, there"), bare.inside(repo, &line));
    }
    report.step("nothing installed, removed or replaced there", || {
        if before.is_some() && bare.installed(repo) == before {
            Ok(())
        } else {
            Err(String::from("the packages are not what they were"))
        }
    });
}

/// A root of its own.
struct Bare {
    root: PathBuf,
    /// Debian's release: `bookworm`.
    codename: String,
    /// Where the machine's apt takes it from.
    mirror: String,
    /// The machine's sources of Debian's packages, as apt reads them.
    sources: String,
    /// The Rust that runs this program, and what cargo has fetched.
    toolchain: PathBuf,
    cargo_home: PathBuf,
}

impl Bare {
    /// What is needed for it. The error says what is missing.
    fn find(repo: &Repo) -> Result<Self, String> {
        if !apt::is_root(repo) {
            return Err(String::from("chroot needs root"));
        }
        let release = fs::read_to_string("/etc/os-release").unwrap_or_default();
        let codename = release.lines().find_map(|line| line.strip_prefix("VERSION_CODENAME=")).ok_or("no Debian")?;
        let format = ["--format", "$(REPO_URI) $(RELEASE) $(COMPONENT) $(ORIGIN)"];
        let mut targets = repo.command("apt-get");
        let targets = targets.arg("indextargets").args(format);
        let targets = output_of(targets.arg("Created-By: Packages")).ok_or("no apt-get here")?;
        let (mirror, sources) =
            read(&targets, codename).ok_or_else(|| format!("apt has no source of Debian {codename}"))?;
        if debootstrap(repo).is_none() {
            apt::unpack(repo, &["debootstrap"], &["debootstrap"])
                .map_err(|reason| format!("no debootstrap ({reason})"))?;
        }
        let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
        let toolchain = output_of(repo.command(rustc).args(["--print", "sysroot"]));
        let home = || Some(PathBuf::from(std::env::var_os("HOME")?).join(".cargo"));
        let cargo_home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
        Ok(Self {
            root: repo.target.join("bare"),
            codename: codename.to_string(),
            mirror,
            sources,
            toolchain: toolchain.ok_or("no rustc here")?.into(),
            cargo_home: cargo_home.or_else(home).ok_or("no HOME")?,
        })
    }

    /// Makes it anew, with the package that is in the way.
    fn make(&self, repo: &Repo) -> Result<(), String> {
        if self.root.exists() {
            fs::remove_dir_all(&self.root).map_err(|error| error.to_string())?;
        }
        let mut make = debootstrap(repo).ok_or("no debootstrap")?;
        make.args(["--variant=minbase", "--include", PREREQUISITES]);
        run(make.arg(&self.codename).arg(&self.root).arg(&self.mirror))?;
        self.write("etc/apt/sources.list", &self.sources)?;
        for file in ["/etc/resolv.conf", "/etc/hosts", "/etc/ssl/certs/ca-certificates.crt", "/etc/pip.conf"] {
            // Not every machine has each.
            let _ = fs::copy(file, self.root.join(file.trim_start_matches('/')));
        }
        for folder in ["repo", "rust", "cargo", "build"] {
            let folder = self.root.join(folder);
            fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
        }
        self.write(SCRIPT, SCRIPT_TEXT)?;
        self.write("in-the-way/DEBIAN/control", IN_THE_WAY)?;
        run(&mut self.inside(repo, "dpkg-deb --build /in-the-way && dpkg --install /in-the-way.deb"))
    }

    fn write(&self, file: &str, text: &str) -> Result<(), String> {
        let path = self.root.join(file);
        let parent = path.parent().unwrap_or(&self.root);
        let written = fs::create_dir_all(parent).and_then(|()| fs::write(&path, text));
        written.map_err(|error| format!("{}: {error}", path.display()))
    }

    /// A line for its shell, with repository and Rust in place, none of which it can change. The mounts end with it.
    fn inside(&self, repo: &Repo, line: &str) -> Command {
        let mut command = repo.command("unshare");
        command.args(["--mount", "sh"]).arg(self.root.join(SCRIPT));
        command.arg(line);
        command.env("REPO", &repo.root).env("BARE", &self.root);
        command.env("RUST", &self.toolchain);
        command.env("CARGO", &self.cargo_home);
        command
    }

    /// What is installed there.
    fn installed(&self, repo: &Repo) -> Option<String> {
        let [program, show, format] = INSTALLED;
        output_of(repo.command("chroot").arg(&self.root).args([program, show, format]))
    }
}

/// Reads `apt-get indextargets`: the mirror of this release, and all of Debian's sources.
fn read(targets: &str, codename: &str) -> Option<(String, String)> {
    let (mut mirror, mut sources) = (None, String::new());
    for line in targets.lines() {
        let [uri, release, component, origin, ..] = line.split(' ').collect::<Vec<_>>()[..] else {
            continue;
        };
        if origin == "Debian" {
            sources += &format!("deb {uri} {release} {component}\n");
            if release == codename {
                mirror = Some(uri.to_string());
            }
        }
    }
    Some((mirror?, sources))
}

/// debootstrap, installed or unpacked; a shell script that has to be told where the rest of it is.
fn debootstrap(repo: &Repo) -> Option<Command> {
    let unpacked = repo.target.join("tools/unpacked/usr/share/debootstrap");
    let mut command = if Path::new("/usr/sbin/debootstrap").is_file() {
        repo.command("/usr/sbin/debootstrap")
    } else if repo.tools().join("debootstrap").is_file() {
        repo.command(repo.tools().join("debootstrap"))
    } else {
        return None;
    };
    if unpacked.is_dir() {
        command.env("DEBOOTSTRAP_DIR", unpacked);
    }
    Some(command)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn debians_own_sources_are_taken_and_no_others() {
        let targets = "mirror/debian/ bookworm main Debian\n\
            mirror/security/ bookworm-security main Debian\n\
            elsewhere/ nodistro main . nodistro\n";
        let (mirror, sources) = read(targets, "bookworm").unwrap();
        assert_eq!(mirror, "mirror/debian/");
        let expected = "deb mirror/debian/ bookworm main\n\
            deb mirror/security/ bookworm-security main\n";
        assert_eq!(sources, expected);
        assert_eq!(read(targets, "trixie"), None);
    }
}
