//! A run in a file: the scene, all frames, the orders and the summary, in compressed and checked
//! blocks (`PROTOCOL.md`, Recordings). [`Writer`] creates a recording during a run; [`Reader`]
//! finds any moment without loading the whole file.

mod read;
mod run;
mod write;

pub use read::{Reader, Span};
pub use run::RunRecorder;
pub use write::{Sink, Writer};

use staya_sim::shown::Shown as _;
use std::io;
use std::path::{Path, PathBuf};

/// First bytes of a recording.
pub const MAGIC: [u8; 8] = *b"STAYAREC";
/// Version of the format.
pub const VERSION: u32 = 1;
/// Magic number and version.
const FILE_HEAD: u64 = 12;
const BLOCK_HEAD: usize = 13;
/// Largest uncompressed size of a block, bytes: a frame of a million robots has at most 42 MB, a
/// map of 10,000 by 10,000 cells has 133 MB.
pub const MOST_RAW: u32 = 1 << 28;
/// DEFLATE's largest compression ratio (1032), with a margin for its header.
const MOST_PACKED_BY: u64 = 1040;

const SCENE: u8 = 1;
const FRAMES: u8 = 2;
const ORDERS: u8 = 3;
const END: u8 = 4;
const MINDS: u8 = 5;

/// Why a recording cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// Error of the operating system.
    #[error("cannot {action} {}: {source}; {remedy}", path.shown())]
    Io {
        /// The action that failed.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Cause.
        source: io::Error,
        /// Remedy for the user.
        remedy: &'static str,
    },
    /// The file is not a recording, or is damaged.
    #[error("{}: byte {at}: {what}; {remedy}", path.shown())]
    Format {
        /// The file.
        path: PathBuf,
        /// Byte offset in the file.
        at: u64,
        /// The problem.
        what: String,
        /// Remedy for the user.
        remedy: &'static str,
    },
}

impl RecordingError {
    /// Converts an error of the system that occurred while `path` was written.
    pub fn writing(path: &Path) -> impl Fn(io::Error) -> Self {
        move |source| {
            let remedy = staya_sim::file::write_remedy(&source);
            Self::Io { action: "write", path: path.to_owned(), source, remedy }
        }
    }

    fn reading(path: &Path) -> impl Fn(io::Error) -> Self {
        move |source| {
            let remedy = staya_sim::file::read_remedy(&source);
            Self::Io { action: "read", path: path.to_owned(), source, remedy }
        }
    }

    fn damage(path: &Path, at: u64, what: impl Into<String>) -> Self {
        let remedy = "make the recording again";
        Self::Format { path: path.to_owned(), at, what: what.into(), remedy }
    }
}

#[cfg(test)]
mod tests;
