//! The parameters that a running robot may have.

use super::law::{LawSetup, laws};
use staya_controller::agent::{AgentConfig, AnySafety, LayerSettings, Safety as _};
use staya_controller::negotiation::Moves;
use staya_controller::parameters::{Parameter, Parameters};
use staya_controller::robot::RobotId;
use staya_controller::time::Duration;

/// The parameters of all laws and safety layers, each name once.
#[must_use]
pub fn parameters() -> Vec<&'static Parameter> {
    let mut all: Vec<&'static Parameter> = Vec::new();
    let mut add = |table: &mut dyn Parameters| {
        for row in table.table() {
            if all.iter().all(|known| known.name != row.name) {
                all.push(row);
            }
        }
    };
    add(&mut AgentConfig::<f32>::new(RobotId(1), 1.0, Duration::from_millis(100)));
    for (name, _) in laws() {
        // On the grid and in the plane.
        for cruise_mps in [None, Some(1.0)] {
            if let Some(law) = LawSetup::by_name(name, Moves::EIGHT, cruise_mps) {
                law.running(&mut add);
            }
        }
    }
    for (name, _) in LayerSettings::ALL {
        if let Some(layer) = LayerSettings::by_name(name) {
            let mut layer: AnySafety<f32, 1> = layer.layer();
            layer.parameters(&mut add);
        }
    }
    all
}
