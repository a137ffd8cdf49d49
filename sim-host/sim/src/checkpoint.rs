//! Checkpoints: one file from which a run resumes with the same trace hash and the same records.
//!
//! ```text
//! "staya checkpoint" format:u32, then head, state, history, trace.csv and series.csv so far,
//! each as length:u64 bytes crc32:u32, of length and bytes
//! ```
//!
//! Integers are little-endian; head, state and history are in postcard format. The file is synced
//! under a temporary name and renamed; the previous one is kept as `FILE.old`. Only its owner can
//! read it, because it contains keys of the scenario. Other files of these names are not replaced.

pub use crate::engine::CheckpointInterval;

use crate::engine::{Saves, StateError};
use crate::file::{self, read_remedy};
use crate::record::{self, Access, Output, Recorder, remove_stale};
use crate::scenario::Scenario;
use crate::shown::{Shown as _, one_line};
use crc32fast::Hasher;
use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Read, Seek as _, SeekFrom, Write};
use std::path::{Path, PathBuf};
use thiserror::Error;

const MAGIC: &[u8; 16] = b"staya checkpoint";
const FORMAT: u32 = 3;
const VERSION: &str = env!("CARGO_PKG_VERSION");
const PARTS: [&str; 5] = ["head", "state", "history", "trace.csv", "series.csv"];
const TRACE: usize = 3;
const SERIES: usize = 4;
const FIRST: u64 = MAGIC.len() as u64 + 4;
/// Longer than any head, bytes.
const LONGEST_HEAD: u64 = 1 << 16;

/// The file is damaged, or not a checkpoint of this scenario.
#[derive(Debug, Error)]
#[error("{}: {}; {}", path.shown(), one_line(what), one_line(remedy))]
pub struct CheckpointError {
    path: PathBuf,
    what: String,
    remedy: String,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Head {
    version: String,
    scenario: String,
    fingerprint: u64,
    tick: u32,
    wall_seconds: f64,
}

/// Location of a run's checkpoints.
#[derive(Clone, Debug)]
pub struct Place {
    path: PathBuf,
    scenario: String,
    fingerprint: u64,
}

impl Place {
    /// Creates the location for a run of `scenario`, and removes what dead runs left there.
    ///
    /// # Errors
    /// A file of that name, or of the name of its predecessor, is not a checkpoint of this run.
    pub fn new(path: PathBuf, scenario: &Scenario) -> Result<Self, CheckpointError> {
        let this = Self { path, scenario: scenario.name.clone(), fingerprint: scenario.fingerprint() };
        for path in this.files() {
            if !this.may_replace(&path) {
                let what = "it is not a checkpoint of this run and would be replaced".to_owned();
                return Err(CheckpointError { path, what, remedy: "move it, or choose another --out".to_owned() });
            }
            remove_stale(&path);
        }
        Ok(this)
    }

    /// Paths of the checkpoint and its predecessor.
    #[must_use]
    pub fn files(&self) -> [PathBuf; 2] {
        [self.path.clone(), beside(&self.path, ".old")]
    }

    /// Reads the beginning of the file.
    fn may_replace(&self, path: &Path) -> bool {
        if path.symlink_metadata().is_err() {
            return true;
        }
        let mut bytes = Vec::new();
        let _ = file::open(path).and_then(|file| file.take(LONGEST_HEAD).read_to_end(&mut bytes));
        let head = bytes.strip_prefix(MAGIC).and_then(|rest| rest.strip_prefix(&FORMAT.to_le_bytes()));
        let head = head.and_then(|rest| postcard::take_from_bytes::<Head>(rest.get(8..)?).ok());
        head.is_some_and(|(head, _)| head.fingerprint == self.fingerprint)
    }

    /// Path of the checkpoint file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a checkpoint of a run at `tick` that has taken `wall_seconds`. Replaces the previous
    /// one, kept as `FILE.old`, only when the new one is complete.
    ///
    /// # Errors
    /// It cannot be written (the previous one is then unchanged), or records cannot be read.
    ///
    /// # Panics
    /// If some robots of the run have external controllers.
    pub fn write(
        &self,
        tick: u32,
        wall_seconds: f64,
        run: &dyn Saves,
        recorder: &mut Recorder,
    ) -> Result<(), record::Error> {
        let mut state = Vec::new();
        run.save(&mut state).expect("all robots are here");
        let head = Head {
            version: VERSION.to_owned(),
            scenario: self.scenario.clone(),
            fingerprint: self.fingerprint,
            tick,
            wall_seconds,
        };
        let parts = [encoded(&head), state, encoded(&recorder.saved())];
        let records = recorder.written()?;
        let mut output = Output::with(&self.path, Access::Private)?;
        let done = (|| {
            let mut out = BufWriter::new(&mut output);
            out.write_all(MAGIC)?;
            out.write_all(&FORMAT.to_le_bytes())?;
            for part in &parts {
                write_part(&mut out, part.len() as u64, &mut part.as_slice())?;
            }
            for record in records {
                match record {
                    Some((path, length)) => write_part(&mut out, length, &mut File::open(path)?)?,
                    None => write_part(&mut out, 0, &mut io::empty())?,
                }
            }
            out.flush()
        })();
        done.map_err(record::Error::new("write", &self.path))?;
        output.finish_by(replace)
    }
}

/// A checkpoint exists at every moment.
fn replace(temporary: &Path, path: &Path) -> io::Result<()> {
    let link = beside(path, &format!(".old.{}.tmp", std::process::id()));
    let old = beside(path, ".old");
    let kept = fs::hard_link(path, &link).and_then(|()| fs::rename(&link, &old));
    match kept {
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        // Without hard links, the checkpoint is missing for a moment.
        Err(_) => fs::rename(path, &old)?,
        Ok(()) => {}
    }
    fs::rename(temporary, path)?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let _ = File::open(folder.unwrap_or(Path::new("."))).and_then(|folder| folder.sync_all());
    Ok(())
}

fn encoded(value: &impl Serialize) -> Vec<u8> {
    postcard::to_extend(value, Vec::new()).expect("it has a form")
}

fn beside(path: &Path, end: &str) -> PathBuf {
    let mut name = OsString::from(path.file_name().unwrap_or_default());
    name.push(end);
    path.with_file_name(name)
}

fn write_part(out: &mut impl Write, length: u64, from: &mut dyn Read) -> io::Result<()> {
    let mut crc = Hasher::new();
    let size = length.to_le_bytes();
    crc.update(&size);
    out.write_all(&size)?;
    copy(length, from, &mut crc, out)?;
    out.write_all(&crc.finalize().to_le_bytes())
}

fn copy(length: u64, from: &mut dyn Read, crc: &mut Hasher, out: &mut dyn Write) -> io::Result<()> {
    let mut block = [0; 1 << 16];
    let mut left = length;
    while left > 0 {
        let most = usize::try_from(left).unwrap_or(usize::MAX).min(block.len());
        let block = &mut block[..most];
        from.read_exact(block)?;
        crc.update(block);
        out.write_all(block)?;
        left -= most as u64;
    }
    Ok(())
}

#[derive(Clone, Copy, Debug)]
struct Part {
    at: u64,
    length: u64,
}

/// A verified checkpoint of this scenario and this program.
#[derive(Debug)]
pub struct Checkpoint {
    path: PathBuf,
    file: File,
    parts: [Part; PARTS.len()],
    head: Head,
    state: Vec<u8>,
}

impl Checkpoint {
    /// Opens a checkpoint of a run of `scenario`, with any number of ticks. Reads the file once.
    ///
    /// # Errors
    /// It cannot be read, is damaged, or belongs to another program version or scenario.
    pub fn open(path: &Path, scenario: &Scenario) -> Result<Self, CheckpointError> {
        let error =
            |what: String, remedy: &str| CheckpointError { path: path.to_owned(), what, remedy: remedy.to_owned() };
        let of_io = |source: io::Error| error(source.to_string(), read_remedy(&source));
        let old = beside(path, ".old");
        let other = if old.exists() { format!("take {}", old.shown()) } else { "restart the run".to_owned() };
        let mut file = file::open(path).map_err(of_io)?;
        let size = file.metadata().map_err(of_io)?.len();
        let cut = |at: u64, part: &str| error(format!("byte {at}: it ends in its {part}"), &other);
        let mut first = [0; FIRST as usize];
        if size >= FIRST {
            file.read_exact(&mut first).map_err(of_io)?;
        }
        let Some(format) = first.strip_prefix(MAGIC) else {
            return Err(error(
                "byte 0: this is not a checkpoint".to_owned(),
                "name a file that `staya run --checkpoint` made",
            ));
        };
        if format != FORMAT.to_le_bytes() {
            let what = format!("byte {}: it is of another version of the program", MAGIC.len());
            return Err(error(what, "resume with the program that made it, or restart the run"));
        }
        let mut parts = [Part { at: 0, length: 0 }; PARTS.len()];
        let mut kept = [Vec::new(), Vec::new()];
        let mut at = FIRST;
        for (index, name) in PARTS.into_iter().enumerate() {
            let mut number = [0; 8];
            if size - at < 8 {
                return Err(cut(size, name));
            }
            file.read_exact(&mut number).map_err(of_io)?;
            let length = u64::from_le_bytes(number);
            if length > (size - at - 8).saturating_sub(4) {
                // The length itself may be damaged; the rest cannot be found in either case.
                return Err(cut(size, name));
            }
            parts[index] = Part { at: at + 8, length };
            let mut crc = Hasher::new();
            crc.update(&number);
            let done = match kept.get_mut(index) {
                Some(bytes) => copy(length, &mut file, &mut crc, bytes),
                None => copy(length, &mut file, &mut crc, &mut io::sink()),
            };
            done.map_err(of_io)?;
            let mut expected = [0; 4];
            file.read_exact(&mut expected).map_err(of_io)?;
            if crc.finalize().to_le_bytes() != expected {
                let what = format!("bytes {at} to {}: its {name} is damaged", at + 11 + length);
                return Err(error(what, &other));
            }
            at += 12 + length;
        }
        if at < size {
            return Err(error(format!("byte {at}: there is more than a checkpoint"), &other));
        }
        let [head, state] = kept;
        let in_head = format!("byte {}", parts[0].at);
        let head: Head =
            postcard::from_bytes(&head).map_err(|_| error(format!("{in_head}: its head makes no sense"), &other))?;
        if head.version != VERSION {
            let what = format!("{in_head}: it is of version {}, this is {VERSION}", head.version);
            return Err(error(what, "resume with the program that made it, or restart the run"));
        }
        if head.fingerprint != scenario.fingerprint() {
            let what = match head.scenario == scenario.name {
                true => format!("{in_head}: `{}` has changed since (or its seed, map or key)", scenario.name),
                false => format!("{in_head}: it is of the scenario `{}`, not of `{}`", head.scenario, scenario.name),
            };
            return Err(error(what, "name the scenario as it was run; only `ticks` may differ"));
        }
        if head.tick > scenario.ticks {
            let what = format!("{in_head}: it is at tick {}, where this run is over", head.tick);
            return Err(error(what, "raise `ticks`, or take an earlier one"));
        }
        Ok(Self { path: path.to_owned(), file, parts, head, state })
    }

    /// Tick of the checkpoint.
    #[must_use]
    pub const fn tick(&self) -> u32 {
        self.head.tick
    }

    /// Duration of the run until the checkpoint, seconds.
    #[must_use]
    pub const fn wall_seconds(&self) -> f64 {
        self.head.wall_seconds
    }

    /// State of the run, for [`simulate_from`](crate::engine::simulate_from).
    #[must_use]
    pub fn state(&self) -> &[u8] {
        &self.state
    }

    /// Converts an engine error about the state to an error about the file.
    #[must_use]
    pub fn refused(&self, error: StateError) -> CheckpointError {
        let begin = usize::try_from(self.parts[1].at).unwrap_or(usize::MAX);
        CheckpointError {
            path: self.path.clone(),
            what: error.after(begin).to_string(),
            remedy: "it may be of another build of this version".to_owned(),
        }
    }

    /// Whether the run recorded each robot; a run that did not cannot start doing so.
    #[must_use]
    pub const fn keeps_robots(&self) -> bool {
        self.parts[TRACE].length > 0
    }

    /// Creates a recorder in folder `dir` that continues the saved records, also those of robots if
    /// `keeps_robots` is set and the checkpoint has them.
    ///
    /// # Errors
    /// The saved records cannot be read, or the files cannot be written.
    pub fn recorder(&mut self, dir: &Path, keeps_robots: bool) -> Result<Recorder, record::Error> {
        let keeps_robots = keeps_robots && self.keeps_robots();
        let reading = |error: io::Error| record::Error::new("read", &self.path)(error);
        let mut bytes = Vec::new();
        part(&mut self.file, self.parts[2], &mut bytes).map_err(reading)?;
        let saved = postcard::from_bytes(&bytes)
            .map_err(|_| reading(io::Error::new(ErrorKind::InvalidData, "its history makes no sense")))?;
        record::make_dir(dir)?;
        for (name, index) in [("trace.csv", TRACE), ("series.csv", SERIES)] {
            if index == TRACE && !keeps_robots {
                continue;
            }
            let path = dir.join(name);
            let mut out = BufWriter::new(File::create(&path).map_err(record::Error::new("make", &path))?);
            let copied = part(&mut self.file, self.parts[index], &mut out).and_then(|()| out.flush());
            copied.map_err(record::Error::new("write", &path))?;
        }
        Recorder::resumed(dir, keeps_robots, saved)
    }
}

fn part(file: &mut File, part: Part, out: &mut dyn Write) -> io::Result<()> {
    file.seek(SeekFrom::Start(part.at))?;
    copy(part.length, file, &mut Hasher::new(), out)
}

#[cfg(test)]
mod tests;
