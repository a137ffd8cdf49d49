//! Runs random scenes in which radios fail, and counts robots that overlap or do not arrive.

use anyhow::{Context as _, Result, bail};
use clap::Parser;
use rayon::prelude::*;
use staya_sim::scenario::{Setting, with_settings};
use staya_tests::scenes::{HEADER, Kind, PERIOD, Row, Scene, UNSEEN, comparison, failures, run, table};
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Runs random scenes in which radios fail, and counts robots that overlap or do not arrive.
///
/// Seeds 0 to 499 may be looked at while a controller is written. Seeds 1000 to 1499 have scenes of
/// the same kinds; run them once, when nothing is to be changed any more.
#[derive(Debug, Parser)]
struct Options {
    /// Seeds of the scenes, from A up to and without B; or a single one.
    #[arg(long, value_name = "A..B", default_value = "0..500", value_parser = seeds)]
    seeds: Range<u32>,
    /// Only scenes of this kind, such as fades; may be repeated.
    #[arg(long = "kind", value_name = "KIND")]
    kinds: Vec<Kind>,
    /// Set a scenario field in all scenes, for example radio.loss=0.3; may be repeated.
    #[arg(long = "set", value_name = "FIELD=VALUE")]
    settings: Vec<Setting>,
    /// Write the scenarios into this folder instead of running them.
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["out", "compare", "list"])]
    write: Option<PathBuf>,
    /// Write one row per scene into this file.
    #[arg(long, value_name = "CSV")]
    out: Option<PathBuf>,
    /// Compare with a file that --out has written.
    #[arg(long, value_name = "CSV")]
    compare: Option<PathBuf>,
    /// List the scenes in which robots overlap or are missing.
    #[arg(long)]
    list: bool,
}

fn seeds(text: &str) -> Result<Range<u32>, String> {
    let number = |text: &str| text.trim().parse::<u32>().ok();
    let range = match text.split_once("..") {
        Some((from, to)) => number(from).zip(number(to)).map(|(from, to)| from..to),
        None => number(text).and_then(|seed| Some(seed..seed.checked_add(1)?)),
    };
    let range = range.filter(|range| !range.is_empty());
    range.ok_or_else(|| format!("{text:?} is not a range of seeds; give A..B with A < B, such as 0..{PERIOD}"))
}

fn main() -> ExitCode {
    match all(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("scenes: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn all(options: &Options) -> Result<()> {
    let is_wanted = |seed: &u32| options.kinds.is_empty() || options.kinds.contains(&Kind::of(*seed));
    let mut seeds: Vec<u32> = options.seeds.clone().filter(is_wanted).collect();
    if seeds.is_empty() {
        bail!("no seed from {} to {} has this kind; give more seeds", options.seeds.start, options.seeds.end - 1);
    }
    if let Some(folder) = &options.write {
        return write(&seeds, folder, &options.settings);
    }
    // The longest runs first, so that no processor ends alone.
    seeds.sort_by_key(|seed| Kind::of(*seed) != Kind::Many);
    let earlier = options.compare.as_deref().map(read).transpose()?;
    if seeds.iter().any(|seed| *seed >= UNSEEN) {
        eprintln!("scenes: seeds from {UNSEEN} are unseen ones; change nothing because of them");
    }
    let begin = Instant::now();
    let done = AtomicUsize::new(0);
    let rows: Result<Vec<Row>> = seeds
        .par_iter()
        .with_max_len(1)
        .map(|&seed| {
            let row = run(&Scene::new(seed), &options.settings);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            if done.is_multiple_of(100) {
                eprintln!("scenes: {done} of {}, {:.0} s", seeds.len(), begin.elapsed().as_secs_f64());
            }
            row
        })
        .collect();
    let mut rows = rows?;
    rows.sort_by_key(|row| row.seed);
    if let Some(path) = &options.out {
        let lines: String = rows.iter().map(|row| format!("{row}\n")).collect();
        fs::write(path, format!("{HEADER}\n{lines}")).with_context(|| path.display().to_string())?;
    }
    if options.list {
        println!("{}", failures(&rows));
    }
    print!("{}", table(&rows));
    if let Some(earlier) = earlier {
        print!("\n{}", comparison(&rows, &earlier));
    }
    eprintln!("scenes: {} runs in {:.0} s", rows.len(), begin.elapsed().as_secs_f64());
    Ok(())
}

fn write(seeds: &[u32], folder: &Path, settings: &[Setting]) -> Result<()> {
    fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    for &seed in seeds {
        let scene = Scene::new(seed);
        let path = folder.join(format!("{}-{seed:04}.toml", scene.kind));
        let text = if settings.is_empty() { scene.text } else { with_settings(&scene.text, &path, settings)? };
        fs::write(&path, text).with_context(|| path.display().to_string())?;
    }
    println!("{} scenarios in {}", seeds.len(), folder.display());
    Ok(())
}

fn read(path: &Path) -> Result<Vec<Row>> {
    let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
    let mut lines = text.lines().enumerate();
    if lines.next().is_none_or(|(_, line)| line != HEADER) {
        bail!("{}:1: other columns; give a file that --out of this version has written", path.display());
    }
    lines.map(|(at, line)| line.parse().with_context(|| format!("{}:{}", path.display(), at + 1))).collect()
}
