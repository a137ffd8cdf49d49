//! The command `staya`: exit codes, standard output, files, errors.

use serde_json::Value;
use std::path::{Path, PathBuf};
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

fn folder() -> (tempfile::TempDir, String) {
    let dir = tempfile::tempdir().expect("temporary folder");
    let path = dir.path().join("out").to_str().expect("UTF-8").to_owned();
    (dir, path)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn refusal(arguments: &[&str]) -> String {
    let Output { status, stdout, stderr } = staya(arguments).output().expect("staya starts");
    let stderr = text(&stderr);
    assert_eq!(status.code(), Some(1), "{stderr}");
    assert!(stdout.is_empty(), "{}", text(&stdout));
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
    stderr
}

#[test]
fn json_is_one_object_with_every_promised_key() {
    let (_dir, out) = folder();
    let arguments = ["run", &scenario("figure-5.toml"), "--json", "--quiet", "--out", &out];
    let Output { status, stdout, stderr } = staya(&arguments).output().expect("staya starts");
    assert!(status.success(), "{}", text(&stderr));
    assert!(stderr.is_empty(), "{}", text(&stderr));
    let json: Value = serde_json::from_slice(&stdout).expect("one JSON object");
    assert_eq!(json["scenario"], "figure-5");
    assert_eq!((&json["seed"], &json["robots"]), (&1.into(), &6.into()));
    assert_eq!((&json["arrived"], &json["collisions"]), (&6.into(), &0.into()));
    for key in ["ticks", "sim_seconds", "wall_seconds", "formation_error_per_agent", "graph_distance_mean"] {
        assert!(json[key].as_f64().is_some_and(|value| value > 0.0), "{key}: {}", json[key]);
    }
    for key in ["sent", "delivered", "lost", "damaged", "rejected"] {
        assert!(json["packets"][key].is_u64(), "packets.{key}");
    }
    let hash = json["trace_hash"].as_str().expect("a string");
    assert!(hash.len() == 16 && hash.chars().all(|c| c.is_ascii_hexdigit()), "{hash}");

    let written: Value =
        serde_json::from_str(&fs::read_to_string(Path::new(&out).join("summary.json")).expect("summary.json"))
            .expect("JSON");
    assert_eq!(written, json);
    let files = json["files"].as_array().expect("a list");
    for file in files {
        let path = PathBuf::from(file.as_str().expect("a name"));
        assert!(fs::metadata(&path).is_ok_and(|m| m.len() > 0), "{}", path.display());
    }
    for name in ["summary.json", "trace.csv", "series.csv", "trace.schema.json"] {
        assert!(files.iter().any(|f| f.as_str().is_some_and(|f| f.ends_with(name))), "{name}");
    }
    assert!(files.iter().any(|f| f.as_str().is_some_and(|f| f.ends_with(".png"))));
}

#[test]
fn a_run_without_traces_is_unchanged_and_removes_earlier_traces() {
    let (_dir, out) = folder();
    let run = |more: &[&str]| {
        let file = scenario("figure-5.toml");
        let arguments = [&["run", &file, "--json", "--quiet", "--out", &out][..], more].concat();
        let Output { status, stdout, stderr } = staya(&arguments).output().expect("staya starts");
        assert!(status.success(), "{}", text(&stderr));
        let json: Value = serde_json::from_slice(&stdout).expect("one JSON object");
        let names = fs::read_dir(&out).expect("results").map(|entry| entry.expect("an entry").file_name());
        let mut names: Vec<_> = names.map(|name| name.into_string().expect("UTF-8")).collect();
        names.sort();
        (json["trace_hash"].clone(), json["packets"].clone(), names)
    };
    let (hash, packets, names) = run(&[]);
    assert!(names.contains(&"trace.csv".to_owned()), "{names:?}");
    let (same_hash, same_packets, names) = run(&["--no-trace"]);
    assert_eq!((same_hash, same_packets), (hash, packets));
    let left = ["packets.png", "packets.svg", "series.csv", "series.schema.json", "summary.json"];
    assert!(left.iter().all(|name| names.iter().any(|there| there == name)), "{names:?}");
    assert!(!names.iter().any(|name| name.starts_with("trace") || name.starts_with("trajectories")), "{names:?}");
}

#[test]
fn a_run_without_formation_has_null_values_and_options_override_the_file() {
    let (_dir, out) = folder();
    let path = scenario("moving-ai-20.toml");
    let base = ["run", &path, "--json", "--quiet", "--out", &out, "--ticks", "7"];
    let run = |more: &[&str]| -> Value {
        let Output { stdout, .. } = staya(&[&base, more].concat()).output().expect("staya starts");
        serde_json::from_slice(&stdout).expect("one JSON object")
    };
    let first = run(&["--seed", "5"]);
    assert_eq!((&first["ticks"], &first["seed"]), (&7.into(), &5.into()));
    assert!(first["formation_error_per_agent"].is_null());
    assert!(first["graph_distance_mean"].is_null());
    let again = run(&["--seed", "5", "--threads", "3"]);
    assert_eq!(again["trace_hash"], first["trace_hash"]);
    assert_ne!(run(&["--seed", "6"])["packets"], first["packets"]);
}

#[test]
fn the_table_names_the_written_files() {
    let (_dir, out) = folder();
    let arguments = ["run", &scenario("figure-5.toml"), "--quiet", "--out", &out];
    let Output { status, stdout, .. } = staya(&arguments).output().expect("staya starts");
    assert!(status.success());
    let table = text(&stdout);
    for part in ["6 of 6 robots", "collisions", "trace hash", "written to", "trace.csv", ".svg"] {
        assert!(table.contains(part), "{part} is missing in\n{table}");
    }
}

#[test]
fn results_are_in_a_folder_with_the_scenarios_name() {
    let (dir, _) = folder();
    let arguments = ["run", &scenario("figure-5.toml"), "--quiet", "--ticks", "2"];
    let ended = staya(&arguments).current_dir(dir.path()).output().expect("staya starts");
    assert!(ended.status.success());
    assert!(dir.path().join("out/figure-5/summary.json").is_file());
}

#[test]
fn errors_are_one_line_with_place_and_remedy() {
    let (dir, out) = folder();
    let missing = refusal(&["run", "no/such.toml", "--out", &out]);
    assert!(missing.starts_with("staya: no/such.toml: "), "{missing}");

    let wrong = dir.path().join("wrong.toml");
    let good = fs::read_to_string(scenario("figure-6.toml")).expect("readable");
    fs::write(&wrong, good.replace("range_m = 150", "range_m = 150\nloss = 60")).expect("write");
    let wrong = refusal(&["run", wrong.to_str().expect("UTF-8"), "--out", &out]);
    let line = good.lines().position(|l| l == "range_m = 150").expect("the line") + 2;
    let place = format!("wrong.toml:{line}:8: radio.loss: 60 is not a probability; give a number from 0 to 1");
    assert!(wrong.contains(&place), "{wrong}");
    assert!(!Path::new(&out).exists(), "nothing was begun");

    let in_the_way = dir.path().join("file");
    fs::write(&in_the_way, "mine").expect("write");
    let way = in_the_way.to_str().expect("UTF-8");
    let unwritable = refusal(&["run", &scenario("figure-5.toml"), "--quiet", "--out", way]);
    assert!(unwritable.contains(way) && unwritable.contains("choose another output directory"), "{unwritable}");
    assert_eq!(fs::read_to_string(&in_the_way).expect("still there"), "mine");
}

#[test]
fn invalid_usage_differs_from_failure() {
    for arguments in [
        &["run"][..],
        &["run", "a.toml", "--ticks", "0"],
        &["run", "a.toml", "--ticks", "-1"],
        &["run", "a.toml", "--threads", "0"],
        &["walk"],
        &["terrain", "metrics"],
        &["terrain", "metrics", "a.map", "--crop", "-1,0,2,2"],
        &["terrain", "draw", "a.map"],
        &["terrain", "generate"],
        &["experiment", "route", "--seeds", "x"],
        &["experiment", "formation", "--seeds", "0"],
    ] {
        let ended = staya(arguments).output().expect("staya starts");
        assert_eq!(ended.status.code(), Some(2), "{arguments:?}");
        assert!(ended.stdout.is_empty(), "{arguments:?}");
        // A negative number is an invalid value, not an unknown option.
        let stderr = text(&ended.stderr);
        assert!(!stderr.contains("unexpected argument"), "{stderr}");
    }
}

#[test]
fn numbers_out_of_range_are_errors_with_a_remedy() {
    for (arguments, expected) in [
        (&["route", "--set", "obstacles=99999999"][..], "obstacles"),
        (&["route", "--set", "terrain.natural.width=65535"], "each side must be"),
        (&["route", "--set", "grid.radius=0"], "grid.radius"),
        (&["route", "--seeds", "1000000"], "more than a million runs"),
        (&["boids", "--set", "boids=0"], "study.boids: 0 is out of range"),
        (&["movingai", "--set", "study.visits=5"], "give 16, 64, 256 or 1024"),
        (&["flock", "--set", "study.knows=none"], "unknown value `none`"),
        (&["goals-tuned", "--set", "study.particles=1"], "study.particles: 1 is out of range"),
        (&["formation", "--set", "radio.loss=-1"], "radio.loss: -1 is not a probability"),
        (
            &["formation", "--set", "robots.formation.rho=0"],
            "robots.formation.rho: with rho = 0 no robot knows its neighbours",
        ),
        (&["formation", "--set", "grid.formation.halt_cells=-1"], "grid.formation.halt_cells: -1"),
    ] {
        let refused = refusal(&[&["experiment"], arguments].concat());
        assert!(refused.contains(expected), "{refused}");
    }
}

#[test]
fn an_unreadable_file_is_named_once_with_a_remedy() {
    let (dir, _) = folder();
    let path = |name: &str| dir.path().join(name).to_str().expect("UTF-8").to_owned();
    let kinds: [(&[&str], &str); 4] = [
        (&["run"], "toml"),
        (&["terrain", "metrics"], "map"),
        (&["terrain", "metrics"], "asc"),
        (&["terrain", "metrics"], "yaml"),
    ];
    for (command, extension) in kinds {
        let refused = |name: &str| {
            let file = path(&format!("{name}.{extension}"));
            let refused = refusal(&[command, &[&file]].concat());
            assert!(refused.starts_with(&format!("staya: {file}")), "{refused}");
            assert!(refused.matches("os error").count() <= 1, "{refused}");
            refused
        };
        assert!(refused("missing").ends_with("; check the name\n"));
        fs::create_dir(path(&format!("folder.{extension}"))).expect("folder");
        assert!(refused("folder").ends_with("; name a file, not a directory\n"));
        fs::write(path(&format!("empty.{extension}")), "").expect("write");
        assert!(refused("empty").contains(';'));
        let bytes: Vec<u8> = (0..4096_u32).map(|i| (i * i % 251) as u8 | 0x80).collect();
        fs::write(path(&format!("garbage.{extension}")), bytes).expect("write");
        let garbage = refused("garbage");
        assert!(garbage.contains("is it another kind of file"), "{garbage}");
    }
}

#[test]
fn experiments_check_their_output_folder_first() {
    let (dir, _) = folder();
    let in_the_way = dir.path().join("file");
    fs::write(&in_the_way, "mine").expect("write");
    let way = in_the_way.to_str().expect("UTF-8");
    // A hundred thousand runs would take hours.
    for many in [&["flock", "--seeds", "100000"][..], &["formation", "--set", "obstacles=9", "--seeds", "100000"]] {
        let refused = refusal(&[&["experiment"], many, &["--out", way]].concat());
        assert!(refused.contains(way) && refused.contains("choose another output directory"), "{refused}");
        assert_eq!(refused.matches("os error").count(), 1, "{refused}");
    }
    let land = format!("{way}/land.yaml");
    let refused = refusal(&["terrain", "generate", "--out", &land]);
    assert!(refused.contains("cannot write"), "{refused}");
    assert!(refused.contains("is in the way"), "{refused}");
}

#[test]
fn every_json_command_prints_one_object_and_leaves_no_probe_file() {
    let (dir, out) = folder();
    let path = |name: &str| dir.path().join(name).to_str().expect("UTF-8").to_owned();
    let (land, picture, answers) = (path("land.yaml"), path("land.png"), path("answers"));
    let route = "experiment route --seeds 2 --set obstacles=5 --set scenario=natural";
    let movingai = "experiment movingai --set scen=../../../maps/random-32-32-20-random-1.scen";
    let (formation, figure) = ("experiment formation --quick --set scenario=staya --set obstacles=5", path("figure"));
    let commands: [Vec<&str>; 6] = [
        vec!["terrain", "generate", "--out", &land],
        vec!["terrain", "metrics", &land],
        vec!["terrain", "draw", &land, "--out", &picture],
        route.split(' ').chain(["--out", &out]).collect(),
        formation.split(' ').chain(["--out", &figure]).collect(),
        movingai.split(' ').chain(["--out", &answers]).collect(),
    ];
    for command in commands {
        let ended = staya(&[&command[..], &["--json"]].concat()).output();
        let ended = ended.expect("staya starts");
        assert!(ended.status.success(), "{}", text(&ended.stderr));
        let json: Value = serde_json::from_slice(&ended.stdout).expect("JSON alone");
        assert!(json.is_object(), "{command:?}");
    }
    for file in fs::read_dir(&out).expect("the folder of the experiments") {
        let name = file.expect("an entry").file_name();
        let name = name.to_str().expect("UTF-8");
        let known = ["rows.csv", "rows.schema.json", "aggregates.csv", "shards", "times", "plots", "pictures"];
        assert!(known.contains(&name), "{name}");
    }
}

fn partial(out: &str) -> Option<PathBuf> {
    let out = Path::new(out);
    let found = fs::read_dir(out.parent()?).ok()?.flatten().map(|entry| entry.path());
    let mut found = found.filter(|path| path.file_name().is_some_and(|n| n.to_string_lossy().contains(".partial-")));
    found.next()
}

#[cfg(unix)]
#[test]
fn a_full_disk_ends_the_run_and_keeps_the_old_results() {
    let (_dir, out) = folder();
    let small = scenario("scale-small.toml");
    let first = staya(&["run", &small, "--quiet", "--ticks", "2", "--out", &out]).output().expect("staya starts");
    assert!(first.status.success());
    let before = fs::read(Path::new(&out).join("summary.json")).expect("summary.json");
    fs::write(Path::new(&out).join("notes.txt"), "mine").expect("write");
    // The system refuses files beyond 64 KiB, as on a full disk.
    let line = "trap '' XFSZ; ulimit -f 128; exec \"$0\" \"$@\"";
    let ended = Command::new("sh")
        .args(["-c", line])
        .arg(staya_tests::program())
        .args(["run", &small, "--quiet", "--out", &out])
        .output()
        .expect("sh starts");
    assert_eq!(ended.status.code(), Some(1));
    let full = text(&ended.stderr);
    let kept = partial(&out).expect("what was written");
    assert!(full.contains("trace.csv") && full.contains("free some space"), "{full}");
    assert!(full.contains(kept.to_str().expect("UTF-8")) && full.contains("is unchanged"), "{full}");
    assert_eq!(fs::read(Path::new(&out).join("summary.json")).expect("still there"), before);
    let next = staya(&["run", &small, "--quiet", "--ticks", "3", "--out", &out]).output().expect("staya starts");
    assert!(next.status.success());
    assert_eq!(partial(&out), None);
    assert_ne!(fs::read(Path::new(&out).join("summary.json")).expect("new"), before);
    assert_eq!(fs::read_to_string(Path::new(&out).join("notes.txt")).expect("kept"), "mine");
}

const PRISON: &str = "name = \"prison\"\nticks = 4000000000\n[terrain]\nfile = \"prison.map\"\n\
                      [robots]\nlist = [{ start = [0, 0], goal = [4, 0] }]\n";

fn prison(dir: &Path) -> PathBuf {
    let path = dir.join("prison.toml");
    fs::write(&path, PRISON).expect("write");
    let map = "type octile\nheight 1\nwidth 5\nmap\n..@..\n";
    fs::write(dir.join("prison.map"), map).expect("write");
    path
}

fn wait_for_series(out: &str, child: &mut std::process::Child) {
    let patience = Instant::now() + Duration::from_secs(120);
    let written = || fs::metadata(partial(out)?.join("series.csv")).ok();
    while written().map_or(0, |m| m.len()) < 10_000 {
        assert!(Instant::now() < patience, "nothing is written");
        assert!(child.try_wait().expect("a child").is_none(), "the run ended early");
        thread::sleep(Duration::from_millis(10));
    }
}

#[cfg(unix)]
#[test]
fn a_killed_run_leaves_the_old_results_unchanged() {
    let (dir, out) = folder();
    let path = prison(dir.path());
    let path = path.to_str().expect("UTF-8");
    let first = staya(&["run", path, "--quiet", "--ticks", "5", "--out", &out]).output().expect("staya starts");
    assert!(first.status.success());
    let all = || -> Vec<(PathBuf, Vec<u8>)> {
        let mut paths: Vec<_> = fs::read_dir(&out).expect("results").map(|entry| entry.expect("one").path()).collect();
        paths.sort();
        paths.into_iter().map(|path| (path.clone(), fs::read(path).expect("readable"))).collect()
    };
    let before = all();
    let mut child =
        staya(&["run", path, "--quiet", "--out", &out]).stderr(Stdio::null()).spawn().expect("staya starts");
    wait_for_series(&out, &mut child);
    child.kill().expect("killed");
    child.wait().expect("it ends");
    assert!(before == all(), "the results have changed");
    let again = staya(&["run", path, "--quiet", "--ticks", "5", "--out", &out]).output().expect("staya starts");
    assert!(again.status.success());
    assert_eq!(partial(&out), None, "incomplete results are removed");
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_run_cleanly_and_keeps_its_results() {
    let (dir, out) = folder();
    let path = prison(dir.path());
    let mut child = staya(&["run", path.to_str().expect("UTF-8"), "--json", "--out", &out])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("staya starts");
    wait_for_series(&out, &mut child);
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(sent.expect("kill starts").success());
    let Output { status, stdout, .. } = child.wait_with_output().expect("it ends");
    assert_eq!(status.code(), Some(130));
    let json: Value = serde_json::from_slice(&stdout).expect("one JSON object");
    assert_eq!((&json["interrupted"], &json["arrived"]), (&true.into(), &0.into()));
    let ticks = json["ticks"].as_u64().expect("a number");
    let series = fs::read_to_string(Path::new(&out).join("series.csv")).expect("readable");
    let last = series.lines().last().expect("a line");
    assert!(last.starts_with(&format!("{ticks},")), "{last}");
    assert!(Path::new(&out).join("summary.json").is_file());
}

#[test]
fn a_swap_in_the_plane_runs_at_the_command_line() {
    let (_dir, out) = folder();
    let circle = scenario("swap-circle.toml");
    let arguments = ["run", &circle, "--json", "--quiet", "--out", &out];
    let Output { status, stderr, .. } = staya(&arguments).output().expect("staya starts");
    assert!(status.success(), "{}", text(&stderr));
    let summary = fs::read(Path::new(&out).join("summary.json")).expect("summary.json");
    let json: Value = serde_json::from_slice(&summary).expect("JSON");
    assert_eq!(json["scenario"], "swap-circle");
    assert_eq!((&json["arrived"], &json["collisions"]), (&16.into(), &0.into()));
    let gap_m = json["least_gap_m"].as_f64().expect("a number");
    assert!(gap_m > 0.0 && gap_m < 0.1, "{gap_m}");
    let files = json["files"].as_array().expect("a list");
    let of_kind = |kind: &str| {
        let names = files.iter().filter_map(|file| file.as_str());
        names.filter(|name| name.ends_with(kind)).count()
    };
    assert!(of_kind(".png") > 0 && of_kind(".png") == of_kind(".svg"), "{files:?}");
    for file in files {
        let path = PathBuf::from(file.as_str().expect("a name"));
        let length = fs::metadata(&path).map(|m| m.len());
        assert!(length.is_ok_and(|length| length > 0), "{}", path.display());
    }
}

#[test]
fn studies_print_tables_and_json_and_write_pictures() {
    let (dir, out) = folder();
    let json = |line: &str| -> Value {
        let output = staya(&line.split(' ').collect::<Vec<_>>()).args(["--json", "--quiet", "--out", &out]).output();
        let output = output.expect("staya starts");
        assert!(output.status.success(), "{}", text(&output.stderr));
        serde_json::from_slice(&output.stdout).expect("one JSON object")
    };
    let flock = "experiment flock --seeds 1 --set plane.robots.cloud.count=10 --set ticks=100";
    let report = json(flock);
    assert_eq!(report["points"].as_array().map(Vec::len), Some(4));
    assert_eq!(report["points"][0]["figures"]["collisions"]["max"], 0.0);
    let name = "pictures/flock-free-packets-10-100";
    for picture in [format!("{name}.png"), format!("{name}-flock.svg")] {
        assert!(dir.path().join("out").join(&picture).exists(), "{picture}: {report}");
    }
    let goals = "experiment goals --seeds 1 --set plane.robots.cloud.count=5 --set ticks=60 --set neighborhood_m=40";
    let report = json(&format!("{goals} --axis k2=0,50 --restart"));
    assert_eq!(report["gains"].as_array().map(Vec::len), Some(2));
    assert_eq!(report["gains"][0]["gains"][0][1], 0.0);
    let boids = "experiment boids --restart --axis search=cells,tree --set boids=20 --set study.steps=3";
    assert_eq!(json(boids)["points"][1]["figures"]["equal"]["min"], 1.0);
}

/// The first line that a command prints.
fn first_line(arguments: &[&str]) -> String {
    let Output { status, stdout, stderr } = staya(arguments).output().expect("staya starts");
    assert!(status.success(), "{arguments:?}: {}", text(&stderr));
    text(&stdout).lines().next().unwrap_or_default().to_owned()
}

#[test]
fn the_first_line_of_each_help_says_what_the_command_does() {
    let top = text(&staya(&["--help"]).output().expect("staya starts").stdout);
    assert_eq!(first_line(&["--help"]), "Simulate swarms of robots, and run their controllers on hardware");
    assert_eq!(first_line(&["-h"]), first_line(&["--help"]));
    let commands = top.split_once("Commands:\n").and_then(|(_, rest)| rest.split_once("\n\n")).expect("commands").0;
    let commands: Vec<_> = commands.lines().filter_map(|line| line.trim().split_once("  ")).collect();
    assert!(commands.len() >= 13, "{commands:?}");
    for (name, about) in commands.into_iter().filter(|(name, _)| *name != "help") {
        let line = first_line(&[name, "--help"]);
        // The list of commands is wrapped.
        assert!(!about.trim().is_empty() && line.starts_with(about.trim()), "{name}: {line}");
        assert_eq!(first_line(&["help", name]), line, "{name}");
        assert!(line.len() <= 100 && line.starts_with(|c: char| c.is_uppercase()), "{name}: {line}");
    }
}
