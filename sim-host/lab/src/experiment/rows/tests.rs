use super::*;
use crate::flock::{self, closing::Closing};
use crate::route::{self, Land};
use crate::{boids, goals};
use staya_console::{Ended, Global, Stop};
use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering};

fn plan() -> route::Plan {
    route::Plan { lands: [5, 9].map(Land::Natural).to_vec(), runs: 4, size: 20, ..route::Plan::default() }
}

fn quiet() -> Global {
    Global { quiet: true, ..Global::default() }
}

fn command(out: &Path, keeping: &RowRetention) -> Result<Ended> {
    plan().command(out, keeping, &quiet(), &Stop::default())
}

fn text(out: &Path, name: &str) -> String {
    fs::read_to_string(out.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
fn rows_contain_parameters_and_figures() {
    let dir = tempfile::tempdir().expect("a folder");
    command(dir.path(), &RowRetention::default()).expect("done");
    let rows = text(dir.path(), ROWS);
    let lines: Vec<Vec<&str>> = rows.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(lines.len(), 1 + 8);
    assert!(lines.iter().all(|cells| cells.len() == lines[0].len()));
    let column = |name: &str| {
        let at = lines[0].iter().position(|cell| *cell == name).unwrap_or_else(|| panic!("{name}"));
        lines[1..].iter().map(|cells| cells[at]).collect::<Vec<_>>()
    };
    assert_eq!(column("obstacles"), ["5", "5", "5", "5", "9", "9", "9", "9"]);
    assert_eq!(column("side_cells"), ["20"; 8]);
    assert!(column("version").iter().all(|version| version.starts_with(env!("CARGO_PKG_VERSION"))));
    let runs = plan().carry_out(|_| true).expect("all runs").concat();
    let costs: Vec<String> = runs.iter().map(|run| run.walks[0].cost.to_string()).collect();
    assert_eq!(column("cost"), costs);
    let schema: serde_json::Value = serde_json::from_str(&text(dir.path(), "rows.schema.json")).expect("JSON");
    let names: Vec<&str> =
        schema["columns"].as_array().expect("columns").iter().filter_map(|c| c["name"].as_str()).collect();
    assert_eq!(names, lines[0]);
    assert_eq!(text(dir.path(), AGGREGATES).lines().count(), 1 + 2 * 8);
}

#[test]
fn resumed_and_sharded_runs_give_the_rows_of_a_single_run() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = |name: &str| dir.path().join(name);
    command(&out("whole"), &RowRetention::default()).expect("done");
    let whole = [ROWS, AGGREGATES].map(|name| text(&out("whole"), name));
    let same = |name: &str| assert_eq!([ROWS, AGGREGATES].map(|file| text(&out(name), file)), whole, "{name}");
    // Shards first, then the whole; then from a file with an incomplete line, as after a kill.
    for shard in ["2/3", "1/3", "3/3"] {
        let keeping = RowRetention { shard: shard.parse().expect("a shard"), ..RowRetention::default() };
        command(&out("shards"), &keeping).expect("done");
        assert!(!out("shards").join(ROWS).exists());
    }
    let resume = RowRetention { resume: true, ..RowRetention::default() };
    command(&out("shards"), &resume).expect("done");
    same("shards");
    fs::create_dir_all(out("cut/shards")).expect("room");
    let rows = text(&out("whole"), "shards/1-of-1.csv");
    fs::write(out("cut/shards/1-of-1.csv"), &rows[..rows.len() / 2]).expect("room");
    let refused = command(&out("cut"), &RowRetention::default()).expect_err("existing rows").to_string();
    assert!(refused.contains("--resume does the others, --restart forgets these"), "{refused}");
    command(&out("cut"), &resume).expect("done");
    same("cut");
    let rows = text(&out("cut"), "shards/1-of-1.csv");
    fs::write(out("cut/shards/1-of-1.csv"), rows.replacen(",done,", ",done,1", 1)).expect("room");
    let refused = command(&out("cut"), &resume).expect_err("a damaged row").to_string();
    assert!(
        refused.contains("1-of-1.csv:2: its checksum is wrong; the file is damaged: remove this line"),
        "{refused}"
    );
    command(&out("cut"), &RowRetention::default()).expect("done");
    same("cut");
    let other = route::Plan { parked: 1, ..plan() };
    let refused =
        other.command(&out("cut"), &resume, &quiet(), &Stop::default()).expect_err("another plan").to_string();
    assert!(refused.contains("it is of another plan"), "{refused}");
}

#[test]
fn early_end_keeps_finished_runs() {
    let dir = tempfile::tempdir().expect("a folder");
    let (asked, keeping, plan) = (AtomicUsize::new(0), RowRetention::default(), plan());
    let may_continue = |_: usize| asked.fetch_add(1, Ordering::Relaxed) < 6;
    let jobs = Jobs::new(&plan, &may_continue, Some((dir.path(), &keeping)));
    let some = plan.perform(&jobs).expect("no error");
    let course = jobs.course().expect("rows are kept");
    assert!(course.done > 0 && course.missing() > 0, "{course:?}");
    assert!(some.concat().len() as u64 <= course.done);
    let all = plan.carry_out(|_| true).expect("no error");
    for (some, all) in some.iter().zip(&all) {
        assert_eq!(some[..], all[..some.len()]);
    }
    let (always, resume) = (|_: usize| true, RowRetention { resume: true, ..RowRetention::default() });
    let jobs = Jobs::new(&plan, &always, Some((dir.path(), &resume)));
    assert_eq!(plan.perform(&jobs).expect("no error"), all);
    assert_eq!(jobs.course().expect("rows").found, course.done);
}

fn check<E: Experiment>(plan: &E, other: &E) {
    plan.check().unwrap_or_else(|what| panic!("{}: {what}", E::NAME));
    let sheet = Sheet::new(plan);
    assert_ne!(sheet.fingerprint(), Sheet::new(other).fingerprint(), "{}", E::NAME);
    let names: Vec<String> = sheet.parameters().into_iter().chain(Design::figures(&sheet)).collect();
    let mut unique = names.clone();
    unique.sort_unstable();
    unique.dedup();
    assert_eq!(unique.len(), names.len(), "{}: {names:?}", E::NAME);
    let is_name = |name: &String| name.chars().all(|c| c.is_ascii_alphanumeric() || "._".contains(c));
    assert!(names.iter().all(is_name), "{}: {names:?}", E::NAME);
    assert_eq!(sheet.runs(), plan.total() as u64);
    for run in [0, sheet.runs() - 1] {
        assert_eq!(sheet.values(run).len(), sheet.parameters().len());
    }
    let mut points: Vec<Vec<String>> =
        (0..plan.points() as u64).map(|p| sheet.values(p * sheet.runs_per_point())).collect();
    points.sort_unstable();
    assert!(points.windows(2).all(|pair| pair[0] != pair[1]), "{}", E::NAME);
    let (point, run) = sheet.place(sheet.runs() - 1);
    let mut blank = plan.blank(point, run);
    let mut number = 0.0;
    blank.figures(&mut |_, _, cell| {
        number += 1.0;
        assert!(cell.set(Some(number)) || cell.set(Some(1.0)));
    });
    let row = sheet.row(0, &mut blank);
    let mut read = plan.blank(point, run);
    assert!(sheet.read(&row, &mut read), "{}", E::NAME);
    assert_eq!(sheet.row(0, &mut read), row, "{}", E::NAME);
}

#[test]
fn rows_of_all_experiments_are_valid() {
    check(&route::Plan::default(), &route::Plan { parked: 3, ..route::Plan::default() });
    check(&goals::Plan::default(), &goals::Plan { k3: vec![1.0], ..goals::Plan::default() });
    check(&flock::Plan::default(), &flock::Plan { loss: 0.1, ..flock::Plan::default() });
    check(&Closing::default(), &Closing { step_s: 0.02, ..Closing::default() });
    check(&boids::Plan::default(), &boids::Plan { steps: 3, ..boids::Plan::default() });
}

#[test]
fn cells_accept_only_values_of_their_type() {
    let mut count = 3_usize;
    assert!(!count.set(None) && !count.set(Some(-1.0)) && !count.set(Some(0.5)) && count.set(Some(4.0)));
    assert_eq!(count, 4);
    let mut truth = false;
    assert!(truth.set(Some(1.0)) && truth && !truth.set(Some(2.0)) && !truth.set(None));
    let mut perhaps = Some(1_u32);
    assert!(perhaps.set(None) && perhaps.is_none() && !perhaps.set(Some(1.5)) && perhaps.set(Some(2.0)));
    assert_eq!(perhaps, Some(2));
}
