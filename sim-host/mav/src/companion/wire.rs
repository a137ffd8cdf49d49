//! How agents say things to each other: in the scenario's wire format, open or with a key.

use heapless::Vec;
use serde::Serialize;
use staya_controller::auth::Key;
use staya_controller::wire::{DecodeError, EncodeError, Format, Frame, Header, Message, Postcard, Sealed, Wire};
use staya_mavlink::signed::Signed;
use staya_mavlink::signing::Signing;
use staya_mavlink::wire::Mavlink;
use staya_sim::file::{read_remedy, write_remedy};
use staya_sim::key::{self, KeyError, KeyFile};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The format of packets between companions.
#[derive(Clone, Debug, Serialize)]
pub enum CompanionWire {
    /// The controller's own frames.
    Postcard(Postcard),
    /// The same with a seal.
    Sealed(Sealed),
    /// MAVLink 2.
    Mavlink(Mavlink),
    /// MAVLink 2 with signatures.
    Signed(Signed),
}

/// Does `$do` with the format that is in it.
macro_rules! each {
    ($any:expr, $wire:ident => $do:expr) => {
        match $any {
            CompanionWire::Postcard($wire) => $do,
            CompanionWire::Sealed($wire) => $do,
            CompanionWire::Mavlink($wire) => $do,
            CompanionWire::Signed($wire) => $do,
        }
    };
}

impl Wire for CompanionWire {
    fn beacon_len(&self) -> usize {
        each!(self, wire => wire.beacon_len())
    }

    fn encode<const N: usize>(
        &mut self,
        header: Header,
        message: &Message,
        out: &mut Vec<u8, N>,
    ) -> Result<usize, EncodeError> {
        if let Self::Signed(signed) = self {
            // So that who starts later does not take it for a recording.
            signed.signing_mut().advance_to(key::timestamp());
        }
        each!(self, wire => wire.encode(header, message, out))
    }

    fn decode(&mut self, frame: &[u8]) -> Result<Frame, DecodeError> {
        each!(self, wire => wire.decode(frame))
    }

    fn next_frame<'a>(&self, rest: &mut &'a [u8]) -> Option<&'a [u8]> {
        each!(self, wire => wire.next_frame(rest))
    }
}

/// Why agents cannot speak with a key.
#[derive(Debug, thiserror::Error)]
pub enum WireError {
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
    /// There is no number, or one that no start can have.
    #[error(
        "{} does not hold a number of starts below 1048576; write one into it that is greater than it ever was, or take a new key and remove it",
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
    key: Key,
    starts: u32,
    /// What its owner should know of the key's file.
    pub remark: Option<String>,
}

impl Seal {
    /// Reads the key in `path`, and the number of starts in the file of the same name with `.starts` behind it, where the next one is left.
    ///
    /// # Errors
    /// [`WireError`], naming the file and the remedy.
    pub fn read(path: &Path) -> Result<Self, WireError> {
        let KeyFile { key, remark } = KeyFile::read(path)?;
        let mut name = path.as_os_str().to_owned();
        name.push(".starts");
        let path = PathBuf::from(name);
        let starts = match std::fs::read_to_string(&path) {
            Ok(text) => text.trim().parse::<u32>().ok(),
            Err(error) if error.kind() == ErrorKind::NotFound => Some(0),
            Err(source) => return Err(WireError::Read { path, source }),
        };
        let starts = starts.filter(|starts| Sealed::<1>::at_start(&key, *starts).is_some());
        let Some(starts) = starts else {
            return Err(WireError::NoNumber { path });
        };
        if let Err(source) = std::fs::write(&path, format!("{}\n", starts + 1)) {
            return Err(WireError::Write { path, source });
        }
        Ok(Self { key, starts, remark })
    }
}

impl CompanionWire {
    /// In a format, and so that only who has the key is heard, if there is one.
    #[must_use]
    pub fn new(format: Format, seal: Option<&Seal>) -> Self {
        match (format, seal) {
            (Format::Mavlink, None) => Self::Mavlink(Mavlink),
            (Format::Mavlink, Some(seal)) => {
                let signing = Signing::new(seal.key.clone(), 0, key::timestamp());
                Self::Signed(Signed::new(signing))
            }
            (Format::Postcard, seal) => {
                let sealed = seal.and_then(|seal| Sealed::at_start(&seal.key, seal.starts));
                sealed.map_or(Self::Postcard(Postcard), Self::Sealed)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use staya_controller::robot::RobotId;

    const HEADER: Header = Header { boot: 0, sender: RobotId(3), sequence: 1 };

    fn said(wire: &mut CompanionWire) -> Vec<u8, 128> {
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
        let seal = || Seal::read(&path).unwrap();
        for format in [Format::Postcard, Format::Mavlink] {
            let mut speaker = CompanionWire::new(format, Some(&seal()));
            let mut listener = CompanionWire::new(format, Some(&seal()));
            let frame = said(&mut speaker);
            let mut rest = frame.as_slice();
            let frame = listener.next_frame(&mut rest).unwrap();
            assert_eq!(listener.decode(frame).unwrap().header, HEADER);
            assert!(listener.decode(frame).is_err(), "a replay");
            let open = said(&mut CompanionWire::new(format, None));
            let mut rest = open.as_slice();
            let frame = listener.next_frame(&mut rest).unwrap();
            assert!(listener.decode(frame).is_err(), "without the key");
            let mut stranger = CompanionWire::new(format, None);
            assert!(stranger.decode(frame).is_ok(), "sound as it is");
        }
    }

    #[test]
    fn each_start_has_a_number_of_its_own() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("swarm.key");
        std::fs::write(&path, "passphrase: one for all\n").unwrap();
        let starts = (0..3).map(|_| Seal::read(&path).unwrap().starts);
        assert_eq!(starts.collect::<std::vec::Vec<_>>(), [0, 1, 2]);
        let kept = folder.path().join("swarm.key.starts");
        for wrong in ["", "many", "-1", "1048576"] {
            std::fs::write(&kept, wrong).unwrap();
            let error = Seal::read(&path).expect_err(wrong).to_string();
            assert!(error.contains("swarm.key.starts does not hold"), "{error}");
        }
        std::fs::remove_file(&kept).unwrap();
        std::fs::create_dir(&kept).unwrap();
        assert!(matches!(Seal::read(&path), Err(WireError::Read { .. })));
        let error = Seal::read(&folder.path().join("none")).expect_err("no key");
        assert!(error.to_string().contains("none"), "{error}");
    }
}
