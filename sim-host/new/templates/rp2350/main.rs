//! Wiring of my-swarm's robot on an RP2350 (Raspberry Pi Pico 2): FILL IN the pins. A radio modem
//! on UART0 (GPIO 0, 1), encoders on GPIO 2, 3 and 4, 5, two motors behind a DRV8833 on GPIO 6 to
//! 9.
#![no_std]
#![no_main]

mod encoder;
mod robot;

use core::cell::Cell;
use embassy_executor::Spawner;
use embassy_futures::select::select3;
use embassy_rp::clocks::RoscRng;
use embassy_rp::gpio::{AnyPin, Input, Pull};
use embassy_rp::pwm::{Config as PwmConfig, Pwm};
use embassy_rp::uart::{BufferedInterruptHandler, BufferedUart, Config as UartConfig};
use embassy_rp::{Peri, Peripherals, bind_interrupts, peripherals::UART0, watchdog::Watchdog};
use embassy_time::Duration;

bind_interrupts!(struct Irqs {
    UART0_IRQ => BufferedInterruptHandler<UART0>;
});

async fn wire(p: Peripherals) -> Option<()> {
    let (mut to_send, mut heard, mut modem) = ([0; 256], [0; 512], UartConfig::default());
    modem.baudrate = 57_600;
    let uart = BufferedUart::new(p.UART0, p.PIN_0, p.PIN_1, Irqs, &mut to_send, &mut heard, modem);
    let (tx, rx) = uart.split();
    let (left, right) = (Cell::new(0), Cell::new(0));
    let channel = |pin: Peri<'static, AnyPin>| Input::new(pin, Pull::Up);
    let count_left = encoder::count(channel(p.PIN_2.into()), channel(p.PIN_3.into()), &left);
    let count_right = encoder::count(channel(p.PIN_4.into()), channel(p.PIN_5.into()), &right);
    // 150 MHz / 7500 = 20 kHz.
    let mut pwm = PwmConfig::default();
    pwm.top = 7_499;
    let (a, b) = Pwm::new_output_ab(p.PWM_SLICE3, p.PIN_6, p.PIN_7, pwm.clone()).split();
    let (c, d) = Pwm::new_output_ab(p.PWM_SLICE4, p.PIN_8, p.PIN_9, pwm).split();
    let motors = [a?, b?, c?, d?];
    let boot = RoscRng.next_u32() as u8;
    let period = Duration::from_millis(200);
    let mut watchdog = Watchdog::new(p.WATCHDOG);
    watchdog.start(period);
    let counts = || [left.get(), right.get()];
    let robot = robot::run(robot::Wiring { boot, radio: (rx, tx), motors, counts, pet: || watchdog.feed(period) });
    select3(robot, count_left, count_right).await;
    None
}

#[embassy_executor::main]
async fn main(_spawner: Spawner) {
    wire(embassy_rp::init(Default::default())).await;
    cortex_m::peripheral::SCB::sys_reset();
}

#[panic_handler] // Releases the motors and restarts.
fn panic(_: &core::panic::PanicInfo) -> ! {
    cortex_m::peripheral::SCB::sys_reset();
}
