//! Template options and number parsing.

use crate::numbers::{fixed, numbers};
use crate::{Grid, Pair, Room, System, Template, Templated, VelocityForm};
use anyhow::{Context as _, Result, anyhow, bail};
use clap::{Args, ValueEnum};
use staya_sim::file::{TEXT, read_remedy, read_text};
use staya_sim::shown::Shown as _;
use std::path::{Path, PathBuf};

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// A disc (--center X,Y, --radius).
    Circle,
    /// A ball, three variables (--center X,Y,Z, --radius).
    Ball,
    /// A polygon (--corners).
    Polygon,
    /// A room with obstacles (--room, --system).
    Room,
    /// Relative velocities that lead two robots to a collision (--place-a and so on, --form).
    VelocityObstacle,
    /// As velocity-obstacle, for any pair: three variables, half-planes for ORCA (--form).
    Neighbor,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Form {
    /// Distance to the nearest border.
    Distance,
    /// Pr1 and Pr2 and (Pr3 or Pr4) or Disc by R-functions, as in the paper.
    RFunction,
}

#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
pub struct TemplateArgs {
    /// Template of the function.
    #[arg(value_enum)]
    template: Kind,
    /// Centre of a circle or a ball [default: the origin].
    #[arg(long, value_name = "X,Y[,Z]", allow_hyphen_values = true)]
    center: Option<String>,
    /// Radius of a circle or a ball.
    #[arg(long, default_value_t = 1.0)]
    radius: f64,
    /// Corners of a polygon [default: an L].
    #[arg(
        long,
        value_name = "'X,Y X,Y X,Y ...'",
        allow_hyphen_values = true,
        default_value = "0,0 3,0 3,1 1,1 1,2 0,2"
    )]
    corners: String,
    /// A room as TOML: `outline = [[x, y], ...]`, `[[circle]]` with `center` and `radius`,
    /// `[[polygon]]` with `corners` [default: the documentation's].
    #[arg(long, value_name = "FILE")]
    pub room: Option<PathBuf>,
    /// R-functions for rooms and `--form r-function`: r0, r1 (minimum and maximum), or an alpha.
    #[arg(long, default_value = "r1", value_parser = |text: &str| text.parse::<System>())]
    system: System,
    /// Function that represents a velocity obstacle.
    #[arg(long, value_enum, default_value_t = Form::Distance)]
    form: Form,
    /// Position of robot A, which decides, metres.
    #[arg(long, value_name = "X,Y", value_parser = fixed::<2>, allow_hyphen_values = true, default_value = "2,-3")]
    place_a: [f64; 2],
    /// Position of robot B, metres.
    #[arg(long, value_name = "X,Y", value_parser = fixed::<2>, allow_hyphen_values = true, default_value = "-2,3")]
    place_b: [f64; 2],
    /// Radii of A and B, metres.
    #[arg(long, value_name = "A,B", value_parser = fixed::<2>, default_value = "1,1")]
    radii: [f64; 2],
    /// tau: time horizon without collisions, seconds.
    #[arg(long, default_value_t = 2.0)]
    horizon: f64,
    /// Smallest and largest coordinate along each axis, instead of the template's own.
    #[arg(long, value_name = "X0,X1,Y0,Y1[,Z0,Z1]", allow_hyphen_values = true)]
    extent: Option<String>,
}

impl TemplateArgs {
    pub fn templated(&self) -> Result<Templated> {
        let templated = self.template()?.function()?;
        let Some(extent) = &self.extent else { return Ok(templated) };
        let wrong = "give two numbers for each variable";
        let ends = numbers(extent).context("--extent")?;
        let (pairs, rest) = ends.as_chunks::<2>();
        let pairs = if rest.is_empty() { pairs } else { &[] };
        Ok(match templated {
            Templated::Plane(function, _) => {
                Templated::Plane(function, pairs.try_into().map_err(|_| anyhow!("--extent: {wrong}, 4 in all"))?)
            }
            Templated::Space(function, _) => {
                Templated::Space(function, pairs.try_into().map_err(|_| anyhow!("--extent: {wrong}, 6 in all"))?)
            }
        })
    }

    pub fn is_neighbor(&self) -> bool {
        self.template == Kind::Neighbor
    }

    fn template(&self) -> Result<Template> {
        let form = match self.form {
            Form::Distance => VelocityForm::Distance,
            Form::RFunction => VelocityForm::RFunction(self.system),
        };
        Ok(match self.template {
            Kind::Circle => Template::Circle(self.center()?, self.radius),
            Kind::Ball => Template::Ball(self.center()?, self.radius),
            Kind::Polygon => {
                let corners = self.corners.split_whitespace().map(fixed);
                Template::Polygon(corners.collect::<Result<_>>().context("--corners")?)
            }
            Kind::Room => Template::Room(room(self.room.as_deref())?, self.system),
            Kind::VelocityObstacle => {
                let places_m = [self.place_a, self.place_b];
                Template::VelocityObstacle(Pair { places_m, radii_m: self.radii, horizon_s: self.horizon }, form)
            }
            Kind::Neighbor => Template::Neighbor(form),
        })
    }

    fn center<const V: usize>(&self) -> Result<[f64; V]> {
        self.center.as_ref().map_or(Ok([0.0; V]), |center| fixed(center)).context("--center")
    }
}

pub fn room(file: Option<&Path>) -> Result<Room> {
    let Some(file) = file else { return Ok(Room::default()) };
    let text = read_text(file, TEXT)
        .map_err(|error| anyhow!("cannot read {}: {error}; {}", file.shown(), read_remedy(&error)))?;
    Ok(Room::read(&text, file)?)
}

/// Equal steps along all axes, `resolution` nodes along the longest, at least two along others.
pub fn grid<const V: usize>(extent: [[f64; 2]; V], resolution: u16) -> Result<Grid<V>> {
    let sides = extent.map(|[low, high]| high - low);
    let longest = sides.iter().copied().fold(0.0, f64::max);
    if !(longest > 0.0 && sides.iter().all(|side| side.is_finite())) {
        bail!("the extent {extent:?} is empty; give a smaller and a larger number for each axis");
    }
    let nodes = sides.map(|side| {
        let steps = libm::round(side / longest * f64::from(resolution - 1));
        (steps.max(1.0) as u16).saturating_add(1)
    });
    Ok(Grid { extent, nodes })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        template: TemplateArgs,
    }

    fn read(words: &str) -> Result<Templated> {
        let line = Line::try_parse_from(format!("voxel {words}").split_whitespace())?;
        line.template.templated()
    }

    #[test]
    fn every_template_works_without_options() {
        for (kind, at, is_plane) in [
            ("circle", [0.0; 3], true),
            ("ball", [0.0; 3], false),
            ("polygon", [0.5, 0.5, 0.0], true),
            ("room", [-1.5, 0.8, 0.0], true),
            ("velocity-obstacle", [-1.5, 2.5, 0.0], true),
            ("neighbor", [1.0, 0.0, 0.5], false),
        ] {
            let value = match read(kind).unwrap() {
                Templated::Plane(function, _) if is_plane => function.value([at[0], at[1]]),
                Templated::Space(function, _) if !is_plane => function.value(at),
                _ => panic!("{kind}"),
            };
            assert!(value > 0.0, "{kind}: {value}");
        }
    }

    #[test]
    fn options_change_the_function_and_invalid_ones_name_the_remedy() {
        let Ok(Templated::Plane(circle, extent)) = read("circle --center -1,2 --radius 0.5 --extent -2,0,1,3") else {
            panic!("no circle");
        };
        assert!((circle.value([-1.0, 2.25]) - 0.25).abs() < 1e-12);
        assert_eq!(extent, [[-2.0, 0.0], [1.0, 3.0]]);
        for (words, remedy) in [
            ("circle --center 1", "2 numbers"),
            ("ball --center 1,2", "3 numbers"),
            ("circle --center 1,x", "`x` is not a number"),
            ("circle --radius 0", "above 0"),
            ("circle --extent 1,2,3", "4 in all"),
            ("ball --extent 1,2,3,4", "6 in all"),
            ("polygon --corners 1,2", "three or more"),
            ("room --system r2", "not r0, r1"),
            ("room --room /nowhere.toml", "cannot read /nowhere.toml"),
            ("velocity-obstacle --horizon 0", "horizon above 0"),
        ] {
            let Err(error) = read(words) else { panic!("{words}") };
            assert!(format!("{error:#}").contains(remedy), "{words}: {error:#}");
        }
    }

    #[test]
    fn the_longest_axis_has_the_resolution_and_no_axis_less_than_two_nodes() {
        assert_eq!(grid([[0.0, 4.0], [0.0, 2.0], [0.0, 1.0]], 17).unwrap().nodes, [17, 9, 5]);
        assert_eq!(grid([[0.0, 100.0], [0.0, 0.1]], 9).unwrap().nodes, [9, 2]);
        assert!(grid([[1.0, 1.0], [0.0, 0.0]], 9).is_err() && grid([[0.0, f64::NAN]; 2], 9).is_err());
    }
}
