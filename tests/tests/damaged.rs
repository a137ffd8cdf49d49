//! A reader refuses damaged files in words of the file; an accepted file runs.

mod fields;

use rayon::prelude::*;
use staya_lab::sweep::Plan;
use staya_lab::sweep::merge::Merged;
use staya_lab::sweep::run::perform;
use staya_lab::sweep::shard::{Existing, Shard, files, perform_shard};
use staya_mav::companion::Config;
use staya_record::recording::{Reader, RunRecorder};
use staya_sim::checkpoint::{Checkpoint, Place};
use staya_sim::engine::{Moment, simulate, simulate_from};
use staya_sim::record::{Options, Recorder, RobotRow};
use staya_sim::scenario::{Overrides, Scenario};
use staya_sim::terrain::Terrain;
use staya_sim::terrain::movingai::load_scen;
use staya_tests::mutants::{mutant, type_name};
use staya_tests::root;
use std::fs;
use std::io::Cursor;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Reads a mutant of the file `path`.
type Read<'a> = dyn Fn(&Path, &[u8]) -> Result<(), String> + Sync + 'a;

/// Files of a folder with one of these endings, without some names.
fn seeds(folder: &str, endings: &[&str], without: &[&str]) -> Vec<PathBuf> {
    let files = fs::read_dir(root().join(folder)).expect(folder).map(|file| file.expect("a file").path());
    let is_of = |path: &PathBuf| path.extension().is_some_and(|is| endings.iter().any(|ending| is == *ending));
    let is_left_out = |path: &PathBuf| path.file_stem().is_some_and(|stem| without.iter().any(|name| stem == *name));
    let mut files: Vec<_> = files.filter(|path| is_of(path) && !is_left_out(path)).collect();
    files.sort();
    assert!(!files.is_empty(), "{folder}");
    files
}

/// Reads `count` mutants of `files` and checks what was said. At least the share `refused` of them
/// must be refused.
fn check(kind: &str, files: &[PathBuf], count: u32, refused: f64, read: &Read<'_>) {
    let whole: Vec<_> = files.iter().map(|path| fs::read(path).expect("a file")).collect();
    for (path, bytes) in files.iter().zip(&whole) {
        read(path, bytes).unwrap_or_else(|error| panic!("{kind}: {error}"));
    }
    let errors: Vec<_> = (0..count)
        .into_par_iter()
        .filter_map(|number| {
            let at = number as usize % files.len();
            let bytes = mutant(&whole[at], at as u32, number);
            Some((read(&files[at], &bytes).err()?, bytes))
        })
        .collect();
    let is_wrong = |(error, bytes): &&(String, Vec<u8>)| {
        let words: Vec<_> = error.split_whitespace().filter(|word| !word.contains('/')).collect();
        let words = words.join(" ");
        let name = type_name(&words).filter(|name| !String::from_utf8_lossy(bytes).contains(name));
        name.is_some() || !error.contains("; ")
    };
    let wrong: Vec<_> = errors.iter().filter(is_wrong).map(|(error, _)| &**error).collect();
    println!("{kind}: {} of {count} mutants refused", errors.len());
    let first = &wrong[..wrong.len().min(20)];
    assert!(wrong.is_empty(), "{kind}, {} of {}:\n{}", wrong.len(), errors.len(), first.join("\n"));
    assert!(errors.len() as f64 >= refused * f64::from(count), "{kind}: {} of {count} refused", errors.len());
    for (path, bytes) in files.iter().zip(&whole) {
        assert!(fs::read(path).expect("a file") == *bytes, "{}", path.display());
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn ticks(ticks: u32) -> Overrides {
    Overrides { seed: None, ticks: Some(ticks) }
}

/// An accepted scenario is run, unless its mutant is large.
fn scenarios(count: u32) {
    let large = ["million", "scale", "scale-plane", "scale-plane-small", "scale-small"];
    check("scenarios", &seeds("scenarios", &["toml"], &large), count, 0.3, &|path, bytes| {
        let scenario = Scenario::parse(&text(bytes), path, &ticks(3)).map_err(|error| error.to_string())?;
        if scenario.robots.len() > 200 || scenario.land.terrain.cells().len() > 1_000_000 {
            return Ok(());
        }
        let run = simulate(&scenario, |_, _| ControlFlow::Continue(()));
        run.map(drop).map_err(|error| format!("{error}; change their starts"))
    });
}

/// A mutant is read in a folder with the other file of its map.
fn maps(count: u32) {
    let read = |path: &Path, bytes: &[u8]| {
        let folder = TempDir::new().expect("a folder");
        let other = if path.extension().is_some_and(|is| is == "pgm") { "yaml" } else { "pgm" };
        let of_pair = |ending: &str| Path::new("maps/office").with_extension(ending);
        let [from, pair] =
            [root().join(of_pair(other)), folder.path().join(of_pair(other).file_name().expect("a name"))];
        fs::copy(from, &pair).expect("a copy");
        let file = folder.path().join(path.file_name().expect("a name"));
        fs::write(&file, bytes).expect("room");
        let read = match path.extension().and_then(|is| is.to_str()) {
            Some("scen") => load_scen(&file).map(drop),
            Some("pgm") => Terrain::load(&pair).map(drop),
            _ => Terrain::load(&file).map(drop),
        };
        assert!(fs::read(&file).expect("the mutant") == bytes);
        read.map_err(|error| error.to_string())
    };
    for (ending, refused) in [("map", 0.3), ("asc", 0.2), ("yaml", 0.2), ("pgm", 0.05), ("scen", 0.2)] {
        check(ending, &seeds("maps", &[ending], &[]), count, refused, &read);
    }
}

/// The first run of an accepted plan begins.
fn plans(count: u32) {
    check("plans", &seeds("sweeps", &["toml"], &[]), count, 0.3, &|path, bytes| {
        let plan = Plan::parse(&text(bytes), path, &Default::default()).map_err(|error| error.to_string())?;
        assert!(plan.runs() > 0 && perform(&plan, 0, || false).is_none_or(|run| run.refusal.is_some()));
        Ok(())
    });
}

fn companions(count: u32) {
    check(
        "companions",
        &seeds("companions", &["toml"], &["crossing", "formation", "one-rover"]),
        count,
        0.3,
        &|path, bytes| Config::parse(&text(bytes), path).map(drop).map_err(|error| error.to_string()),
    );
}

/// Everything in an accepted recording is read.
fn recordings(count: u32) {
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("run.staya");
    let scenario = staya_tests::scenario("six-discs", Some(60));
    let mut recorder = RunRecorder::new(Vec::new(), &path, &scenario, 1).expect("memory");
    let record = |moment: &Moment<'_>, rows: &mut dyn Iterator<Item = RobotRow>| {
        recorder.tick(moment, rows).expect("memory");
        ControlFlow::Continue(())
    };
    simulate(&scenario, record).expect("free starts");
    fs::write(&path, recorder.finish(&"a summary").expect("memory")).expect("room");
    check("recordings", &[path], count, 0.3, &|path, bytes| {
        let read = || {
            let mut reader = Reader::new(Cursor::new(bytes), path)?;
            reader.scene()?;
            for tick in reader.ticks().map_or(0..0, |(first, last)| first..last.min(first + 100)) {
                reader.frame(tick)?;
            }
            reader.orders()?;
            reader.summary()
        };
        read().map(drop).map_err(|error| error.to_string())
    });
}

/// Checkpoints, and their states behind valid checksums. A run continues from an accepted one.
fn checkpoints(count: u32) {
    for name in ["six-discs", "six-robots"] {
        let folder = TempDir::new().expect("a folder");
        let mut scenario = staya_tests::scenario(name, Some(12));
        scenario.radio.delay_ms = 700.0;
        let place = Place::new(folder.path().join("checkpoint"), &scenario).expect("a free name");
        let mut recorder = Recorder::new(folder.path().join("results"), Options::default()).expect("room");
        let save = |moment: &Moment<'_>, rows: &mut dyn Iterator<Item = RobotRow>| {
            recorder.tick(moment.row, rows).expect("room");
            if moment.row.tick == 9 {
                place.write(9, 0.0, moment.run.expect("a run"), &mut recorder).expect("room");
            }
            ControlFlow::Continue(())
        };
        simulate(&scenario, save).expect("free starts");
        let go_on = |state: &[u8]| simulate_from(&scenario, state, &mut |_, _| ControlFlow::Continue(()));
        let file = place.path().to_owned();
        let state = folder.path().join("state");
        fs::write(&state, Checkpoint::open(&file, &scenario).expect("a checkpoint").state()).expect("room");
        check("checkpoints", &[file], count, 0.9, &|path, bytes| {
            let own = TempDir::new().expect("a folder");
            let file = own.path().join(path.file_name().expect("a name"));
            fs::write(&file, bytes).expect("room");
            let checkpoint = Checkpoint::open(&file, &scenario).map_err(|error| error.to_string())?;
            go_on(checkpoint.state()).map(drop).map_err(|error| error.to_string())
        });
        check("states", &[state], count, 0.1, &|_, bytes| go_on(bytes).map(drop).map_err(|error| error.to_string()));
    }
}

/// Rows of a sweep.
fn rows(count: u32) {
    let folder = TempDir::new().expect("a folder");
    let plan = fs::read_to_string(root().join("sweeps/swap-loss.toml")).expect("a plan");
    let plan = plan.replace("seeds = 5", "seeds = 1");
    let plan = Plan::parse(&plan, &root().join("sweeps/small.toml"), &Default::default()).expect("a plan");
    let job = |number| perform(&plan, number, || true);
    perform_shard(&plan, Shard::default(), folder.path(), Existing::Refuse, job, |_, _| {}).expect("rows");
    let whole = files(folder.path()).expect("a folder");
    check("rows", &whole, count, 0.3, &|path, bytes| {
        let own = TempDir::new().expect("a folder");
        let file = own.path().join(path.file_name().expect("a name"));
        fs::write(&file, bytes).expect("room");
        Merged::read(&plan, &[file]).map(drop).map_err(|error| error.to_string())
    });
}

const KINDS: [fn(u32); 7] = [scenarios, maps, plans, companions, recordings, checkpoints, rows];

#[test]
fn damaged_files_are_refused_in_their_own_words() {
    KINDS.iter().for_each(|kind| kind(60));
}

#[test]
#[ignore = "10,000 files of each kind: minutes"]
fn ten_thousand_damaged_files_of_each_kind() {
    KINDS.iter().for_each(|kind| kind(10_000));
}
