//! `staya run --record`, `--mcap`, `--gif` and `staya page` at the command line.

use serde_json::Value;
use staya_record::recording::Reader;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn staya(arguments: &[&str]) -> Output {
    let mut command = Command::new(staya_tests::program());
    command.args(arguments).stdin(Stdio::null()).output().expect("staya starts")
}

fn scenario(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(name);
    path.to_str().expect("UTF-8").to_owned()
}

fn run(arguments: &[&str]) -> Value {
    let ended = staya(&[&["run", "--json", "--quiet"], arguments].concat());
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    serde_json::from_slice(&ended.stdout).expect("one JSON object")
}

fn refusal(arguments: &[&str]) -> String {
    let ended = staya(arguments);
    assert_eq!(ended.status.code(), Some(1));
    String::from_utf8_lossy(&ended.stderr).into_owned()
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("temporary folder"))
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().expect("UTF-8").to_owned()
    }
}

#[test]
fn a_recording_has_every_tick_and_changes_nothing() {
    let folder = Folder::new();
    let (out, file, every) = (folder.path("out"), folder.path("run.rec"), folder.path("every.rec"));
    let figure = scenario("figure-5.toml");
    let plain = run(&[&figure, "--out", &out]);
    let recorded = run(&[&figure, "--out", &out, "--record", &file]);
    assert_eq!(plain["trace_hash"], recorded["trace_hash"]);
    let files = recorded["files"].as_array().expect("a list");
    assert!(files.contains(&Value::from(file.clone())), "{files:?}");
    let ticks = recorded["ticks"].as_u64().expect("a number") as u32;
    let mut reader = Reader::open(file.as_ref()).expect("a recording");
    assert_eq!((reader.ticks(), reader.torn_at()), (Some((0, ticks)), None));
    let last = reader.frame(ticks).expect("the last frame");
    assert_eq!(Value::from(last.figures.hash), recorded["trace_hash"]);
    assert_eq!(reader.summary().expect("a summary").expect("one")["trace_hash"], recorded["trace_hash"]);
    let trace = fs::read_to_string(Path::new(&out).join("trace.csv")).expect("trace.csv");
    for line in trace.lines().skip(1).step_by(17) {
        let fields: Vec<_> = line.split(',').collect();
        let frame = reader.frame(fields[0].parse().expect("a tick")).expect("a frame");
        let robot = fields[2].parse::<usize>().expect("a number") - 1;
        let origin_m = reader.scene().expect("a scene").origin_m;
        for axis in 0..2 {
            let expected: f64 = fields[5 + axis].parse().expect("metres");
            let found = f64::from(frame.position_m[robot][axis]) + origin_m[axis];
            assert!((found - expected).abs() < 1e-3, "{line}: {found}");
        }
    }

    run(&[&figure, "--out", &out, "--record", &every, "--record-every", "10"]);
    let mut reader = Reader::open(every.as_ref()).expect("a recording");
    assert_eq!(reader.ticks(), Some((0, ticks)));
    assert_eq!(reader.frame(19).expect("a frame").tick, 10);
}

#[test]
fn interventions_are_in_the_recording() {
    let folder = Folder::new();
    let (out, file, path) = (folder.path("out"), folder.path("run.rec"), folder.path("wall.toml"));
    let text = "name = \"wall\"\nticks = 30\ntick_s = 0.1\n[plane]\nradius_m = 0.2\nmax_speed_mps = 0.5\n\
                [plane.robots]\nlist = [{ start_m = [0, 0], goal_m = [5, 0] }]\n[[intervention]]\nat_s = 1.0\n\
                do = { kind = \"solid\", solid = { kind = \"circle\", center_m = [3, 3], radius_m = 1 } }\n";
    fs::write(&path, text).expect("write");
    run(&[&path, "--out", &out, "--record", &file]);
    let mut reader = Reader::open(file.as_ref()).expect("a recording");
    let solids = |text: String| serde_json::from_str::<Value>(&text).expect("JSON")["solids"].as_array().map(Vec::len);
    assert_eq!(solids(reader.scene_text_at(10).expect("a scene")), Some(0));
    assert_eq!(solids(reader.scene_text_at(11).expect("a scene")), Some(1));
    assert_eq!(reader.orders().expect("orders")[0]["tick"], 10);
}

#[test]
fn a_page_contains_a_run_or_a_recording() {
    if staya_record::page::file("index.html").is_none() {
        return;
    }
    let folder = Folder::new();
    let (out, file) = (folder.path("out"), folder.path("run.rec"));
    let six = scenario("six-robots.toml");
    run(&[&six, "--out", &out, "--record", &file]);
    let pages = [folder.path("of-recording.html"), folder.path("of-scenario.html")];
    for (source, page) in [&file, &six].into_iter().zip(&pages) {
        let made = staya(&["page", source, "--out", page, "--quiet", "--json"]);
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        let json: Value = serde_json::from_slice(&made.stdout).expect("one JSON object");
        let bytes = fs::metadata(page).expect("a page").len();
        assert_eq!(json["bytes"].as_u64(), Some(bytes));
        assert!(bytes < 1_000_000, "{bytes}");
        let text = fs::read_to_string(page).expect("UTF-8");
        assert!(text.contains("id=\"recording\">U1RBWUFSRUM") && text.contains("\"staya/main.js\":\"data:"));
        assert!(!text.contains("<!-- staya:"));
    }
}

#[test]
fn gif_and_mcap_files_are_valid() {
    let folder = Folder::new();
    let [out, gif, mcap] = ["out", "run.gif", "run.mcap"].map(|name| folder.path(name));
    run(&[
        &scenario("mixed.toml"),
        "--ticks",
        "40",
        "--out",
        &out,
        "--gif",
        &gif,
        "--gif-width",
        "200",
        "--mcap",
        &mcap,
    ]);
    assert!(fs::read(&gif).expect("a picture").starts_with(b"GIF89a\xc8\0"));
    let bytes = fs::read(&mcap).expect("a file");
    assert!(bytes.starts_with(b"\x89MCAP0\r\n") && bytes.ends_with(b"\x89MCAP0\r\n"));
}

/// Every pair of an input and an option that writes a file, by its own name and through links.
#[test]
fn no_output_replaces_an_input_or_another_output() {
    let folder = Folder::new();
    let [out, path, map, picture] = ["out", "run.toml", "a.yaml", "a.pgm"].map(|name| folder.path(name));
    let made = staya(&["terrain", "generate", "--width", "20", "--height", "20", "--obstacles", "1", "--out", &map]);
    assert!(made.status.success());
    let text = "name = \"t\"\nticks = 30\n[terrain]\nfile = \"a.yaml\"\n[robots.scattered]\ncount = 3\ntravel = 5\n";
    fs::write(&path, text).expect("write");
    let [recording, checkpoint] = [folder.path("kept.rec"), format!("{out}.checkpoint")];
    run(&[&path, "--out", &out, "--record", &recording, "--checkpoint", "10ticks"]);
    let inputs = [&path, &map, &picture, &checkpoint, &recording];
    let before = inputs.map(|input| fs::read(input).expect("an input"));
    let mut refused = 0;
    let mut refuse = |arguments: &[&str]| {
        let error = refusal(&[arguments, &["--quiet"]].concat());
        assert!(error.contains("it is also an") && error.contains("; choose another name"), "{error}");
        refused += 1;
    };
    for (number, input) in inputs.iter().enumerate() {
        let mut names =
            vec![(*input).clone(), format!("{}/out/../{}", folder.path(""), &input[folder.path("").len()..])];
        #[cfg(unix)]
        for ending in ["link.mcap", "link.gif"] {
            names.push(folder.path(&format!("{number}{ending}")));
            std::os::unix::fs::symlink(input, names.last().expect("a name")).expect("a link");
        }
        for name in &names {
            let is_recording = input == &&recording;
            if !is_recording {
                let from: &[&str] = if input == &&checkpoint { &["--from", &checkpoint] } else { &[] };
                refuse(&[&["run", &path, "--out", &out, "--record", name], from].concat());
                if let Some((_, ending @ ("mcap" | "gif"))) = name.rsplit_once('.') {
                    let option = format!("--{ending}");
                    refuse(&[&["run", &path, "--out", &out, &option, name], from].concat());
                }
            }
            if input != &&checkpoint {
                refuse(&["page", if is_recording { &recording } else { &path }, "--out", name]);
            }
        }
        for (input, before) in inputs.iter().zip(&before) {
            assert!(fs::read(input).expect("an input") == *before, "{input}");
        }
    }
    let [gif, mcap] = ["new.gif", "new.mcap"].map(|name| folder.path(name));
    refuse(&["run", &path, "--out", &out, "--record", &gif, "--gif", &gif]);
    refuse(&["run", &path, "--out", &out, "--record", &mcap, "--mcap", &mcap]);
    refuse(&["run", &path, "--out", &out, "--record", &out]);
    assert!(refused > 30 && !Path::new(&gif).exists() && !Path::new(&mcap).exists());
}

#[test]
fn errors_name_the_file_the_byte_and_the_remedy() {
    let folder = Folder::new();
    let (out, file, page) = (folder.path("out"), folder.path("run.rec"), folder.path("page.html"));
    let figure = scenario("figure-5.toml");
    for option in ["--record", "--mcap", "--gif"] {
        let nowhere = folder.path(&format!("no/such/file.{}", &option[2..]));
        let refused = refusal(&["run", &figure, "--quiet", "--out", &out, option, &nowhere]);
        assert!(refused.contains(&nowhere) && refused.contains("make its directory first"), "{refused}");
        assert!(!Path::new(&out).exists(), "{option}: nothing was begun");
    }
    run(&[&figure, "--out", &out, "--record", &file]);
    let mut bytes = fs::read(&file).expect("a recording");
    bytes[40] ^= 1;
    fs::write(&file, &bytes).expect("write");
    let damaged = refusal(&["page", &file, "--out", &page]);
    assert!(damaged.contains(&format!("{file}: byte 12: this block is damaged")), "{damaged}");
    let missing = refusal(&["page", &folder.path("none.rec"), "--out", &page]);
    assert!(missing.contains("none.rec") && missing.contains("check the name"), "{missing}");
    fs::write(&file, "a text").expect("write");
    let text = refusal(&["page", &file, "--out", &page]);
    assert!(text.contains("byte 0: not a recording"), "{text}");
    assert!(!PathBuf::from(page).exists());
}
