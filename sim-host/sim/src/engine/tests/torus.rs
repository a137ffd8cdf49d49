//! The position of the seams does not matter, and far from them the torus is like the plane.

use super::*;
use crate::scenario::Overrides;
use staya_controller::rand::Rng;
use std::path::Path;

const SIDES_M: [f64; 2] = [60.0, 45.0];

type Places = Vec<[f64; 2]>;

fn starts(count: u32, box_m: [u64; 2]) -> Vec<([f64; 2], [f64; 2])> {
    let drawn = |index: u32, what: u32, below: u64| (Rng::keyed(7, what, index, 0).next_u64() % below) as f64;
    let start = |index: u32| {
        let y = f64::from(index) * (box_m[1] as f64) / f64::from(count);
        let place = [drawn(index, 0, box_m[0] * 1000) / 1000.0, (y * 1000.0).floor() / 1000.0];
        (place, [drawn(index, 1, 200) / 100.0 - 1.0, drawn(index, 2, 200) / 100.0 - 1.0])
    };
    (0..count).map(start).collect()
}

fn run(starts: &[([f64; 2], [f64; 2])], torus: bool, shift_m: [f64; 2], ticks: u32) -> Vec<Places> {
    let list = starts.iter().map(|(place, velocity)| {
        let [x, y] = [0, 1].map(|axis| {
            let moved = place[axis] + shift_m[axis];
            if torus { (moved.rem_euclid(SIDES_M[axis]) * 1000.0).round() / 1000.0 } else { moved }
        });
        format!("{{ start_m = [{x}, {y}], velocity_mps = [{}, {}] }}", velocity[0], velocity[1])
    });
    let torus = if torus { "torus_m = [60, 45]\n" } else { "" };
    let text = format!(
        "name = \"torus\"\nseed = 3\nticks = {ticks}\ntick_s = 0.1\n[radio]\nrange_m = 20\nloss = 0.1\n[plane]\nradius_m = 0.05\n\
         max_speed_mps = 2\nlaw = \"boids\"\n{torus}[plane.boids]\ncrowded_m = 1.5\nclosest_m = 20\n[plane.robots]\nlist = [{}]\n",
        list.collect::<Vec<_>>().join(", ")
    );
    let scenario = Scenario::parse(&text, Path::new("torus.toml"), &Overrides::default());
    let mut moments = Vec::new();
    simulate(&scenario.unwrap_or_else(|error| panic!("{error}")), |_, rows| {
        moments.push(rows.map(|row| [row.motion.position_m[0], row.motion.position_m[1]]).collect());
        ControlFlow::Continue(())
    })
    .expect("room");
    moments
}

fn between(from: [f64; 2], to: [f64; 2]) -> f64 {
    let [x, y] = [0, 1].map(|axis| {
        let way = (to[axis] - from[axis]).rem_euclid(SIDES_M[axis]);
        way.min(SIDES_M[axis] - way)
    });
    libm::hypot(x, y)
}

#[test]
fn the_position_of_the_seams_makes_no_difference() {
    let starts = starts(24, [60, 45]);
    let here = run(&starts, true, [0.0; 2], 300);
    for shift_m in [[33.0, 21.5], [0.0, 44.999]] {
        let there = run(&starts, true, shift_m, 300);
        let mut crossings = [0, 0];
        for (tick, (here, there)) in here.iter().zip(&there).enumerate() {
            for (robot, (from, to)) in here.iter().zip(there).enumerate() {
                let moved = [from[0] + shift_m[0], from[1] + shift_m[1]];
                let off_m = between(moved, *to);
                assert!(off_m < 1e-6, "robot {robot} is {off_m} m off in tick {tick}, moved by {shift_m:?}");
                assert!((0..2).all(|axis| (0.0..SIDES_M[axis]).contains(&to[axis])), "{to:?} is beside the torus");
            }
        }
        for (moments, crossings) in [&here, &there].into_iter().zip(&mut crossings) {
            for pair in moments.windows(2) {
                let apart = |(from, to): (&[f64; 2], &[f64; 2])| libm::hypot(to[0] - from[0], to[1] - from[1]) > 20.0;
                *crossings += pair[0].iter().zip(&pair[1]).filter(|pair| apart(*pair)).count();
            }
        }
        assert!(crossings[0] > 20 && crossings[1] > 20 && crossings[0] != crossings[1], "{crossings:?}");
    }
}

#[test]
fn far_from_the_seams_the_torus_is_the_plane() {
    let starts = starts(24, [6, 6]);
    // At 2 m/s for 4 s no robot comes within range of an image.
    let shift_m = [27.0, 19.5];
    let plane = run(&starts, false, shift_m, 40);
    for (tick, (plane, torus)) in plane.iter().zip(run(&starts, true, shift_m, 40)).enumerate() {
        for (robot, (there, here)) in plane.iter().zip(torus).enumerate() {
            let off_m = libm::hypot(there[0] - here[0], there[1] - here[1]);
            assert!(off_m < 1e-6, "robot {robot} is {off_m} m off in tick {tick}");
        }
    }
    let turned = plane.windows(3).any(|three| {
        let way = |i: usize| [three[i + 1][0][0] - three[i][0][0], three[i + 1][0][1] - three[i][0][1]];
        (way(0)[0] * way(1)[1] - way(0)[1] * way(1)[0]).abs() > 1e-6
    });
    assert!(turned, "no robot avoids another one");
}
