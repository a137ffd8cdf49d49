//! Logs that MAVExplorer, mavlogdump and QGroundControl read.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// A tlog: before each frame the time, eight bytes with the highest first, microseconds since 1970.
#[derive(Debug)]
pub struct Tlog {
    file: BufWriter<File>,
    path: PathBuf,
}

/// A log that cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write the log {}: {source}", .path.display())]
pub struct TlogError {
    /// Which one.
    pub path: PathBuf,
    /// Why.
    pub source: io::Error,
}

impl Tlog {
    /// Begins a log; one that is there is replaced.
    ///
    /// # Errors
    /// When the file cannot be made.
    pub fn create(path: &Path) -> Result<Self, TlogError> {
        let path = path.to_owned();
        match File::create(&path) {
            Ok(file) => Ok(Self { file: BufWriter::new(file), path }),
            Err(source) => Err(TlogError { path, source }),
        }
    }

    /// Adds a frame that came or went just now.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn add(&mut self, frame: &[u8]) -> Result<(), TlogError> {
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        let micros = now.map_or(0, |time| time.as_micros());
        self.add_at(u64::try_from(micros).unwrap_or(u64::MAX), frame)
    }

    /// Adds a frame of another time, microseconds since 1970.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn add_at(&mut self, micros: u64, frame: &[u8]) -> Result<(), TlogError> {
        let time = self.file.write_all(&micros.to_be_bytes());
        let written = time.and_then(|()| self.file.write_all(frame));
        written.map_err(|source| self.error(source))
    }

    /// Writes what is still kept back. Dropping does it too, but tells nobody of errors.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn finish(mut self) -> Result<(), TlogError> {
        self.file.flush().map_err(|source| self.error(source))
    }

    fn error(&self, source: io::Error) -> TlogError {
        TlogError { path: self.path.clone(), source }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_follows_its_time() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.tlog");
        let mut log = Tlog::create(&path).expect("a log");
        log.add_at(0x0102, b"xyz").expect("room");
        log.finish().expect("room");
        let bytes = std::fs::read(&path).expect("the log");
        assert_eq!(bytes, b"\0\0\0\0\0\0\x01\x02xyz");
    }

    #[test]
    fn no_folder_is_an_error_that_names_the_file() {
        let error = Tlog::create(Path::new("/no/such/folder/a.tlog")).expect_err("no folder");
        assert!(error.to_string().contains("/no/such/folder/a.tlog"));
    }

    #[test]
    fn full_disk_is_told() {
        // A device that is always full, where there is one.
        if let Ok(mut log) = Tlog::create(Path::new("/dev/full")) {
            log.add(&[0; 100]).expect("kept back");
            let error = log.finish().expect_err("full");
            assert!(error.to_string().contains("/dev/full"), "{error}");
        }
    }
}
