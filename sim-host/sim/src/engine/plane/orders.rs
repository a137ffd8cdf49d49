//! Encodes the operator's orders and the robots' goals.

use crate::radio;
use crate::scenario::{Order, Target};
use staya_controller::agent::{Protocol as _, WAYPOINTS, Waypoint, WaypointOrder, Waypoints};
use staya_controller::auth::Key;
use staya_controller::geom::{Position, Vec3};
use staya_controller::robot::RobotId;
use staya_controller::time::Instant;
use staya_controller::wire::{Format, Header, Wire};

/// The frames of `orders`, by tick, for robots that restart at most `restarts` times.
pub(in crate::engine) fn frames(
    orders: &[Order],
    format: Format,
    key: Option<&Key>,
    restarts: u32,
) -> Vec<(u32, Vec<u8>)> {
    let mut frames = Vec::<(u32, Vec<u8>)>::new();
    // Each index has its own version counter, because versions are compared modulo 2^n.
    let mut versions = [0_u8; 256];
    let (mut wire, sender) = radio::operator(format, key, 0);
    radio::keep_up(&mut wire, restarts);
    let mut sequence = 0_u16;
    for order in orders {
        let version = &mut versions[usize::from(order.index)];
        *version = version.wrapping_add(1);
        let milli = |x: f64| libm::round(x * 1000.0);
        let waypoint = Waypoint {
            position: Position::from_mm(order.target.position_m.map(|x| milli(x) as i32)),
            velocity_mps: Vec3::from_milli(order.target.velocity_mps.map(|x| i32::from(milli(x) as i16))),
            at: Instant::default(),
        };
        let place = WaypointOrder { index: order.index, waypoint };
        let message = Waypoints::order(RobotId::NONE, *version, &place).expect("a waypoint fits a frame");
        let header = Header { boot: 0, sender, sequence };
        sequence = sequence.wrapping_add(1);
        let mut bytes = heapless::Vec::<u8, 64>::new();
        wire.encode(header, &message, &mut bytes).expect("a frame has at most 60 bytes");
        match frames.last_mut() {
            Some((tick, frame)) if *tick == order.tick => frame.extend_from_slice(&bytes),
            _ => frames.push((order.tick, bytes.to_vec())),
        }
    }
    frames
}

/// The waypoints after all orders; `restarts`: the first index begins a new course.
pub(super) fn course(
    orders: impl Iterator<Item = (u8, Waypoint<f32>)>,
    restarts: bool,
) -> heapless::Vec<(u8, Waypoint<f32>), WAYPOINTS> {
    let mut waypoints = heapless::Vec::<(u8, Waypoint<f32>), WAYPOINTS>::new();
    for (index, waypoint) in orders {
        if restarts && index == 0 {
            waypoints.clear();
        }
        match waypoints.iter_mut().find(|(known, _)| *known == index) {
            Some((_, known)) => *known = waypoint,
            // Cannot fail: the scenario was checked for the number of goals.
            None => drop(waypoints.push((index, waypoint))),
        }
    }
    waypoints
}

/// Converts a goal at age `age_s`, relative to the start of a robot's clock.
pub(super) fn waypoint(target: &Target, age_s: f64) -> Waypoint<f32> {
    let mut at = target.position_m;
    for (at, v) in at.iter_mut().zip(target.velocity_mps) {
        *at += v * age_s;
    }
    let [vx, vy, vz] = target.velocity_mps.map(|v| v as f32);
    Waypoint {
        position: Position::from_metres(at).unwrap_or_default(),
        velocity_mps: Vec3::new(vx, vy, vz),
        at: Instant::from_micros(0),
    }
}
