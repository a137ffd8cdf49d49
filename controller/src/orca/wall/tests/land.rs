use crate::geom::Vec2;
use crate::grid::{BLOCKED, Cell, GridFrame, Window};
use crate::obstacle::{Obstacle, grid_walls};
use crate::orca::{solve, wall};
use crate::rand::Rng;
use crate::scalar::Scalar;
use proptest::prelude::*;
use std::vec::Vec;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_robot_that_obeys_the_walls_never_enters_a_blocked_cell(seed: u64, share in 0_u32..60) {
        let mut rng = Rng::new(seed);
        let side = 12_u16;
        let edge = [0, side - 1];
        let mut bytes: Vec<u8> = (0..side * side)
            .map(|at| {
                let is_edge = edge.contains(&(at % side)) || edge.contains(&(at / side));
                if is_edge || rng.below(100) < share { BLOCKED } else { 1 }
            })
            .collect();
        bytes[usize::from(6 * side + 6)] = 1;
        let frame = GridFrame { origin_m: Vec2::ZERO, cell_m: 1.0 };
        let window = Window::new(&bytes, Cell::new(0, 0), side, side).unwrap();
        let (radius, speed, dt, horizon) = (0.3, 1.5, 0.1, 1.0);
        let mut place = Vec2::new(6.5, 6.5);
        let mut velocity = Vec2::ZERO;
        let mut wish = Vec2::ZERO;
        for step in 0..200 {
            if step % 10 == 0 {
                let angle = f64::from(rng.below(6283)) / 1000.0;
                let (sin, cos) = Scalar::sin_cos(angle);
                wish = Vec2::new(cos, sin) * speed;
            }
            let reach = radius + speed * horizon;
            let planes: Vec<_> = grid_walls::<_, 16>(&window, &frame, place, reach)
                .iter()
                .filter_map(|obstacle| match *obstacle {
                    Obstacle::Wall(ends) => wall(velocity, ends, radius, horizon),
                    _ => None,
                })
                .collect();
            velocity = solve::<_, 16>(&planes, planes.len(), wish, speed).velocity_mps;
            place += velocity * dt;
            for x in 0..side as i16 {
                for y in 0..side as i16 {
                    if window.get(Cell::new(x, y)) != Some(BLOCKED) {
                        continue;
                    }
                    let near = Vec2::new(
                        place.x.clamp(f64::from(x), f64::from(x) + 1.0),
                        place.y.clamp(f64::from(y), f64::from(y) + 1.0),
                    );
                    let clearance = (near - place).norm() - radius;
                    prop_assert!(clearance > -1e-6, "{clearance} at {place:?}, step {step}");
                }
            }
        }
    }
}
