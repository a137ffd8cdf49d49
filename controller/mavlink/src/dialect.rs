//! The messages of the dialect: those of `messages/common.xml` and `messages/ardupilotmega.xml`
//! (public ones that Staya uses) and of `messages/staya.xml` (Staya's own, documented there and in
//! `controller/src/wire/message.rs`).
//!
//! A test compares this table with the XML files. Enums are numbers here: an unknown one must not
//! invalidate a message.

use mavlink_core::error::ParserError;
use mavlink_core::types::CharArray;
use mavlink_core::utils::remove_trailing_zeroes;
use mavlink_core::{MavlinkVersion, Message, MessageData};
pub(crate) use messages::CRC;
use messages::{Field, FieldInfo, encoded_len, extra_crc};

#[macro_use]
mod messages;

messages! {
    0 HEARTBEAT(HEARTBEAT_DATA) {
        custom_mode: u32, mavtype("type"): u8, autopilot: u8, base_mode: u8, system_status: u8,
        mavlink_version: u8,
    }
    1 SYS_STATUS(SYS_STATUS_DATA) {
        onboard_control_sensors_present: u32, onboard_control_sensors_enabled: u32,
        onboard_control_sensors_health: u32, load: u16, voltage_battery: u16, current_battery: i16,
        drop_rate_comm: u16, errors_comm: u16, errors_count1: u16, errors_count2: u16,
        errors_count3: u16, errors_count4: u16, battery_remaining: i8,
    } + {
        onboard_control_sensors_present_extended: u32,
        onboard_control_sensors_enabled_extended: u32, onboard_control_sensors_health_extended: u32,
    }
    2 SYSTEM_TIME(SYSTEM_TIME_DATA) {
        time_unix_usec: u64, time_boot_ms: u32,
    }
    4 PING(PING_DATA) {
        time_usec: u64, seq: u32, target_system: u8, target_component: u8,
    }
    11 SET_MODE(SET_MODE_DATA) {
        custom_mode: u32, target_system: u8, base_mode: u8,
    }
    20 PARAM_REQUEST_READ(PARAM_REQUEST_READ_DATA) {
        param_index: i16, target_system: u8, target_component: u8, param_id: CharArray<16>,
    }
    21 PARAM_REQUEST_LIST(PARAM_REQUEST_LIST_DATA) {
        target_system: u8, target_component: u8,
    }
    22 PARAM_VALUE(PARAM_VALUE_DATA) {
        param_value: f32, param_count: u16, param_index: u16, param_id: CharArray<16>,
        param_type: u8,
    }
    23 PARAM_SET(PARAM_SET_DATA) {
        param_value: f32, target_system: u8, target_component: u8, param_id: CharArray<16>,
        param_type: u8,
    }
    24 GPS_RAW_INT(GPS_RAW_INT_DATA) {
        time_usec: u64, lat: i32, lon: i32, alt: i32, eph: u16, epv: u16, vel: u16, cog: u16,
        fix_type: u8, satellites_visible: u8,
    } + {
        alt_ellipsoid: i32, h_acc: u32, v_acc: u32, vel_acc: u32, hdg_acc: u32, yaw: u16,
    }
    30 ATTITUDE(ATTITUDE_DATA) {
        time_boot_ms: u32, roll: f32, pitch: f32, yaw: f32, rollspeed: f32, pitchspeed: f32,
        yawspeed: f32,
    }
    32 LOCAL_POSITION_NED(LOCAL_POSITION_NED_DATA) {
        time_boot_ms: u32, x: f32, y: f32, z: f32, vx: f32, vy: f32, vz: f32,
    }
    33 GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA) {
        time_boot_ms: u32, lat: i32, lon: i32, alt: i32, relative_alt: i32, vx: i16, vy: i16,
        vz: i16, hdg: u16,
    }
    37 MISSION_REQUEST_PARTIAL_LIST(MISSION_REQUEST_PARTIAL_LIST_DATA) {
        start_index: i16, end_index: i16, target_system: u8, target_component: u8,
    } + {
        mission_type: u8,
    }
    38 MISSION_WRITE_PARTIAL_LIST(MISSION_WRITE_PARTIAL_LIST_DATA) {
        start_index: i16, end_index: i16, target_system: u8, target_component: u8,
    } + {
        mission_type: u8,
    }
    39 MISSION_ITEM(MISSION_ITEM_DATA) {
        param1: f32, param2: f32, param3: f32, param4: f32, x: f32, y: f32, z: f32, seq: u16,
        command: u16, target_system: u8, target_component: u8, frame: u8, current: u8,
        autocontinue: u8,
    } + {
        mission_type: u8,
    }
    40 MISSION_REQUEST(MISSION_REQUEST_DATA) {
        seq: u16, target_system: u8, target_component: u8,
    } + {
        mission_type: u8,
    }
    41 MISSION_SET_CURRENT(MISSION_SET_CURRENT_DATA) {
        seq: u16, target_system: u8, target_component: u8,
    }
    42 MISSION_CURRENT(MISSION_CURRENT_DATA) {
        seq: u16,
    } + {
        total: u16, mission_state: u8, mission_mode: u8,
    }
    43 MISSION_REQUEST_LIST(MISSION_REQUEST_LIST_DATA) {
        target_system: u8, target_component: u8,
    } + {
        mission_type: u8,
    }
    44 MISSION_COUNT(MISSION_COUNT_DATA) {
        count: u16, target_system: u8, target_component: u8,
    } + {
        mission_type: u8,
    }
    45 MISSION_CLEAR_ALL(MISSION_CLEAR_ALL_DATA) {
        target_system: u8, target_component: u8,
    } + {
        mission_type: u8,
    }
    46 MISSION_ITEM_REACHED(MISSION_ITEM_REACHED_DATA) {
        seq: u16,
    }
    47 MISSION_ACK(MISSION_ACK_DATA) {
        target_system: u8, target_component: u8, mavtype("type"): u8,
    } + {
        mission_type: u8,
    }
    48 SET_GPS_GLOBAL_ORIGIN(SET_GPS_GLOBAL_ORIGIN_DATA) {
        latitude: i32, longitude: i32, altitude: i32, target_system: u8,
    } + {
        time_usec: u64,
    }
    49 GPS_GLOBAL_ORIGIN(GPS_GLOBAL_ORIGIN_DATA) {
        latitude: i32, longitude: i32, altitude: i32,
    } + {
        time_usec: u64,
    }
    51 MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA) {
        seq: u16, target_system: u8, target_component: u8,
    } + {
        mission_type: u8,
    }
    66 REQUEST_DATA_STREAM(REQUEST_DATA_STREAM_DATA) {
        req_message_rate: u16, target_system: u8, target_component: u8, req_stream_id: u8,
        start_stop: u8,
    }
    69 MANUAL_CONTROL(MANUAL_CONTROL_DATA) {
        x: i16, y: i16, z: i16, r: i16, buttons: u16, target: u8,
    } + {
        buttons2: u16, enabled_extensions: u8, s: i16, t: i16, aux1: i16, aux2: i16, aux3: i16,
        aux4: i16, aux5: i16, aux6: i16,
    }
    70 RC_CHANNELS_OVERRIDE(RC_CHANNELS_OVERRIDE_DATA) {
        chan1_raw: u16, chan2_raw: u16, chan3_raw: u16, chan4_raw: u16, chan5_raw: u16,
        chan6_raw: u16, chan7_raw: u16, chan8_raw: u16, target_system: u8, target_component: u8,
    } + {
        chan9_raw: u16, chan10_raw: u16, chan11_raw: u16, chan12_raw: u16, chan13_raw: u16,
        chan14_raw: u16, chan15_raw: u16, chan16_raw: u16, chan17_raw: u16, chan18_raw: u16,
    }
    73 MISSION_ITEM_INT(MISSION_ITEM_INT_DATA) {
        param1: f32, param2: f32, param3: f32, param4: f32, x: i32, y: i32, z: f32, seq: u16,
        command: u16, target_system: u8, target_component: u8, frame: u8, current: u8,
        autocontinue: u8,
    } + {
        mission_type: u8,
    }
    74 VFR_HUD(VFR_HUD_DATA) {
        airspeed: f32, groundspeed: f32, alt: f32, climb: f32, heading: i16, throttle: u16,
    }
    75 COMMAND_INT(COMMAND_INT_DATA) {
        param1: f32, param2: f32, param3: f32, param4: f32, x: i32, y: i32, z: f32, command: u16,
        target_system: u8, target_component: u8, frame: u8, current: u8, autocontinue: u8,
    }
    76 COMMAND_LONG(COMMAND_LONG_DATA) {
        param1: f32, param2: f32, param3: f32, param4: f32, param5: f32, param6: f32, param7: f32,
        command: u16, target_system: u8, target_component: u8, confirmation: u8,
    }
    77 COMMAND_ACK(COMMAND_ACK_DATA) {
        command: u16, result: u8,
    } + {
        progress: u8, result_param2: i32, target_system: u8, target_component: u8,
    }
    82 SET_ATTITUDE_TARGET(SET_ATTITUDE_TARGET_DATA) {
        time_boot_ms: u32, q: [f32; 4], body_roll_rate: f32, body_pitch_rate: f32,
        body_yaw_rate: f32, thrust: f32, target_system: u8, target_component: u8, type_mask: u8,
    }
    84 SET_POSITION_TARGET_LOCAL_NED(SET_POSITION_TARGET_LOCAL_NED_DATA) {
        time_boot_ms: u32, x: f32, y: f32, z: f32, vx: f32, vy: f32, vz: f32, afx: f32, afy: f32,
        afz: f32, yaw: f32, yaw_rate: f32, type_mask: u16, target_system: u8, target_component: u8,
        coordinate_frame: u8,
    }
    85 POSITION_TARGET_LOCAL_NED(POSITION_TARGET_LOCAL_NED_DATA) {
        time_boot_ms: u32, x: f32, y: f32, z: f32, vx: f32, vy: f32, vz: f32, afx: f32, afy: f32,
        afz: f32, yaw: f32, yaw_rate: f32, type_mask: u16, coordinate_frame: u8,
    }
    86 SET_POSITION_TARGET_GLOBAL_INT(SET_POSITION_TARGET_GLOBAL_INT_DATA) {
        time_boot_ms: u32, lat_int: i32, lon_int: i32, alt: f32, vx: f32, vy: f32, vz: f32,
        afx: f32, afy: f32, afz: f32, yaw: f32, yaw_rate: f32, type_mask: u16, target_system: u8,
        target_component: u8, coordinate_frame: u8,
    }
    87 POSITION_TARGET_GLOBAL_INT(POSITION_TARGET_GLOBAL_INT_DATA) {
        time_boot_ms: u32, lat_int: i32, lon_int: i32, alt: f32, vx: f32, vy: f32, vz: f32,
        afx: f32, afy: f32, afz: f32, yaw: f32, yaw_rate: f32, type_mask: u16, coordinate_frame: u8,
    }
    110 FILE_TRANSFER_PROTOCOL(FILE_TRANSFER_PROTOCOL_DATA) {
        target_network: u8, target_system: u8, target_component: u8, payload: [u8; 251],
    }
    111 TIMESYNC(TIMESYNC_DATA) {
        tc1: i64, ts1: i64,
    }
    117 LOG_REQUEST_LIST(LOG_REQUEST_LIST_DATA) {
        start: u16, end: u16, target_system: u8, target_component: u8,
    }
    124 GPS2_RAW(GPS2_RAW_DATA) {
        time_usec: u64, lat: i32, lon: i32, alt: i32, dgps_age: u32, eph: u16, epv: u16, vel: u16,
        cog: u16, fix_type: u8, satellites_visible: u8, dgps_numch: u8,
    } + {
        yaw: u16, alt_ellipsoid: i32, h_acc: u32, v_acc: u32, vel_acc: u32, hdg_acc: u32,
    }
    139 SET_ACTUATOR_CONTROL_TARGET(SET_ACTUATOR_CONTROL_TARGET_DATA) {
        time_usec: u64, controls: [f32; 8], group_mlx: u8, target_system: u8, target_component: u8,
    }
    147 BATTERY_STATUS(BATTERY_STATUS_DATA) {
        current_consumed: i32, energy_consumed: i32, temperature: i16, voltages: [u16; 10],
        current_battery: i16, id: u8, battery_function: u8, mavtype("type"): u8,
        battery_remaining: i8,
    } + {
        time_remaining: i32, charge_state: u8, voltages_ext: [u16; 4], mode: u8, fault_bitmask: u32,
    }
    148 AUTOPILOT_VERSION(AUTOPILOT_VERSION_DATA) {
        capabilities: u64, uid: u64, flight_sw_version: u32, middleware_sw_version: u32,
        os_sw_version: u32, board_version: u32, vendor_id: u16, product_id: u16,
        flight_custom_version: [u8; 8], middleware_custom_version: [u8; 8],
        os_custom_version: [u8; 8],
    } + {
        uid2: [u8; 18],
    }
    160 FENCE_POINT(FENCE_POINT_DATA) {
        lat: f32, lng: f32, target_system: u8, target_component: u8, idx: u8, count: u8,
    }
    161 FENCE_FETCH_POINT(FENCE_FETCH_POINT_DATA) {
        target_system: u8, target_component: u8, idx: u8,
    }
    175 RALLY_POINT(RALLY_POINT_DATA) {
        lat: i32, lng: i32, alt: i16, break_alt: i16, land_dir: u16, target_system: u8,
        target_component: u8, idx: u8, count: u8, flags: u8,
    }
    176 RALLY_FETCH_POINT(RALLY_FETCH_POINT_DATA) {
        target_system: u8, target_component: u8, idx: u8,
    }
    193 EKF_STATUS_REPORT(EKF_STATUS_REPORT_DATA) {
        velocity_variance: f32, pos_horiz_variance: f32, pos_vert_variance: f32,
        compass_variance: f32, terrain_alt_variance: f32, flags: u16,
    } + {
        airspeed_variance: f32,
    }
    230 ESTIMATOR_STATUS(ESTIMATOR_STATUS_DATA) {
        time_usec: u64, vel_ratio: f32, pos_horiz_ratio: f32, pos_vert_ratio: f32, mag_ratio: f32,
        hagl_ratio: f32, tas_ratio: f32, pos_horiz_accuracy: f32, pos_vert_accuracy: f32,
        flags: u16,
    }
    242 HOME_POSITION(HOME_POSITION_DATA) {
        latitude: i32, longitude: i32, altitude: i32, x: f32, y: f32, z: f32, q: [f32; 4],
        approach_x: f32, approach_y: f32, approach_z: f32,
    } + {
        time_usec: u64,
    }
    243 SET_HOME_POSITION(SET_HOME_POSITION_DATA) {
        latitude: i32, longitude: i32, altitude: i32, x: f32, y: f32, z: f32, q: [f32; 4],
        approach_x: f32, approach_y: f32, approach_z: f32, target_system: u8,
    } + {
        time_usec: u64,
    }
    244 MESSAGE_INTERVAL(MESSAGE_INTERVAL_DATA) {
        interval_us: i32, message_id: u16,
    }
    245 EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA) {
        vtol_state: u8, landed_state: u8,
    }
    253 STATUSTEXT(STATUSTEXT_DATA) {
        severity: u8, text: CharArray<50>,
    } + {
        id: u16, chunk_seq: u8,
    }
    256 SETUP_SIGNING(SETUP_SIGNING_DATA) {
        initial_timestamp: u64, target_system: u8, target_component: u8, secret_key: [u8; 32],
    }
    385 TUNNEL(TUNNEL_DATA) {
        payload_type: u16, target_system: u8, target_component: u8, payload_length: u8,
        payload: [u8; 128],
    }
    /// Position, velocity and state of a robot, with the payload of its law. Sent once per period.
    9_500_000 STAYA_BEACON(STAYA_BEACON_DATA) {
        x_mm: i32, y_mm: i32, z_mm: i32, vx_mmps: i16, vy_mmps: i16, vz_mmps: i16, radius_mm: u16,
        sequence: u16, boot: u8, mode: u8, flock: u8, protocol: u8, count: u8, bytes: [u8; 16],
    }
    /// Message of a law to one robot (up to 12 bytes) or to all robots, or an order to a law with a
    /// protocol of users.
    9_500_002 STAYA_MESSAGE(STAYA_MESSAGE_DATA) {
        sequence: u16, boot: u8, target_system: u8, kind: u8, number: u8, protocol: u8, count: u8,
        bytes: [u8; 38],
    }
    /// Answer to a STAYA_MESSAGE to one robot.
    9_500_003 STAYA_ACK(STAYA_ACK_DATA) {
        sequence: u16, boot: u8, target_system: u8, message_boot: u8, number: u8,
    }
    /// One part of a robot's place in a formation: the place and its neighbours.
    9_500_004 STAYA_TEMPLATE(STAYA_TEMPLATE_DATA) {
        sequence: u16, offset_x: i16, offset_y: i16, entry_x: [i16; 2], entry_y: [i16; 2], boot: u8,
        target_system: u8, version: u8, part: u8, parts: u8, slot: u8, count: u8, entry_id: [u8; 2],
        entry_hops: [u8; 2],
    }
    /// A goal on the grid for a formation's leader and all its followers.
    9_500_005 STAYA_GOAL(STAYA_GOAL_DATA) {
        sequence: u16, target_x: i16, target_y: i16, boot: u8, target_system: u8, version: u8,
    }
    /// A waypoint, one of several that may move.
    9_500_006 STAYA_PLACE(STAYA_PLACE_DATA) {
        x_mm: i32, y_mm: i32, z_mm: i32, vx_mmps: i16, vy_mmps: i16, vz_mmps: i16, sequence: u16,
        boot: u8, target_system: u8, version: u8, index: u8,
    }
    /// A robot that fell silent, for robots that never heard it; sent in turn behind beacons. A
    /// ground station clears a place with is_lost 0 and age 0.
    9_500_009 STAYA_LOST(STAYA_LOST_DATA) {
        x_mm: i32, y_mm: i32, z_mm: i32, radius_mm: u16, age_cs: u16, sequence: u16, boot: u8,
        robot: u8, is_lost: u8,
    }
    /// The last beacon of a robot of a formation, relayed to those that do not hear it; sent behind
    /// beacons.
    9_500_010 STAYA_RELAYED(STAYA_RELAYED_DATA) {
        x_mm: i32, y_mm: i32, z_mm: i32, radius_mm: u16, age_cs: u16, sequence: u16, boot: u8,
        robot: u8, mode: u8, flock: u8, protocol: u8, count: u8, bytes: [u8; 16],
    }
}

#[cfg(test)]
mod tests;
