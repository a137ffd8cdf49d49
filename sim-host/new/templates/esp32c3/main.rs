//! Wiring of my-swarm's robot on an ESP32-C3: FILL IN the pins. A radio modem on UART1 (GPIO 4, 5),
//! encoders on GPIO 6, 7 and 0, 1, two motors behind a DRV8833 on GPIO 2, 3, 10 and 18.
#![no_std]
#![no_main]

mod encoder;
mod robot;

use core::cell::Cell;
use embassy_executor::Spawner;
use embassy_futures::select::select3;
use esp_hal::gpio::{AnyPin, DriveMode, Input, InputConfig, Pull};
use esp_hal::ledc::channel::{self, Channel, ChannelIFace};
use esp_hal::ledc::timer::{self, Timer, TimerIFace};
use esp_hal::ledc::{LSGlobalClkSource, Ledc, LowSpeed};
use esp_hal::peripherals::Peripherals;
use esp_hal::timer::timg::TimerGroup;
use esp_hal::uart::{Config as UartConfig, Uart};
use esp_hal::{rng::Rng, time::Rate};
use static_cell::StaticCell;

esp_bootloader_esp_idf::esp_app_desc!();

async fn wire(p: Peripherals) -> Option<()> {
    let timers = TimerGroup::new(p.TIMG0);
    let mut watchdog = timers.wdt;
    esp_rtos::start(timers.timer0, p.FROM_CPU_INTR0);
    let modem = UartConfig::default().with_baudrate(57_600);
    let uart = Uart::new(p.UART1, modem).ok()?.with_rx(p.GPIO4).with_tx(p.GPIO5).into_async();
    let radio = uart.split();
    let (left, right) = (Cell::new(0), Cell::new(0));
    let line = |pin: AnyPin<'static>| Input::new(pin, InputConfig::default().with_pull(Pull::Up));
    let count_left = encoder::count(line(p.GPIO6.into()), line(p.GPIO7.into()), &left);
    let count_right = encoder::count(line(p.GPIO0.into()), line(p.GPIO1.into()), &right);
    let mut ledc = Ledc::new(p.LEDC);
    ledc.set_global_slow_clock(LSGlobalClkSource::APBClk);
    let mut clock = ledc.timer::<LowSpeed>(timer::Number::Timer0);
    clock
        .configure(timer::config::Config {
            duty: timer::config::Duty::Duty10Bit,
            clock_source: timer::LSClockSource::APBClk,
            frequency: Rate::from_khz(20),
        })
        .ok()?;
    // The channels need a static clock.
    static CLOCK: StaticCell<Timer<'static, LowSpeed>> = StaticCell::new();
    let clock = &*CLOCK.init(clock);
    let motor = |mut channel: Channel<'static, LowSpeed>| {
        let config = channel::config::Config { timer: clock, duty_pct: 0, drive_mode: DriveMode::PushPull };
        channel.configure(config).ok()?;
        Some(channel)
    };
    let motors = [
        motor(ledc.channel(channel::Number::Channel0, p.GPIO2))?,
        motor(ledc.channel(channel::Number::Channel1, p.GPIO3))?,
        motor(ledc.channel(channel::Number::Channel2, p.GPIO10))?,
        motor(ledc.channel(channel::Number::Channel3, p.GPIO18))?,
    ];
    let boot = Rng::new().random() as u8;
    watchdog.set_timeout(esp_hal::timer::timg::MwdtStage::Stage0, esp_hal::time::Duration::from_millis(200));
    watchdog.enable();
    let counts = || [left.get(), right.get()];
    let robot = robot::run(robot::Wiring { boot, radio, motors, counts, pet: || watchdog.feed() });
    select3(robot, count_left, count_right).await;
    None
}

#[esp_rtos::main]
async fn main(_spawner: Spawner) {
    wire(esp_hal::init(esp_hal::Config::default())).await;
    esp_hal::system::software_reset()
}

#[panic_handler] // Releases the motors and restarts.
fn panic(_: &core::panic::PanicInfo) -> ! {
    esp_hal::system::software_reset()
}
