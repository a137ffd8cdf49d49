//! Files that are whole or not there at all, and errors that say which one and what to do.

use serde::Serialize;
use std::fs::File;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// A file or directory that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot {action} {}: {source}; {}", path.display(), remedy(source))]
pub struct Error {
    action: &'static str,
    path: PathBuf,
    source: io::Error,
}

impl Error {
    pub(crate) fn new(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self {
            action,
            path,
            source,
        }
    }

    /// The file or directory.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

fn remedy(source: &io::Error) -> &'static str {
    match source.kind() {
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "choose an output directory that you may write to"
        }
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            "free some space or choose an output directory on another disk"
        }
        ErrorKind::NotADirectory | ErrorKind::AlreadyExists | ErrorKind::IsADirectory => {
            "a file or directory of that name is in the way: remove it or choose another output directory"
        }
        _ => "choose another output directory",
    }
}

/// Makes a directory and its parents; one that exists is fine.
pub fn make_dir(dir: &Path) -> Result<(), Error> {
    std::fs::create_dir_all(dir).map_err(Error::new("make directory", dir))
}

/// Writes a file so that readers see the old one or the whole new one, never a part: a temporary
/// file beside it, then a rename.
///
/// # Errors
/// The temporary file cannot be written or renamed; it is removed then, the old file stays.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.tmp", std::process::id()));
    let temporary = path.with_file_name(name);
    std::fs::write(&temporary, bytes)
        .and_then(|()| std::fs::rename(&temporary, path))
        .map_err(|source| {
            // The error that matters is the first one.
            let _ = std::fs::remove_file(&temporary);
            Error::new("write", path)(source)
        })
}

/// Writes `summary.json` into a directory that exists, pretty-printed, in field order.
///
/// # Errors
/// The file cannot be written, or `summary` has a map whose keys are no strings.
pub fn write_summary(dir: &Path, summary: &impl Serialize) -> Result<(), Error> {
    let path = dir.join("summary.json");
    let mut text = serde_json::to_vec_pretty(summary)
        .map_err(|error| Error::new("write", &path)(error.into()))?;
    text.push(b'\n');
    write_atomically(&path, &text)
}

/// Bytes that gather in memory before they go to the file.
const BLOCK: usize = 1 << 16;

/// A text file that grows by blocks of whole lines.
#[derive(Debug)]
pub struct LineFile {
    file: File,
    path: PathBuf,
    pending: Vec<u8>,
    /// Bytes in the file that are known to be whole blocks.
    written: u64,
}

impl LineFile {
    /// Makes the file, empty but for `header`.
    pub fn create(path: &Path, header: &str) -> Result<Self, Error> {
        let mut this = Self {
            file: File::create(path).map_err(Error::new("make", path))?,
            path: path.to_owned(),
            pending: header.into(),
            written: 0,
        };
        this.flush()?;
        Ok(this)
    }

    /// Where to append; the block is complete at the next [`LineFile::end_block`].
    pub const fn pending(&mut self) -> &mut Vec<u8> {
        &mut self.pending
    }

    /// Marks the end of a block; writes when enough has gathered.
    pub fn end_block(&mut self) -> Result<(), Error> {
        if self.pending.len() < BLOCK {
            return Ok(());
        }
        self.flush()
    }

    /// Writes what has gathered. After an error the file ends with the last whole block.
    pub fn flush(&mut self) -> Result<(), Error> {
        let result = self.file.write_all(&self.pending);
        match result {
            Ok(()) => self.written += self.pending.len() as u64,
            // Best effort: what was cut in the middle would mislead a reader.
            Err(_) => drop(self.file.set_len(self.written)),
        }
        self.pending.clear();
        result.map_err(Error::new("write", &self.path))
    }
}

impl Drop for LineFile {
    /// A run that ends early keeps what it had; nobody is left to hear of an error.
    fn drop(&mut self) {
        let _ = self.flush();
    }
}
