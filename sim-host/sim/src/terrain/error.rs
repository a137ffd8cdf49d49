//! What can be wrong with terrain, reported so that a person can fix it.

use crate::file::{self, read_remedy, write_remedy};
use std::fmt;
use std::path::{Path, PathBuf};

/// Where in a file something is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// In a line, counted from 1.
    Line(usize),
    /// At a byte, counted from 0 (binary data has no lines).
    Byte(usize),
    /// In the file as a whole.
    File,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, ":{line}"),
            Self::Byte(byte) => write!(f, ", byte {byte}"),
            Self::File => Ok(()),
        }
    }
}

/// Why there is no terrain.
#[derive(Debug, thiserror::Error)]
pub enum TerrainError {
    /// The file cannot be read.
    #[error("{}: {source}; {}", .path.display(), read_remedy(.source))]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file cannot be written.
    #[error("cannot write {}: {source}; {}", .path.display(), write_remedy(.source))]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file does not say what its format asks for.
    #[error("{}{place}: {what}; {remedy}", .path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Where in the file.
        place: Place,
        /// What is wrong.
        what: String,
        /// What to do about it.
        remedy: String,
    },
    /// No reader knows the extension.
    #[error("{}: unknown kind of terrain file; use .map (Moving AI), .asc (ESRI heights) or .yaml with a .pgm (ROS map_server)", .0.display())]
    UnknownKind(PathBuf),
    /// A size that is zero, too large, or does not fit the number of cells.
    #[error(
        "a terrain of {width} x {height} cells with {cells} values; each side must be 1..={MAX_SIDE} and the values width * height"
    )]
    Size {
        /// Cells from west to east.
        width: usize,
        /// Cells from south to north.
        height: usize,
        /// Values given.
        cells: usize,
    },
    /// A piece that does not lie inside the map.
    #[error(
        "the piece of {width} x {height} cells from ({x}, {y}) leaves the map of {map_width} x {map_height}; choose a smaller piece or another corner"
    )]
    Crop {
        /// Westernmost column of the piece.
        x: u16,
        /// Southernmost row of the piece.
        y: u16,
        /// Columns of the piece.
        width: u16,
        /// Rows of the piece.
        height: u16,
        /// Columns of the map.
        map_width: u16,
        /// Rows of the map.
        map_height: u16,
    },
    /// A parameter of a rule or of a generator that makes no sense.
    #[error("{what}; {remedy}")]
    Parameter {
        /// What is wrong.
        what: String,
        /// What to do about it.
        remedy: String,
    },
}

/// Largest width and height: cells are addressed by `i16`.
pub const MAX_SIDE: u16 = i16::MAX as u16;

/// A [`TerrainError::Format`].
pub(super) fn format_error(
    path: &Path,
    place: Place,
    what: impl Into<String>,
    remedy: impl Into<String>,
) -> TerrainError {
    TerrainError::Format { path: path.to_owned(), place, what: what.into(), remedy: remedy.into() }
}

/// A [`TerrainError::Parameter`].
pub fn parameter_error(what: impl Into<String>, remedy: impl Into<String>) -> TerrainError {
    TerrainError::Parameter { what: what.into(), remedy: remedy.into() }
}

/// Refuses a map whose cells, of so many bytes each while it is read, would not fit into memory.
pub fn fits(path: &Path, width: u16, height: u16, cell_bytes: u64) -> Result<(), TerrainError> {
    let bytes = u64::from(width) * u64::from(height) * cell_bytes;
    if file::has_memory(bytes) {
        return Ok(());
    }
    let what = format!("{width} x {height} cells need {} MB of memory, which is not to be had", bytes >> 20);
    Err(format_error(path, Place::File, what, "cut a piece out of the map, or close other programs"))
}

/// The bytes of a file.
pub fn read(path: &Path) -> Result<Vec<u8>, TerrainError> {
    file::read(path, file::MAP).map_err(|source| TerrainError::Read { path: path.to_owned(), source })
}

/// Writes a file.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), TerrainError> {
    std::fs::write(path, bytes).map_err(|source| TerrainError::Write { path: path.to_owned(), source })
}
