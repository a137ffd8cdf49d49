use super::waypoints::add_movers;
use crate::medium::Faults;
use crate::plane::{Scene, Solid, run};
use crate::{Probe, Summary};
use heapless::Vec;
use staya_controller::agent::{
    BoidsGuidance, GoalFlockGuidance, LatticeGuidance, PushOutSafety, Unguarded, Waypoint, WaypointOrder,
};
use staya_controller::boids::BoidsParams;
use staya_controller::geom::{Position, Vec3};
use staya_controller::goal_flock::GoalParams;
use staya_controller::lattice::{Gain, LatticeParams};
use staya_controller::push_out::PushOutParams;
use staya_controller::scalar::Scalar;

const CROWD: [[i32; 3]; 5] = [[0, 0, 0], [0, 700, 0], [600, 300, 0], [-500, -400, 0], [700, -500, 0]];

fn scene<S: Scalar>(solids: &'static [Solid], ticks: u32) -> Scene<S> {
    Scene {
        solids,
        land: None,
        max_speed_mps: S::ONE,
        // The laws treat robots as points; push-out gives them a radius.
        apart_mm: 300,
        faults: Faults::default(),
        ticks,
    }
}

#[inline(never)]
pub(super) fn lattice<S: Scalar, P: Probe<S>>(probe: &mut P) -> Summary {
    const BALL: [Solid; 1] = [Solid::Ball([6000, 900, 0], 500)];
    // Stable at ten decisions per second with a latency of 0.1 s.
    let params = LatticeParams {
        alpha: Gain::critical(S::ONE),
        beta: Gain::critical(S::from_i32(4)),
        gamma: Gain::critical(S::HALF),
        ..LatticeParams::new(S::ONE)
    };
    let mut movers = Vec::new();
    add_movers(&mut movers, &CROWD, |_| LatticeGuidance::new(params, true), || Unguarded);
    let reference =
        Waypoint { velocity_mps: Vec3::new(0.25, 0.0, 0.0), ..Waypoint::fixed(Position::from_mm([1000, 0, 0])) };
    for mover in &mut movers {
        mover.agent.order(&WaypointOrder::first(reference));
    }
    run(&scene(&BALL, 400), &mut movers, &mut (), probe)
}

#[inline(never)]
pub(super) fn goals<S: Scalar, P: Probe<S>>(probe: &mut P) -> Summary {
    let params = GoalParams::new(S::from_milli(500), S::ONE);
    let mut movers = Vec::new();
    add_movers(
        &mut movers,
        &CROWD,
        |_| GoalFlockGuidance::new(params, S::ONE, 3),
        || PushOutSafety::new(PushOutParams::new(S::from_milli(350))),
    );
    for mover in &mut movers {
        for (index, goal) in (0..).zip([[9000, 4000, 0], [9000, -4000, 0]]) {
            let waypoint = Waypoint::fixed(Position::from_mm(goal));
            mover.agent.order(&WaypointOrder { index, waypoint });
        }
    }
    run(&scene(&[], 400), &mut movers, &mut (), probe)
}

#[inline(never)]
pub(super) fn boids<S: Scalar, P: Probe<S>>(probe: &mut P) -> Summary {
    let params = BoidsParams::new(S::from_milli(300), S::from_i32(30), S::from_ratio(1, 20), S::from_ratio(1, 50));
    let mut movers = Vec::new();
    add_movers(&mut movers, &CROWD, |_| BoidsGuidance::new(params, S::HALF), || Unguarded);
    let ways = [[5, 0], [4, 3], [3, -4], [0, 5], [4, -3]];
    for (mover, [x, y]) in movers.iter_mut().zip(ways) {
        let tenths = |n| S::from_ratio(n, 10);
        mover.velocity_mps = Vec3::new(tenths(x), tenths(y), S::ZERO);
    }
    run(&scene(&[], 400), &mut movers, &mut (), probe)
}
