//! Robots on a circle change places with the opposite ones: collision avoidance alone, without
//! agents and radio, as in RVO2's example `Circle`. Run it with `cargo run --example orca_circle`.

use staya_controller::orca::{AvoidParams, Avoider};
use staya_controller::scalar::Scalar;
use staya_controller::{
    body::Body,
    geom::Vec3,
    neighbor::Nearby,
    rand::Rng,
    robot::{Mode, RobotId},
};

const ROBOTS: u32 = 24;
const RADIUS_M: f64 = 0.25;
const SPEED_MPS: f64 = 1.0;
const STEP_S: f64 = 0.1;

fn main() {
    let start = |i: u32| {
        let (sin, cos) = Scalar::sin_cos(std::f64::consts::TAU * f64::from(i) / f64::from(ROBOTS));
        Vec3::new(cos, sin, 0.0) * 5.0
    };
    let has_arrived = |place: &Vec3<f64>, i: u32| (*place + start(i)).norm() < 0.05;

    let mut places: Vec<Vec3<f64>> = (0..ROBOTS).map(start).collect();
    let mut velocities = vec![Vec3::ZERO; places.len()];
    // Only the nearest 16 obstacles and robots are considered.
    let mut avoiders = vec![Avoider::<f64, 16>::new(AvoidParams::default()); places.len()];
    let (mut rng, mut least_gap_m, mut steps) = (Rng::new(1), f64::MAX, 0);
    while !places.iter().zip(0..).all(|(place, i)| has_arrived(place, i)) {
        let mut chosen = Vec::new();
        for (i, own) in places.iter().enumerate() {
            let others = (0..places.len()).filter(|j| *j != i).map(|j| Nearby {
                id: RobotId(j as u32 + 1),
                offset_m: places[j] - *own,
                velocity_mps: velocities[j],
                radius_m: RADIUS_M,
                gives_way: true,
                mode: Mode::Cruise,
                is_stranger: false,
            });
            let mut nearby: Vec<_> = others.collect();
            nearby.sort_by(|a, b| a.offset_m.norm().total_cmp(&b.offset_m.norm()));
            least_gap_m = least_gap_m.min(nearby[0].offset_m.norm() - 2.0 * RADIUS_M);
            let body = Body {
                id: RobotId(i as u32 + 1),
                velocity_mps: velocities[i],
                radius_m: RADIUS_M,
                max_speed_mps: SPEED_MPS,
                max_acceleration_mps2: f64::MAX, // no inertia
                step_s: STEP_S,
            };
            // The preferred velocity reaches the goal in one step.
            let goal = (-start(i as u32) - *own).xy();
            let wish = (goal * (1.0 / STEP_S)).clamp_norm(SPEED_MPS);
            let best = avoiders[i].velocity(&body, wish, Some(goal), &nearby, &[], &mut rng);
            chosen.push(best.velocity_mps.extend(0.0));
        }
        velocities = chosen;
        for (place, velocity) in places.iter_mut().zip(&velocities) {
            *place += *velocity * STEP_S;
        }
        if steps % 20 == 0 {
            let Vec3 { x, y, .. } = places[0];
            println!("{:4.1} s: robot 1 at ({x:5.2}, {y:5.2})", f64::from(steps) * STEP_S);
        }
        steps += 1;
        assert!(steps < 1000, "a robot never arrives");
    }
    println!("all {ROBOTS} arrived after {:.1} s", f64::from(steps) * STEP_S);
    println!("the least gap between two of them was {:.1} mm", least_gap_m * 1000.0);
    assert!(least_gap_m > 0.0, "two robots touched");
}
