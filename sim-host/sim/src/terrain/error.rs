//! Terrain errors, with place, cause and remedy.

use crate::file::{self, read_remedy};
use crate::record;
use crate::shown::{Shown as _, one_line};
use std::fmt;
use std::path::{Path, PathBuf};

/// Position of an error in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Line, counted from 1.
    Line(usize),
    /// Byte, counted from 0 (binary data has no lines).
    Byte(usize),
    /// The file as a whole.
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

/// Why a terrain could not be loaded, created or saved.
#[derive(Debug, thiserror::Error)]
pub enum TerrainError {
    /// The file cannot be read.
    #[error("{}: {source}; {}", .path.shown(), read_remedy(.source))]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// Cause, as reported by the system.
        source: std::io::Error,
    },
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] record::Error),
    /// The content violates the file format.
    #[error("{}{place}: {}; {}", .path.shown(), one_line(.what), one_line(.remedy))]
    Format {
        /// Path of the file.
        path: PathBuf,
        /// Position in the file.
        place: Place,
        /// Cause of the error.
        what: String,
        /// How to correct it.
        remedy: String,
    },
    /// The file extension is unknown.
    #[error("{}: unknown kind of terrain file; use .map (Moving AI), .asc (ESRI heights) or .yaml with a .pgm (ROS map_server)", .0.shown())]
    UnknownKind(PathBuf),
    /// A size is zero, too large, or does not match the number of cells.
    #[error(
        "a terrain of {width} x {height} cells with {cells} values; each side must be 1..={MAX_SIDE} and the values width * height"
    )]
    Size {
        /// Cells from west to east.
        width: usize,
        /// Cells from south to north.
        height: usize,
        /// Number of given values.
        cells: usize,
    },
    /// A part that is not inside the map.
    #[error(
        "the piece of {width} x {height} cells from ({x}, {y}) leaves the map of {map_width} x {map_height}; choose a smaller piece or another corner"
    )]
    Crop {
        /// Westernmost column of the part.
        x: u16,
        /// Southernmost row of the part.
        y: u16,
        /// Columns of the part.
        width: u16,
        /// Rows of the part.
        height: u16,
        /// Columns of the map.
        map_width: u16,
        /// Rows of the map.
        map_height: u16,
    },
    /// A parameter of a rule or of a generator is invalid.
    #[error("{what}; {remedy}")]
    Parameter {
        /// Cause of the error.
        what: String,
        /// How to correct it.
        remedy: String,
    },
}

/// Largest width and height: cells are addressed by `i16`.
pub const MAX_SIDE: u16 = i16::MAX as u16;

pub(super) fn format_error(
    path: &Path,
    place: Place,
    what: impl Into<String>,
    remedy: impl Into<String>,
) -> TerrainError {
    TerrainError::Format { path: path.to_owned(), place, what: what.into(), remedy: remedy.into() }
}

/// Creates a [`TerrainError::Parameter`].
pub fn parameter_error(what: impl Into<String>, remedy: impl Into<String>) -> TerrainError {
    TerrainError::Parameter { what: what.into(), remedy: remedy.into() }
}

/// Refuses a map that does not fit into memory; `cell_bytes` is needed per cell while it is read.
pub fn fits(path: &Path, width: u16, height: u16, cell_bytes: u64) -> Result<(), TerrainError> {
    let bytes = u64::from(width) * u64::from(height) * cell_bytes;
    if file::has_memory(bytes) {
        return Ok(());
    }
    let what = format!("{width} x {height} cells need {} MB of memory, which is not to be had", bytes >> 20);
    Err(format_error(path, Place::File, what, "cut a piece out of the map, or close other programs"))
}

/// Reads a whole file.
pub fn read(path: &Path) -> Result<Vec<u8>, TerrainError> {
    file::read(path, file::MAP).map_err(|source| TerrainError::Read { path: path.to_owned(), source })
}
