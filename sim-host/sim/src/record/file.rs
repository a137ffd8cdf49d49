//! Files that are whole or not there at all, and errors that say which one and what to do.

use crate::file::write_remedy;
use serde::Serialize;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file or directory that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot {action} {}: {source}; {}", path.display(), write_remedy(source))]
pub struct Error {
    action: &'static str,
    path: PathBuf,
    source: io::Error,
}

impl Error {
    /// What turns an error of the system into this one: `action` on `path` failed.
    pub fn new(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self { action, path, source }
    }

    /// The file or directory.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Makes a directory and its parents; one that exists is fine.
pub fn make_dir(dir: &Path) -> Result<(), Error> {
    std::fs::create_dir_all(dir).map_err(Error::new("make directory", dir))
}

/// Makes the directory of results before the work for them begins, and finds out whether files can be
/// written to it.
///
/// # Errors
/// The directory cannot be made, or no file in it.
pub fn prepare_dir(dir: &Path) -> Result<(), Error> {
    make_dir(dir)?;
    let probe = dir.join(format!(".{}.tmp", std::process::id()));
    let written = std::fs::write(&probe, "?").map_err(Error::new("write to", dir));
    // It may not have come into being.
    let _ = std::fs::remove_file(&probe);
    written
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
    std::fs::write(&temporary, bytes).and_then(|()| std::fs::rename(&temporary, path)).map_err(|source| {
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
    let mut text = serde_json::to_vec_pretty(summary).map_err(|error| Error::new("write", &path)(error.into()))?;
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

    /// Goes on with a file that ends with a whole block.
    pub fn resume(path: &Path) -> Result<Self, Error> {
        let file = File::options().append(true).open(path).map_err(Error::new("open", path))?;
        let written = file.metadata().map_err(Error::new("read", path))?.len();
        Ok(Self { file, path: path.to_owned(), pending: Vec::new(), written })
    }

    /// The file, and its bytes once all that has gathered is written.
    pub fn written(&mut self) -> Result<(PathBuf, u64), Error> {
        self.flush()?;
        Ok((self.path.clone(), self.written))
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
