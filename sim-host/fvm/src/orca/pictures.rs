//! Pictures of the functional voxel paper: figures 3 to 6, the R-function, and the voxel template.

use super::V;
use super::view::{
    LEFT, NUMBER, PIXELS, SIDE, SMALL_SIDE, TOP, View, arrow, canvas, contoured, grey, image, label, left_of, note,
    opaque, picture,
};
use crate::numbers::fixed;
use anyhow::{Context as _, bail};
use clap::Args;
use staya_controller::orca::{HalfPlane, MovingBall, Params, VelocityObstacle, VoxelTable2k, half_plane};
use staya_plot::canvas::{Anchor, Canvas, Point, Stroke, Text};
use staya_plot::colour::{Colour, INK, MUTED, PALETTE, WHITE};
use staya_sim::record::Error;
use std::path::{Path, PathBuf};

/// Forbidden by the cone beyond the perpendiculars, forbidden by the disc, permitted.
const CONE: Colour = PALETTE[1];
const DISC: Colour = PALETTE[4];
const ALLOWED: Colour = PALETTE[2];
/// Largest distance of the robots, in sums of their radii. Beyond it, axes of pictures near the
/// disc would consist of rounding errors.
const FARTHEST: f64 = 1e9;

/// Two robots, by default those of the paper's section "analytic representation".
#[derive(Args, Clone, Copy, Debug, PartialEq)]
#[command(allow_negative_numbers = true)]
pub struct Scene {
    /// Position of robot A, which decides, metres.
    #[arg(long, value_name = "X,Y", value_parser = fixed::<2>, allow_hyphen_values = true, default_value = "2,-3")]
    pub place_a: [f64; 2],
    /// Position of robot B, metres.
    #[arg(long, value_name = "X,Y", value_parser = fixed::<2>, allow_hyphen_values = true, default_value = "-2,3")]
    pub place_b: [f64; 2],
    /// Velocity of robot A, m/s.
    #[arg(long, value_name = "X,Y", value_parser = fixed::<2>, allow_hyphen_values = true, default_value = "1.5,1")]
    pub velocity_a: [f64; 2],
    /// Velocity of robot B, m/s.
    #[arg(long, value_name = "X,Y", value_parser = fixed::<2>, allow_hyphen_values = true, default_value = "3,-1.5")]
    pub velocity_b: [f64; 2],
    /// Radii of A and B, metres.
    #[arg(long, value_name = "A,B", value_parser = fixed::<2>, default_value = "1,1")]
    pub radii: [f64; 2],
    /// tau: time horizon without collisions, seconds.
    #[arg(long, default_value_t = 2.0)]
    pub horizon: f64,
    /// A's share of the correction.
    #[arg(long, default_value_t = 1.0)]
    pub share: f64,
}

/// A valid scene with derived values.
#[derive(Clone, Copy, Debug)]
pub struct Drawing {
    obstacle: VelocityObstacle<f64>,
    neighbor: MovingBall<V>,
    own: V,
    relative: V,
    params: Params<f64>,
    /// Velocities permitted to A.
    pub plane: HalfPlane<f64>,
    /// Smallest change of the relative velocity along the normal, m/s; negative if it is free.
    pub change_mps: f64,
}

impl Scene {
    /// Validates the scene and computes the derived values.
    ///
    /// # Errors
    /// A number is not finite, a radius or horizon is not above 0, or the robots overlap or are too
    /// far apart.
    pub fn drawing(&self) -> anyhow::Result<Drawing> {
        let vector = |[x, y]: [f64; 2]| V::new(x, y);
        let [place, other_place, own, other] =
            [self.place_a, self.place_b, self.velocity_a, self.velocity_b].map(vector);
        let sound = [place, other_place, own, other].iter().all(|v| v.is_finite());
        if !(sound && self.share.is_finite()) {
            bail!("places, velocities and the share must be finite; give finite numbers");
        }
        let positive = |x: f64| x.is_finite() && x > 0.0;
        if !self.radii.into_iter().chain([self.horizon]).all(positive) {
            bail!("radii and the horizon must be above 0; give positive numbers");
        }
        let radii_m = self.radii.iter().sum();
        let neighbor = MovingBall { offset_m: other_place - place, velocity_mps: other, radii_m, tie: V::ZERO };
        let apart = neighbor.offset_m.norm();
        if apart > FARTHEST * radii_m {
            bail!(
                "the robots are {apart:e} m apart, more than {FARTHEST:e} times the sum of their radii; \
                 give places nearer to each other, or greater radii"
            );
        }
        let obstacle = VelocityObstacle::new(neighbor.offset_m, radii_m, self.horizon);
        let obstacle = obstacle.with_context(|| {
            format!("the robots are {apart} m apart and overlap; give places more than {radii_m} m apart")
        })?;
        let params = Params { horizon_s: self.horizon, separation_s: self.horizon, share: self.share };
        let whole = Params { share: 1.0, ..params };
        let out_of_range = "the numbers are out of range; give smaller ones";
        Ok(Drawing {
            obstacle,
            neighbor,
            own,
            relative: own - other,
            params,
            plane: half_plane(own, &neighbor, &params).context(out_of_range)?,
            change_mps: half_plane(own, &neighbor, &whole).context(out_of_range)?.penetration(own),
        })
    }
}

impl Drawing {
    /// Draws all pictures into `dir`, each as SVG and PNG. Returns the paths.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn draw(&self, dir: &Path) -> Result<Vec<PathBuf>, Error> {
        let mut files = self.velocities().write(&dir.join("velocity-obstacle"))?;
        files.extend(self.fields().write(&dir.join("r-function"))?);
        files.extend(self.m_images().write(&dir.join("m-images"))?);
        files.extend(self.template().write(&dir.join("template"))?);
        Ok(files)
    }

    fn view(&self, left: f64, top: f64, side: f64) -> View {
        let (tip, radius) = self.obstacle.disc();
        let unit = V::new(1.0, 1.0) * radius;
        let mut points = vec![tip - unit, tip + unit + self.obstacle.ahead() * (2.0 * radius)];
        points.extend([V::ZERO, self.own, self.relative, self.neighbor.velocity_mps]);
        points.push(self.plane.point);
        let least = |axis: fn(&V) -> f64| points.iter().map(axis).fold(f64::MAX, f64::min);
        let most = |axis: fn(&V) -> f64| points.iter().map(axis).fold(f64::MIN, f64::max);
        let (low, high) = (V::new(least(|p| p.x), least(|p| p.y)), V::new(most(|p| p.x), most(|p| p.y)));
        let size = high - low;
        let extent = 1.3 * size.x.max(size.y);
        View { corner: (low + high) * 0.5 - V::new(extent, extent) * 0.5, side: extent, area: [left, top, side] }
    }

    fn near(&self, left: f64, top: f64) -> View {
        let (tip, radius) = self.obstacle.disc();
        let middle = tip + self.obstacle.ahead() * (0.5 * radius);
        let half = 2.2 * radius;
        View { corner: middle - V::new(half, half), side: 2.0 * half, area: [left, top, SMALL_SIDE] }
    }

    /// FVM figures 3 to 5: parts of the obstacle, velocities and half-plane.
    fn velocities(&self) -> Canvas {
        let mut canvas = canvas("The velocities that avoid robot B", 1, SIDE, 190.0);
        let view = self.view(LEFT + 6.0, TOP, SIDE);
        let tint = |colour: Colour, share: f64| opaque(WHITE.towards(colour, share));
        let pixels = view.pixels(|at| {
            let [pr1, pr2, pr3, pr4, disc] = self.obstacle.predicates(at);
            if pr1 > 0.0 && pr2 > 0.0 && (pr3 > 0.0 || pr4 > 0.0) {
                tint(CONE, 0.42)
            } else if disc > 0.0 {
                tint(DISC, 0.55)
            } else if self.plane.penetration(at) <= 0.0 {
                tint(ALLOWED, 0.13)
            } else {
                opaque(WHITE)
            }
        });
        image(&mut canvas, &view, pixels);
        self.outline(&mut canvas, &view);
        self.arrows(&mut canvas, &view);
        canvas.clip(None);
        view.axes(&mut canvas);
        self.legend(&mut canvas, [LEFT + SIDE + 30.0, TOP]);
        canvas
    }

    fn outline(&self, canvas: &mut Canvas, view: &View) {
        let (tip, radius) = self.obstacle.disc();
        let far = 3.0 * view.side + tip.norm();
        let line = Stroke::new(INK, 1.2);
        let fine = Stroke::new(MUTED, 0.9).dashed(5.0, 4.0);
        let legs = self.obstacle.legs();
        for leg in legs {
            canvas.line(vec![view.place(V::ZERO), view.place(leg * far)], line);
            let foot = leg * tip.dot(leg);
            canvas.line(vec![view.place(tip), view.place(foot)], fine);
        }
        let scale = view.area[2] / view.side;
        canvas.circle(view.place(tip), radius * scale, None, Some(line));
        for (name, leg, outwards) in [("Pr1", legs[0], 1.0), ("Pr2", legs[1], -1.0)] {
            let along = leg * (0.55 * tip.dot(leg));
            label(canvas, view, along, leg.perp() * outwards, name, INK);
        }
        label(canvas, view, tip, self.obstacle.ahead(), "(p_B - p_A)/tau", MUTED);
        canvas.circle(view.place(tip), 2.2, Some(MUTED), None);
    }

    fn arrows(&self, canvas: &mut Canvas, view: &View) {
        let border = self.plane.direction() * (2.0 * view.side);
        let point = self.plane.point;
        let ends = [point - border, point + border].map(|end| view.place(end));
        canvas.line(ends.to_vec(), Stroke::new(ALLOWED, 2.2));
        let of_b = self.neighbor.velocity_mps;
        let aside = self.plane.normal * -self.change_mps;
        for (name, to, away, colour) in
            [("v_B", of_b, of_b, MUTED), ("v_A", self.own, aside, PALETTE[0]), ("v_A - v_B", self.relative, aside, INK)]
        {
            arrow(canvas, view, V::ZERO, to, Stroke::new(colour, 1.8));
            label(canvas, view, to, away, name, colour);
        }
        let change = self.plane.normal * self.change_mps;
        let red = Stroke::new(CONE, 2.6);
        arrow(canvas, view, self.relative, self.relative + change, red);
        arrow(canvas, view, self.own, self.plane.point, red);
    }

    fn legend(&self, canvas: &mut Canvas, [x, mut y]: Point) {
        let mut entry = |colour: Option<Colour>, text: &str| {
            if let Some(colour) = colour {
                canvas.rectangle([x, y, 14.0, 14.0], Some(colour), Some(Stroke::new(MUTED, 0.6)));
            }
            canvas.text(Text::new([x + 20.0, y + 11.5], NUMBER, Anchor::Start, text));
            y += 21.0;
        };
        let mix = |colour: Colour, share: f64| Some(WHITE.towards(colour, share));
        entry(mix(CONE, 0.42), "Pr1, Pr2, and Pr3 or Pr4");
        entry(mix(DISC, 0.55), "Disc alone");
        entry(mix(ALLOWED, 0.13), "permitted for A");
        entry(mix(CONE, 1.0), "u, and A's share of it");
        entry(mix(ALLOWED, 1.0), "border of ORCA");
        entry(None, "");
        let V { x, y } = self.plane.point;
        for text in [
            format!("tau = {} s", self.params.horizon_s),
            format!("R = {} m", self.neighbor.radii_m),
            format!("share = {}", self.params.share),
            format!("|u| = {:.6} m/s", self.change_mps),
            format!("through ({x:.6},"),
            format!("{y:.6}) m/s"),
            format!("normal ({:.6},", self.plane.normal.x),
            format!("{:.6})", self.plane.normal.y),
        ] {
            entry(None, &text);
        }
    }

    fn fields(&self) -> Canvas {
        let mut canvas = canvas("The velocity obstacle as one function", 2, SMALL_SIDE, 0.0);
        let unit = self.obstacle.disc().1;
        let nearest = |at: V| self.nearest(at).map_or(0.0, |(change, _)| change);
        let fields: [(&str, &dyn Fn(V) -> f64); 2] = [
            ("R-function of Pr1 to Pr4 and Disc", &|at| self.obstacle.value(at)),
            ("distance to the nearest border", &nearest),
        ];
        for (index, (title, field)) in fields.into_iter().enumerate() {
            let view = self.near(left_of(index), TOP);
            let pixels = view.pixels(|at| contoured(field(at) / unit));
            picture(&mut canvas, &view, title, pixels);
        }
        note(
            &mut canvas,
            2,
            "orange: inside, blue: outside; a line each 1/4 of the disc's radius, the border in black",
        );
        canvas
    }

    fn nearest(&self, relative: V) -> Option<(f64, V)> {
        let whole = Params { share: 1.0, ..self.params };
        let own = relative + self.neighbor.velocity_mps;
        let plane = half_plane(own, &self.neighbor, &whole)?;
        Some((plane.penetration(own), plane.normal))
    }

    /// Components of the normal (eq. 16) to the R-function's graph, as in FVM figure 6.
    fn m_images(&self) -> Canvas {
        let mut canvas = canvas("M-images of the R-function", 4, SMALL_SIDE, 0.0);
        let names = ["cos alpha4", "cos beta4", "cos gamma4", "cos delta4"];
        for (index, name) in names.into_iter().enumerate() {
            let view = self.near(left_of(index), TOP);
            let step = view.side / f64::from(PIXELS);
            let pixels = view.pixels(|at| grey(self.local_equation(at, step)[index]));
            picture(&mut canvas, &view, name, pixels);
        }
        note(
            &mut canvas,
            4,
            "the local equation cos alpha4 x + cos beta4 y + cos gamma4 z = cos delta4 (eq. 16); black -1, white 1",
        );
        canvas
    }

    fn local_equation(&self, at: V, step: f64) -> [f64; 4] {
        let value = |at: V| self.obstacle.value(at);
        let here = value(at);
        let a = (value(at + V::new(step, 0.0)) - here) / step;
        let b = (value(at + V::new(0.0, step)) - here) / step;
        let equation = [a, b, -1.0, a * at.x + b * at.y - here];
        let squares: f64 = equation.iter().map(|c| c * c).sum();
        equation.map(|c| c / libm::sqrt(squares))
    }

    fn template(&self) -> Canvas {
        let mut canvas = canvas("The normal to the nearest border, as the template has it", 3, SMALL_SIDE, 0.0);
        let look_up = |at: V| {
            let ahead = self.obstacle.ahead();
            let (tip, radius) = self.obstacle.disc();
            let w = at - tip;
            let across = ahead.det(w);
            let sine = radius / tip.norm();
            let table = VoxelTable2k::TABLE;
            let normal = table.normal(sine, V::new(w.dot(ahead), across.abs()))?;
            let side = if across > 0.0 { normal.y } else { -normal.y };
            Some(ahead.rotate(normal.x, side))
        };
        let error = |at: V| {
            let (found, (_, exact)) = (look_up(at)?, self.nearest(at)?);
            Some(libm::atan2(exact.det(found), exact.dot(found)).abs().to_degrees())
        };
        type Colouring<'a> = (&'a str, &'a dyn Fn(V) -> Option<[u8; 4]>);
        let pictures: [Colouring<'_>; 3] = [
            ("cos (east)", &|at| Some(grey(look_up(at)?.x))),
            ("sin (north)", &|at| Some(grey(look_up(at)?.y))),
            ("angle error, white 0 to black 1/2 degree", &|at| Some(grey(1.0 - 4.0 * error(at)?))),
        ];
        for (index, (title, colour)) in pictures.into_iter().enumerate() {
            let view = self.near(left_of(index), TOP);
            let pixels = view.pixels(|at| colour(at).unwrap_or([0; 4]));
            picture(&mut canvas, &view, title, pixels);
        }
        note(
            &mut canvas,
            3,
            "cos, sin: black -1, white 1; the distance follows: all borders are tangent to one circle",
        );
        canvas
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        scene: Scene,
    }

    fn scene() -> Scene {
        Line::parse_from(["draw"]).scene
    }

    #[test]
    fn default_scene_is_the_papers_example() {
        let drawing = scene().drawing().unwrap();
        assert!((drawing.plane.point - V::new(1.707107, 0.792893)).norm() < 1e-6);
        assert!((drawing.change_mps - 0.292893).abs() < 1e-6);
    }

    #[test]
    fn invalid_scenes_are_errors_with_a_remedy() {
        let refusal = |scene: Scene| scene.drawing().unwrap_err().to_string();
        let near = Scene { place_a: [0.0, 0.0], place_b: [0.5, 0.0], ..scene() };
        assert!(refusal(near).contains("more than 2 m apart"));
        let lost = Scene { velocity_a: [f64::NAN, 0.0], ..scene() };
        assert!(refusal(lost).contains("finite"));
        let thin = Scene { radii: [0.0, 1.0], ..scene() };
        assert!(refusal(thin).contains("above 0"));
        assert!(refusal(Scene { horizon: -1.0, ..scene() }).contains("above 0"));
        // Axes of such pictures would have a label for each rounding error.
        let far = Scene { place_a: [0.0; 2], place_b: [1e100, 0.0], ..scene() };
        assert!(refusal(far).contains("1e100 m apart, more than 1e9 times the sum of their radii; give places nearer"));
    }

    #[test]
    fn the_local_equation_has_the_half_planes_angle() {
        let drawing = scene().drawing().unwrap();
        let [a, b, _, _] = drawing.local_equation(drawing.relative, 1e-6);
        let cos = a / libm::sqrt(a * a + b * b);
        assert!((cos + drawing.plane.normal.x).abs() < 1e-5, "{cos}");
    }

    #[test]
    fn equal_scenes_give_equal_pictures() {
        let odd =
            Scene { place_a: [1e6, 0.0], place_b: [1e6, -7.0], velocity_a: [0.0; 2], velocity_b: [0.0; 2], ..scene() };
        for scene in [scene(), odd] {
            let drawing = scene.drawing().unwrap();
            assert_eq!(drawing.velocities(), drawing.velocities());
            for canvas in [drawing.velocities(), drawing.fields(), drawing.m_images(), drawing.template()] {
                assert!(canvas.shapes.len() > 10);
            }
        }
    }
}
