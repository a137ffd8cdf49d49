use super::super::test_support::{Bench, GCS, model, on_grid, origin};
use super::*;
use staya_controller::geom::Vec3;
use staya_controller::grid::Cell;
use staya_controller::time::Duration;
use staya_mavlink::mavlink_core::MessageData;
use staya_sim::world::plane::Solid;

const NAN: f32 = f32::NAN;
const NONE: [f32; 7] = [0.0; 7];

fn flying() -> VehicleModel {
    VehicleModel { flies: true, ..model() }
}

fn first(first: f32) -> [f32; 7] {
    [first, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
}

fn two(first: f32, second: f32) -> [f32; 7] {
    [first, second, 0.0, 0.0, 0.0, 0.0, 0.0]
}

fn guided(model: VehicleModel) -> Bench {
    let mut bench = Bench::new(model);
    let number = FlightMode::Guided.number(bench.vehicle.model.flies);
    let result = bench.command(MAV_CMD_DO_SET_MODE, two(1.0, number as f32));
    assert_eq!((result, bench.wish()), (MAV_RESULT_ACCEPTED, Some(Wish::Hold)));
    bench
}

fn local(mask: u16, frame: u8) -> SET_POSITION_TARGET_LOCAL_NED_DATA {
    SET_POSITION_TARGET_LOCAL_NED_DATA {
        x: 10.0,
        y: 20.0,
        z: -3.0,
        vx: 1.0,
        vy: 0.5,
        vz: -0.25,
        type_mask: mask,
        target_system: 7,
        target_component: 1,
        coordinate_frame: frame,
        ..SET_POSITION_TARGET_LOCAL_NED_DATA::DEFAULT
    }
}

fn set(bench: &mut Bench, target: SET_POSITION_TARGET_LOCAL_NED_DATA) -> Option<Wish<f32>> {
    bench.give(MavMessage::SET_POSITION_TARGET_LOCAL_NED(target));
    bench.wish()
}

fn place_mm(wish: Option<Wish<f32>>) -> [i32; 3] {
    match wish {
        Some(Wish::Waypoint { waypoint, .. }) => waypoint.position.mm,
        other => panic!("{other:?}"),
    }
}

fn reposition(east: f64, north: f64, flags: f32) -> COMMAND_INT_DATA {
    let place = origin().to_global([east, north, 0.0]).expect("near");
    let [x, y, _] = place.to_e7();
    COMMAND_INT_DATA {
        param1: -1.0,
        param2: flags,
        param4: NAN,
        x,
        y,
        z: 0.0,
        command: MAV_CMD_DO_REPOSITION,
        frame: MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
        ..COMMAND_INT_DATA::DEFAULT
    }
}

fn item(seq: u16, east: f64, north: f64) -> MISSION_ITEM_INT_DATA {
    let at = reposition(east, north, 0.0);
    MISSION_ITEM_INT_DATA {
        x: at.x,
        y: at.y,
        seq,
        command: MAV_CMD_NAV_WAYPOINT,
        frame: MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
        target_system: 7,
        target_component: 1,
        autocontinue: 1,
        ..MISSION_ITEM_INT_DATA::DEFAULT
    }
}

fn load(bench: &mut Bench, items: &[MISSION_ITEM_INT_DATA]) -> u8 {
    bench.give(MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
        count: items.len() as u16,
        target_system: 7,
        target_component: 1,
        mission_type: 0,
    }));
    for item in items {
        bench.give(MavMessage::MISSION_ITEM_INT(item.clone()));
        let ended = bench.vehicle.out.messages.iter().find_map(|message| match message {
            MavMessage::MISSION_ACK(ack) => Some(ack.mavtype),
            _ => None,
        });
        if let Some(result) = ended {
            return result;
        }
    }
    panic!("no end of the transfer");
}

mod commands;
mod missions;
mod setpoints;
mod telemetry;
