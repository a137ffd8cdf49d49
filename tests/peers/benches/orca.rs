//! Benchmarks of ORCA and `dodgy_2d`: ten neighbours, and a whole step of 1000 robots.

use core::hint::black_box;
use criterion::{Criterion, criterion_group, criterion_main};
use staya_peers::crowd::Crowd;
use staya_peers::swarm::Swarm;

fn orca(c: &mut Criterion) {
    // Alternating crowds keep the branch predictor from learning a single one.
    let crowds: Vec<Crowd> = (0..256).map(Crowd::new).collect();
    let mut group = c.benchmark_group("orca_10");
    let mut turn = crowds.iter().cycle();
    group.bench_function("staya", |bencher| {
        bencher.iter(|| turn.next().map(|crowd| black_box(crowd).staya()));
    });
    let mut turn = crowds.iter().cycle();
    group.bench_function("dodgy_2d", |bencher| {
        bencher.iter(|| turn.next().map(|crowd| black_box(crowd).dodgy()));
    });
    group.finish();
}

/// Times are for all 1000 robots: 1 us here is 1 ns per robot.
fn step(c: &mut Criterion) {
    let mut swarm = Swarm::new(1000, 1);
    let mut group = c.benchmark_group("orca_step_1000");
    group.bench_function("staya", |bencher| bencher.iter(|| swarm.staya()));
    group.bench_function("dodgy_2d", |bencher| bencher.iter(|| swarm.dodgy()));
    group.bench_function("search_alone", |bencher| bencher.iter(|| swarm.search()));
    group.finish();
}

criterion_group!(benches, orca, step);
criterion_main!(benches);
