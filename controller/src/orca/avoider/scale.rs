//! Scale invariance: traces are equal in other units of length and time.

use super::*;
use crate::orca::fixtures::rng_of;
use crate::robot::{Mode, RobotId};
use proptest::prelude::*;
use std::vec::Vec;

/// Metres and seconds per unit. Robots have radius 0.15, speed 0.5, 20 decisions per unit of time.
#[derive(Clone, Copy)]
struct Units {
    length: f32,
    time: f32,
}

fn trace(units: Units, ways: &[[Vec2<f32>; 2]], walls: &[[Vec2<f32>; 2]], steps: u32) -> Vec<Vec<Vec2<f32>>> {
    let Units { length, time } = units;
    let params =
        AvoidParams { horizon_s: 2.0 * time, wall_horizon_s: time, margin_m: 0.004 * length, ..AvoidParams::default() };
    let speed = 0.5 * length / time;
    let step_s = 0.05 * time;
    let mut avoiders = std::vec![Avoider::<f32, 16>::new(params); ways.len()];
    let mut bodies: Vec<_> = ways.iter().map(|[start, _]| (*start * length, Vec2::ZERO)).collect();
    let mut rows = Vec::new();
    for step in 0..steps {
        let before = bodies.clone();
        for (own, avoider) in avoiders.iter_mut().enumerate() {
            let (at, velocity) = before[own];
            let id = RobotId(own as u32 + 1);
            let others = before.iter().zip(1..).filter(|(_, number)| RobotId(*number) != id);
            let mut nearby: Vec<_> = others
                .map(|((other, velocity_mps), number)| Nearby {
                    id: RobotId(number),
                    offset_m: (*other - at).extend(0.0),
                    velocity_mps: velocity_mps.extend(0.0),
                    radius_m: 0.15 * length,
                    gives_way: true,
                    mode: Mode::Cruise,
                    is_stranger: false,
                })
                .collect();
            nearby.sort_by(|a, b| a.offset_m.norm().total_cmp(&b.offset_m.norm()).then(a.id.cmp(&b.id)));
            nearby.truncate(8);
            let obstacles: Vec<_> =
                walls.iter().map(|ends| Obstacle::Wall(ends.map(|end| end * length - at))).collect();
            let body = Body {
                id,
                velocity_mps: velocity.extend(0.0),
                radius_m: 0.15 * length,
                max_speed_mps: speed,
                max_acceleration_mps2: f32::MAX,
                step_s,
            };
            let way = ways[own][1] * length - at;
            let wish = way * (speed.min(way.norm() / step_s) / way.norm().max(1e-9 * length));
            let mut rng = rng_of(id.0, step);
            let velocity = avoider.velocity(&body, wish, Some(way), &nearby, &obstacles, &mut rng).velocity_mps;
            bodies[own] = (at + velocity * step_s, velocity);
        }
        rows.push(bodies.iter().map(|(at, _)| *at * (1.0 / length)).collect());
    }
    rows
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn traces_are_equal_in_other_units_of_length_and_time(
        // Powers of two, so that rounding is identical: crowds amplify the last bit.
        length in -4_i32..6,
        time in -3_i32..4,
        starts in proptest::collection::vec((0.4_f32..2.5, -2.0_f32..2.0), 4),
        is_at_door: bool,
    ) {
        // All paths cross, in the open or through a door for one.
        let mirrored = |(x, y): (f32, f32), side: f32| Vec2::new(x * side, y);
        let ways: Vec<_> = (0..4)
            .map(|k| {
                let side = if k % 2 == 0 { -1.0 } else { 1.0 };
                [mirrored(starts[k], side), mirrored(starts[(k + 1) % 4], -side)]
            })
            .collect();
        let door = [[0.2_f32, 4.0], [-0.2, -4.0]].map(|ends| ends.map(|y| Vec2::new(0.0, y)));
        let walls = if is_at_door { &door[..] } else { &[] };
        let power = |exponent: i32| libm::ldexpf(1.0, exponent);
        let one = trace(Units { length: 1.0, time: 1.0 }, &ways, walls, 200);
        let other = trace(Units { length: power(length), time: power(time) }, &ways, walls, 200);
        for (step, (one, other)) in one.iter().zip(&other).enumerate() {
            for (one, other) in one.iter().zip(other) {
                prop_assert!((*one - *other).norm() < 1e-3, "step {}: {:?} {:?}", step, one, other);
            }
        }
    }
}
