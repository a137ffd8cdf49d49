//! Files, with errors that name them.

use std::fs;
use std::path::{Path, PathBuf};

fn named<T>(path: &Path, result: std::io::Result<T>) -> Result<T, String> {
    result.map_err(|error| format!("{}: {error}", path.display()))
}

/// A text file.
pub fn read(path: &Path) -> Result<String, String> {
    named(path, fs::read_to_string(path))
}

/// A file of bytes.
pub fn bytes(path: &Path) -> Result<Vec<u8>, String> {
    named(path, fs::read(path))
}

/// Writes a file, and makes the folder that it is in.
pub fn write(path: &Path, text: impl AsRef<[u8]>) -> Result<(), String> {
    make(path.parent().unwrap_or(path))?;
    named(path, fs::write(path, text))
}

/// Makes a folder.
pub fn make(folder: &Path) -> Result<(), String> {
    named(folder, fs::create_dir_all(folder))
}

/// Removes a folder with all that is in it.
pub fn remove(folder: &Path) -> Result<(), String> {
    if folder.exists() { named(folder, fs::remove_dir_all(folder)) } else { Ok(()) }
}

/// Makes a folder that is empty.
pub fn make_empty(folder: &Path) -> Result<(), String> {
    remove(folder)?;
    make(folder)
}

/// Copies a file, and makes the folder that it goes to. A program that runs cannot be written to,
/// but another one can take its name.
pub fn copy(from: &Path, to: &Path) -> Result<(), String> {
    make(to.parent().unwrap_or(to))?;
    let beside = to.with_extension("new");
    named(from, fs::copy(from, &beside))?;
    named(to, fs::rename(&beside, to))
}

/// The contents of a folder, sorted.
pub fn entries(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let entries = fs::read_dir(folder).and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect());
    let mut entries: Vec<PathBuf> = named(folder, entries)?;
    entries.sort();
    Ok(entries)
}

/// All files below a folder that `is_wanted` takes, sorted; folders that it does not take are left
/// out whole.
pub fn below(folder: &Path, is_wanted: &impl Fn(&Path) -> bool) -> Result<Vec<PathBuf>, String> {
    let mut files = Vec::new();
    for path in entries(folder)?.into_iter().filter(|path| is_wanted(path)) {
        if path.is_dir() {
            files.extend(below(&path, is_wanted)?);
        } else {
            files.push(path);
        }
    }
    Ok(files)
}

/// The files below a folder with one of these extensions, except hidden folders and output.
pub fn sources(folder: &Path, extensions: &[&str]) -> Result<Vec<PathBuf>, String> {
    below(folder, &|path| if path.is_dir() { !is_made(path) } else { has_extension(path, extensions) })
}

/// Whether a folder is hidden, or holds only output of builds and runs.
pub fn is_made(folder: &Path) -> bool {
    let name = name(folder);
    name.starts_with('.') || ["target", "out"].contains(&name.as_str())
}

/// Whether the path has one of these extensions.
pub fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    path.extension().is_some_and(|own| extensions.iter().any(|extension| own == *extension))
}

/// The last part of a path.
pub fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The last part of a path without its extension.
pub fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
