//! How often a vehicle says what of itself.

use staya_mavlink::dialect::*;
use staya_mavlink::mavlink_core::MessageData as _;

/// Shortest time between two messages of a kind, microseconds.
const SHORTEST_US: u64 = 1000;
/// One message, again and again.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stream {
    id: u32,
    /// By default; 0: not at all.
    default_us: u64,
    /// Now.
    every_us: u64,
    due_us: u64,
}

/// Messages that come by themselves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Streams(Vec<Stream>);

/// Microseconds between two messages at a rate, 0 for none.
fn every(rate_hz: f64) -> u64 {
    if rate_hz > 0.0 { (1e6 / rate_hz) as u64 } else { 0 }
}

impl Streams {
    /// The defaults: `position_hz` of each kind of position, half of that for the attitude, the rest about once a second. `phase` from 0
    /// to 1: vehicles with different ones do not all speak at once.
    #[must_use]
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

    /// Whether there is such a message.
    #[must_use]
    pub fn has(&self, id: u32) -> bool {
        self.0.iter().any(|stream| stream.id == id)
    }

    /// Calls `send` for each message that is due. One that is late is sent once.
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

    /// Time between two messages, microseconds; -1: not sent; `None` when there is no such message.
    #[must_use]
    pub fn interval_us(&self, id: u32) -> Option<i32> {
        let stream = self.0.iter().find(|stream| stream.id == id)?;
        Some(match stream.every_us {
            0 => -1,
            us => i32::try_from(us).unwrap_or(i32::MAX),
        })
    }

    /// As SET_MESSAGE_INTERVAL says it: -1 ends the stream, 0 is the default. Whether that can be.
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
        // Without its heartbeat it would be lost.
        if id == HEARTBEAT_DATA::ID && wanted != stream.default_us {
            return false;
        }
        (stream.every_us, stream.due_us) = (wanted, now_us + wanted);
        true
    }

    /// As REQUEST_DATA_STREAM says it: all messages of a group; 0 ends them.
    pub fn set_group(&mut self, group: u8, rate_hz: u16, now_us: u64) {
        let ids: &[u32] = match group {
            // All: what says how it moves and how it is, not what hardly changes.
            0 => &[
                SYS_STATUS_DATA::ID,
                GPS_RAW_INT_DATA::ID,
                ATTITUDE_DATA::ID,
                LOCAL_POSITION_NED_DATA::ID,
                GLOBAL_POSITION_INT_DATA::ID,
                VFR_HUD_DATA::ID,
            ],
            2 => &[SYS_STATUS_DATA::ID, GPS_RAW_INT_DATA::ID, MISSION_CURRENT_DATA::ID],
            6 => &[LOCAL_POSITION_NED_DATA::ID, GLOBAL_POSITION_INT_DATA::ID],
            10 => &[ATTITUDE_DATA::ID],
            11 => &[VFR_HUD_DATA::ID],
            12 => &[SYSTEM_TIME_DATA::ID, BATTERY_STATUS_DATA::ID],
            _ => &[],
        };
        let every_us = every(f64::from(rate_hz.min(1000)));
        for stream in self.0.iter_mut().filter(|stream| ids.contains(&stream.id)) {
            (stream.every_us, stream.due_us) = (every_us, now_us + every_us);
        }
    }
}
