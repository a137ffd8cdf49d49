//! Strategies for arbitrary messages.

use super::*;
use crate::grid::{Cell, Dir};
use crate::land::LandPatch;
use crate::robot::{Mode, RobotId};
use crate::template::TemplateEntry;
use crate::time::Instant;
use proptest::collection::vec;
use proptest::prelude::*;

pub fn robot() -> impl Strategy<Value = RobotId> {
    prop_oneof![0..300_u32, any::<u32>()].prop_map(RobotId)
}

pub fn sender() -> impl Strategy<Value = RobotId> {
    robot().prop_map(|id| RobotId(id.0.max(1)))
}

pub fn cell() -> impl Strategy<Value = Cell> {
    any::<(i16, i16)>().prop_map(|(x, y)| Cell::new(x, y))
}

pub fn header() -> impl Strategy<Value = Header> {
    (any::<u8>(), sender(), any::<u16>()).prop_map(|(boot, sender, sequence)| Header { boot, sender, sequence })
}

fn mode() -> impl Strategy<Value = Mode> {
    prop_oneof![
        Just(Mode::Idle),
        Just(Mode::Forming),
        Just(Mode::Cruise),
        Just(Mode::Hold),
        Just(Mode::Arrived),
        Just(Mode::Fault),
        Just(Mode::Passive),
    ]
}

pub fn kind() -> impl Strategy<Value = RequestKind> {
    prop_oneof![Just(RequestKind::Stop), Just(RequestKind::Resume), Just(RequestKind::Redirect),]
}

fn beacon() -> impl Strategy<Value = Message> {
    let motion = (any::<u32>(), any::<[i32; 3]>(), any::<[i16; 3]>());
    let body = (any::<u16>(), cell(), 0..=8_u8, any::<u16>());
    let task = (robot(), any::<u8>(), mode(), cell());
    (motion, body, task).prop_map(|(motion, body, task)| {
        let (time, position_mm, velocity_mmps) = motion;
        let (radius_mm, cell, heading, busy_ms) = body;
        let (leader, slot, mode, target) = task;
        Message::Beacon(Beacon {
            time: Instant::from_micros(time),
            position_mm,
            velocity_mmps,
            radius_mm,
            cell,
            heading: Dir::from_index(heading),
            busy_ms,
            leader,
            slot,
            mode,
            target,
        })
    })
}

pub fn entry() -> impl Strategy<Value = TemplateEntry> {
    (cell(), robot(), any::<u8>()).prop_map(|(offset, id, hops)| TemplateEntry { offset, id, hops })
}

fn template() -> impl Strategy<Value = Message> {
    let place = (robot(), any::<[u8; 4]>(), cell());
    (place, vec(entry(), 0..=TEMPLATE_PART)).prop_map(|(place, entries)| {
        let (to, [version, part, parts, slot], offset) = place;
        Message::Template(TemplateAssignment {
            to,
            version,
            part,
            parts,
            slot,
            offset,
            entries: entries.into_iter().collect(),
        })
    })
}

pub fn message() -> impl Strategy<Value = Message> {
    let request = (robot(), robot(), any::<u8>(), kind(), any::<u16>());
    let request = request.prop_map(|(to, origin, number, kind, valid_ms)| {
        Message::Request(Request { to, origin, number, kind, valid_ms })
    });
    let ack = (robot(), any::<[u8; 2]>(), any::<bool>())
        .prop_map(|(to, [boot, number], accepted)| Message::Ack(Ack { to, boot, number, accepted }));
    let goal = (robot(), any::<u8>(), cell())
        .prop_map(|(to, version, target)| Message::Goal(GoalAssignment { to, version, target }));
    let place = (robot(), any::<[u8; 2]>(), any::<([i32; 3], [i16; 3])>());
    let place = place.prop_map(|(to, [version, index], (position_mm, velocity_mmps))| {
        Message::Waypoint(WaypointAssignment { to, version, index, position_mm, velocity_mmps })
    });
    let phase = || prop_oneof![Just(KeyPhase::Hear), Just(KeyPhase::Speak), Just(KeyPhase::Forget)];
    let key = (robot(), any::<u16>(), phase(), any::<[u8; 32]>())
        .prop_map(|(to, generation, phase, wrapped)| Message::Key(KeyAssignment { to, generation, phase, wrapped }));
    let held = (robot(), any::<u16>(), phase())
        .prop_map(|(to, generation, phase)| Message::KeyHeld(KeyHeld { to, generation, phase }));
    let land =
        (cell(), any::<[u8; 32]>()).prop_map(|(corner, bytes)| Message::Land(LandPatch::from_bytes(corner, bytes)));
    let payload = vec(any::<u8>(), 0..=MAX_PAYLOAD);
    let payload = payload.prop_map(|bytes| Message::Payload(PayloadBytes::new(&bytes).unwrap_or_default()));
    let lost = (robot(), any::<bool>(), any::<u16>(), any::<[i32; 3]>(), any::<u16>());
    let lost = lost.prop_map(|(id, is_lost, age_cs, position_mm, radius_mm)| {
        Message::Lost(LostRobot { id, is_lost, age_cs, position_mm, radius_mm })
    });
    let keys = prop_oneof![key, held];
    prop_oneof![beacon(), request, ack, template(), goal, place, keys, land, payload, lost]
}
