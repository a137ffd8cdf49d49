//! Benchmarks of half-planes by formula and by template, and of the intersection of ten of them.

use core::hint::black_box;
use criterion::{Criterion, criterion_group, criterion_main};
use staya_controller::geom::{Vec2, Vec3};
use staya_controller::orca::{Analytic, HalfPlane, HalfSpaces, MovingBall, Params, VoxelTable2k, half_space, solve};
use staya_controller::rand::Rng;
use staya_controller::scalar::{Q16, Scalar};

/// Alternating scenes keep the branch predictor from learning a single one.
const SCENES: usize = 256;
const NEIGHBORS: usize = 10;

fn within<S: Scalar>(rng: &mut Rng, most: f64) -> S {
    let share = f64::from(rng.below(1 << 16)) / f64::from(1 << 15) - 1.0;
    S::from_f64(share * most).unwrap()
}

fn vector<S: Scalar>(rng: &mut Rng, most: f64) -> Vec2<S> {
    Vec2::new(within(rng, most), within(rng, most))
}

fn params<S: Scalar>() -> Params<S> {
    Params { horizon_s: S::TWO, separation_s: S::from_milli(50), share: S::HALF }
}

/// A robot of radius 0.3 m within 5 m that does not overlap.
fn pair<S: Scalar>(rng: &mut Rng) -> (Vec2<S>, MovingBall<Vec2<S>>) {
    let radii_m = S::from_milli(600);
    let mut offset_m = Vec2::ZERO;
    while offset_m.norm() <= radii_m {
        offset_m = vector(rng, 5.0);
    }
    let other = MovingBall { offset_m, velocity_mps: vector(rng, 1.5), radii_m, tie: Vec2::ZERO };
    (vector(rng, 1.5), other)
}

type Source<'a, S> = &'a dyn Fn(Vec2<S>, &MovingBall<Vec2<S>>) -> Option<HalfPlane<S>>;

fn half_planes<S: Scalar>(c: &mut Criterion, scalar: &str) {
    let mut rng = Rng::new(1);
    let pairs: Vec<(Vec2<S>, MovingBall<Vec2<S>>)> = (0..SCENES).map(|_| pair(&mut rng)).collect();
    let mut group = c.benchmark_group(format!("half_plane_{scalar}"));
    let mut run = |name: &str, source: Source<'_, S>| {
        let mut turn = 0;
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                turn = (turn + 1) % SCENES;
                let (own, other) = &pairs[turn];
                source(black_box(*own), black_box(other))
            });
        });
    };
    fn by<S: Scalar, P: HalfSpaces<S, Velocity = Vec2<S>>>(
        source: P,
    ) -> impl Fn(Vec2<S>, &MovingBall<Vec2<S>>) -> Option<HalfPlane<S>> {
        move |own, other| source.half_space(own, other, &params())
    }
    run("analytic", &by(Analytic));
    run("template_2k", &by(VoxelTable2k));
}

fn what_is_left(c: &mut Criterion) {
    let mut rng = Rng::new(2);
    let mut planes = Vec::new();
    let mut spaces = Vec::new();
    for _ in 0..SCENES {
        let own: Vec2<f32> = vector(&mut rng, 1.0);
        let others: Vec<MovingBall<Vec2<f32>>> = (0..NEIGHBORS).map(|_| pair(&mut rng).1).collect();
        let in_plane = others.iter().filter_map(|other| Analytic.half_space(own, other, &params()));
        planes.push((in_plane.collect::<Vec<_>>(), vector::<f32>(&mut rng, 1.0)));
        let up = |rng: &mut Rng| within::<f32>(rng, 1.0);
        let own = own.extend(up(&mut rng));
        let in_space = others.iter().filter_map(|other| {
            let other = MovingBall {
                offset_m: other.offset_m.extend(up(&mut rng)),
                velocity_mps: other.velocity_mps.extend(up(&mut rng)),
                radii_m: other.radii_m,
                tie: Vec3::ZERO,
            };
            half_space(own, &other, &params())
        });
        let in_space: Vec<_> = in_space.collect();
        spaces.push((in_space, vector::<f32>(&mut rng, 1.0).extend(up(&mut rng))));
    }
    let mut group = c.benchmark_group("orca_solve_10");
    let mut turn = 0;
    group.bench_function("plane", |bencher| {
        bencher.iter(|| {
            turn = (turn + 1) % SCENES;
            let (planes, wish) = &planes[turn];
            solve::<_, NEIGHBORS>(black_box(planes), 0, black_box(*wish), 1.0)
        });
    });
    group.bench_function("space", |bencher| {
        bencher.iter(|| {
            turn = (turn + 1) % SCENES;
            let (spaces, wish) = &spaces[turn];
            solve::<_, NEIGHBORS>(black_box(spaces), 0, black_box(*wish), 1.0)
        });
    });
}

fn orca(c: &mut Criterion) {
    half_planes::<f32>(c, "f32");
    half_planes::<Q16>(c, "q16");
    what_is_left(c);
}

criterion_group!(benches, orca);
criterion_main!(benches);
