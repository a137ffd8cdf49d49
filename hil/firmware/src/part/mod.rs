//! The parts: each file sets up one and offers the same names.

#[cfg(part = "nrf51")]
mod nrf51;
#[cfg(part = "nrf51")]
pub use nrf51::*;

#[cfg(part = "riscv32")]
mod riscv32;
#[cfg(part = "riscv32")]
pub use riscv32::*;

#[cfg(part = "stm32f405")]
mod stm32f405;
#[cfg(part = "stm32f405")]
pub use stm32f405::*;

#[cfg(not(any(part = "stm32f405", part = "nrf51", part = "riscv32")))]
compile_error!("no part has this target triple: see the table in src/lib.rs");

/// What the clocks came to.
#[derive(Clone, Copy)]
pub struct Clocks {
    /// Of the processor.
    pub clock_hz: u32,
    /// Of [`ticks`].
    pub tick_hz: u32,
}

/// Bits per second, from `STAYA_BAUD` when the firmware is built.
#[cfg(any(part = "stm32f405", part = "nrf51"))]
const BAUD: u32 = number(env!("STAYA_BAUD"));

/// A decimal number that the build script has checked.
#[cfg(any(part = "stm32f405", part = "nrf51"))]
const fn number(text: &str) -> u32 {
    let mut rest = text.as_bytes();
    let mut value = 0;
    while let [digit, others @ ..] = rest {
        value = value * 10 + (*digit - b'0') as u32;
        rest = others;
    }
    value
}
