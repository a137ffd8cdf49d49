//! A MAVLink frame of each of the swarm's messages, for `tests/python/test_dialect.py`.

use staya_controller::grid::{Cell, Dir};
use staya_controller::land::LandPatch;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::template::TemplateEntry;
use staya_controller::time::Instant;
use staya_controller::wire::{
    Ack, Beacon, Frame, GoalAssignment, Header, LostRobot, Message, PayloadBytes, Request, RequestKind,
    TemplateAssignment, WaypointAssignment,
};
use staya_mavlink::wire::{decode, encode};
use std::fmt::Write as _;

const TO: RobotId = RobotId(254);

fn messages() -> [(&'static str, Message, &'static str); 10] {
    let entry = |x, id, hops| TemplateEntry { offset: Cell::new(x, -x), id: RobotId(id), hops };
    let template = |entries: &[TemplateEntry]| {
        Message::Template(TemplateAssignment {
            to: TO,
            version: 200,
            part: 1,
            parts: 3,
            slot: 4,
            offset: Cell::new(-6, 9),
            entries: entries.iter().copied().collect(),
        })
    };
    let beacon = Beacon {
        time: Instant::from_micros(4_000_000_001),
        position_mm: [12_345, -678_901, i32::MIN],
        velocity_mmps: [250, -3, i16::MAX],
        radius_mm: 150,
        cell: Cell::new(98, -98),
        heading: Dir::SouthEast,
        busy_ms: 400,
        leader: RobotId(1),
        slot: 4,
        mode: Mode::Fault,
        target: Cell::new(-32_768, 70),
    };
    let request = Request { to: TO, origin: RobotId(9), number: 7, kind: RequestKind::Redirect, valid_ms: 2_000 };
    let ack = Ack { to: TO, boot: 3, number: 7, accepted: true };
    let goal = GoalAssignment { to: RobotId::NONE, version: 0, target: Cell::new(24, -21) };
    let place = WaypointAssignment {
        to: RobotId::NONE,
        version: 1,
        index: 2,
        position_mm: [1, -2, 3],
        velocity_mmps: [-4, 5, -6],
    };
    [
        (
            "STAYA_BEACON",
            Message::Beacon(beacon),
            "time_us=4000000001 x_mm=12345 y_mm=-678901 z_mm=-2147483648 vx_mmps=250 vy_mmps=-3 vz_mmps=32767 radius_mm=150 \
             cell_x=98 cell_y=-98 target_x=-32768 target_y=70 busy_ms=400 heading=8 leader=1 slot=4 mode=5",
        ),
        ("STAYA_REQUEST", Message::Request(request), "target_system=254 origin=9 number=7 kind=2 valid_ms=2000"),
        ("STAYA_ACK", Message::Ack(ack), "target_system=254 request_boot=3 number=7 accepted=1"),
        (
            "STAYA_TEMPLATE",
            template(&[entry(-3, 2, 1), entry(5, 0, 255)]),
            "target_system=254 version=200 part=1 parts=3 slot=4 offset_x=-6 offset_y=9 count=2 entry_x=-3,5 entry_y=3,-5 \
             entry_id=2,0 entry_hops=1,255",
        ),
        (
            "STAYA_TEMPLATE",
            template(&[]),
            "target_system=254 count=0 entry_x=0,0 entry_y=0,0 entry_id=0,0 entry_hops=0,0",
        ),
        ("STAYA_GOAL", Message::Goal(goal), "target_system=0 version=0 target_x=24 target_y=-21"),
        (
            "STAYA_PLACE",
            Message::Waypoint(place),
            "target_system=0 version=1 index=2 x_mm=1 y_mm=-2 z_mm=3 vx_mmps=-4 vy_mmps=5 vz_mmps=-6",
        ),
        (
            "STAYA_LAND",
            Message::Land(LandPatch::from_bytes(
                Cell::new(-3, 1_000),
                core::array::from_fn(|index| 255 - 8 * index as u8),
            )),
            "corner_x=-3 corner_y=1000 tiles=255,247,239,231,223,215,207,199,191,183,175,167,159,151,143,135,127,119,111,103,95,\
             87,79,71,63,55,47,39,31,23,15,7",
        ),
        (
            "STAYA_PAYLOAD",
            Message::Payload(PayloadBytes::of(&(7_u8, -300_i16, 1.5_f32)).expect("fits")),
            "count=7 bytes=7,215,4,0,0,192,63,0,0,0,0,0,0,0,0,0",
        ),
        (
            "STAYA_LOST",
            Message::Lost(LostRobot {
                id: TO,
                is_lost: true,
                age_cs: 6_553,
                position_mm: [-1, 2_000_000, 3],
                radius_mm: 250,
            }),
            "x_mm=-1 y_mm=2000000 z_mm=3 radius_mm=250 age_cs=6553 robot=254 is_lost=1",
        ),
    ]
}

#[test]
fn golden_mavlink_frames() {
    let mut table = String::from("# system 42, boot 3, sequence 777: message, frame, fields\n");
    let header = Header { boot: 3, sender: RobotId(42), sequence: 777 };
    for (name, message, fields) in messages() {
        let mut bytes = heapless::Vec::<u8, 280>::new();
        encode(header, &message, &mut bytes).expect("fits");
        let tag = None;
        assert_eq!(decode(&bytes), Ok(Frame { header, message, tag }));
        let hex: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        writeln!(table, "{name} {hex} {fields}").expect("strings take everything");
    }
    staya_tests::golden("mavlink-frames", &table, &[]);
}
