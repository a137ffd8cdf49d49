//! `staya terrain generate | metrics | draw | model`: random terrain, statistics, pictures, tables
//! of costs to go.

use anyhow::{Result, bail};
use clap::{Args, Subcommand, ValueEnum};
use serde::Serialize;
use staya_console::{Ended, Global, options, print, print_json};
use staya_controller::grid::{Cell, Norm, UNIT};
use staya_plot::terrain::{draw, scale_for};
use staya_sim::record::{Files, write_atomically};
use staya_sim::shown::Shown as _;
use staya_sim::terrain::generate::{ByMetrics, Hills, LandPlan, by_metrics, natural_by, uniform};
use staya_sim::terrain::known::{LEAST_BYTES, MOST_BYTES, cost_to_go};
use staya_sim::terrain::metrics::{Metrics, obstacles_of_entropy};
use staya_sim::terrain::optimal::Planner;
use staya_sim::terrain::{LoadOptions, SlopeRule, Terrain, ros};
use std::fmt::Write as _;
use std::path::PathBuf;

/// Generate, measure and draw terrain.
#[derive(Args, Clone, Debug)]
pub struct TerrainArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Clone, Debug, Subcommand)]
enum Action {
    /// Generate random terrain.
    Generate(Generate),
    /// Print size, entropy and edges of a terrain file.
    Metrics(Source),
    /// Draw a terrain file; darker is less passable.
    Draw {
        #[command(flatten)]
        source: Source,
        /// Output picture, .png or .svg.
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
        /// Pixels per cell [default: about 1000 pixels along the longer side].
        #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..))]
        scale: Option<u32>,
    },
    /// Make a table of travel times to a goal, which a robot's firmware carries in flash.
    Model(Model),
}

#[derive(Args, Clone, Debug)]
struct Model {
    #[command(flatten)]
    source: Source,
    /// The goal: column and row, from the south-west cell.
    #[arg(long, value_name = "X,Y", value_delimiter = ',', num_args = 1, allow_hyphen_values = true, required = true)]
    goal: Vec<i16>,
    /// Most bytes of the table.
    #[arg(long, default_value_t = 4096, value_parser = clap::value_parser!(u32).range(LEAST_BYTES as i64..=MOST_BYTES as i64))]
    bytes: u32,
    /// Length of diagonal moves.
    #[arg(long, default_value = "euclidean", value_parser = options::norm())]
    norm: Norm,
    /// Diagonal moves may pass a blocked corner.
    #[arg(long)]
    corner_cutting: bool,
    /// Output file.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// The table, and how far it is from the travel times of cells.
#[derive(Debug, Serialize)]
struct ModelReport {
    file: PathBuf,
    bytes: usize,
    nodes: [u8; 2],
    /// Cells with a way to the goal.
    cells: usize,
    /// The longest travel time, ticks.
    longest: f64,
    /// Mean and largest error, ticks.
    mean_error: f64,
    largest_error: f64,
}

impl Model {
    fn run(&self, global: &Global) -> Result<()> {
        let terrain = self.source.load()?;
        let &[x, y] = &self.goal[..] else { bail!("--goal needs two numbers; give X,Y in cells") };
        let (goal, moves) = (Cell::new(x, y), (self.norm, self.corner_cutting));
        let table = cost_to_go(&terrain, goal, moves, self.bytes as usize)?;
        let bytes = table.bytes();
        let inputs = [Some(self.source.file.clone()), Terrain::picture(&self.source.file)];
        Files::reading(inputs.into_iter().flatten()).claim(&self.out)?;
        write_atomically(&self.out, bytes)?;
        let times = Planner::default().costs_to(&terrain, goal, self.norm, self.corner_cutting);
        let unit = f64::from(UNIT);
        let width = usize::from(terrain.width());
        let reached = times.iter().enumerate().filter(|&(_, &time)| time != u64::MAX);
        let errors = reached.clone().map(|(at, &time)| {
            let cell = Cell::new((at % width) as i16, (at / width) as i16);
            (table.at(cell) as f64 / 256.0 - time as f64).abs() / unit
        });
        let cells = reached.clone().count();
        let report = ModelReport {
            file: self.out.clone(),
            bytes: bytes.len(),
            nodes: table.header().nodes,
            cells,
            longest: reached.map(|(_, &time)| time as f64).fold(0.0, f64::max) / unit,
            mean_error: errors.clone().sum::<f64>() / cells as f64,
            largest_error: errors.fold(0.0, f64::max),
        };
        report.print(global)
    }
}

impl ModelReport {
    fn print(&self, global: &Global) -> Result<()> {
        if global.json {
            return print_json(self);
        }
        let [columns, rows] = self.nodes;
        let mut text = String::new();
        writeln!(text, "{}", self.file.shown())?;
        writeln!(text, "  size                  {} bytes, {columns} x {rows} nodes of 12 bits", self.bytes)?;
        writeln!(text, "  cells with a way      {}, at most {:.1} ticks", self.cells, self.longest)?;
        writeln!(
            text,
            "  error                 {:.2} ticks on average, {:.1} at most",
            self.mean_error, self.largest_error
        )?;
        print(&text)
    }
}

/// Kind of random terrain.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Kind {
    /// Every cell is drawn independently.
    Uniform,
    /// Hills around the least passable cells.
    Natural,
    /// With a given configuration entropy and total edge.
    Entropy,
}

#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
struct Generate {
    /// Kind of terrain.
    #[arg(long, value_enum, default_value = "natural")]
    kind: Kind,
    /// Cells from west to east.
    #[arg(long, default_value_t = 100)]
    width: u16,
    /// Cells from south to north.
    #[arg(long, default_value_t = 100)]
    height: u16,
    /// Number of classes of impassability.
    #[arg(long, default_value_t = 9)]
    classes: u8,
    /// natural: number of least passable cells.
    #[arg(long, default_value_t = 70)]
    obstacles: u32,
    /// natural: shape of the hills around the least passable cells.
    #[arg(long, default_value = "even", value_parser = options::hills())]
    hills: Hills,
    /// natural: norm of distances.
    #[arg(long, default_value = "euclidean", value_parser = options::norm())]
    norm: Norm,
    /// entropy: required configuration entropy S, 0 to ln(classes).
    #[arg(long, required_if_eq("kind", "entropy"))]
    entropy: Option<f64>,
    /// entropy: tolerance of S.
    #[arg(long, default_value_t = 0.01)]
    entropy_tolerance: f64,
    /// entropy: required total edge TE.
    #[arg(long, required_if_eq("kind", "entropy"))]
    total_edge: Option<u64>,
    /// entropy: tolerance of TE.
    #[arg(long, default_value_t = 2)]
    edge_tolerance: u64,
    /// Seed; equal seeds give equal terrain.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Output as a ROS map: this .yaml and a .pgm picture beside it, without loss.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// A terrain file and options to read it.
#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
struct Source {
    /// .map (Moving AI), .asc (ESRI heights) or .yaml (ROS map with a .pgm).
    file: PathBuf,
    /// Part of the map: column and row of its south-west cell, width, height.
    #[arg(long, value_name = "X,Y,W,H", value_delimiter = ',', num_args = 1, allow_hyphen_values = true)]
    crop: Option<Vec<u16>>,
    /// .asc: steepest passable slope, rise over run.
    #[arg(long, value_name = "SLOPE", default_value_t = SlopeRule::default().max_slope)]
    max_slope: f64,
    /// .asc: number of slope classes.
    #[arg(long, value_name = "N", default_value_t = SlopeRule::default().classes)]
    slope_classes: u8,
    /// .asc: average squares with this many cells per side into one cell.
    #[arg(long, value_name = "N", default_value_t = 1)]
    downsample: u16,
}

impl Source {
    fn load(&self) -> Result<Terrain> {
        let options = LoadOptions {
            slope: SlopeRule { classes: self.slope_classes, max_slope: self.max_slope },
            downsample: self.downsample,
            ..LoadOptions::default()
        };
        let terrain = Terrain::load_with(&self.file, &options)?;
        match self.crop.as_deref() {
            None => Ok(terrain),
            Some(&[x, y, width, height]) => Ok(terrain.crop(x, y, width, height)?),
            Some(_) => bail!("--crop needs four numbers; give X,Y,WIDTH,HEIGHT in cells"),
        }
    }
}

#[derive(Debug, Serialize)]
struct LandReport {
    file: PathBuf,
    width: u16,
    height: u16,
    cell_m: f64,
    #[serde(flatten)]
    metrics: Metrics,
    /// N(S) of natural terrain with equal entropy (100 x 100 cells, 9 classes).
    equivalent_obstacles: f64,
}

impl LandReport {
    fn new(file: PathBuf, terrain: &Terrain) -> Self {
        let metrics = Metrics::of(terrain);
        Self {
            file,
            width: terrain.width(),
            height: terrain.height(),
            cell_m: terrain.cell_m,
            metrics,
            equivalent_obstacles: obstacles_of_entropy(metrics.entropy),
        }
    }

    fn print(&self, global: &Global) -> Result<()> {
        if global.json {
            return print_json(self);
        }
        let m = &self.metrics;
        let mut text = String::new();
        let share = 100.0 * m.blocked as f64 / m.cells as f64;
        writeln!(text, "{}", self.file.shown())?;
        writeln!(text, "  size                  {} x {} cells of {} m", self.width, self.height, self.cell_m)?;
        writeln!(text, "  classes               {}, blocked {share:.1} %", m.classes)?;
        writeln!(text, "  entropy S             {:.4}", m.entropy)?;
        writeln!(text, "  total edge TE         {}", m.total_edge)?;
        writeln!(text, "  edge density TED      {:.4}", m.total_edge_density)?;
        writeln!(text, "  obstacles by N(S)     {:.1}", self.equivalent_obstacles)?;
        print(&text)
    }
}

impl TerrainArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// A file that cannot be read or written, or a parameter out of range.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        match &self.action {
            Action::Generate(generate) => generate.run(global)?,
            Action::Metrics(source) => {
                LandReport::new(source.file.clone(), &source.load()?).print(global)?;
            }
            Action::Draw { source, out, scale } => {
                let terrain = source.load()?;
                let inputs = [Some(source.file.clone()), Terrain::picture(&source.file)];
                Files::reading(inputs.into_iter().flatten()).claim(out)?;
                draw(&terrain, scale.unwrap_or(scale_for(&terrain, 1000)), out)?;
                LandReport::new(out.clone(), &terrain).print(global)?;
            }
            Action::Model(model) => model.run(global)?,
        }
        Ok(Ended::Done)
    }
}

impl Generate {
    fn run(&self, global: &Global) -> Result<()> {
        let extension = self.out.extension().and_then(|extension| extension.to_str());
        if !matches!(extension, Some("yaml" | "yml")) {
            bail!(
                "--out {}: terrain is written as a ROS map; give a name that ends in .yaml (the picture is a .pgm beside it)",
                self.out.shown()
            );
        }
        let plan = LandPlan { width: self.width, height: self.height, classes: self.classes, seed: self.seed };
        let terrain = match (self.kind, self.entropy, self.total_edge) {
            (Kind::Uniform, _, _) => uniform(&plan)?,
            (Kind::Natural, _, _) => natural_by(&plan, self.obstacles, self.norm, self.hills)?,
            (Kind::Entropy, Some(entropy), Some(total_edge)) => by_metrics(
                &plan,
                &ByMetrics {
                    entropy,
                    entropy_tolerance: self.entropy_tolerance,
                    total_edge,
                    edge_tolerance: self.edge_tolerance,
                },
            )?,
            (Kind::Entropy, _, _) => bail!("--kind entropy needs --entropy and --total-edge"),
        };
        ros::save(&terrain, &self.out)?;
        LandReport::new(self.out.clone(), &terrain).print(global)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use staya_controller::land::CostToGo;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        terrain: TerrainArgs,
    }

    fn run(words: &[&str]) -> Result<Ended> {
        let line = Line::try_parse_from([&["terrain"], words].concat())?;
        let global = Global { json: true, ..Global::default() };
        line.terrain.run(&global)
    }

    #[test]
    fn generated_terrain_can_be_measured_and_drawn() {
        let dir = tempfile::tempdir().unwrap();
        let path = |name: &str| dir.path().join(name).to_str().unwrap().to_owned();
        let (land, picture) = (path("a.yaml"), path("a.png"));
        let size = ["--width", "30", "--height", "20"];
        let kinds: [&[&str]; 3] = [
            &["--kind", "uniform"],
            &["--kind", "natural", "--obstacles", "7", "--norm", "chebyshev"],
            &["--kind", "entropy", "--entropy", "1.2", "--total-edge", "300"],
        ];
        for kind in kinds {
            let words = [&["generate", "--out", &land], kind, &size].concat();
            assert_eq!(run(&words).unwrap(), Ended::Done);
            let terrain = Terrain::load(land.as_ref()).unwrap();
            assert_eq!((terrain.width(), terrain.height()), (30, 20));
        }
        let table = path("goal.ctg");
        run(&["model", &land, "--goal", "3,4", "--bytes", "200", "--out", &table]).unwrap();
        let header = *CostToGo::from_bytes(std::fs::read(&table).unwrap()).unwrap().header();
        assert_eq!((header.cells, header.goal), ([30, 20], Cell::new(3, 4)));
        let metrics = Metrics::of(&Terrain::load(land.as_ref()).unwrap());
        assert!(metrics.total_edge.abs_diff(300) <= 2);
        assert_eq!(run(&["metrics", &land]).unwrap(), Ended::Done);
        run(&["draw", &land, "--out", &picture, "--crop", "1,2,10,5", "--scale", "3"]).unwrap();
        assert!(std::fs::metadata(&picture).unwrap().len() > 0);
    }

    #[test]
    fn invalid_usage_is_an_error_with_a_remedy() {
        let message = |words: &[&str]| run(words).unwrap_err().to_string();
        assert!(message(&["generate", "--out", "a.asc"]).contains("ends in .yaml"));
        assert!(message(&["generate", "--kind", "entropy", "--out", "a.yaml"]).contains("--total-edge"));
        assert!(message(&["metrics", "a.tif"]).contains("unknown kind of terrain file"));
        let dir = tempfile::tempdir().unwrap();
        let land = dir.path().join("a.yaml");
        ros::save(&Terrain::flat(3, 3), &land).unwrap();
        let land = land.to_str().unwrap();
        assert!(message(&["metrics", land, "--crop", "1,2"]).contains("X,Y,WIDTH,HEIGHT"));
        assert!(message(&["metrics", land, "--crop", "1,2,9,9"]).contains("leaves the map of 3 x 3"));
        assert!(message(&["model", land, "--goal", "1", "--out", "a.ctg"]).contains("X,Y"));
        assert!(message(&["model", land, "--goal", "1,9", "--out", "a.ctg"]).contains("give a free cell"));
        assert!(message(&["model", land, "--goal", "1,1", "--out", land]).contains("a.yaml"));
    }
}
