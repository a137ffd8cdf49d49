//! Benchmark of one cost field over natural terrain: Staya's reverse search and `pathfinding`.

use criterion::{Criterion, criterion_group, criterion_main};
use staya_controller::route::CostField;
use staya_peers::Task;
use std::hint::black_box;

/// Alternating landscapes keep the branch predictor from learning a single one.
const LANDSCAPES: u64 = 32;

fn cost_field<const CELLS: usize>(c: &mut Criterion, side: u16, peaks: usize) {
    let mut field = CostField::<CELLS>::new();
    let tasks: Vec<Task> = (0..LANDSCAPES).map(|seed| Task::natural(side, peaks, 0, seed)).collect();
    for task in &tasks {
        task.assert_equal(&mut field);
    }
    let mut group = c.benchmark_group(format!("cost_field_{side}x{side}"));
    group.bench_function("staya", |bencher| {
        let mut tasks = tasks.iter().cycle();
        bencher.iter(|| tasks.next().map(|task| black_box(task).staya(&mut field)));
    });
    group.bench_function("pathfinding", |bencher| {
        let mut tasks = tasks.iter().cycle();
        bencher.iter(|| tasks.next().map(|task| black_box(task).pathfinding().count()));
    });
    group.finish();
}

fn cost_fields(c: &mut Criterion) {
    cost_field::<{ 18 * 18 }>(c, 16, 4);
    cost_field::<{ 34 * 34 }>(c, 32, 12);
}

criterion_group!(benches, cost_fields);
criterion_main!(benches);
