use super::*;

fn names(dir: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(dir).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn read(path: PathBuf) -> String {
    fs::read_to_string(path).unwrap()
}

fn begun(target: &Path, files: &[&str], text: &str) -> Results {
    let results = Results::begin(target).unwrap();
    for file in files {
        fs::write(results.dir().join(file), text).unwrap();
    }
    results
}

fn run(target: &Path, files: &[&str], text: &str) {
    begun(target, files, text).finish().unwrap();
}

#[test]
fn old_results_stay_until_the_new_ones_are_complete_and_notes_are_kept() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("deep/run");
    run(&target, &["summary.json", "formation.png"], "one");
    fs::write(target.join("notes.txt"), "mine").unwrap();
    fs::create_dir(target.join("more")).unwrap();
    fs::write(target.join("more/thoughts"), "mine").unwrap();
    let second = begun(&target, &["summary.json", "trace.csv"], "two");
    assert_eq!(read(target.join("summary.json")), "one");
    second.finish().unwrap();
    assert_eq!(names(&target), [MARKER, "more", "notes.txt", "summary.json", "trace.csv"]);
    assert_eq!(read(target.join("summary.json")), "two");
    assert_eq!(read(target.join("more/thoughts")), "mine");
    assert_eq!(names(target.parent().unwrap()), ["run"], "nothing is left beside");
}

#[test]
fn a_failed_run_leaves_only_the_old_results_unless_kept() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("run");
    run(&target, &["summary.json"], "one");
    drop(begun(&target, &["summary.json"], "two"));
    assert_eq!(names(dir.path()), ["run"]);
    let kept = begun(&target, &["trace.csv"], "three").keep();
    assert_eq!(read(kept.join("trace.csv")), "three");
    assert_eq!(read(target.join("summary.json")), "one");
    run(&target, &["summary.json"], "four");
    assert_eq!(names(dir.path()), ["run"], "the next run clears away what was kept");
}

#[test]
fn results_are_complete_wherever_a_run_died() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("run");
    // It died before it moved any file.
    run(&target, &["summary.json"], "one");
    std::mem::forget(begun(&target, &["trace.csv"], "dead").marker.take());
    fs::write(target.join("notes.txt"), "mine").unwrap();
    fs::rename(&target, dir.path().join(".run.old-7-0")).unwrap();
    let next = Results::begin(&target).unwrap();
    assert_eq!(read(target.join("summary.json")), "one", "it is back");
    drop(next);
    fs::create_dir(dir.path().join(".run.old-8-0")).unwrap();
    let old = dir.path().join(".run.old-8-0");
    fs::write(old.join(MARKER), "made by\nsummary.json\ntrace.csv\n").unwrap();
    fs::write(old.join("summary.json"), "older").unwrap();
    fs::write(old.join("thoughts"), "mine").unwrap();
    fs::write(old.join("notes.txt"), "mine too").unwrap();
    drop(Results::begin(&target).unwrap());
    assert_eq!(read(target.join("summary.json")), "one");
    assert_eq!(read(target.join("thoughts")), "mine");
    assert_eq!(read(target.join("notes.txt.mine")), "mine too");
    assert!(!old.exists());
}

#[test]
fn concurrent_runs_leave_complete_results() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("run");
    let (one, two) = (begun(&target, &["summary.json", "a"], "one"), begun(&target, &["summary.json", "b"], "two"));
    assert_ne!(one.dir(), two.dir());
    one.finish().unwrap();
    assert_eq!(names(&target), [MARKER, "a", "summary.json"]);
    two.finish().unwrap();
    assert_eq!(names(&target), [MARKER, "b", "summary.json"]);
    std::thread::scope(|scope| {
        for _ in 0..8 {
            scope.spawn(|| run(&target, &["summary.json", "c"], "many"));
        }
    });
    assert_eq!(names(&target), [MARKER, "c", "summary.json"]);
    drop(Results::begin(&target).unwrap());
    assert_eq!(names(dir.path()), ["run"]);
}

#[test]
fn a_foreign_folder_is_extended_or_refused() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("mine");
    fs::create_dir(&target).unwrap();
    fs::write(target.join("novel.txt"), "chapter 1").unwrap();
    fs::write(target.join("unusual.csv"), "mine").unwrap();
    run(&target, &["summary.json", "unusual.csv"], "one");
    assert_eq!(names(&target), [MARKER, "novel.txt", "summary.json", "unusual.csv", "unusual.csv.mine"]);
    assert_eq!(read(target.join("unusual.csv.mine")), "mine");
    run(&target, &["summary.json"], "two");
    assert_eq!(names(&target), [MARKER, "novel.txt", "summary.json", "unusual.csv.mine"]);

    let strange = dir.path().join("strange");
    fs::create_dir(&strange).unwrap();
    fs::write(strange.join("trace.csv"), "mine").unwrap();
    let text = Results::begin(&strange).unwrap_err().to_string();
    assert!(text.contains("trace.csv") && text.contains("no run") && text.contains("choose another"), "{text}");
    assert_eq!(read(strange.join("trace.csv")), "mine");
    fs::write(strange.join("summary.json"), "{\"trace_hash\": 1}").unwrap();
    run(&strange, &["summary.json"], "new");
    assert_eq!(names(&strange), [MARKER, "summary.json"]);
}

#[test]
fn files_are_moved_one_by_one_if_the_folder_cannot_be_renamed() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("mount");
    run(&target, &["summary.json", "old.csv"], "one");
    fs::write(target.join("notes.txt"), "mine").unwrap();
    let mut next = begun(&target, &["summary.json", "new.csv"], "two");
    next.one_by_one = true;
    next.finish().unwrap();
    assert_eq!(names(&target), [MARKER, "new.csv", "notes.txt", "summary.json"]);
    assert_eq!(read(target.join("summary.json")), "two");
    assert_eq!(names(dir.path()), ["mount"]);
}

#[cfg(unix)]
#[test]
fn a_link_to_a_folder_stays_a_link() {
    let dir = tempfile::tempdir().unwrap();
    fs::create_dir(dir.path().join("disk")).unwrap();
    let link = dir.path().join("link");
    std::os::unix::fs::symlink("disk", &link).unwrap();
    run(&link, &["summary.json"], "one");
    assert!(link.is_symlink());
    assert_eq!(read(dir.path().join("disk/summary.json")), "one");
}
