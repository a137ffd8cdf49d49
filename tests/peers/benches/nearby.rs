//! Benchmark of neighbour searches for all boids of a flock at the paper's density (STA, section
//! 2.3): the project's searches, including the k-d tree, and the grid of `krabmaga`.

use core::hint::black_box;
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, SamplingMode, criterion_group, criterion_main};
use staya_lab::study::boids::Flock;
use staya_lab::study::boids::searches::{MidpointTree, MutualPairs, Tree};
use staya_peers::flockers::{Grid, flock, plan};
use staya_sim::nearby::{AllPairs, Cells, Query, Search, Space};
use std::time::Duration;

/// Above this number, all pairs take minutes.
const MOST_BY_ALL_PAIRS: u32 = 10_000;

fn neighbours(flock: &Flock, radius: f32, search: &mut impl Search<f32, 2>) -> usize {
    search.rebuild(flock.places());
    let mut found = Vec::new();
    let near = (0..).zip(flock.places()).map(|(boid, &at)| {
        let query = Query { at, radius, most: usize::MAX, except: Some(boid) };
        search.within(&query, &mut found);
        found.len()
    });
    near.sum()
}

fn measure(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, wanted: usize, mut neighbours: impl FnMut() -> usize) {
    assert_eq!(neighbours(), wanted, "{name} finds others");
    group.bench_function(name, |bencher| bencher.iter(|| black_box(neighbours())));
}

fn nearby(c: &mut Criterion) {
    for boids in [100, 1000, 10_000, 100_000] {
        let flock = flock(boids);
        let (space, radius) = (Space::torus(flock.sides()).unwrap_or(Space::OPEN), plan().closest);
        let mut cells = Cells::new(space, radius);
        let wanted = neighbours(&flock, radius, &mut cells);
        let mut group = c.benchmark_group(format!("nearby_{boids}"));
        group.sample_size(10).sampling_mode(SamplingMode::Flat);
        group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
        if boids <= MOST_BY_ALL_PAIRS {
            let mut all = AllPairs::new(space);
            measure(&mut group, "all_pairs", wanted, || neighbours(&flock, radius, &mut all));
            let mut mutual = MutualPairs::new(space, radius);
            measure(&mut group, "mutual_pairs", wanted, || neighbours(&flock, radius, &mut mutual));
        }
        measure(&mut group, "cells", wanted, || neighbours(&flock, radius, &mut cells));
        let mut midpoint = MidpointTree::new(space);
        measure(&mut group, "midpoint_tree", wanted, || neighbours(&flock, radius, &mut midpoint));
        let mut tree = Tree::new(space);
        measure(&mut group, "kiddo_tree", wanted, || neighbours(&flock, radius, &mut tree));
        let mut grid = Grid::new(&flock);
        measure(&mut group, "krabmaga_grid", wanted, || grid.neighbours());
        group.finish();
    }
}

criterion_group!(benches, nearby);
criterion_main!(benches);
