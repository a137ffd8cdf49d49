//! Strategies for arbitrary messages.

use super::*;
use crate::robot::{Mode, RobotId};
use proptest::collection::vec;
use proptest::prelude::*;

pub fn robot() -> impl Strategy<Value = RobotId> {
    prop_oneof![0..300_u32, any::<u32>()].prop_map(RobotId)
}

pub fn sender() -> impl Strategy<Value = RobotId> {
    robot().prop_map(|id| RobotId(id.0.max(1)))
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

/// Mostly none or one of the built-in ones.
pub fn protocol() -> impl Strategy<Value = ProtocolId> {
    prop_oneof![3 => 0..3_u8, 1 => any::<u8>()].prop_map(ProtocolId)
}

pub fn bytes<const N: usize>() -> impl Strategy<Value = Bytes<N>> {
    vec(any::<u8>(), 0..=N).prop_map(|bytes| Bytes::from_slice(&bytes).unwrap())
}

pub fn beacon() -> impl Strategy<Value = Beacon> {
    let motion = any::<([i32; 3], [i16; 3], u16)>();
    let law = (mode(), any::<u8>(), protocol(), bytes());
    (motion, law).prop_map(|((position_mm, velocity_mmps, radius_mm), (mode, flock, protocol, payload))| Beacon {
        position_mm,
        velocity_mmps,
        radius_mm,
        mode,
        flock,
        protocol,
        payload,
    })
}

pub fn relayed() -> impl Strategy<Value = Relayed> {
    (robot(), any::<u16>(), beacon()).prop_map(|(id, age_cs, beacon)| {
        let Beacon { position_mm, velocity_mmps: _, radius_mm, mode, flock, protocol, payload } = beacon;
        Relayed { id, age_cs, position_mm, radius_mm, mode, flock, protocol, payload }
    })
}

fn addressed() -> impl Strategy<Value = Addressed> {
    (robot(), any::<u8>(), protocol(), bytes()).prop_map(|(to, number, protocol, content)| Addressed {
        to,
        number,
        protocol,
        content,
    })
}

pub fn message() -> impl Strategy<Value = Message> {
    let beacon = beacon().prop_map(Message::Beacon);
    let law = addressed().prop_map(Message::Law);
    let order = addressed().prop_map(Message::Order);
    let ack = (robot(), any::<[u8; 2]>()).prop_map(|(to, [boot, number])| Message::Ack(Ack { to, boot, number }));
    let broadcast =
        (protocol(), bytes()).prop_map(|(protocol, content)| Message::Broadcast(Broadcast { protocol, content }));
    let phase = || prop_oneof![Just(KeyPhase::Hear), Just(KeyPhase::Speak), Just(KeyPhase::Forget)];
    let key = (robot(), any::<u16>(), phase(), any::<[u8; 32]>())
        .prop_map(|(to, generation, phase, wrapped)| Message::Key(KeyAssignment { to, generation, phase, wrapped }));
    let held = (robot(), any::<u16>(), phase())
        .prop_map(|(to, generation, phase)| Message::KeyHeld(KeyHeld { to, generation, phase }));
    let lost = (robot(), any::<bool>(), any::<u16>(), any::<[i32; 3]>(), any::<u16>());
    let lost = lost.prop_map(|(id, is_lost, age_cs, position_mm, radius_mm)| {
        Message::Lost(LostRobot { id, is_lost, age_cs, position_mm, radius_mm })
    });
    let relayed = relayed().prop_map(Message::Relayed);
    prop_oneof![
        2 => beacon, 2 => law, 1 => ack, 1 => broadcast, 2 => order, 1 => lost, 1 => key, 1 => held, 1 => relayed
    ]
}
