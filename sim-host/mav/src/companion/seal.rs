//! The key with which agents speak to each other, and the number of the start that goes with it.

use super::roll::{KeyWatch, Roll, Turn};
use staya_controller::auth::Key;
use staya_controller::wire::{Format, Sealed};
use staya_sim::file::{read_remedy, write_remedy};
use staya_sim::key::{self, KeyError, KeyFile};
use staya_sim::radio::HostWire;
use std::fs::File;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Why agents cannot speak with a key.
#[derive(Debug, thiserror::Error)]
pub enum SealError {
    /// The key cannot be had.
    #[error(transparent)]
    Key(#[from] KeyError),
    /// The number of starts cannot be read.
    #[error("cannot read the number of starts in {}: {source}; {}", .path.display(), read_remedy(.source))]
    Read {
        /// Where it is kept.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// There is no file. To begin anew at 0 unasked would make what was recorded of earlier starts good again, and others deaf to this one.
    #[error(
        "there is no {}, which counts how often this key was used here; if it never was, make it: `echo 0 > {}`; else write a number into it that is \
         greater than it ever was, or take a new key",
        .path.display(), .path.display()
    )]
    Missing {
        /// Where it should be.
        path: PathBuf,
    },
    /// There is no number, or one that no start can have, or its line has no end: it was torn.
    #[error(
        "{} does not hold a line with a number of starts below 1048576; write one into it that is greater than it ever was, or take a new key and remove it",
        .path.display()
    )]
    NoNumber {
        /// Where it is kept.
        path: PathBuf,
    },
    /// The number of starts cannot be stored.
    #[error("cannot store the number of starts in {}: {source}; {}", .path.display(), write_remedy(.source))]
    Write {
        /// Where it is kept.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

/// A key and the number of this start, which no later one on this machine will have: [`Sealed`] says why.
#[derive(Clone, Debug)]
pub struct Seal {
    path: PathBuf,
    key: Key,
    /// The one before, from the file with `.old` behind its name.
    old: Option<Key>,
    starts: u32,
    /// What its owner should know of the key's file.
    pub remark: Option<String>,
}

/// Puts `text` in the place of a file: after a power failure there is the old one or the new one, whole.
fn replace(path: &Path, text: &str) -> std::io::Result<()> {
    let mut name = path.as_os_str().to_owned();
    name.push(".new");
    let new = PathBuf::from(name);
    let mut file = File::create(&new)?;
    file.write_all(text.as_bytes())?;
    file.sync_all()?;
    std::fs::rename(&new, path)?;
    // The rename itself; what is no Unix has no way to ask for it.
    #[cfg(unix)]
    if let Some(folder) = path.parent() {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        File::open(folder)?.sync_all()?;
    }
    Ok(())
}

impl Seal {
    /// Reads the key in `path`, the one before if there is a file of the same name with `.old` behind it, and the number of starts in that with `.starts`,
    /// where the next one is left.
    ///
    /// # Errors
    /// [`SealError`], naming the file and the remedy.
    pub fn read(path: &Path) -> Result<Self, SealError> {
        let KeyFile { key, remark } = KeyFile::read(path)?;
        let beside = |ending| {
            let mut name = path.as_os_str().to_owned();
            name.push(ending);
            PathBuf::from(name)
        };
        let (file, before) = (path.to_path_buf(), beside(".old"));
        let old = if before.exists() { Some(KeyFile::read(&before)?.key).filter(|old| *old != key) } else { None };
        let path = beside(".starts");
        let starts = match std::fs::read_to_string(&path) {
            Ok(text) => text.strip_suffix('\n').and_then(|line| line.trim().parse::<u32>().ok()),
            Err(error) if error.kind() == ErrorKind::NotFound => return Err(SealError::Missing { path }),
            Err(source) => return Err(SealError::Read { path, source }),
        };
        let starts = starts.filter(|starts| Sealed::<1>::at_start(&key, *starts).is_some());
        let Some(starts) = starts else {
            return Err(SealError::NoNumber { path });
        };
        if let Err(source) = replace(&path, &format!("{}\n", starts + 1)) {
            return Err(SealError::Write { path, source });
        }
        Ok(Self { path: file, key, old, starts, remark })
    }

    /// What an agent speaks in a format, so that only who has the key is heard, or the one before.
    #[must_use]
    pub fn wire(&self, format: Format) -> HostWire {
        let wire = HostWire::keyed(format, self.old.as_ref().unwrap_or(&self.key), self.starts, 0, key::timestamp());
        let mut wire = wire.expect("the number of starts was looked at when it was read");
        if self.has_old() {
            let mut roll = Roll::new(Duration::ZERO, false);
            for turn in [roll.begin(Duration::ZERO, self.key.clone()), Turn::Speak] {
                roll.apply(&turn, &mut wire);
            }
        }
        wire
    }

    /// Whether there is a key before this one.
    #[must_use]
    pub const fn has_old(&self) -> bool {
        self.old.is_some()
    }

    /// Watches the key's file from now on.
    #[must_use]
    pub fn watch(&self) -> KeyWatch {
        KeyWatch::start(self.path.clone(), self.key.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use heapless::Vec;
    use staya_controller::robot::RobotId;
    use staya_controller::wire::{Header, Message, Wire};

    const HEADER: Header = Header { boot: 0, sender: RobotId(3), sequence: 1 };

    fn said(wire: &mut HostWire) -> Vec<u8, 128> {
        let mut out = Vec::new();
        let message = Message::Beacon(Default::default());
        wire.encode(HEADER, &message, &mut out).unwrap();
        out
    }

    #[test]
    fn who_has_the_key_is_heard_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("swarm.key");
        std::fs::write(&path, "passphrase: one for all\n").unwrap();
        std::fs::write(folder.path().join("swarm.key.starts"), "0\n").unwrap();
        let seal = || Seal::read(&path).unwrap();
        for format in [Format::Postcard, Format::Mavlink] {
            let mut speaker = seal().wire(format);
            let mut listener = seal().wire(format);
            let frame = said(&mut speaker);
            let mut rest = frame.as_slice();
            let frame = listener.next_frame(&mut rest).unwrap();
            assert_eq!(listener.decode(frame).unwrap().header, HEADER);
            assert!(listener.decode(frame).is_err(), "a replay");
            let open = said(&mut HostWire::new(format));
            let mut rest = open.as_slice();
            let frame = listener.next_frame(&mut rest).unwrap();
            assert!(listener.decode(frame).is_err(), "without the key");
            let mut stranger = HostWire::new(format);
            assert!(stranger.decode(frame).is_ok(), "sound as it is");
        }
    }

    #[test]
    fn a_number_that_cannot_be_stored_is_an_error_and_the_old_one_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("swarm.key");
        std::fs::write(&path, "passphrase: one for all\n").unwrap();
        let kept = folder.path().join("swarm.key.starts");
        std::fs::write(&kept, "7\n").unwrap();
        // In the way of the new file.
        std::fs::create_dir(folder.path().join("swarm.key.starts.new")).unwrap();
        assert!(matches!(Seal::read(&path), Err(SealError::Write { .. })));
        assert_eq!(std::fs::read_to_string(&kept).unwrap(), "7\n");
    }

    #[test]
    fn each_start_has_a_number_of_its_own() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("swarm.key");
        std::fs::write(&path, "passphrase: one for all\n").unwrap();
        let kept = folder.path().join("swarm.key.starts");
        let error = Seal::read(&path).expect_err("nobody has said that it was never used").to_string();
        assert!(error.contains("swarm.key.starts, which counts") && error.contains("echo 0 >"), "{error}");
        assert!(!kept.exists());
        std::fs::write(&kept, "0\n").unwrap();
        let starts = (0..3).map(|_| Seal::read(&path).unwrap().starts);
        assert_eq!(starts.collect::<std::vec::Vec<_>>(), [0, 1, 2]);
        assert_eq!(std::fs::read_to_string(&kept).unwrap(), "3\n");
        // The last is torn: it may have been 17.
        for wrong in ["", "\n", "many\n", "-1\n", "1048576\n", "1"] {
            std::fs::write(&kept, wrong).unwrap();
            let error = Seal::read(&path).expect_err(wrong).to_string();
            assert!(error.contains("swarm.key.starts does not hold"), "{error}");
            assert_eq!(std::fs::read_to_string(&kept).unwrap(), wrong, "it is left as it is");
        }
        std::fs::remove_file(&kept).unwrap();
        std::fs::create_dir(&kept).unwrap();
        assert!(matches!(Seal::read(&path), Err(SealError::Read { .. })));
        let error = Seal::read(&folder.path().join("none")).expect_err("no key");
        assert!(error.to_string().contains("none"), "{error}");
    }
}
