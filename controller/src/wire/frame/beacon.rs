//! Decodes beacons without a deserializer, exactly as postcard would. Most frames are beacons, and
//! a host that runs many robots spends most of its time on decoding them.

use super::{Header, Message};
use crate::fixint::Fixed;
use crate::robot::{Mode, RobotId};
use crate::wire::{Beacon, Bytes, ProtocolId};

/// Indexed by their number on the wire.
const MODES: [Mode; 7] =
    [Mode::Idle, Mode::Forming, Mode::Cruise, Mode::Hold, Mode::Arrived, Mode::Fault, Mode::Passive];
const BEACON: u8 = 0;

/// Returns `None` for anything else and for numbers from 2^28 on: those are left to postcard.
pub(super) fn read(body: &[u8]) -> Option<(Header, Message)> {
    let mut rest = body;
    let [boot] = take(&mut rest)?;
    let sender = number(&mut rest)?;
    let sequence = fixed::<u16, 2>(&mut rest)?;
    let [BEACON] = take(&mut rest)? else {
        return None;
    };
    let position_mm = [fixed::<i32, 4>(&mut rest)?, fixed::<i32, 4>(&mut rest)?, fixed::<i32, 4>(&mut rest)?];
    let velocity_mmps = [fixed::<i16, 2>(&mut rest)?, fixed::<i16, 2>(&mut rest)?, fixed::<i16, 2>(&mut rest)?];
    let radius_mm = fixed::<u16, 2>(&mut rest)?;
    let [mode, flock, protocol, len] = take(&mut rest)?;
    let mode = *MODES.get(usize::from(mode))?;
    if usize::from(len) != rest.len() || !sender.is_some() {
        return None;
    }
    let (protocol, payload) = (ProtocolId(protocol), Bytes::from_slice(rest).ok()?);
    let beacon = Beacon { position_mm, velocity_mmps, radius_mm, mode, flock, protocol, payload };
    Some((Header { boot, sender, sequence }, Message::Beacon(beacon)))
}

fn take<const N: usize>(rest: &mut &[u8]) -> Option<[u8; N]> {
    let (bytes, after) = rest.split_first_chunk()?;
    *rest = after;
    Some(*bytes)
}

fn fixed<T: Fixed<Bytes = [u8; N]>, const N: usize>(rest: &mut &[u8]) -> Option<T> {
    take(rest).map(T::from_bytes)
}

/// Groups of 7 bits, at most four of them.
fn number(rest: &mut &[u8]) -> Option<RobotId> {
    let mut number = 0;
    for shift in [0, 7, 14, 21] {
        let [byte] = take(rest)?;
        number |= u32::from(byte & 0x7F).wrapping_shl(shift);
        if byte < 0x80 {
            return Some(RobotId(number));
        }
    }
    None
}
