//! `staya orca`: ORCA's tables, and drawings of forbidden velocities.

use crate::orca::Sample;
use crate::orca::pictures::{Drawing, Scene};
use anyhow::Result;
use clap::{Args, Subcommand};
use serde::Serialize;
use staya_console::{Ended, Global, print, print_json};
use staya_sim::record::prepare_dir;
use staya_sim::shown::Shown as _;
use std::fmt::Write as _;
use std::path::PathBuf;

#[derive(Args, Clone, Debug)]
pub struct OrcaArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Clone, Debug, Subcommand)]
enum Action {
    /// Measure the errors of half-planes from voxel templates, by template size.
    Table(Sample),
    /// Draw a velocity obstacle of two robots, its half-plane, R-function, M-images and template
    /// (default: the worked example of the functional voxel paper).
    Draw(Box<DrawArgs>),
}

#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
struct DrawArgs {
    #[command(flatten)]
    scene: Scene,
    /// Folder for the pictures.
    #[arg(long, value_name = "DIR", default_value = "out/orca")]
    out: PathBuf,
}

impl OrcaArgs {
    pub fn run(&self, global: &Global) -> Result<Ended> {
        match &self.action {
            Action::Table(sample) => {
                let report = sample.report();
                if global.json { print_json(&report)? } else { print(&report.to_string())? }
            }
            Action::Draw(args) => args.run(global)?,
        }
        Ok(Ended::Done)
    }
}

#[derive(Debug, Serialize)]
struct Drawn {
    /// Smallest change of the relative velocity, m/s; negative if it is already free.
    change_mps: f64,
    point_mps: [f64; 2],
    normal: [f64; 2],
    pictures: Vec<PathBuf>,
}

impl DrawArgs {
    fn run(&self, global: &Global) -> Result<()> {
        let drawing: Drawing = self.scene.drawing()?;
        prepare_dir(&self.out)?;
        let pictures = drawing.draw(&self.out)?;
        let (point, normal) = (drawing.plane.point, drawing.plane.normal);
        if global.json {
            return print_json(&Drawn {
                change_mps: drawing.change_mps,
                point_mps: [point.x, point.y],
                normal: [normal.x, normal.y],
                pictures,
            });
        }
        let mut text = String::new();
        writeln!(text, "smallest change u  {:.6} m/s", drawing.change_mps)?;
        writeln!(text, "half-plane through ({:.6}, {:.6}) m/s", point.x, point.y)?;
        writeln!(text, "normal             ({:.6}, {:.6})", normal.x, normal.y)?;
        writeln!(text, "{} pictures in {}", pictures.len(), self.out.shown())?;
        print(&text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        orca: OrcaArgs,
    }

    fn read(words: &[&str]) -> Result<Action, String> {
        Line::try_parse_from([&["orca"], words].concat())
            .map(|line| line.orca.action)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn defaults_are_the_papers_example_and_options_change_the_scene() {
        let scene = |words: &[&str]| match read(words).unwrap() {
            Action::Draw(args) => args.scene,
            Action::Table(_) => panic!("another command"),
        };
        let example = Scene {
            place_a: [2.0, -3.0],
            place_b: [-2.0, 3.0],
            velocity_a: [1.5, 1.0],
            velocity_b: [3.0, -1.5],
            radii: [1.0; 2],
            horizon: 2.0,
            share: 1.0,
        };
        assert_eq!(scene(&["draw"]), example);
        let words = "draw --place-a -1,2 --place-b 3,-4 --velocity-a -5,0.5 --velocity-b 0,-1 \
            --radii 0.2,0.3 --horizon 4 --share 0.5";
        let words: Vec<&str> = words.split_whitespace().collect();
        let expected = Scene {
            place_a: [-1.0, 2.0],
            place_b: [3.0, -4.0],
            velocity_a: [-5.0, 0.5],
            velocity_b: [0.0, -1.0],
            radii: [0.2, 0.3],
            horizon: 4.0,
            share: 0.5,
        };
        assert_eq!(scene(&words), expected);
    }

    #[test]
    fn invalid_usage_is_an_error_with_a_remedy() {
        let message = |words: &[&str]| read(words).unwrap_err();
        assert!(message(&["draw", "--place-a", "1"]).contains("such as 1.5,-2"));
        assert!(message(&["draw", "--radii", "1,x"]).contains("`x` is not a number"));
        assert!(message(&["table", "--pairs", "0"]).contains("1..=10000000"));
    }
}
