//! Encoding one beacon in each wire format, and finding and decoding it in the inbox.

use core::hint::black_box;
use core::time::Duration;
use criterion::{Criterion, criterion_group, criterion_main};
use heapless::Vec;
use staya_controller::agent::{Grid, GridPayload, Protocol as _};
use staya_controller::grid::{Cell, Dir};
use staya_controller::robot::{Mode, RobotId};
use staya_controller::wire::{Beacon, Content as _, Header, Message, Postcard, Wire};
use staya_mavlink::wire::Mavlink;

fn beacon() -> Message {
    let payload = GridPayload {
        cell: Cell::new(98, -98),
        target: Cell::new(98, 70),
        busy_ms: 400,
        heading: Dir::NorthWest,
        slot: 4,
        leader: RobotId(1),
    };
    let (protocol, payload) = payload.encode(Grid::ID).unwrap();
    Message::Beacon(Beacon {
        position_mm: [12_345, -678_901, 4_000],
        velocity_mmps: [250, -3, 1],
        radius_mm: 150,
        mode: Mode::Cruise,
        flock: 0,
        protocol,
        payload,
    })
}

fn format<W: Wire>(c: &mut Criterion, name: &str, mut wire: W) {
    let mut header = Header { boot: 1, sender: RobotId(7), sequence: 0 };
    let (message, mut out) = (beacon(), Vec::<u8, 256>::new());
    c.bench_function(&format!("beacon/encode/{name}"), |bencher| {
        bencher.iter(|| {
            header.sequence = header.sequence.wrapping_add(1);
            out.clear();
            wire.encode(header, black_box(&message), &mut out).unwrap()
        });
    });
    // A filter may have skipped the previous benchmark.
    out.clear();
    wire.encode(header, &message, &mut out).unwrap();
    c.bench_function(&format!("beacon/decode/{name}"), |bencher| {
        bencher.iter(|| {
            let mut inbox = black_box(out.as_slice());
            let frame = wire.next_frame(&mut inbox).unwrap();
            wire.decode(frame).unwrap()
        });
    });
}

fn formats(c: &mut Criterion) {
    format(c, "postcard", Postcard);
    format(c, "mavlink", Mavlink);
}

fn short() -> Criterion {
    Criterion::default().warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2))
}

criterion_group!(name = benches; config = short(); targets = formats);
criterion_main!(benches);
