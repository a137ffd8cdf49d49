//! `staya experiment boids`.

use super::results::number;
use crate::boids::{Method, Plan, Report};
use anyhow::{Result, bail};
use clap::Args;
use serde::Serialize;
use staya_console::{Ended, Global, Progress, Stop, print, print_json};
use staya_sim::record::prepare_dir;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Boids on a torus: what three ways to find neighbours cost, with equal flights (Starovoitova, section 2.3).
#[derive(Args, Clone, Debug)]
pub struct BoidsArgs {
    /// Numbers of boids, one line of the table each.
    #[arg(
        long,
        value_name = "N,N,...",
        value_delimiter = ',',
        default_value = "100,300,1000,3000,10000,30000,100000"
    )]
    boids: Vec<u32>,
    /// Steps to time for each search and number of boids.
    #[arg(long, default_value_t = Plan::default().steps)]
    steps: u32,
    /// Skip the search of all pairs for more boids than this.
    #[arg(long, value_name = "N", default_value_t = Plan::default().most_by_all_pairs)]
    all_pairs_up_to: u32,
    /// Boids in the picture.
    #[arg(long, value_name = "N", default_value_t = Plan::default().picture_boids)]
    picture_boids: u32,
    /// Steps until the last picture.
    #[arg(long, value_name = "STEPS", default_value_t = Plan::default().picture_steps)]
    picture_steps: u32,
    /// Equal seeds give equal flights.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder for pictures and table.
    #[arg(long, value_name = "DIR", default_value = "out/experiment-boids")]
    out: PathBuf,
}

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Output<'a> {
    #[serde(flatten)]
    report: &'a Report,
    equal: bool,
    interrupted: bool,
    files: &'a [PathBuf],
}

impl BoidsArgs {
    fn plan(&self) -> Plan {
        Plan {
            boids: self.boids.clone(),
            steps: self.steps,
            most_by_all_pairs: self.all_pairs_up_to,
            picture_boids: self.picture_boids,
            picture_steps: self.picture_steps,
            seed: self.seed,
            ..Plan::default()
        }
    }

    /// Runs the command.
    ///
    /// # Errors
    /// A parameter out of range, a file that cannot be written, searches that differ.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        let plan = self.plan();
        plan.check()?;
        self.carry_out(&plan, global, &Stop::on_ctrl_c()?)
    }

    fn carry_out(&self, plan: &Plan, global: &Global, stop: &Stop) -> Result<Ended> {
        prepare_dir(&self.out)?;
        let mut progress = Progress::new("runs", plan.total() as u64, global);
        let report = plan.carry_out(|done| {
            progress.set(done as u64, String::new);
            !stop.is_requested()
        })?;
        progress.finish();
        if report.rows.is_empty() {
            bail!("stopped before the first number of boids was done");
        }
        let mut files = vec![report.write_csv(&self.out)?];
        files.extend(report.draw(&self.out)?);
        if global.json {
            print_json(&Output {
                report: &report,
                equal: report.is_equal(),
                interrupted: stop.is_requested(),
                files: &files,
            })?;
        } else {
            let mut text = table(&report)?;
            if stop.is_requested() {
                let (done, all) = (report.rows.len(), plan.boids.len());
                writeln!(text, "stopped early, after {done} of {all} lines")?;
            }
            writeln!(text, "{} files in {}", files.len(), self.out.display())?;
            print(&text)?;
        }
        if !report.is_equal() {
            bail!("the searches gave different flights: a defect, please report it");
        }
        Ok(Ended::by(stop))
    }
}

fn table(report: &Report) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    writeln!(
        text,
        "boids on a torus of {} square units a boid, neighbours up to {}, seed {}; microseconds a boid in the median step",
        report.area_per_boid, report.closest, report.seed
    )?;
    write!(text, "{:>8}{:>7}{:>12}", "boids", "steps", "neighbours")?;
    for method in Method::ALL {
        write!(text, "{:>15}", method.name())?;
    }
    let parallel = format!("cells, {} threads", report.threads);
    writeln!(text, "{parallel:>19}{:>9}  hash", "equal")?;
    for row in &report.rows {
        write!(
            text,
            "{:>8}{:>7}{:>12.2}",
            row.boids, row.steps, row.mean_neighbours
        )?;
        for method in Method::ALL {
            write!(text, "{:>15}", number(row.us_per_boid(method.name()), 3))?;
        }
        let equal = if row.is_equal() { "yes" } else { "NO" };
        let hash = row.timings.first().map_or("", |timing| &timing.hash);
        writeln!(text, "{:>19.3}{equal:>9}  {hash}", row.parallel_us_per_boid)?;
    }
    writeln!(
        text,
        "-: not run; all pairs only up to {} boids, since a step costs their square",
        report.most_by_all_pairs
    )?;
    for moment in &report.moments {
        writeln!(
            text,
            "pictured flock after {} steps: group order {:.3}",
            moment.step, moment.polarisation
        )?;
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        boids: BoidsArgs,
    }

    fn read(words: &[&str]) -> BoidsArgs {
        let line = Line::try_parse_from([&["boids"], words].concat());
        line.expect("arguments").boids
    }

    #[test]
    fn defaults_are_the_papers_flock() {
        assert_eq!(read(&[]).plan(), Plan::default());
    }

    #[test]
    fn table_has_a_line_per_number_and_says_what_was_not_run() {
        let words = "--boids 4,9 --steps 2 --all-pairs-up-to 5 --picture-boids 3 --picture-steps 2";
        let args = read(&words.split(' ').collect::<Vec<_>>());
        let report = args.plan().carry_out(|_| true).expect("a plan");
        let text = table(&report).expect("text");
        assert_eq!(text.matches(" yes ").count(), 2);
        assert!(text.contains("only up to 5 boids") && text.contains("after 2 steps"));
        let second = text.lines().nth(3).expect("a line");
        assert!(second.split_whitespace().nth(3) == Some("-"), "{second}");
    }

    #[test]
    fn files_are_left_and_an_early_end_is_told() {
        let dir = tempfile::tempdir().expect("a folder");
        let out = dir.path().join("a/b");
        let folder = out.to_str().expect("a name");
        let words = [
            "--boids",
            "5",
            "--steps",
            "1",
            "--picture-steps",
            "2",
            "--out",
            folder,
        ];
        let args = read(&words);
        let quiet = Global {
            quiet: true,
            ..Global::default()
        };
        let stop = Stop::default();
        let ended = args.carry_out(&args.plan(), &quiet, &stop).expect("done");
        assert_eq!(ended, Ended::Done);
        assert!(out.join("flock.svg").is_file() && out.join("boids.csv").is_file());
        stop.request();
        let error = args
            .carry_out(&args.plan(), &quiet, &stop)
            .expect_err("stopped");
        assert!(error.to_string().contains("before the first"));
    }
}
