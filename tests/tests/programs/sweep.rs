//! `staya sweep` at the command line: identical rows after any kill and for any number of shards.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;

const SCENARIO: &str = "name = 'swap'\nticks = 200\ntick_s = 0.05\n[radio]\nrange_m = 5\n[plane]\nradius_m = 0.15\n\
    max_speed_mps = 0.5\n[plane.robots.circle]\ncount = 12\nradius_m = 2\nnoise_m = 0.05\n";
const PLAN: &str = "name = 'p'\nscenario = 'swap.toml'\nseeds = 4\nmeasures = ['arrived', 'least_gap_m', 'packets.lost']\n\
    [axes]\nradio.loss = [0, 0.2, 0.4, 0.6]\nradio.delay_ms = [0, 50]\n";
const RUNS: usize = 32;

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        let this = Self(tempfile::tempdir().expect("a folder"));
        fs::write(this.path("swap.toml"), SCENARIO).expect("room");
        fs::write(this.path("plan.toml"), PLAN).expect("room");
        this
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn sweep(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(staya_tests::program());
        command.arg("sweep").args(arguments).arg("--quiet").current_dir(self.0.path()).stdin(Stdio::null());
        command
    }

    fn done(&self, arguments: &[&str]) -> String {
        let Output { status, stdout, stderr } = self.sweep(arguments).output().expect("staya starts");
        assert!(status.success(), "{arguments:?}: {}", text(&stderr));
        text(&stdout)
    }

    fn refused(&self, arguments: &[&str], code: i32) -> String {
        let Output { status, stderr, .. } = self.sweep(arguments).output().expect("staya starts");
        assert_eq!(status.code(), Some(code), "{}", text(&stderr));
        text(&stderr)
    }

    fn results(&self, out: &str) -> Vec<Vec<u8>> {
        let out = self.path(out);
        let mut pictures: Vec<_> =
            fs::read_dir(out.join("plots")).expect("pictures").flatten().map(|e| e.path()).collect();
        pictures.sort();
        assert_eq!(pictures.len(), 6);
        let files = [out.join("rows.csv"), out.join("rows.schema.json"), out.join("aggregates.csv")]
            .into_iter()
            .chain(pictures);
        files.map(|file| fs::read(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()))).collect()
    }

    fn rows(&self, file: &str) -> usize {
        let bytes = fs::read(self.path(file)).unwrap_or_default();
        bytes.iter().filter(|&&byte| byte == b'\n').count().saturating_sub(1)
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn any_number_of_shards_gives_identical_bytes() {
    let folder = Folder::new();
    let said = folder.done(&["plan.toml", "--out", "alone"]);
    assert!(
        said.contains("32 of 32 runs") && said.contains("plots/arrived-over-radio.loss-and-radio.delay_ms.svg"),
        "{said}"
    );
    let alone = folder.results("alone");
    folder.done(&["plan.toml", "--out", "one-thread", "--threads", "1"]);
    assert_eq!(folder.results("one-thread"), alone);
    for shards in [2, 7] {
        let out = format!("of-{shards}");
        for index in (1..=shards).rev() {
            let shard = format!("{index}/{shards}");
            folder.done(&["plan.toml", "--out", &out, "--shard", &shard]);
            if index == 2 {
                let said = folder.refused(&["merge", "plan.toml", "--out", &out], 1);
                assert!(
                    said.contains(&format!("{out}/shards: ")) && said.contains("of 32 runs are missing: 0, "),
                    "{said}"
                );
                assert!(said.contains(&format!("`staya sweep plan.toml --out {out} --resume` does them")), "{said}");
            }
        }
        let json: Value =
            serde_json::from_str(&folder.done(&["merge", "plan.toml", "--out", &out, "--json"])).expect("JSON");
        assert_eq!((&json["runs"], json["points"].as_array().map(Vec::len)), (&32.into(), Some(8)));
        assert_eq!(folder.results(&out), alone);
    }
    let files: Vec<String> = (1..=7).map(|index| format!("of-7/shards/{index}-of-7.csv")).collect();
    let arguments: Vec<&str> =
        ["merge", "plan.toml", "--out", "named"].into_iter().chain(files.iter().map(String::as_str)).collect();
    folder.done(&arguments);
    assert_eq!(folder.results("named"), alone);
}

#[cfg(unix)]
#[test]
fn a_killed_process_loses_only_the_runs_in_progress() {
    let folder = Folder::new();
    folder.done(&["plan.toml", "--out", "alone"]);
    let alone = folder.results("alone");
    for (signal, ends) in [("-KILL", None), ("-INT", Some(130)), ("-TERM", Some(130))] {
        let out = format!("out{signal}");
        let file = format!("{out}/shards/1-of-1.csv");
        let arguments = ["plan.toml", "--out", &out, "--resume"];
        let mut child = folder.sweep(&arguments).stdout(Stdio::null()).spawn().expect("staya starts");
        let since = Instant::now();
        while folder.rows(&file) < 5 && since.elapsed() < Duration::from_secs(30) {
            sleep(Duration::from_millis(1));
        }
        let id = child.id().to_string();
        assert!(Command::new("kill").args([signal, &id]).status().expect("kill").success());
        let status = child.wait().expect("it ends");
        let rows = folder.rows(&file);
        assert!((5..RUNS).contains(&rows), "{signal}: {rows} rows");
        assert_eq!(status.code(), ends, "{signal}");
        let json: Value = serde_json::from_str(&folder.done(&[&arguments[..], &["--json"]].concat())).expect("JSON");
        assert_eq!((&json["done_before"], &json["done_now"]), (&rows.into(), &(RUNS - rows).into()), "{signal}");
        assert_eq!(folder.results(&out), alone, "{signal}");
    }
}

#[test]
fn invalid_plans_are_refused_with_place_and_remedy() {
    let folder = Folder::new();
    let said = folder.refused(&["none.toml"], 1);
    assert!(said.contains("none.toml: ") && said.contains("check the name"), "{said}");
    for shard in ["0/2", "3/2", "x"] {
        assert!(folder.refused(&["plan.toml", "--shard", shard], 2).contains("--shard"), "{shard}");
    }
    assert!(folder.refused(&[], 2).contains("<PLAN>"));
    folder.done(&["plan.toml", "--out", "out", "--shard", "1/4"]);
    let said = folder.refused(&["plan.toml", "--out", "out"], 1);
    assert!(
        said.contains("1-of-4.csv: it has 8 of 32 runs; --resume does the others, --restart forgets these"),
        "{said}"
    );
    let said = folder.refused(&["plot", "plan.toml", "--out", "out", "--figure", "arrived", "--over", "radio.los"], 1);
    assert!(
        said.contains("--over: radio.los is not an axis of the plan; give one of radio.loss, radio.delay_ms"),
        "{said}"
    );
    let said = folder.refused(&["plot", "plan.toml", "--out", "out", "--figure", "arrived", "--over", "radio.loss"], 1);
    assert!(said.contains("rows.csv: "), "{said}");
    for (arguments, what) in [
        (["slurm", "plan.toml", "--tasks", "0"], "--tasks: 0 tasks; give 1 to 1000"),
        (["slurm", "plan.toml", "--tasks", "33"], "--tasks: 33 tasks; the plan has 32 runs; give at most as many"),
        (["parallel", "plan.toml", "--tasks", "33"], "--tasks: 33 tasks; the plan has 32 runs"),
    ] {
        let said = folder.refused(&arguments, 1);
        assert!(said.contains(what), "{said}");
    }
    let before = fs::read(folder.path("out/shards/1-of-4.csv")).expect("rows");
    fs::write(folder.path("plan.toml"), PLAN.replace("0.2", "0.3")).expect("room");
    for arguments in [&["plan.toml", "--out", "out", "--resume"][..], &["merge", "plan.toml", "--out", "out"]] {
        let said = folder.refused(arguments, 1);
        assert!(said.contains("1-of-4.csv:2: it is of another plan (") && said.contains("--restart"), "{said}");
    }
    assert_eq!(fs::read(folder.path("out/shards/1-of-4.csv")).expect("rows"), before);
    let said = folder.done(&["plan.toml", "--out", "out", "--restart"]);
    assert!(said.contains("32 of 32 runs"), "{said}");
    folder.done(&["plot", "plan.toml", "--out", "out", "--figure", "least_gap_m", "--over", "radio.loss"]);
    assert!(folder.path("out/plots/least_gap_m-over-radio.loss.png").is_file());
}

#[test]
fn a_dry_run_prints_the_cost_and_writes_nothing() {
    let folder = Folder::new();
    let said = folder.done(&["plan.toml", "--dry-run"]);
    for part in ["radio.loss: 4 values, 0, 0.2, 0.4, 0.6", "32 runs: 8 points", "processor time", "of rows"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let json: Value = serde_json::from_str(&folder.done(&["plan.toml", "--dry-run", "--json"])).expect("JSON");
    assert_eq!((&json["runs"], &json["tried"]), (&32.into(), &3.into()));
    assert!(json["seconds"].as_f64().is_some_and(|s| s > 0.0) && json["bytes"].as_u64().is_some_and(|b| b > 2000));
    assert!(!folder.path("out").exists());
}

#[test]
fn scripts_contain_their_commands() {
    let folder = Folder::new();
    let place = folder.0.path().canonicalize().expect("there").display().to_string();
    let slurm =
        folder.done(&["slurm", "plan.toml", "--tasks", "8", "--at-once", "3", "--minutes", "20", "--program", "staya"]);
    for line in [
        "#!/bin/sh",
        "#SBATCH --array=1-8%3",
        "#SBATCH --cpus-per-task=1",
        "#SBATCH --requeue",
        "#SBATCH --time=20",
        &format!(
            "exec staya sweep {place}/plan.toml --out {place}/out/sweeps/p --shard \"$SLURM_ARRAY_TASK_ID\"/8 --threads 1 --resume --quiet"
        ),
    ] {
        assert!(slurm.lines().any(|own| own == line), "{line}\n{slurm}");
    }
    let hosts = ["--host", "8/alpha", "--host", ":"];
    let parallel =
        folder.done(&[&["parallel", "plan.toml", "--tasks", "8", "--program", "staya"], &hosts[..]].concat());
    assert!(parallel.contains("--sshlogin 8/alpha --sshlogin : ") && parallel.contains("--shard {}/8"), "{parallel}");
    assert!(
        parallel.ends_with(&format!("staya sweep merge {place}/plan.toml --out {place}/out/sweeps/p\n")),
        "{parallel}"
    );
}

#[test]
fn included_plans_are_valid() {
    let plans = Path::new(env!("CARGO_MANIFEST_DIR")).join("../sweeps");
    let mut count = 0;
    for entry in fs::read_dir(plans).expect("plans").flatten() {
        if entry.path().extension().is_some_and(|extension| extension == "toml") {
            let plan = entry.path().display().to_string();
            let said = Folder::new().done(&[&plan, "--dry-run"]);
            assert!(said.contains(" runs: "), "{plan}: {said}");
            count += 1;
        }
    }
    assert!(count >= 3, "{count} plans");
}
