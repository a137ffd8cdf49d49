//! `staya experiment`.

use super::RowArgs;
use crate::figure::{self, Figure};
use crate::sweep::Plan;
use crate::sweep::plan::{Change, Changes};
use crate::sweep::report::{ROWS, Report};
use crate::sweep::shard::Existing;
use anyhow::{Context as _, Result, ensure};
use clap::Args;
use staya_console::{Ended, Global, Stop, print, print_json};
use staya_sim::record::prepare_dir;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

#[derive(Args, Clone, Debug)]
pub struct FigureArgs {
    /// A figure: its short name, PAPER/FIGURE, or the file of a plan [default: list all].
    name: Option<String>,
    /// Other values of an axis, as in radio.loss=0,0.3 or count=2..64; repeatable. The end of an
    /// axis's name suffices; other fields of the scenario become axes.
    #[arg(long = "axis", value_name = "FIELD=VALUE,...")]
    axes: Vec<Change>,
    /// Another value of a field; repeatable.
    #[arg(long = "set", value_name = "FIELD=VALUE")]
    set: Vec<Change>,
    /// The first seed.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Number of seeds.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    seeds: Option<u32>,
    /// Run few seeds.
    #[arg(long, conflicts_with = "seeds")]
    quick: bool,
    /// Run all figures, and fail if one does not show what it should.
    #[arg(long, conflicts_with_all = ["name", "axes", "set", "out"])]
    all: bool,
    /// Folder for rows and pictures [default: out/ and the short name].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    rows: RowArgs,
}

impl FigureArgs {
    pub fn run(&self, global: &Global) -> Result<Ended> {
        let stop = &Stop::on_ctrl_c()?;
        if self.all {
            return self.run_all(global, stop);
        }
        let Some(name) = &self.name else {
            return list(global);
        };
        let figure = figure::find(name)?;
        let out = self.out.clone().unwrap_or_else(|| figure.out());
        let plan = self.plan(&figure)?;
        let report = self.make(&plan, &out, global, stop)?;
        report.print(global)?;
        report.judge()?;
        Ok(if report.is_partial() { Ended::by(stop) } else { Ended::Done })
    }

    fn plan(&self, figure: &Figure) -> Result<Plan> {
        let fields = self.axes.iter().chain(&self.set).cloned().collect();
        let changes = Changes { fields, seed: self.seed, seeds: self.seeds, is_quick: self.quick };
        Ok(Plan::load(&figure.path, &changes)?)
    }

    /// Rows of a completed figure are replaced like any results. Rows of an interrupted one may be
    /// hours of work, so they are kept.
    fn make<'a>(&self, plan: &'a Plan, out: &'a Path, global: &Global, stop: &Stop) -> Result<Report<'a>> {
        prepare_dir(out).context("results have no place")?;
        let is_complete = self.rows.shard.is_whole() && out.join(ROWS).is_file();
        let usual = if is_complete { Existing::Forget } else { Existing::Refuse };
        Report::make(plan, out, (self.rows.shard, self.rows.existing(usual)), global, stop)
    }

    fn run_all(&self, global: &Global, stop: &Stop) -> Result<Ended> {
        let (figures, mut broken, mut reports) = (figure::all()?, Vec::new(), Vec::new());
        for figure in &figures {
            let out = if self.quick { Path::new("out/experiments/quick").join(&figure.name) } else { figure.out() };
            let plan = self.plan(figure)?;
            let report = self.make(&plan, &out, global, stop)?;
            if global.json {
                reports.push(serde_json::to_value(&report)?);
            } else {
                report.print(global)?;
                print("\n")?;
            }
            if report.is_partial() {
                return Ok(Ended::by(stop));
            }
            broken.extend(report.judge().err().map(|error| error.to_string()));
        }
        if global.json {
            print_json(&serde_json::json!({ "figures": reports }))?;
        }
        ensure!(broken.is_empty(), "{}", broken.join("\n"));
        Ok(Ended::Done)
    }
}

/// Prints all experiments, with the verdicts on the last complete runs of figures.
fn list(global: &Global) -> Result<Ended> {
    let figures = figure::all()?;
    let row = |figure: &Figure| {
        let verdict = figure.verdict().unwrap_or_else(|| "not run".to_owned());
        [figure.name.clone(), figure.place.clone(), verdict, figure.title.clone()]
    };
    let rows: Vec<_> = figures.iter().map(row).collect();
    if global.json {
        let object = |[name, place, verdict, title]: &[String; 4]| serde_json::json!({ "name": name, "place": place, "verdict": verdict, "title": title });
        print_json(&serde_json::json!({ "experiments": rows.iter().map(object).collect::<Vec<_>>() }))?;
        return Ok(Ended::Done);
    }
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let [names, places, verdicts] = [0, 1, 2].map(width);
    let mut text = String::new();
    for [name, place, verdict, title] in &rows {
        writeln!(text, "{name:<names$}  {place:<places$}  {verdict:<verdicts$}  {title}")?;
    }
    print(&text)?;
    Ok(Ended::Done)
}
