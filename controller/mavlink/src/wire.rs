//! The swarm's messages as MAVLink 2 frames: [`Mavlink`], a [`Wire`] like postcard.
//!
//! Each message of the controller is a `STAYA_*` message of the dialect, with boot and sequence
//! of its [`Header`] in the payload: MAVLink's 8-bit sequence is too short to detect repeated
//! frames. A robot's number is its system: 1 to 254, and 255 for a ground station. Its component is
//! [`COMPONENT`].
//!
//! Other systems may share the band. MAVLink messages that are not `STAYA_*` give
//! [`DecodeError::Foreign`] and do not count as damage. [`Wire::next_frame`] returns all other
//! bytes between frames as one piece, which [`Wire::decode`] rejects, so that it is counted.

use crate::dialect::{
    STAYA_ACK_DATA, STAYA_BEACON_DATA, STAYA_GOAL_DATA, STAYA_LOST_DATA, STAYA_MESSAGE_DATA, STAYA_PLACE_DATA,
    STAYA_RELAYED_DATA, STAYA_TEMPLATE_DATA,
};
use crate::frame::{self, Full, RawFrame, Scan, Sender, scan};
use heapless::Vec;
use mavlink_core::MessageData;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{
    AnyOrder, Grid, GridOrder, Protocol as _, TEMPLATE_PART, TemplatePart, Waypoint, WaypointOrder, Waypoints,
};
use staya_controller::geom::{Position, Vec3};
use staya_controller::grid::Cell;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::scalar::Scalar as _;
use staya_controller::template::TemplateEntry;
use staya_controller::time::Instant;
use staya_controller::wire::{
    Ack, Addressed, Beacon, Broadcast, Bytes, Content, DecodeError, EncodeError, Frame, Header, LostRobot, MAX_CONTENT,
    MAX_ORDER, MAX_PAYLOAD, Message, ProtocolId, Relayed, Wire,
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
            let (count, bytes) = padded(&beacon.payload);
            let data = STAYA_BEACON_DATA {
                x_mm,
                y_mm,
                z_mm,
                vx_mmps,
                vy_mmps,
                vz_mmps,
                radius_mm: beacon.radius_mm,
                sequence,
                boot,
                mode: beacon.mode as u8,
                flock: beacon.flock,
                protocol: beacon.protocol.0,
                count,
                bytes,
            };
            frame::encode(sender, &data, out)
        }
        Message::Law(Addressed { to, number, protocol, content }) => {
            let to_one = ToLaw { to: *to, kind: TO_ONE, number: *number, protocol: *protocol };
            frame::encode(sender, &to_one.with(content, header)?, out)
        }
        Message::Broadcast(Broadcast { protocol, content }) => {
            let to_all = ToLaw { to: RobotId::NONE, kind: TO_ALL, number: 0, protocol: *protocol };
            frame::encode(sender, &to_all.with(content, header)?, out)
        }
        Message::Order(order) => return encode_order(sender, header, order, out),
        Message::Ack(ack) => {
            let target_system = system(ack.to)?;
            let data = STAYA_ACK_DATA { sequence, boot, target_system, message_boot: ack.boot, number: ack.number };
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
        Message::Relayed(said) => {
            let [x_mm, y_mm, z_mm] = said.position_mm;
            let (count, bytes) = padded(&said.payload);
            let data = STAYA_RELAYED_DATA {
                x_mm,
                y_mm,
                z_mm,
                radius_mm: said.radius_mm,
                age_cs: said.age_cs,
                sequence,
                boot,
                robot: system(said.id)?,
                mode: said.mode as u8,
                flock: said.flock,
                protocol: said.protocol.0,
                count,
                bytes,
            };
            frame::encode(sender, &data, out)
        }
        // MAVLink's signatures have one key: see `Sealed` for robots with their own keys.
        Message::Key(_) | Message::KeyHeld(_) => return Err(EncodeError::Full),
    };
    written.map_err(|Full| EncodeError::Full)
}

/// Number of a message to one robot, to all, and of an order in `STAYA_MESSAGE`.
const TO_ONE: u8 = 0;
const TO_ALL: u8 = 1;
const ORDER: u8 = 2;

struct ToLaw {
    to: RobotId,
    kind: u8,
    number: u8,
    protocol: ProtocolId,
}

impl ToLaw {
    fn with(self, content: &[u8], header: Header) -> Result<STAYA_MESSAGE_DATA, EncodeError> {
        let Self { to, kind, number, protocol: ProtocolId(protocol) } = self;
        let (count, bytes) = padded(content);
        let Header { boot, sequence, .. } = header;
        Ok(STAYA_MESSAGE_DATA { sequence, boot, target_system: system(to)?, kind, number, protocol, count, bytes })
    }
}

/// Orders of the built-in protocols have messages of their own, which clients fill in by name. An
/// order that these would change travels as bytes.
#[inline(never)]
fn encode_order<const N: usize>(
    sender: Sender,
    header: Header,
    order: &Addressed,
    out: &mut Vec<u8, N>,
) -> Result<usize, EncodeError> {
    let Header { boot, sequence, .. } = header;
    let Addressed { to, number, protocol, content } = order;
    let (target_system, version) = (system(*to)?, *number);
    let named = AnyOrder::decode(*protocol, *protocol, content).filter(|named| is_named(named, order));
    let written = match named {
        Some(AnyOrder::Grid(GridOrder::FormationGoal(Cell { x: target_x, y: target_y }))) => {
            frame::encode(sender, &STAYA_GOAL_DATA { sequence, target_x, target_y, boot, target_system, version }, out)
        }
        Some(AnyOrder::Grid(GridOrder::Template { part, .. })) => {
            frame::encode(sender, &template(&part, target_system, boot, sequence)?, out)
        }
        Some(AnyOrder::Waypoint(WaypointOrder { index, waypoint })) => {
            let [x_mm, y_mm, z_mm] = waypoint.position.mm;
            let Vec3 { x, y, z } = waypoint.velocity_mps;
            let [vx_mmps, vy_mmps, vz_mmps] = [x, y, z].map(milli);
            let data = STAYA_PLACE_DATA {
                x_mm,
                y_mm,
                z_mm,
                vx_mmps,
                vy_mmps,
                vz_mmps,
                sequence,
                boot,
                target_system,
                version,
                index,
            };
            frame::encode(sender, &data, out)
        }
        Some(AnyOrder::Grid(GridOrder::Goal(_)) | AnyOrder::Other(_)) | None => {
            let order = ToLaw { to: *to, kind: ORDER, number: *number, protocol: *protocol };
            frame::encode(sender, &order.with(content, header)?, out)
        }
    };
    written.map_err(|Full| EncodeError::Full)
}

/// Whether the message for this kind of order holds all of it. One that names a robot beyond all
/// systems is refused, in either form.
fn is_named(named: &AnyOrder, order: &Addressed) -> bool {
    let is_other_version =
        matches!(named, AnyOrder::Grid(GridOrder::Template { part, .. }) if part.version != order.number);
    let again = named.encode::<MAX_ORDER>(order.protocol);
    !is_other_version && again.is_some_and(|(id, bytes)| id == order.protocol && bytes == order.content)
}

/// The bytes, followed by zeros, and their number.
fn padded<const N: usize>(content: &[u8]) -> (u8, [u8; N]) {
    let mut bytes = [0; N];
    let mut count = 0_u8;
    for (byte, told) in bytes.iter_mut().zip(content) {
        *byte = *told;
        count = count.saturating_add(1);
    }
    (count, bytes)
}

fn filled<const N: usize>(count: u8, bytes: &[u8]) -> Result<Bytes<N>, DecodeError> {
    let content = bytes.get(..usize::from(count)).and_then(|content| Bytes::from_slice(content).ok());
    content.ok_or(DecodeError::Body)
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
        STAYA_MESSAGE_DATA::ID => to_law(&body(&raw)?)?,
        STAYA_ACK_DATA::ID => {
            let data: STAYA_ACK_DATA = body(&raw)?;
            let ack = Ack { to: robot(data.target_system), boot: data.message_boot, number: data.number };
            (data.boot, data.sequence, Message::Ack(ack))
        }
        STAYA_TEMPLATE_DATA::ID => template_part(&body(&raw)?)?,
        STAYA_GOAL_DATA::ID => goal(&body(&raw)?)?,
        STAYA_PLACE_DATA::ID => place(&body(&raw)?)?,
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
        STAYA_RELAYED_DATA::ID => relayed(&body(&raw)?)?,
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
        position_mm: [data.x_mm, data.y_mm, data.z_mm],
        velocity_mmps: [data.vx_mmps, data.vy_mmps, data.vz_mmps],
        radius_mm: data.radius_mm,
        mode: Mode::from_number(data.mode).ok_or(DecodeError::Body)?,
        flock: data.flock,
        protocol: ProtocolId(data.protocol),
        payload: filled(data.count, &data.bytes)?,
    };
    Ok((data.boot, data.sequence, Message::Beacon(beacon)))
}

#[inline(never)]
fn relayed(data: &STAYA_RELAYED_DATA) -> Parts {
    let said = Relayed {
        id: robot(data.robot),
        age_cs: data.age_cs,
        position_mm: [data.x_mm, data.y_mm, data.z_mm],
        radius_mm: data.radius_mm,
        mode: Mode::from_number(data.mode).ok_or(DecodeError::Body)?,
        flock: data.flock,
        protocol: ProtocolId(data.protocol),
        payload: filled(data.count, &data.bytes)?,
    };
    Ok((data.boot, data.sequence, Message::Relayed(said)))
}

#[inline(never)]
fn goal(data: &STAYA_GOAL_DATA) -> Parts {
    let goal = GridOrder::FormationGoal(Cell::new(data.target_x, data.target_y));
    let order = Grid::order(robot(data.target_system), data.version, &goal);
    Ok((data.boot, data.sequence, order.ok_or(DecodeError::Body)?))
}

#[inline(never)]
fn place(data: &STAYA_PLACE_DATA) -> Parts {
    let velocity_mmps = [data.vx_mmps, data.vy_mmps, data.vz_mmps];
    let waypoint = Waypoint {
        position: Position::from_mm([data.x_mm, data.y_mm, data.z_mm]),
        velocity_mps: Vec3::from_milli(velocity_mmps.map(i32::from)),
        at: Instant::default(),
    };
    let order = WaypointOrder { index: data.index, waypoint };
    let order = Waypoints::order(robot(data.target_system), data.version, &order);
    Ok((data.boot, data.sequence, order.ok_or(DecodeError::Body)?))
}

#[inline(never)]
fn to_law(data: &STAYA_MESSAGE_DATA) -> Parts {
    let (to, protocol) = (robot(data.target_system), ProtocolId(data.protocol));
    let addressed = || Ok(Addressed { to, number: data.number, protocol, content: filled(data.count, &data.bytes)? });
    let message = match data.kind {
        TO_ONE => Message::Law(addressed()?),
        TO_ALL => Message::Broadcast(Broadcast { protocol, content: filled(data.count, &data.bytes)? }),
        ORDER => {
            let order = addressed()?;
            if let Some(AnyOrder::Grid(GridOrder::Template { part, .. })) =
                AnyOrder::decode(protocol, protocol, &order.content)
                && part.entries.iter().any(|entry| system(entry.id).is_err())
            {
                return Err(DecodeError::Body);
            }
            Message::Order(order)
        }
        _ => return Err(DecodeError::Body),
    };
    Ok((data.boot, data.sequence, message))
}

#[expect(clippy::arithmetic_side_effects, reason = "at most as many as a part has entries")]
fn template(
    part: &TemplatePart,
    target_system: u8,
    boot: u8,
    sequence: u16,
) -> Result<STAYA_TEMPLATE_DATA, EncodeError> {
    let mut data = STAYA_TEMPLATE_DATA {
        sequence,
        offset_x: part.offset.x,
        offset_y: part.offset.y,
        boot,
        target_system,
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

// A part of the controller's template fits one message, and so does what a law says.
const _: () = assert!(MAX_PAYLOAD == STAYA_BEACON_DATA::DEFAULT.bytes.len());
const _: () = assert!(MAX_CONTENT == STAYA_MESSAGE_DATA::DEFAULT.bytes.len());
const _: () = assert!(TEMPLATE_PART == STAYA_TEMPLATE_DATA::DEFAULT.entry_id.len());

#[inline(never)]
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
    let part = TemplatePart {
        version: data.version,
        part: data.part,
        parts: data.parts,
        slot: data.slot,
        offset: Cell::new(data.offset_x, data.offset_y),
        entries,
    };
    let order = GridOrder::Template { part, is_restarted: false };
    let order = Grid::order(robot(data.target_system), data.version, &order);
    Ok((data.boot, data.sequence, order.ok_or(DecodeError::Body)?))
}

fn system(id: RobotId) -> Result<u8, EncodeError> {
    u8::try_from(id.0).map_err(|_| EncodeError::Robot(id))
}

fn robot(system: u8) -> RobotId {
    RobotId(system.into())
}

/// In thousandths, saturating.
fn milli(mps: f32) -> i16 {
    mps.to_milli().unwrap_or(0).clamp(i16::MIN.into(), i16::MAX.into()) as i16
}

#[cfg(test)]
mod tests;
