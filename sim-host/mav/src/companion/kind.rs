//! What differs from autopilot to autopilot.

use serde::{Deserialize, Serialize};

/// An autopilot and what it drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
pub enum Kind {
    /// ArduPilot Rover.
    #[serde(rename = "ardupilot-rover")]
    ArduRover,
    /// ArduPilot Copter.
    #[serde(rename = "ardupilot-copter")]
    ArduCopter,
    /// PX4 on something that flies.
    #[serde(rename = "px4-copter", alias = "px4")]
    Px4Copter,
    /// PX4 on something that drives.
    #[serde(rename = "px4-rover")]
    Px4Rover,
}

/// PX4's main mode OFFBOARD, as it stands in the third byte of a heartbeat's custom mode.
const OFFBOARD: u32 = 6;

impl Kind {
    /// Whether it has to take off before it takes velocities.
    #[must_use]
    pub const fn flies(self) -> bool {
        matches!(self, Self::ArduCopter | Self::Px4Copter)
    }

    /// Whether the mode for outside control is refused, and left again, without a stream of setpoints.
    #[must_use]
    pub const fn needs_stream(self) -> bool {
        self.is_px4()
    }

    /// Whether it is PX4 and not ArduPilot.
    #[must_use]
    pub const fn is_px4(self) -> bool {
        matches!(self, Self::Px4Copter | Self::Px4Rover)
    }

    /// The mode for outside control, as `MAV_CMD_DO_SET_MODE` asks for it.
    #[must_use]
    pub const fn outside_control(self) -> u32 {
        match self {
            Self::ArduRover => 15,
            Self::ArduCopter => 4,
            Self::Px4Copter | Self::Px4Rover => OFFBOARD,
        }
    }

    /// Whether a heartbeat's custom mode is that mode.
    #[must_use]
    pub const fn is_outside_control(self, custom_mode: u32) -> bool {
        let mode = if self.needs_stream() { (custom_mode >> 16) & 0xFF } else { custom_mode };
        mode == self.outside_control()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_are_those_of_the_autopilots() {
        assert!(Kind::ArduRover.is_outside_control(15));
        assert!(!Kind::ArduRover.is_outside_control(4));
        assert!(Kind::ArduCopter.is_outside_control(4));
        assert!(Kind::Px4Copter.is_outside_control(6 << 16));
        assert!(!Kind::Px4Copter.is_outside_control(6));
        // AUTO.LOITER.
        assert!(!Kind::Px4Rover.is_outside_control((4 << 16) | (3 << 24)));
    }
}
