//! Key change while a companion runs: the key file is watched, and both keys are valid for a while.

use staya_controller::auth::Key;
use staya_sim::key::KeyFile;
use staya_sim::radio::HostWire;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::Duration;

const LOOK: Duration = Duration::from_secs(1);

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Turn {
    /// Accept the new key too.
    Hear(Key),
    /// Send with the new key, still accept the old one.
    Speak,
    /// Accept the old key no more.
    Forget,
}

/// A companion accepts the new key at once, sends with it after half of the overlap, and drops the
/// old key after all of it. Files that change within half of the overlap keep contact.
#[derive(Clone, Debug)]
pub struct Roll {
    generation: u16,
    overlap: Duration,
    due: Option<(Duration, Turn)>,
}

impl Roll {
    /// With `has_old` the previous key is accepted from the start and dropped after the overlap.
    pub fn new(overlap: Duration, has_old: bool) -> Self {
        Self { generation: has_old.into(), overlap, due: has_old.then_some((overlap, Turn::Forget)) }
    }

    #[must_use]
    pub fn begin(&mut self, now: Duration, key: Key) -> Turn {
        self.generation = self.generation.saturating_add(1);
        self.due = Some((now + self.overlap / 2, Turn::Speak));
        Turn::Hear(key)
    }

    #[must_use]
    pub fn turn(&mut self, now: Duration) -> Option<Turn> {
        let (_, turn) = self.due.take_if(|(at, _)| now >= *at)?;
        if turn == Turn::Speak {
            self.due = Some((now + self.overlap / 2, Turn::Forget));
        }
        Some(turn)
    }

    pub fn apply(&self, turn: &Turn, wire: &mut HostWire) {
        match (wire, turn) {
            (HostWire::Sealed(sealed), Turn::Hear(key)) => sealed.ring_mut().hear_key(self.generation, key),
            (HostWire::Sealed(sealed), Turn::Speak) => sealed.ring_mut().speak(self.generation),
            (HostWire::Sealed(sealed), Turn::Forget) => sealed.ring_mut().forget_before(self.generation),
            (HostWire::Signed(signed), Turn::Hear(key)) => signed.signing_mut().hear(key.clone()),
            (HostWire::Signed(signed), Turn::Speak) => signed.signing_mut().speak(),
            (HostWire::Signed(signed), Turn::Forget) => signed.signing_mut().forget(),
            (HostWire::Postcard(_) | HostWire::Mavlink(_), _) => {}
        }
    }
}

/// Watches a key file in its own thread, so that a hanging disk does not block the controllers.
#[derive(Debug)]
pub struct KeyWatch(Receiver<Result<Key, String>>);

impl KeyWatch {
    /// Reports each key that differs from the previous one, and each error once.
    pub fn start(path: PathBuf, mut key: Key) -> Self {
        let (sender, receiver) = channel();
        let mut is_told = false;
        let watch = move || {
            loop {
                thread::sleep(LOOK);
                let read = KeyFile::read(&path);
                let was_told = core::mem::replace(&mut is_told, read.is_err());
                let news = match read {
                    Ok(file) if file.key == key => None,
                    Ok(file) => {
                        key = file.key.clone();
                        Some(Ok(file.key))
                    }
                    Err(error) => (!was_told).then(|| Err(error.to_string())),
                };
                if news.is_some_and(|news| sender.send(news).is_err()) {
                    break;
                }
            }
        };
        let _ = thread::Builder::new().name("key".into()).spawn(watch);
        Self(receiver)
    }

    pub fn news(&self) -> Option<Result<Key, String>> {
        self.0.try_recv().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::super::seal::Seal;
    use super::*;
    use heapless::Vec;
    use staya_controller::robot::RobotId;
    use staya_controller::wire::{DecodeError, Format, Header, Message, Wire};

    const OVERLAP: Duration = Duration::from_secs(60);

    fn hears(by: &mut HostWire, of: &mut HostWire, sequence: u16) -> Result<(), DecodeError> {
        let mut out = Vec::<u8, 128>::new();
        let header = Header { boot: 0, sender: RobotId(3), sequence };
        of.encode(header, &Message::Beacon(Default::default()), &mut out).unwrap();
        let mut rest = out.as_slice();
        let frame = by.next_frame(&mut rest).unwrap();
        by.decode(frame).map(drop)
    }

    #[test]
    fn companions_hear_each_other_while_the_key_changes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("swarm.key");
        std::fs::write(&path, "passphrase: old\n").unwrap();
        std::fs::write(folder.path().join("swarm.key.starts"), "0\n").unwrap();
        let new = Key::of_passphrase(b"new");
        for format in [Format::Postcard, Format::Mavlink] {
            for apart_s in [0, 10, 29] {
                let mut wires: [HostWire; 3] = std::array::from_fn(|_| Seal::read(&path).unwrap().wire(format));
                let mut rolls = [Roll::new(OVERLAP, false), Roll::new(OVERLAP, false)];
                for second in 0..150_u16 {
                    let now = Duration::from_secs(second.into());
                    for (at, roll) in rolls.iter_mut().enumerate() {
                        let begins = usize::from(second) == 5 + at * apart_s;
                        let turn = if begins { Some(roll.begin(now, new.clone())) } else { roll.turn(now) };
                        if let Some(turn) = turn {
                            roll.apply(&turn, &mut wires[at]);
                        }
                    }
                    let [first, second_one, third] = &mut wires;
                    assert_eq!(hears(first, second_one, second), Ok(()), "{format:?} {apart_s} {second}");
                    if second > 100 {
                        assert_eq!(hears(first, third, second), Err(DecodeError::Forged));
                        assert_eq!(hears(third, first, second), Err(DecodeError::Forged));
                    }
                }
            }
        }
    }

    #[test]
    fn a_companion_started_during_a_change_accepts_both_keys() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("swarm.key");
        std::fs::write(&path, "passphrase: old\n").unwrap();
        std::fs::write(folder.path().join("swarm.key.starts"), "0\n").unwrap();
        for format in [Format::Postcard, Format::Mavlink] {
            std::fs::write(&path, "passphrase: old\n").unwrap();
            let _ = std::fs::remove_file(folder.path().join("swarm.key.old"));
            let mut late = Seal::read(&path).unwrap().wire(format);
            std::fs::rename(&path, folder.path().join("swarm.key.old")).unwrap();
            std::fs::write(&path, "passphrase: new\n").unwrap();
            let seal = Seal::read(&path).unwrap();
            let mut started = seal.wire(format);
            let mut roll = Roll::new(OVERLAP, seal.has_old());
            assert_eq!(hears(&mut started, &mut late, 1), Ok(()), "{format:?}");
            assert_eq!(hears(&mut late, &mut started, 1), Err(DecodeError::Forged), "its file has not changed yet");
            assert_eq!(roll.turn(OVERLAP / 2), None);
            let turn = roll.turn(OVERLAP).unwrap();
            roll.apply(&turn, &mut started);
            assert_eq!(hears(&mut started, &mut late, 2), Err(DecodeError::Forged));
        }
    }

    #[test]
    fn a_changed_or_broken_key_file_is_reported_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("swarm.key");
        std::fs::write(&path, "passphrase: old\n").unwrap();
        let watch = KeyWatch::start(path.clone(), Key::of_passphrase(b"old"));
        let wait = || {
            (0..400).find_map(|_| {
                watch.news().or_else(|| {
                    thread::sleep(Duration::from_millis(25));
                    None
                })
            })
        };
        std::fs::write(&path, "passphrase:\n").unwrap();
        assert!(wait().unwrap().unwrap_err().contains("the passphrase is empty"));
        std::fs::write(&path, "passphrase: new\n").unwrap();
        assert_eq!(wait().unwrap(), Ok(Key::of_passphrase(b"new")));
        assert!(watch.news().is_none());
    }
}
