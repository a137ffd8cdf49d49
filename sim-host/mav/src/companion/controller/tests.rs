use super::*;
use staya_controller::robot::Mode;
use staya_controller::wire::Postcard;
use staya_sim::scenario::Overrides;
use std::path::Path;

const TICK: Duration = Duration::from_millis(100);

/// With the lag that the configuration gives by default.
fn controllers(count: usize) -> Vec<Controller<Postcard>> {
    lagging(count, 0.5)
}

fn lagging(count: usize, lag_s: f64) -> Vec<Controller<Postcard>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../companions/crossing.toml");
    let mut scenario = Scenario::load(&path, &Overrides::default()).unwrap();
    scenario.trust.plausibility.max_radius_m += 10.0;
    scenario.plane_mut().unwrap().general.raise_lag(lag_s);
    let plane = scenario.plane().unwrap();
    let ground = Arc::new(PlaneGround::new(&scenario, plane));
    let controller = |index| Controller::new(&scenario, &ground, index, 1, 10.0, Postcard);
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
    assert_eq!(controller.agent().mode(), Mode::Cruise);
}

#[test]
fn an_uncontrolled_vehicle_is_passive_and_gets_no_command() {
    let mut controller = controllers(1).remove(0);
    let _ = controller.step(&at(0.0, 0.0), true, &[], Duration::ZERO);
    let out = controller.step(&at(1.0, 0.0), false, &[], TICK);
    assert!(!out.outbox.is_empty(), "beacons continue");
    assert_eq!(controller.agent().mode(), Mode::Passive);
    assert_eq!(controller.velocity_mps(), [0.0; 3]);
}

/// One tick of a body that follows a velocity with a lag.
fn follow(body: &mut Body, wish_mps: [f64; 3], lag_s: f64) {
    for _ in 0..10 {
        for (axis, wish) in wish_mps.into_iter().enumerate() {
            let change = (wish - body.velocity_mps[axis]) / lag_s;
            body.velocity_mps[axis] += change.clamp(-1.0, 1.0) * 0.01;
            body.position_m[axis] += body.velocity_mps[axis] * 0.01;
        }
    }
}

#[test]
fn a_lagging_vehicle_stops_at_its_goal_without_overshoot() {
    for lag_s in [0.1, 0.5, 1.5] {
        let mut controller = lagging(1, lag_s).remove(0);
        let mut body = at(30.0, 0.0);
        let mut farthest = 0.0_f64;
        for step in 0..400 {
            let _ = controller.step(&body, true, &[], TICK * step);
            follow(&mut body, controller.velocity_mps(), lag_s);
            farthest = farthest.max(body.position_m[0]);
        }
        assert_eq!(controller.agent().mode(), Mode::Arrived);
        assert!(farthest < 50.1, "lag {lag_s} s: {farthest} m");
        assert!((body.position_m[0] - 50.0).abs() < 1.0, "lag {lag_s} s: {:?}", body.position_m);
    }
}

/// Both exchange places on one line, 40 m apart, with half a metre between their courses.
#[test]
fn lagging_vehicles_that_meet_do_not_touch() {
    for lag_s in [0.1, 0.5, 1.5] {
        let mut both: Vec<_> = lagging(6, lag_s).into_iter().skip(1).step_by(3).collect();
        let mut bodies = [at(10.0, 0.0), at(40.0, 0.5)];
        let (mut said, mut least) = ([Vec::new(), Vec::new()], f64::INFINITY);
        for step in 0..400 {
            let heard = said.clone();
            for (one, controller) in both.iter_mut().enumerate() {
                let out = controller.step(&bodies[one], true, &heard[1 - one], TICK * step);
                said[one] = out.outbox.to_vec();
            }
            for (controller, body) in both.iter().zip(&mut bodies) {
                follow(body, controller.velocity_mps(), lag_s);
            }
            let off = [0, 1].map(|axis| bodies[0].position_m[axis] - bodies[1].position_m[axis]);
            least = least.min(libm::hypot(off[0], off[1]));
        }
        assert!(least > 2.0, "lag {lag_s} s: {least} m");
        assert!(both.iter().all(|controller| controller.agent().mode() == Mode::Arrived), "lag {lag_s} s: {bodies:?}");
    }
}

/// A copter in the plane keeps its height by itself.
#[test]
fn a_vertical_velocity_in_the_plane_changes_nothing() {
    let commanded = |climbs_mps| {
        let mut controller = controllers(1).remove(0);
        let body = Body { velocity_mps: [1.0, 0.0, climbs_mps], ..at(48.0, 0.0) };
        (0..20).for_each(|step| drop(controller.step(&body, true, &[], TICK * step).clone()));
        controller.velocity_mps()
    };
    assert_eq!(commanded(1.5), commanded(0.0));
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
    assert_eq!(second.agent().mode(), Mode::Arrived);
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
fn a_silent_vehicle_gets_the_distance_that_it_needs_to_stop() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../companions/crossing.toml");
    let scenario = Scenario::load(&path, &Overrides::default()).unwrap();
    let max_m = |safety: LayerSettings| safety.orca().expect("ORCA").inflation.max_m;
    let usual = scenario.safety(0);
    assert_eq!(max_m(usual), 1.0, "a radius, as for robots that stop at once");
    assert_eq!(max_m(with_room(usual, 10.0)), 10.0);
    assert_eq!(max_m(with_room(with_room(usual, 12.0), 10.0)), 12.0, "the larger margin of the scenario is kept");
}
