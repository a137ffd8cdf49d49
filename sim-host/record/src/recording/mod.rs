//! A run in a file: the scene, every frame, the orders and the summary, in blocks that are packed and checked one by
//! one
//! (`PROTOCOL.md`, Recordings). [`Writer`] makes one while a run goes on, [`Reader`] finds any moment of it without
//! reading it all into memory.

mod read;
mod run;
mod write;

pub use read::{Reader, Span};
pub use run::RunRecorder;
pub use write::{Sink, Writer};

use std::io;
use std::path::{Path, PathBuf};

/// What recordings begin with.
pub const MAGIC: [u8; 8] = *b"STAYAREC";
/// Of the format.
pub const VERSION: u32 = 1;
/// Bytes of magic and version.
const FILE_HEAD: u64 = 12;
/// Bytes in front of each block's packed bytes.
const BLOCK_HEAD: usize = 13;
/// Raw bytes that a block has at most.
pub const MOST_RAW: u32 = 1 << 30;
/// DEFLATE makes nothing smaller than by this factor (1032, and a little for its own head).
const MOST_PACKED_BY: u64 = 1040;

const SCENE: u8 = 1;
const FRAMES: u8 = 2;
const ORDERS: u8 = 3;
const END: u8 = 4;

/// A recording that cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The system refuses.
    #[error("cannot {action} {}: {source}; {remedy}", path.display())]
    Io {
        /// What failed.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
        /// What helps.
        remedy: &'static str,
    },
    /// It is something else, or damaged.
    #[error("{}: byte {at}: {what}; {remedy}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Where.
        at: u64,
        /// What is wrong.
        what: String,
        /// What helps.
        remedy: &'static str,
    },
}

impl RecordingError {
    /// What turns an error of the system into this one: `path` could not be written.
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
        let remedy = "make the recording anew";
        Self::Format { path: path.to_owned(), at, what: what.into(), remedy }
    }
}

#[cfg(test)]
mod tests;
