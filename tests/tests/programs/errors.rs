//! Compares the output of mistakes with the transcripts `tests/errors/*.txt`.
//!
//! A transcript begins with files for all of its cases. A case has a title, files of its own, a
//! command, its standard error and its exit code. `cargo xtask bless` writes the outputs; read them
//! before you commit.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

struct File<'a> {
    name: &'a str,
    text: String,
}

/// Splits `=== NAME` blocks off the lines; a block ends before the next line that begins with
/// `===`, `##` or `$`.
fn files<'a>(lines: &[&'a str]) -> Vec<File<'a>> {
    let mut files = Vec::<File<'_>>::new();
    let mut is_escaped = false;
    for line in lines {
        if let Some(name) = line.strip_prefix("=== ") {
            is_escaped = name.ends_with(" escaped");
            files.push(File { name: name.trim_end_matches(" escaped"), text: String::new() });
        } else if line.starts_with("$ ") {
            break;
        } else if let Some(file) = files.last_mut() {
            file.text += line;
            file.text += if is_escaped { "" } else { "\n" };
        }
    }
    files
}

/// Bytes of a text in which `\xHH` is a byte.
fn bytes(text: &str) -> Vec<u8> {
    let mut parts = text.split("\\x");
    let mut bytes = parts.next().unwrap_or_default().as_bytes().to_vec();
    for part in parts {
        bytes.push(u8::from_str_radix(&part[..2], 16).expect("two hex digits"));
        bytes.extend(&part.as_bytes()[2..]);
    }
    bytes
}

fn run(folder: &Path, line: &str) -> String {
    let mut words = line.split_whitespace();
    assert_eq!(words.next(), Some("staya"));
    let mut command = Command::new(staya_tests::program());
    command.args(words).current_dir(folder).stdin(Stdio::null()).env("COLUMNS", "200").env("NO_COLOR", "1");
    let output = command.output().expect("staya starts");
    let (stdout, stderr) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(stdout.is_empty(), "{line}: a mistake prints results: {stdout}");
    assert!(!output.status.success(), "{line}: a mistake ends with success: {stderr}");
    let code = output.status.code().unwrap_or_else(|| panic!("{line}: ended by a signal: {stderr}"));
    let stderr = stderr.replace(&*folder.to_string_lossy(), "FOLDER");
    // The machine's serial ports.
    let lines = stderr.lines().map(|line| match line.split_once("; there are /dev/") {
        Some((before, after)) => {
            let rest = after.split_once(';').map_or(String::new(), |(_, rest)| format!(";{rest}"));
            format!("{before}; there are PORTS{rest}\n")
        }
        None => format!("{line}\n"),
    });
    format!("{}[{code}]\n", lines.collect::<String>())
}

/// The transcript with the outputs of this build.
fn replay(text: &str) -> (String, usize) {
    let (head, cases) = text.split_once("\n## ").expect("a case");
    let shared: Vec<_> = head.lines().collect();
    let (mut new, mut count) = (head.to_owned(), 0);
    for case in cases.split("\n## ") {
        count += 1;
        let lines: Vec<_> = case.lines().collect();
        let at = lines.iter().position(|line| line.starts_with("$ ")).expect("a command");
        let folder = tempfile::tempdir().expect("temporary folder");
        let own = files(&lines[1..at]);
        for File { name, text } in files(&shared).iter().chain(&own) {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            fs::write(path, bytes(text)).expect("a file");
        }
        let before = snapshot(folder.path());
        let said = run(folder.path(), &lines[at][2..]);
        for (path, content) in before {
            assert_eq!(fs::read(&path).ok(), Some(content), "{}: a mistake changes {}", lines[0], path.display());
        }
        let _ = write!(new, "\n## {}\n{}", lines[..=at].join("\n"), said);
    }
    (new, count)
}

fn snapshot(folder: &Path) -> Vec<(std::path::PathBuf, Vec<u8>)> {
    let files = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    files.filter(|path| path.is_file()).map(|path| (path.clone(), fs::read(path).expect("a file"))).collect()
}

fn compare(name: &str) -> usize {
    let path = staya_tests::root().join("tests/errors").join(format!("{name}.txt"));
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let (new, count) = replay(&text);
    for leak in ["struct ", "enum ", "Some(", "None", "{ "] {
        for line in new.lines().filter(|line| line.starts_with("staya: ") || line.starts_with("error: ")) {
            assert!(!line.contains(leak), "a Rust name in: {line}");
        }
    }
    if std::env::var_os("STAYA_BLESS").is_some() {
        fs::write(&path, new).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    } else {
        let first = text.lines().zip(new.lines()).find(|(wanted, found)| wanted != found);
        assert!(text == new, "{name}: wanted and found: {first:#?}; cargo xtask bless writes {}", path.display());
    }
    count
}

#[test]
fn mistakes_in_scenarios_are_explained() {
    assert!(compare("scenario") >= 15);
}

#[test]
fn mistakes_in_commands_are_explained() {
    assert!(compare("options") >= 10);
}

#[test]
fn mistakes_in_other_files_are_explained() {
    assert!(compare("files") >= 10);
}

#[test]
fn mistakes_with_devices_are_explained() {
    assert!(compare("devices") >= 5);
}
