//! Named functions: circle, ball, polygon, room, and velocity obstacles.

use crate::room::{extent, is_polygon};
use crate::{Function, Room, System, shape};
use anyhow::{Result, bail};

/// The function of a model.
#[derive(Clone, Debug, PartialEq)]
pub enum Template {
    /// A disc: centre and radius, metres.
    Circle([f64; 2], f64),
    /// A ball: centre and radius, metres.
    Ball([f64; 3], f64),
    /// A polygon: its corners, metres.
    Polygon(Vec<[f64; 2]>),
    /// A room: positive where no robot can be.
    Room(Room, System),
    /// The relative velocities, m/s, that lead a pair of robots to a collision (FVM, eq. 15).
    VelocityObstacle(Pair, VelocityForm),
    /// As `VelocityObstacle`, for every pair; see `velocity_obstacle`.
    Neighbor(VelocityForm),
}

/// Two robots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Positions of A, which decides, and of B, metres.
    pub places_m: [[f64; 2]; 2],
    /// Radii, metres.
    pub radii_m: [f64; 2],
    /// Time horizon without collisions, seconds.
    pub horizon_s: f64,
}

/// Function that represents a velocity obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VelocityForm {
    /// Distance to the nearest border, as ORCA needs it.
    Distance,
    /// Pr1 and Pr2 and (Pr3 or Pr4) or Disc by R-functions, as in the paper. The border is the
    /// same, but the gradient is not everywhere the shortest way out.
    RFunction(System),
}

/// A function and its default extent.
#[derive(Clone)]
pub enum Templated {
    /// Two variables.
    Plane(Function<2>, [[f64; 2]; 2]),
    /// Three variables.
    Space(Function<3>, [[f64; 2]; 3]),
}

/// Along and across the axis to the neighbour, in disc radii; tan of a quarter of the cone's angle.
const NEIGHBOR: [[f64; 2]; 3] = [[-2.0, 2.0], [0.0, 2.0], [0.0, 1.0]];

impl Template {
    /// The function and its default extent.
    ///
    /// # Errors
    /// A number is not finite, a radius or horizon is not above 0, corners are not a polygon, or
    /// robots overlap.
    pub fn function(&self) -> Result<Templated> {
        Ok(match self {
            &Self::Circle(center, radius) => Templated::Plane(shape::circle(center, radius), around(center, radius)?),
            &Self::Ball(center, radius) => Templated::Space(shape::ball(center, radius), around(center, radius)?),
            Self::Polygon(corners) => {
                if !is_polygon(corners) {
                    bail!("corners: give three or more, finite, no two in a row equal");
                }
                let [[left, right], [bottom, top]] = extent(corners, 0.0);
                let margin = 0.25 * (right - left).max(top - bottom);
                Templated::Plane(shape::polygon(corners.clone()), extent(corners, margin))
            }
            Self::Room(room, system) => Templated::Plane(room.function(*system), room.extent(0.5)),
            Self::VelocityObstacle(pair, form) => pair.function(*form)?,
            &Self::Neighbor(form) => {
                let leg = |t: f64| [2.0 * t / (1.0 + t * t), (1.0 - t * t) / (1.0 + t * t)];
                Templated::Space(Function::new(move |[x, y, t]| velocity_obstacle(form, x, y, leg(t))), NEIGHBOR)
            }
        })
    }
}

fn around<const V: usize>(center: [f64; V], radius: f64) -> Result<[[f64; 2]; V]> {
    if !(radius > 0.0 && radius.is_finite()) {
        bail!("radius {radius}: give a finite number above 0");
    }
    if !center.iter().all(|x| x.is_finite()) {
        bail!("center: give finite numbers");
    }
    Ok(center.map(|x| [x - 1.5 * radius, x + 1.5 * radius]))
}

impl Pair {
    fn function(&self, form: VelocityForm) -> Result<Templated> {
        let [[ax, ay], [bx, by]] = self.places_m;
        let (x, y) = (bx - ax, by - ay);
        let (distance, radii) = (libm::hypot(x, y), self.radii_m[0] + self.radii_m[1]);
        let is_sound = distance > radii && distance.is_finite() && self.radii_m.iter().all(|&r| r > 0.0);
        if !(is_sound && self.horizon_s > 0.0 && self.horizon_s.is_finite()) {
            bail!(
                "the robots overlap or a number is not positive; give places more than {radii} m apart, radii and \
                 horizon above 0"
            );
        }
        let (tip, unit) = ([x / self.horizon_s, y / self.horizon_s], radii / self.horizon_s);
        let (ahead, sine) = ([x / distance, y / distance], radii / distance);
        let leg = [sine, libm::sqrt(1.0 - sine * sine)];
        let half = 1.25 * libm::hypot(tip[0], tip[1]).max(2.0 * unit);
        let function = Function::new(move |[vx, vy]: [f64; 2]| {
            let (x, y) = ((vx - tip[0]) / unit, (vy - tip[1]) / unit);
            let (along, across) = (x * ahead[0] + y * ahead[1], ahead[0] * y - ahead[1] * x);
            unit * velocity_obstacle(form, along, across.abs(), leg)
        });
        Ok(Templated::Plane(function, tip.map(|middle| [middle - half, middle + half])))
    }
}

/// The velocity obstacle in normal form, positive inside: disc of radius 1 at the origin, neighbour
/// on the positive x axis, cone given by sine and cosine of its half angle. `y >= 0` up to
/// differences at 0; the other half is the mirror image.
#[must_use]
pub fn velocity_obstacle(form: VelocityForm, x: f64, y: f64, [sine, cos]: [f64; 2]) -> f64 {
    // Inside both legs, which touch the disc; beyond the perpendiculars on them through its centre.
    let (pr1, pr2) = (1.0 + sine * x - cos * y, 1.0 + sine * x + cos * y);
    let (pr3, pr4) = (cos * x + sine * y, cos * x - sine * y);
    let disc = 1.0 - libm::hypot(x, y);
    match form {
        // Beyond the perpendicular and ahead, the nearer leg is nearest; elsewhere the disc.
        VelocityForm::Distance if pr3 > 0.0 || x > 0.0 => pr1,
        VelocityForm::Distance => disc,
        VelocityForm::RFunction(system) => {
            let cone = system.and(system.and(pr1, pr2), system.or(pr3, pr4));
            system.or(cone, disc)
        }
    }
}
