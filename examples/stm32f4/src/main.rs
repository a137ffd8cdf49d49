//! A robot with two driven wheels on an STM32F405 that moves to a waypoint and avoids other robots.
//!
//! Wiring: a radio modem on USART1 (PA9, PA10), encoders on TIM3 (PA6, PA7) and TIM4 (PB6, PB7),
//! and two motors behind a DRV8833 on TIM8 (PC6 to PC9).
#![no_std]
#![no_main]

use embassy_executor::Spawner;
use embassy_futures::select::select;
use embassy_stm32::timer::{qei::Qei, simple_pwm::PwmPin, simple_pwm::SimplePwm};
use embassy_stm32::usart::{BufferedInterruptHandler, BufferedUart, Config as UartConfig};
use embassy_stm32::{Config, Peripherals, bind_interrupts, gpio::OutputType::PushPull, peripherals};
use embassy_stm32::{rcc::*, rng, time::Hertz, wdg::IndependentWatchdog};
use embassy_time::{Instant as Clock, Ticker};
use staya_controller::agent::*;
use staya_controller::time::{Duration, Instant};
use staya_controller::{geom::Position, neighbor::StalenessInflation, orca::AvoidParams};
use staya_controller::{robot::RobotId, wire::Postcard};
use staya_robot::odometry::{Encoder, Odometry};
use staya_robot::{drive::*, radio::PacketLink};

const TICK: Duration = Duration::from_millis(50);
/// Measured on the robot.
const TRACK_M: f32 = 0.12;
const WHEEL_M: f32 = 0.03;
const BODY_M: f32 = 0.09;
const TICKS_PER_TURN: u16 = 1440;

bind_interrupts!(struct Irqs {
    USART1 => BufferedInterruptHandler<peripherals::USART1>;
    RNG => rng::InterruptHandler<peripherals::RNG>;
});

/// Returns only if a measured value is invalid.
async fn robot(p: Peripherals) -> Option<()> {
    let (mut tx, mut rx, mut modem) = ([0; 256], [0; 512], UartConfig::default());
    modem.baudrate = 57_600;
    let uart = BufferedUart::new(p.USART1, p.PA10, p.PA9, &mut tx, &mut rx, Irqs, modem);
    let (tx, rx) = uart.ok()?.split();
    let mut radio = PacketLink::<_>::new((rx, tx));
    let left = Qei::new(p.TIM3, p.PA6, p.PA7, Default::default());
    let right = Qei::new(p.TIM4, p.PB6, p.PB7, Default::default());
    let mut left_rim = Encoder::new(WHEEL_M, TICKS_PER_TURN, false)?;
    let mut right_rim = Encoder::new(WHEEL_M, TICKS_PER_TURN, true)?;
    let (a, b) = (Some(PwmPin::new(p.PC6, PushPull)), Some(PwmPin::new(p.PC7, PushPull)));
    let (c, d) = (Some(PwmPin::new(p.PC8, PushPull)), Some(PwmPin::new(p.PC9, PushPull)));
    let mut pwm = SimplePwm::new(p.TIM8, a, b, c, d, Hertz(20_000), Default::default()).split();
    for channel in [&mut pwm.ch1, &mut pwm.ch2, &mut pwm.ch3, &mut pwm.ch4] {
        channel.enable();
    }
    let motor = Calibration { full_mps: 0.6, dead_duty: 0.1, still_mps: 0.005, is_inverted: false };
    let (l, r) = (HBridge::new(pwm.ch1, pwm.ch2), HBridge::new(pwm.ch3, pwm.ch4));
    let mut wheels = Wheels::new([(l, motor), (r, Calibration { is_inverted: true, ..motor })]);

    let ahead = LookAhead::new(TRACK_M / 2.0)?;
    let limits = Limits { speed_mps: 0.5, acceleration_mps2: 1.0 };
    let mut mixer = Mixer::new(Differential::new(TRACK_M)?, limits)?;
    let mut odometry = Odometry::new(Position::ORIGIN, 0.0)?;
    let mut config = AgentConfig::new(RobotId(1), ahead.radius(BODY_M) + 0.02, TICK);
    config.boot = rng::Rng::new(p.RNG, Irqs).next_u32() as u8;
    config.max_acceleration_mps2 = ahead.max_speed(limits.acceleration_mps2, TRACK_M);
    config.lag_s = 0.1; // measured: time until a wheel has made 63 % of a change of speed
    let max_speed_mps = ahead.max_speed(limits.speed_mps, TRACK_M);
    let safety = OrcaSafety::new(AvoidParams::default(), StalenessInflation { growth_mps: 0.1, max_m: 0.2 });
    let law = WaypointGuidance::new(max_speed_mps, 0.02);
    let mut agent = OrcaAgent::new(&config, law, safety, Postcard);
    agent.order(&WaypointOrder::first(Waypoint::fixed(Position::from_mm([2000, 1000, 0]))));

    let mut ticker = Ticker::every(embassy_time::Duration::from_micros(TICK.as_micros() as u64));
    let mut watchdog = IndependentWatchdog::new(p.IWDG, 200_000);
    watchdog.unleash();
    loop {
        select(ticker.next(), radio.serve()).await;
        watchdog.pet();
        let rims = [left_rim.travelled(left.count()), right_rim.travelled(right.count())];
        odometry.advance(&mixer.kinematics().twist(&rims), TICK);
        let heading = odometry.heading_rad();
        let state = ahead.state(&odometry.state(), heading, odometry.twist().turn_radps);
        let surroundings = InPlane { max_speed_mps, obstacles: &[] };
        let inputs = Inputs { state, surroundings, inbox: radio.take() };
        let now = Instant::from_micros(Clock::now().as_micros() as u32);
        let out = agent.step(&inputs, now, &mut ());
        radio.send(&out.outbox);
        let twist = ahead.twist(wished_velocity(&out.command), heading);
        let Ok(()) = wheels.turn(&mixer.mix(&twist, TICK));
    }
}

#[embassy_executor::main]
async fn main(_spawner: Spawner) {
    let mut config = Config::default();
    // 16 MHz / 8 * 168, divided by 2 for the core and by 7 (48 MHz) for random numbers.
    let (prediv, mul, divp, divq) = (PllPreDiv::DIV8, PllMul::MUL168, PllPDiv::DIV2, PllQDiv::DIV7);
    config.rcc.pll = Some(Pll { prediv, mul, divp: Some(divp), divq: Some(divq), divr: None });
    (config.rcc.pll_src, config.rcc.sys) = (PllSource::HSI, Sysclk::PLL1_P);
    (config.rcc.apb1_pre, config.rcc.apb2_pre) = (APBPrescaler::DIV4, APBPrescaler::DIV2);
    robot(embassy_stm32::init(config)).await;
    cortex_m::peripheral::SCB::sys_reset();
}

#[panic_handler] // Stops the motors and restarts.
fn panic(_: &core::panic::PanicInfo) -> ! {
    cortex_m::peripheral::SCB::sys_reset();
}
