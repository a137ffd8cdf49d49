//! Benchmarks of encoding and decoding one frame of each message kind, in its longest form.

use core::hint::black_box;
use core::time::Duration;
use criterion::{Criterion, criterion_group, criterion_main};
use heapless::Vec;
use staya_controller::auth::Key;
use staya_controller::grid::{Cell, Dir};
use staya_controller::robot::{Mode, RobotId};
use staya_controller::template::TemplateEntry;
use staya_controller::time::Instant;
use staya_controller::wire::{
    Ack, Beacon, GoalAssignment, Header, MAX_FRAME_LEN, Message, Request, RequestKind, Sealed, TEMPLATE_PART,
    TemplateAssignment, Wire, decode, encode,
};

const TO: RobotId = RobotId(70_000);
const CELL: Cell = Cell::new(98, -98);

fn messages() -> [(&'static str, Message); 5] {
    let entry = TemplateEntry { offset: CELL, id: TO, hops: 1 };
    [
        (
            "beacon",
            Message::Beacon(Beacon {
                time: Instant::from_micros(123_456_789),
                position_mm: [12_345, -678_901, 0],
                velocity_mmps: [250, -3, 0],
                radius_mm: 150,
                cell: CELL,
                heading: Dir::NorthWest,
                busy_ms: 400,
                leader: TO,
                slot: 4,
                mode: Mode::Cruise,
                target: CELL,
            }),
        ),
        (
            "request",
            Message::Request(Request { to: TO, origin: TO, number: 9, kind: RequestKind::Stop, valid_ms: 2_000 }),
        ),
        ("ack", Message::Ack(Ack { to: TO, boot: 1, number: 9, accepted: true })),
        (
            "template",
            Message::Template(TemplateAssignment {
                to: TO,
                version: 1,
                part: 0,
                parts: 4,
                slot: 3,
                offset: CELL,
                entries: [entry; TEMPLATE_PART].into(),
            }),
        ),
        ("goal", Message::Goal(GoalAssignment { to: RobotId::NONE, version: 1, target: CELL })),
    ]
}

fn wire(c: &mut Criterion) {
    let header = Header { boot: 1, sender: TO, sequence: 4_711 };
    let mut out = Vec::<u8, MAX_FRAME_LEN>::new();
    let mut group = c.benchmark_group("encode");
    for (name, message) in messages() {
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                out.clear();
                encode(header, black_box(&message), &mut out)
            });
        });
    }
    group.finish();
    let mut group = c.benchmark_group("decode");
    for (name, message) in messages() {
        out.clear();
        encode(header, &message, &mut out).unwrap();
        let (_delimiter, frame) = out.split_last().unwrap();
        assert_eq!(decode(frame).unwrap().message, message);
        group.bench_function(name, |bencher| bencher.iter(|| decode(black_box(frame))));
    }
    group.finish();
}

fn sealed(c: &mut Criterion) {
    let header = Header { boot: 1, sender: TO, sequence: 4_711 };
    let [(_, beacon), ..] = messages();
    let key = Key::of_passphrase(b"bench");
    let mut sender = Sealed::<4>::at_start(&key, 1).unwrap();
    let receiver = Sealed::<4>::at_start(&key, 1).unwrap();
    let mut out = Vec::<u8, MAX_FRAME_LEN>::new();
    c.bench_function("encode/sealed_beacon", |bencher| {
        bencher.iter(|| {
            out.clear();
            sender.encode(header, black_box(&beacon), &mut out)
        });
    });
    // A filter may have skipped the previous benchmark.
    out.clear();
    sender.encode(header, &beacon, &mut out).unwrap();
    let (_delimiter, frame) = out.split_last().unwrap();
    assert!(receiver.clone().decode(frame).is_ok());
    c.bench_function("decode/sealed_beacon", |bencher| {
        bencher.iter(|| receiver.clone().decode(black_box(frame)));
    });
}

fn short() -> Criterion {
    Criterion::default().warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2))
}

criterion_group!(name = benches; config = short(); targets = wire, sealed);
criterion_main!(benches);
