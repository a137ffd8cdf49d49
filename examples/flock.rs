//! Scattered robots form a flock with equal distances and a common velocity, and pass between two
//! discs (Olfati-Saber 2006, algorithm 3). It uses the flocking law alone, without agents and
//! radio. Run it with `cargo run --example flock`.

use staya_controller::lattice::{LatticeParams, Reference, acceleration};
use staya_controller::obstacle::Obstacle;
use staya_controller::{
    body::Body,
    geom::Vec3,
    neighbor::Nearby,
    rand::Rng,
    robot::{Mode, RobotId},
};

const ROBOTS: usize = 30;
const SPACING_M: f64 = 0.5;
const STEP_S: f64 = 0.02;
const STEPS: u32 = 3750;
const PICTURES_EVERY: u32 = 1250;
const DISCS: [(Vec3<f64>, f64); 2] = [(Vec3::new(6.0, 1.7, 0.0), 0.6), (Vec3::new(6.0, -1.7, 0.0), 0.6)];

struct Robot {
    place: Vec3<f64>,
    velocity: Vec3<f64>,
}

fn main() {
    let params = LatticeParams::new(SPACING_M);
    let mut rng = Rng::new(3);
    let mut draw = || f64::from(rng.below(4000)) / 1000.0 - 2.0;
    let strewn = |_| Robot { place: Vec3::new(draw(), draw(), 0.0), velocity: Vec3::ZERO };
    let mut robots: Vec<Robot> = (0..ROBOTS).map(strewn).collect();
    let mut lead = Robot { place: Vec3::ZERO, velocity: Vec3::new(0.2, 0.0, 0.0) };
    for step in 0..=STEPS {
        if step % PICTURES_EVERY == 0 {
            println!("after {:.0} s\n{}", f64::from(step) * STEP_S, picture(&robots));
        }
        // All robots decide before any robot moves.
        let chosen: Vec<_> = (0..ROBOTS).map(|own| decide(&params, &robots, own, &lead)).collect();
        for (robot, acceleration) in robots.iter_mut().zip(chosen) {
            robot.velocity += acceleration * STEP_S;
            robot.place += robot.velocity * STEP_S;
        }
        lead.place += lead.velocity * STEP_S;
        for (center, radius) in DISCS {
            assert!(robots.iter().all(|robot| (robot.place - center).norm() > radius), "into a disc");
        }
    }
    let off_by = robots.iter().map(|robot| (robot.velocity - lead.velocity).norm()).fold(0.0, f64::max);
    let nearest = |own: usize| {
        let others = robots.iter().enumerate().filter(move |(other, _)| *other != own);
        others.map(|(_, other)| (other.place - robots[own].place).norm()).fold(f64::MAX, f64::min)
    };
    let least = (0..ROBOTS).map(nearest).fold(f64::MAX, f64::min);
    let most = (0..ROBOTS).map(nearest).fold(0.0, f64::max);
    println!("the nearest neighbour is {least:.2} to {most:.2} m away, the spacing is {SPACING_M} m");
    println!("velocities differ from the reference by {off_by:.3} m/s at most");
    assert!(least > 0.7 * SPACING_M && most < 1.2 * SPACING_M, "no lattice");
    assert!(off_by < 0.02, "a robot does not follow");
}

fn decide(params: &LatticeParams<f64>, robots: &[Robot], own: usize, lead: &Robot) -> Vec3<f64> {
    let id = |index: usize| RobotId(index as u32 + 1);
    let robot = &robots[own];
    let body = Body {
        id: id(own),
        velocity_mps: robot.velocity,
        radius_m: 0.1,
        max_speed_mps: 1.0,
        max_acceleration_mps2: f64::MAX,
        step_s: STEP_S,
    };
    let others = robots.iter().enumerate().filter(|(index, _)| *index != own);
    let nearby: Vec<_> = others
        .map(|(index, other)| Nearby {
            id: id(index),
            offset_m: other.place - robot.place,
            velocity_mps: other.velocity,
            radius_m: 0.1,
            gives_way: true,
            mode: Mode::Cruise,
            is_stranger: false,
        })
        .filter(|other| other.offset_m.norm() < params.range_m())
        .collect();
    let discs = DISCS.map(|(center, radius_m)| Obstacle::Ball { center_m: center - robot.place, radius_m });
    let reference = Reference { offset_m: lead.place - robot.place, velocity_mps: lead.velocity };
    acceleration(params, &body, &nearby, &discs, Some(&reference))
}

/// Robots are `o`, discs `#`; a character is 0.2 m wide and 0.4 m high.
fn picture(robots: &[Robot]) -> String {
    let mut text = String::new();
    for row in (-7..=7).rev() {
        for column in -15..=82 {
            let at = Vec3::new(f64::from(column) * 0.2, f64::from(row) * 0.4, 0.0);
            let is_here = |robot: &Robot| {
                let away = robot.place - at;
                away.x.abs() <= 0.1 && away.y.abs() <= 0.2
            };
            let in_disc = DISCS.iter().any(|(center, radius)| (at - *center).norm() < *radius);
            text.push(if robots.iter().any(is_here) {
                'o'
            } else if in_disc {
                '#'
            } else {
                ' '
            });
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
    }
    text
}
