//! `cargo xtask firmware`: the ELF files of the parts, with the toolchain that is installed.

use crate::device::{NAMES, PARTS, Part, STM32F405, Toolchain, part};
use crate::prelude::*;
use object::{Object as _, ObjectSection as _, SectionFlags, SectionKind, elf};
use std::process::{Child, Stdio};

/// How programs of a part are built.
pub struct Profile {
    /// Cargo's profile, and the folder that it builds in.
    name: &'static str,
    built: &'static str,
    /// The end of names behind that of a part.
    pub suffix: &'static str,
    /// The folder of the ELF files in that of the part.
    folder: &'static str,
    /// The number format of `lockstep`; `None`: the part's.
    numbers: Option<Numbers>,
}

/// As robots have them.
pub const FIRMWARE: &Profile = &Profile { name: "firmware", built: "firmware", suffix: "", folder: "", numbers: None };
/// To debug them.
pub const DEBUG: &Profile = &Profile { name: "dev", built: "debug", suffix: ", debug", folder: "debug", numbers: None };

/// A number format of firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Numbers {
    /// Single precision
    F32,
    /// Single precision with approximate functions
    Fast32,
    /// Fixed point, for parts without an FPU
    Q16,
}

impl Numbers {
    /// Its name in options and folders.
    pub const fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::Fast32 => "fast32",
            Self::Q16 => "q16",
        }
    }
}

impl Profile {
    /// The same profile with `lockstep` in another number format.
    pub const fn in_numbers(&self, numbers: Option<Numbers>) -> Self {
        Self { numbers, ..*self }
    }

    /// Where the ELF file of a program is put: `target/firmware/PART/BIN`, with `-NUMBERS` behind
    /// the part if they were chosen, or `target/firmware/PART/debug/BIN`.
    pub fn elf(&self, repo: &Repo, part: &Part, bin: &str) -> PathBuf {
        repo.target.join("firmware").join(self.folder_of(part)).join(self.folder).join(bin)
    }

    fn folder_of(&self, part: &Part) -> String {
        let usual = if part.name == "nrf51" { Numbers::Q16 } else { Numbers::F32 };
        let other = self.numbers.filter(|&numbers| numbers != usual);
        other.map_or_else(|| part.name.into(), |numbers| format!("{}-{}", part.name, numbers.name()))
    }

    /// The build's numbers, whatever the caller's environment says.
    fn choose<'a>(&self, cargo: &'a mut Command) -> &'a mut Command {
        match self.numbers {
            Some(numbers) => cargo.env("STAYA_NUMBERS", numbers.name()),
            None => cargo.env_remove("STAYA_NUMBERS"),
        }
    }

    /// The ELF file of a program that was built before. A part that needs it is skipped without it.
    pub fn find(&self, repo: &Repo, part: &Part, bin: &str) -> Result<PathBuf> {
        let elf = self.elf(repo, part, bin);
        ensure!(elf.is_file(), skipped(format!("no firmware for {}", part.name)));
        Ok(elf)
    }
}

/// Programs of names that begin so link only when the optimiser has thrown out every panic.
const ONLY_OPTIMISED: &str = "nopanic";

#[derive(clap::Args)]
pub struct Options {
    /// To debug
    #[arg(long)]
    debug: bool,
    /// Programs, without this option all
    #[arg(long = "bin", value_name = "NAME", conflicts_with = "folder")]
    bins: Vec<String>,
    /// The program of a crate with a law of its own
    #[arg(long = "crate", value_name = "DIR", conflicts_with = "debug")]
    folder: Option<PathBuf>,
    /// The number format of `lockstep` or of the crate's program, without this option the part's;
    /// put into target/firmware/PART-NUMBERS
    #[arg(long, conflicts_with = "debug")]
    numbers: Option<Numbers>,
    #[arg(value_name = "PART", value_parser = part, default_values = NAMES)]
    parts: Vec<&'static Part>,
}

/// The command: one step per part.
pub fn run_command(s: &mut Session, options: &Options) {
    let profile = if options.debug { DEBUG } else { FIRMWARE };
    let profile = &profile.in_numbers(options.numbers);
    let bins: Vec<&str> = options.bins.iter().map(String::as_str).collect();
    for part in &options.parts {
        match &options.folder {
            Some(folder) => build_own(s, part, profile, folder),
            None => build(s, part, profile, &bins),
        };
    }
}

/// Begins to build every program for all parts at a low priority; the caller waits for the end.
/// Failures are reported later, when a step builds the program again.
pub fn begin(s: &mut Session) -> Option<Child> {
    // Toolchains are fetched first: packages are unpacked by one program at a time.
    let parts = PARTS.iter().filter(|part| s.toolchains.find(&s.repo, part.target).is_ok());
    let parts: Vec<&str> = parts.map(|part| part.name).collect();
    if parts.is_empty() {
        return None;
    }
    let mut command = s.repo.command("nice");
    command.args(["-n", "19"]).arg(std::env::current_exe().ok()?).arg("firmware").args(parts);
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().ok()
}

/// Builds the programs of these names for a part as one step, or all of them if none is named.
/// Returns whether the ELF files are there.
pub fn build(s: &mut Session, part: &Part, profile: &Profile, bins: &[&str]) -> bool {
    let name = format!("firmware for {}{}", profile.folder_of(part), profile.suffix);
    s.with_toolchain(&name, part.target, |repo, toolchain| make(repo, toolchain, part, profile, bins))
}

/// Builds programs for a part, and copies the ELF files to where they are looked for.
pub fn make(repo: &Repo, toolchain: &Toolchain, part: &Part, profile: &Profile, only: &[&str]) -> Result<()> {
    let is_debug = profile.name == DEBUG.name;
    ensure!(part.name != "nrf51" || !is_debug, skipped("256 KiB of flash hold it only optimised"));
    let mut cargo = toolchain.cargo(repo, part.target, "build --locked --package staya-firmware --profile");
    // Flash has room for the canned swarms only if they are small.
    cargo.arg(profile.name).env("CARGO_PROFILE_DEV_OPT_LEVEL", "s");
    // Each file in src/bin is a program.
    let mut bins: Vec<String> =
        files::entries(&repo.root.join("hil/firmware/src/bin"))?.iter().map(|file| files::stem(file)).collect();
    bins.retain(|bin| !is_debug || !bin.starts_with(ONLY_OPTIMISED));
    if let Some(unknown) = only.iter().find(|&&name| !bins.iter().any(|bin| bin == name)) {
        bail!("no program {unknown} in hil/firmware");
    }
    bins.retain(|bin| only.is_empty() || only.contains(&bin.as_str()));
    execute(profile.choose(&mut cargo).args(bins.iter().flat_map(|bin| ["--bin", bin])))?;
    let built = toolchain.target_folder(repo).join(part.target).join(profile.built);
    println!("{:>8} {:>8}  file", "flash", "RAM");
    bins.iter().try_for_each(|bin| put(&built.join(bin), &profile.elf(repo, part, bin)))
}

/// Builds the program `firmware` of the crate in `folder` for a part as one step, and puts it where
/// the crate's program on the host looks: `FOLDER/target/firmware/PART/lockstep`. Returns whether
/// it is there.
pub fn build_own(s: &mut Session, part: &Part, profile: &Profile, folder: &Path) -> bool {
    let name = format!("firmware of {} for {}", folder.display(), profile.folder_of(part));
    s.with_toolchain(&name, part.target, |repo, toolchain| {
        let folder = std::path::absolute(folder).with_context(|| folder.display().to_string())?;
        let manifest = folder.join("Cargo.toml");
        let shown = manifest.display();
        ensure!(manifest.is_file(), "{shown} is not there; docs/project.md says what such a crate has");
        let Profile { name, built, .. } = profile;
        let mut cargo = toolchain.cargo(repo, part.target, "build --bin firmware --profile");
        cargo.arg(name).arg("--manifest-path").arg(&manifest);
        // The repository's profile, which the crate need not have.
        for line in ["inherits=\"release\"", "opt-level=\"s\"", "lto=\"fat\"", "codegen-units=1", "panic=\"abort\""] {
            cargo.args(["--config", &format!("profile.{name}.{line}")]);
        }
        let target = toolchain.target_folder(repo);
        execute(profile.choose(cargo.env("CARGO_TARGET_DIR", &target)))?;
        println!("{:>8} {:>8}  file", "flash", "RAM");
        let from = target.join(part.target).join(built).join("firmware");
        put(&from, &folder.join("target/firmware").join(profile.folder_of(part)).join("lockstep"))
    })
}

/// Where the example firmware is, a workspace of its own.
pub const EXAMPLE: &str = "examples/stm32f4";

/// Its release build: that it links is the test, since no emulator has the part's clocks.
pub fn example(s: &mut Session) {
    s.with_toolchain("example firmware for the STM32F405", STM32F405.target, |repo, toolchain| {
        let mut build = toolchain.cargo(repo, STM32F405.target, "build --locked --release");
        execute(build.current_dir(repo.root.join(EXAMPLE)))
    });
}

/// Copies an ELF file to where it is looked for, and says what it takes.
fn put(from: &Path, to: &Path) -> Result<()> {
    files::copy(from, to)?;
    let Sections { flash, ram, .. } = sections(to)?;
    println!("{flash:>8} {ram:>8}  {}", to.display());
    Ok(())
}

/// The sizes of an ELF file, bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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

/// The sizes of an ELF file of 32 bits.
pub fn sections(file: &Path) -> Result<Sections> {
    sizes(&files::bytes(file)?).with_context(|| format!("{} is not a 32-bit ELF file", file.display()))
}

/// The same from the file's section headers: loaded sections with contents are flash,
/// writable ones are RAM. The section of riscv-rt for the rest of RAM does not count.
fn sizes(bytes: &[u8]) -> Option<Sections> {
    let file = object::read::elf::ElfFile32::<object::Endianness>::parse(bytes).ok()?;
    let mut sum = Sections::default();
    for section in file.sections() {
        let (SectionFlags::Elf { sh_flags }, Ok(name)) = (section.flags(), section.name()) else { continue };
        let is_loaded = sh_flags & u64::from(elf::SHF_ALLOC) != 0;
        if !is_loaded || [".stack", ".heap"].contains(&name) {
            continue;
        }
        let size = section.size();
        sum.flash += if section.kind() == SectionKind::UninitializedData { 0 } else { size };
        sum.ram += if sh_flags & u64::from(elf::SHF_WRITE) != 0 { size } else { 0 };
        match name {
            ".text" => sum.text += size,
            ".rodata" => sum.rodata += size,
            _ => {}
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
        elf[..7].copy_from_slice(b"\x7fELF\x01\x01\x01");
        elf[20] = 1; // the version
        elf.extend(names);
        let table = elf.len() as u32;
        elf[32..36].copy_from_slice(&table.to_le_bytes());
        elf[46] = 40; // bytes of a section header
        elf[48] = 7; // how many
        elf[50] = 6; // the one that says where the names are
        let mut section = |name: u32, kind: u32, flags: u32, at: u32, bytes: u32| {
            for word in [name, kind, flags, 0, at, bytes, 0, 0, 0, 0] {
                elf.extend(word.to_le_bytes());
            }
        };
        section(0, 0, 0, 0, 0); // the first one is none
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
}
