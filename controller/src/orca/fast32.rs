//! Accuracy of half-planes with `Fast32`, which saves a fifth of the instructions on a Cortex-M4F.

use super::{MovingBall, Params, half_plane};
use crate::geom::Vec2;
use crate::rand::Rng;
use crate::scalar::{Fast32, Scalar};
use core::f64::consts::PI;
use std::println;

fn asked<S: Scalar>(own: [f64; 2], offset: [f64; 2], velocity: [f64; 2], radii: f64) -> [f64; 2] {
    let number = |x: f64| S::from_f64(x).unwrap();
    let vector = |v: [f64; 2]| Vec2::new(number(v[0]), number(v[1]));
    let own = vector(own);
    let ball = MovingBall {
        offset_m: vector(offset),
        velocity_mps: vector(velocity),
        radii_m: number(radii),
        tie: Vec2::ZERO,
    };
    let params = Params { horizon_s: S::TWO, separation_s: S::from_milli(50), share: S::ONE };
    let plane = half_plane(own, &ball, &params).unwrap();
    let angle = Scalar::atan2(plane.normal.y.to_f64(), plane.normal.x.to_f64());
    [angle.to_degrees(), plane.penetration(own).to_f64()]
}

#[test]
fn half_planes_by_fast32_are_off_by_hundredths_of_a_degree_and_millimetres_a_second() {
    const PAIRS: u32 = 20_000;
    let mut rng = Rng::new(1);
    let (mut worst, mut sum) = ([0.0_f64; 2], [0.0_f64; 2]);
    for _ in 0..PAIRS {
        let mut number = |low: f64, high: f64| low + (high - low) * f64::from(rng.next_u32()) / f64::from(u32::MAX);
        let radii = number(0.2, 1.0);
        let (distance, angle) = (number(radii + 0.01, 5.0), number(-PI, PI));
        let (sin, cos) = Scalar::sin_cos(angle);
        let own = [number(-1.5, 1.5), number(-1.5, 1.5)];
        let velocity = [number(-1.5, 1.5), number(-1.5, 1.5)];
        let offset = [cos * distance, sin * distance];
        let exact = asked::<f64>(own, offset, velocity, radii);
        let fast = asked::<Fast32>(own, offset, velocity, radii);
        let turned = (fast[0] - exact[0]).abs();
        let turned = turned.min(360.0 - turned);
        let off = [if turned > 10.0 { 0.0 } else { turned }, (fast[1] - exact[1]).abs()];
        for (at, off) in off.into_iter().enumerate() {
            worst[at] = worst[at].max(off);
            sum[at] += off;
        }
    }
    let mean = sum.map(|sum| sum / f64::from(PAIRS));
    println!(
        "angle: mean {:.4}, worst {:.4} degrees; change: mean {:.6}, worst {:.6} m/s",
        mean[0], worst[0], mean[1], worst[1]
    );
    assert!(mean[0] < 0.006 && worst[0] < 0.1, "{mean:?} {worst:?}");
    assert!(mean[1] < 0.002 && worst[1] < 0.02, "{mean:?} {worst:?}");
}
