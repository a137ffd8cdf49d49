//! Benchmarks of encoding and decoding one frame of each message kind, in its longest form.

use core::hint::black_box;
use core::time::Duration;
use criterion::{Criterion, criterion_group, criterion_main};
use heapless::Vec;
use staya_controller::agent::{Grid, GridMessage, GridOrder, GridPayload, Protocol as _, TEMPLATE_PART, TemplatePart};
use staya_controller::auth::Key;
use staya_controller::grid::{Cell, Dir};
use staya_controller::robot::{Mode, RobotId};
use staya_controller::template::TemplateEntry;
use staya_controller::wire::{
    Ack, Addressed, Beacon, Content as _, Header, MAX_FRAME_LEN, Message, Sealed, Wire, decode, encode,
};

const TO: RobotId = RobotId(70_000);
const CELL: Cell = Cell::new(98, -98);

fn messages() -> [(&'static str, Message); 5] {
    let payload = GridPayload { cell: CELL, target: CELL, busy_ms: 400, heading: Dir::NorthWest, slot: 4, leader: TO };
    let (protocol, payload) = payload.encode(Grid::ID).unwrap();
    let beacon = Beacon {
        position_mm: [12_345, -678_901, 0],
        velocity_mmps: [250, -3, 0],
        radius_mm: 150,
        mode: Mode::Cruise,
        flock: 0,
        protocol,
        payload,
    };
    let stop = GridMessage::Stop { origin: TO, valid_ms: 2_000 };
    let (protocol, content) = stop.encode(Grid::ID).unwrap();
    let entries = [TemplateEntry { offset: CELL, id: TO, hops: 1 }; TEMPLATE_PART].into();
    let part = TemplatePart { version: 1, part: 0, parts: 4, slot: 3, offset: CELL, entries };
    let template = GridOrder::Template { part, is_restarted: false };
    [
        ("beacon", Message::Beacon(beacon)),
        ("stop", Message::Law(Addressed { to: TO, number: 9, protocol, content })),
        ("ack", Message::Ack(Ack { to: TO, boot: 1, number: 9 })),
        ("template", Grid::order(TO, 1, &template).unwrap()),
        ("goal", Grid::order(RobotId::NONE, 1, &GridOrder::FormationGoal(CELL)).unwrap()),
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
