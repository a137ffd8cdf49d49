use super::roll::{KeyWatch, Roll, Turn};
use anyhow::{Result, anyhow, bail};
use staya_controller::auth::Key;
use staya_controller::wire::{Format, Sealed};
use staya_sim::file::{read_remedy, write_remedy};
use staya_sim::key::{self, KeyFile};
use staya_sim::radio::HostWire;
use staya_sim::shown::Shown as _;
use std::fs::File;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A key and the counter of this start, which is unique on this computer; see [`Sealed`].
#[derive(Clone, Debug)]
pub struct Seal {
    path: PathBuf,
    key: Key,
    /// The previous key, from the file with `.old` appended to its name.
    old: Option<Key>,
    starts: u32,
    /// A warning about the key file.
    pub remark: Option<String>,
}

/// After a power failure the file has the old or the new content.
fn replace(path: &Path, text: &str) -> std::io::Result<()> {
    let new = path.with_added_extension("new");
    let mut file = File::create(&new)?;
    file.write_all(text.as_bytes())?;
    file.sync_all()?;
    std::fs::rename(&new, path)?;
    // The rename itself is durable only on Unix.
    #[cfg(unix)]
    if let Some(folder) = path.parent() {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        File::open(folder)?.sync_all()?;
    }
    Ok(())
}

impl Seal {
    /// Reads the key in `path`, the previous key in the file with `.old` appended if it exists, and
    /// the counter of starts in the file with `.starts` appended, and stores the next counter.
    ///
    /// # Errors
    /// A file is missing, invalid or not writable; the text names it and the remedy.
    pub fn read(path: &Path) -> Result<Self> {
        let KeyFile { key, remark } = KeyFile::read(path)?;
        let (file, before) = (path.to_path_buf(), path.with_added_extension("old"));
        let old = if before.exists() { Some(KeyFile::read(&before)?.key).filter(|old| *old != key) } else { None };
        let path = path.with_added_extension("starts");
        let name = path.shown();
        let text = std::fs::read_to_string(&path).map_err(|error| match error.kind() {
            // From 0 the counter would make recorded packets valid again.
            ErrorKind::NotFound => anyhow!(
                "{name} is missing, it counts how often this computer used the key; if the key is unused here, run \
                 `echo 0 > {name}`; else write a number into it that is greater than all earlier ones, or give a new \
                 key"
            ),
            _ => anyhow!("cannot read the counter of starts in {name}: {error}; {}", read_remedy(&error)),
        })?;
        // A line without its end may have lost digits.
        let starts = text.strip_suffix('\n').and_then(|line| line.trim().parse::<u32>().ok());
        let Some(starts) = starts.filter(|starts| Sealed::<1>::at_start(&key, *starts).is_some()) else {
            bail!(
                "{name} is not a counter of starts below 1048576; write a number into it that is greater than all \
                 earlier ones, or give a new key and remove it"
            );
        };
        replace(&path, &format!("{}\n", starts + 1)).map_err(|error| {
            anyhow!("cannot store the counter of starts in {name}: {error}; {}", write_remedy(&error))
        })?;
        Ok(Self { path: file, key, old, starts, remark })
    }

    /// The wire format of an agent, encrypted with this key; the previous key is accepted too.
    pub fn wire(&self, format: Format) -> HostWire {
        let wire = HostWire::keyed(format, self.old.as_ref().unwrap_or(&self.key), self.starts, 0, key::timestamp());
        let mut wire = wire.expect("the counter of starts was validated when read");
        if self.has_old() {
            let mut roll = Roll::new(Duration::ZERO, false);
            for turn in [roll.begin(Duration::ZERO, self.key.clone()), Turn::Speak] {
                roll.apply(&turn, &mut wire);
            }
        }
        wire
    }

    /// Whether there is a previous key.
    pub const fn has_old(&self) -> bool {
        self.old.is_some()
    }

    /// Starts to watch the key file.
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
    fn a_packet_with_the_key_is_accepted_once() {
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
            assert!(stranger.decode(frame).is_ok(), "a plain packet is valid");
        }
    }

    #[test]
    fn a_counter_that_cannot_be_stored_is_an_error_and_stays_unchanged() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("swarm.key");
        std::fs::write(&path, "passphrase: one for all\n").unwrap();
        let kept = folder.path().join("swarm.key.starts");
        std::fs::write(&kept, "7\n").unwrap();
        std::fs::create_dir(folder.path().join("swarm.key.starts.new")).unwrap();
        let error = Seal::read(&path).expect_err("the counter cannot be stored").to_string();
        assert!(error.starts_with("cannot store the counter of starts in "), "{error}");
        assert_eq!(std::fs::read_to_string(&kept).unwrap(), "7\n");
    }

    #[test]
    fn each_start_has_its_own_counter() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("swarm.key");
        std::fs::write(&path, "passphrase: one for all\n").unwrap();
        let kept = folder.path().join("swarm.key.starts");
        let error = Seal::read(&path).expect_err("the counter is missing").to_string();
        assert!(error.contains("swarm.key.starts is missing") && error.contains("echo 0 >"), "{error}");
        assert!(!kept.exists());
        std::fs::write(&kept, "0\n").unwrap();
        let starts = (0..3).map(|_| Seal::read(&path).unwrap().starts);
        assert_eq!(starts.collect::<std::vec::Vec<_>>(), [0, 1, 2]);
        assert_eq!(std::fs::read_to_string(&kept).unwrap(), "3\n");
        // The last one lacks its line end: it may have been 17.
        for wrong in ["", "\n", "many\n", "-1\n", "1048576\n", "1"] {
            std::fs::write(&kept, wrong).unwrap();
            let error = Seal::read(&path).expect_err(wrong).to_string();
            assert!(error.contains("swarm.key.starts is not a counter"), "{error}");
            assert_eq!(std::fs::read_to_string(&kept).unwrap(), wrong, "the file is unchanged");
        }
        std::fs::remove_file(&kept).unwrap();
        std::fs::create_dir(&kept).unwrap();
        let error = Seal::read(&path).expect_err("a folder").to_string();
        assert!(error.starts_with("cannot read the counter of starts in "), "{error}");
        let error = Seal::read(&folder.path().join("none")).expect_err("no key");
        assert!(error.to_string().contains("none"), "{error}");
    }
}
