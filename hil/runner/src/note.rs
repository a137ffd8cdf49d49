use crate::part::Part;
use crate::printable::printable;
use staya_link::frame::VERSION;
use std::path::{Path, PathBuf};

/// Content: `staya`, link version, names of part (24) and firmware (32), padded with zeros.
const SECTION: &[u8] = b".staya\0";
const MAGIC: &[u8] = b"staya";

/// The identification of a firmware in its ELF file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Version of the link.
    pub version: u8,
    /// Name of the part.
    pub part: String,
    /// Name and version of the firmware, as in its [`Hello`](staya_link::message::Hello).
    pub program: String,
}

/// Reason why a file is not a firmware for a part.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "each text says it")]
pub enum NoteError {
    #[error("{}: {source}", .path.display())]
    Read { path: PathBuf, source: std::io::Error },
    #[error("{} is not a 32-bit ELF file", .path.display())]
    NoElf { path: PathBuf },
    #[error(
        "{} has no session of the link: it is neither `lockstep` nor made by `staya_firmware::lockstep!`, or it is older \
         than this program; build it again",
        .path.display()
    )]
    NoSession { path: PathBuf },
    #[error("{} is for `{}`, not for `{expected}`", .path.display(), printable(.said))]
    OtherPart { path: PathBuf, said: String, expected: &'static str },
    #[error(
        "{} speaks version {said} of the link, this program version {VERSION}: build firmware and program from the same source",
        .path.display()
    )]
    OtherVersion { path: PathBuf, said: u8 },
    #[error(
        "{} is `{}`, and this program steps `{expected}`: build or install both from the same source",
        .path.display(),
        printable(.said)
    )]
    OtherProgram { path: PathBuf, said: String, expected: String },
}

impl Note {
    /// Reads the note of an ELF file.
    ///
    /// # Errors
    /// The file cannot be read, is not an ELF file, or has no note.
    pub fn read(path: &Path) -> Result<Self, NoteError> {
        let path = path.to_owned();
        let elf = match std::fs::read(&path) {
            Ok(elf) => elf,
            Err(source) => return Err(NoteError::Read { path, source }),
        };
        if elf.get(..6) != Some(b"\x7fELF\x01\x01") {
            return Err(NoteError::NoElf { path });
        }
        section(&elf).and_then(Self::parse).ok_or(NoteError::NoSession { path })
    }

    /// Reads the note of the firmware `elf` and checks part, link version and `program`.
    ///
    /// # Errors
    /// Those of [`Note::read`], and any mismatch.
    pub fn check(elf: &Path, part: Part, program: Option<&str>) -> Result<Self, NoteError> {
        let (note, path) = (Self::read(elf)?, elf.to_owned());
        if note.part != part.firmware_name() {
            return Err(NoteError::OtherPart { path, said: note.part, expected: part.firmware_name() });
        }
        if note.version != VERSION {
            return Err(NoteError::OtherVersion { path, said: note.version });
        }
        if let Some(expected) = program
            && note.program != expected
        {
            return Err(NoteError::OtherProgram { path, said: note.program, expected: expected.to_owned() });
        }
        Ok(note)
    }

    fn parse(note: &[u8]) -> Option<Self> {
        let text = |bytes: &[u8]| {
            let bytes = bytes.split(|byte| *byte == 0).next()?;
            String::from_utf8(bytes.to_vec()).ok()
        };
        let (version, rest) = note.strip_prefix(MAGIC)?.split_first()?;
        let (part, program) = rest.split_at_checked(24)?;
        Some(Self { version: *version, part: text(part)?, program: text(program.get(..32)?)? })
    }
}

fn section(elf: &[u8]) -> Option<&[u8]> {
    let half = |at: usize| Some(usize::from(u16::from_le_bytes(elf.get(at..)?.first_chunk().copied()?)));
    let word = |at: usize| usize::try_from(u32::from_le_bytes(elf.get(at..)?.first_chunk().copied()?)).ok();
    let (table, size, count, names) = (word(32)?, half(46)?, half(48)?, half(50)?);
    let names = word(table + names * size + 16)?;
    (0..count).map(|n| table + n * size).find_map(|header| {
        let name = elf.get(names + word(header)?..)?;
        let (at, bytes) = (word(header + 16)?, word(header + 20)?);
        name.starts_with(SECTION).then(|| elf.get(at..at.checked_add(bytes)?)).flatten()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn elf(name: &[u8], contents: &[u8]) -> Vec<u8> {
        let mut elf = vec![0u8; 52];
        elf[..6].copy_from_slice(b"\x7fELF\x01\x01");
        let names_at = elf.len();
        elf.extend(b"\0");
        elf.extend(name);
        let contents_at = elf.len();
        elf.extend(contents);
        let table = elf.len() as u32;
        elf[32..36].copy_from_slice(&table.to_le_bytes());
        elf[46] = 40;
        elf[48] = 2;
        elf[50] = 1;
        for (name, at, bytes) in [(1, contents_at, contents.len()), (0, names_at, 1 + name.len())] {
            for word in [name, 1, 0, 0, at as u32, bytes as u32, 0, 0, 0, 0] {
                elf.extend(u32::to_le_bytes(word));
            }
        }
        elf
    }

    fn note(version: u8, part: &str, program: &str) -> Vec<u8> {
        let mut note = vec![0; 62];
        note[..5].copy_from_slice(MAGIC);
        note[5] = version;
        note[6..6 + part.len()].copy_from_slice(part.as_bytes());
        note[30..30 + program.len()].copy_from_slice(program.as_bytes());
        note
    }

    fn checked(bytes: &[u8]) -> String {
        let path =
            std::env::temp_dir().join(format!("staya-note-{}-{:?}", std::process::id(), std::thread::current().id()));
        std::fs::write(&path, bytes).expect("a file");
        let checked = Note::check(&path, Part::Stm32f405, Some("patrol 0.1.0"));
        std::fs::remove_file(&path).expect("it is there");
        checked.map_or_else(|error| error.to_string(), |note| format!("{note:?}"))
    }

    #[test]
    fn each_unsuitable_file_has_its_own_error() {
        let good = note(VERSION, "stm32f405", "patrol 0.1.0");
        assert!(checked(&elf(SECTION, &good)).starts_with("Note {"));
        for (file, why) in [
            (b"#!/bin/sh".to_vec(), "is not a 32-bit ELF file"),
            (Vec::new(), "is not a 32-bit ELF file"),
            (elf(b".text\0", &good), "no session"),
            (elf(SECTION, b"stay"), "no session"),
            (elf(SECTION, &good[..40]), "no session"),
            (elf(SECTION, &note(VERSION, "nrf51", "patrol 0.1.0")), "is for `nrf51`, not for `stm32f405`"),
            (elf(SECTION, &note(VERSION + 1, "stm32f405", "patrol 0.1.0")), "of the link, this program version"),
            (
                elf(SECTION, &note(VERSION, "stm32f405", "lockstep 0.1.0")),
                "is `lockstep 0.1.0`, and this program steps `patrol",
            ),
        ] {
            let said = checked(&file);
            assert!(said.contains(why), "{said}");
        }
        let whole = elf(SECTION, &good);
        // The last 20 bytes belong to unused fields of the last header.
        for cut in 6..whole.len() - 20 {
            let said = checked(&whole[..cut]);
            assert!(said.contains("no session"), "{cut}: {said}");
        }
        let missing = Note::read(Path::new("no/such/file")).expect_err("none").to_string();
        assert!(missing.contains("no/such/file"), "{missing}");
    }
}
