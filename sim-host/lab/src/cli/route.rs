//! `staya experiment route`.

use crate::route::{Coefficient, Land, MAX_RADIUS, Plan};
use clap::{Args, ValueEnum};
use staya_console::options::{self, RouteOptions, gain};
use staya_controller::cost::Gain;
use staya_controller::grid::Norm;
use staya_controller::route::RouteParams;
use staya_controller::shuffle::Sharpness;
use staya_sim::terrain::generate::Hills;
use std::path::PathBuf;

#[derive(Clone, Copy, Debug, ValueEnum)]
enum LandArg {
    /// Hills of mud around obstacles.
    Natural,
    /// Cells in random order: for each number of obstacles with the classes of that natural land
    /// (equal entropy), and one point with every class equally likely.
    Uniform,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum CoefficientArg {
    /// Weight of travel time.
    A0,
    /// Cost of a cell with another robot.
    A1,
    /// Cost of an earlier visit.
    A2,
    /// Cost of the distance between exit and target.
    A3,
}

impl CoefficientArg {
    const fn with_values(self) -> (Coefficient, &'static [u16]) {
        match self {
            Self::A0 => (Coefficient::A0, &[0, 4, 8, 12, 16, 24, 32, 64]),
            Self::A1 => (Coefficient::A1, &[0, 16, 32, 64, 128]),
            Self::A2 => (Coefficient::A2, &[0, 8, 16, 32, 48, 64, 96, 160]),
            Self::A3 => (Coefficient::A3, &[0, 16, 32, 40, 48, 56, 64, 72, 80, 96, 128, 192]),
        }
    }
}

#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
pub struct RouteArgs {
    /// The kind of landscapes.
    #[arg(long, value_enum, default_value = "natural")]
    terrain: LandArg,
    /// Numbers of obstacles, one point of the figures each.
    #[arg(long, value_name = "N,N,...", value_delimiter = ',', default_value = "10,40,70,100,130,160")]
    obstacles: Vec<u32>,
    /// Landscapes per point.
    #[arg(long, default_value_t = 1000)]
    runs: u32,
    /// Radius of the robot's window, cells.
    #[arg(long, default_value_t = RouteParams::default().radius, value_parser = clap::value_parser!(u8).range(1..=i64::from(MAX_RADIUS)))]
    radius: u8,
    #[command(flatten)]
    route: RouteOptions,
    /// Length of a diagonal move.
    #[arg(long, default_value = "euclidean", value_parser = options::norm())]
    norm: Norm,
    /// Permit diagonal moves past blocked orthogonal neighbours.
    #[arg(long)]
    corner_cutting: bool,
    /// Cells along each side of the landscape.
    #[arg(long, default_value_t = 100)]
    size: u16,
    /// Classes of impassability.
    #[arg(long, default_value_t = 9)]
    classes: u8,
    /// Interpretation of natural land, which the paper defines in one sentence (docs/limits.md).
    #[arg(long, default_value = "even", value_parser = options::hills())]
    hills: Hills,
    /// Draw the order of moves: this additional cost halves a move's chance; 0 never draws.
    #[arg(long, value_name = "TICKS", default_value = "0", value_parser = options::shuffle)]
    shuffle: Sharpness,
    /// Norm of the distance to an obstacle.
    #[arg(long, default_value = "euclidean", value_parser = options::norm())]
    hill_norm: Norm,
    /// Stationary robots in random cells of each landscape, avoided with weight a1.
    #[arg(long, value_name = "ROBOTS", default_value_t = 0)]
    parked: u32,
    /// Seed; equal seeds give equal results. Parameters were tuned on seed 1.
    #[arg(long, default_value_t = 2)]
    seed: u64,
    /// Coefficients to vary, one at a time, on the same landscapes.
    #[arg(long, value_enum, value_name = "a0,a1,a2,a3", value_delimiter = ',')]
    sweep: Vec<CoefficientArg>,
    /// Values of the varied coefficients [default: a selection for each].
    #[arg(long, value_name = "V,V,...", value_delimiter = ',', value_parser = gain, requires = "sweep")]
    values: Vec<Gain>,
    /// Folder for rows and pictures.
    #[arg(long, value_name = "DIR", default_value = "out/experiment-route")]
    pub out: PathBuf,
}

impl RouteArgs {
    pub fn plan(&self) -> Plan {
        let params =
            RouteParams { norm: self.norm, corner_cutting: self.corner_cutting, ..self.route.params(self.radius) };
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
            let values = if self.values.is_empty() { usual.collect() } else { self.values.clone() };
            values.into_iter().map(move |value| (coefficient, value))
        });
        Plan {
            lands,
            runs: self.runs,
            size: self.size,
            classes: self.classes,
            hills: self.hills,
            sharpness: self.shuffle,
            hill_norm: self.hill_norm,
            parked: self.parked,
            seed: self.seed,
            params,
            replan: self.route.replan,
            sweep: sweep.collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Experiment as _;
    use crate::experiment::rows::RowRetention;
    use clap::Parser;
    use staya_console::{Ended, Global, Stop};
    use staya_controller::route::{ExitRule, Replan};

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        route: RouteArgs,
    }

    fn read(words: &[&str]) -> Result<RouteArgs, String> {
        Line::try_parse_from([&["route"], words].concat()).map(|line| line.route).map_err(|error| error.to_string())
    }

    #[test]
    fn defaults_match_the_experiment_of_the_paper() {
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
            hills: Hills::Even,
            hill_norm: Norm::Chebyshev,
            sharpness: Sharpness::Greedy,
            parked: 8,
            seed: 9,
            params,
            replan: Replan::UntilChanged,
            sweep: vec![(Coefficient::A1, one), (Coefficient::A1, two), (Coefficient::A3, one), (Coefficient::A3, two)],
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
            args.plan().check().unwrap_err().to_string()
        };
        assert!(refused(&["--runs", "0"]).contains("make 1 or more"));
        assert!(refused(&["--obstacles", "10001"]).contains("10001 obstacles on 10000 cells"));
    }

    #[test]
    fn pictures_are_written_and_an_early_end_is_reported() {
        let dir = tempfile::tempdir().unwrap();
        let out = dir.path().join("a/b");
        let folder = out.to_str().unwrap();
        let words = ["--runs", "2", "--size", "30", "--sweep", "a2", "--out", folder];
        let args = read(&words).unwrap();
        let quiet = Global { quiet: true, ..Global::default() };
        let stop = Stop::default();
        let ended = args.plan().command(&args.out, &RowRetention::default(), &quiet, &stop).unwrap();
        assert_eq!(ended, Ended::Done);
        assert!(out.join("figure3.svg").is_file() && out.join("sweep-a2.png").is_file());
        stop.request();
        let error = args.plan().command(&args.out, &RowRetention::default(), &quiet, &stop).unwrap_err();
        assert!(error.to_string().contains("before any of the routes was done"), "{error}");
    }

    #[test]
    fn tables_have_a_row_per_point_and_value() {
        let words = ["--runs", "2", "--size", "30", "--obstacles", "3,4", "--sweep", "a3"];
        let plan = read(&words).unwrap().plan();
        let text = plan.measure().unwrap().to_string();
        assert_eq!(text.matches("\nnatural ").count(), 4);
        let (_, sweep) = text.split_once("\n\ndT %").unwrap();
        assert_eq!(sweep.lines().count(), 2 + 12);
        assert_eq!(sweep.matches("3*").count(), 1);
    }
}
