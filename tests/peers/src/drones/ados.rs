//! Drones with the controller of `ados-swarm`. The host's part, the beacon and the neighbour table,
//! has its format, rounding and time limit.

use super::{BEACON_STEPS, Body, Radio, STEP_S, Scene, Swarm, Task, Vector};
use ados_swarm::formation::{FormationAnchor, FormationName};
use ados_swarm::geo::{deg_to_e7, e7_to_deg};
use ados_swarm::{
    CONTROL_PERIOD, GeoOrigin, NEIGHBOR_STALE, Ned, NeighborFix, OperatorDirective, OwnState, STATUS_ARMED,
    STATUS_EMERGENCY, STATUS_GPS_OK, STATUS_GUIDED, SwarmControlConfig, SwarmController, SwarmMode,
};
use std::cmp::Ordering;
use std::time::{Duration, Instant};

#[derive(Clone, Copy)]
struct Beacon {
    step: u32,
    lat_e7: i32,
    lon_e7: i32,
    alt_dm: f64,
    cmps: Vector,
    status: u8,
}

/// Drones of `ados-swarm` in their default configuration.
pub struct Ados {
    start: Instant,
    origin: GeoOrigin,
    task: Task,
    drones: Vec<SwarmController>,
    /// The last beacon that each drone received from each other one.
    heard: Vec<Vec<Option<Beacon>>>,
}

impl Ados {
    fn is_fresh(step: u32, beacon: &Beacon) -> bool {
        f64::from(step - beacon.step) * STEP_S < NEIGHBOR_STALE.as_secs_f64() - STEP_S / 2.0
    }

    fn beacon(&self, step: u32, drone: usize, body: &Body) -> Beacon {
        let [north, east, up] = body.at_m;
        let (lat, lon, alt) = self.origin.to_geo(Ned::new(north, east, -up));
        let controller = &self.drones[drone];
        let alarm = if controller.emergency() { STATUS_EMERGENCY } else { 0 };
        Beacon {
            step,
            lat_e7: deg_to_e7(lat),
            lon_e7: deg_to_e7(lon),
            alt_dm: libm::round(alt * 10.0),
            cmps: body.mps.map(|mps| libm::round(mps * 100.0)),
            status: STATUS_GPS_OK | STATUS_ARMED | STATUS_GUIDED | alarm | controller.precedence().as_status_bits(),
        }
    }

    /// An entry of the host's neighbour table: the state of a beacon, extrapolated.
    fn fix(step: u32, other: usize, beacon: &Beacon) -> NeighborFix {
        let age_s = f64::from(step - beacon.step) * STEP_S;
        let [vn, ve, up] = beacon.cmps.map(|cmps| cmps / 100.0);
        let place = GeoOrigin::new(e7_to_deg(beacon.lat_e7), e7_to_deg(beacon.lon_e7), beacon.alt_dm / 10.0);
        let (lat_deg, lon_deg, alt_m) = place.to_geo(Ned::new(vn * age_s, ve * age_s, -up * age_s));
        NeighborFix {
            slot: slot(other),
            lat_deg,
            lon_deg,
            alt_m,
            vn,
            ve,
            vd: -up,
            status: beacon.status,
            sender_order: Ordering::Equal,
        }
    }
}

fn slot(drone: usize) -> u8 {
    drone as u8 + 1
}

impl Swarm for Ados {
    fn new(scene: &Scene) -> Self {
        let count = scene.starts_m.len();
        let slots: Vec<u8> = (0..count).map(slot).collect();
        let config = SwarmControlConfig { enabled: true, ..SwarmControlConfig::default() };
        let drone = |_| {
            let mut drone = SwarmController::new(&config, &slots);
            match scene.task {
                Task::Goals => {}
                Task::Flock => drone.set_mode(SwarmMode::Flocking),
                Task::Wedge(spacing_m) => {
                    drone.set_mode(SwarmMode::Formation);
                    drone.set_formation(FormationName::Wedge, &slots, spacing_m, FormationAnchor::Centroid);
                }
            }
            drone
        };
        Self {
            start: Instant::now(),
            origin: GeoOrigin::new(12.9716, 77.5946, 0.0),
            task: scene.task,
            drones: (0..count).map(drone).collect(),
            heard: vec![vec![None; count]; count],
        }
    }

    fn step(&mut self, step: u32, bodies: &[Body], goals: &[Vector], radio: &Radio) -> Vec<Vector> {
        let now = self.start + CONTROL_PERIOD * step;
        if step.is_multiple_of(BEACON_STEPS) {
            for (from, body) in bodies.iter().enumerate().filter(|(_, body)| body.lives) {
                let beacon = self.beacon(step, from, body);
                for to in (0..bodies.len()).filter(|&to| to != from && radio.delivers(step, from, to)) {
                    self.heard[to][from] = Some(beacon);
                }
            }
        }
        let command = |drone: usize| {
            let body = &bodies[drone];
            if !body.lives {
                return [0.0; 3];
            }
            let [north, east, up] = body.at_m;
            let (lat_deg, lon_deg, alt_rel_m) = self.origin.to_geo(Ned::new(north, east, -up));
            let own = OwnState {
                slot: slot(drone),
                lat_deg,
                lon_deg,
                alt_rel_m,
                vn: body.mps[0],
                ve: body.mps[1],
                vd: -body.mps[2],
                armed: true,
                guided: true,
                fix_age: Some(Duration::ZERO),
            };
            let heard = self.heard[drone].iter().enumerate();
            let heard = heard.filter_map(|(other, beacon)| Some((other, beacon.as_ref()?)));
            let heard = heard.filter(|(_, beacon)| Self::is_fresh(step, beacon));
            let fixes: Vec<_> = heard.map(|(other, beacon)| Self::fix(step, other, beacon)).collect();
            let [north, east, up] = goals[drone];
            let (lat_deg, lon_deg, alt_m) = self.origin.to_geo(Ned::new(north, east, -up));
            let controller = &mut self.drones[drone];
            match self.task {
                Task::Goals => {
                    controller.set_operator_directive(OperatorDirective::Goto { lat_deg, lon_deg, alt_m }, now);
                }
                Task::Flock => controller.set_target(Some((lat_deg, lon_deg, alt_m))),
                Task::Wedge(_) => {}
            }
            // A drone without a setpoint hovers.
            let setpoint = controller.tick(&own, &fixes, now).setpoint;
            setpoint.map_or([0.0; 3], |point| [point.vn, point.ve, -point.vd].map(f64::from))
        };
        (0..bodies.len()).map(command).collect()
    }

    fn knows(&self, step: u32, own: usize, other: usize) -> bool {
        self.heard[own][other].is_some_and(|beacon| Self::is_fresh(step, &beacon))
    }
}
