//! Benchmark of one step of a flock of 100,000: Staya's cell index and boids, on one and on all
//! threads, and `krabmaga`. Each sample runs equally many steps from one uniform flock.

use criterion::{Criterion, criterion_group, criterion_main};
use staya_lab::study::boids::Flock;
use staya_peers::flockers::{Peer, flock, plan};
use staya_sim::nearby::{Cells, Space};
use std::time::{Duration, Instant};

const BOIDS: u32 = 100_000;
const STEPS: u64 = 4;

fn run<T>(count: u64, start: impl Fn() -> T, mut step: impl FnMut(&mut T)) -> Duration {
    let mut sum = Duration::ZERO;
    let mut left = count;
    while left > 0 {
        let mut state = start();
        let now = left.min(STEPS);
        let begun = Instant::now();
        (0..now).for_each(|_| step(&mut state));
        sum += begun.elapsed();
        left -= now;
    }
    sum
}

fn flock_100k(c: &mut Criterion) {
    let start = flock(BOIDS);
    let mut group = c.benchmark_group("flock_100k");
    group.sample_size(10);
    let space = Space::torus(start.sides()).unwrap_or(Space::OPEN);
    let cells = || (start.clone(), Cells::new(space, plan().closest));
    group.bench_function("staya", |bencher| {
        let step = |(flock, cells): &mut (Flock, Cells<f32, 2>)| flock.step_by_cells(cells);
        bencher.iter_custom(|count| run(count, cells, step));
    });
    group.bench_function("staya_all_threads", |bencher| {
        let step = |(flock, cells): &mut (Flock, Cells<f32, 2>)| flock.step_in_parallel(cells);
        bencher.iter_custom(|count| run(count, cells, step));
    });
    group.bench_function("krabmaga", |bencher| {
        bencher.iter_custom(|count| run(count, || Peer::new(&start), Peer::step));
    });
    group.finish();
}

criterion_group!(benches, flock_100k);
criterion_main!(benches);
