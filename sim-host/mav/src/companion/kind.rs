use serde::Serialize;
use staya_sim::scenario::{Node, Read, Wrong, word};

/// An autopilot and its type of vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Kind {
    /// ArduPilot Rover.
    #[serde(rename = "ardupilot-rover")]
    ArduRover,
    /// ArduPilot Copter.
    #[serde(rename = "ardupilot-copter")]
    ArduCopter,
    /// PX4 on a flying vehicle.
    #[serde(rename = "px4-copter")]
    Px4Copter,
    /// PX4 on a ground vehicle.
    #[serde(rename = "px4-rover")]
    Px4Rover,
}

impl Read for Kind {
    const KIND: &'static str = "a name in quotes";

    fn read(node: &Node<'_>) -> Result<Self, Wrong> {
        let names = [
            ("ardupilot-rover", Self::ArduRover),
            ("ardupilot-copter", Self::ArduCopter),
            ("px4-copter", Self::Px4Copter),
            ("px4-rover", Self::Px4Rover),
            ("px4", Self::Px4Copter),
        ];
        word(node, &names)
    }
}

/// The third byte of the custom mode in a PX4 heartbeat.
const OFFBOARD: u32 = 6;

impl Kind {
    /// Whether the vehicle must take off before it follows velocities.
    #[must_use]
    pub const fn flies(self) -> bool {
        matches!(self, Self::ArduCopter | Self::Px4Copter)
    }

    /// Whether this is PX4, which keeps external control only while setpoints arrive, rather than
    /// ArduPilot.
    #[must_use]
    pub const fn is_px4(self) -> bool {
        matches!(self, Self::Px4Copter | Self::Px4Rover)
    }

    /// Number of the external control mode in `MAV_CMD_DO_SET_MODE`.
    #[must_use]
    pub const fn outside_control(self) -> u32 {
        match self {
            Self::ArduRover => 15,
            Self::ArduCopter => 4,
            Self::Px4Copter | Self::Px4Rover => OFFBOARD,
        }
    }

    /// Whether a custom mode is the external control mode.
    #[must_use]
    pub const fn is_outside_control(self, custom_mode: u32) -> bool {
        let mode = if self.is_px4() { (custom_mode >> 16) & 0xFF } else { custom_mode };
        mode == self.outside_control()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn external_control_modes_have_the_autopilots_numbers() {
        assert!(Kind::ArduRover.is_outside_control(15));
        assert!(!Kind::ArduRover.is_outside_control(4));
        assert!(Kind::ArduCopter.is_outside_control(4));
        assert!(Kind::Px4Copter.is_outside_control(6 << 16));
        assert!(!Kind::Px4Copter.is_outside_control(6));
        assert!(!Kind::Px4Rover.is_outside_control((4 << 16) | (3 << 24)));
    }
}
