//! Wiring of my-swarm's robot on an nRF52840: FILL IN the pins. A radio modem on UARTE0 (P0.08,
//! P0.06), encoders on P0.13, P0.14 and P0.15, P0.16, two motors behind a DRV8833 on P0.26, P0.27,
//! P0.30 and P0.31.
#![no_std]
#![no_main]

mod encoder;
mod robot;

use core::cell::Cell;
use core::convert::Infallible;
use embassy_executor::Spawner;
use embassy_futures::select::select3;
use embassy_nrf::buffered_uarte::{BufferedUarte, InterruptHandler};
use embassy_nrf::gpio::{AnyPin, Input, Pull};
use embassy_nrf::pwm::{DutyCycle, Prescaler, SimpleConfig, SimplePwm};
use embassy_nrf::rng::Rng;
use embassy_nrf::uarte::{Baudrate, Config as UartConfig};
use embassy_nrf::wdt::{self, Watchdog};
use embassy_nrf::{Peri, Peripherals, bind_interrupts, config::HfclkSource, peripherals::UARTE0};
use embedded_hal::pwm::{ErrorType, SetDutyCycle};

bind_interrupts!(struct Irqs {
    UARTE0 => InterruptHandler<UARTE0>;
});

async fn wire(p: Peripherals) -> Option<()> {
    let (mut to_send, mut heard, mut modem) = ([0; 256], [0; 512], UartConfig::default());
    modem.baudrate = Baudrate::Baud57600;
    let (timer, one, other, group) = (p.TIMER0, p.PPI_CH0, p.PPI_CH1, p.PPI_GROUP0);
    let (receive, send) = (p.P0_08, p.P0_06);
    let uart =
        BufferedUarte::new(p.UARTE0, timer, one, other, group, receive, send, Irqs, modem, &mut heard, &mut to_send);
    let radio = uart.split();
    let (left, right) = (Cell::new(0), Cell::new(0));
    let channel = |pin: Peri<'static, AnyPin>| Input::new(pin, Pull::Up);
    let count_left = encoder::count(channel(p.P0_13.into()), channel(p.P0_14.into()), &left);
    let count_right = encoder::count(channel(p.P0_15.into()), channel(p.P0_16.into()), &right);
    // 16 MHz / 800 = 20 kHz.
    let mut pwm = SimpleConfig::default();
    (pwm.prescaler, pwm.max_duty) = (Prescaler::Div1, 800);
    let motors = [
        Motor(SimplePwm::new_1ch(p.PWM0, p.P0_26, &pwm)),
        Motor(SimplePwm::new_1ch(p.PWM1, p.P0_27, &pwm)),
        Motor(SimplePwm::new_1ch(p.PWM2, p.P0_30, &pwm)),
        Motor(SimplePwm::new_1ch(p.PWM3, p.P0_31, &pwm)),
    ];
    let boot = Rng::new_blocking(p.RNG).blocking_next_u32() as u8;
    let mut config = wdt::Config::default();
    config.timeout_ticks = 32_768 / 5;
    let (_, [mut watchdog]) = Watchdog::try_new(p.WDT, config).ok()?;
    let counts = || [left.get(), right.get()];
    let robot = robot::run(robot::Wiring { boot, radio, motors, counts, pet: || watchdog.pet() });
    select3(robot, count_left, count_right).await;
    None
}

struct Motor(SimplePwm<'static>);

impl ErrorType for Motor {
    type Error = Infallible;
}

impl SetDutyCycle for Motor {
    fn max_duty_cycle(&self) -> u16 {
        self.0.max_duty()
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        self.0.set_duty(0, DutyCycle::inverted(duty));
        Ok(())
    }
}

#[embassy_executor::main]
async fn main(_spawner: Spawner) {
    let mut config = embassy_nrf::config::Config::default();
    // Serial lines and odometry need the accuracy of the crystal.
    config.hfclk_source = HfclkSource::ExternalXtal;
    wire(embassy_nrf::init(config)).await;
    cortex_m::peripheral::SCB::sys_reset();
}

#[panic_handler] // Releases the motors and restarts.
fn panic(_: &core::panic::PanicInfo) -> ! {
    cortex_m::peripheral::SCB::sys_reset();
}
