use super::{Ask, Kind};
use staya_mavlink::constants::*;
use staya_mavlink::dialect::*;
use staya_mavlink::mavlink_core::MessageData as _;
use std::time::Duration;

const VELOCITY_ONLY: u16 = 0xDC7;
const VELOCITY_AND_YAW_RATE: u16 = 0x5C7;

pub fn heartbeat() -> MavMessage {
    MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        mavtype: 18,
        autopilot: 8,
        system_status: 4,
        mavlink_version: 3,
        ..HEARTBEAT_DATA::DEFAULT
    })
}

fn command(system: u8, command: u16, params: [f64; 2], height_m: f64) -> MavMessage {
    let [param1, param2] = params.map(|p| p as f32);
    MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
        param1,
        param2,
        param7: height_m as f32,
        command,
        target_system: system,
        target_component: MAV_COMP_ID_AUTOPILOT1,
        ..COMMAND_LONG_DATA::DEFAULT
    })
}

/// `None` for a takeoff of PX4, which climbs by its setpoints.
pub fn request(system: u8, kind: Kind, ask: Ask, altitude_m: f64) -> Option<MavMessage> {
    match ask {
        Ask::Mode => Some(command(system, MAV_CMD_DO_SET_MODE, [1.0, f64::from(kind.outside_control())], 0.0)),
        Ask::Arm => Some(command(system, MAV_CMD_COMPONENT_ARM_DISARM, [1.0, 0.0], 0.0)),
        Ask::Takeoff => (!kind.is_px4()).then(|| command(system, MAV_CMD_NAV_TAKEOFF, [0.0; 2], altitude_m)),
    }
}

/// Positions, and from flying vehicles the landed state at 2 Hz.
pub fn intervals(system: u8, kind: Kind, position_hz: f64) -> impl Iterator<Item = MavMessage> {
    let state = kind.flies().then_some((EXTENDED_SYS_STATE_DATA::ID, 2.0));
    [(GLOBAL_POSITION_INT_DATA::ID, position_hz), (LOCAL_POSITION_NED_DATA::ID, position_hz)]
        .into_iter()
        .chain(state)
        .map(move |(id, hz)| interval(system, id, hz))
}

pub fn health_intervals(system: u8, kind: Kind) -> impl Iterator<Item = MavMessage> {
    const HEALTH_HZ: f64 = 4.0;
    let estimator = if kind.is_px4() { ESTIMATOR_STATUS_DATA::ID } else { EKF_STATUS_REPORT_DATA::ID };
    let ids = [estimator, GPS_RAW_INT_DATA::ID, GPS2_RAW_DATA::ID, SYS_STATUS_DATA::ID];
    ids.into_iter().map(move |id| interval(system, id, HEALTH_HZ))
}

fn interval(system: u8, id: u32, hz: f64) -> MavMessage {
    command(system, MAV_CMD_SET_MESSAGE_INTERVAL, [f64::from(id), 1e6 / hz], 0.0)
}

/// Below 0.05 m/s an ArduPilot rover also gets a yaw rate of 0: it derives its heading from the
/// velocity, and a velocity of 0 would mean north.
pub fn setpoint(system: u8, kind: Kind, velocity_ned_mps: [f64; 3], now: Duration) -> MavMessage {
    const SLOW_MPS: f64 = 0.05;
    let [north, east, _] = velocity_ned_mps;
    let stands = kind == Kind::ArduRover && north * north + east * east < SLOW_MPS * SLOW_MPS;
    let (type_mask, velocity) =
        if stands { (VELOCITY_AND_YAW_RATE, [0.0; 3]) } else { (VELOCITY_ONLY, velocity_ned_mps) };
    let [vx, vy, vz] = velocity.map(|v| v as f32);
    MavMessage::SET_POSITION_TARGET_LOCAL_NED(SET_POSITION_TARGET_LOCAL_NED_DATA {
        time_boot_ms: now.as_millis() as u32,
        target_system: system,
        target_component: MAV_COMP_ID_AUTOPILOT1,
        coordinate_frame: MAV_FRAME_LOCAL_NED,
        type_mask,
        vx,
        vy,
        vz,
        ..SET_POSITION_TARGET_LOCAL_NED_DATA::DEFAULT
    })
}

/// Cut off at 50 bytes.
pub fn status_text(text: &str, is_worrying: bool) -> MavMessage {
    MavMessage::STATUSTEXT(STATUSTEXT_DATA {
        severity: if is_worrying { 4 } else { 6 },
        text: text.into(),
        ..STATUSTEXT_DATA::DEFAULT
    })
}
