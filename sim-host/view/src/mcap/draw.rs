use super::proto::Bytes;
use crate::frame::FrameData;
use crate::scene::{Kind, Scene, Solid};
use staya_sim::world::plane::Shape;

pub const FRAME: &str = "map";
/// Colours by Okabe and Ito.
const COLOURS: [[u8; 3]; 7] =
    [[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [230, 159, 0], [86, 180, 233], [90, 90, 90]];
const INTRUDER: [f64; 4] = [0.8, 0.1, 0.1, 1.0];
const OBSTACLE: [f64; 4] = [0.44, 0.41, 0.36, 1.0];
/// A multiple of a robot's radius.
const HEIGHT: f64 = 1.0;
const MANY: usize = 100;

pub fn stamp(out: &mut Bytes, at_ns: u64) {
    out.int(1, at_ns / 1_000_000_000);
    out.int(2, at_ns % 1_000_000_000);
}

pub fn vector(out: &mut Bytes, values: [f64; 3]) {
    (1..).zip(values).for_each(|(number, value)| out.double(number, value));
}

fn rgba(out: &mut Bytes, values: [f64; 4]) {
    (1..).zip(values).for_each(|(number, value)| out.double(number, value));
}

pub fn pose(out: &mut Bytes, at_m: [f64; 3], heading: f64) {
    out.message(1, |out| vector(out, at_m));
    out.message(2, |out| {
        out.double(3, libm::sin(heading / 2.0));
        out.double(4, libm::cos(heading / 2.0));
    });
}

/// From east; 0 for zero velocity.
pub fn heading([x, y, _]: [f32; 3]) -> f64 {
    libm::atan2(y.into(), x.into())
}

/// The attitude of a body that faces its velocity without roll.
pub fn looking(out: &mut Bytes, at_m: [f64; 3], velocity_mps: [f32; 3]) {
    let quaternion = quaternion(velocity_mps);
    out.message(1, |out| vector(out, at_m));
    out.message(2, |out| (1..).zip(quaternion).for_each(|(number, value)| out.double(number, value)));
}

/// As [`attitude`](staya_sim::metrics::flock::attitude): a rotation to the heading, then a pitch.
fn quaternion(velocity_mps: [f32; 3]) -> [f64; 4] {
    let [x, y, z] = velocity_mps.map(f64::from);
    let (sin, cos) = libm::sincos(heading(velocity_mps) / 2.0);
    let (down, level) = libm::sincos(-libm::atan2(z, libm::hypot(x, y)) / 2.0);
    [-sin * down, cos * down, sin * level, cos * level]
}

/// Replaces the previous entity with this id.
fn entity(update: &mut Bytes, id: &str, at_ns: u64, fill: impl FnOnce(&mut Bytes)) {
    update.message(2, |out| {
        out.message(1, |out| stamp(out, at_ns));
        out.text(2, FRAME);
        out.text(3, id);
        fill(out);
    });
}

fn colour_of(scene: &Scene, index: usize, mode: u8) -> [f64; 4] {
    let group = scene.robots.group.get(index).copied().unwrap_or(0) as usize;
    let number = if scene.robots.id.len() <= MANY && group == 0 { index } else { group };
    let [r, g, b] = COLOURS[number % COLOURS.len()].map(|part| f64::from(part) / 255.0);
    // Arrived robots are pale, robots that are down dark.
    match mode {
        4 => [0.5 + r / 2.0, 0.5 + g / 2.0, 0.5 + b / 2.0, 1.0],
        5 => [r / 4.0, g / 4.0, b / 4.0, 1.0],
        _ => [r, g, b, 1.0],
    }
}

fn ball(out: &mut Bytes, (at_m, turned): ([f64; 3], f64), radius_m: f64, colour: [f64; 4]) {
    out.message(9, |out| {
        out.message(1, |out| pose(out, at_m, turned));
        out.message(2, |out| vector(out, [2.0 * radius_m; 3]));
        out.message(3, |out| rgba(out, colour));
    });
}

/// Stands on the ground.
fn cylinder(out: &mut Bytes, ([x, y], turned): ([f64; 2], f64), radius_m: f64, high_m: f64, colour: [f64; 4]) {
    out.message(10, |out| {
        out.message(1, |out| pose(out, [x, y, high_m / 2.0], turned));
        out.message(2, |out| vector(out, [2.0 * radius_m, 2.0 * radius_m, high_m]));
        out.double(3, 1.0);
        out.double(4, 1.0);
        out.message(5, |out| rgba(out, colour));
    });
}

pub fn bodies(scene: &Scene, frame: &FrameData, at_ns: u64) -> Vec<u8> {
    let robots = scene.robots.id.len();
    let body = |out: &mut Bytes, index: usize, radius_m: f64, colour: [f64; 4]| {
        let [x, y, z] = frame.position_m[index].map(f64::from);
        let turned = heading(frame.velocity_mps[index]);
        match scene.kind {
            Kind::Space => ball(out, ([x, y, z], turned), radius_m, colour),
            _ => cylinder(out, ([x, y], turned), radius_m, radius_m * HEIGHT, colour),
        }
    };
    let mut update = Bytes::default();
    let bodies = frame.bodies().min(frame.velocity_mps.len());
    entity(&mut update, "robots", at_ns, |out| {
        for (index, radius_m) in scene.robots.radius_m.iter().enumerate().take(bodies) {
            body(out, index, *radius_m, colour_of(scene, index, frame.mode.get(index).copied().unwrap_or(0)));
        }
    });
    if bodies > robots {
        entity(&mut update, "intruders", at_ns, |out| {
            for (index, intruder) in (robots..bodies).zip(&scene.intruders) {
                body(out, index, intruder.radius_m, INTRUDER);
            }
        });
    }
    update.0
}

fn lines(out: &mut Bytes, colour: [f64; 4], thickness: f64, pairs: impl Iterator<Item = [[f64; 3]; 2]>) {
    out.message(11, |out| {
        out.int(1, 2);
        out.message(2, |out| pose(out, [0.0; 3], 0.0));
        out.double(3, thickness);
        out.int(4, 0);
        pairs.flatten().for_each(|point| out.message(5, |out| vector(out, point)));
        out.message(6, |out| rgba(out, colour));
    });
}

pub fn goals(scene: &Scene, goals_m: &[[f32; 3]], at_ns: u64) -> Vec<u8> {
    let mut update = Bytes::default();
    entity(&mut update, "goals", at_ns, |out| {
        for (index, goal) in goals_m.iter().enumerate().filter(|(_, goal)| goal.iter().all(|x| x.is_finite())) {
            let arm = scene.robots.radius_m.get(index).copied().unwrap_or(1.0);
            let [x, y, z] = goal.map(f64::from);
            let cross =
                [[[x - arm, y - arm, z], [x + arm, y + arm, z]], [[x - arm, y + arm, z], [x + arm, y - arm, z]]];
            lines(out, colour_of(scene, index, 0), arm / 4.0, cross.into_iter());
        }
    });
    update.0
}

pub fn obstacles(scene: &Scene, at_ns: u64) -> Vec<u8> {
    let largest_m = scene.robots.radius_m.iter().copied().fold(0.0, f64::max);
    let mut update = Bytes::default();
    entity(&mut update, "obstacles", at_ns, |out| {
        for solid in &scene.solids {
            match &solid.solid {
                Solid::Shape(Shape::Segment { from_m, to_m }) => wall(out, &[*from_m, *to_m], largest_m),
                Solid::Shape(Shape::Polygon { points_m }) => {
                    let ends = points_m.first().into_iter().chain(points_m).copied();
                    wall(out, &ends.collect::<Vec<_>>(), largest_m);
                }
                Solid::Shape(Shape::Circle { center_m, radius_m }) => {
                    cylinder(out, (*center_m, 0.0), *radius_m, largest_m.max(radius_m / 4.0), OBSTACLE);
                }
                Solid::Shape(Shape::Ball { center_m, radius_m }) => ball(out, (*center_m, 0.0), *radius_m, OBSTACLE),
                // A half-space has no boundary that could be drawn.
                Solid::HalfSpace(_) => {}
            }
        }
    });
    update.0
}

/// Lines at the foot and the top, with posts between them.
fn wall(out: &mut Bytes, points_m: &[[f64; 2]], high: f64) {
    let at = |[x, y]: [f64; 2], z: f64| [x, y, z];
    let sides = points_m.windows(2).flat_map(|pair| {
        let [from, to] = [pair[0], pair[1]];
        [[at(from, 0.0), at(to, 0.0)], [at(from, high), at(to, high)]]
    });
    let posts = points_m.iter().map(|&point| [at(point, 0.0), at(point, high)]);
    lines(out, OBSTACLE, high / 4.0, sides.chain(posts));
}

#[cfg(test)]
mod tests {
    use super::*;
    use staya_sim::metrics::flock::attitude;

    fn columns([x, y, z, w]: [f64; 4]) -> [[f64; 3]; 3] {
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)],
            [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)],
            [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)],
        ]
    }

    #[test]
    fn poses_have_the_attitude_of_their_velocity() {
        for velocity in [[1.0, 0.0, 0.0], [0.0, -2.0, 0.5], [-1.0, 4.0, -9.0], [0.0, 0.0, 7.0], [3.0, 3.0, 3.0]] {
            let wanted = attitude(velocity.map(f64::from)).unwrap();
            let columns = columns(quaternion(velocity));
            for (got, wanted) in columns.iter().flatten().zip(wanted.iter().flatten()) {
                assert!((got - wanted).abs() < 1e-12, "{velocity:?}: {columns:?} {wanted:?}");
            }
        }
        assert_eq!(quaternion([0.0; 3]), [0.0, 0.0, 0.0, 1.0]);
    }
}
