//! `cargo xtask firmware`: the ELF files of the parts, with whatever toolchain there is.

use crate::device::{Toolchain, Toolchains};
use crate::part::{PARTS, Part, part};
use crate::repo::{Repo, run};
use crate::report::Report;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};

/// Cargo's profile for what goes on a part, and the one to debug with.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    Firmware,
    Debug,
}

impl Profile {
    /// As cargo is told, and the folder that it builds in.
    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Firmware => ("firmware", "firmware"),
            Self::Debug => ("dev", "debug"),
        }
    }

    /// Where the ELF file of a program is put: `target/firmware/PART/BIN`, or
    /// `target/firmware/PART/debug/BIN`.
    pub fn elf(self, repo: &Repo, part: &Part, bin: &str) -> PathBuf {
        let folder = repo.target.join("firmware").join(part.name);
        match self {
            Self::Firmware => folder.join(bin),
            Self::Debug => folder.join("debug").join(bin),
        }
    }
}

/// Programs of names that begin so link only when the optimiser has thrown out every panic.
const ONLY_OPTIMISED: &str = "nopanic";

/// What `cargo xtask firmware` is asked for.
pub struct Request<'a> {
    /// All of them if none is named.
    parts: Vec<&'static Part>,
    profile: Profile,
    /// The programs to build; all of them if none is named.
    bins: Vec<&'a str>,
    /// The folder of a crate whose firmware it is, in place of the repository's.
    folder: Option<&'a str>,
}

impl<'a> Request<'a> {
    /// Reads the command line: `[--debug] [--bin NAME]... [PART...]`, or `--crate DIR [PART...]`.
    pub fn read(arguments: &[&'a str]) -> Option<Self> {
        let (mut parts, mut profile, mut bins, mut folder) = (Vec::new(), Profile::Firmware, Vec::new(), None);
        let mut arguments = arguments.iter().copied();
        while let Some(argument) = arguments.next() {
            match argument {
                "--debug" => profile = Profile::Debug,
                "--bin" => bins.push(arguments.next()?),
                "--crate" => folder = Some(arguments.next()?),
                name => parts.push(part(name)?),
            }
        }
        if parts.is_empty() {
            parts.extend(&PARTS);
        }
        if folder.is_some() && (profile == Profile::Debug || !bins.is_empty()) {
            return None;
        }
        Some(Self { parts, profile, bins, folder })
    }
}

/// The command: one step per part.
pub fn run_command(repo: &Repo, report: &mut Report, request: &Request<'_>) {
    let mut toolchains = Toolchains::default();
    for part in &request.parts {
        let Request { profile, bins, folder, .. } = request;
        if let Some(folder) = folder {
            build_own(repo, report, &mut toolchains, part, Path::new(folder));
            continue;
        }
        build_some(repo, report, &mut toolchains, part, *profile, bins);
    }
}

/// Begins to build every program for all parts, with what others leave of the processors; the caller waits for its end. What it
/// cannot build is reported when it is built as a step.
pub fn begin(repo: &Repo, toolchains: &mut Toolchains) -> Option<Child> {
    // What has to be fetched is fetched first: packages are unpacked by one program at a time.
    let parts = PARTS.iter().filter(|part| toolchains.find(repo, part.target).is_ok());
    let parts: Vec<&str> = parts.map(|part| part.name).collect();
    if parts.is_empty() {
        return None;
    }
    let mut command = repo.command("nice");
    command.args(["-n", "19"]).arg(std::env::current_exe().ok()?).arg("firmware").args(parts);
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().ok()
}

/// Builds every program for a part as one step. Returns whether the ELF files are there.
pub fn build_step(
    repo: &Repo,
    report: &mut Report,
    toolchains: &mut Toolchains,
    part: &Part,
    profile: Profile,
) -> bool {
    build_some(repo, report, toolchains, part, profile, &[])
}

/// The same with the programs of these names; all of them if none is named.
pub fn build_some(
    repo: &Repo,
    report: &mut Report,
    toolchains: &mut Toolchains,
    part: &Part,
    profile: Profile,
    bins: &[&str],
) -> bool {
    let name = match profile {
        Profile::Firmware => format!("firmware for {}", part.name),
        Profile::Debug => format!("firmware for {}, debug", part.name),
    };
    if part.name == "nrf51" && profile == Profile::Debug {
        report.skip(&name, "256 KiB of flash hold it only optimised");
        return false;
    }
    match toolchains.find(repo, part.target) {
        Ok(toolchain) => report.step(&name, || build(repo, &toolchain, part, profile, bins)),
        Err(reason) => {
            report.skip(&name, &reason);
            false
        }
    }
}

/// Builds every program for a part, or those that are named, and copies the ELF files to where they are looked for.
fn build(repo: &Repo, toolchain: &Toolchain, part: &Part, profile: Profile, only: &[&str]) -> Result<(), String> {
    let (profile_name, folder) = profile.names();
    let mut cargo = toolchain.cargo(repo, part.target, "build");
    cargo.args(["--locked", "--profile", profile_name]);
    cargo.args(["--package", "staya-firmware"]);
    let mut bins = bins(repo, profile)?;
    if let Some(unknown) = only.iter().find(|&&name| !bins.iter().any(|bin| bin == name)) {
        return Err(format!("no program {unknown} in hil/firmware"));
    }
    bins.retain(|bin| only.is_empty() || only.contains(&bin.as_str()));
    for bin in &bins {
        cargo.args(["--bin", bin]);
    }
    run(&mut cargo)?;
    let built = toolchain.target_folder(repo).join(part.target).join(folder);
    println!("{:>8} {:>8}  file", "flash", "RAM");
    for bin in &bins {
        put(&built.join(bin), &profile.elf(repo, part, bin))?;
    }
    Ok(())
}

/// Builds the program `firmware` of the crate in `folder` for a part as one step, and puts it where the crate's program on the host looks:
/// `FOLDER/target/firmware/PART/lockstep`. Returns whether it is there.
pub fn build_own(repo: &Repo, report: &mut Report, toolchains: &mut Toolchains, part: &Part, folder: &Path) -> bool {
    let name = format!("firmware of {} for {}", folder.display(), part.name);
    let toolchain = match toolchains.find(repo, part.target) {
        Ok(toolchain) => toolchain,
        Err(reason) => {
            report.skip(&name, &reason);
            return false;
        }
    };
    report.step(&name, || {
        let folder = std::path::absolute(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        let manifest = folder.join("Cargo.toml");
        if !manifest.is_file() {
            return Err(format!("{} is not there; docs/project.md says what such a crate has", manifest.display()));
        }
        let mut cargo = toolchain.cargo(repo, part.target, "build");
        let (profile, built) = Profile::Firmware.names();
        cargo.arg("--manifest-path").arg(manifest).args(["--bin", "firmware", "--profile", profile]);
        // The repository's profile, which the crate need not have.
        for line in ["inherits=\"release\"", "opt-level=\"s\"", "lto=\"fat\"", "codegen-units=1", "panic=\"abort\""] {
            cargo.args(["--config", &format!("profile.{profile}.{line}")]);
        }
        let target = toolchain.target_folder(repo);
        cargo.env("CARGO_TARGET_DIR", &target);
        run(&mut cargo)?;
        let to = folder.join("target/firmware").join(part.name).join("lockstep");
        let from = target.join(part.target).join(built).join("firmware");
        println!("{:>8} {:>8}  file", "flash", "RAM");
        put(&from, &to)
    })
}

/// Copies an ELF file to where it is looked for, and says what it takes.
fn put(from: &Path, to: &Path) -> Result<(), String> {
    let parent = to.parent().unwrap_or(to);
    fs::create_dir_all(parent).map_err(|error| format!("{}: {error}", parent.display()))?;
    fs::copy(from, to).map_err(|error| format!("{}: {error}", from.display()))?;
    let Sections { flash, ram, .. } = sections(to)?;
    println!("{flash:>8} {ram:>8}  {}", to.display());
    Ok(())
}

/// The names of the programs: each file in `src/bin` is one.
fn bins(repo: &Repo, profile: Profile) -> Result<Vec<String>, String> {
    let folder = repo.root.join("hil/firmware/src/bin");
    let entries = fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut bins: Vec<String> = entries
        .filter_map(|entry| Some(entry.ok()?.path().file_stem()?.to_str()?.to_string()))
        .filter(|bin| profile == Profile::Firmware || !bin.starts_with(ONLY_OPTIMISED))
        .collect();
    bins.sort();
    Ok(bins)
}

/// What an ELF file takes, bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Sections {
    /// Machine code.
    pub text: u64,
    /// Constants.
    pub rodata: u64,
    /// All that is in flash.
    pub flash: u64,
    /// Statics.
    pub ram: u64,
}

/// What an ELF file of 32 bits takes.
pub fn sections(file: &Path) -> Result<Sections, String> {
    let bytes = fs::read(file).map_err(|error| format!("{}: {error}", file.display()))?;
    sizes(&bytes).ok_or_else(|| format!("{}: no ELF file of 32 bits", file.display()))
}

/// The same from the file's section headers: what is loaded and has contents is flash, what is
/// writable is RAM. What riscv-rt calls a section and is only the rest of RAM does not count.
fn sizes(elf: &[u8]) -> Option<Sections> {
    const EMPTY: u32 = 8;
    const WRITABLE: u32 = 1;
    const LOADED: u32 = 2;
    if elf.get(..6)? != b"\x7fELF\x01\x01" {
        return None;
    }
    let half = |at: usize| {
        let bytes = elf.get(at..at.checked_add(2)?)?.try_into().ok()?;
        Some(usize::from(u16::from_le_bytes(bytes)))
    };
    let word = |at: usize| {
        let bytes = elf.get(at..at.checked_add(4)?)?.try_into().ok()?;
        Some(u32::from_le_bytes(bytes))
    };
    let offset = |at: usize| usize::try_from(word(at)?).ok();
    let (table, size, count, names) = (offset(32)?, half(46)?, half(48)?, half(50)?);
    let names = offset(table + names * size + 16)?;
    let mut sum = Sections::default();
    for header in (0..count).map(|n| table + n * size) {
        let (kind, flags) = (word(header + 4)?, word(header + 8)?);
        let bytes = u64::from(word(header + 20)?);
        let name = elf.get(names + offset(header)?..)?;
        let is_rest = name.starts_with(b".stack\0") || name.starts_with(b".heap\0");
        if flags & LOADED == 0 || is_rest {
            continue;
        }
        if kind != EMPTY {
            sum.flash += bytes;
        }
        if flags & WRITABLE != 0 {
            sum.ram += bytes;
        }
        if name.starts_with(b".text\0") {
            sum.text += bytes;
        }
        if name.starts_with(b".rodata\0") {
            sum.rodata += bytes;
        }
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contents_are_flash_and_writable_sections_are_ram() {
        // Header, names, five sections: text, data, bss, stack, and one that is not loaded.
        let names = b"\0.text\0.data\0.bss\0.stack\0.debug\0";
        let sections = [(1, 1, 6, 100), (7, 1, 3, 8), (13, 8, 3, 200), (18, 8, 3, 4000), (25, 1, 0, 50)];
        let mut elf = vec![0u8; 52];
        elf[..6].copy_from_slice(b"\x7fELF\x01\x01");
        elf.extend(names);
        let table = elf.len() as u32;
        elf[32..36].copy_from_slice(&table.to_le_bytes());
        elf[46] = 40; // bytes of a section header
        elf[48] = 6; // how many
        elf[50] = 5; // the one that says where the names are
        let mut section = |name: u32, kind: u32, flags: u32, at: u32, bytes: u32| {
            for word in [name, kind, flags, 0, at, bytes, 0, 0, 0, 0] {
                elf.extend(word.to_le_bytes());
            }
        };
        for (name, kind, flags, bytes) in sections {
            section(name, kind, flags, 0, bytes);
        }
        section(0, 3, 0, 52, names.len() as u32);
        let sum = Sections { text: 100, rodata: 0, flash: 108, ram: 208 };
        assert_eq!(sizes(&elf), Some(sum));
        assert_eq!(sizes(&elf[..elf.len() - 200]), None);
        elf[4] = 2; // 64 bits
        assert_eq!(sizes(&elf), None);
    }

    #[test]
    fn the_command_line_names_parts_a_profile_and_a_program() {
        let all = Request::read(&[]).unwrap();
        assert_eq!((all.parts.len(), all.bins.len()), (PARTS.len(), 0));
        let one = Request::read(&["--bin", "lockstep", "nrf51", "--debug"]).unwrap();
        assert_eq!((one.parts.len(), one.bins), (1, vec!["lockstep"]));
        assert!(one.profile == Profile::Debug && one.parts[0].name == "nrf51");
        let own = Request::read(&["--crate", "examples/own_part", "riscv32"]).unwrap();
        assert_eq!((own.folder, own.parts.len()), (Some("examples/own_part"), 1));
        let crate_and_bin = ["--crate", "here", "--bin", "lockstep"];
        for wrong in [&["z80"][..], &["--bin"], &["--binary", "lockstep"], &["--crate"], &crate_and_bin] {
            assert!(Request::read(wrong).is_none(), "{wrong:?}");
        }
    }
}
