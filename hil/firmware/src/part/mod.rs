//! One file per part, with the same functions.

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

#[derive(Clone, Copy)]
pub struct Clocks {
    pub clock_hz: u32,
    /// Rate of [`ticks`].
    pub tick_hz: u32,
}

/// Baud rate, from `STAYA_BAUD` at build time.
#[cfg(any(part = "stm32f405", part = "nrf51"))]
const BAUD: u32 = number(env!("STAYA_BAUD"));

/// Parses a number that the build script has checked.
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
