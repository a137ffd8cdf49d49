use super::super::params::SETPOINT_TIMEOUT;
use super::{Action, Kind, Vehicle};
use staya_mavlink::constants::*;
use staya_mavlink::dialect::*;

impl Vehicle {
    pub(super) fn unknown_parameter(&mut self) {
        self.text(Kind::Parameter, MAV_SEVERITY_WARNING, "unknown parameter");
    }

    pub(super) fn set_parameter(&mut self, wanted: &PARAM_SET_DATA) {
        let Some(index) = self.parameters.find(&wanted.param_id) else {
            return self.unknown_parameter();
        };
        let set = self.parameters.set(index, wanted.param_value);
        // The present value is reported whether it changed or not.
        let told = self.parameters.message(index);
        self.out.messages.extend(told.map(MavMessage::PARAM_VALUE));
        match set {
            Ok(SETPOINT_TIMEOUT) => {}
            Ok(name) => self.out.actions.push(Action::Set(name, wanted.param_value)),
            Err([least, greatest]) => {
                let name = String::from_utf8_lossy(&*wanted.param_id);
                let text = format!("{}: give {least} to {greatest}", name.trim_end_matches('\0'));
                self.text(Kind::News, MAV_SEVERITY_WARNING, &text);
            }
        }
    }

    /// Reports the value in use after the controller refused a value that conflicts with another.
    pub(in super::super) fn set_back(&mut self, name: &'static str, value: Option<f32>) {
        let Some(index) = value.and_then(|value| self.parameters.set_back(name, value)) else { return };
        self.out.messages.extend(self.parameters.message(index).map(MavMessage::PARAM_VALUE));
        let text = format!("{name} conflicts with other parameters");
        self.text(Kind::News, MAV_SEVERITY_WARNING, &text);
    }
}
