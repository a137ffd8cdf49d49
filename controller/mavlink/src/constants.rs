//! Numbers of the public MAVLink messages, by their standard names; only those that Staya uses.
//!
//! They are plain integers instead of enums: an unknown value from another system must not
//! invalidate the message.

#![expect(missing_docs, reason = "the names are the standard's")]

pub const MAV_TYPE_QUADROTOR: u8 = 2;
pub const MAV_TYPE_GCS: u8 = 6;
pub const MAV_TYPE_GROUND_ROVER: u8 = 10;
pub const MAV_AUTOPILOT_ARDUPILOTMEGA: u8 = 3;
pub const MAV_COMP_ID_AUTOPILOT1: u8 = 1;

pub const MAV_MODE_FLAG_CUSTOM_MODE_ENABLED: u8 = 1;
pub const MAV_MODE_FLAG_AUTO_ENABLED: u8 = 4;
pub const MAV_MODE_FLAG_GUIDED_ENABLED: u8 = 8;
pub const MAV_MODE_FLAG_SAFETY_ARMED: u8 = 128;
pub const MAV_STATE_STANDBY: u8 = 3;
pub const MAV_STATE_ACTIVE: u8 = 4;
pub const MAV_STATE_CRITICAL: u8 = 5;

pub const MAV_LANDED_STATE_ON_GROUND: u8 = 1;
pub const MAV_LANDED_STATE_IN_AIR: u8 = 2;
pub const MAV_LANDED_STATE_TAKEOFF: u8 = 3;
pub const MAV_LANDED_STATE_LANDING: u8 = 4;

pub const MAV_SYS_STATUS_SENSOR_3D_GYRO: u32 = 1;
pub const MAV_SYS_STATUS_SENSOR_3D_ACCEL: u32 = 1 << 1;
pub const MAV_SYS_STATUS_SENSOR_3D_MAG: u32 = 1 << 2;
pub const MAV_SYS_STATUS_SENSOR_GPS: u32 = 1 << 5;
pub const MAV_SYS_STATUS_GEOFENCE: u32 = 1 << 20;
pub const MAV_SYS_STATUS_AHRS: u32 = 1 << 21;
pub const MAV_SYS_STATUS_SENSOR_XY_POSITION_CONTROL: u32 = 1 << 14;
pub const MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS: u32 = 1 << 15;
pub const MAV_SYS_STATUS_PREARM_CHECK: u32 = 1 << 28;
pub const GPS_FIX_TYPE_3D_FIX: u8 = 3;

pub const ESTIMATOR_ATTITUDE: u16 = 1;
pub const ESTIMATOR_VELOCITY_HORIZ: u16 = 1 << 1;
pub const ESTIMATOR_VELOCITY_VERT: u16 = 1 << 2;
pub const ESTIMATOR_POS_HORIZ_REL: u16 = 1 << 3;
pub const ESTIMATOR_POS_HORIZ_ABS: u16 = 1 << 4;
pub const ESTIMATOR_POS_VERT_ABS: u16 = 1 << 5;
pub const ESTIMATOR_CONST_POS_MODE: u16 = 1 << 7;
pub const ESTIMATOR_PRED_POS_HORIZ_REL: u16 = 1 << 8;
pub const ESTIMATOR_PRED_POS_HORIZ_ABS: u16 = 1 << 9;
pub const ESTIMATOR_GPS_GLITCH: u16 = 1 << 10;
pub const ESTIMATOR_ACCEL_ERROR: u16 = 1 << 11;
pub const EKF_UNINITIALIZED: u16 = 1 << 10;
pub const EKF_GPS_GLITCHING: u16 = 1 << 15;

pub const MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT: u64 = 1 << 1;
pub const MAV_PROTOCOL_CAPABILITY_MISSION_INT: u64 = 1 << 2;
pub const MAV_PROTOCOL_CAPABILITY_COMMAND_INT: u64 = 1 << 3;
pub const MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED: u64 = 1 << 7;
pub const MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_GLOBAL_INT: u64 = 1 << 8;
pub const MAV_PROTOCOL_CAPABILITY_MAVLINK2: u64 = 1 << 13;
pub const MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST: u64 = 1 << 17;

pub const MAV_FRAME_GLOBAL: u8 = 0;
pub const MAV_FRAME_LOCAL_NED: u8 = 1;
pub const MAV_FRAME_GLOBAL_RELATIVE_ALT: u8 = 3;
pub const MAV_FRAME_GLOBAL_INT: u8 = 5;
pub const MAV_FRAME_GLOBAL_RELATIVE_ALT_INT: u8 = 6;
pub const MAV_FRAME_LOCAL_OFFSET_NED: u8 = 7;
pub const MAV_FRAME_BODY_NED: u8 = 8;
pub const MAV_FRAME_BODY_OFFSET_NED: u8 = 9;

pub const MAV_RESULT_ACCEPTED: u8 = 0;
pub const MAV_RESULT_TEMPORARILY_REJECTED: u8 = 1;
pub const MAV_RESULT_DENIED: u8 = 2;
pub const MAV_RESULT_UNSUPPORTED: u8 = 3;
pub const MAV_RESULT_COMMAND_INT_ONLY: u8 = 8;
pub const MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME: u8 = 9;

pub const MAV_CMD_NAV_WAYPOINT: u16 = 16;
pub const MAV_CMD_NAV_LOITER_UNLIM: u16 = 17;
pub const MAV_CMD_NAV_RETURN_TO_LAUNCH: u16 = 20;
pub const MAV_CMD_NAV_LAND: u16 = 21;
pub const MAV_CMD_NAV_TAKEOFF: u16 = 22;
pub const MAV_CMD_DO_SET_MODE: u16 = 176;
pub const MAV_CMD_DO_CHANGE_SPEED: u16 = 178;
pub const MAV_CMD_DO_REPOSITION: u16 = 192;
pub const MAV_CMD_DO_SET_MISSION_CURRENT: u16 = 224;
pub const MAV_CMD_MISSION_START: u16 = 300;
pub const MAV_CMD_COMPONENT_ARM_DISARM: u16 = 400;
pub const MAV_CMD_GET_HOME_POSITION: u16 = 410;
pub const MAV_CMD_GET_MESSAGE_INTERVAL: u16 = 510;
pub const MAV_CMD_SET_MESSAGE_INTERVAL: u16 = 511;
pub const MAV_CMD_REQUEST_MESSAGE: u16 = 512;
pub const MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: u16 = 520;
/// In parameter 2 of [`MAV_CMD_COMPONENT_ARM_DISARM`]: forces the change despite any objections.
pub const ARM_DISARM_FORCE: f32 = 21196.0;
pub const MAV_DO_REPOSITION_FLAGS_CHANGE_MODE: u32 = 1;

pub const POSITION_TARGET_TYPEMASK_Z_IGNORE: u16 = 1 << 2;
pub const POSITION_TARGET_TYPEMASK_VZ_IGNORE: u16 = 1 << 5;

pub const MAV_PARAM_TYPE_REAL32: u8 = 9;

pub const MAV_MISSION_ACCEPTED: u8 = 0;
pub const MAV_MISSION_ERROR: u8 = 1;
pub const MAV_MISSION_UNSUPPORTED_FRAME: u8 = 2;
pub const MAV_MISSION_UNSUPPORTED: u8 = 3;
pub const MAV_MISSION_NO_SPACE: u8 = 4;
pub const MAV_MISSION_INVALID_PARAM1: u8 = 6;
pub const MAV_MISSION_INVALID_PARAM5_X: u8 = 10;
pub const MAV_MISSION_INVALID_PARAM7: u8 = 12;
pub const MAV_MISSION_INVALID_SEQUENCE: u8 = 13;
pub const MAV_MISSION_DENIED: u8 = 14;
pub const MAV_MISSION_OPERATION_CANCELLED: u8 = 15;
pub const MAV_MISSION_TYPE_MISSION: u8 = 0;
pub const MAV_MISSION_TYPE_FENCE: u8 = 1;
pub const MAV_MISSION_TYPE_RALLY: u8 = 2;
pub const MAV_MISSION_TYPE_ALL: u8 = 255;

pub const MAV_SEVERITY_ERROR: u8 = 3;
pub const MAV_SEVERITY_WARNING: u8 = 4;
pub const MAV_SEVERITY_NOTICE: u8 = 5;
pub const MAV_SEVERITY_INFO: u8 = 6;
