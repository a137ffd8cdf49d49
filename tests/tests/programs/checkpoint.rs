//! Checkpoints at the command line: an interrupted or moved run continues with identical results.

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};
use std::{fs, thread};

fn staya(arguments: &[&str]) -> Command {
    let mut command = Command::new(staya_tests::program());
    command.args(arguments).stdin(Stdio::null());
    command
}

fn scenario(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
    folder.join(name).to_str().expect("a path in UTF-8").to_owned()
}

fn run(arguments: &[&str]) -> String {
    let Output { status, stderr, .. } =
        staya(&[&["run", "--quiet"], arguments].concat()).output().expect("staya starts");
    let stderr = String::from_utf8_lossy(&stderr).into_owned();
    assert!(status.success(), "{stderr}");
    stderr
}

fn results(out: &str) -> BTreeMap<String, Vec<u8>> {
    let files = fs::read_dir(out).expect("a folder").map(|entry| {
        let path = entry.expect("it can be read").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let mut bytes = fs::read(&path).expect("it can be read");
        if name == "summary.json" {
            let mut json: Value = serde_json::from_slice(&bytes).expect("JSON");
            let object = json.as_object_mut().expect("an object");
            assert!(object.remove("wall_seconds").is_some() && object.remove("files").is_some());
            bytes = json.to_string().into_bytes();
        }
        (name, bytes)
    });
    files.collect()
}

fn assert_same(out: &str, whole: &str) {
    let (one, other) = (results(out), results(whole));
    assert!(one.len() > 6, "{:?}", one.keys());
    assert_eq!(one.keys().collect::<Vec<_>>(), other.keys().collect::<Vec<_>>());
    for (name, bytes) in &one {
        assert!(*bytes == other[name], "{name}");
    }
}

fn folders<const N: usize>() -> (tempfile::TempDir, [String; N]) {
    let dir = tempfile::tempdir().expect("temporary folder");
    let names = std::array::from_fn(|index| dir.path().join(index.to_string()).to_str().expect("UTF-8").to_owned());
    (dir, names)
}

#[test]
fn a_run_continues_in_another_process_with_identical_results() {
    for name in ["six-robots.toml", "six-discs.toml", "revoked.toml"] {
        let (_dir, [whole, out]) = folders();
        let path = scenario(name);
        run(&[&path, "--out", &whole, "--checkpoint", "30ticks"]);
        for end in [".checkpoint", ".checkpoint.old"] {
            run(&[&path, "--out", &out, "--from", &format!("{whole}{end}")]);
            assert_same(&out, &whole);
        }
    }
}

const LONG: &str = "name = \"long\"\nticks = 10000000\ntick_s = 0.5\n[terrain]\n\
    uniform = { width = 200, height = 200, classes = 1 }\n[robots.scattered]\ncount = 60\ntravel = 30\n\
    [radio]\nrange_m = 20\nloss = 0.3\njitter_ms = 900\n\
    [[intervention]]\nat_s = 4000000\ndo = { kind = \"radio\", loss = 0 }\n";

#[cfg(unix)]
#[test]
fn killed_and_stopped_runs_continue() {
    for signal in ["-KILL", "-INT"] {
        let (dir, [out, again, whole]) = folders();
        let path = dir.path().join("long.toml");
        fs::write(&path, LONG).expect("it can be written");
        let path = path.to_str().expect("UTF-8");
        let mut child = staya(&["run", "--quiet", path, "--out", &out, "--checkpoint", "20ticks"])
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .expect("staya starts");
        let checkpoint = format!("{out}.checkpoint");
        let until = Instant::now() + Duration::from_secs(120);
        while !Path::new(&checkpoint).exists() {
            assert!(Instant::now() < until && child.try_wait().expect("it can be asked").is_none(), "no checkpoint");
            thread::sleep(Duration::from_millis(5));
        }
        assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill").success());
        let Output { status, stderr, .. } = child.wait_with_output().expect("it ends");
        if signal == "-INT" {
            assert_eq!(status.code(), Some(130));
            assert!(String::from_utf8_lossy(&stderr).contains("checkpoint at tick"));
        }
        // The run lasts a little longer than its checkpoint.
        let refused = staya(&["run", "--quiet", path, "--out", &again, "--from", &checkpoint, "--ticks", "1"]).output();
        let refused = String::from_utf8_lossy(&refused.expect("staya starts").stderr).into_owned();
        let tick = refused.split("it is at tick ").nth(1).and_then(|rest| rest.split(',').next());
        let tick: u32 = tick.and_then(|tick| tick.parse().ok()).unwrap_or_else(|| panic!("{refused}"));
        let ticks = (tick + 15).to_string();
        run(&[path, "--out", &again, "--from", &checkpoint, "--ticks", &ticks]);
        run(&[path, "--out", &whole, "--ticks", &ticks]);
        assert_same(&again, &whole);
    }
}

#[test]
fn checkpoints_of_other_runs_are_not_replaced() {
    let (dir, [out]) = folders();
    let path = scenario("figure-5.toml");
    let checkpoint = format!("{out}.checkpoint");
    let stale = format!("{checkpoint}.99999999.tmp");
    fs::write(&stale, "").expect("it can be written");
    run(&[&path, "--out", &out, "--ticks", "10", "--checkpoint", "5ticks"]);
    assert!(!Path::new(&stale).exists());
    run(&[&path, "--out", &out, "--ticks", "10", "--checkpoint", "4ticks"]);
    let before = fs::read(&checkpoint).expect("it is there");
    let other_seed = ["run", &path, "--out", &out, "--ticks", "10", "--checkpoint", "5ticks", "--seed", "2"];
    let ended = staya(&other_seed).output().expect("staya starts");
    let stderr = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert!(ended.status.code() == Some(1) && stderr.contains(&checkpoint), "{stderr}");
    assert!(stderr.contains("not a checkpoint of this run") && stderr.contains("move it"), "{stderr}");
    assert!(fs::read(&checkpoint).expect("it is there") == before);
    assert_eq!(fs::read_dir(dir.path()).expect("a folder").count(), 3, "results and two checkpoints");
}

#[test]
fn checkpoints_of_other_runs_are_refused_in_one_line() {
    let (_dir, [out, other]) = folders();
    let [path, another] = ["figure-5.toml", "figure-6.toml"].map(scenario);
    run(&[&path, "--out", &out, "--ticks", "10", "--checkpoint", "5ticks"]);
    let checkpoint = format!("{out}.checkpoint");
    let refused = |arguments: &[&str]| {
        let ended = staya(&[&["run", "--out", &other], arguments].concat()).output().expect("staya starts");
        let stderr = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert_eq!((ended.status.code(), stderr.lines().count()), (Some(1), 1), "{stderr}");
        assert!(!Path::new(&other).exists());
        stderr
    };
    let error = refused(&[&another, "--from", &checkpoint]);
    assert!(error.contains(&checkpoint) && error.contains("`figure-5`, not of `figure-6`"), "{error}");
    let error = refused(&[&path, "--from", &checkpoint, "--seed", "2"]);
    assert!(error.contains("`figure-5` has changed"), "{error}");
    let error = refused(&[&path, "--from", &path]);
    assert!(error.contains("this is not a checkpoint"), "{error}");
    let error = refused(&[&path, "--from", &format!("{out}.nothing")]);
    assert!(error.contains("check the name"), "{error}");
    let bytes = fs::read(&checkpoint).expect("it is there");
    fs::write(&checkpoint, &bytes[..bytes.len() / 2]).expect("it can be written");
    let error = refused(&[&path, "--from", &checkpoint]);
    assert!(error.contains(&format!("byte {}", bytes.len() / 2)) && error.contains(".checkpoint.old"), "{error}");
}
