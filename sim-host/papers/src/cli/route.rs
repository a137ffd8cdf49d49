//! `staya experiment route`.

use super::params::NormArg;
use super::params::{RouteOptions, gain};
use super::results::{Work, number};
use crate::route::{
    Coefficient, Land, Loss, MAX_RADIUS, Means, Plan, Point, Report, Results, decimal,
};
use anyhow::Result;
use clap::{Args, ValueEnum};
use staya_console::{Ended, Global, Stop};
use staya_controller::cost::Gain;
use staya_controller::route::RouteParams;
use staya_sim::record::prepare_dir;
use std::fmt::Write as _;
use std::path::PathBuf;

/// A kind of landscapes as a word.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum LandArg {
    /// Hills of mud around the obstacles.
    Natural,
    /// Cells without any order: one point per number of obstacles with the cells of such natural land shuffled
    /// (equal entropy), and a last one with every cell of any class.
    Uniform,
}

/// A coefficient as a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum CoefficientArg {
    /// Weight of travel time.
    A0,
    /// Price of a cell with another robot.
    A1,
    /// Price of an earlier visit.
    A2,
    /// Price of the distance between exit and target.
    A3,
}

impl CoefficientArg {
    /// The coefficient, and the values in sixteenths that show what it does.
    const fn with_values(self) -> (Coefficient, &'static [u16]) {
        match self {
            Self::A0 => (Coefficient::A0, &[0, 4, 8, 12, 16, 24, 32, 64]),
            Self::A1 => (Coefficient::A1, &[0, 16, 32, 64, 128]),
            Self::A2 => (Coefficient::A2, &[0, 8, 16, 32, 48, 64, 96, 160]),
            Self::A3 => (
                Coefficient::A3,
                &[0, 16, 32, 40, 48, 56, 64, 72, 80, 96, 128, 192],
            ),
        }
    }
}

/// Windowed routing against the global optimum on random land (Kuznetsov, section 5, figures 2 to 4).
#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
pub struct RouteArgs {
    /// The kind of landscapes.
    #[arg(long, value_enum, default_value = "natural")]
    terrain: LandArg,
    /// Numbers of obstacles, one point of the figures each.
    #[arg(
        long,
        value_name = "N,N,...",
        value_delimiter = ',',
        default_value = "10,40,70,100,130,160"
    )]
    obstacles: Vec<u32>,
    /// Landscapes per point.
    #[arg(long, default_value_t = 1000)]
    runs: u32,
    /// Radius of the robot's window in cells.
    #[arg(long, default_value_t = RouteParams::default().radius, value_parser = clap::value_parser!(u8).range(1..=i64::from(MAX_RADIUS)))]
    radius: u8,
    #[command(flatten)]
    route: RouteOptions,
    /// Length of a diagonal move.
    #[arg(long, value_enum, default_value = "euclidean")]
    norm: NormArg,
    /// Let diagonal moves pass blocked orthogonal neighbours.
    #[arg(long)]
    corner_cutting: bool,
    /// Cells along each side of the landscape.
    #[arg(long, default_value_t = 100)]
    size: u16,
    /// Classes of impassability.
    #[arg(long, default_value_t = 9)]
    classes: u8,
    /// How the distance to an obstacle is measured.
    #[arg(long, value_enum, default_value = "euclidean")]
    hill_norm: NormArg,
    /// Other robots that stand in random cells of each landscape; a1 says how they are avoided.
    #[arg(long, value_name = "ROBOTS", default_value_t = 0)]
    parked: u32,
    /// Equal seeds give equal results.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Repeat everything for other values of these coefficients, one at a time, on the same landscapes.
    #[arg(long, value_enum, value_name = "a0,a1,a2,a3", value_delimiter = ',')]
    sweep: Vec<CoefficientArg>,
    /// The values to sweep over [default: a selection for each coefficient].
    #[arg(long, value_name = "V,V,...", value_delimiter = ',', value_parser = gain, requires = "sweep")]
    values: Vec<Gain>,
    /// Folder for the pictures.
    #[arg(long, value_name = "DIR", default_value = "out/experiment-route")]
    out: PathBuf,
}

impl RouteArgs {
    fn plan(&self) -> Plan {
        let params = RouteParams {
            norm: self.norm.into(),
            corner_cutting: self.corner_cutting,
            ..self.route.params(self.radius)
        };
        let mut lands: Vec<Land> = self
            .obstacles
            .iter()
            .map(|&obstacles| match self.terrain {
                LandArg::Natural => Land::Natural(obstacles),
                LandArg::Uniform => Land::Shuffled(obstacles),
            })
            .collect();
        if matches!(self.terrain, LandArg::Uniform) {
            lands.push(Land::Uniform);
        }
        let sweep = self.sweep.iter().flat_map(|coefficient| {
            let (coefficient, usual) = coefficient.with_values();
            let usual = usual.iter().copied().map(Gain::from_sixteenths);
            let values = if self.values.is_empty() {
                usual.collect()
            } else {
                self.values.clone()
            };
            values.into_iter().map(move |value| (coefficient, value))
        });
        Plan {
            lands,
            runs: self.runs,
            size: self.size,
            classes: self.classes,
            hill_norm: self.hill_norm.into(),
            parked: self.parked,
            seed: self.seed,
            params,
            replan: self.route.replan(),
            sweep: sweep.collect(),
        }
    }

    /// Runs the command.
    ///
    /// # Errors
    /// A parameter out of range, a picture that cannot be written.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        let plan = self.plan();
        plan.check()?;
        self.carry_out(&plan, global, &Stop::on_ctrl_c()?)
    }

    fn carry_out(&self, plan: &Plan, global: &Global, stop: &Stop) -> Result<Ended> {
        prepare_dir(&self.out)?;
        let work = Work::new("landscapes", plan.total(), &self.out);
        let (results, mut course) =
            work.carry_out(global, stop, |told| plan.carry_out(told), Results::done)?;
        let report = results.report();
        course.pictures = report.draw(&results.example()?, &self.out)?;
        let tables = |report: &Report| Ok(table(report)? + &sweep_tables(report, &plan.params)?);
        course.tell(&report, tables, global)?;
        Ok(Ended::by(stop))
    }
}

fn table(report: &Report) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    writeln!(
        text,
        "{size} x {size} cells, {} classes, window radius {}, exit {}, a = ({}, {}, {}, {}), seed {}",
        report.classes,
        report.radius,
        report.exit,
        report.a0,
        report.a1,
        report.a2,
        report.a3,
        report.seed,
        size = report.size,
    )?;
    writeln!(
        text,
        "{:<9}{:>5}{:>7}{:>9}{:>9}{:>8}{:>8}{:>9}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}",
        "land",
        "N",
        "runs",
        "arrived",
        "dT %",
        "+-",
        "median",
        "dL %",
        "+-",
        "median",
        "S",
        "TE",
        "TED",
        "N(S)"
    )?;
    for point in &report.points {
        let column = |loss: Option<Loss>| {
            let summary = loss.map(|loss| loss.summary);
            [
                number(summary.map(|s| s.mean), 2),
                number(summary.and_then(|s| s.mean_error95), 2),
                number(summary.map(|s| s.median), 2),
            ]
        };
        let [t, te, tm] = column(point.time_loss_percent);
        let [l, le, lm] = column(point.length_loss_percent);
        writeln!(
            text,
            "{}{:>7}{:>9}{t:>9}{te:>8}{tm:>8}{l:>9}{le:>8}{lm:>8}{:>8.3}{:>8.0}{:>8.3}{:>8.1}",
            row_name(point),
            point.runs,
            point.arrived,
            point.entropy,
            point.total_edge,
            point.total_edge_density,
            point.obstacles_of_entropy,
        )?;
    }
    text.push_str("+-: half the 95 % interval of the mean. N(S): obstacles by entropy\n\n");
    text.push_str("Travel time in ticks with its Norton-Rice law (m, alpha, beta) and the p-value of the chi-square test\n");
    let names = ["mean", "m", "alpha", "beta", "p"];
    write!(text, "{:<14}", "")?;
    for group in ["by window", "fastest route"] {
        write!(text, "  {group:<14}")?;
        names
            .iter()
            .try_for_each(|name| write!(text, "{name:>8}"))?;
    }
    text.push('\n');
    for point in &report.points {
        text.push_str(&row_name(point));
        for arrivals in [&point.arrivals, &point.optimal_arrivals] {
            write!(text, "{:16}", "")?;
            let arrivals = arrivals.as_ref();
            let law = arrivals.and_then(|a| a.norton_rice);
            let p = arrivals.and_then(|a| a.goodness).map(|g| g.p_value);
            let values = [
                number(arrivals.map(|a| a.mean_ticks), 1),
                digits(law.map(|law| law.m())),
                digits(law.map(|law| law.alpha())),
                digits(law.map(|law| law.beta())),
                number(p, 3),
            ];
            values
                .iter()
                .try_for_each(|value| write!(text, "{value:>8}"))?;
        }
        text.push('\n');
    }
    Ok(text)
}

/// About three digits, whatever the size; `-` for a missing value.
fn digits(value: Option<f64>) -> String {
    match value {
        Some(x) if x < 0.01 => format!("{x:.0e}"),
        Some(x) if x < 100.0 => format!("{x:.2}"),
        _ => number(value, 1),
    }
}

fn row_name(point: &Point) -> String {
    let obstacles = point.obstacles.map_or(String::from("-"), |n| n.to_string());
    format!("{:<9}{obstacles:>5}", point.land)
}

/// One table per coefficient: a line per value, a pair of columns per point.
fn sweep_tables(report: &Report, own: &RouteParams) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    for responses in report.sweep.chunk_by(|a, b| a.coefficient == b.coefficient) {
        let coefficient = responses[0].coefficient;
        let name = coefficient.name();
        writeln!(
            text,
            "\ndT % / dL % for other values of {name}, * = the value above; (n) = only n arrived"
        )?;
        write!(text, "{name:>8} ")?;
        for point in &report.points {
            let obstacles = point.obstacles.map_or(String::new(), |n| format!(" {n}"));
            write!(text, "{:>20}", format!("{}{obstacles}", point.land))?;
        }
        text.push('\n');
        for response in responses {
            let is_own = decimal(coefficient.get(own)) == response.value;
            write!(
                text,
                "{:>8}{}",
                response.value,
                if is_own { '*' } else { ' ' }
            )?;
            for (means, point) in response.points.iter().zip(&report.points) {
                write!(text, "{:>20}", cell(means, point.runs))?;
            }
            text.push('\n');
        }
    }
    Ok(text)
}

fn cell(means: &Means, runs: usize) -> String {
    let (time, length) = (means.time_loss_percent, means.length_loss_percent);
    let mut text = format!("{} / {}", number(time, 1), number(length, 1));
    if means.arrived < runs {
        text = format!("({}) {text}", means.arrived);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use staya_controller::grid::Norm;
    use staya_controller::route::{ExitRule, Replan};

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        route: RouteArgs,
    }

    fn read(words: &[&str]) -> Result<RouteArgs, String> {
        Line::try_parse_from([&["route"], words].concat())
            .map(|line| line.route)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn defaults_are_the_papers_experiment() {
        assert_eq!(read(&[]).unwrap().plan(), Plan::default());
    }

    #[test]
    fn options_reach_the_plan() {
        let words = "--terrain uniform --obstacles 5,7 --runs 3 --exit ray --replan until-changed --radius 4 \
            --a0 0.5 --a1 1 --a2 2.25 --a3 0 --norm chebyshev --corner-cutting --hill-norm chebyshev --size 50 \
            --classes 4 --seed 9 --parked 8 --sweep a1,a3 --values 1,2";
        let words: Vec<&str> = words.split_whitespace().collect();
        let plan = read(&words).unwrap().plan();
        let params = RouteParams {
            radius: 4,
            exit: ExitRule::Ray,
            norm: Norm::Chebyshev,
            corner_cutting: true,
            a0: Gain::from_sixteenths(8),
            a1: Gain::ONE,
            a2: Gain::from_sixteenths(36),
            a3: Gain::ZERO,
        };
        let (one, two) = (Gain::ONE, Gain::from_int(2));
        let expected = Plan {
            lands: vec![Land::Shuffled(5), Land::Shuffled(7), Land::Uniform],
            runs: 3,
            size: 50,
            classes: 4,
            hill_norm: Norm::Chebyshev,
            parked: 8,
            seed: 9,
            params,
            replan: Replan::UntilChanged,
            sweep: vec![
                (Coefficient::A1, one),
                (Coefficient::A1, two),
                (Coefficient::A3, one),
                (Coefficient::A3, two),
            ],
        };
        assert_eq!(plan, expected);
    }

    #[test]
    fn wrong_usage_names_the_remedy() {
        let message = |words: &[&str]| read(words).unwrap_err();
        assert!(message(&["--terrain", "swamp"]).contains("possible values: natural, uniform"));
        assert!(message(&["--radius", "32"]).contains("1..=31"));
        assert!(message(&["--a3", "0.1"]).contains("give 0.0625 or 0.125"));
        assert!(message(&["--obstacles", "10,many"]).contains("'many'"));
        assert!(message(&["--values", "1"]).contains("--sweep"));
        let refused = |words: &[&str]| {
            let args = read(words).unwrap();
            args.run(&Global::default()).unwrap_err().to_string()
        };
        assert!(refused(&["--runs", "0"]).contains("make 1 or more"));
        assert!(refused(&["--obstacles", "10001"]).contains("10001 obstacles on 10000 cells"));
    }

    #[test]
    fn pictures_are_left_and_an_early_end_is_told() {
        let dir = tempfile::tempdir().unwrap();
        let out = dir.path().join("a/b");
        let folder = out.to_str().unwrap();
        let words = [
            "--runs", "2", "--size", "30", "--sweep", "a2", "--out", folder,
        ];
        let args = read(&words).unwrap();
        let quiet = Global {
            quiet: true,
            ..Global::default()
        };
        let stop = Stop::default();
        let ended = args.carry_out(&args.plan(), &quiet, &stop).unwrap();
        assert_eq!(ended, Ended::Done);
        assert!(out.join("figure3.svg").is_file() && out.join("sweep-a2.png").is_file());
        stop.request();
        let error = args.carry_out(&args.plan(), &quiet, &stop).unwrap_err();
        assert!(error.to_string().contains("before any of the landscapes"));
    }

    #[test]
    fn tables_have_a_row_per_point_and_value() {
        let words = [
            "--runs",
            "2",
            "--size",
            "30",
            "--obstacles",
            "3,4",
            "--sweep",
            "a3",
        ];
        let plan = read(&words).unwrap().plan();
        let report = plan.carry_out(|_| true).unwrap().report();
        let text = table(&report).unwrap();
        assert_eq!(text.matches("\nnatural ").count(), 4);
        let text = sweep_tables(&report, &plan.params).unwrap();
        assert_eq!(text.lines().count(), 3 + 12);
        assert_eq!(text.matches("3*").count(), 1);
    }
}
