//! Files with the secret key of a swarm: one line, besides empty lines and lines that begin with
//! `#`. The line is the key as 64 hexadecimal digits, or `passphrase: WORDS`; then the SHA-256 of
//! the trimmed words is the key, as in MAVProxy and Mission Planner.
//!
//! ```text
//! # openssl rand -hex 32 > swarm.key && chmod 600 swarm.key
//! 3d6b...
//! ```

use crate::file::{self, read_remedy};
use crate::shown::Shown as _;
use staya_controller::auth::{KEY_LEN, Key};
use staya_mavlink::signing::EPOCH_UNIX_S;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};
use thiserror::Error;

/// Largest size of a key file in bytes, comments included.
const LONGEST: u64 = 1 << 16;
const WANTED: &str =
    "write one line into it: 64 hexadecimal digits (openssl rand -hex 32), or \"passphrase: \" and words";

/// Why a key file was refused. The error never contains the file's content.
#[derive(Debug, Error)]
pub enum KeyError {
    /// The file cannot be read.
    #[error("cannot read the key file {}: {error}; {}", path.shown(), read_remedy(error))]
    Unreadable {
        /// Path of the file.
        path: PathBuf,
        /// Cause, as reported by the system.
        error: std::io::Error,
    },
    /// The file does not contain a key.
    #[error("{}, line {line}: {problem}; {WANTED}", path.shown())]
    NoKey {
        /// Path of the file.
        path: PathBuf,
        /// Line, counted from 1.
        line: usize,
        /// Cause of the error.
        problem: String,
    },
}

/// A key, with a warning about its file.
#[derive(Clone, Debug)]
pub struct KeyFile {
    /// The secret key.
    pub key: Key,
    /// Warning for the user, with a remedy, if others than the owner can read the file.
    pub remark: Option<String>,
}

impl KeyFile {
    /// Reads a key file.
    ///
    /// # Errors
    /// See [`KeyError`].
    pub fn read(path: &Path) -> Result<Self, KeyError> {
        let text =
            file::read_text(path, LONGEST).map_err(|error| KeyError::Unreadable { path: path.to_path_buf(), error })?;
        let key =
            parse(&text).map_err(|(line, problem)| KeyError::NoKey { path: path.to_path_buf(), line, problem })?;
        let remark = is_open(path).then(|| {
            let path = path.shown();
            format!("{path} can be read by others than its owner: chmod 600 {path}")
        });
        Ok(Self { key, remark })
    }
}

/// Parses the content of a key file.
///
/// # Errors
/// The line, counted from 1, and the cause, without any part of the secret.
pub fn parse(text: &str) -> Result<Key, (usize, String)> {
    let lines = text.lines().map(str::trim).zip(1..);
    let mut lines = lines.filter(|(line, _)| !line.is_empty() && !line.starts_with('#'));
    let (line, number) = lines.next().ok_or((1, "there is no key".to_string()))?;
    if let Some((_, second)) = lines.next() {
        return Err((second, "there is a second key".to_string()));
    }
    match line.strip_prefix("passphrase:") {
        Some(words) if words.trim().is_empty() => Err((number, "the passphrase is empty".into())),
        Some(words) => Ok(Key::of_passphrase(words.trim().as_bytes())),
        None => digits(line).map_err(|problem| (number, problem)),
    }
}

fn digits(line: &str) -> Result<Key, String> {
    let mut bytes = [0; KEY_LEN];
    let mut count = 0;
    for (column, letter) in (1..).zip(line.chars()) {
        let Some(digit) = letter.to_digit(16) else {
            return Err(format!("column {column} is not a hexadecimal digit"));
        };
        if let Some(byte) = bytes.get_mut(count / 2) {
            *byte = *byte << 4 | digit as u8;
        }
        count += 1;
    }
    match count {
        64 => Ok(Key::new(bytes)),
        _ => Err(format!("{count} hexadecimal digits instead of 64")),
    }
}

#[cfg(unix)]
fn is_open(path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    fs::metadata(path).is_ok_and(|about| about.mode() & 0o077 != 0)
}

#[cfg(not(unix))]
fn is_open(_: &Path) -> bool {
    false
}

/// Time for [`staya_mavlink::signing`], tens of microseconds; 0 if the clock is before 2015.
#[must_use]
pub fn timestamp() -> u64 {
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH);
    let micros = since_1970.map_or(0, |since| since.as_micros() as u64);
    micros.saturating_sub(EPOCH_UNIX_S * 1_000_000) / 10
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_and_passphrases_are_keys() {
        let hex = "000102030405060708090a0b0c0d0e0f101112131415161718191A1B1C1D1E1F";
        let bytes = std::array::from_fn(|at| at as u8);
        for text in [hex, &format!("# ours\n\n  {hex}\t\r\n# end\n")] {
            assert_eq!(parse(text), Ok(Key::new(bytes)));
        }
        let words = Key::of_passphrase(b"correct horse");
        assert_eq!(parse("passphrase:  correct horse \n"), Ok(words));
    }

    #[test]
    fn invalid_keys_are_refused_without_revealing_them() {
        let hex = "00".repeat(32);
        for (text, line, problem) in [
            ("# nothing\n".to_string(), 1, "there is no key"),
            (format!("{hex}\n\n{hex}"), 3, "there is a second key"),
            ("\npassphrase: ".into(), 2, "the passphrase is empty"),
            (format!("\n{hex}0"), 2, "65 hexadecimal digits instead of 64"),
            ("secret".into(), 1, "column 1 is not a hexadecimal digit"),
            ("0é".into(), 1, "column 2 is not a hexadecimal digit"),
        ] {
            assert_eq!(parse(&text), Err((line, problem.to_string())));
        }
    }

    #[test]
    fn errors_name_the_file_and_the_remedy() {
        let dir = tempfile::tempdir().expect("a directory");
        let path = dir.path().join("swarm.key");
        let error = KeyFile::read(&path).expect_err("no file").to_string();
        assert!(error.contains("swarm.key") && error.contains("check the name"), "{error}");
        fs::write(&path, "abc\n").expect("written");
        let error = KeyFile::read(&path).expect_err("no key").to_string();
        assert!(error.contains("swarm.key, line 1: 3 hexadecimal digits"), "{error}");
        assert!(error.contains("openssl rand -hex 32"), "{error}");
        fs::write(&path, "passphrase: abc\n").expect("written");
        assert_eq!(KeyFile::read(&path).expect("a key").key, Key::of_passphrase(b"abc"));
    }

    #[cfg(unix)]
    #[test]
    fn a_file_readable_by_others_causes_a_warning() {
        use std::os::unix::fs::PermissionsExt;
        let dir = tempfile::tempdir().expect("a directory");
        let path = dir.path().join("swarm.key");
        fs::write(&path, "passphrase: abc\n").expect("written");
        for (mode, is_remarked) in [(0o600, false), (0o640, true), (0o604, true)] {
            fs::set_permissions(&path, fs::Permissions::from_mode(mode)).expect("mine");
            let remark = KeyFile::read(&path).expect("a key").remark;
            assert_eq!(remark.is_some_and(|remark| remark.contains("chmod 600")), is_remarked);
        }
    }

    #[test]
    fn the_clock_counts_tens_of_microseconds_since_2015() {
        let year = 365 * 86_400 * 100_000;
        assert!((10 * year..80 * year).contains(&timestamp()));
    }
}
