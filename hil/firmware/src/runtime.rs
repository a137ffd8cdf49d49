//! Services of a part for its program. Call [`start`] once, before anything else. After
//! [`start_watchdog`] the main loop has to call [`feed_watchdog`].

use crate::{boots, log, part};
use core::fmt;

/// Description of the part and of this start.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// `stm32f405`, `nrf51` or `riscv32`.
    pub part: &'static str,
    /// Rate of [`ticks`], per second. In an emulator with `-icount shift=0`,
    /// `ticks * (1e9 / tick_hz)` is the number of instructions.
    pub tick_hz: u32,
    /// The processor's clock as far as known, hertz.
    pub clock_hz: u32,
    /// Whether the part is emulated.
    pub emulated: bool,
    /// Starts since power-up: 1 after power-up.
    pub boots: u32,
}

/// Sets up clocks, tick counter and UART. Without an oscillator the part runs slower.
pub fn start() -> Start {
    let boots = boots::count();
    let clocks = part::start();
    log::choose(part::is_emulated(), boots::is_mute());
    Start { part: part::NAME, tick_hz: clocks.tick_hz, clock_hz: clocks.clock_hz, emulated: part::is_emulated(), boots }
}

/// Tick counter, [`Start::tick_hz`] per second; wraps, at 168 MHz after 25 s. Use differences only.
#[must_use]
pub fn ticks() -> u32 {
    part::ticks()
}

/// Takes the oldest received byte.
#[must_use]
pub fn receive() -> Option<u8> {
    let byte = part::RECEIVED.pop();
    if byte.is_none() {
        part::listen();
    }
    byte
}

/// Received bytes that were lost because they were not taken in time.
#[must_use]
pub fn lost() -> u32 {
    part::RECEIVED.lost()
}

/// Sends bytes over the UART, until it has the last one. Drops bytes that it does not take in time.
pub fn send(bytes: &[u8]) {
    for &byte in bytes {
        if !part::send(byte) {
            return;
        }
    }
}

/// Sleeps until an interrupt (several times per second), unless a byte is waiting.
pub fn sleep() {
    part::sleep_unless(|| !part::RECEIVED.is_empty());
}

/// Starts the watchdog for good: the part resets after about four seconds without
/// [`feed_watchdog`]. The emulator has none.
pub fn start_watchdog() {
    part::start_watchdog();
}

/// Tells the watchdog that the main loop is running.
pub fn feed_watchdog() {
    part::feed_watchdog();
}

/// Prints text: in the emulator over semihosting, on a board over RTT. Whole lines are cheapest.
pub fn print(text: fmt::Arguments<'_>) {
    let mut out = log::Text::new();
    let _ = fmt::write(&mut out, text);
    out.flush();
}

/// Ends the emulator with this exit code. A board sleeps forever.
pub fn exit(code: i32) -> ! {
    if part::is_emulated() && !boots::is_mute() {
        semihosting::process::exit(code);
    }
    loop {
        part::sleep_unless(|| false);
    }
}

/// Resets the part after the last byte has been sent. The count of starts is kept.
pub fn reset() -> ! {
    part::flush();
    part::reset()
}

/// Starts since power-up, including the current one.
#[must_use]
pub fn boots() -> u32 {
    boots::current()
}
