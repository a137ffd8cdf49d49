//! Names of files and fields with control characters, which a terminal would obey.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Clears the screen, begins a line of its own, overwrites a line, sets the window's title.
const EVIL: &str = "a\u{1b}[2J\nstaya: all is well\rb\u{9b}31m\u{1b}]0;c\u{7}";

fn staya(folder: &Path, arguments: &[OsString]) -> Output {
    let mut command = Command::new(staya_tests::program());
    command.args(arguments).current_dir(folder).stdin(Stdio::null());
    command.output().expect("staya starts")
}

fn words(words: &[&str]) -> Vec<OsString> {
    words.iter().map(Into::into).collect()
}

fn assert_safe(what: &str, Output { stdout, stderr, .. }: &Output) {
    for said in [stdout, stderr] {
        let said = String::from_utf8_lossy(said);
        let raw = said.chars().find(|letter| letter.is_control() && !matches!(letter, '\n' | '\t'));
        assert_eq!(raw, None, "{what}: {said:?}");
        assert!(!said.lines().any(|line| line.starts_with("staya: all is well")), "{what}: {said}");
    }
}

#[test]
#[cfg(unix)]
fn no_name_reaches_the_terminal_with_control_characters() {
    let dir = tempfile::tempdir().expect("temporary folder");
    let good = "name = \"good\"\nticks = 20\n[plane]\nradius_m = 0.2\nmax_speed_mps = 1\n[[plane.robots.list]]\n\
                start_m = [0, 0]\ngoal_m = [0.5, 0]\n";
    let write = |name: &str, text: &str| fs::write(dir.path().join(name), text).expect("a file");
    let file = format!("{EVIL}.toml");
    write(&file, good);
    write("good.toml", good);
    write("name.toml", &good.replace("\"good\"", "\"a\\u001b[2J\\nstaya: all is well\""));
    write("field.toml", &format!("{good}\"x\\u001b[2J\\nstaya: all is well\" = 1\n"));
    write("map.toml", "name = \"m\"\nticks = 2\n[terrain]\nfile = \"a\\u001b[2J\\nstaya: all is well.map\"\n");
    let bad = format!("bad{file}");
    write(&bad, "name = 1\n");
    let missing = format!("missing{file}");
    for (arguments, succeeds) in [
        (words(&["run", &file]), true),
        (words(&["run", "good.toml", "--out", EVIL]), true),
        (words(&["run", "good.toml", "--json", "--out", EVIL]), true),
        (words(&["run", &file, "--checkpoint", "5ticks", "--out", EVIL]), true),
        (words(&["run", &missing]), false),
        (words(&["run", &bad]), false),
        (words(&["run", "name.toml"]), false),
        (words(&["run", "field.toml"]), false),
        (words(&["run", "map.toml"]), false),
        (words(&["run", "good.toml", "--set", EVIL]), false),
        (words(&["run", "good.toml", "--set", &format!("{EVIL}=1")]), false),
        (words(&["run", "good.toml", "--from", &missing]), false),
        (words(&["run", "good.toml", "--out", "good.toml"]), false),
        (words(&["run", "good.toml", EVIL]), false),
        (words(&["run", "good.toml", "--seed", EVIL]), false),
        (words(&["run", "good.toml", &format!("--{EVIL}")]), false),
        (words(&[EVIL]), false),
        (words(&["page", &missing]), false),
        (words(&["terrain", &missing]), false),
        (words(&["new", &format!("{EVIL}/{EVIL}")]), false),
    ] {
        let output = staya(dir.path(), &arguments);
        let what = format!("{arguments:?}");
        assert_eq!(output.status.success(), succeeds, "{what}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(!output.stdout.is_empty() || !output.stderr.is_empty(), "{what} says nothing");
        assert_safe(&what, &output);
    }
    let results: PathBuf = dir.path().join(EVIL).join("summary.json");
    assert!(results.is_file(), "the folder has the name that was given");
}
