//! Benchmarks of one decision of each flocking law, and of push-out behind it, among ten
//! neighbours. Alternating neighbourhoods keep the branch predictor from learning a single one.

use core::hint::black_box;
use criterion::{Criterion, criterion_group, criterion_main};
use staya_controller::body::Body;
use staya_controller::boids::BoidsParams;
use staya_controller::geom::{Position, Vec2, Vec3};
use staya_controller::goal_flock::{GoalParams, wish};
use staya_controller::lattice::{LatticeParams, Reference, acceleration};
use staya_controller::neighbor::Nearby;
use staya_controller::obstacle::Obstacle;
use staya_controller::push_out::{Model, PushOutParams, push_out};
use staya_controller::rand::Rng;
use staya_controller::robot::{Mode, RobotId};

const NEIGHBORS: usize = 10;
const CASES: usize = 64;

type Others = [Nearby<f32>; NEIGHBORS];

fn others(rng: &mut Rng, range: f32) -> Others {
    let mut within = |range: f32| (rng.below(2001) as f32 / 1000.0 - 1.0) * range;
    let mut id = 1;
    [(); NEIGHBORS].map(|()| {
        id += 1;
        let mut offset_m = Vec3::ZERO;
        while offset_m.norm() < range * 0.3 {
            offset_m = Vec3::new(within(range), within(range), 0.0);
        }
        let heading = Vec3::new(within(1.0), within(1.0), 0.0).normalized();
        Nearby {
            id: RobotId(id),
            offset_m,
            velocity_mps: heading.unwrap_or(Vec3::ZERO) * 0.5,
            radius_m: 0.1,
            gives_way: true,
            mode: Mode::Cruise,
            is_stranger: false,
        }
    })
}

fn flock(c: &mut Criterion) {
    let mut rng = Rng::new(1);
    let cases: Vec<Others> = (0..CASES).map(|_| others(&mut rng, 0.5)).collect();
    let body = Body {
        id: RobotId(1),
        velocity_mps: Vec3::new(0.3, 0.1, 0.0),
        radius_m: 0.1,
        max_speed_mps: 1.0,
        max_acceleration_mps2: 5.0,
        step_s: 0.05,
    };
    let mut group = c.benchmark_group("flock_10_neighbors");

    let lattice = LatticeParams::new(0.5);
    let reference = Reference { offset_m: Vec3::new(9.0, 2.0, 0.0), velocity_mps: Vec3::new(0.3, 0.0, 0.0) };
    let obstacles = [Obstacle::Ball { center_m: Vec3::new(0.6, 0.1, 0.0), radius_m: 0.4 }];
    let mut turn = cases.iter().cycle();
    group.bench_function("lattice", |bencher| {
        bencher.iter(|| {
            let nearby = black_box(turn.next().unwrap());
            acceleration(&lattice, &body, nearby, &[], Some(&reference))
        });
    });
    group.bench_function("lattice_and_obstacle", |bencher| {
        bencher.iter(|| {
            let nearby = black_box(turn.next().unwrap());
            acceleration(&lattice, &body, nearby, &obstacles, Some(&reference))
        });
    });

    let goal = GoalParams::new(0.25, 1.0);
    let target = Some(Position::from_mm([30_000, 5_000, 0]));
    group.bench_function("goal", |bencher| {
        bencher.iter(|| {
            let nearby = black_box(turn.next().unwrap());
            wish(&goal, &body, Position::ORIGIN, target, nearby)
        });
    });

    let boids = BoidsParams::new(0.1, 0.6, 0.05, 0.02);
    let mut heading = Vec2::new(1.0, 0.0);
    group.bench_function("boids", |bencher| {
        bencher.iter(|| {
            let nearby = black_box(turn.next().unwrap());
            heading = boids.steer(RobotId(1), black_box(heading), nearby);
            heading
        });
    });

    for (name, model) in [("push_out_radial", Model::Radial), ("push_out_tangential", Model::Tangential)] {
        let params = PushOutParams { model, ..PushOutParams::new(0.2) };
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let nearby = black_box(turn.next().unwrap());
                push_out(&params, &body, Vec3::new(1.0, 0.0, 0.0), nearby, &[])
            });
        });
    }
    group.finish();
}

criterion_group!(benches, flock);
criterion_main!(benches);
