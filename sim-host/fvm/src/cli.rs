//! The commands of `staya-voxel`: `staya voxel` and `staya orca`.

mod options;
mod orca;

use crate::build::MOST_BYTES;
use crate::draw::{m_images, sheet};
use crate::numbers::numbers;
use crate::swarm::{Crowd, Outcome, Source, Swap};
use crate::{
    HalfPlaneErrors, Measured, Reading, System, Template, Templated, VelocityForm, build, half_planes, measure,
};
use anyhow::{Context as _, Result, anyhow};
use clap::{Args, Subcommand};
use options::{TemplateArgs, grid};
use serde::Serialize;
use staya_console::{Ended, Global, print, print_json};
use staya_sim::file::read_remedy;
use staya_sim::record::{Files, prepare_dir, write_atomically};
use staya_sim::shown::Shown as _;
use staya_voxel::{Header, Local, Model, VoxelNeighbor};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Commands for tables of functions.
#[derive(Clone, Debug, Subcommand)]
pub enum Command {
    /// Draw the velocities that ORCA forbids two robots, and measure its lookup tables.
    Orca(orca::OrcaArgs),
    /// Make, draw and measure functional voxel models: functions as tables for a microcontroller.
    Voxel(VoxelArgs),
}

impl Command {
    /// Runs the command.
    ///
    /// # Errors
    /// Any error of the command.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        match self {
            Self::Orca(args) => args.run(global),
            Self::Voxel(args) => args.run(global),
        }
    }
}

/// Functional voxel models: functions as tables of tangent planes for a microcontroller.
#[derive(Args, Clone, Debug)]
pub struct VoxelArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Clone, Debug, Subcommand)]
enum Action {
    /// Make a model: circle, ball, polygon, room, or velocity obstacles of one or all neighbours.
    Build(Box<BuildArgs>),
    /// Draw a model's values and M-images (PNG, SVG).
    Draw(DrawArgs),
    /// Evaluate a model at a point: value, gradient, distance to the border, and ORCA's half-plane.
    Evaluate(EvaluateArgs),
    /// Measure the errors of a template's models by resolution and depth.
    Measure(Box<MeasureArgs>),
    /// Simulate a swap of places in a room with half-planes from formulas, tables or models.
    Swarm(SwarmArgs),
}

#[derive(Args, Clone, Debug)]
struct BuildArgs {
    #[command(flatten)]
    template: TemplateArgs,
    /// Nodes along the longest axis.
    #[arg(long, value_name = "N", default_value_t = 33, value_parser = clap::value_parser!(u16).range(2..))]
    resolution: u16,
    /// Bits per component.
    #[arg(long, value_name = "BITS", default_value_t = 16, value_parser = clap::value_parser!(u8).range(4..=16))]
    depth: u8,
    /// Output file.
    #[arg(long, value_name = "FILE", default_value = "model.fvm")]
    out: PathBuf,
}

#[derive(Args, Clone, Debug)]
struct DrawArgs {
    /// A model made by `staya voxel build`.
    model: PathBuf,
    /// Third variable of the slice, for models of three variables [default: the middle].
    #[arg(long, value_name = "Z", allow_hyphen_values = true)]
    slice: Option<f64>,
    /// Folder for the pictures.
    #[arg(long, value_name = "DIR", default_value = "out/voxel")]
    out: PathBuf,
}

#[derive(Args, Clone, Debug)]
struct EvaluateArgs {
    /// A model made by `staya voxel build`.
    model: PathBuf,
    /// Point: two or three numbers with commas.
    #[arg(value_name = "X,Y[,Z]", allow_hyphen_values = true)]
    at: String,
    /// Use the plane of the nearest node instead of blending the surrounding ones.
    #[arg(long)]
    nearest: bool,
}

#[derive(Args, Clone, Debug)]
struct MeasureArgs {
    #[command(flatten)]
    template: TemplateArgs,
    /// Nodes along the longest axis.
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_value = "9,17,33,65", value_parser = clap::value_parser!(u16).range(2..))]
    resolution: Vec<u16>,
    /// Bits per component.
    #[arg(long, value_name = "BITS,...", value_delimiter = ',', default_value = "8,12,16", value_parser = clap::value_parser!(u8).range(4..=16))]
    depth: Vec<u8>,
    /// Number of random points to compare.
    #[arg(long, value_name = "N", default_value_t = 20_000, value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    points: u32,
    /// Seed; equal seeds give equal points.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

#[derive(Args, Clone, Debug)]
struct SwarmArgs {
    /// A room as TOML (`outline`, `[[circle]]`, `[[polygon]]`) [default: the documentation's].
    #[arg(long, value_name = "FILE")]
    room: Option<PathBuf>,
    #[command(flatten)]
    crowd: Crowd,
    /// Nodes along the longest axis of the room's model.
    #[arg(long, value_name = "N", default_value_t = 65, value_parser = clap::value_parser!(u16).range(2..))]
    room_resolution: u16,
    /// Nodes along the longest axis of the neighbours' model.
    #[arg(long, value_name = "N", default_value_t = 17, value_parser = clap::value_parser!(u16).range(2..))]
    neighbor_resolution: u16,
    /// Bits per component of both models.
    #[arg(long, value_name = "BITS", default_value_t = 16, value_parser = clap::value_parser!(u8).range(4..=16))]
    depth: u8,
}

impl VoxelArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// A file that cannot be read or written, an invalid template, or an invalid model.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        match &self.action {
            Action::Build(args) => args.run(global)?,
            Action::Draw(args) => args.run(global)?,
            Action::Evaluate(args) => args.run(global)?,
            Action::Measure(args) => args.run(global)?,
            Action::Swarm(args) => args.run(global)?,
        }
        Ok(Ended::Done)
    }
}

fn made(template: &Templated, resolution: u16, depth: u8) -> Result<Vec<u8>> {
    Ok(match template {
        Templated::Plane(function, extent) => build(function, &grid(*extent, resolution)?, depth)?,
        Templated::Space(function, extent) => build(function, &grid(*extent, resolution)?, depth)?,
    })
}

fn read(path: &Path) -> Result<Vec<u8>> {
    staya_sim::file::read(path, MOST_BYTES as u64)
        .map_err(|error| anyhow!("cannot read {}: {error}; {}", path.shown(), read_remedy(&error)))
}

#[derive(Debug, Serialize)]
struct About {
    file: PathBuf,
    bytes: usize,
    variables: u8,
    depth: u8,
    nodes: Vec<u16>,
    first: Vec<f32>,
    step: Vec<f32>,
}

impl About {
    fn of(file: &Path, bytes: &[u8]) -> Result<Self> {
        let header = Header::read(bytes)?;
        let axes = usize::from(header.variables);
        Ok(Self {
            file: file.to_owned(),
            bytes: bytes.len(),
            variables: header.variables,
            depth: header.depth,
            nodes: header.nodes[..axes].to_vec(),
            first: header.first[..axes].to_vec(),
            step: header.step[..axes].to_vec(),
        })
    }
}

impl BuildArgs {
    fn run(&self, global: &Global) -> Result<()> {
        let bytes = made(&self.template.templated()?, self.resolution, self.depth)?;
        Files::reading(&self.template.room).claim(&self.out)?;
        write_atomically(&self.out, &bytes)?;
        let about = About::of(&self.out, &bytes)?;
        if global.json {
            return print_json(&about);
        }
        let nodes: Vec<String> = about.nodes.iter().map(ToString::to_string).collect();
        let out = self.out.shown();
        print(&format!("{out}: {} nodes of {} bits, {} bytes\n", nodes.join(" x "), about.depth, about.bytes))
    }
}

impl DrawArgs {
    fn run(&self, global: &Global) -> Result<()> {
        let bytes = read(&self.model)?;
        let name = self.model.file_stem().unwrap_or_default();
        let title = format!("Functional voxel model {}", name.display());
        let canvas = sheet(&bytes, &title, self.slice).with_context(|| self.model.shown().to_string())?;
        prepare_dir(&self.out)?;
        let stem = self.out.join(name);
        let mut pictures = canvas.write(&stem)?;
        pictures.extend(m_images(&bytes, &stem)?);
        if global.json {
            return print_json(&pictures);
        }
        let mut text = String::new();
        for picture in pictures {
            writeln!(text, "{}", picture.shown())?;
        }
        print(&text)
    }
}

#[derive(Debug, Serialize)]
struct Evaluated {
    value: f32,
    gradient: Vec<f32>,
    /// Distance to the border to first order, positive inside the set; two variables only.
    distance: Option<f32>,
    /// Outward normal of the set; two variables only.
    normal: Option<[f32; 2]>,
}

impl EvaluateArgs {
    fn run(&self, global: &Global) -> Result<()> {
        let bytes = read(&self.model)?;
        let about = || self.model.shown().to_string();
        let variables = Header::read(&bytes).with_context(about)?.variables;
        let at = numbers(&self.at)?;
        let reading = if self.nearest { Reading::Nearest } else { Reading::Blend };
        let found = if variables == 2 {
            let local = local::<2>(&bytes, &at, reading)?;
            let normal = local.direction().map(|direction| [-direction.x, -direction.y]);
            Evaluated { value: local.value, gradient: local.gradient.to_vec(), distance: local.distance(), normal }
        } else {
            let local = local::<3>(&bytes, &at, reading)?;
            Evaluated { value: local.value, gradient: local.gradient.to_vec(), distance: None, normal: None }
        };
        if global.json {
            return print_json(&found);
        }
        let mut text = format!("value    {}\ngradient {:?}\n", found.value, found.gradient);
        if let (Some(distance), Some([x, y])) = (found.distance, found.normal) {
            writeln!(text, "distance {distance}, first order; positive where the function is positive")?;
            writeln!(text, "normal   ({x}, {y}), out of the positive set")?;
        }
        print(&text)
    }
}

fn local<const V: usize>(bytes: &[u8], at: &[f64], reading: Reading) -> Result<Local<f32, V>> {
    let model = Model::<f32, V>::from_bytes(bytes)?;
    let at: [f64; V] =
        at.try_into().map_err(|_| anyhow!("{} numbers for a function of {V} variables; give {V}", at.len()))?;
    let extent = model.extent();
    reading
        .local(&model, at.map(|x| x as f32))
        .ok_or_else(|| anyhow!("{at:?} is outside the model; give a point in its extent {extent:?}"))
}

/// Head of the table of errors.
const MEASURED: &str = concat!(
    "       nodes  bits    bytes  reading                 value              gradient               angle, degrees\n",
    "                                           mean      worst       mean      worst       mean      p99    worst\n",
);

#[derive(Debug, Serialize)]
struct Row {
    nodes: Vec<u16>,
    depth: u8,
    bytes: usize,
    reading: Reading,
    #[serde(flatten)]
    errors: Measured,
    /// Errors of half-planes against the formula, for models of neighbours.
    #[serde(skip_serializing_if = "Option::is_none")]
    half_planes: Option<HalfPlaneErrors>,
}

impl MeasureArgs {
    fn run(&self, global: &Global) -> Result<()> {
        let template = self.template.templated()?;
        let mut rows = Vec::new();
        for &resolution in &self.resolution {
            for &depth in &self.depth {
                let bytes = made(&template, resolution, depth)?;
                for reading in [Reading::Nearest, Reading::Blend] {
                    let errors = self.errors(&template, &bytes, reading)?;
                    let nodes = About::of(Path::new(""), &bytes)?.nodes;
                    let half_planes = match reading {
                        Reading::Blend if self.template.is_neighbor() => {
                            half_planes(&VoxelNeighbor::new(Model::from_bytes(&bytes)?), self.points, self.seed)
                        }
                        _ => None,
                    };
                    rows.push(Row { nodes, depth, bytes: bytes.len(), reading, errors, half_planes });
                }
            }
        }
        if global.json {
            return print_json(&rows);
        }
        let mut text = String::from(MEASURED);
        for Row { nodes, depth, bytes, reading, errors, half_planes } in rows {
            let nodes: Vec<String> = nodes.iter().map(ToString::to_string).collect();
            let reading = if reading == Reading::Nearest { "nearest" } else { "blend" };
            let Measured { value, gradient, angle_deg: angle } = errors;
            writeln!(
                text,
                "{:>12} {depth:>5} {bytes:>8} {reading:>8} {:>10.6} {:>10.6} {:>10.5} {:>10.5} {:>10.4} {:>8.3} {:>8.2}",
                nodes.join("x"),
                value.mean,
                value.max,
                gradient.mean,
                gradient.max,
                angle.mean,
                angle.p99,
                angle.max
            )?;
            if let Some(HalfPlaneErrors { angle_deg: angle, change }) = half_planes {
                writeln!(
                    text,
                    "{:>12} half-planes against the formula: angle mean {:.4}, p99 {:.3}, worst {:.2} degrees; change mean {:.6}, \
                     worst {:.4} of (R_A + R_B) / tau",
                    "", angle.mean, angle.p99, angle.max, change.mean, change.max
                )?;
            }
        }
        print(&text)
    }

    fn errors(&self, template: &Templated, bytes: &[u8], reading: Reading) -> Result<Measured> {
        let (points, seed) = (self.points, self.seed);
        let found = match template {
            Templated::Plane(function, _) => measure(function, &Model::from_bytes(bytes)?, reading, points, seed),
            Templated::Space(function, _) => measure(function, &Model::from_bytes(bytes)?, reading, points, seed),
        };
        found.ok_or_else(|| {
            anyhow!("no point could be compared: the function is constant or too steep; give a greater depth")
        })
    }
}

impl SwarmArgs {
    fn run(&self, global: &Global) -> Result<()> {
        let room = options::room(self.room.as_deref())?;
        let model = |template: &Template, resolution| made(&template.function()?, resolution, self.depth);
        let room_model = model(&Template::Room(room.clone(), System::R1), self.room_resolution)?;
        let neighbor_model = model(&Template::Neighbor(VelocityForm::Distance), self.neighbor_resolution)?;
        let swap = Swap { crowd: self.crowd, room, room_model: &room_model, neighbor_model: &neighbor_model };
        if let Some(robot) = swap.blocked() {
            return Err(anyhow!("robot {robot} would start or end in a wall; give another --circle or fewer --robots"));
        }
        let mut outcomes = Vec::new();
        for walls in [Source::Formula, Source::Model] {
            for neighbors in [Source::Formula, Source::Table, Source::Model] {
                outcomes.push(swap.run(neighbors, walls)?);
            }
        }
        if global.json {
            return print_json(&outcomes);
        }
        let mut text = format!(
            "models: room {} bytes, neighbours {} bytes\n\
             neighbours walls      arrived  time, s     gap, m    wall, m overlaps\n",
            room_model.len(),
            neighbor_model.len()
        );
        let name = |source| match source {
            Source::Formula => "formula",
            Source::Table => "table",
            Source::Model => "model",
        };
        for Outcome { neighbors, walls, arrived, time_s, gap_m, wall_gap_m, overlaps } in outcomes {
            let (neighbors, walls) = (name(neighbors), name(walls));
            writeln!(
                text,
                "{neighbors:<10} {walls:<10} {arrived:>7} {time_s:>8.2} {gap_m:>10.4} {wall_gap_m:>10.4} {overlaps:>8}"
            )?;
        }
        print(&text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_larger_than_models_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("model.fvm");
        std::fs::File::create(&file).unwrap().set_len((64 << 20) + 1).unwrap();
        let said = read(&file).unwrap_err().to_string();
        assert!(said.ends_with("it has 67108865 bytes of at most 67108864; choose a smaller file"), "{said}");
        assert!(read(Path::new("/nowhere.fvm")).unwrap_err().to_string().ends_with("check the name"));
    }
}
