//! Programs from Debian's packages, unpacked into `target/tools` and run from there.
//!
//! Nothing is installed for them: that needs no root, and no package of the user's is in the way of another one (Debian's
//! emulators exclude the `qemu-utils` of backports, for one). apt says which packages this machine lacks; `dpkg-deb` unpacks
//! those; a small script for each program starts it with the libraries that came along. Only what does not work from another
//! place than its own (Python; tshark for root) is installed ([`install`]), as root and if nothing has to go or change for it.

use crate::repo::{Repo, output_of, run};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Where programs are. Chromium's has a script of the same name in `usr/bin`, which starts what is installed.
const PROGRAMS: [&str; 3] = ["usr/lib/chromium", "usr/bin", "usr/sbin"];

/// What apt would do for some packages.
#[derive(Debug, Default, PartialEq, Eq)]
struct Installation {
    /// The packages that are missing, as `name=version`, with all that they need.
    missing: Vec<String>,
    /// Packages of the user's that would be removed or replaced.
    in_the_way: Vec<String>,
}

/// Makes `programs` from `packages` available in [`Repo::tools`], where [`Repo::command`] finds them. The error says why they are not.
pub fn unpack(repo: &Repo, packages: &[&str], programs: &[&str]) -> Result<(), String> {
    // What is installed in part is unpacked whole.
    let plan = plan(repo, &[&["--reinstall"], packages].concat())?;
    let home = home(repo);
    let (root, archives) = (home.join("unpacked"), home.join("archives"));
    make(&archives)?;
    run(apt_get(repo, &["download"]).args(&plan.missing).current_dir(&archives))?;
    for archive in files(&archives)? {
        let mut unpack = repo.command("dpkg-deb");
        let unpack = unpack.arg("-x").arg(&archive).arg(&root);
        output_of(unpack).ok_or_else(|| format!("cannot unpack {}", archive.display()))?;
    }
    relink(&root, &root).map_err(|error| format!("{}: {error}", root.display()))?;
    fs::remove_dir_all(&archives).map_err(|error| format!("{}: {error}", archives.display()))?;
    write_fonts(repo, &root)?;
    println!("Unpacked into {}", root.display());
    // The scripts come last: what has one is complete.
    make(&repo.tools())?;
    programs.iter().try_for_each(|name| write_script(repo, &root, name))
}

/// A folder by this name among the libraries that were unpacked.
pub fn unpacked(repo: &Repo, name: &str) -> Option<PathBuf> {
    libraries(&home(repo).join("unpacked")).into_iter().find(|folder| folder.ends_with(name))
}

/// The script that starts an unpacked program, if there is one.
pub fn script(repo: &Repo, name: &str) -> Option<PathBuf> {
    Some(repo.tools().join(name)).filter(|script| script.is_file())
}

/// Installs packages, as root, if nothing that is installed has to go or change for it. The error says why not.
pub fn install(repo: &Repo, packages: &[&str]) -> Result<(), String> {
    if !is_root(repo) {
        return Err(String::from("only root can install packages"));
    }
    let Installation { in_the_way, .. } = plan(repo, packages)?;
    if !in_the_way.is_empty() {
        let those = in_the_way.join(", ");
        return Err(format!("that would remove or replace {those}"));
    }
    let install = ["install", "--yes", "--no-install-recommends", "--no-remove"];
    run(apt_get(repo, &install).args(packages))
}

/// Whether this program runs as root.
pub fn is_root(repo: &Repo) -> bool {
    output_of(repo.command("id").arg("-u")).as_deref() == Some("0")
}

/// Asks apt, with lists of packages that are up to date, what an installation with these arguments takes.
fn plan(repo: &Repo, arguments: &[&str]) -> Result<Installation, String> {
    if output_of(repo.command("apt-get").arg("--version")).is_none() {
        return Err(String::from("no apt-get here"));
    }
    let home = home(repo);
    make(&home.join("lists/partial"))?;
    make(&home.join("cache/archives/partial"))?;
    run(&mut apt_get(repo, &["update"]))?;
    let simulate = ["install", "--simulate", "--no-install-recommends"];
    let said = output_of(apt_get(repo, &simulate).args(arguments))
        .ok_or_else(|| format!("apt-get finds no way to install {}", arguments.join(" ")))?;
    Ok(read(&said))
}

/// Reads what a simulation prints: `Inst NAME [INSTALLED] (VERSION ORIGIN [ARCHITECTURE])`, `Remv NAME [INSTALLED]`.
fn read(said: &str) -> Installation {
    let mut plan = Installation::default();
    for line in said.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [action @ ("Inst" | "Remv"), name, second, ..] = words[..] else {
            continue;
        };
        if second.starts_with('[') {
            plan.in_the_way.push(name.to_string());
        }
        let version = words.iter().find_map(|word| word.strip_prefix('('));
        if let ("Inst", Some(version)) = (action, version) {
            plan.missing.push(format!("{name}={version}"));
        }
    }
    plan
}

/// Turns absolute links below a folder to what came along below `root`.
fn relink(root: &Path, folder: &Path) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let (path, kind) = entry.and_then(|entry| Ok((entry.path(), entry.file_type()?)))?;
        if kind.is_dir() {
            relink(root, &path)?;
        } else if kind.is_symlink() {
            let to = fs::read_link(&path)?;
            let inside = to.strip_prefix("/").map(|to| root.join(to));
            if let Ok(inside) = inside
                && inside.exists()
            {
                fs::remove_file(&path)?;
                link(&inside, &path)?;
            }
        }
    }
    Ok(())
}

#[cfg(unix)]
fn link(to: &Path, from: &Path) -> std::io::Result<()> {
    std::os::unix::fs::symlink(to, from)
}

#[cfg(not(unix))]
fn link(_: &Path, _: &Path) -> std::io::Result<()> {
    Ok(()) // where there is apt, there is Unix
}

/// Where it says which fonts there are: those that came along, so that a picture is the same on every machine.
fn fonts(repo: &Repo) -> PathBuf {
    home(repo).join("fonts.conf")
}

/// Writes that file. Fontconfig's own way to another root, `FONTCONFIG_SYSROOT`, does not do: Chromium then opens the
/// same paths outside of it.
fn write_fonts(repo: &Repo, root: &Path) -> Result<(), String> {
    let text = format!(
        "<?xml version=\"1.0\"?>\n\
         <!DOCTYPE fontconfig SYSTEM \"urn:fontconfig:fonts.dtd\">\n\
         <fontconfig>\n\
         <dir>{}</dir>\n\
         <include ignore_missing=\"yes\">{}</include>\n\
         <cachedir>{}</cachedir>\n\
         </fontconfig>\n",
        root.join("usr/share/fonts").display(),
        root.join("etc/fonts/conf.d").display(),
        home(repo).join("cache/fonts").display(),
    );
    let file = fonts(repo);
    fs::write(&file, text).map_err(|error| format!("{}: {error}", file.display()))
}

/// A script that starts a program with the libraries that were unpacked beside it.
fn write_script(repo: &Repo, root: &Path, name: &str) -> Result<(), String> {
    let places = PROGRAMS.map(|folder| root.join(folder).join(name));
    let program = places.iter().find(|place| place.exists());
    let program = program.ok_or_else(|| format!("the packages hold no {name}"))?;
    let libraries: Vec<String> = libraries(root).iter().map(|folder| folder.display().to_string()).collect();
    let text = format!(
        "#!/bin/sh\n\
         # Starts a program that `cargo xtask` unpacked, with its libraries.\n\
         export LD_LIBRARY_PATH='{}'\"${{LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}}\"\n\
         export WIRESHARK_DATA_DIR='{}'\n\
         export FONTCONFIG_FILE='{}'\n\
         exec '{}' \"$@\"\n",
        libraries.join(":"),
        root.join("usr/share/wireshark").display(),
        fonts(repo).display(),
        program.display()
    );
    let script = repo.tools().join(name);
    let written = fs::write(&script, text).and_then(|()| make_executable(&script));
    written.map_err(|error| format!("{}: {error}", script.display()))
}

/// Lets a file be run.
#[cfg(unix)]
pub fn make_executable(script: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(script, fs::Permissions::from_mode(0o755))
}

#[cfg(not(unix))]
pub fn make_executable(_: &Path) -> std::io::Result<()> {
    Ok(()) // where there is apt, there is Unix
}

/// The folders of libraries below a root: `lib/x86_64-linux-gnu`, those in it, and the same in `usr`.
fn libraries(root: &Path) -> Vec<PathBuf> {
    let folders = |parent: &Path| {
        let mut found: Vec<PathBuf> = files(parent).unwrap_or_default();
        found.retain(|path| path.is_dir());
        found
    };
    let is_of_machine = |folder: &PathBuf| folder.to_string_lossy().contains("-linux-");
    let machine = ["usr/lib", "lib"].iter().flat_map(|lib| folders(&root.join(lib)));
    let machine: Vec<PathBuf> = machine.filter(is_of_machine).collect();
    let inner: Vec<PathBuf> = machine.iter().flat_map(|folder| folders(folder)).collect();
    machine.into_iter().chain(inner).collect()
}

/// Where packages and their lists are kept.
fn home(repo: &Repo) -> PathBuf {
    repo.target.join("tools")
}

fn make(folder: &Path) -> Result<(), String> {
    fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))
}

/// What is in a folder, sorted.
fn files(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let entries = fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    files.sort();
    Ok(files)
}

/// apt-get that asks nothing, waits for another one to finish, and keeps lists and archives of its own.
fn apt_get(repo: &Repo, arguments: &[&str]) -> Command {
    let mut command = repo.command("apt-get");
    let home = home(repo);
    let options = [
        format!("Dir::State::Lists={}", home.join("lists").display()),
        format!("Dir::Cache={}", home.join("cache").display()),
        // As root apt fetches as another user, who may not write here.
        String::from("APT::Sandbox::User=root"),
        String::from("DPkg::Lock::Timeout=300"),
    ];
    command.args(["--quiet", "--quiet"]);
    command.args(options.iter().flat_map(|option| ["-o", option]));
    command.args(arguments);
    command.env("DEBIAN_FRONTEND", "noninteractive");
    command
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_is_told_from_what_is_in_the_way() {
        let said = "NOTE: This is only a simulation!\n\
            Remv qemu-utils [1:10.0.2+ds-2]\n\
            Inst libfdt1 (1.6.1-4+b1 Debian:12.15/oldstable [amd64])\n\
            Inst libssl3 [3.0.16-1] (3.0.17-1 Debian-Security:12/oldstable-security [amd64]) []\n\
            Conf libfdt1 (1.6.1-4+b1 Debian:12.15/oldstable [amd64])\n";
        let expected = Installation {
            missing: vec![String::from("libfdt1=1.6.1-4+b1"), String::from("libssl3=3.0.17-1")],
            in_the_way: vec![String::from("qemu-utils"), String::from("libssl3")],
        };
        assert_eq!(read(said), expected);
        assert_eq!(read(""), Installation::default());
    }
}
