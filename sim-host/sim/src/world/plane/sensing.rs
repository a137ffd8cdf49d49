//! Detection of other robots by camera, UWB or motion capture.

use super::{Disc, Plane, Solid};
use crate::nearby::{Cells, Found, Query, Search, Space};
use staya_controller::geom::Vec3;
use staya_controller::neighbor::{SIGHTINGS, Sighting, TrackParams};
use staya_controller::rand::Rng;
use staya_controller::time::Duration;
use std::collections::VecDeque;

const PURPOSE: u32 = u32::from_be_bytes(*b"eyes");

/// Properties of the sensors: `[plane.sensing]` of a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensing {
    /// Range from centre to centre, metres.
    pub range_m: f64,
    /// Standard deviation of measured positions along each axis, metres.
    pub noise_m: f64,
    /// Whether bodies, obstacles and closed cells occlude robots behind them.
    pub is_occluded: bool,
    /// Whether a detection contains the robot's id.
    pub sees_names: bool,
    /// Ticks between two detections of a robot.
    pub every_ticks: u32,
    /// Delay of a detection, ticks.
    pub delay_ticks: u32,
    /// Whether robots send beacons.
    pub has_beacons: bool,
    /// Parameters of the controller's tracker.
    pub tracking: TrackParams<f32>,
}

/// The robots' sensors and the past positions that they measure.
#[derive(Clone, Debug)]
pub struct Sight {
    sensing: Sensing,
    seed: u64,
    tick_us: u32,
    /// Whether all bodies stay at one height; then measured heights have no error.
    is_flat: bool,
    /// Past positions of the bodies, then the intruders; latest entry last.
    past: VecDeque<Vec<[f64; 3]>>,
    index: Cells<f64, 3>,
}

impl Sight {
    /// Creates sensors without past positions.
    pub fn new(sensing: Sensing, seed: u64, tick_us: u32, is_flat: bool) -> Self {
        let index = Cells::new(Space::OPEN, sensing.range_m);
        Self { sensing, seed, tick_us, is_flat, past: VecDeque::new(), index }
    }

    /// Records all positions at the start of a tick.
    pub fn look(&mut self, plane: &Plane) {
        let bodies = plane.discs().iter().chain(plane.intruders());
        self.past.push_back(bodies.map(|disc| disc.position_m).collect());
        self.keep();
    }

    /// Recorded positions, for checkpoints.
    pub fn past(&self) -> &VecDeque<Vec<[f64; 3]>> {
        &self.past
    }

    /// Restores the recorded positions.
    pub fn put_past(&mut self, past: VecDeque<Vec<[f64; 3]>>) {
        self.past = past;
        self.keep();
    }

    fn keep(&mut self) {
        let wanted = self.sensing.delay_ticks as usize + 1;
        while self.past.len() > wanted {
            self.past.pop_front();
        }
        if let Some(then) = self.past.front() {
            self.index.rebuild(then);
        }
    }

    /// Writes the detections of body `index` at `tick` to `sightings`, nearest first, without
    /// silent intruders, which robots detect as obstacles. None if the sensor was not due in the
    /// `within_ticks` ticks that end with this one: 1, or the time since its last use.
    pub fn sightings(
        &self,
        plane: &Plane,
        index: usize,
        tick: u32,
        within_ticks: u32,
        sightings: &mut Vec<Sighting<f32>>,
    ) {
        sightings.clear();
        let (sensing, delay) = (&self.sensing, self.sensing.delay_ticks);
        let is_early = self.past.len() <= delay as usize;
        let Some(then) = self.past.front().filter(|_| !is_early) else { return };
        let own = &plane.discs()[index];
        if (tick.wrapping_sub(delay).wrapping_add(own.id.0)) % sensing.every_ticks >= within_ticks {
            return;
        }
        let at = then[index];
        let mut found: Vec<Found<f64, 3>> = Vec::new();
        let query = Query { at, radius: sensing.range_m, most: usize::MAX, except: Some(index as u32) };
        self.index.within(&query, &mut found);
        let disc = |found: &Found<f64, 3>| -> &Disc {
            let at = found.index as usize;
            plane.discs().get(at).unwrap_or_else(|| &plane.intruders()[at - plane.discs().len()])
        };
        let mut rng = Rng::keyed(self.seed, PURPOSE, own.id.0, tick);
        for (place, other) in found.iter().enumerate() {
            let body = disc(other);
            let to = then[other.index as usize];
            let is_behind =
                |nearer: &Found<f64, 3>| distance_m(at, to, then[nearer.index as usize]) < disc(nearer).radius_m;
            let is_hidden = sensing.is_occluded && (found[..place].iter().any(is_behind) || is_walled(plane, at, to));
            if !body.id.is_some() || is_hidden {
                continue;
            }
            let mut noise = [0.0; 3].map(|_: f64| normal(&mut rng) * sensing.noise_m);
            if self.is_flat {
                noise[2] = 0.0;
            }
            let [x, y, z] = [0, 1, 2].map(|axis| (to[axis] - at[axis] + noise[axis]) as f32);
            sightings.push(Sighting {
                offset_m: Vec3::new(x, y, z),
                // The reported deviation is at least a millimetre.
                deviation_m: sensing.noise_m.max(0.001) as f32,
                age: Duration::from_micros((delay * self.tick_us).cast_signed()),
                radius_m: body.radius_m as f32,
                id: sensing.sees_names.then_some(body.id),
                velocity_mps: None,
            });
            if sightings.len() == SIGHTINGS {
                break;
            }
        }
    }
}

/// A sample of the standard normal distribution (Box and Muller 1958).
fn normal(rng: &mut Rng) -> f64 {
    let unit = |draw: u32| (f64::from(draw) + 0.5) / 4_294_967_296.0;
    let (radius, angle) = (unit(rng.next_u32()), unit(rng.next_u32()));
    libm::sqrt(-2.0 * libm::log(radius)) * libm::cos(core::f64::consts::TAU * angle)
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn distance_m(from: [f64; 3], to: [f64; 3], point: [f64; 3]) -> f64 {
    let (way, off) = (minus(to, from), minus(point, from));
    let square = dot(way, way);
    let share = if square > 0.0 { (dot(off, way) / square).clamp(0.0, 1.0) } else { 0.0 };
    let rest = minus(off, way.map(|x| x * share));
    libm::sqrt(dot(rest, rest))
}

fn is_walled(plane: &Plane, from: [f64; 3], to: [f64; 3]) -> bool {
    let way = minus(to, from);
    let length_m = libm::sqrt(dot(way, way));
    if plane.solids_near(from, length_m).any(|solid| hides(solid, from, to)) {
        return true;
    }
    let Some(land) = plane.terrain() else { return false };
    let steps = libm::ceil(4.0 * length_m / land.cell_m).max(1.0) as u32;
    (1..steps).any(|step| {
        let share = f64::from(step) / f64::from(steps);
        let place = [0, 1, 2].map(|axis| from[axis] + way[axis] * share);
        plane.cell(place).is_some_and(|cell| !land.is_passable(cell))
    })
}

fn hides(solid: &Solid, from: [f64; 3], to: [f64; 3]) -> bool {
    match *solid {
        Solid::Ball { center_m, radius_m } => distance_m(from, to, center_m) < radius_m,
        Solid::Plane { point_m, normal } => {
            [from, to].into_iter().any(|place| dot(minus(place, point_m), normal) < 0.0)
        }
        Solid::Wall([a, b]) => {
            let side =
                |[px, py]: [f64; 2], [qx, qy]: [f64; 2], [x, y]: [f64; 2]| (qx - px) * (y - py) - (qy - py) * (x - px);
            let ([p, q], flat) = ([from, to], |[x, y, _]: [f64; 3]| [x, y]);
            let (p, q) = (flat(p), flat(q));
            side(a, b, p) * side(a, b, q) < 0.0 && side(p, q, a) * side(p, q, b) < 0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_balls_and_the_ground_occlude() {
        let (from, to) = ([0.0; 3], [4.0, 0.0, 0.0]);
        let wall = |x: f64, low: f64| Solid::Wall([[x, low], [x, 1.0]]);
        assert!(hides(&wall(2.0, -1.0), from, to));
        assert!(!hides(&wall(2.0, 0.5), from, to) && !hides(&wall(5.0, -1.0), from, to));
        let ball = |y: f64| Solid::Ball { center_m: [2.0, y, 0.0], radius_m: 0.5 };
        assert!(hides(&ball(0.4), from, to) && !hides(&ball(0.6), from, to));
        let ground = |x: f64| Solid::Plane { point_m: [x, 0.0, 0.0], normal: [-1.0, 0.0, 0.0] };
        assert!(hides(&ground(3.0), from, to) && !hides(&ground(5.0), from, to));
    }

    #[test]
    fn errors_have_the_configured_deviation() {
        let mut rng = Rng::keyed(1, PURPOSE, 2, 3);
        let draws: Vec<f64> = (0..100_000).map(|_| normal(&mut rng)).collect();
        let mean = draws.iter().sum::<f64>() / 1e5;
        let square = draws.iter().map(|x| x * x).sum::<f64>() / 1e5;
        assert!(mean.abs() < 0.01 && (square - 1.0).abs() < 0.02, "{mean} {square}");
    }
}
