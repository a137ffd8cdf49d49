//! The robot of my-swarm: two driven wheels with encoders, and a radio modem on a serial line. This
//! file is common to all parts; the pins are in main.rs.

use core::convert::Infallible;
use embassy_futures::select::select;
use embassy_time::{Instant as Clock, Ticker};
use embedded_hal::pwm::SetDutyCycle;
use embedded_io_async::{Read, Write};
use my_swarm::MyLaw;
use staya_controller::agent::*;
use staya_controller::geom::Position;
use staya_controller::neighbor::StalenessInflation;
use staya_controller::orca::AvoidParams;
use staya_controller::robot::RobotId;
use staya_controller::scalar::cast;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::Postcard;
use staya_robot::odometry::{Encoder, Odometry};
use staya_robot::{drive::*, radio::PacketLink};

/// Number format of the agent: `f32`, `Fast32` with approximate functions, or `Q16` for parts
/// without an FPU.
type Number = MY_NUMBER;

// FILL IN. controller/robot/README.md in Staya's repository describes how to measure each value.

/// Number of the robot, unique, from 1.
const NUMBER: RobotId = RobotId(1);
/// Start: position east and north of the shared origin (millimetres), and heading (radians
/// counterclockwise from east).
const START: (Position, f32) = (Position::from_mm([0, 0, 0]), 0.0);
/// Goal.
const GOAL: Position = Position::from_mm([2000, 1000, 0]);
/// Distance between the wheels, radius of a wheel, and radius of the body around the centre of the
/// axle, metres.
const TRACK_M: f32 = 0.12;
const WHEEL_M: f32 = 0.03;
const BODY_M: f32 = 0.09;
/// Encoder edges per turn of a wheel over both channels, and which encoders count down when driving
/// forward.
const EDGES_PER_TURN: u16 = 1440;
const COUNTS_DOWN: [bool; 2] = [false, true];
/// Speed of a wheel's rim at full duty, largest duty at which a wheel does not turn, and which
/// motors are inverted.
const FULL_MPS: f32 = 0.6;
const DEAD_DUTY: f32 = 0.1;
const IS_INVERTED: [bool; 2] = [false, true];
/// Limits of the commands to the wheels.
const LIMITS: Limits<f32> = Limits { speed_mps: 0.5, acceleration_mps2: 1.0 };
/// Time until a wheel has made 63 % of a commanded change of speed, seconds.
const LAG_S: f32 = 0.1;
/// Time between two steps. The `PERIOD` of a watchdog must be longer.
const TICK: Duration = Duration::from_millis(50);

/// Peripherals that main.rs has set up.
pub struct Wiring<R, W, P, C, D> {
    /// A random number at each start, by which other robots notice a restart.
    pub boot: u8,
    pub radio: (R, W),
    /// Left wheel forward and back, right wheel forward and back.
    pub motors: [P; 4],
    /// Counts of the left and the right encoder; they may wrap.
    pub counts: C,
    /// Resets the watchdog.
    pub pet: D,
}

/// Runs the robot and never returns, except for invalid constants.
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
    // The controller sees the robot as a disc around a point ahead of its axle.
    let ahead = LookAhead::new(TRACK_M / 2.0)?;
    let mut mixer = Mixer::new(Differential::new(TRACK_M)?, LIMITS)?;
    let mut odometry = Odometry::new(START.0, START.1)?;
    let max_speed_mps = ahead.max_speed(LIMITS.speed_mps, TRACK_M);

    let mut config = AgentConfig::new(NUMBER, ahead.radius(BODY_M) + 0.02, TICK);
    config.boot = boot;
    config.max_acceleration_mps2 = ahead.max_speed(LIMITS.acceleration_mps2, TRACK_M);
    config.lag_s = LAG_S;
    let inflation = StalenessInflation { growth_mps: 0.1_f32, max_m: 0.2 };
    let safety = OrcaSafety::new(AvoidParams::default(), inflation.cast());
    let law = MyLaw::new(max_speed_mps, 0.02, 0.6);
    let mut agent: Agent<Number, MyLaw, NEIGHBORS, OrcaSafety<Number, HALF_PLANES>> =
        Agent::new(&config.cast(), law, safety, Postcard);
    agent.order(&WaypointOrder::first(Waypoint::fixed(GOAL)));

    let mut ticker = Ticker::every(embassy_time::Duration::from_micros(TICK.as_micros() as u64));
    loop {
        select(ticker.next(), radio.serve()).await;
        pet();
        let [left, right] = counts();
        let rims = [left_rim.travelled(left), right_rim.travelled(right)];
        odometry.advance(&mixer.kinematics().twist(&rims), TICK);
        let heading = odometry.heading_rad();
        let state = ahead.state(&odometry.state(), heading, odometry.twist().turn_radps);
        let inputs = Inputs {
            state: KinematicState { position: state.position, velocity_mps: state.velocity_mps.cast() },
            surroundings: InPlane { max_speed_mps: cast(max_speed_mps), obstacles: &[] },
            inbox: radio.take(),
        };
        let now = Instant::from_micros(Clock::now().as_micros() as u32);
        let out = agent.step(&inputs, now, &mut ());
        radio.send(&out.outbox);
        let twist = ahead.twist(wished_velocity(&out.command).cast(), heading);
        // If one motor fails, the other one stops and the robot restarts.
        wheels.turn(&mixer.mix(&twist, TICK)).ok()?;
    }
}
