//! The swarm's messages as MAVLink 2 frames: [`Mavlink`], a [`Wire`] like postcard.
//!
//! Each message of the controller is one `STAYA_*` message of the dialect, with boot and sequence
//! of its [`Header`] in the payload: MAVLink's 8-bit sequence is too short to detect repeated
//! frames. A robot's number is its system: 1 to 254, and 255 for a ground station. Its component is
//! [`COMPONENT`].
//!
//! Other systems may share the band. MAVLink messages that are not `STAYA_*` give
//! [`DecodeError::Foreign`] and do not count as damage. [`Wire::next_frame`] returns all other
//! bytes between frames as one piece, which [`Wire::decode`] rejects, so that it is counted.

use crate::dialect::{
    STAYA_ACK_DATA, STAYA_BEACON_DATA, STAYA_GOAL_DATA, STAYA_LAND_DATA, STAYA_LOST_DATA, STAYA_PAYLOAD_DATA,
    STAYA_PLACE_DATA, STAYA_REQUEST_DATA, STAYA_TEMPLATE_DATA,
};
use crate::frame::{self, Full, RawFrame, Scan, Sender, scan};
use heapless::Vec;
use mavlink_core::MessageData;
use serde::{Deserialize, Serialize};
use staya_controller::grid::{Cell, Dir};
use staya_controller::land::LandPatch;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::template::TemplateEntry;
use staya_controller::time::Instant;
use staya_controller::wire::{
    Ack, Beacon, DecodeError, EncodeError, Frame, GoalAssignment, Header, LostRobot, MAX_PAYLOAD, Message,
    PayloadBytes, Request, RequestKind, TEMPLATE_PART, TemplateAssignment, WaypointAssignment, Wire,
};

/// The component of robots: an onboard computer (`MAV_COMP_ID_ONBOARD_COMPUTER`).
pub const COMPONENT: u8 = 191;
/// The largest number of a robot; 255 is a ground station.
pub const MAX_ROBOT: u8 = 254;
/// Bytes of a frame around its payload.
const AROUND: usize = 12;

/// Maximum length of a beacon's frame in bytes.
pub const BEACON_LEN: usize = AROUND + STAYA_BEACON_DATA::ENCODED_LEN;

/// Unsigned MAVLink 2 frames. It has no state, and ignores the signatures of others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Mavlink;

impl Wire for Mavlink {
    fn beacon_len(&self) -> usize {
        BEACON_LEN
    }

    fn encode<const N: usize>(
        &mut self,
        header: Header,
        message: &Message,
        out: &mut Vec<u8, N>,
    ) -> Result<usize, EncodeError> {
        encode(header, message, out)
    }

    fn decode(&mut self, frame: &[u8]) -> Result<Frame, DecodeError> {
        decode(frame)
    }

    fn next_frame<'a>(&self, rest: &mut &'a [u8]) -> Option<&'a [u8]> {
        next_frame(rest)
    }
}

/// Removes the next frame, or the bytes before it that belong to no frame, from the complete bytes
/// `rest`; `None` when nothing is left. Bounded work: that of [`scan`].
pub fn next_frame<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    let len = match scan(rest, true) {
        Scan::Frame { junk: 0, frame } => frame.bytes().len(),
        Scan::Frame { junk, .. } | Scan::Nothing { junk } => junk,
    };
    let (piece, behind) = rest.split_at_checked(len)?;
    *rest = behind;
    (!piece.is_empty()).then_some(piece)
}

/// Appends an unsigned MAVLink 2 frame and returns its length. Bounded work: O(frame bytes).
///
/// # Errors
/// [`EncodeError::NoSender`] if the sender is [`RobotId::NONE`], [`EncodeError::Robot`] if a robot
/// number is above 255, [`EncodeError::Full`] if the frame does not fit. Nothing is written then.
pub fn encode<const N: usize>(header: Header, message: &Message, out: &mut Vec<u8, N>) -> Result<usize, EncodeError> {
    if !header.sender.is_some() {
        return Err(EncodeError::NoSender);
    }
    let sender = Sender {
        system: system(header.sender)?,
        component: COMPONENT,
        // The frame count as MAVLink requires it.
        sequence: header.sequence as u8,
    };
    let Header { boot, sequence, .. } = header;
    let written = match message {
        Message::Beacon(beacon) => {
            let [x_mm, y_mm, z_mm] = beacon.position_mm;
            let [vx_mmps, vy_mmps, vz_mmps] = beacon.velocity_mmps;
            let data = STAYA_BEACON_DATA {
                time_us: beacon.time.as_micros(),
                x_mm,
                y_mm,
                z_mm,
                vx_mmps,
                vy_mmps,
                vz_mmps,
                radius_mm: beacon.radius_mm,
                cell_x: beacon.cell.x,
                cell_y: beacon.cell.y,
                target_x: beacon.target.x,
                target_y: beacon.target.y,
                busy_ms: beacon.busy_ms,
                sequence,
                boot,
                heading: heading(beacon.heading),
                leader: system(beacon.leader)?,
                slot: beacon.slot,
                mode: beacon.mode as u8,
            };
            frame::encode(sender, &data, out)
        }
        Message::Request(request) => {
            let data = STAYA_REQUEST_DATA {
                valid_ms: request.valid_ms,
                sequence,
                boot,
                target_system: system(request.to)?,
                origin: system(request.origin)?,
                number: request.number,
                kind: match request.kind {
                    RequestKind::Stop => 0,
                    RequestKind::Resume => 1,
                    RequestKind::Redirect => 2,
                },
            };
            frame::encode(sender, &data, out)
        }
        Message::Ack(ack) => {
            let data = STAYA_ACK_DATA {
                sequence,
                boot,
                target_system: system(ack.to)?,
                request_boot: ack.boot,
                number: ack.number,
                accepted: ack.accepted.into(),
            };
            frame::encode(sender, &data, out)
        }
        Message::Template(part) => {
            let data = template(part, boot, sequence)?;
            frame::encode(sender, &data, out)
        }
        Message::Goal(goal) => {
            let data = STAYA_GOAL_DATA {
                sequence,
                target_x: goal.target.x,
                target_y: goal.target.y,
                boot,
                target_system: system(goal.to)?,
                version: goal.version,
            };
            frame::encode(sender, &data, out)
        }
        Message::Waypoint(place) => {
            let [x_mm, y_mm, z_mm] = place.position_mm;
            let [vx_mmps, vy_mmps, vz_mmps] = place.velocity_mmps;
            let data = STAYA_PLACE_DATA {
                x_mm,
                y_mm,
                z_mm,
                vx_mmps,
                vy_mmps,
                vz_mmps,
                sequence,
                boot,
                target_system: system(place.to)?,
                version: place.version,
                index: place.index,
            };
            frame::encode(sender, &data, out)
        }
        Message::Land(patch) => {
            let Cell { x: corner_x, y: corner_y } = patch.corner;
            let data = STAYA_LAND_DATA { sequence, corner_x, corner_y, boot, tiles: patch.bytes() };
            frame::encode(sender, &data, out)
        }
        Message::Payload(payload) => {
            let mut data = STAYA_PAYLOAD_DATA { sequence, boot, ..STAYA_PAYLOAD_DATA::DEFAULT };
            for (byte, told) in data.bytes.iter_mut().zip(payload.as_slice()) {
                *byte = *told;
                data.count = data.count.saturating_add(1);
            }
            frame::encode(sender, &data, out)
        }
        Message::Lost(lost) => {
            let [x_mm, y_mm, z_mm] = lost.position_mm;
            let data = STAYA_LOST_DATA {
                x_mm,
                y_mm,
                z_mm,
                radius_mm: lost.radius_mm,
                age_cs: lost.age_cs,
                sequence,
                boot,
                robot: system(lost.id)?,
                is_lost: lost.is_lost.into(),
            };
            frame::encode(sender, &data, out)
        }
        // MAVLink's signatures have one key: see `Sealed` for robots with their own keys.
        Message::Key(_) | Message::KeyHeld(_) => return Err(EncodeError::Full),
    };
    written.map_err(|Full| EncodeError::Full)
}

/// Decodes one MAVLink 2 frame, ignoring any signature. Bounded work: O(frame bytes).
///
/// # Errors
/// [`DecodeError::Crc`] if the bytes are not an intact frame, [`DecodeError::Foreign`] if it is not
/// a `STAYA_*` message, [`DecodeError::NoSender`] for system 0, [`DecodeError::Body`] for an
/// invalid field (an unknown mode, more neighbours than a part holds, ...).
pub fn decode(bytes: &[u8]) -> Result<Frame, DecodeError> {
    if bytes.is_empty() {
        return Err(DecodeError::Empty);
    }
    let raw = RawFrame::new(bytes).ok_or(DecodeError::Crc)?;
    let (boot, sequence, message) = match raw.message_id() {
        STAYA_BEACON_DATA::ID => beacon(&body(&raw)?)?,
        STAYA_REQUEST_DATA::ID => request(&body(&raw)?)?,
        STAYA_ACK_DATA::ID => ack(&body(&raw)?)?,
        STAYA_TEMPLATE_DATA::ID => template_part(&body(&raw)?)?,
        STAYA_GOAL_DATA::ID => {
            let data: STAYA_GOAL_DATA = body(&raw)?;
            let goal = GoalAssignment {
                to: robot(data.target_system),
                version: data.version,
                target: Cell::new(data.target_x, data.target_y),
            };
            (data.boot, data.sequence, Message::Goal(goal))
        }
        STAYA_PLACE_DATA::ID => {
            let data: STAYA_PLACE_DATA = body(&raw)?;
            let place = WaypointAssignment {
                to: robot(data.target_system),
                version: data.version,
                index: data.index,
                position_mm: [data.x_mm, data.y_mm, data.z_mm],
                velocity_mmps: [data.vx_mmps, data.vy_mmps, data.vz_mmps],
            };
            (data.boot, data.sequence, Message::Waypoint(place))
        }
        STAYA_LAND_DATA::ID => {
            let data: STAYA_LAND_DATA = body(&raw)?;
            let corner = Cell::new(data.corner_x, data.corner_y);
            (data.boot, data.sequence, Message::Land(LandPatch::from_bytes(corner, data.tiles)))
        }
        STAYA_PAYLOAD_DATA::ID => {
            let data: STAYA_PAYLOAD_DATA = body(&raw)?;
            let bytes = data.bytes.get(..usize::from(data.count));
            let payload = bytes.and_then(PayloadBytes::new).ok_or(DecodeError::Body)?;
            (data.boot, data.sequence, Message::Payload(payload))
        }
        STAYA_LOST_DATA::ID => {
            let data: STAYA_LOST_DATA = body(&raw)?;
            let lost = LostRobot {
                id: robot(data.robot),
                is_lost: match data.is_lost {
                    0 => false,
                    1 => true,
                    _ => return Err(DecodeError::Body),
                },
                age_cs: data.age_cs,
                position_mm: [data.x_mm, data.y_mm, data.z_mm],
                radius_mm: data.radius_mm,
            };
            (data.boot, data.sequence, Message::Lost(lost))
        }
        _ => return Err(DecodeError::Foreign),
    };
    let header = Header { boot, sender: robot(raw.sender().system), sequence };
    if !header.sender.is_some() {
        return Err(DecodeError::NoSender);
    }
    Ok(Frame { header, message, tag: None })
}

type Parts = Result<(u8, u16, Message), DecodeError>;

fn body<D: MessageData>(raw: &RawFrame<'_>) -> Result<D, DecodeError> {
    raw.get().ok_or(DecodeError::Body)
}

fn beacon(data: &STAYA_BEACON_DATA) -> Parts {
    let beacon = Beacon {
        time: Instant::from_micros(data.time_us),
        position_mm: [data.x_mm, data.y_mm, data.z_mm],
        velocity_mmps: [data.vx_mmps, data.vy_mmps, data.vz_mmps],
        radius_mm: data.radius_mm,
        cell: Cell::new(data.cell_x, data.cell_y),
        heading: dir(data.heading).ok_or(DecodeError::Body)?,
        busy_ms: data.busy_ms,
        leader: robot(data.leader),
        slot: data.slot,
        mode: mode(data.mode).ok_or(DecodeError::Body)?,
        target: Cell::new(data.target_x, data.target_y),
    };
    Ok((data.boot, data.sequence, Message::Beacon(beacon)))
}

fn request(data: &STAYA_REQUEST_DATA) -> Parts {
    let request = Request {
        to: robot(data.target_system),
        origin: robot(data.origin),
        number: data.number,
        kind: match data.kind {
            0 => RequestKind::Stop,
            1 => RequestKind::Resume,
            2 => RequestKind::Redirect,
            _ => return Err(DecodeError::Body),
        },
        valid_ms: data.valid_ms,
    };
    Ok((data.boot, data.sequence, Message::Request(request)))
}

fn ack(data: &STAYA_ACK_DATA) -> Parts {
    let ack = Ack {
        to: robot(data.target_system),
        boot: data.request_boot,
        number: data.number,
        accepted: match data.accepted {
            0 => false,
            1 => true,
            _ => return Err(DecodeError::Body),
        },
    };
    Ok((data.boot, data.sequence, Message::Ack(ack)))
}

#[expect(clippy::arithmetic_side_effects, reason = "at most as many as a part has entries")]
fn template(part: &TemplateAssignment, boot: u8, sequence: u16) -> Result<STAYA_TEMPLATE_DATA, EncodeError> {
    let mut data = STAYA_TEMPLATE_DATA {
        sequence,
        offset_x: part.offset.x,
        offset_y: part.offset.y,
        boot,
        target_system: system(part.to)?,
        version: part.version,
        part: part.part,
        parts: part.parts,
        slot: part.slot,
        ..STAYA_TEMPLATE_DATA::DEFAULT
    };
    let places = data.entry_x.iter_mut().zip(&mut data.entry_y);
    let others = data.entry_id.iter_mut().zip(&mut data.entry_hops);
    for ((entry, (x, y)), (id, hops)) in part.entries.iter().zip(places).zip(others) {
        (*x, *y) = (entry.offset.x, entry.offset.y);
        (*id, *hops) = (system(entry.id)?, entry.hops);
        data.count += 1;
    }
    Ok(data)
}

// A part of the controller's template fits one message, and so does the payload of a law.
const _: () = assert!(MAX_PAYLOAD == STAYA_PAYLOAD_DATA::DEFAULT.bytes.len());
const _: () = assert!(TEMPLATE_PART == STAYA_TEMPLATE_DATA::DEFAULT.entry_id.len());

fn template_part(data: &STAYA_TEMPLATE_DATA) -> Parts {
    let count = usize::from(data.count);
    if count > TEMPLATE_PART {
        return Err(DecodeError::Body);
    }
    let places = data.entry_x.iter().zip(&data.entry_y);
    let others = data.entry_id.iter().zip(&data.entry_hops);
    let mut entries = Vec::new();
    for ((x, y), (id, hops)) in places.zip(others).take(count) {
        let entry = TemplateEntry { offset: Cell::new(*x, *y), id: robot(*id), hops: *hops };
        entries.push(entry).map_err(|_| DecodeError::Body)?;
    }
    let part = TemplateAssignment {
        to: robot(data.target_system),
        version: data.version,
        part: data.part,
        parts: data.parts,
        slot: data.slot,
        offset: Cell::new(data.offset_x, data.offset_y),
        entries,
    };
    Ok((data.boot, data.sequence, Message::Template(part)))
}

fn system(id: RobotId) -> Result<u8, EncodeError> {
    u8::try_from(id.0).map_err(|_| EncodeError::Robot(id))
}

fn robot(system: u8) -> RobotId {
    RobotId(system.into())
}

/// 0: stays; 1 to 8: the move of that number minus one.
#[expect(clippy::arithmetic_side_effects, reason = "an index is at most 7")]
const fn heading(dir: Dir) -> u8 {
    match dir {
        Dir::Stay => 0,
        dir => dir.index() as u8 + 1,
    }
}

#[expect(clippy::arithmetic_side_effects, reason = "1 to 8")]
fn dir(heading: u8) -> Option<Dir> {
    match heading {
        0 => Some(Dir::Stay),
        1..=8 => Some(Dir::from_index(heading - 1)),
        _ => None,
    }
}

fn mode(number: u8) -> Option<Mode> {
    const MODES: [Mode; 7] =
        [Mode::Idle, Mode::Forming, Mode::Cruise, Mode::Hold, Mode::Arrived, Mode::Fault, Mode::Passive];
    MODES.get(usize::from(number)).copied()
}

#[cfg(test)]
mod tests;
