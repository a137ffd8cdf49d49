//! The part of a plan that one process makes, and its file of rows.
//!
//! Whole lines are appended to the file, so a crash or a full disk damages only the last line. The
//! next process makes the missing runs.

use crate::error::SweepError;
use crate::sweep::jobs;
use crate::sweep::plan::Plan;
use crate::sweep::row::{Finished, Outcome, Row, header, is_older_header};
use staya_sim::file::{MAP, read};
use staya_sim::record::{Error, make_dir};
use staya_sim::shown::Shown as _;
use std::collections::BTreeSet;
use std::fmt::{self, Display, Formatter};
use std::fs::{self, File, TryLockError};
use std::io::{ErrorKind, Seek as _, SeekFrom, Write as _};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::{Duration, Instant};

/// Folder of the shards' rows within the results.
pub const FOLDER: &str = "shards";
/// Run times are not part of rows, because they differ between machines.
const TIMES: &str = "times";
const SYNC: Duration = Duration::from_secs(2);

/// One of several equal parts of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    index: u64,
    of: u64,
}

impl Default for Shard {
    /// The whole plan.
    fn default() -> Self {
        Self { index: 1, of: 1 }
    }
}

impl Shard {
    /// Whether the shard is the whole plan.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.of == 1
    }

    /// Whether the shard contains a run; consecutive runs are in different shards.
    #[must_use]
    pub fn has(&self, run: u64) -> bool {
        run % self.of == self.index - 1
    }

    fn file_name(&self) -> String {
        format!("{}-of-{}.csv", self.index, self.of)
    }
}

impl Display for Shard {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parts = text.split_once('/').and_then(|(index, of)| Some((index.parse().ok()?, of.parse().ok()?)));
        match parts {
            Some((index, of)) if (1..=of).contains(&index) => Ok(Self { index, of }),
            Some((_, of)) if of > 0 => Err(format!("there is no shard {text}; give 1/{of} to {of}/{of}")),
            _ => Err("give the number of the shard and how many there are, as in 3/8".to_owned()),
        }
    }
}

/// Treatment of existing rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// Refuse to start.
    Refuse,
    /// Make the missing runs.
    Resume,
    /// Replace the rows.
    Forget,
}

/// Rows of one file.
#[derive(Debug, Default)]
pub struct Rows {
    /// Rows with their line numbers.
    pub rows: Vec<(usize, Row)>,
    whole: u64,
    /// Bytes of an incomplete last line.
    pub torn: usize,
}

/// Reads a file of rows without an incomplete last line.
///
/// # Errors
/// The file cannot be read, or a line is damaged or belongs to another plan or version. Names file
/// and line.
pub fn read_rows(plan: &Plan, path: &Path) -> Result<Rows, SweepError> {
    let unreadable = |error: std::io::Error| {
        let remedy = staya_sim::file::read_remedy(&error);
        SweepError::new(path.shown(), error.to_string(), remedy)
    };
    let bytes = read(path, MAP).map_err(unreadable)?;
    let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
    let (lines, torn) = bytes.split_at(whole);
    let mut rows = Rows { whole: whole as u64, torn: torn.len(), ..Rows::default() };
    let expected = header(plan);
    for (line, number) in lines.split_inclusive(|&byte| byte == b'\n').zip(1..) {
        let wrong =
            |(what, remedy): (String, String)| SweepError::new(format_args!("{}:{number}", path.shown()), what, remedy);
        // A byte that is not UTF-8 is replaced, which the checksum reveals.
        let line = String::from_utf8_lossy(line);
        let line = line.trim_end_matches('\n');
        if number > 1 {
            rows.rows.push((number, Row::read(plan, line).map_err(wrong)?));
        } else if is_older_header(plan, line) {
            let what = "its rows have no checksums, so an older program wrote them".to_owned();
            return Err(wrong((what, "choose another folder with --out, or begin again with --restart".to_owned())));
        } else if line != expected {
            let what = "its columns are not those of this plan".to_owned();
            let remedy = "choose another folder with --out, or begin again with --restart; if only this line is \
                damaged, remove the file, and `--resume` does its runs again";
            return Err(wrong((what, remedy.to_owned())));
        }
    }
    Ok(rows)
}

/// Lists the files of rows in a folder of results, sorted.
///
/// # Errors
/// The folder cannot be read.
pub fn files(out: &Path) -> Result<Vec<PathBuf>, Error> {
    let folder = out.join(FOLDER);
    let entries = match fs::read_dir(&folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(Error::new("read directory", &folder)(error)),
    };
    let mut files = Vec::new();
    for entry in entries {
        let entry = entry.map_err(Error::new("read directory", &folder))?;
        if entry.file_name().to_string_lossy().ends_with(".csv") {
            files.push(entry.path());
        }
    }
    files.sort();
    Ok(files)
}

#[derive(Debug)]
struct Appended {
    file: File,
    path: PathBuf,
    times: Option<File>,
    synced: Instant,
}

impl Appended {
    fn open(plan: &Plan, out: &Path, shard: Shard, existing: Existing) -> Result<(Self, usize), SweepError> {
        let path = out.join(FOLDER).join(shard.file_name());
        make_dir(&out.join(FOLDER))?;
        make_dir(&out.join(TIMES))?;
        let open = File::options().create(true).read(true).append(true).open(&path);
        let mut file = open.map_err(Error::new("open", &path))?;
        // Continues without a lock if the file system does not support locks.
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            let what = "another process is at work on it";
            return Err(SweepError::new(path.shown(), what, "wait for it, or end it"));
        }
        if existing == Existing::Forget {
            file.set_len(0).map_err(Error::new("write", &path))?;
        }
        // Another process may have appended rows since the file was read.
        let Rows { whole, torn, .. } = read_rows(plan, &path)?;
        file.set_len(whole).and_then(|()| file.seek(SeekFrom::End(0))).map_err(Error::new("write", &path))?;
        let times = File::options().create(true).append(true).open(out.join(TIMES).join(shard.file_name())).ok();
        let mut this = Self { file, path, times, synced: Instant::now() };
        if whole == 0 {
            this.append(&header(plan))?;
        }
        Ok((this, torn))
    }

    fn append(&mut self, line: &str) -> Result<(), Error> {
        // In one write: a killed process leaves the whole line or nothing.
        let written = self.file.write_all(format!("{line}\n").as_bytes());
        written.map_err(Error::new("write", &self.path))?;
        if self.synced.elapsed() > SYNC {
            self.sync()?;
        }
        Ok(())
    }

    fn sync(&mut self) -> Result<(), Error> {
        self.synced = Instant::now();
        self.file.sync_data().map_err(Error::new("write", &self.path))
    }
}

/// Progress of a shard.
#[derive(Clone, Debug, Default)]
pub struct Course {
    /// Runs of the shard.
    pub runs: u64,
    /// Rows found at the start.
    pub found: u64,
    /// Runs made now.
    pub done: u64,
    /// Impossible runs among them, and the first reason.
    pub impossible: Option<(u64, String)>,
    /// Incomplete lines found.
    pub torn: usize,
}

impl Course {
    /// Runs that are still missing.
    #[must_use]
    pub fn missing(&self) -> u64 {
        self.runs - self.found - self.done
    }
}

/// Makes the missing runs of a shard and appends each row when its run is done.
///
/// `job` makes a run on any thread; `None` ends the shard. `progress` receives the numbers of runs
/// done and to do.
///
/// # Errors
/// Existing rows belong to another plan or version or must not be replaced, or a file cannot be
/// written. Finished rows are kept.
pub fn perform_shard(
    plan: &Plan,
    shard: Shard,
    out: &Path,
    existing: Existing,
    job: impl Fn(u64) -> Option<Finished> + Sync,
    mut progress: impl FnMut(u64, u64) + Send,
) -> Result<Course, SweepError> {
    if existing == Existing::Forget && shard.is_whole() {
        for file in files(out)? {
            fs::remove_file(&file).map_err(Error::new("remove", &file))?;
        }
    }
    let own = out.join(FOLDER).join(shard.file_name());
    let mut there = BTreeSet::new();
    for file in files(out)? {
        if existing == Existing::Forget && file == own {
            continue;
        }
        let rows = read_rows(plan, &file)?.rows;
        if existing == Existing::Refuse && !rows.is_empty() && (file == own || shard.is_whole()) {
            let what = format!("it has {} of {} runs", rows.len(), plan.runs());
            return Err(SweepError::new(file.shown(), what, "--resume does the others, --restart forgets these"));
        }
        let done = rows.into_iter().filter(|(_, row)| row.outcome == Outcome::Done);
        there.extend(done.map(|(_, row)| row.run));
    }
    let (mut file, torn) = Appended::open(plan, out, shard, existing)?;
    let mine: Vec<u64> = (0..plan.runs()).filter(|&run| shard.has(run)).collect();
    let missing: Vec<u64> = mine.iter().copied().filter(|run| !there.contains(run)).collect();
    let mut course =
        Course { runs: mine.len() as u64, found: (mine.len() - missing.len()) as u64, torn, ..Course::default() };
    let mut failed = None;
    let take = |_, finished: Option<Finished>| {
        let Some(Finished { row, seconds, refusal }) = finished else {
            return ControlFlow::Break(());
        };
        if let Err(error) = file.append(&row.line(plan)) {
            failed = Some(error);
            return ControlFlow::Break(());
        }
        if let Some(times) = &mut file.times {
            let _ = writeln!(times, "{},{seconds:.6}", row.run);
        }
        if let Some(why) = refusal {
            course.impossible.get_or_insert((0, why)).0 += 1;
        }
        course.done += 1;
        progress(course.done, missing.len() as u64);
        ControlFlow::Continue(())
    };
    jobs::each(missing.len(), plan.at_once(), |index| job(missing[index]), take);
    file.sync()?;
    match failed {
        Some(error) => Err(error.into()),
        None => Ok(course),
    }
}

#[cfg(test)]
mod tests;
