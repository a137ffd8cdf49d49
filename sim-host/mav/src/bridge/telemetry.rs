use super::model::FlightMode;
use super::vehicle::Vehicle;
use crate::geo::ned;
use staya_controller::robot::Mode;
use staya_mavlink::constants::*;
use staya_mavlink::dialect::*;
use staya_mavlink::mavlink_core::MessageData as _;

const UNKNOWN: u16 = u16::MAX;
/// A robot's own state is exact, as that of an estimator which has all measurements.
const ESTIMATED: u16 = ESTIMATOR_ATTITUDE
    | ESTIMATOR_VELOCITY_HORIZ
    | ESTIMATOR_VELOCITY_VERT
    | ESTIMATOR_POS_HORIZ_REL
    | ESTIMATOR_POS_HORIZ_ABS
    | ESTIMATOR_POS_VERT_ABS
    | ESTIMATOR_PRED_POS_HORIZ_REL
    | ESTIMATOR_PRED_POS_HORIZ_ABS;

impl Vehicle {
    pub(super) fn telemetry(&self, id: u32) -> Option<MavMessage> {
        let motion = &self.seen.motion;
        let time_boot_ms = (self.uptime_us() / 1000) as u32;
        let [x, y, z] = ned(motion.position_m).map(|m| m as f32);
        let velocity = ned(motion.velocity_mps);
        let [vx, vy, vz] = velocity.map(|v| v as f32);
        let speed_mps = libm::hypot(velocity[0], velocity[1]);
        let cm = |v: f64| libm::round(v * 100.0) as i16;
        // Units of 0.01 degrees.
        let heading = libm::round(f64::from(self.yaw).to_degrees() * 100.0) as i32;
        let heading = heading.rem_euclid(36_000) as u16;
        let place = |at_m: [f64; 3]| {
            let global = self.model.origin.to_global(at_m);
            global.map(|global| global.to_e7())
        };
        let here = || place(motion.position_m);
        Some(match id {
            HEARTBEAT_DATA::ID => self.heartbeat(),
            SYS_STATUS_DATA::ID => self.sys_status(),
            SYSTEM_TIME_DATA::ID => MavMessage::SYSTEM_TIME(SYSTEM_TIME_DATA {
                // The simulation has no time of day.
                time_unix_usec: 0,
                time_boot_ms,
            }),
            GPS_RAW_INT_DATA::ID => {
                let [lat, lon, alt] = here()?;
                MavMessage::GPS_RAW_INT(GPS_RAW_INT_DATA {
                    time_usec: self.uptime_us(),
                    lat,
                    lon,
                    alt,
                    eph: UNKNOWN,
                    epv: UNKNOWN,
                    vel: cm(speed_mps) as u16,
                    cog: heading,
                    fix_type: GPS_FIX_TYPE_3D_FIX,
                    satellites_visible: u8::MAX,
                    ..GPS_RAW_INT_DATA::DEFAULT
                })
            }
            ATTITUDE_DATA::ID => {
                MavMessage::ATTITUDE(ATTITUDE_DATA { time_boot_ms, yaw: self.yaw, ..ATTITUDE_DATA::DEFAULT })
            }
            LOCAL_POSITION_NED_DATA::ID => {
                MavMessage::LOCAL_POSITION_NED(LOCAL_POSITION_NED_DATA { time_boot_ms, x, y, z, vx, vy, vz })
            }
            GLOBAL_POSITION_INT_DATA::ID => {
                let [lat, lon, alt] = here()?;
                let [vx, vy, vz] = velocity.map(cm);
                let above_home_m = motion.position_m[2] - self.home_m[2];
                MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
                    time_boot_ms,
                    lat,
                    lon,
                    alt,
                    relative_alt: libm::round(above_home_m * 1000.0) as i32,
                    vx,
                    vy,
                    vz,
                    hdg: heading,
                })
            }
            MISSION_CURRENT_DATA::ID => MavMessage::MISSION_CURRENT(MISSION_CURRENT_DATA {
                seq: self.mission.current,
                total: self.mission.len().saturating_sub(1),
                // MISSION_STATE: 1 none, 2 not started, 3 active, 5 complete.
                mission_state: match self.mode {
                    _ if self.mission.is_empty() => 1,
                    FlightMode::Mission { .. } | FlightMode::Land { is_item: true } => 3,
                    _ if self.mission.is_complete => 5,
                    _ => 2,
                },
                mission_mode: if let FlightMode::Mission { .. } = self.mode { 1 } else { 2 },
            }),
            GPS_GLOBAL_ORIGIN_DATA::ID => {
                let [latitude, longitude, altitude] = place([0.0; 3])?;
                MavMessage::GPS_GLOBAL_ORIGIN(GPS_GLOBAL_ORIGIN_DATA {
                    latitude,
                    longitude,
                    altitude,
                    time_usec: self.uptime_us(),
                })
            }
            VFR_HUD_DATA::ID => MavMessage::VFR_HUD(VFR_HUD_DATA {
                airspeed: speed_mps as f32,
                groundspeed: speed_mps as f32,
                alt: (self.model.origin.place().altitude_m + motion.position_m[2]) as f32,
                climb: -vz,
                heading: (heading / 100) as i16,
                throttle: 0,
            }),
            BATTERY_STATUS_DATA::ID => MavMessage::BATTERY_STATUS(BATTERY_STATUS_DATA {
                current_consumed: -1,
                energy_consumed: -1,
                temperature: i16::MAX,
                voltages: [UNKNOWN; 10],
                current_battery: -1,
                battery_remaining: -1,
                ..BATTERY_STATUS_DATA::DEFAULT
            }),
            EKF_STATUS_REPORT_DATA::ID => MavMessage::EKF_STATUS_REPORT(EKF_STATUS_REPORT_DATA {
                flags: ESTIMATED,
                ..EKF_STATUS_REPORT_DATA::DEFAULT
            }),
            AUTOPILOT_VERSION_DATA::ID => MavMessage::AUTOPILOT_VERSION(self.version()),
            HOME_POSITION_DATA::ID => {
                let [latitude, longitude, altitude] = place(self.home_m)?;
                let [x, y, z] = ned(self.home_m).map(|m| m as f32);
                MavMessage::HOME_POSITION(HOME_POSITION_DATA {
                    latitude,
                    longitude,
                    altitude,
                    x,
                    y,
                    z,
                    q: [1.0, 0.0, 0.0, 0.0],
                    time_usec: self.uptime_us(),
                    ..HOME_POSITION_DATA::DEFAULT
                })
            }
            EXTENDED_SYS_STATE_DATA::ID => {
                let landed_state = match (self.is_in_air(), self.mode) {
                    (false, _) => MAV_LANDED_STATE_ON_GROUND,
                    (true, FlightMode::Land { .. }) => MAV_LANDED_STATE_LANDING,
                    (true, _) => MAV_LANDED_STATE_IN_AIR,
                };
                MavMessage::EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA {
                    landed_state,
                    ..EXTENDED_SYS_STATE_DATA::DEFAULT
                })
            }
            _ => return None,
        })
    }

    /// Item 0 of the mission list.
    pub(super) fn home_item(&self) -> MISSION_ITEM_INT_DATA {
        let home = self.model.origin.to_global(self.home_m).map(|home| (home.to_e7(), home.altitude_m));
        let ([x, y, _], altitude_m) = home.unwrap_or_default();
        MISSION_ITEM_INT_DATA {
            x,
            y,
            z: altitude_m as f32,
            command: MAV_CMD_NAV_WAYPOINT,
            frame: MAV_FRAME_GLOBAL,
            autocontinue: 1,
            ..MISSION_ITEM_INT_DATA::DEFAULT
        }
    }

    fn heartbeat(&self) -> MavMessage {
        let flies = self.model.flies;
        let armed = if self.is_armed { MAV_MODE_FLAG_SAFETY_ARMED } else { 0 };
        let source = match self.mode {
            FlightMode::Auto | FlightMode::Mission { .. } => MAV_MODE_FLAG_AUTO_ENABLED | MAV_MODE_FLAG_GUIDED_ENABLED,
            FlightMode::Guided => MAV_MODE_FLAG_GUIDED_ENABLED,
            _ => 0,
        };
        MavMessage::HEARTBEAT(HEARTBEAT_DATA {
            custom_mode: self.mode.number(flies),
            mavtype: if flies { MAV_TYPE_QUADROTOR } else { MAV_TYPE_GROUND_ROVER },
            autopilot: MAV_AUTOPILOT_ARDUPILOTMEGA,
            base_mode: MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | armed | source,
            system_status: match (self.is_armed, self.seen.status.mode) {
                (false, _) => MAV_STATE_STANDBY,
                (true, Mode::Fault) => MAV_STATE_CRITICAL,
                (true, _) => MAV_STATE_ACTIVE,
            },
            mavlink_version: 3,
        })
    }

    fn sys_status(&self) -> MavMessage {
        let present = MAV_SYS_STATUS_SENSOR_3D_GYRO
            | MAV_SYS_STATUS_SENSOR_3D_ACCEL
            | MAV_SYS_STATUS_SENSOR_3D_MAG
            | MAV_SYS_STATUS_SENSOR_GPS
            | MAV_SYS_STATUS_AHRS
            | MAV_SYS_STATUS_SENSOR_XY_POSITION_CONTROL
            | MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS
            | MAV_SYS_STATUS_PREARM_CHECK;
        let has_fault = self.seen.status.mode == Mode::Fault;
        let unsound = if has_fault { MAV_SYS_STATUS_SENSOR_XY_POSITION_CONTROL } else { 0 };
        MavMessage::SYS_STATUS(SYS_STATUS_DATA {
            onboard_control_sensors_present: present,
            onboard_control_sensors_enabled: present,
            // MAVProxy reads an unset bit as a fence breach. There is no fence.
            onboard_control_sensors_health: (present & !unsound) | MAV_SYS_STATUS_GEOFENCE,
            voltage_battery: UNKNOWN,
            current_battery: -1,
            battery_remaining: -1,
            ..SYS_STATUS_DATA::DEFAULT
        })
    }

    fn version(&self) -> AUTOPILOT_VERSION_DATA {
        let number = |text: &str| text.parse::<u32>().unwrap_or(0) & 0xFF;
        let [major, minor, patch] =
            [env!("CARGO_PKG_VERSION_MAJOR"), env!("CARGO_PKG_VERSION_MINOR"), env!("CARGO_PKG_VERSION_PATCH")]
                .map(number);
        AUTOPILOT_VERSION_DATA {
            capabilities: MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT
                | MAV_PROTOCOL_CAPABILITY_MISSION_INT
                | MAV_PROTOCOL_CAPABILITY_COMMAND_INT
                | MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED
                | MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_GLOBAL_INT
                | MAV_PROTOCOL_CAPABILITY_MAVLINK2
                | MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST,
            uid: self.sender.system.into(),
            flight_sw_version: major << 24 | minor << 16 | patch << 8,
            ..AUTOPILOT_VERSION_DATA::DEFAULT
        }
    }
}
