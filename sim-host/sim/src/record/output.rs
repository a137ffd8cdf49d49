//! Outputs of a command: none replaces an input or another output, and each takes its place only
//! when it is complete.

use super::Error;
use crate::shown::Shown as _;
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

const TRIES: usize = 32;
/// Links that lead to links; more are a circle.
const LINKS: usize = 40;

static CREATED: AtomicU32 = AtomicU32::new(0);

/// The files that a command reads and writes.
#[derive(Debug, Default)]
pub struct Files {
    known: Vec<Known>,
}

#[derive(Debug)]
struct Known {
    path: PathBuf,
    identity: Identity,
    is_output: bool,
}

/// Equal for two names of one file, also through links.
#[derive(Debug, PartialEq, Eq)]
enum Identity {
    /// Device and number of an existing file.
    #[cfg(unix)]
    Existing(u64, u64),
    /// Absolute path without links.
    Path(PathBuf),
}

impl Files {
    /// Creates the list of a command that reads `inputs`.
    #[must_use]
    pub fn reading<P: AsRef<Path>>(inputs: impl IntoIterator<Item = P>) -> Self {
        let mut this = Self::default();
        inputs.into_iter().for_each(|path| this.reads(path.as_ref()));
        this
    }

    /// Adds an input. An output that already has its path stays.
    pub fn reads(&mut self, path: &Path) {
        let path = path.to_owned();
        let identity = identity(&resolved(&path));
        self.known.push(Known { path, identity, is_output: false });
    }

    /// Reserves `path` for an output, a file or a folder. Devices and pipes can be used repeatedly.
    ///
    /// # Errors
    /// The path is an input or another output, also by another name or a link.
    pub fn claim(&mut self, path: &Path) -> Result<(), Error> {
        let target = resolved(path);
        if is_special(&target) {
            return Ok(());
        }
        let identity = identity(&target);
        if let Some(other) = self.known.iter().find(|known| known.identity == identity) {
            let (kind, other) = (if other.is_output { "another output" } else { "an input" }, other.path.shown());
            let source = io::Error::new(ErrorKind::AlreadyExists, format!("it is also {kind} ({other})"));
            return Err(Error::with_remedy("write", path, source, "choose another name"));
        }
        self.known.push(Known { path: path.to_owned(), identity, is_output: true });
        Ok(())
    }

    /// Reserves `path`, creates its output, and removes what dead processes left beside it.
    ///
    /// # Errors
    /// See [`Files::claim`] and [`Output::create`].
    pub fn create(&mut self, path: &Path) -> Result<Output, Error> {
        self.claim(path)?;
        remove_stale(path);
        Output::create(path)
    }
}

/// Readers of a new file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Those of the system's settings, or of the file that it replaces.
    Usual,
    /// Only its owner.
    Private,
}

/// A file that is written as `NAME.PROCESS-NUMBER.tmp` beside its path, and takes the place of that
/// path in [`finish`](Output::finish). If it is dropped before, the path is unchanged. A device or
/// pipe is written at once.
#[derive(Debug)]
pub struct Output {
    file: File,
    /// As the user named it, for errors.
    path: PathBuf,
    /// Without links, so that a link stays.
    target: PathBuf,
    temporary: Option<PathBuf>,
}

impl Output {
    /// Creates the file beside `path`.
    ///
    /// # Errors
    /// It cannot be created, or `path` is a folder.
    pub fn create(path: &Path) -> Result<Self, Error> {
        Self::with(path, Access::Usual)
    }

    /// Like [`create`](Self::create), with the given access.
    ///
    /// # Errors
    /// See [`create`](Self::create).
    pub fn with(path: &Path, access: Access) -> Result<Self, Error> {
        let target = resolved(path);
        let made = if is_special(&target) {
            OpenOptions::new().write(true).open(&target).map(|file| (file, None))
        } else if target.is_dir() || target.file_name().is_none() {
            Err(ErrorKind::IsADirectory.into())
        } else {
            temporary(&target, access).map(|(file, temporary)| (file, Some(temporary)))
        };
        let (file, temporary) = made.map_err(Error::new("write", path))?;
        Ok(Self { file, path: path.to_owned(), target, temporary })
    }

    /// The name given at the creation.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Puts the complete file in its place.
    ///
    /// # Errors
    /// The system does not allow it. The path is then unchanged.
    pub fn finish(self) -> Result<(), Error> {
        self.place(|temporary, target| fs::rename(temporary, target))
    }

    /// Writes the file to the disk and calls `place` with the temporary file and the path.
    ///
    /// # Errors
    /// The disk is full, or `place` fails. The path is then as `place` left it.
    pub fn finish_by(self, place: impl FnOnce(&Path, &Path) -> io::Result<()>) -> Result<(), Error> {
        self.file.sync_all().map_err(Error::new("write", &self.path))?;
        self.place(place)
    }

    fn place(mut self, place: impl FnOnce(&Path, &Path) -> io::Result<()>) -> Result<(), Error> {
        if let Some(temporary) = &self.temporary {
            place(temporary, &self.target).map_err(Error::new("write", &self.path))?;
        }
        self.temporary = None;
        Ok(())
    }

    /// Leaves an incomplete file beside its path, until the next output of that path begins.
    /// Returns its name.
    #[must_use]
    pub fn keep(mut self) -> PathBuf {
        self.temporary.take().unwrap_or_else(|| self.path.clone())
    }

    /// Shortens the file to `length` bytes, if possible.
    pub fn cut(&mut self, length: u64) {
        let _ = self.file.set_len(length).and_then(|()| self.file.seek(SeekFrom::End(0)));
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for Output {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        if let Some(temporary) = &self.temporary {
            // Errors cannot be reported here; the next output of that path tries again.
            let _ = fs::remove_file(temporary);
        }
    }
}

/// Writes a whole file by way of an [`Output`].
///
/// # Errors
/// It cannot be written; the old file then stays.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let mut output = Output::create(path)?;
    output.write_all(bytes).map_err(Error::new("write", path))?;
    output.finish()
}

/// Removes the temporary files of `path` that no living process holds; best effort.
pub fn remove_stale(path: &Path) {
    let target = resolved(path);
    let (folder, name) = (folder(&target), target.file_name().unwrap_or_default().to_string_lossy().into_owned());
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let file_name = entry.file_name();
        let number = file_name.to_str().and_then(|other| other.strip_prefix(&name)?.strip_prefix('.'));
        let number = number.and_then(|rest| rest.strip_suffix(".tmp"));
        let is_ours = number.is_some_and(|number| {
            number.starts_with(|c: char| c.is_ascii_digit()) && number.chars().all(|c| c.is_ascii_digit() || c == '-')
        });
        // A living process has locked its file.
        if is_ours && File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok()) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Creates a locked temporary file. Another process may remove it before it is locked, so its name
/// is checked afterwards.
fn temporary(target: &Path, access: Access) -> io::Result<(File, PathBuf)> {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    if access == Access::Private {
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    }
    for _ in 0..TRIES {
        let mut name = OsString::from(target.file_name().unwrap_or_default());
        let number = CREATED.fetch_add(1, Ordering::Relaxed);
        name.push(format!(".{}-{number}.tmp", std::process::id()));
        let temporary = target.with_file_name(name);
        let file = match options.open(&temporary) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => continue,
            file => file?,
        };
        // Without file locks, the files of dead processes stay.
        let _ = file.try_lock();
        if !temporary.exists() {
            continue;
        }
        if access == Access::Usual
            && let Ok(old) = fs::metadata(target)
        {
            let _ = file.set_permissions(old.permissions());
        }
        return Ok((file, temporary));
    }
    Err(ErrorKind::AlreadyExists.into())
}

/// The path behind a link, also if there is no file yet.
fn resolved(path: &Path) -> PathBuf {
    let mut path = path.to_owned();
    for _ in 0..LINKS {
        match fs::read_link(&path) {
            Ok(to) => path = folder(&path).join(to),
            Err(_) => break,
        }
    }
    path
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn is_special(target: &Path) -> bool {
    fs::metadata(target).is_ok_and(|found| !found.is_file() && !found.is_dir())
}

fn identity(target: &Path) -> Identity {
    #[cfg(unix)]
    if let Ok(found) = fs::metadata(target) {
        use std::os::unix::fs::MetadataExt as _;
        return Identity::Existing(found.dev(), found.ino());
    }
    let whole = target
        .canonicalize()
        .or_else(|_| folder(target).canonicalize().map(|folder| folder.join(target.file_name().unwrap_or_default())));
    Identity::Path(whole.unwrap_or_else(|_| target.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder)
            .expect("a folder")
            .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_path_is_claimed_once_by_whatever_name() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        fs::write(at("input"), "in").expect("room");
        fs::hard_link(at("input"), at("hard")).expect("links");
        fs::create_dir(at("sub")).expect("room");
        let mut others = vec![at("input"), at("hard"), at("sub/../input"), at("./input")];
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("input", at("soft")).expect("links");
            std::os::unix::fs::symlink("soft", at("softer")).expect("links");
            std::os::unix::fs::symlink("new", at("early")).expect("links");
            others.extend([at("soft"), at("softer")]);
        }
        let mut files = Files::reading([at("input")]);
        for path in &others {
            let error = files.create(path).expect_err("an input").to_string();
            assert!(error.contains("it is also an input") && error.ends_with("; choose another name"), "{error}");
        }
        files.claim(&at("new")).expect("free");
        let again = [
            at("new"),
            at("sub/../new"),
            #[cfg(unix)]
            at("early"),
        ];
        for path in &again {
            let error = files.claim(path).expect_err("an output").to_string();
            assert!(error.contains("it is also another output"), "{error}");
        }
        files.claim(&at("other")).expect("free");
        assert_eq!(fs::read(at("input")).expect("a file"), b"in");
    }

    #[test]
    fn an_output_takes_its_place_when_it_is_complete() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        fs::write(&path, "old").expect("room");
        let mut output = Output::create(&path).expect("a file");
        output.write_all(b"new").expect("room");
        assert_eq!((fs::read(&path).expect("the old one"), names(folder.path()).len()), (b"old".to_vec(), 2));
        drop(output);
        assert_eq!(names(folder.path()), ["a"]);
        let mut output = Output::create(&path).expect("a file");
        output.write_all(b"new").expect("room");
        output.finish().expect("its place");
        assert_eq!((fs::read(&path).expect("the new one"), names(folder.path())), (b"new".to_vec(), vec!["a".into()]));
        let kept = Output::create(&path).expect("a file").keep();
        assert!(kept.exists() && Output::create(folder.path()).is_err() && Output::create(&path.join("b")).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_stay() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().expect("a folder");
        let (path, link) = (folder.path().join("a"), folder.path().join("b"));
        let mode = |path: &Path| fs::metadata(path).expect("a file").permissions().mode() & 0o777;
        Output::with(&path, Access::Private).expect("a file").finish().expect("its place");
        assert_eq!(mode(&path), 0o600);
        std::os::unix::fs::symlink("a", &link).expect("links");
        write_atomically(&link, b"c").expect("room");
        assert!(link.is_symlink() && fs::read(&path).expect("a file") == b"c");
        assert_eq!(mode(&path), 0o600);
    }

    #[test]
    fn files_of_dead_processes_are_removed() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        for name in ["a.12.tmp", "a.12-3.tmp", "a.tmp", "a.x.tmp", "a.-.tmp", "b.1.tmp", "a.1"] {
            fs::write(folder.path().join(name), "").expect("room");
        }
        let living = Output::create(&path).expect("a file");
        let next = Files::default().create(&path).expect("a file");
        let left = names(folder.path());
        assert_eq!(left.len(), 7, "{left:?}");
        assert!(["a.tmp", "a.x.tmp", "a.-.tmp", "b.1.tmp", "a.1"].iter().all(|name| left.iter().any(|l| l == name)));
        drop((living, next));
        assert_eq!(names(folder.path()).len(), 5);
    }
}
