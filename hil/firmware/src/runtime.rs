//! What a program of the firmware may ask of the part it runs on.
//!
//! Read this first: [`start`] once, then anything. The watchdog runs only after [`start_watchdog`]; from then on
//! the main loop has to call [`feed_watchdog`]; no interrupt ever does.

use crate::{boots, log, part};
use core::fmt;

/// What the part is and how it started.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// `stm32f405`, `nrf51` or `riscv32`.
    pub part: &'static str,
    /// Ticks of [`ticks`] per second. Emulated with `-icount shift=0`, where one instruction takes
    /// one nanosecond, `ticks * (1e9 / tick_hz)` is the number of instructions.
    pub tick_hz: u32,
    /// The processor's clock in hertz, as far as is known.
    pub clock_hz: u32,
    /// Whether an emulator runs it.
    pub emulated: bool,
    /// Starts since power-up, this one included: 1 after power-up.
    pub boots: u32,
}

/// Sets up clocks, the tick counter and the UART. Waits for oscillators are bounded: without them
/// the part runs slower, and [`Start::clock_hz`] says so.
pub fn start() -> Start {
    let boots = boots::count();
    let clocks = part::start();
    log::choose(part::is_emulated(), boots::is_mute());
    Start { part: part::NAME, tick_hz: clocks.tick_hz, clock_hz: clocks.clock_hz, emulated: part::is_emulated(), boots }
}

/// A counter that goes up by [`Start::tick_hz`] per second and wraps. Differences count: at
/// 168 MHz it wraps after 25 s.
#[must_use]
pub fn ticks() -> u32 {
    part::ticks()
}

/// The oldest byte that the UART has received and nobody has taken.
#[must_use]
pub fn receive() -> Option<u8> {
    let byte = part::RECEIVED.pop();
    if byte.is_none() {
        part::listen();
    }
    byte
}

/// Bytes that were received and lost since the start, because nobody took them in time.
#[must_use]
pub fn lost() -> u32 {
    part::RECEIVED.lost()
}

/// Sends bytes over the UART; returns when the last one is handed to it, or drops what the UART
/// does not take within a bounded wait.
pub fn send(bytes: &[u8]) {
    for &byte in bytes {
        if !part::send(byte) {
            return;
        }
    }
}

/// Sleeps until an interrupt, unless there is something to receive. The tick counter wakes the
/// part several times a second, so that the main loop can feed the watchdog.
pub fn sleep() {
    part::sleep_unless(|| !part::RECEIVED.is_empty());
}

/// Starts the watchdog: without [`feed_watchdog`] for about four seconds the part resets. Nothing
/// stops it again. The emulator has none.
pub fn start_watchdog() {
    part::start_watchdog();
}

/// Says that the main loop is alive.
pub fn feed_watchdog() {
    part::feed_watchdog();
}

/// Prints text: in the emulator over semihosting, on a board over RTT. A line at a time is cheapest.
pub fn print(text: fmt::Arguments<'_>) {
    let mut out = log::Text::new();
    // Text never fails; what cannot be written is dropped there.
    let _ = fmt::write(&mut out, text);
    out.flush();
}

/// Ends the emulator with this exit code. On a board it sleeps for good.
pub fn exit(code: i32) -> ! {
    if part::is_emulated() && !boots::is_mute() {
        semihosting::process::exit(code);
    }
    loop {
        part::sleep_unless(|| false);
    }
}

/// Starts again from the reset vector, after what was sent has left. RAM that counts starts is kept.
pub fn reset() -> ! {
    part::flush();
    part::reset()
}

/// Starts since power-up, this one included.
#[must_use]
pub fn boots() -> u32 {
    boots::current()
}
