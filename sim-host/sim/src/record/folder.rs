//! Atomic replacement of a results folder. A run writes to `.NAME.partial-PID`; then the old folder
//! is renamed to `.NAME.old-PID` and the new one to `NAME`. After an interruption one of these is
//! complete, and the next run restores or removes the remains of a dead run (known by a file lock).
//! Only files listed in [`MARKER`] are replaced; others move to the new folder. Into a folder that
//! no run created, files move one by one, the summary last, unless it has a file named as a result.

use super::Error;
use std::collections::BTreeSet;
use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

/// List of a run's files in its results folder; locked while the run is active.
pub const MARKER: &str = ".staya-results";
/// Missing while a folder is changed file by file, and present when it is complete.
const SUMMARY: &str = "summary.json";
/// Names of result files, to recognise folders without a list.
const KNOWN: [&str; 13] = [
    SUMMARY,
    "formation.png",
    "formation.svg",
    "motion.png",
    "motion.svg",
    "packets.png",
    "packets.svg",
    "series.csv",
    "series.schema.json",
    "trace.csv",
    "trace.schema.json",
    "trajectories.png",
    "trajectories.svg",
];
/// Age after which a folder without a locked list counts as dead: active runs lock at once.
const YOUNG: Duration = Duration::from_secs(60);
const TRIES: usize = 32;

static BEGUN: AtomicU32 = AtomicU32::new(0);

/// Results of an active run; removed if dropped unfinished; the old results stay.
#[derive(Debug)]
pub struct Results {
    target: PathBuf,
    partial: PathBuf,
    /// The list in `partial`; `None`: nothing needs to be removed.
    marker: Option<File>,
    one_by_one: bool,
}

impl Results {
    /// Creates the folder for a run's files, and removes what dead runs into the same `target`
    /// left. `target` is not touched and does not have to exist.
    ///
    /// # Errors
    /// The folder cannot be created, or `target` is a file or has foreign files named as results.
    pub fn begin(target: impl AsRef<Path>) -> Result<Self, Error> {
        let target = resolved(target.as_ref())?;
        let (parent, name) = split(&target);
        let is_there = match fs::metadata(&target) {
            Ok(found) if found.is_dir() => true,
            Ok(_) => return Err(Error::new("make directory", &target)(ErrorKind::NotADirectory.into())),
            Err(_) => false,
        };
        fs::create_dir_all(&parent).map_err(Error::new("make directory", &target))?;
        for place in [&parent, &target] {
            clear(place, &name, &target);
        }
        let mut one_by_one = is_there && (is_in_use(&target) || check(&target)?);
        let (partial, marker) = match make(&parent, &name) {
            Ok(made) => made,
            // For example a container volume: files can be written into it, but not next to it.
            Err(_) if is_there => {
                one_by_one = true;
                make(&target, &name).map_err(Error::new("write to", &target))?
            }
            Err(error) => return Err(Error::new("make directory", &target)(error)),
        };
        Ok(Self { target, partial, marker: Some(marker), one_by_one })
    }

    /// Folder to write to.
    #[must_use]
    pub fn dir(&self) -> &Path {
        &self.partial
    }

    /// Final folder.
    #[must_use]
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Moves all files to the final folder. O(files).
    ///
    /// # Errors
    /// A file cannot be moved. New and old results stay where they are, if possible.
    pub fn finish(mut self) -> Result<(), Error> {
        let done = self.settle();
        self.marker = None;
        done.map_err(|source| Error::new("move the new results into", &self.target)(source))
    }

    /// Keeps the partial results until the next run into the same target, and returns their folder.
    #[must_use]
    pub fn keep(mut self) -> PathBuf {
        self.marker = None;
        std::mem::take(&mut self.partial)
    }

    fn settle(&mut self) -> io::Result<()> {
        let names = entries(&self.partial)?;
        if let Some(marker) = &mut self.marker {
            write_list(marker, &names)?;
        }
        if cfg!(windows) {
            // On some systems an open file prevents the rename of its folder.
            self.marker = None;
        }
        if !self.one_by_one && self.swap()? {
            return Ok(());
        }
        self.move_in(&names)
    }

    /// Replaces the whole folder; false if the system does not allow it, and nothing is changed.
    fn swap(&self) -> io::Result<bool> {
        let (parent, name) = split(&self.target);
        // Process and number, as in the name of the new folder, are unique.
        let own = self.partial.file_name().unwrap_or_default().to_string_lossy();
        let own = own.strip_prefix(&prefix(&name, "partial")).unwrap_or_default();
        let mut aside = Vec::new();
        let mut outcome = Err(io::Error::other("other runs keep replacing the folder"));
        for attempt in 0..TRIES {
            match fs::rename(&self.partial, &self.target) {
                Ok(()) => {
                    outcome = Ok(true);
                    break;
                }
                Err(error) if is_in_the_way(&error) => {}
                Err(error) => {
                    outcome = Err(error);
                    break;
                }
            }
            let old = parent.join(format!("{}{own}-{attempt}", prefix(&name, "old")));
            match fs::rename(&self.target, &old) {
                Ok(()) => aside.push(old),
                // Another run is at the same point.
                Err(error) if error.kind() == ErrorKind::NotFound => {}
                Err(_) => {
                    outcome = Ok(false);
                    break;
                }
            }
        }
        // Best effort: the next run removes or restores the remains.
        aside.iter().for_each(|old| drop(retire(old, &self.target)));
        outcome
    }

    fn move_in(&self, names: &BTreeSet<String>) -> io::Result<()> {
        let own = own(&self.target).unwrap_or_default();
        fs::create_dir_all(&self.target)?;
        // From here on the list contains all names, old and new, even after an interruption.
        let list = names.union(&own).cloned().collect();
        write_list(&mut File::create(self.target.join(MARKER))?, &list)?;
        gone(fs::remove_file(self.target.join(SUMMARY)))?;
        let last = [SUMMARY, MARKER];
        for name in names.iter().filter(|name| !last.contains(&name.as_str())) {
            if !own.contains(name) {
                step_aside(&self.target.join(name))?;
            }
            fs::rename(self.partial.join(name), self.target.join(name))?;
        }
        for name in own.difference(names).filter(|name| !last.contains(&name.as_str())) {
            gone(remove(&self.target.join(name)))?;
        }
        for name in last {
            gone(fs::rename(self.partial.join(name), self.target.join(name)))?;
        }
        fs::remove_dir(&self.partial)
    }
}

impl Drop for Results {
    fn drop(&mut self) {
        if self.marker.take().is_some() {
            // Errors cannot be reported here; the next run tries again.
            let _ = fs::remove_dir_all(&self.partial);
        }
    }
}

fn resolved(target: &Path) -> Result<PathBuf, Error> {
    let is_plain = target.file_name().is_some() && !target.is_symlink();
    if is_plain {
        return Ok(target.to_owned());
    }
    target.canonicalize().map_err(Error::new("find directory", target))
}

fn split(target: &Path) -> (PathBuf, String) {
    let parent = target.parent().filter(|parent| !parent.as_os_str().is_empty());
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    (parent.unwrap_or(Path::new(".")).to_owned(), name.into_owned())
}

fn prefix(name: &str, what: &str) -> String {
    format!(".{name}.{what}-")
}

/// Creates `.NAME.partial-PID` with a locked list. The folder gets this name after the list is
/// locked, so that no other run takes it for the folder of a dead run.
fn make(parent: &Path, name: &str) -> io::Result<(PathBuf, File)> {
    for _ in 0..TRIES {
        // Names are never reused, because another run may still be checking an old one.
        let number = BEGUN.fetch_add(1, Ordering::Relaxed);
        let of_kind = |what: &str| parent.join(format!("{}{}-{number}", prefix(name, what), std::process::id()));
        let partial = of_kind("partial");
        // Windows cannot rename a folder that contains an open file.
        let making = if cfg!(windows) { partial.clone() } else { of_kind("making") };
        match fs::create_dir(&making) {
            Ok(()) => {}
            Err(error) if error.kind() == ErrorKind::AlreadyExists => continue,
            Err(error) => return Err(error),
        }
        let marker = File::create_new(making.join(MARKER)).inspect(|file| {
            // Without file locks, dead runs are not recognised and their files stay.
            let _ = file.try_lock();
        });
        let named =
            |marker| if making == partial { Ok(marker) } else { fs::rename(&making, &partial).map(|()| marker) };
        let made = marker.and_then(named);
        match made {
            Ok(marker) => return Ok((partial, marker)),
            Err(error) => {
                let _ = fs::remove_dir_all(&making);
                if !is_in_the_way(&error) {
                    return Err(error);
                }
            }
        }
    }
    Err(ErrorKind::AlreadyExists.into())
}

/// Whether the current directory is the folder or inside it, so that it must not be renamed.
fn is_in_use(target: &Path) -> bool {
    let here = std::env::current_dir().and_then(|here| here.canonicalize());
    here.is_ok_and(|here| target.canonicalize().is_ok_and(|target| here.starts_with(target)))
}

/// Whether files must be moved into an existing folder one by one, because no run created it.
fn check(target: &Path) -> Result<bool, Error> {
    let mut found = BTreeSet::new();
    for _ in 0..TRIES {
        let before = std::mem::replace(
            &mut found,
            match entries(target) {
                // Another run is replacing it.
                Err(error) if error.kind() == ErrorKind::NotFound => return Ok(false),
                found => found.map_err(Error::new("read directory", target))?,
            },
        );
        if found.is_empty() || own(target).is_some() {
            return Ok(false);
        }
        // A folder that is being replaced looks different at the next attempt.
        if found == before {
            break;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    match KNOWN.iter().find(|name| found.contains(**name)) {
        None => Ok(true),
        Some(name) => {
            let stranger = io::Error::new(ErrorKind::AlreadyExists, "no run that was completed made it");
            Err(Error::new("replace", &target.join(name))(stranger))
        }
    }
}

fn entries(dir: &Path) -> io::Result<BTreeSet<String>> {
    let mut names = BTreeSet::new();
    for entry in fs::read_dir(dir)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        let is_under_way = [".partial-", ".making-"].iter().any(|part| name.contains(part));
        if name != MARKER && !(name.starts_with('.') && is_under_way) {
            names.insert(name);
        }
    }
    Ok(names)
}

/// Names of the files that a run created in a folder; `None` if no run created it.
fn own(dir: &Path) -> Option<BTreeSet<String>> {
    if let Ok(list) = fs::read_to_string(dir.join(MARKER)) {
        let names = list.lines().skip(1).filter(|name| !name.contains(['/', '\\']) && !["", ".", ".."].contains(name));
        return Some(names.map(str::to_owned).collect());
    }
    // Results of a version that wrote no list.
    let summary = fs::read_to_string(dir.join(SUMMARY)).ok()?;
    summary.contains("\"trace_hash\"").then(|| KNOWN.map(str::to_owned).into())
}

fn write_list(marker: &mut File, names: &BTreeSet<String>) -> io::Result<()> {
    let mut text = String::from("made by `staya run`, which replaces these files and no others:\n");
    for name in names {
        text.push_str(name);
        text.push('\n');
    }
    marker.write_all(text.as_bytes())
}

fn is_in_the_way(error: &io::Error) -> bool {
    let refused = cfg!(windows) && error.kind() == ErrorKind::PermissionDenied;
    refused || matches!(error.kind(), ErrorKind::DirectoryNotEmpty | ErrorKind::AlreadyExists)
}

fn gone(result: io::Result<()>) -> io::Result<()> {
    result.or_else(|error| if error.kind() == ErrorKind::NotFound { Ok(()) } else { Err(error) })
}

fn remove(path: &Path) -> io::Result<()> {
    let is_folder = fs::symlink_metadata(path)?.is_dir();
    if is_folder { fs::remove_dir_all(path) } else { fs::remove_file(path) }
}

fn step_aside(path: &Path) -> io::Result<()> {
    if fs::symlink_metadata(path).is_ok() { fs::rename(path, free(path)?) } else { Ok(()) }
}

fn free(path: &Path) -> io::Result<PathBuf> {
    for number in 0..10_000 {
        let mut name = path.as_os_str().to_owned();
        name.push(if number == 0 { ".mine".to_owned() } else { format!(".mine-{number}") });
        if fs::symlink_metadata(&name).is_err() {
            return Ok(name.into());
        }
    }
    Err(ErrorKind::AlreadyExists.into())
}

/// Handles the old folder: if a new one exists, moves files that no run created there and removes
/// the rest; otherwise restores the old folder.
fn retire(old: &Path, target: &Path) -> io::Result<()> {
    if !target.is_dir() && fs::rename(old, target).is_ok() {
        return Ok(());
    }
    let own = own(old).unwrap_or_default();
    for name in entries(old)?.difference(&own) {
        let to = target.join(name);
        let to = if fs::symlink_metadata(&to).is_ok() { free(&to)? } else { to };
        gone(fs::rename(old.join(name), to))?;
    }
    for name in &own {
        gone(remove(&old.join(name)))?;
    }
    gone(fs::remove_file(old.join(MARKER)))?;
    fs::remove_dir(old)
}

/// Restores or removes what dead runs into `target` left in `place`; best effort.
fn clear(place: &Path, name: &str, target: &Path) {
    let Ok(found) = fs::read_dir(place) else {
        return;
    };
    for entry in found.flatten() {
        let file_name = entry.file_name().to_string_lossy().into_owned();
        let is_ours = |what: &str| {
            let rest = file_name.strip_prefix(&prefix(name, what));
            rest.is_some_and(|rest| !rest.is_empty() && rest.chars().all(|c| c.is_ascii_digit() || c == '-'))
        };
        if is_ours("old") {
            let _ = retire(&entry.path(), target);
        } else if is_ours("partial") && is_dead(&entry.path()) || is_ours("making") && is_old(&entry.path()) {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

fn is_dead(partial: &Path) -> bool {
    match File::options().read(true).write(true).open(partial.join(MARKER)) {
        Ok(marker) => match marker.try_lock() {
            Ok(()) => true,
            Err(TryLockError::WouldBlock | TryLockError::Error(_)) => false,
        },
        Err(_) => is_old(partial),
    }
}

fn is_old(folder: &Path) -> bool {
    let made = fs::metadata(folder).and_then(|found| found.modified());
    made.is_ok_and(|made| made.elapsed().is_ok_and(|age| age > YOUNG))
}

#[cfg(test)]
mod tests;
