//! A MAVLink frame of each of the swarm's messages, for `tests/python/test_dialect.py`.

use staya_controller::agent::{
    Grid, GridMessage, GridOrder, GridPayload, Protocol as _, TemplatePart, Waypoint, WaypointOrder, Waypoints,
};
use staya_controller::geom::{Position, Vec3};
use staya_controller::grid::{Cell, Dir};
use staya_controller::land::LandPatch;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::template::TemplateEntry;
use staya_controller::time::Instant;
use staya_controller::wire::{
    Ack, Addressed, Beacon, Broadcast, Bytes, Content as _, Frame, Header, LostRobot, Message, ProtocolId, Relayed,
};
use staya_mavlink::wire::{decode, encode};
use std::fmt::Write as _;

const TO: RobotId = RobotId(254);
/// A protocol of a user.
const OWN: ProtocolId = ProtocolId(64);

fn bytes<const N: usize>(bytes: &[u8]) -> Bytes<N> {
    Bytes::from_slice(bytes).expect("fits")
}

fn messages() -> [(&'static str, Message, &'static str); 12] {
    let entry = |x, id, hops| TemplateEntry { offset: Cell::new(x, -x), id: RobotId(id), hops };
    let template = |entries: &[TemplateEntry]| {
        let (offset, entries) = (Cell::new(-6, 9), entries.iter().copied().collect());
        let part = TemplatePart { version: 200, part: 1, parts: 3, slot: 4, offset, entries };
        Grid::order(TO, 200, &GridOrder::Template { part, is_restarted: false }).expect("fits")
    };
    let payload = GridPayload {
        cell: Cell::new(98, -98),
        target: Cell::new(-32_768, 70),
        busy_ms: 400,
        heading: Dir::SouthEast,
        slot: 4,
        leader: RobotId(1),
    };
    let (protocol, payload) = payload.encode(Grid::ID).expect("fits");
    let beacon = Beacon {
        position_mm: [12_345, -678_901, i32::MIN],
        velocity_mmps: [250, -3, i16::MAX],
        radius_mm: 150,
        mode: Mode::Fault,
        flock: 9,
        protocol,
        payload,
    };
    let Beacon { position_mm, radius_mm, mode, flock, payload, .. } = beacon.clone();
    let said = Relayed { id: TO, age_cs: 12, position_mm, radius_mm, mode, flock, protocol, payload };
    let own = Beacon { mode: Mode::Hold, protocol: OWN, payload: bytes(&[1; 16]), ..Beacon::default() };
    let stop = GridMessage::Stop { origin: RobotId(9), valid_ms: 2_000 };
    let (protocol, content) = stop.encode(Grid::ID).expect("fits");
    let stop = Addressed { to: TO, number: 7, protocol, content };
    let tiles = core::array::from_fn(|index| 255 - 8 * index as u8);
    let land = GridMessage::Land(LandPatch::from_bytes(Cell::new(-3, 1_000), tiles));
    let (protocol, content) = land.encode(Grid::ID).expect("fits");
    let land = Broadcast { protocol, content };
    let order = Addressed { to: TO, number: 8, protocol: OWN, content: bytes(&[7, 215, 4, 0, 0, 192, 63]) };
    let ack = Ack { to: TO, boot: 3, number: 7 };
    let goal = Grid::order(RobotId::NONE, 0, &GridOrder::FormationGoal(Cell::new(24, -21))).expect("fits");
    let waypoint = Waypoint {
        position: Position::from_mm([1, -2, 3]),
        velocity_mps: Vec3::from_milli([-4, 5, -6]),
        at: Instant::default(),
    };
    let place = Waypoints::order(RobotId::NONE, 1, &WaypointOrder { index: 2, waypoint }).expect("fits");
    [
        (
            "STAYA_BEACON",
            Message::Beacon(beacon),
            "x_mm=12345 y_mm=-678901 z_mm=-2147483648 vx_mmps=250 vy_mmps=-3 vz_mmps=32767 radius_mm=150 mode=5 flock=9 \
             protocol=1 count=13 bytes=98,0,158,255,0,128,70,0,144,1,7,4,1,0,0,0",
        ),
        (
            "STAYA_BEACON",
            Message::Beacon(own),
            "x_mm=0 radius_mm=0 mode=3 flock=0 protocol=64 count=16 bytes=1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1",
        ),
        (
            "STAYA_MESSAGE",
            Message::Law(stop),
            "target_system=254 kind=0 number=7 protocol=1 count=4 \
             bytes=0,9,208,7,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0",
        ),
        (
            "STAYA_MESSAGE",
            Message::Broadcast(land),
            "target_system=0 kind=1 number=0 protocol=1 count=37 bytes=3,253,255,232,3,\
             255,247,239,231,223,215,207,199,191,183,175,167,159,151,143,135,127,119,111,103,95,87,79,71,63,55,47,39,31,23,15,7,0",
        ),
        (
            "STAYA_MESSAGE",
            Message::Order(order),
            "target_system=254 kind=2 number=8 protocol=64 count=7 \
             bytes=7,215,4,0,0,192,63,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0",
        ),
        ("STAYA_ACK", Message::Ack(ack), "target_system=254 message_boot=3 number=7"),
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
        ("STAYA_GOAL", goal, "target_system=0 version=0 target_x=24 target_y=-21"),
        (
            "STAYA_PLACE",
            place,
            "target_system=0 version=1 index=2 x_mm=1 y_mm=-2 z_mm=3 vx_mmps=-4 vy_mmps=5 vz_mmps=-6",
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
        (
            "STAYA_RELAYED",
            Message::Relayed(said),
            "x_mm=12345 y_mm=-678901 z_mm=-2147483648 radius_mm=150 age_cs=12 robot=254 mode=5 flock=9 protocol=1 \
             count=13 bytes=98,0,158,255,0,128,70,0,144,1,7,4,1,0,0,0",
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
