use super::*;

#[test]
fn setpoints_of_each_frame_and_mask_become_goals() {
    let mut bench = guided(model());
    let valid = Duration::from_millis(3000);
    // The vehicle is at (3, 5) on the ground.
    assert_eq!(place_mm(set(&mut bench, local(0xDF8, 1))), [20_000, 10_000, 0]);
    assert_eq!(place_mm(set(&mut bench, local(0xDF8, 7))), [23_000, 15_000, 0]);
    let velocity = |x, y| Some(Wish::Velocity { velocity_mps: Vec3::new(x, y, 0.0), valid });
    assert_eq!(set(&mut bench, local(0xDC7, 1)), velocity(0.5, 1.0));
    // Mask of MAVSDK.
    assert_eq!(set(&mut bench, local(2503, 1)), velocity(0.5, 1.0));
    let both = set(&mut bench, local(0xDC0, 1));
    let Some(Wish::Waypoint { waypoint, valid: Some(until) }) = both else {
        panic!("{both:?}");
    };
    assert_eq!((waypoint.velocity_mps, until), (Vec3::new(0.5, 1.0, 0.0), valid));
    // The vehicle heads east, so right is south.
    bench.tick(|sample| sample.motion.velocity_mps = [1.0, 0.0, 0.0]);
    for frame in [8, 9] {
        let Some(Wish::Velocity { velocity_mps: v, .. }) = set(&mut bench, local(0xDC7, frame)) else {
            panic!("a velocity");
        };
        assert!((v.x - 1.0).abs() < 1e-6 && (v.y + 0.5).abs() < 1e-6, "{v:?}");
        assert_eq!(place_mm(set(&mut bench, local(0xDF8, frame))), [13_000, -15_000, 0]);
    }
}

/// Masks in public use, and whether they use a position and a velocity.
const PUBLIC_MASKS: [(u16, bool, bool, &str); 14] = [
    (0b0000_1111_1111_1000, true, false, "DroneKit-Python, guided_set_speed_yaw: position"),
    (0b0000_1111_1100_0111, false, true, "DroneKit-Python, guided_set_speed_yaw: velocity"),
    (0b0000_1111_1100_0000, true, true, "position and velocity, with the force bit"),
    (0b1101_1111_1000, true, false, "ArduPilot documentation: position"),
    (0b1101_1100_0111, false, true, "ArduPilot documentation: velocity"),
    (0b1101_1100_0000, true, true, "ArduPilot documentation: position and velocity"),
    (0b1001_1100_0111, false, true, "ArduPilot documentation: velocity and yaw"),
    (0b0101_1100_0111, false, true, "ArduPilot documentation: velocity and yaw rate"),
    (0b1001_1111_1000, true, false, "MAVSDK: position and yaw"),
    (0b1001_1100_0000, true, true, "MAVSDK: position, velocity and yaw"),
    (0b0001_1111_1000, true, false, "position, yaw and yaw rate"),
    (0b0001_1100_0111, false, true, "velocity, yaw and yaw rate"),
    (0b1101_1110_0111, false, true, "velocity without vz"),
    (0b1101_1111_1100, true, false, "position without z"),
];

#[test]
fn masks_in_public_use_are_accepted() {
    let mut bench = guided(flying());
    for (mask, has_place, has_velocity, what) in PUBLIC_MASKS {
        let wish = set(&mut bench, local(mask, 1));
        let found = match wish {
            Some(Wish::Waypoint { waypoint, .. }) => (true, waypoint.velocity_mps != Vec3::new(0.0, 0.0, 0.0)),
            Some(Wish::Velocity { .. }) => (false, true),
            _ => (false, false),
        };
        assert_eq!(found, (has_place, has_velocity), "{mask:#b} {what}: {wish:?}");
    }
    // Accelerations with the force bit and without it, nothing, half a position, half a velocity.
    for mask in [0xE38, 0xC38, 0xDFF, 0xDFA, 0xDCF] {
        bench.vehicle.now_us += 10_000_000;
        assert_eq!(set(&mut bench, local(mask, 1)), None, "{mask:#x}");
        assert_eq!(bench.texts().len(), 1, "{mask:#x}");
    }
}

#[test]
fn setpoints_in_space_have_heights() {
    let mut bench = guided(flying());
    assert_eq!(place_mm(set(&mut bench, local(0xDF8, 1))), [20_000, 10_000, 3000]);
    bench.tick(|sample| sample.motion.position_m[2] = 7.0);
    assert_eq!(place_mm(set(&mut bench, local(0xDFC, 1)))[2], 7000, "the mask excludes z");
    let Some(Wish::Velocity { velocity_mps, .. }) = set(&mut bench, local(0xDC7, 1)) else {
        panic!("a velocity");
    };
    assert_eq!(velocity_mps, Vec3::new(0.5, 1.0, 0.25));
    let place = origin().to_global([-4.0, 6.0, 0.0]).expect("near").to_e7();
    let target = SET_POSITION_TARGET_GLOBAL_INT_DATA {
        lat_int: place[0],
        lon_int: place[1],
        alt: 12.5,
        type_mask: 0xDF8,
        target_system: 7,
        target_component: 1,
        coordinate_frame: MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
        ..SET_POSITION_TARGET_GLOBAL_INT_DATA::DEFAULT
    };
    bench.give(MavMessage::SET_POSITION_TARGET_GLOBAL_INT(target));
    let [x, y, z] = place_mm(bench.wish());
    assert!((x + 4000).abs() < 10 && (y - 6000).abs() < 10 && z == 12_500, "{x} {y} {z}");
}

#[test]
fn invalid_setpoints_are_refused_with_a_text() {
    let mut bench = guided(model());
    let mut refused = |change: &dyn Fn(&mut SET_POSITION_TARGET_LOCAL_NED_DATA)| {
        let mut target = local(0xDF8, 1);
        change(&mut target);
        bench.vehicle.now_us += 10_000_000;
        assert_eq!(set(&mut bench, target), None);
        assert_eq!(bench.texts().len(), 1);
        let mut target = local(0xDF8, 1);
        change(&mut target);
        assert_eq!(set(&mut bench, target), None);
        assert!(bench.texts().is_empty());
    };
    refused(&|t| t.coordinate_frame = 3);
    refused(&|t| t.type_mask = 0xDFF);
    refused(&|t| t.type_mask = 0xC38);
    refused(&|t| t.x = NAN);
    refused(&|t| t.y = f32::INFINITY);
    refused(&|t| t.x = 1e12);
    let mut target = local(0xDF8, 1);
    (target.vx, target.afx, target.yaw) = (NAN, NAN, NAN);
    assert!(set(&mut bench, target).is_some());
    bench.vehicle.now_us += 10_000_000;
    assert_eq!(bench.command(MAV_CMD_DO_SET_MODE, two(1.0, 4.0)), MAV_RESULT_ACCEPTED);
    assert_eq!(set(&mut bench, local(0xDF8, 1)), None, "HOLD ignores setpoints");
    assert_eq!(bench.texts(), ["setpoint: arm and select GUIDED first"]);
}

#[test]
fn reposition_moves_the_vehicle_or_answers_why_not() {
    let mut bench = Bench::new(model());
    let not_now = MAV_RESULT_TEMPORARILY_REJECTED;
    assert_eq!(bench.command_int(reposition(8.0, 2.0, 0.0)), not_now, "in AUTO");
    assert_eq!(bench.command_int(reposition(8.0, 2.0, 1.0)), MAV_RESULT_ACCEPTED);
    assert_eq!(bench.vehicle.mode, FlightMode::Guided);
    let [x, y, _] = place_mm(bench.wish());
    assert!((x - 8000).abs() < 10 && (y - 2000).abs() < 10, "{x} {y}");
    assert_eq!(bench.command_int(reposition(9.0, 2.0, NAN)), MAV_RESULT_ACCEPTED);
    let mut bad = |change: &dyn Fn(&mut COMMAND_INT_DATA)| {
        let mut command = reposition(8.0, 2.0, 1.0);
        change(&mut command);
        let result = bench.command_int(command);
        assert_eq!(bench.wish(), None);
        result
    };
    let frame = MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME;
    assert_eq!(bad(&|c| c.frame = MAV_FRAME_BODY_NED), frame);
    assert_eq!(bad(&|c| c.x = i32::MAX), MAV_RESULT_DENIED);
    assert_eq!(bad(&|c| c.y = -1_700_000_000), MAV_RESULT_DENIED);
    assert_eq!(bad(&|c| c.param2 = 0.5), MAV_RESULT_DENIED);
    assert_eq!(bad(&|c| c.param1 = 99.0), MAV_RESULT_DENIED, "too fast");
    // 32-bit floats are off by a metre.
    let floats = bench.command(MAV_CMD_DO_REPOSITION, [-1.0, 1.0, 0.0, 0.0, 50.0, 8.0, 0.0]);
    assert_eq!(floats, MAV_RESULT_COMMAND_INT_ONLY);
    assert_eq!(bench.command(MAV_CMD_COMPONENT_ARM_DISARM, NONE), MAV_RESULT_ACCEPTED);
    assert_eq!(bench.command_int(reposition(8.0, 2.0, 1.0)), not_now, "not armed");
}

#[test]
fn goals_inside_a_wall_are_denied() {
    let ball = Solid::Ball { center_m: [8.0, 2.0, 0.0], radius_m: 1.0 };
    let mut bench = Bench::new(VehicleModel { solids: vec![ball], ..model() });
    assert_eq!(bench.command_int(reposition(8.5, 2.0, 1.0)), MAV_RESULT_DENIED);
    assert_eq!(bench.command_int(reposition(9.2, 2.0, 1.0)), MAV_RESULT_DENIED);
    assert_eq!(bench.command_int(reposition(9.3, 2.0, 1.0)), MAV_RESULT_ACCEPTED);
}

#[test]
fn on_a_grid_positions_become_cells_and_velocities_are_refused() {
    let mut bench = guided(on_grid());
    assert_eq!(set(&mut bench, local(0xDC7, 1)), None);
    let mut target = local(0xDF8, 1);
    (target.x, target.y) = (17.0, 5.0);
    assert_eq!(set(&mut bench, target.clone()), Some(Wish::Cell(Cell::new(2, 8))));
    for (x, y) in [(9.0, 9.0), (21.0, 1.0), (-0.1, 1.0)] {
        (target.x, target.y) = (x, y);
        assert_eq!(set(&mut bench, target.clone()), None, "{x} {y}");
        assert_eq!(bench.command_int(reposition(y.into(), x.into(), 1.0)), MAV_RESULT_DENIED);
    }
    assert_eq!(bench.command(MAV_CMD_DO_CHANGE_SPEED, two(0.0, 1.0)), MAV_RESULT_UNSUPPORTED);
    let mut bench = guided(VehicleModel { in_formation: true, ..on_grid() });
    let home = MAV_CMD_NAV_RETURN_TO_LAUNCH;
    assert_eq!(bench.command(home, NONE), MAV_RESULT_DENIED);
    assert_eq!(bench.command_int(reposition(1.0, 1.0, 1.0)), MAV_RESULT_DENIED);
    assert_eq!(set(&mut bench, local(0xDF8, 1)), None);
}
