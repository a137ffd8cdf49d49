//! Benchmark of the weights of the eight moves in a window of radius 5, over terrain of
//! impassability 1 to 9. `tests/peers` compares larger windows with another crate.

use core::hint::black_box;
use criterion::{Criterion, criterion_group, criterion_main};
use staya_controller::grid::{Cell, Window};
use staya_controller::rand::Rng;
use staya_controller::route::{CostField, ExitRule, RouteParams, VisitMemory};

const SIDE: u16 = 11;
const CELLS: usize = SIDE as usize * SIDE as usize;
/// Alternating landscapes keep the branch predictor from learning a single one.
const LANDSCAPES: usize = 32;

fn cost_field(c: &mut Criterion) {
    let mut rng = Rng::new(1);
    let landscapes = [[(); CELLS]; LANDSCAPES].map(|land| land.map(|()| 1 + rng.below(9) as u8));
    let from = Cell::new(5, 5);
    let inside = Cell::new(10, 9);
    let outside = Cell::new(60, 40);
    let none: Option<&VisitMemory<0>> = None;
    let mut field = CostField::<{ 13 * 13 }>::new();
    let mut group = c.benchmark_group("cost_field_11x11");
    for (name, target, exit) in [
        ("target_inside", inside, ExitRule::Best),
        ("best_exit", outside, ExitRule::Best),
        ("ray_exit", outside, ExitRule::Ray),
    ] {
        let params = RouteParams { exit, ..RouteParams::default() };
        let mut turn = landscapes.iter().cycle();
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let cells = turn.next().unwrap();
                let window = Window::new(cells, Cell::default(), SIDE, SIDE).unwrap();
                field.weights(&params, black_box(&window), from, target, [], none).unwrap()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, cost_field);
criterion_main!(benches);
