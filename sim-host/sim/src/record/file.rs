//! Errors that name the file and the remedy; directories, the summary and growing tables.

use super::write_atomically;
use crate::file::write_remedy;
use crate::shown::Shown as _;
use serde::Serialize;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file or directory could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot {action} {}: {source}; {remedy}", path.shown())]
pub struct Error {
    action: &'static str,
    path: PathBuf,
    source: io::Error,
    remedy: &'static str,
}

impl Error {
    /// Converts a system error: `action` on `path` failed.
    pub fn new(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| {
            let remedy = write_remedy(&source);
            Self { action, path, source, remedy }
        }
    }

    pub(super) fn with_remedy(action: &'static str, path: &Path, source: io::Error, remedy: &'static str) -> Self {
        Self { action, path: path.to_owned(), source, remedy }
    }

    /// The file or directory.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Creates a directory and its parents, if it does not exist.
pub fn make_dir(dir: &Path) -> Result<(), Error> {
    std::fs::create_dir_all(dir).map_err(Error::new("make directory", dir))
}

/// Creates the results directory before the work begins, and checks that it is writable.
///
/// # Errors
/// The directory cannot be created, or no file in it.
pub fn prepare_dir(dir: &Path) -> Result<(), Error> {
    make_dir(dir)?;
    let probe = dir.join(format!(".{}.tmp", std::process::id()));
    let written = std::fs::write(&probe, "?").map_err(Error::new("write to", dir));
    let _ = std::fs::remove_file(&probe);
    written
}

/// Writes `summary.json` to an existing directory, pretty-printed, in field order.
///
/// # Errors
/// The file cannot be written, or `summary` contains a map with keys that are not strings.
pub fn write_summary(dir: &Path, summary: &impl Serialize) -> Result<(), Error> {
    let path = dir.join("summary.json");
    let mut text = serde_json::to_vec_pretty(summary).map_err(|error| Error::new("write", &path)(error.into()))?;
    text.push(b'\n');
    write_atomically(&path, &text)
}

const BLOCK: usize = 1 << 16;

/// A text file that grows by blocks of whole lines.
#[derive(Debug)]
pub struct LineFile {
    file: File,
    path: PathBuf,
    pending: Vec<u8>,
    /// Bytes in the file, which are complete blocks.
    written: u64,
}

impl LineFile {
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

    /// The file must end with a complete block.
    pub fn resume(path: &Path) -> Result<Self, Error> {
        let file = File::options().append(true).open(path).map_err(Error::new("open", path))?;
        let written = file.metadata().map_err(Error::new("read", path))?.len();
        Ok(Self { file, path: path.to_owned(), pending: Vec::new(), written })
    }

    /// Path and length of the file, after writing all buffered bytes.
    pub fn written(&mut self) -> Result<(PathBuf, u64), Error> {
        self.flush()?;
        Ok((self.path.clone(), self.written))
    }

    pub const fn pending(&mut self) -> &mut Vec<u8> {
        &mut self.pending
    }

    pub fn end_block(&mut self) -> Result<(), Error> {
        if self.pending.len() < BLOCK {
            return Ok(());
        }
        self.flush()
    }

    /// Writes the buffer. After an error the file ends with the last complete block.
    pub fn flush(&mut self) -> Result<(), Error> {
        let result = self.file.write_all(&self.pending);
        match result {
            Ok(()) => self.written += self.pending.len() as u64,
            // Best effort: a partial line would mislead readers.
            Err(_) => drop(self.file.set_len(self.written)),
        }
        self.pending.clear();
        result.map_err(Error::new("write", &self.path))
    }
}

impl Drop for LineFile {
    /// Writes the buffer if the run ends early; errors cannot be reported here.
    fn drop(&mut self) {
        let _ = self.flush();
    }
}
