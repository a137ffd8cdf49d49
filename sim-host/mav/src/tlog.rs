use serde::Serialize;
use staya_sim::record::{Error, Files};
use std::fmt;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// Hours of a few vehicles.
const LIMIT: u64 = 256 << 20;
/// Bytes that are collected before they are written.
const BLOCK: usize = 1 << 13;

/// A tlog file: before each frame its time, microseconds since 1970 as a big-endian `u64`. An
/// earlier file, and each file at 256 MiB, replaces the one with `.1` appended, and a new one
/// begins. The log is valid at each moment, so it is written in place.
///
/// A log is never a reason to stop steering robots. The first write that fails is an error; then
/// the log ends with its last whole frame, and later frames are only counted.
#[derive(Debug)]
pub struct Tlog {
    file: File,
    path: PathBuf,
    /// Whole frames with their times that are not written yet.
    pending: Vec<u8>,
    pending_frames: u64,
    /// Bytes in the file.
    written: u64,
    limit: u64,
    has_failed: bool,
    missing: Missing,
}

/// Counts what a log lacks because it could not be written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Missing {
    /// Frames that the log lacks.
    pub log_frames_lost: u64,
    /// Bytes of these frames, times included.
    pub log_bytes_lost: u64,
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { log_frames_lost, log_bytes_lost } = self;
        write!(f, "the log is incomplete: {log_frames_lost} frames ({log_bytes_lost} bytes) are missing")
    }
}

impl Tlog {
    /// Creates a log of a command that uses `files`.
    ///
    /// # Errors
    /// The file cannot be created, or it or its predecessor is one of `files`.
    pub fn create(path: &Path, files: &mut Files) -> Result<Self, Error> {
        let before = before(path);
        files.claim(path)?;
        files.claim(&before)?;
        let error = Error::new("write", path);
        let is_kept = fs::metadata(path).is_ok_and(|found| found.is_file() && found.len() > 0);
        let kept = if is_kept { fs::rename(path, before) } else { Ok(()) };
        let file = kept.and_then(|()| File::create(path)).map_err(error)?;
        Ok(Self {
            file,
            path: path.to_owned(),
            pending: Vec::with_capacity(BLOCK),
            pending_frames: 0,
            written: 0,
            limit: LIMIT,
            has_failed: false,
            missing: Missing::default(),
        })
    }

    /// Appends a frame with the present time.
    ///
    /// # Errors
    /// The file cannot be written. Later calls only count the frame as [missing](Self::missing).
    pub fn add(&mut self, frame: &[u8]) -> Result<(), Error> {
        self.write(micros_since_1970(), frame)
    }

    fn write(&mut self, micros: u64, frame: &[u8]) -> Result<(), Error> {
        let time = micros.to_be_bytes();
        let len = (time.len() + frame.len()) as u64;
        if self.has_failed {
            self.missing.log_frames_lost += 1;
            self.missing.log_bytes_lost += len;
            return Ok(());
        }
        let before = self.written + self.pending.len() as u64;
        let is_over = before > 0 && before + len > self.limit;
        self.pending.extend_from_slice(&time);
        self.pending.extend_from_slice(frame);
        self.pending_frames += 1;
        if !is_over && self.pending.len() < BLOCK {
            return Ok(());
        }
        // The frame that goes over the limit is the first one of the next file.
        let last = self.pending.len() - if is_over { len as usize } else { 0 };
        let done = self.flush(last).and_then(|()| if is_over { self.rotate() } else { Ok(()) });
        done.map_err(|error| self.fails(error))
    }

    /// Writes the first `len` bytes that are pending, which are whole frames.
    fn flush(&mut self, len: usize) -> io::Result<()> {
        let (due, rest) = self.pending.split_at(len);
        self.file.write_all(due)?;
        self.written += due.len() as u64;
        let is_rest = u64::from(!rest.is_empty());
        self.pending.drain(..len);
        self.pending_frames = is_rest;
        Ok(())
    }

    fn rotate(&mut self) -> io::Result<()> {
        fs::rename(&self.path, before(&self.path))?;
        self.file = File::create(&self.path)?;
        self.written = 0;
        Ok(())
    }

    fn fails(&mut self, error: io::Error) -> Error {
        self.has_failed = true;
        // Best effort: half a frame would confuse readers.
        let _ = self.file.set_len(self.written);
        self.missing.log_frames_lost += self.pending_frames;
        self.missing.log_bytes_lost += self.pending.len() as u64;
        self.pending = Vec::new();
        self.pending_frames = 0;
        Error::new("write", &self.path)(error)
    }

    /// Writes all pending frames. Dropping does so too but ignores errors.
    ///
    /// # Errors
    /// The file cannot be written, and no call before reported that.
    pub fn finish(&mut self) -> Result<(), Error> {
        if self.has_failed {
            return Ok(());
        }
        self.flush(self.pending.len()).map_err(|error| self.fails(error))
    }

    /// The frames that could not be written so far.
    pub const fn missing(&self) -> Missing {
        self.missing
    }
}

impl Drop for Tlog {
    fn drop(&mut self) {
        let _ = self.finish();
    }
}

pub(crate) fn micros_since_1970() -> u64 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    now.map_or(0, |time| u64::try_from(time.as_micros()).unwrap_or(u64::MAX))
}

/// Path of the log before.
fn before(path: &Path) -> PathBuf {
    path.with_added_extension("1")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_frame_follows_its_time() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.tlog");
        let mut log = Tlog::create(&path, &mut Files::default()).expect("a log");
        log.write(0x0102, b"xyz").expect("room");
        log.finish().expect("room");
        let bytes = std::fs::read(&path).expect("the log");
        assert_eq!(bytes, b"\0\0\0\0\0\0\x01\x02xyz");
    }

    #[test]
    fn a_log_has_a_size_limit_and_keeps_the_last_frames() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.tlog");
        let mut log = Tlog::create(&path, &mut Files::default()).expect("a log");
        log.limit = 40;
        for frame in 0..11 {
            log.write(frame, b"ab").expect("room");
        }
        log.finish().expect("room");
        let frames = |name: &str| {
            let bytes = std::fs::read(folder.path().join(name)).expect(name);
            bytes.chunks(10).map(|part| part[7]).collect::<Vec<_>>()
        };
        assert_eq!(frames("a.tlog.1"), [4, 5, 6, 7]);
        assert_eq!(frames("a.tlog"), [8, 9, 10]);
        assert_eq!(std::fs::read_dir(folder.path()).expect("the folder exists").count(), 2);
    }

    #[test]
    fn an_earlier_log_is_kept_and_an_input_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.tlog");
        fs::write(&path, "old").expect("room");
        let log = Tlog::create(&path, &mut Files::default()).expect("a log");
        drop(log);
        assert_eq!(fs::read(folder.path().join("a.tlog.1")).expect("the old log"), b"old");
        let inputs = ["a.tlog", "a.tlog.1"].map(|name| folder.path().join(name));
        for input in &inputs {
            let error = Tlog::create(&path, &mut Files::reading([input])).expect_err("an input").to_string();
            assert!(error.contains("it is also an input"), "{error}");
        }
        assert_eq!(fs::read(&inputs[1]).expect("the old log"), b"old");
    }

    #[test]
    fn a_missing_folder_is_an_error_with_the_path() {
        let error = Tlog::create(Path::new("/no/such/folder/a.tlog"), &mut Files::default()).expect_err("no folder");
        assert!(error.to_string().contains("/no/such/folder/a.tlog"));
    }

    #[test]
    fn a_full_disk_is_an_error_once_and_all_frames_are_written_or_counted() {
        let Ok(mut log) = Tlog::create(Path::new("/dev/full"), &mut Files::default()) else { return };
        let errors: Vec<_> = (0..1000).filter_map(|_| log.add(&[0; 100]).err()).collect();
        assert_eq!(errors.len(), 1);
        let error = errors[0].to_string();
        assert!(error.contains("/dev/full") && error.contains("free some space"), "{error}");
        log.finish().expect("reported before");
        assert_eq!(log.missing(), Missing { log_frames_lost: 1000, log_bytes_lost: 108_000 });
    }

    #[test]
    fn a_full_disk_at_the_end_is_an_error_too() {
        let Ok(mut log) = Tlog::create(Path::new("/dev/full"), &mut Files::default()) else { return };
        log.add(&[0; 100]).expect("pending");
        assert_eq!(log.missing(), Missing::default());
        assert!(log.finish().expect_err("full").to_string().contains("/dev/full"));
        assert_eq!(log.missing(), Missing { log_frames_lost: 1, log_bytes_lost: 108 });
    }

    #[test]
    fn a_log_that_cannot_rotate_keeps_what_is_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.tlog");
        let mut log = Tlog::create(&path, &mut Files::default()).expect("a log");
        log.limit = 40;
        fs::create_dir(folder.path().join("a.tlog.1")).expect("room");
        let errors = (0..11).filter(|&frame| log.write(frame, b"ab").is_err()).count();
        log.finish().expect("reported before");
        assert_eq!((errors, log.missing().log_frames_lost), (1, 7));
        assert_eq!(fs::read(&path).expect("the log").len(), 40);
    }
}
