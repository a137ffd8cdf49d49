use staya_mavlink::constants::*;
use staya_mavlink::dialect::{COMMAND_LONG_DATA, MavMessage};
use staya_mavlink::mavlink_core::Message as _;

/// `None` for heartbeats and packets to other companions.
pub fn words(message: &MavMessage) -> Option<String> {
    Some(match message {
        MavMessage::HEARTBEAT(_) | MavMessage::TUNNEL(_) => return None,
        MavMessage::COMMAND_LONG(command) => format!("COMMAND_LONG {}", command_words(command)),
        MavMessage::STATUSTEXT(text) => format!("STATUSTEXT {:?}", text.text.to_str().unwrap_or_default()),
        MavMessage::SET_POSITION_TARGET_LOCAL_NED(to) => format!(
            "SET_POSITION_TARGET_LOCAL_NED {:.2} m/s north, {:.2} m/s east, {:.2} m/s down",
            to.vx, to.vy, to.vz
        ),
        other => format!("{} {other:?}", other.message_name()),
    })
}

fn command_words(command: &COMMAND_LONG_DATA) -> String {
    match command.command {
        MAV_CMD_SET_MESSAGE_INTERVAL => {
            let id = command.param1 as u32;
            let name = MavMessage::default_message_from_id(id).map_or("?", |message| message.message_name());
            format!("SET_MESSAGE_INTERVAL {name} {:.1} Hz", 1e6 / command.param2)
        }
        MAV_CMD_DO_SET_MODE => format!("DO_SET_MODE {}", command.param2),
        MAV_CMD_COMPONENT_ARM_DISARM => String::from("COMPONENT_ARM_DISARM: arm"),
        MAV_CMD_NAV_TAKEOFF => format!("NAV_TAKEOFF to {} m", command.param7),
        other => other.to_string(),
    }
}
