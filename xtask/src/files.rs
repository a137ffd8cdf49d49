//! Files, with errors that name them.

use anyhow::{Context as _, Result};
use std::fs;
use std::path::{Path, PathBuf};

/// A text file.
pub fn read(path: &Path) -> Result<String> {
    fs::read_to_string(path).with_context(|| path.display().to_string())
}

/// A file of bytes.
pub fn bytes(path: &Path) -> Result<Vec<u8>> {
    fs::read(path).with_context(|| path.display().to_string())
}

/// Writes a file, and makes the folder that it is in.
pub fn write(path: &Path, text: impl AsRef<[u8]>) -> Result<()> {
    make(path.parent().unwrap_or(path))?;
    fs::write(path, text).with_context(|| path.display().to_string())
}

/// Writes a file unless it has these bytes, so that cargo builds only the difference.
pub fn update(path: &Path, wanted: &[u8]) -> Result<()> {
    if bytes(path).is_ok_and(|bytes| bytes == wanted) { Ok(()) } else { write(path, wanted) }
}

/// Makes a folder.
pub fn make(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).with_context(|| folder.display().to_string())
}

/// Removes a folder with all that is in it, or a file.
pub fn remove(path: &Path) -> Result<()> {
    let removed = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    if path.exists() { removed.with_context(|| path.display().to_string()) } else { Ok(()) }
}

/// Makes a folder that is empty.
pub fn make_empty(folder: &Path) -> Result<()> {
    remove(folder)?;
    make(folder)
}

/// Copies a file, and makes the folder that it goes to. A program that runs cannot be written to,
/// but another one can take its name.
pub fn copy(from: &Path, to: &Path) -> Result<()> {
    make(to.parent().unwrap_or(to))?;
    let beside = to.with_extension("new");
    fs::copy(from, &beside).with_context(|| from.display().to_string())?;
    fs::rename(&beside, to).with_context(|| to.display().to_string())
}

/// The contents of a folder, sorted.
pub fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder).and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect());
    let mut entries: Vec<PathBuf> = entries.with_context(|| folder.display().to_string())?;
    entries.sort();
    Ok(entries)
}

/// All files below a folder that `is_wanted` takes, sorted; folders that it does not take are left
/// out whole.
pub fn below(folder: &Path, is_wanted: &impl Fn(&Path) -> bool) -> Result<Vec<PathBuf>> {
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
pub fn sources(folder: &Path, extensions: &[&str]) -> Result<Vec<PathBuf>> {
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
