use super::*;
use crate::engine::{Moment, simulate, simulate_from};
use crate::record::{Options, RobotRow};
use crate::scenario::Overrides;
use std::ops::ControlFlow;

const TEXT: &str = "name = \"t\"\nticks = 12\ntick_s = 0.5\n[terrain]\ncell_m = 2\n\
    uniform = { width = 20, height = 20, classes = 1 }\n[robots]\nlist = [{ start = [3, 3], goal = [16, 3] }]\n";

fn scenario(rest: &str, overrides: &Overrides) -> Scenario {
    Scenario::parse(&format!("{TEXT}{rest}"), Path::new("t.toml"), overrides).expect("a good scenario")
}

fn of(rest: &str) -> Scenario {
    scenario(rest, &Overrides::default())
}

fn run(dir: &Path, scenario: &Scenario, ticks: &[u32]) -> Place {
    run_with(dir, scenario, ticks, Options::default())
}

fn run_with(dir: &Path, scenario: &Scenario, ticks: &[u32], options: Options) -> Place {
    let place = Place::new(dir.join("checkpoint"), scenario).expect("the name is free");
    let mut recorder = Recorder::new(dir.join("whole"), options).expect("it can be made");
    simulate(scenario, |moment: &Moment<'_>, robots: &mut dyn Iterator<Item = RobotRow>| {
        recorder.tick(moment.row, robots).expect("it can be written");
        if ticks.contains(&moment.row.tick) {
            let run = moment.run.expect("it is a run");
            place.write(moment.row.tick, 1.5, run, &mut recorder).expect("it can be written");
        }
        ControlFlow::Continue(())
    })
    .expect("robots can be placed");
    recorder.finish().expect("it can be written");
    place
}

#[test]
fn resumed_records_are_identical() {
    let dir = tempfile::tempdir().expect("a folder");
    let scenario = of("");
    let place = run(dir.path(), &scenario, &[5]);
    let mut from = Checkpoint::open(place.path(), &scenario).expect("it is whole");
    assert_eq!((from.tick(), from.wall_seconds()), (5, 1.5));
    let again = dir.path().join("again");
    let mut recorder = from.recorder(&again, true).expect("it can be made");
    simulate_from(&scenario, from.state(), &mut |moment, robots| {
        recorder.tick(moment.row, robots).expect("it can be written");
        ControlFlow::Continue(())
    })
    .expect("it resumes");
    let history = recorder.finish().expect("it can be written");
    assert_eq!(history.ticks(), 13);
    for name in ["trace.csv", "series.csv", "trace.schema.json", "series.schema.json"] {
        let [one, other] = ["whole", "again"].map(|folder| fs::read(dir.path().join(folder).join(name)).expect(name));
        assert!(one == other, "{name}");
    }
}

#[test]
fn a_run_without_traces_resumes_without_traces() {
    let scenario = of("");
    for (kept, wanted) in [(false, true), (false, false), (true, false)] {
        let dir = tempfile::tempdir().expect("a folder");
        let options = Options { keeps_robots: kept, ..Options::default() };
        let place = run_with(dir.path(), &scenario, &[5], options);
        let mut from = Checkpoint::open(place.path(), &scenario).expect("it is whole");
        assert_eq!(from.keeps_robots(), kept);
        let again = dir.path().join("again");
        let mut recorder = from.recorder(&again, wanted).expect("it can be made");
        simulate_from(&scenario, from.state(), &mut |moment, robots| {
            recorder.tick(moment.row, robots).expect("it can be written");
            ControlFlow::Continue(())
        })
        .expect("it resumes");
        recorder.finish().expect("it can be written");
        let mut names: Vec<_> =
            fs::read_dir(&again).expect("a folder").map(|entry| entry.expect("an entry").file_name()).collect();
        names.sort();
        assert_eq!(names, ["series.csv", "series.schema.json"], "{kept} {wanted}");
        let [one, other] = ["whole", "again"].map(|folder| fs::read(dir.path().join(folder).join("series.csv")));
        assert_eq!(one.expect("it is there"), other.expect("it is there"));
    }
}

#[test]
fn only_the_last_two_checkpoints_are_kept() {
    let dir = tempfile::tempdir().expect("a folder");
    let scenario = of("");
    let place = run(dir.path(), &scenario, &[2, 4, 6]);
    let tick = |path: &Path| Checkpoint::open(path, &scenario).expect("it is whole").tick();
    assert_eq!((tick(place.path()), tick(&dir.path().join("checkpoint.old"))), (6, 4));
    assert_eq!(fs::read_dir(dir.path()).expect("a folder").count(), 3);
}

#[cfg(unix)]
#[test]
fn only_the_owner_can_read_a_checkpoint() {
    use std::os::unix::fs::PermissionsExt as _;
    let dir = tempfile::tempdir().expect("a folder");
    let place = run(dir.path(), &of(""), &[2]);
    assert_eq!(fs::metadata(place.path()).expect("it is there").permissions().mode() & 0o777, 0o600);
}

fn refuses_damage(step: usize) {
    let dir = tempfile::tempdir().expect("a folder");
    let scenario = of("");
    let place = run(dir.path(), &scenario, &[1]);
    let whole = fs::read(place.path()).expect("it is there");
    let refused = |bytes: &[u8]| {
        fs::write(place.path(), bytes).expect("it can be written");
        let error = Checkpoint::open(place.path(), &scenario).expect_err("it is damaged").to_string();
        assert!(error.starts_with(place.path().to_str().expect("UTF-8")) && error.contains(": byte"), "{error}");
        error
    };
    for at in (0..whole.len()).step_by(step) {
        let mut bytes = whole.clone();
        bytes[at] ^= 1 << (at % 8);
        refused(&bytes);
        refused(&whole[..at]);
    }
    assert!(refused(&[&whole[..], b"x"].concat()).contains("there is more"));
    fs::write(dir.path().join("checkpoint.old"), &whole).expect("it can be written");
    assert!(refused(&whole[..whole.len() - 1]).contains("take "));
    fs::write(place.path(), &whole).expect("it can be written");
    Checkpoint::open(place.path(), &scenario).expect("it is whole");
}

/// 7 and 8 are coprime, so every bit of a byte is damaged somewhere.
#[test]
fn a_damaged_or_truncated_file_is_refused_with_its_byte() {
    refuses_damage(7);
}

#[test]
#[ignore = "each byte of the file: 8 s"]
fn damage_or_truncation_at_any_byte_is_refused() {
    refuses_damage(1);
}

#[test]
fn another_scenario_is_refused_but_a_longer_run_is_accepted() {
    let dir = tempfile::tempdir().expect("a folder");
    let scenario = of("");
    let place = run(dir.path(), &scenario, &[5]);
    let refused =
        |scenario: &Scenario| Checkpoint::open(place.path(), scenario).expect_err("it is of another one").to_string();
    for rest in ["[radio]\nloss = 0.1\n", "[authentication]\nkey = \"passphrase: of the tests\"\n"] {
        assert!(refused(&of(rest)).contains("`t` has changed"), "{rest}");
    }
    let with = |overrides: Overrides| self::scenario("", &overrides);
    assert!(refused(&with(Overrides { seed: Some(2), ..Overrides::default() })).contains("has changed"));
    let mut named = of("");
    named.name = "u".to_owned();
    named.seed = 7;
    assert!(refused(&named).contains("of the scenario `t`, not of `u`"));
    let ticks = |ticks| with(Overrides { ticks: Some(ticks), ..Overrides::default() });
    assert!(refused(&ticks(4)).contains("at tick 5"));
    Checkpoint::open(place.path(), &ticks(500)).expect("a longer run");
}

#[test]
fn another_version_of_the_program_is_refused() {
    let dir = tempfile::tempdir().expect("a folder");
    let scenario = of("");
    let place = run(dir.path(), &scenario, &[1]);
    let whole = fs::read(place.path()).expect("it is there");
    let mut other = whole.clone();
    other[MAGIC.len()] += 1;
    fs::write(place.path(), &other).expect("it can be written");
    let error = Checkpoint::open(place.path(), &scenario).expect_err("another format").to_string();
    assert!(error.contains("another version of the program"), "{error}");
    let mut other = whole[..FIRST as usize].to_vec();
    let mut head: Head = {
        let length = u64::from_le_bytes(whole[20..28].try_into().expect("8 bytes")) as usize;
        postcard::from_bytes(&whole[28..28 + length]).expect("a head")
    };
    let old = encoded(&head).len();
    head.version = "0.0.1".to_owned();
    let head = encoded(&head);
    write_part(&mut other, head.len() as u64, &mut head.as_slice()).expect("memory");
    other.extend_from_slice(&whole[28 + old + 4..]);
    fs::write(place.path(), &other).expect("it can be written");
    let error = Checkpoint::open(place.path(), &scenario).expect_err("another version").to_string();
    assert!(error.contains("version 0.0.1, this is"), "{error}");
}

#[test]
fn a_write_error_leaves_the_previous_checkpoint() {
    let dir = tempfile::tempdir().expect("a folder");
    let scenario = of("");
    let place = run(dir.path(), &scenario, &[3]);
    let before = fs::read(place.path()).expect("it is there");
    let mut recorder = Recorder::new(dir.path().join("again"), Options::default()).expect("it can be made");
    let mut failed = None;
    simulate(&scenario, |moment: &Moment<'_>, robots: &mut dyn Iterator<Item = RobotRow>| {
        recorder.tick(moment.row, robots).expect("it can be written");
        fs::remove_file(dir.path().join("again/series.csv")).expect("it is there");
        failed = place.write(moment.row.tick, 0.0, moment.run.expect("a run"), &mut recorder).err();
        ControlFlow::Break(())
    })
    .expect("robots can be placed");
    let error = failed.expect("its records are gone").to_string();
    assert!(error.starts_with("cannot write") && error.contains("checkpoint"), "{error}");
    assert!(fs::read(place.path()).expect("it is there") == before);
    assert_eq!(fs::read_dir(dir.path()).expect("a folder").count(), 3, "checkpoint, whole, again");
}

#[test]
fn foreign_files_and_other_runs_are_not_replaced() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("checkpoint");
    let (scenario, other) = (of(""), of("[radio]\nloss = 0.25\n"));
    let old = dir.path().join("checkpoint.old");
    let stale = dir.path().join("checkpoint.99999-0.tmp");
    fs::write(&stale, "keys").expect("room");
    run(dir.path(), &scenario, &[5, 6]);
    assert!(!stale.exists() && old.exists());
    Place::new(path.clone(), &scenario).expect("its own");
    let refused = |scenario: &Scenario, file: &Path| {
        let error = Place::new(path.clone(), scenario).expect_err("another's").to_string();
        assert!(error.starts_with(&*file.to_string_lossy()) && error.ends_with("choose another --out"), "{error}");
    };
    refused(&other, &path);
    for text in [&b""[..], b"a letter", &fs::read(&path).expect("a checkpoint")[..30]] {
        for file in [&path, &old] {
            let kept = fs::read(file).expect("a checkpoint");
            fs::write(file, text).expect("room");
            refused(&scenario, file);
            assert_eq!(fs::read(file).expect("a letter"), text);
            fs::write(file, kept).expect("room");
        }
    }
}
