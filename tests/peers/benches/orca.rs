//! ORCA among ten neighbours: half-planes and solution, beside `dodgy_2d`.

use core::hint::black_box;
use criterion::{Criterion, criterion_group, criterion_main};
use staya_peers::crowd::Crowd;

fn orca(c: &mut Criterion) {
    // Different crowds in turn, so that no branch predictor learns one by heart.
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

criterion_group!(benches, orca);
criterion_main!(benches);
