use staya_sim::record::{Error, Files};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// Hours of a few vehicles.
const LIMIT: u64 = 256 << 20;

/// A tlog file: before each frame its time, microseconds since 1970 as a big-endian `u64`. An
/// earlier file, and each file at 256 MiB, replaces the one with `.1` appended, and a new one
/// begins. The log is valid at each moment, so it is written in place.
#[derive(Debug)]
pub struct Tlog {
    file: BufWriter<File>,
    path: PathBuf,
    len: u64,
    limit: u64,
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
        Ok(Self { file: BufWriter::new(file), path: path.to_owned(), len: 0, limit: LIMIT })
    }

    /// Appends a frame with the present time.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(&mut self, frame: &[u8]) -> Result<(), Error> {
        self.write(micros_since_1970(), frame).map_err(Error::new("write", &self.path))
    }

    fn write(&mut self, micros: u64, frame: &[u8]) -> io::Result<()> {
        let time = micros.to_be_bytes();
        let len = (time.len() + frame.len()) as u64;
        if self.len > 0 && self.len + len > self.limit {
            self.rotate()?;
        }
        self.len += len;
        self.file.write_all(&time)?;
        self.file.write_all(frame)
    }

    fn rotate(&mut self) -> io::Result<()> {
        self.file.flush()?;
        fs::rename(&self.path, before(&self.path))?;
        self.file = BufWriter::new(File::create(&self.path)?);
        self.len = 0;
        Ok(())
    }

    /// Writes buffered data. Dropping does so too but ignores errors.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn finish(mut self) -> Result<(), Error> {
        self.file.flush().map_err(Error::new("write", &self.path))
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
        let mut log = Tlog { limit: 40, ..Tlog::create(&path, &mut Files::default()).expect("a log") };
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
    fn a_full_disk_is_an_error() {
        if let Ok(mut log) = Tlog::create(Path::new("/dev/full"), &mut Files::default()) {
            log.add(&[0; 100]).expect("buffered");
            let error = log.finish().expect_err("full");
            assert!(error.to_string().contains("/dev/full"), "{error}");
        }
    }
}
