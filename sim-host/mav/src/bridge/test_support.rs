use super::model::VehicleModel;
use super::params::Parameters;
use super::streams::Streams;
use super::vehicle::{Out, Vehicle};
use crate::geo::{Global, Origin};
use staya_controller::agent::Wish;
use staya_controller::grid::{BLOCKED, Cell};
use staya_controller::parameters::Parameter;
use staya_controller::robot::{Mode, RobotId};
use staya_mavlink::dialect::*;
use staya_mavlink::frame::Sender;
use staya_sim::engine::{Observation, Status};
use staya_sim::record::Motion;
use staya_sim::scenario::parameters;
use staya_sim::terrain::Terrain;
use std::sync::Arc;

pub(super) const GCS: Sender = Sender { system: 255, component: 190, sequence: 0 };

pub(super) fn origin() -> Origin {
    let place = Global { latitude_deg: 50.0, longitude_deg: 8.0, altitude_m: 100.0 };
    Origin::new(place).expect("a place")
}

pub(super) fn model() -> VehicleModel {
    VehicleModel {
        flies: false,
        grid: None,
        in_formation: false,
        is_alone: false,
        max_speed_mps: 2.0,
        radius_m: 0.25,
        origin: origin(),
        solids: Vec::new(),
    }
}

/// Robots on a grid of 10 x 10 cells of 2 m, with a wall at (4, 4).
pub(super) fn on_grid() -> VehicleModel {
    let mut land = Terrain::flat(10, 10);
    land.cell_m = 2.0;
    land.set(Cell::new(4, 4), BLOCKED);
    VehicleModel { grid: Some(land), max_speed_mps: 0.0, radius_m: 0.0, ..model() }
}

pub(super) fn sample() -> Observation {
    Observation {
        motion: Motion { cell: Cell::new(1, 2), position_m: [3.0, 5.0, 0.0], velocity_mps: [0.0; 3] },
        status: Status { mode: Mode::Cruise, leader: RobotId::NONE, target: Cell::new(1, 2), wait: None },
        starts: 0,
        is_up: true,
        wish: Wish::Own,
        neighbors: 0,
    }
}

pub(super) fn greatest() -> Vec<(&'static Parameter, f32)> {
    parameters().into_iter().map(|row| (row, row.range[1])).collect()
}

pub(super) struct Bench {
    pub(super) vehicle: Vehicle,
    pub(super) sample: Observation,
    pub(super) time_us: u64,
}

impl Bench {
    pub(super) fn new(model: VehicleModel) -> Self {
        let mut values = greatest();
        for (row, value) in &mut values {
            match row.name {
                "speed_mps" => *value = 1.0,
                "tolerance_m" => *value = 0.05,
                _ => {}
            }
        }
        let parameters = Parameters::new(&model, &values);
        let streams = Streams::new(10.0, 0.0);
        let sample = sample();
        Self { vehicle: Vehicle::new(7, Arc::new(model), parameters, streams, (0, sample), true), sample, time_us: 0 }
    }

    pub(super) fn give(&mut self, message: MavMessage) -> &Out {
        self.vehicle.out = Out::default();
        let now_us = self.vehicle.now_us;
        self.vehicle.receive(GCS, &message, now_us);
        &self.vehicle.out
    }

    pub(super) fn command(&mut self, command: u16, params: [f32; 7]) -> u8 {
        let [param1, param2, param3, param4, param5, param6, param7] = params;
        self.give(MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
            param1,
            param2,
            param3,
            param4,
            param5,
            param6,
            param7,
            command,
            target_system: 7,
            target_component: 1,
            confirmation: 0,
        }));
        self.result()
    }

    pub(super) fn command_int(&mut self, command: COMMAND_INT_DATA) -> u8 {
        self.give(MavMessage::COMMAND_INT(COMMAND_INT_DATA { target_system: 7, target_component: 1, ..command }));
        self.result()
    }

    pub(super) fn result(&self) -> u8 {
        let acks = self.vehicle.out.messages.iter().filter_map(|message| match message {
            MavMessage::COMMAND_ACK(ack) => Some(ack.result),
            _ => None,
        });
        let acks: Vec<u8> = acks.collect();
        assert_eq!(acks.len(), 1, "each command is answered once");
        assert!(matches!(self.vehicle.out.messages[0], MavMessage::COMMAND_ACK(_)));
        acks[0]
    }

    pub(super) fn tick(&mut self, change: impl FnOnce(&mut Observation)) -> &Out {
        self.time_us += 100_000;
        change(&mut self.sample);
        self.vehicle.out = Out::default();
        self.vehicle.observe((self.time_us, self.sample), &[], self.time_us);
        &self.vehicle.out
    }

    pub(super) fn wish(&self) -> Option<Wish<f32>> {
        let mut actions = self.vehicle.out.actions.iter().rev();
        actions.find_map(|action| match action {
            super::vehicle::Action::Wish(wish) => Some(*wish),
            _ => None,
        })
    }

    pub(super) fn texts(&self) -> Vec<String> {
        let texts = self.vehicle.out.messages.iter().filter_map(|message| match message {
            MavMessage::STATUSTEXT(text) => Some(text.text.to_str().unwrap_or("?").to_owned()),
            _ => None,
        });
        texts.collect()
    }
}
