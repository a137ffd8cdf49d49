//! Reading of whole files, and remedies for read and write errors.

use std::fs::{self, File};
use std::io::{self, Error, ErrorKind, Read as _};
use std::path::Path;

/// Largest size in bytes of a text file written by hand: scenarios, configurations.
pub const TEXT: u64 = 256 << 20;
/// Largest size of a map file, bytes.
pub const MAP: u64 = 8 << 30;

/// Opens a regular file. Devices may never end and pipes may block, so both are refused.
///
/// # Errors
/// The path is not a regular file, or cannot be opened.
pub fn open(path: &Path) -> io::Result<File> {
    let about = fs::metadata(path)?;
    // Directories fail later with a clear error.
    if about.is_file() || about.is_dir() {
        File::open(path)
    } else {
        Err(Error::new(ErrorKind::InvalidInput, "it is a device or a pipe, no regular file"))
    }
}

/// Reads a regular file of at most `most` bytes. Memory is allocated after the size is known.
///
/// # Errors
/// The file is not regular, is too large, does not fit into memory, or cannot be read.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let file = open(path)?;
    let len = file.metadata()?.len();
    let too_large = |len: u64| Error::new(ErrorKind::FileTooLarge, format!("it has {len} bytes of at most {most}"));
    if len > most {
        return Err(too_large(len));
    }
    let mut bytes = Vec::new();
    let is_there = usize::try_from(len).is_ok_and(|len| bytes.try_reserve_exact(len).is_ok());
    if !is_there {
        return Err(Error::new(ErrorKind::OutOfMemory, format!("there is no memory for its {len} bytes")));
    }
    // Some system files report a length of 0.
    file.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(too_large(bytes.len() as u64)) } else { Ok(bytes) }
}

/// Reads a regular text file of at most `most` bytes.
///
/// # Errors
/// See [`read`]; also if the file is not UTF-8.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    let bytes = read(path, most)?;
    String::from_utf8(bytes).map_err(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + valid.iter().filter(|&&byte| byte == b'\n').count();
        Error::new(ErrorKind::InvalidData, format!("line {line} is not text in UTF-8"))
    })
}

/// Whether `bytes` of memory are available, as far as the system reports it before use.
#[must_use]
pub fn has_memory(bytes: u64) -> bool {
    let can_be_reserved = || {
        let len = usize::try_from(bytes).unwrap_or(usize::MAX);
        Vec::<u8>::new().try_reserve_exact(len).is_ok()
    };
    available().is_none_or(|available| bytes <= available) && can_be_reserved()
}

fn available() -> Option<u64> {
    let text = fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

/// Remedy for a file that cannot be read.
pub fn read_remedy(error: &Error) -> &'static str {
    match error.kind() {
        ErrorKind::NotFound => "check the name",
        ErrorKind::IsADirectory => "name a file, not a directory",
        ErrorKind::PermissionDenied => "choose a file that you may read",
        ErrorKind::InvalidInput => "name a regular file",
        ErrorKind::FileTooLarge => "choose a smaller file",
        ErrorKind::OutOfMemory => "close other programs, or choose a smaller file",
        ErrorKind::InvalidData => "is it another kind of file, or damaged?",
        _ => "choose another file",
    }
}

/// Remedy for a file or directory that cannot be written.
pub fn write_remedy(error: &Error) -> &'static str {
    match error.kind() {
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "choose an output directory that you may write to"
        }
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            "free some space or choose an output directory on another disk"
        }
        ErrorKind::NotADirectory | ErrorKind::AlreadyExists | ErrorKind::IsADirectory => {
            "a file or directory of that name is in the way: remove it or choose another output directory"
        }
        ErrorKind::NotFound => "make its directory first, or choose another output directory",
        _ => "choose another output directory",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_up_to_the_size_limit() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        fs::write(&path, "abc").expect("room");
        assert_eq!(read_text(&path, 3).expect("three bytes"), "abc");
        let error = read(&path, 2).expect_err("too large");
        assert_eq!(
            (error.to_string().as_str(), read_remedy(&error)),
            ("it has 3 bytes of at most 2", "choose a smaller file")
        );
        File::create(&path).expect("mine").set_len(1 << 42).expect("a hole");
        assert_eq!(read(&path, MAP).expect_err("too large").kind(), ErrorKind::FileTooLarge);
        assert_eq!(read(&path, u64::MAX).expect_err("no memory").kind(), ErrorKind::OutOfMemory);
        fs::write(&path, [0xFF]).expect("room");
        assert_eq!(read_text(&path, TEXT).expect_err("no text").kind(), ErrorKind::InvalidData);
        assert!(read(folder.path(), TEXT).is_err() && read(&folder.path().join("none"), TEXT).is_err());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_and_pipes_are_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.expect("mkfifo").success());
        for path in [Path::new("/dev/zero"), &pipe] {
            let error = read(path, TEXT).expect_err("no file");
            assert_eq!(read_remedy(&error), "name a regular file", "{error}");
        }
        assert!(!read("/proc/meminfo".as_ref(), TEXT).expect("a text").is_empty());
        assert!(has_memory(1 << 20) && !has_memory(1 << 60) && !has_memory(u64::MAX));
    }
}
