//! Wiring of my-swarm's robot on an STM32F405: FILL IN the pins. A radio modem on USART1 (PA9,
//! PA10), encoders on TIM3 (PA6, PA7) and TIM4 (PB6, PB7), two motors behind a DRV8833 on TIM8 (PC6
//! to PC9).
#![no_std]
#![no_main]

mod robot;

use embassy_executor::Spawner;
use embassy_stm32::timer::{qei::Qei, simple_pwm::PwmPin, simple_pwm::SimplePwm};
use embassy_stm32::usart::{BufferedInterruptHandler, BufferedUart, Config as UartConfig};
use embassy_stm32::{Config, Peripherals, bind_interrupts, gpio::OutputType::PushPull, peripherals};
use embassy_stm32::{rcc::*, rng, time::Hertz, wdg::IndependentWatchdog};

bind_interrupts!(struct Irqs {
    USART1 => BufferedInterruptHandler<peripherals::USART1>;
    RNG => rng::InterruptHandler<peripherals::RNG>;
});

async fn wire(p: Peripherals) -> Option<()> {
    let (mut to_send, mut heard, mut modem) = ([0; 256], [0; 512], UartConfig::default());
    modem.baudrate = 57_600;
    let uart = BufferedUart::new(p.USART1, p.PA10, p.PA9, &mut to_send, &mut heard, Irqs, modem);
    let (tx, rx) = uart.ok()?.split();
    let left = Qei::new(p.TIM3, p.PA6, p.PA7, Default::default());
    let right = Qei::new(p.TIM4, p.PB6, p.PB7, Default::default());
    let (a, b) = (Some(PwmPin::new(p.PC6, PushPull)), Some(PwmPin::new(p.PC7, PushPull)));
    let (c, d) = (Some(PwmPin::new(p.PC8, PushPull)), Some(PwmPin::new(p.PC9, PushPull)));
    let pwm = SimplePwm::new(p.TIM8, a, b, c, d, Hertz(20_000), Default::default()).split();
    let mut motors = [pwm.ch1, pwm.ch2, pwm.ch3, pwm.ch4];
    motors.iter_mut().for_each(|motor| motor.enable());
    let boot = rng::Rng::new(p.RNG, Irqs).next_u32() as u8;
    let mut watchdog = IndependentWatchdog::new(p.IWDG, 200_000);
    watchdog.unleash();
    let counts = || [left.count(), right.count()];
    robot::run(robot::Wiring { boot, radio: (rx, tx), motors, counts, pet: || watchdog.pet() }).await.map(|_| ())
}

#[embassy_executor::main]
async fn main(_spawner: Spawner) {
    let mut config = Config::default();
    // 16 MHz / 8 * 168: half of it for the core, a seventh (48 MHz) for random numbers.
    let (prediv, mul, divp, divq) = (PllPreDiv::DIV8, PllMul::MUL168, PllPDiv::DIV2, PllQDiv::DIV7);
    config.rcc.pll = Some(Pll { prediv, mul, divp: Some(divp), divq: Some(divq), divr: None });
    (config.rcc.pll_src, config.rcc.sys) = (PllSource::HSI, Sysclk::PLL1_P);
    (config.rcc.apb1_pre, config.rcc.apb2_pre) = (APBPrescaler::DIV4, APBPrescaler::DIV2);
    wire(embassy_stm32::init(config)).await;
    cortex_m::peripheral::SCB::sys_reset();
}

#[panic_handler] // Releases the motors and restarts.
fn panic(_: &core::panic::PanicInfo) -> ! {
    cortex_m::peripheral::SCB::sys_reset();
}
