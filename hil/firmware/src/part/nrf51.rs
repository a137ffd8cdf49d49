//! nRF51822 of the micro:bit (version 1): UART0 on P0.24 (TX) and P0.25 (RX).
//!
//! 16 MHz from the crystal, or else from the internal oscillator. Without a SysTick, TIMER0 counts
//! ticks. Sections: Nordic's nRF51 Series Reference Manual 3.0.

use super::{BAUD, Clocks};
use crate::ring::Ring;
use cortex_m::peripheral::{NVIC, SCB};
use nrf_pac::{CLOCK, FICR, GPIO, Interrupt, TIMER0, UART0, WDT, gpio, timer, uart, wdt};

pub const NAME: &str = "nrf51";
/// 22 ms at 115200 baud.
pub static RECEIVED: Ring<256> = Ring::new();

const HZ: u32 = 16_000_000;
const TX_PIN: usize = 24;
const RX_PIN: usize = 25;
/// Reads of a status flag before an oscillator counts as missing: tens of milliseconds.
const PATIENCE: u32 = 50_000;
/// Two seconds per byte: the host of an emulator may read slowly.
const SEND_PATIENCE: u32 = 2 * HZ;
/// Channels of TIMER0: for [`ticks`], and to wake the main loop.
const NOW: usize = 0;
const WAKE: usize = 1;
/// 0.26 s.
const WAKE_EVERY: u32 = 1 << 22;
/// Section 29.4: the most bytes taken in one interrupt.
const FIFO: usize = 6;

pub fn start() -> Clocks {
    // The internal oscillator is accurate to 1 % at best; a UART needs the crystal.
    CLOCK.tasks_hfclkstart().write_value(1);
    let _ = (0..PATIENCE).any(|_| CLOCK.events_hfclkstarted().read() != 0);
    timer0();
    uart0();
    Clocks { clock_hz: HZ, tick_hz: HZ }
}

/// QEMU has a constant device number, one word after Nordic's registers, which hold random ones.
pub fn is_emulated() -> bool {
    FICR.deviceid(0).read() == 3 && FICR.deviceid(1).read() == 0x1234_5678
}

fn timer0() {
    TIMER0.mode().write(|mode| mode.set_mode(timer::vals::Mode::Timer));
    TIMER0.bitmode().write(|mode| mode.set_bitmode(timer::vals::Bitmode::_32bit));
    TIMER0.prescaler().write(|by| by.set_prescaler(0));
    TIMER0.tasks_clear().write_value(1);
    TIMER0.cc(WAKE).write_value(WAKE_EVERY);
    TIMER0.intenset().write(|int| int.set_compare(WAKE, true));
    TIMER0.tasks_start().write_value(1);
    // SAFETY: the handler is below and shares no memory.
    unsafe { NVIC::unmask(Interrupt::TIMER0) };
}

// SAFETY: nrf-pac's interrupt table has this name for it; a handler without arguments.
#[unsafe(export_name = "TIMER0")]
extern "C" fn on_timer() {
    TIMER0.events_compare(WAKE).write_value(0);
    let next = TIMER0.cc(WAKE).read().wrapping_add(WAKE_EVERY);
    TIMER0.cc(WAKE).write_value(next);
}

pub fn ticks() -> u32 {
    TIMER0.tasks_capture(NOW).write_value(1);
    TIMER0.cc(NOW).read()
}

fn uart0() {
    // The line must idle high even before the UART drives the pin.
    GPIO.outset().write(|pins| pins.set_pin(TX_PIN, true));
    GPIO.pin_cnf(TX_PIN).write(|pin| pin.set_dir(gpio::vals::Dir::Output));
    // An open input would receive noise.
    GPIO.pin_cnf(RX_PIN).write(|pin| pin.set_pull(gpio::vals::Pull::Pullup));
    UART0.pseltxd().write_value(TX_PIN as u32);
    UART0.pselrxd().write_value(RX_PIN as u32);
    UART0.baudrate().write(|baud| {
        // A fraction of 2^32 of 16 MHz, in steps of 2^12: the values of the manual's table.
        let fraction = (((BAUD as u64) << 32) / HZ as u64) as u32;
        let rounded = fraction.wrapping_add(0x800) & 0xFFFF_F000;
        baud.set_baudrate(uart::vals::Baudrate::from_bits(rounded));
    });
    UART0.enable().write(|enable| enable.set_enable(uart::vals::Enable::Enabled));
    UART0.events_rxdrdy().write_value(0);
    UART0.events_txdrdy().write_value(0);
    UART0.intenset().write(|int| {
        int.set_rxdrdy(true);
        int.set_error(true);
    });
    UART0.tasks_starttx().write_value(1);
    UART0.tasks_startrx().write_value(1);
    // SAFETY: the handler is below and shares only the ring.
    unsafe { NVIC::unmask(Interrupt::UART0) };
}

/// Wakes [`send`] and empties the FIFO. The event is cleared first: later bytes set it.
// SAFETY: nrf-pac's interrupt table has this name for it; a handler without arguments.
#[unsafe(export_name = "UART0")]
extern "C" fn on_uart() {
    if UART0.events_txdrdy().read() != 0 {
        UART0.intenclr().write(|int| int.set_txdrdy(true));
    }
    for _ in 0..FIFO {
        if UART0.events_rxdrdy().read() == 0 {
            break;
        }
        if !RECEIVED.has_room() {
            // The emulator refills the FIFO at once, which would starve the main loop.
            UART0.intenclr().write(|int| int.set_rxdrdy(true));
            break;
        }
        UART0.events_rxdrdy().write_value(0);
        RECEIVED.push(UART0.rxd().read().rxd());
    }
    if UART0.events_error().read() != 0 {
        UART0.events_error().write_value(0);
        let source = UART0.errorsrc().read();
        UART0.errorsrc().write_value(source); // ones clear
        if source.overrun() {
            RECEIVED.lose();
        }
    }
}

/// The main loop has taken all bytes: resumes reception if the ring was full.
pub fn listen() {
    UART0.intenset().write(|int| int.set_rxdrdy(true));
}

/// Sleeps until the byte has left: the event signals completion, not free space.
pub fn send(byte: u8) -> bool {
    let began = ticks();
    let is_sent = || UART0.events_txdrdy().read() != 0;
    UART0.events_txdrdy().write_value(0);
    UART0.txd().write(|txd| txd.set_txd(byte));
    while !is_sent() {
        if ticks().wrapping_sub(began) > SEND_PATIENCE {
            return false;
        }
        UART0.intenset().write(|int| int.set_txdrdy(true));
        sleep_unless(is_sent);
    }
    true
}

/// [`send`] returns when nothing is left to send.
pub fn flush() {}

/// With interrupts masked, an interrupt after the check still ends the wait.
pub fn sleep_unless(is_due: impl FnOnce() -> bool) {
    cortex_m::interrupt::free(|_| {
        if !is_due() {
            cortex_m::asm::wfi();
        }
    });
}

/// Four seconds of the 32 kHz clock; paused while a debugger halts the core.
pub fn start_watchdog() {
    WDT.config().write(|config| {
        config.set_sleep(wdt::vals::Sleep::Run);
        config.set_halt(wdt::vals::Halt::Pause);
    });
    WDT.crv().write_value(4 * 32_768 - 1);
    WDT.rren().write(|enable| enable.set_rr(0, true));
    WDT.tasks_start().write_value(1);
}

pub fn feed_watchdog() {
    WDT.rr(0).write(|rr| rr.set_rr(wdt::vals::Rr::Reload));
}

pub fn reset() -> ! {
    SCB::sys_reset()
}
