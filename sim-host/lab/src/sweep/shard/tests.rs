use super::*;
use crate::sweep::aggregate;
use crate::sweep::merge::Merged;
use crate::sweep::plan::Changes;
use crate::sweep::plan::Plan;
use crate::sweep::row::checked;
use crate::sweep::run::perform;
use proptest::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use tempfile::TempDir;

const SCENARIO: &str = "name = 'duel'\nticks = 20\ntick_s = 0.1\n[plane]\nradius_m = 0.2\nmax_speed_mps = 1\n\
    [plane.robots.circle]\ncount = 4\nradius_m = 3\nnoise_m = 0.1\n";
const PLAN: &str =
    "name = 'p'\nscenario = 'duel.toml'\nseeds = 3\n[axes]\nradio.loss = [0, 0.25, 0.5]\nticks = [5, 10]\n";

fn folder() -> (TempDir, Plan) {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("duel.toml"), SCENARIO).expect("room");
    let plan = Plan::parse(PLAN, &folder.path().join("plan.toml"), &Changes::default())
        .unwrap_or_else(|what| panic!("{what}"));
    (folder, plan)
}

fn shard(text: &str) -> Shard {
    text.parse().unwrap_or_else(|what| panic!("{what}"))
}

fn done(
    plan: &Plan,
    shard: Shard,
    out: &Path,
    existing: Existing,
    may_continue: &(dyn Fn() -> bool + Sync),
) -> Result<Course, SweepError> {
    perform_shard(plan, shard, out, existing, |run| perform(plan, run, may_continue), |_, _| {})
}

fn perform_all(plan: &Plan, out: &Path, shards: &[&str], existing: Existing) -> Course {
    let mut last = Course::default();
    for text in shards {
        last = done(plan, shard(text), out, existing, &|| true).unwrap_or_else(|what| panic!("{what}"));
        assert_eq!(last.missing(), 0);
    }
    last
}

fn merged(plan: &Plan, out: &Path) -> String {
    let merged = Merged::read(plan, &files(out).expect("a folder")).unwrap_or_else(|what| panic!("{what}"));
    let merged = merged.whole(plan, out, "").unwrap_or_else(|what| panic!("{what}"));
    let aggregates = aggregate::text(plan, &aggregate::points(plan, &merged));
    merged.text(plan) + &aggregates
}

#[test]
fn any_number_of_shards_gives_identical_bytes() {
    let (folder, plan) = folder();
    let out = |name: &str| folder.path().join(name);
    perform_all(&plan, &out("1"), &["1/1"], Existing::Refuse);
    let whole = merged(&plan, &out("1"));
    assert_eq!(whole.lines().filter(|line| line.contains(",done,")).count(), 18);
    perform_all(&plan, &out("2"), &["2/2", "1/2"], Existing::Refuse);
    assert_eq!(merged(&plan, &out("2")), whole);
    perform_all(&plan, &out("7"), &["3/7", "1/7", "7/7", "2/7", "6/7", "5/7", "4/7"], Existing::Refuse);
    assert_eq!(merged(&plan, &out("7")), whole);
    let file = out("1").join("shards/1-of-1.csv");
    let text = fs::read_to_string(&file).expect("rows");
    let (header, rows) = text.split_once('\n').expect("lines");
    let backwards: Vec<&str> = [header].into_iter().chain(rows.lines().rev()).collect();
    fs::write(&file, backwards.join("\n") + "\n").expect("room");
    assert_eq!(merged(&plan, &out("1")), whole);
}

#[test]
fn truncated_file_is_completed() {
    let (folder, plan) = folder();
    let out = folder.path().join("out");
    perform_all(&plan, &out, &["1/1"], Existing::Refuse);
    let (file, whole) = (out.join("shards/1-of-1.csv"), merged(&plan, &out));
    let bytes = fs::read(&file).expect("rows");
    for cut in [0, 1, 30, bytes.len() / 2, bytes.len() - 1] {
        fs::write(&file, &bytes[..cut]).expect("room");
        let lines = bytes[..cut].iter().filter(|&&byte| byte == b'\n').count() as u64;
        let course = perform_all(&plan, &out, &["1/1"], Existing::Resume);
        assert_eq!((course.found, course.found + course.done), (lines.saturating_sub(1), 18), "{cut}");
        assert_eq!(course.torn > 0, cut > 0, "{cut}");
        assert_eq!(merged(&plan, &out), whole, "{cut}");
    }
}

#[test]
fn early_end_keeps_finished_runs_and_resume_makes_the_missing_ones() {
    let (folder, plan) = folder();
    let out = folder.path().join("out");
    let asked = AtomicU64::new(0);
    let may_continue = || asked.fetch_add(1, Ordering::Relaxed) < 40;
    let course = done(&plan, Shard::default(), &out, Existing::Refuse, &may_continue).expect("no error");
    assert!(course.done > 0 && course.missing() > 0, "{course:?}");
    let other = perform_all(&plan, &out, &["2/3"], Existing::Resume);
    let rest = perform_all(&plan, &out, &["1/1"], Existing::Resume);
    assert_eq!(rest.done, 18 - course.done - other.done);
    assert_eq!(rest.found, course.done + other.done);
    let again = perform_all(&plan, &out, &["1/1"], Existing::Resume);
    assert_eq!((again.found, again.done), (18, 0));
    let straight = folder.path().join("straight");
    perform_all(&plan, &straight, &["1/1"], Existing::Refuse);
    assert_eq!(merged(&plan, &out), merged(&plan, &straight));
}

#[test]
fn existing_rows_are_kept_unless_an_option_permits_it() {
    let (folder, plan) = folder();
    let out = folder.path().join("out");
    perform_all(&plan, &out, &["1/2"], Existing::Refuse);
    let refused = |text: &str| {
        let ended = done(&plan, shard(text), &out, Existing::Refuse, &|| true);
        ended.expect_err("rows are there").to_string()
    };
    for text in ["1/2", "1/1"] {
        let said = refused(text);
        assert!(
            said.ends_with("1-of-2.csv: it has 9 of 18 runs; --resume does the others, --restart forgets these"),
            "{said}"
        );
    }
    let text = PLAN.replace("0.25", "0.3");
    let changed = Plan::parse(&text, &folder.path().join("plan.toml"), &Changes::default()).expect("a plan");
    let before = fs::read(out.join("shards/1-of-2.csv")).expect("rows");
    for existing in [Existing::Refuse, Existing::Resume] {
        let ended = done(&changed, shard("1/2"), &out, existing, &|| true);
        let said = ended.expect_err("another plan").to_string();
        assert!(said.contains("1-of-2.csv:2: it is of another plan (") && said.contains("--restart"), "{said}");
    }
    assert_eq!(fs::read(out.join("shards/1-of-2.csv")).expect("rows"), before);
    let course = done(&changed, Shard::default(), &out, Existing::Forget, &|| true).expect("room");
    assert_eq!((course.found, course.done), (0, 18));
    assert_eq!(files(&out).expect("a folder").len(), 1);
}

#[test]
fn two_processes_cannot_share_a_file() {
    let (folder, plan) = folder();
    let out = folder.path().join("out");
    let (first, _) = Appended::open(&plan, &out, Shard::default(), Existing::Resume).expect("a file");
    let said = Appended::open(&plan, &out, Shard::default(), Existing::Resume).expect_err("it is taken").to_string();
    assert!(said.ends_with("1-of-1.csv: another process is at work on it; wait for it, or end it"), "{said}");
    drop(first);
    assert!(Appended::open(&plan, &out, Shard::default(), Existing::Resume).is_ok());
}

#[test]
fn inconsistent_rows_are_refused() {
    let (folder, plan) = folder();
    let out = folder.path().join("out");
    perform_all(&plan, &out, &["1/2", "2/2"], Existing::Refuse);
    let [one, two] = ["shards/1-of-2.csv", "shards/2-of-2.csv"].map(|name| out.join(name));
    let rows = fs::read_to_string(&one).expect("rows");
    let second = rows.lines().nth(1).expect("a row").to_owned();
    let number = second.split(',').next().expect("a number").to_owned();
    let read = |files: &[PathBuf]| Merged::read(&plan, files);
    // An identical row counts once.
    let whole = merged(&plan, &out);
    let doubled = read(&[one.clone(), two.clone(), one.clone()]).expect("the same rows");
    assert_eq!((doubled.doubles, doubled.rows.len()), (9, 18));
    fs::write(&one, format!("{rows}{second}\n")).expect("room");
    assert_eq!(merged(&plan, &out), whole);
    // In a merged file, a duplicate is an error.
    let file = out.join("rows.csv");
    let merged_text = read(&[one.clone(), two.clone()]).expect("rows").text(&plan);
    fs::write(&file, &merged_text).expect("room");
    assert!(Merged::reread(&plan, &file).is_ok());
    let first = merged_text.lines().nth(1).expect("a row");
    fs::write(&file, merged_text.replacen(first, &format!("{first}\n{first}"), 1)).expect("room");
    let said = Merged::reread(&plan, &file).expect_err("twice").to_string();
    assert!(said.contains("rows.csv:3: run 0 has two rows, or is out of order; merge the shards again"), "{said}");
    // A different row comes from another version of the program.
    let renewed = |line: &str| checked(line.rsplit_once(',').map_or("", |(cells, _)| cells));
    let other = renewed(&second.replacen(",done,", ",done,7", 1));
    fs::write(&one, format!("{rows}{other}\n")).expect("room");
    let said = read(&[one.clone(), two.clone()]).expect_err("they differ").to_string();
    assert!(
        said.contains(&format!("1-of-2.csv:11: run {number} has another row in")) && said.contains("--restart"),
        "{said}"
    );
    for (cells, what) in [
        ("1,2,", "it is not a row"),
        (&second.replacen(&format!("{number},"), "77,", 1), "the plan has no such run"),
        (&second.replacen(",done,", ",lost,", 1), "its outcome is unknown"),
        (&second.replacen(",done,", ",done,x", 1), "a figure is not a number"),
        (&second.replacen(",done,", ",done,1,", 1), "it has not as many figures as the plan"),
        (&second.replace(staya_console::VERSION, "9.9.9"), "it is of version 9.9.9"),
    ] {
        fs::write(&one, format!("{rows}{}\n", renewed(cells))).expect("room");
        let said = read(std::slice::from_ref(&one)).expect_err(what).to_string();
        assert!(said.contains(&format!("1-of-2.csv:11: {what}")), "{said}");
    }
    fs::write(&one, rows.replacen("run,", "runs,", 1)).expect("room");
    assert!(read(&[one]).expect_err("a header").to_string().contains("1-of-2.csv:1: its columns are not those"));
}

#[test]
fn a_damaged_byte_is_refused_or_harmless() {
    let (folder, plan) = folder();
    let out = folder.path().join("out");
    perform_all(&plan, &out, &["1/1"], Existing::Refuse);
    let (file, whole) = (out.join("shards/1-of-1.csv"), merged(&plan, &out));
    let bytes = fs::read(&file).expect("rows");
    proptest!(|(at in 0..bytes.len(), by in 1..=255_u8)| {
        let mut damaged = bytes.clone();
        damaged[at] ^= by;
        fs::write(&file, &damaged).expect("room");
        let read = Merged::read(&plan, std::slice::from_ref(&file));
        if at == bytes.len() - 1 {
            // The last line is incomplete, as after a kill.
            prop_assert_eq!(read.expect("rows").missing.len(), 1);
            perform_all(&plan, &out, &["1/1"], Existing::Resume);
            prop_assert_eq!(merged(&plan, &out), whole.clone());
        } else {
            let line = 1 + bytes[..at].iter().filter(|&&byte| byte == b'\n').count();
            let resumed = done(&plan, Shard::default(), &out, Existing::Resume, &|| true);
            for refusal in [read.map(drop), resumed.map(drop)] {
                let said = refusal.expect_err("a damaged byte").to_string();
                prop_assert!(said.starts_with(&format!("{}:{line}: ", file.display())), "{}", said);
                prop_assert!(said.contains("--resume"), "{}", said);
            }
            prop_assert_eq!(fs::read(&file).expect("rows"), damaged);
        }
    });
}

#[test]
fn damaged_row_is_made_again_after_its_line_was_removed() {
    let (folder, plan) = folder();
    let out = folder.path().join("out");
    perform_all(&plan, &out, &["1/1"], Existing::Refuse);
    let (file, whole) = (out.join("shards/1-of-1.csv"), merged(&plan, &out));
    let rows = fs::read_to_string(&file).expect("rows");
    let row = rows.lines().nth(4).expect("a row");
    let damaged = row.replacen(",done,", ",done,6553", 1);
    fs::write(&file, rows.replacen(row, &damaged, 1)).expect("room");
    let said = Merged::read(&plan, &files(&out).expect("a folder")).expect_err("a damaged row").to_string();
    let expected = "1-of-1.csv:5: its checksum is wrong; the file is damaged: remove this line, and `--resume` does \
        the run again";
    assert!(said.ends_with(expected), "{said}");
    fs::write(&file, rows.replacen(&format!("{row}\n"), "", 1)).expect("room");
    assert_eq!(perform_all(&plan, &out, &["1/1"], Existing::Resume).done, 1);
    assert_eq!(merged(&plan, &out), whole);
    // A merged file is written again instead.
    let merged = out.join("rows.csv");
    fs::write(&merged, rows.replacen(row, &damaged, 1)).expect("room");
    let said = Merged::reread(&plan, &merged).expect_err("a damaged row").to_string();
    assert!(said.ends_with("rows.csv:5: its checksum is wrong; merge the shards again: `staya sweep merge`"), "{said}");
}

#[test]
fn rows_without_checksums_are_refused() {
    let (folder, plan) = folder();
    let out = folder.path().join("out");
    perform_all(&plan, &out, &["1/1"], Existing::Refuse);
    let file = out.join("shards/1-of-1.csv");
    let rows = fs::read_to_string(&file).expect("rows");
    let older: Vec<&str> = rows.lines().map(|line| line.rsplit_once(',').map_or(line, |(cells, _)| cells)).collect();
    fs::write(&file, older.join("\n") + "\n").expect("room");
    let said = done(&plan, Shard::default(), &out, Existing::Resume, &|| true).expect_err("no checksums").to_string();
    let expected = "1-of-1.csv:1: its rows have no checksums, so an older program wrote them; choose another folder \
        with --out, or begin again with --restart";
    assert!(said.ends_with(expected), "{said}");
}

#[test]
fn missing_runs_are_named() {
    let (folder, plan) = folder();
    let out = folder.path().join("out");
    perform_all(&plan, &out, &["2/3"], Existing::Refuse);
    let merged = Merged::read(&plan, &files(&out).expect("a folder")).expect("rows");
    assert_eq!(merged.missing.first(), Some(&(0, 0)));
    assert_eq!(merged.missing.get(1), Some(&(2, 3)));
    let said = merged.whole(&plan, &out, "do them").expect_err("gaps").to_string();
    assert!(said.ends_with("12 of 18 runs are missing: 0, 2-3, 5-6, 8-9, 11-12, 14-15, 17; do them"), "{said}");
}

#[test]
fn impossible_run_has_a_row_and_is_tried_again() {
    let (folder, _) = folder();
    let (map, out) = (folder.path().join("land.map"), folder.path().join("out"));
    let land = "type octile\nheight 1\nwidth 3\nmap\n...\n";
    fs::write(&map, land).expect("room");
    let walk =
        "name = 'walk'\nticks = 5\n[terrain]\nfile = 'land.map'\n[[robots.list]]\nstart = [0, 0]\ngoal = [2, 0]\n";
    fs::write(folder.path().join("duel.toml"), walk).expect("room");
    let text = "name = 'p'\nscenario = 'duel.toml'\n[axes]\nradio.loss = [0, 1]\n";
    let plan = Plan::parse(text, &folder.path().join("plan.toml"), &Changes::default())
        .unwrap_or_else(|what| panic!("{what}"));
    fs::remove_file(&map).expect("mine");
    let course = perform_all(&plan, &out, &["1/1"], Existing::Refuse);
    let (count, why) = course.impossible.expect("no land");
    assert!(count == 2 && why.contains("land.map"), "{count} {why}");
    let merged = Merged::read(&plan, &files(&out).expect("a folder")).expect("rows");
    assert!(merged.rows.iter().all(|row| row.outcome == Outcome::Impossible && row.figures[0].0.is_none()));
    assert_eq!(aggregate::points(&plan, &merged)[0].figures[0], None);
    fs::write(&map, land).expect("room");
    let course = perform_all(&plan, &out, &["1/1"], Existing::Resume);
    assert_eq!((course.done, course.impossible), (2, None));
    let merged = Merged::read(&plan, &files(&out).expect("a folder")).expect("rows");
    assert!(merged.doubles == 0 && merged.rows.iter().all(|row| row.outcome == Outcome::Done));
}

#[test]
fn invalid_shards_are_refused() {
    for bad in ["", "3", "0/2", "3/2", "1/0", "a/b", "-1/2", "1/2/3", "1/ 2"] {
        assert!(bad.parse::<Shard>().is_err(), "{bad:?}");
    }
    assert_eq!("3/2".parse::<Shard>().expect_err("too many"), "there is no shard 3/2; give 1/2 to 2/2");
    for of in [1, 2, 7] {
        for run in 0..30 {
            let holders = (1..=of).filter(|index| shard(&format!("{index}/{of}")).has(run)).count();
            assert_eq!(holders, 1);
        }
    }
}
