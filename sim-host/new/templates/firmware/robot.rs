//! The robot of my-swarm: two driven wheels with encoders and a radio modem on a serial line. The same on every part; the pins are in
//! main.rs.

use core::convert::Infallible;
use embassy_futures::select::select;
use embassy_time::{Instant as Clock, Ticker};
use embedded_hal::pwm::SetDutyCycle;
use embedded_io_async::{Read, Write};
use my_swarm::Law;
use staya_controller::agent::*;
use staya_controller::geom::Position;
use staya_controller::neighbor::StalenessInflation;
use staya_controller::orca::AvoidParams;
use staya_controller::robot::RobotId;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::Postcard;
use staya_robot::odometry::{Encoder, Odometry};
use staya_robot::{drive::*, radio::PacketLink};

// FILL IN. How to measure each: controller/robot/README.md in Staya's repository.

/// The robot's number, each its own, 1 or more.
const NUMBER: RobotId = RobotId(1);
/// Where it starts, east and north of the point that all share (millimetres), and which way it looks (radians from east, to the left).
const START: (Position, f32) = (Position::from_mm([0, 0, 0]), 0.0);
/// Where it goes.
const GOAL: Position = Position::from_mm([2000, 1000, 0]);
/// Between the wheels; a wheel's radius; the body's around the middle between the wheels: metres.
const TRACK_M: f32 = 0.12;
const WHEEL_M: f32 = 0.03;
const BODY_M: f32 = 0.09;
/// Edges of an encoder in one turn of a wheel, both channels counted; which of the encoders count down when the robot goes ahead.
const EDGES_PER_TURN: u16 = 1440;
const COUNTS_DOWN: [bool; 2] = [false, true];
/// Speed of a rim at full duty; the largest duty at which a wheel stands still; which motors turn the other way.
const FULL_MPS: f32 = 0.6;
const DEAD_DUTY: f32 = 0.1;
const IS_INVERTED: [bool; 2] = [false, true];
/// What the wheels are asked for at most.
const LIMITS: Limits<f32> = Limits { speed_mps: 0.5, acceleration_mps2: 1.0 };
/// From one step to the next. `PERIOD` of a watchdog is to be longer.
const TICK: Duration = Duration::from_millis(50);

/// What main.rs has wired.
pub struct Wiring<R, W, P, C, D> {
    /// Another number at each start, by chance: so that others tell its packets from those before.
    pub boot: u8,
    /// The radio modem.
    pub radio: (R, W),
    /// Left wheel ahead and back, right wheel ahead and back.
    pub motors: [P; 4],
    /// How far the left and the right encoder have counted; it may wrap.
    pub counts: C,
    /// Tells the watchdog that all is well.
    pub pet: D,
}

/// Runs the robot for good; returns only if a measure makes no sense.
pub async fn run<R, W, P, C, D>(wiring: Wiring<R, W, P, C, D>) -> Option<Infallible>
where
    R: Read,
    W: Write,
    P: SetDutyCycle,
    C: Fn() -> [u16; 2],
    D: FnMut(),
{
    let Wiring { boot, radio, motors, counts, mut pet } = wiring;
    let mut radio = PacketLink::<_>::new(radio);
    let mut left_rim = Encoder::new(WHEEL_M, EDGES_PER_TURN, COUNTS_DOWN[0])?;
    let mut right_rim = Encoder::new(WHEEL_M, EDGES_PER_TURN, COUNTS_DOWN[1])?;
    let motor = |is_inverted| Calibration { full_mps: FULL_MPS, dead_duty: DEAD_DUTY, still_mps: 0.005, is_inverted };
    let [left_ahead, left_back, right_ahead, right_back] = motors;
    let mut wheels = Wheels::new([
        (HBridge::new(left_ahead, left_back), motor(IS_INVERTED[0])),
        (HBridge::new(right_ahead, right_back), motor(IS_INVERTED[1])),
    ]);
    // To the controller the robot is a disc around a point ahead of its axle.
    let ahead = LookAhead::new(TRACK_M / 2.0)?;
    let mut mixer = Mixer::new(Differential::new(TRACK_M)?, LIMITS)?;
    let mut odometry = Odometry::new(START.0, START.1)?;
    let max_speed_mps = ahead.max_speed(LIMITS.speed_mps, TRACK_M);

    let mut config = AgentConfig::new(NUMBER, ahead.radius(BODY_M) + 0.02, TICK);
    config.boot = boot;
    config.max_acceleration_mps2 = ahead.max_speed(LIMITS.acceleration_mps2, TRACK_M);
    let safety = OrcaSafety::new(AvoidParams::default(), StalenessInflation { growth_mps: 0.1, max_m: 0.2 });
    let law = Law::new(max_speed_mps, 0.02, 0.6);
    let mut agent: Agent<f32, Law, NEIGHBORS, OrcaSafety<f32, HALF_PLANES>> =
        Agent::new(&config, law, safety, Postcard);
    agent.assign_waypoint(0, &Waypoint::fixed(GOAL));

    let mut ticker = Ticker::every(embassy_time::Duration::from_micros(TICK.as_micros() as u64));
    loop {
        select(ticker.next(), radio.serve()).await;
        pet();
        let [left, right] = counts();
        let rims = [left_rim.travelled(left), right_rim.travelled(right)];
        odometry.advance(&mixer.kinematics().twist(&rims), TICK);
        let heading = odometry.heading_rad();
        let inputs = Inputs {
            state: ahead.state(&odometry.state(), heading, odometry.twist().turn_radps),
            surroundings: InPlane { max_speed_mps, obstacles: &[] },
            inbox: radio.take(),
        };
        let now = Instant::from_micros(Clock::now().as_micros() as u32);
        let out = agent.step(&inputs, now, &mut ());
        radio.send(&out.outbox);
        let twist = ahead.twist(wished_velocity(&out.command), heading);
        // A motor that cannot be set stops the other one; the robot starts anew.
        wheels.turn(&mixer.mix(&twist, TICK)).ok()?;
    }
}
