use staya_mavlink::dialect::*;
use staya_mavlink::mavlink_core::MessageData as _;

const SHORTEST_US: u64 = 1000;
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stream {
    id: u32,
    default_us: u64,
    every_us: u64,
    due_us: u64,
}

/// The telemetry streams of one vehicle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Streams(Vec<Stream>);

fn every(rate_hz: f64) -> u64 {
    if rate_hz > 0.0 { (1e6 / rate_hz) as u64 } else { 0 }
}

impl Streams {
    /// Creates the default streams: each position message at `position_hz`, attitude at half of
    /// that, the others at about 1 Hz. `phase` (0 to 1) shifts the first messages.
    pub fn new(position_hz: f64, phase: f64) -> Self {
        let second = every(1.0);
        let rates = [
            (HEARTBEAT_DATA::ID, second),
            (SYS_STATUS_DATA::ID, second),
            (SYSTEM_TIME_DATA::ID, 4 * second),
            (GPS_RAW_INT_DATA::ID, second),
            (ATTITUDE_DATA::ID, every(position_hz / 2.0)),
            (LOCAL_POSITION_NED_DATA::ID, every(position_hz)),
            (GLOBAL_POSITION_INT_DATA::ID, every(position_hz)),
            (MISSION_CURRENT_DATA::ID, second),
            (EKF_STATUS_REPORT_DATA::ID, second),
            (GPS_GLOBAL_ORIGIN_DATA::ID, 0),
            (VFR_HUD_DATA::ID, every(position_hz / 5.0)),
            (BATTERY_STATUS_DATA::ID, 2 * second),
            (AUTOPILOT_VERSION_DATA::ID, 0),
            (HOME_POSITION_DATA::ID, 2 * second),
            (EXTENDED_SYS_STATE_DATA::ID, second),
        ];
        let streams = rates.map(|(id, every_us)| Stream {
            id,
            default_us: every_us,
            every_us,
            due_us: (every_us as f64 * phase) as u64,
        });
        Self(streams.into())
    }

    /// Whether the vehicle can send message `id`.
    pub fn has(&self, id: u32) -> bool {
        self.0.iter().any(|stream| stream.id == id)
    }

    /// Calls `send` for each message that is due. An overdue message is sent once.
    pub fn each_due(&mut self, now_us: u64, mut send: impl FnMut(u32)) {
        for stream in &mut self.0 {
            if stream.every_us == 0 || now_us < stream.due_us {
                continue;
            }
            send(stream.id);
            let next = stream.due_us + stream.every_us;
            stream.due_us = if next > now_us { next } else { now_us + stream.every_us };
        }
    }

    /// Interval of a message, microseconds; -1 if it is off, `None` if the vehicle cannot send it.
    pub fn interval_us(&self, id: u32) -> Option<i32> {
        let stream = self.0.iter().find(|stream| stream.id == id)?;
        Some(match stream.every_us {
            0 => -1,
            us => i32::try_from(us).unwrap_or(i32::MAX),
        })
    }

    /// Applies SET_MESSAGE_INTERVAL: -1 for off, 0 for the default. Returns whether it is possible.
    pub fn set_interval(&mut self, id: u32, interval_us: f32, now_us: u64) -> bool {
        let Some(stream) = self.0.iter_mut().find(|stream| stream.id == id) else {
            return false;
        };
        let wanted = if interval_us == -1.0 {
            0
        } else if interval_us == 0.0 {
            stream.default_us
        } else if interval_us >= SHORTEST_US as f32 {
            interval_us as u64
        } else {
            return false;
        };
        // A client would take a vehicle without heartbeats for lost.
        if id == HEARTBEAT_DATA::ID && wanted != stream.default_us {
            return false;
        }
        (stream.every_us, stream.due_us) = (wanted, now_us + wanted);
        true
    }

    /// Applies REQUEST_DATA_STREAM to all messages of a group; 0 turns them off. Returns whether
    /// the group has messages.
    pub fn set_group(&mut self, group: u8, rate_hz: u16, now_us: u64) -> bool {
        let ids: &[u32] = match group {
            // Group 0 is "all": motion and status, but not messages that rarely change.
            0 => &[
                SYS_STATUS_DATA::ID,
                GPS_RAW_INT_DATA::ID,
                ATTITUDE_DATA::ID,
                LOCAL_POSITION_NED_DATA::ID,
                GLOBAL_POSITION_INT_DATA::ID,
                VFR_HUD_DATA::ID,
                EKF_STATUS_REPORT_DATA::ID,
            ],
            2 => &[SYS_STATUS_DATA::ID, GPS_RAW_INT_DATA::ID, MISSION_CURRENT_DATA::ID],
            6 => &[LOCAL_POSITION_NED_DATA::ID, GLOBAL_POSITION_INT_DATA::ID],
            10 => &[ATTITUDE_DATA::ID],
            11 => &[VFR_HUD_DATA::ID],
            12 => &[SYSTEM_TIME_DATA::ID, BATTERY_STATUS_DATA::ID, EKF_STATUS_REPORT_DATA::ID],
            _ => &[],
        };
        let every_us = every(f64::from(rate_hz.min(1000)));
        for stream in self.0.iter_mut().filter(|stream| ids.contains(&stream.id)) {
            (stream.every_us, stream.due_us) = (every_us, now_us + every_us);
        }
        !ids.is_empty()
    }
}
