//! `staya sweep PLAN`.

use super::RowArgs;
use crate::error::SweepError;
use crate::sweep::merge::Merged;
use crate::sweep::plan::{Changes, PlotTable};
use crate::sweep::report::{ROWS, Report};
use crate::sweep::run::estimate;
use crate::sweep::script::{self, Job};
use crate::sweep::shard::{Existing, files};
use crate::sweep::{Plan, pictures};
use anyhow::Result;
use clap::{Args, Subcommand};
use staya_console::{Ended, Global, Stop, print, print_json};
use staya_sim::shown::Shown as _;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

#[derive(Args, Clone, Debug)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct SweepArgs {
    #[command(subcommand)]
    command: Option<SweepCommand>,
    #[command(flatten)]
    target: TargetArgs,
    /// Show number, duration and size of the runs, and try three of them.
    #[arg(long)]
    dry_run: bool,
    #[command(flatten)]
    rows: RowArgs,
}

#[derive(Args, Clone, Debug)]
struct TargetArgs {
    /// Plan, a .toml file; docs/sweeps.md lists all fields.
    #[arg(required = true)]
    plan: Option<PathBuf>,
    /// Folder of the results [default: out/ and the plan's name].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

#[derive(Subcommand, Clone, Debug)]
enum SweepCommand {
    /// Merge the rows of all shards, with means, intervals and pictures.
    Merge(MergeArgs),
    /// Draw a figure of merged rows over one axis or two.
    Plot(PlotArgs),
    /// Print a Slurm job: an array with one core per task.
    Slurm(SlurmArgs),
    /// Print a script for GNU parallel, for one machine or several.
    Parallel(ParallelArgs),
}

#[derive(Args, Clone, Debug)]
struct MergeArgs {
    #[command(flatten)]
    target: TargetArgs,
    /// Files of rows, instead of those in the folder.
    files: Vec<PathBuf>,
}

#[derive(Args, Clone, Debug)]
struct PlotArgs {
    #[command(flatten)]
    target: TargetArgs,
    /// A figure that the plan measures.
    #[arg(long, value_name = "NAME")]
    figure: String,
    /// The axis from left to right.
    #[arg(long, value_name = "FIELD")]
    over: String,
    /// The second axis: curves if it has up to six values, else a map.
    #[arg(long, value_name = "FIELD")]
    and: Option<String>,
}

#[derive(Args, Clone, Debug)]
struct ScriptArgs {
    #[command(flatten)]
    target: TargetArgs,
    /// Number of parts.
    #[arg(long, value_name = "N", default_value_t = 20)]
    tasks: u32,
    /// Most parallel tasks [default: the number of cores].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    at_once: Option<u32>,
    /// Path of the program on the hosts [default: this one].
    #[arg(long, value_name = "FILE")]
    program: Option<String>,
}

#[derive(Args, Clone, Debug)]
struct SlurmArgs {
    #[command(flatten)]
    script: ScriptArgs,
    /// Time limit of a task.
    #[arg(long, value_name = "MINUTES", value_parser = clap::value_parser!(u32).range(1..))]
    minutes: Option<u32>,
}

#[derive(Args, Clone, Debug)]
struct ParallelArgs {
    #[command(flatten)]
    script: ScriptArgs,
    /// Host reachable by ssh, as for GNU parallel (8/name: eight tasks; `:`: here); repeatable.
    #[arg(long = "host", value_name = "HOST")]
    hosts: Vec<String>,
}

impl TargetArgs {
    fn load(&self) -> Result<(Plan, PathBuf)> {
        let plan = Plan::load(self.plan.as_deref().unwrap_or(Path::new("")), &Changes::default())?;
        let out = self.out.clone().unwrap_or_else(|| plan.out());
        Ok((plan, out))
    }
}

impl SweepArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// The plan cannot be read or is wrong, rows are inconsistent, or a file cannot be written.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        match &self.command {
            Some(SweepCommand::Merge(args)) => args.run(global),
            Some(SweepCommand::Plot(args)) => args.run(global),
            Some(SweepCommand::Slurm(args)) => {
                let text = args.script.with(|plan, job| script::slurm(plan, job, args.minutes))?;
                print(&text)?;
                Ok(Ended::Done)
            }
            Some(SweepCommand::Parallel(args)) => {
                let text = args.script.with(|plan, job| script::parallel(plan, job, &args.hosts))?;
                print(&text)?;
                Ok(Ended::Done)
            }
            None if self.dry_run => self.show(global),
            None => self.perform(global),
        }
    }

    fn show(&self, global: &Global) -> Result<Ended> {
        let (plan, _) = self.target.load()?;
        let cost = estimate(&plan);
        if global.json {
            print_json(&cost)?;
            return Ok(Ended::Done);
        }
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let threads = global.threads.map_or(cores, usize::from).min(cores);
        let mut text = format!("{} ({}), {}\n", plan.name, plan.fingerprint(), plan.path().shown());
        for axis in plan.axes() {
            let values = plan.values(axis).unwrap_or_default();
            let shown = values.iter().take(6).map(ToString::to_string).collect::<Vec<_>>().join(", ");
            let dots = if values.len() > 6 { ", ..." } else { "" };
            writeln!(text, "  {axis}: {} values, {shown}{dots}", values.len())?;
        }
        let (runs, seeds) = (plan.runs(), plan.seeds());
        writeln!(
            text,
            "  {runs} runs: {} points, {seeds} seeds each; {} figures",
            runs / seeds,
            plan.measures().len()
        )?;
        let most = if cost.is_whole { "about" } else { "at most" };
        writeln!(
            text,
            "  {most} {} of processor time, {} on {threads} cores (tried {} runs); {} of rows",
            duration(cost.seconds),
            duration(cost.seconds / threads as f64),
            cost.tried,
            size(cost.bytes)
        )?;
        print(&text)?;
        Ok(Ended::Done)
    }

    fn perform(&self, global: &Global) -> Result<Ended> {
        let (plan, out) = self.target.load()?;
        let stop = Stop::on_ctrl_c()?;
        let rows = (self.rows.shard, self.rows.existing(Existing::Refuse));
        let report = Report::make(&plan, &out, rows, global, &stop)?;
        report.print(global)?;
        report.judge()?;
        Ok(if report.is_partial() { Ended::by(&stop) } else { Ended::Done })
    }
}

impl MergeArgs {
    fn run(&self, global: &Global) -> Result<Ended> {
        let (plan, out) = self.target.load()?;
        let (sources, place) = match &self.files[..] {
            [] => (files(&out)?, out.join("shards")),
            given => (given.to_vec(), out.clone()),
        };
        let fills = format!(
            "`staya sweep {} --out {} --resume` does them, if all shards are in {}",
            plan.path().shown(),
            out.shown(),
            out.join("shards").shown()
        );
        let merged = Merged::read(&plan, &sources)?.whole(&plan, &place, &fills)?;
        let mut report = Report::new(&plan, &out);
        report.runs = plan.runs();
        report.done_before = plan.runs();
        report.doubles = merged.doubles;
        report.take(&merged)?;
        report.print(global)?;
        Ok(Ended::Done)
    }
}

impl PlotArgs {
    fn run(&self, global: &Global) -> Result<Ended> {
        let (plan, out) = self.target.load()?;
        let plot =
            PlotTable { figure: self.figure.clone(), over: self.over.clone(), and: self.and.clone(), log: false };
        plan.check_plot(&plot)
            .map_err(|(field, what, remedy)| SweepError::new(format_args!("--{field}"), what, remedy))?;
        let merged = Merged::reread(&plan, &out.join(ROWS))?;
        let files = pictures::draw(&plan, &merged, &plot, &out.join("plots"))?;
        if global.json {
            print_json(&BTreeMap::from([("files", &files)]))?;
        } else {
            let lines = files.iter().map(|file| format!("{}\n", file.shown()));
            print(&lines.collect::<String>())?;
        }
        Ok(Ended::Done)
    }
}

impl ScriptArgs {
    fn with(&self, make: impl FnOnce(&Plan, &Job<'_>) -> Result<String, SweepError>) -> Result<String> {
        let (plan, out) = self.target.load()?;
        let absolute = |path: &Path| std::path::absolute(path);
        let program = match &self.program {
            Some(program) => program.clone(),
            None => std::env::current_exe()?.display().to_string(),
        };
        let (file, out) = (absolute(plan.path())?, absolute(&out)?);
        let job = Job { program: &program, plan: &file, out: &out, tasks: self.tasks, at_once: self.at_once };
        Ok(make(&plan, &job)?)
    }
}

fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 120.0 => format!("{s:.1} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

fn size(bytes: u64) -> String {
    match bytes {
        b if b < 10_000 => format!("{b} bytes"),
        b if b < 10_000_000 => format!("{:.0} kB", b as f64 / 1e3),
        b => format!("{:.0} MB", b as f64 / 1e6),
    }
}
