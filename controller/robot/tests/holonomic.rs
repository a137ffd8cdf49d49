//! A spinning robot on three omni wheels with fixed-point numbers reaches its goal.

use crate::common;
use core::convert::Infallible;
use embedded_hal::digital::{ErrorType as PinError, OutputPin};
use staya_controller::agent::{
    Agent, AgentConfig, InPlane, Inputs, OrcaSafety, Waypoint, WaypointGuidance, WaypointOrder,
};
use staya_controller::geom::{Position, Vec2};
use staya_controller::neighbor::StalenessInflation;
use staya_controller::orca::AvoidParams;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::scalar::{Q16, Scalar};
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::Postcard;
use staya_robot::drive::{Calibration, Kinematics, Limits, Mixer, Omni, SignMagnitude, Twist, Wheels, wished_velocity};
use staya_robot::odometry::{Encoder, Odometry};
use std::cell::Cell;
use std::rc::Rc;

const TICK: Duration = Duration::from_millis(50);
const TICK_S: f64 = 0.05;
const MAX_DUTY: u16 = 4095;
const FULL_MPS: f64 = 0.8;
const WHEEL_M: f64 = 0.025;
const ARM_M: f64 = 0.1;
const TICKS_PER_TURN: u16 = 1200;

type Power = common::Channel<MAX_DUTY>;

#[derive(Clone, Default)]
struct Ahead(Rc<Cell<bool>>);

impl PinError for Ahead {
    type Error = Infallible;
}

impl OutputPin for Ahead {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.set(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.set(true);
        Ok(())
    }
}

fn q(value: f64) -> Q16 {
    Q16::from_f64(value).unwrap()
}

#[test]
fn an_omni_robot_in_fixed_point_arrives_while_it_spins() {
    let pins: [(Power, Ahead); 3] = Default::default();
    let wheels = Omni::<f64, 3>::new(0.3, ARM_M).unwrap();
    let (mut place, mut heading, mut ways) = (Vec2::new(0.0, 0.0), 1.0f64, [0.0f64; 3]);
    let limits = Limits { speed_mps: q(0.6), acceleration_mps2: q(2.0) };
    let mut mixer = Mixer::new(Omni::<Q16, 3>::new(q(0.3), q(ARM_M)).unwrap(), limits).unwrap();
    let linear = Calibration::linear(q(FULL_MPS));
    let motors = pins.clone();
    let mut motors = Wheels::new(motors.map(|(power, ahead)| (SignMagnitude::new(power, ahead), linear)));
    let mut encoders = [(); 3].map(|()| Encoder::new(q(WHEEL_M), TICKS_PER_TURN, false).unwrap());
    let mut odometry = Odometry::new(Position::ORIGIN, q(heading)).unwrap();
    let max_speed_mps = q(0.4);
    let config = AgentConfig { max_acceleration_mps2: q(1.0), ..AgentConfig::new(RobotId(1), q(0.15), TICK) };
    let inflation = StalenessInflation { growth_mps: Q16::ZERO, max_m: Q16::ZERO };
    let safety = OrcaSafety::<Q16, 16>::new(AvoidParams::default(), inflation);
    let guidance = WaypointGuidance::new(max_speed_mps, q(0.02));
    let mut agent = Agent::<Q16, _, 8, _>::new(&config, guidance, safety, Postcard);
    let goal = Vec2::new(-1.5, 2.0);
    let there = Position::from_metres([goal.x, goal.y, 0.0]).unwrap();
    assert!(agent.order(&WaypointOrder::first(Waypoint::fixed(there))));

    let mut turned = 0.0;
    let mut now = Instant::from_micros(0);
    let mut steps = 0;
    while agent.mode() != Mode::Arrived {
        steps += 1;
        assert!(steps < 400, "{place:?}");
        let turn = core::f64::consts::TAU * WHEEL_M;
        let count = |way: f64| (way / turn * f64::from(TICKS_PER_TURN)).floor() as i64 as u16;
        let mut counts = ways.iter().map(|way| count(*way));
        let rims = encoders.each_mut().map(|encoder| encoder.travelled(counts.next().unwrap()));
        odometry.advance(&mixer.kinematics().twist(&rims), TICK);
        let inputs =
            Inputs { state: odometry.state(), surroundings: InPlane { max_speed_mps, obstacles: &[] }, inbox: &[] };
        let out = agent.step(&inputs, now, &mut ());
        let wish = wished_velocity(&out.command);
        let twist = Twist::holonomic(wish, odometry.heading_rad(), q(1.0));
        let Ok(()) = motors.turn(&mixer.mix(&twist, TICK));
        now = now + TICK;

        let speed = |(power, ahead): &(Power, Ahead)| {
            let sign = if ahead.0.get() { 1.0 } else { -1.0 };
            sign * FULL_MPS * f64::from(power.0.get()) / f64::from(MAX_DUTY)
        };
        let rims = pins.each_ref().map(speed);
        let body = wheels.twist(&rims);
        let (sin, cos) = Scalar::sin_cos(heading + body.turn_radps * TICK_S / 2.0);
        place += Vec2::new(body.forward_mps, body.left_mps).rotate(cos, sin) * TICK_S;
        heading += body.turn_radps * TICK_S;
        turned += body.turn_radps * TICK_S;
        for (way, rim) in ways.iter_mut().zip(rims) {
            *way += rim * TICK_S;
        }
    }
    assert!((place - goal).norm() < 0.05, "{place:?}");
    assert!(turned > 4.0, "it spins on the way: {turned}");
}
