//! Errors of files that cannot be read or written, with the remedy.

use std::io::{Error, ErrorKind};

/// What helps when a file cannot be read.
pub fn read_remedy(error: &Error) -> &'static str {
    match error.kind() {
        ErrorKind::NotFound => "check the name",
        ErrorKind::IsADirectory => "name a file, not a directory",
        ErrorKind::PermissionDenied => "choose a file that you may read",
        // What `read_to_string` says of other bytes.
        ErrorKind::InvalidData => "is it another kind of file, or damaged?",
        _ => "choose another file",
    }
}

/// What helps when a file or directory cannot be written.
pub fn write_remedy(error: &Error) -> &'static str {
    match error.kind() {
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "choose an output directory that you may write to"
        }
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            "free some space or choose an output directory on another disk"
        }
        ErrorKind::NotADirectory | ErrorKind::AlreadyExists | ErrorKind::IsADirectory => {
            "a file or directory of that name is in the way: remove it or choose another output directory"
        }
        ErrorKind::NotFound => "make its directory first, or choose another output directory",
        _ => "choose another output directory",
    }
}
