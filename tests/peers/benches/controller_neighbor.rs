//! Benchmarks of a full table of 16 neighbours.

use core::hint::black_box;
use criterion::{Criterion, criterion_group, criterion_main};
use staya_controller::geom::Position;
use staya_controller::neighbor::{Ages, Neighbor, NeighborTable, Put, StalenessInflation, nearest};
use staya_controller::rand::Rng;
use staya_controller::robot::RobotId;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::{Beacon, ProtocolId};

const ROBOTS: u32 = 16;
const AGES: Ages = Ages { stale_after: Duration::from_millis(500), expire_after: Duration::from_millis(5_000) };

type Table = NeighborTable<f32, { ROBOTS as usize }>;

fn neighbor(id: u32, range_mm: i32, rng: &mut Rng) -> Neighbor<f32> {
    let mut within = |range: i32| rng.below(range.cast_unsigned() * 2).cast_signed() - range;
    let beacon = Beacon {
        position_mm: [within(range_mm), within(range_mm), 0],
        velocity_mmps: [within(500) as i16, within(500) as i16, 0],
        radius_mm: 150,
        ..Beacon::default()
    };
    Neighbor::from_beacon(RobotId(id), &beacon, ProtocolId::NONE, Instant::default())
}

fn neighbor_table(c: &mut Criterion) {
    let here = Position::ORIGIN;
    let now = Instant::from_micros(200_000);
    let mut rng = Rng::new(1);
    let mut table = Table::new(AGES);
    for id in 1..=ROBOTS {
        let put = table.put(neighbor(id * 7, 10_000, &mut rng), here, now, |_| false);
        assert_eq!(put, Put::Inserted);
    }
    let known = neighbor(8 * 7, 10_000, &mut rng);
    let strangers = [neighbor(60, 1, &mut rng), neighbor(61, 1, &mut rng)];

    let mut group = c.benchmark_group("neighbors_16");
    group.bench_function("put_known", |bencher| {
        bencher.iter(|| table.put(black_box(known), here, now, |_| false));
    });
    group.bench_function("put_evicting", |bencher| {
        let mut full = table.clone();
        let mut turn = strangers.iter().cycle();
        // All others are protected, so that each unknown robot evicts the other one.
        let others = |id: RobotId| !strangers.iter().any(|stranger| stranger.id == id);
        let _ = full.put(strangers[0], here, now, |_| false);
        turn.next();
        bencher.iter(|| turn.next().map(|stranger| full.put(black_box(*stranger), here, now, others)));
    });
    group.bench_function("nearest_8", |bencher| {
        let inflation = StalenessInflation { growth_mps: 0.5, max_m: 1.0 };
        bencher.iter(|| {
            let known = table.as_slice();
            nearest::<f32, 8>(known, 0, black_box(here), 0.15, now, &AGES, &inflation)
        });
    });
    group.finish();
}

criterion_group!(benches, neighbor_table);
criterion_main!(benches);
