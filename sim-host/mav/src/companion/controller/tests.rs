use super::*;
use staya_controller::wire::Postcard;
use staya_sim::scenario::Overrides;
use std::path::Path;

const TICK: Duration = Duration::from_millis(100);

fn controllers(count: usize) -> Vec<Controller<Postcard>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../companions/crossing.toml");
    let mut scenario = Scenario::load(&path, &Overrides::default()).unwrap();
    scenario.plausibility.max_radius_m += 10.0;
    let plane = scenario.plane.as_ref().unwrap();
    let ground = Arc::new(PlaneGround::new(&scenario, plane));
    let controller = |index| Controller::new(&scenario, &ground, index, 1, [0.5, 10.0], Postcard);
    (0..count).map(controller).collect()
}

fn at(x: f64, y: f64) -> Body {
    Body { position_m: [x, y, 7.0], ..Body::default() }
}

#[test]
fn the_controller_heads_for_its_goal_and_sends_beacons() {
    let mut controller = controllers(1).remove(0);
    let mut body = at(0.0, 0.0);
    for step in 0..50 {
        let out = controller.step(&body, true, &[], TICK * step);
        assert!(!out.outbox.is_empty());
        body.velocity_mps = controller.velocity_mps();
        for axis in 0..3 {
            body.position_m[axis] += body.velocity_mps[axis] * 0.1;
        }
    }
    let [x, y, z] = controller.velocity_mps();
    assert!((x - 2.0).abs() < 1e-3 && y.abs() < 1e-3 && z == 0.0, "{x} {y} {z}");
    assert_eq!(controller.mode(), Mode::Cruise);
}

#[test]
fn an_uncontrolled_vehicle_is_passive_and_gets_no_command() {
    let mut controller = controllers(1).remove(0);
    let _ = controller.step(&at(0.0, 0.0), true, &[], Duration::ZERO);
    let out = controller.step(&at(1.0, 0.0), false, &[], TICK);
    assert!(!out.outbox.is_empty(), "beacons continue");
    assert_eq!(controller.mode(), Mode::Passive);
    assert_eq!(controller.velocity_mps(), [0.0; 3]);
}

#[test]
fn a_lagging_vehicle_does_not_overshoot_its_tolerance() {
    let mut controller = controllers(1).remove(0);
    let mut body = at(30.0, 0.0);
    let mut farthest = 0.0_f64;
    for step in 0..400 {
        let _ = controller.step(&body, true, &[], TICK * step);
        let wish = controller.velocity_mps();
        for _ in 0..10 {
            for (axis, wish) in wish.into_iter().enumerate() {
                let change = (wish - body.velocity_mps[axis]) / 0.5;
                body.velocity_mps[axis] += change.clamp(-1.0, 1.0) * 0.01;
                body.position_m[axis] += body.velocity_mps[axis] * 0.01;
            }
        }
        farthest = farthest.max(body.position_m[0]);
    }
    assert_eq!(controller.mode(), Mode::Arrived);
    assert!(farthest < 51.0, "{farthest}");
    assert!((body.position_m[0] - 50.0).abs() < 1.0);
}

/// Smallest distance to an uncontrolled vehicle that stands beside the path.
fn least_distance(error_m: f64) -> f64 {
    let mut controllers = controllers(2);
    let mut second = controllers.remove(1);
    let mut first = controllers.remove(0);
    let (stands, mut moves) = (Body { error_m, ..at(25.0, 0.1) }, at(10.0, 0.0));
    let mut least = f64::INFINITY;
    for step in 0..400 {
        let said = first.step(&stands, false, &[], TICK * step).outbox.clone();
        let _ = second.step(&moves, true, &said, TICK * step);
        moves.velocity_mps = second.velocity_mps();
        for axis in 0..3 {
            moves.position_m[axis] += moves.velocity_mps[axis] * 0.1;
        }
        let off = [0, 1].map(|axis| moves.position_m[axis] - stands.position_m[axis]);
        least = least.min(off.iter().map(|x| x * x).sum::<f64>().sqrt());
    }
    assert_eq!(second.mode(), Mode::Arrived);
    least
}

#[test]
fn a_passive_vehicle_is_evaded_by_the_other_alone() {
    let least = least_distance(0.0);
    assert!((2.0..4.0).contains(&least), "{least}");
}

#[test]
fn a_vehicle_with_a_position_error_gets_more_distance() {
    for error_m in [1.0, 4.0] {
        let least = least_distance(error_m);
        assert!(least >= 2.0 + error_m, "{least} m with an error of {error_m} m");
    }
}

#[test]
fn braking_speed_grows_with_distance_and_has_a_minimum_near_the_goal() {
    let brake = Brake { place_m: [0.0; 3], tolerance_m: 1.0 };
    let speed = |distance| speed_before(&brake, [distance, 0.0, 0.0], 1.0, 0.5);
    assert_eq!(speed(0.0), 1.0);
    assert!(speed(100.0) > speed(10.0) && speed(10.0) > speed(2.0));
    let v = speed(10.0);
    assert!((v * v + v * 0.5 - 10.0).abs() < 1e-9, "{v}");
    assert_eq!(speed_before(&brake, [5.0, 0.0, 0.0], 1.0, 0.0), f64::INFINITY);
}

#[test]
fn a_silent_vehicle_gets_the_distance_that_it_needs_to_stop() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../companions/crossing.toml");
    let scenario = Scenario::load(&path, &Overrides::default()).unwrap();
    let max_m = |safety| match safety {
        SafetySetup::Orca { inflation, .. } => inflation.max_m,
        other => panic!("{other:?}"),
    };
    let usual = scenario.safety(0);
    assert_eq!(max_m(usual), 1.0, "a radius, as for robots that stop at once");
    assert_eq!(max_m(with_room(usual, 10.0)), 10.0);
    assert_eq!(max_m(with_room(with_room(usual, 12.0), 10.0)), 12.0, "the larger margin of the scenario is kept");
}
