//! Decodes beacons without a deserializer, exactly as postcard would. Most frames are beacons, and
//! a host that runs many robots spends most of its time on decoding them.

use super::{Header, Message};
use crate::fixint::Fields;
use crate::robot::{Mode, RobotId};
use crate::wire::{Beacon, Bytes, ProtocolId};

const BEACON: u8 = 0;

/// Returns `None` for anything else and for numbers from 2^28 on: those are left to postcard.
pub(super) fn read(body: &[u8]) -> Option<(Header, Message)> {
    let mut rest = Fields(body);
    let [boot] = rest.take()?;
    let (sender, sequence) = (RobotId(rest.number()?), rest.fixed()?);
    let [BEACON] = rest.take()? else {
        return None;
    };
    let position_mm = [rest.fixed()?, rest.fixed()?, rest.fixed()?];
    let velocity_mmps = [rest.fixed()?, rest.fixed()?, rest.fixed()?];
    let radius_mm = rest.fixed()?;
    let [mode, flock, protocol, len] = rest.take()?;
    let mode = Mode::from_number(mode)?;
    if usize::from(len) != rest.0.len() || !sender.is_some() {
        return None;
    }
    let (protocol, payload) = (ProtocolId(protocol), Bytes::from_slice(rest.0).ok()?);
    let beacon = Beacon { position_mm, velocity_mmps, radius_mm, mode, flock, protocol, payload };
    Some((Header { boot, sender, sequence }, Message::Beacon(beacon)))
}
