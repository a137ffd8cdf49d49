//! Conversions shared by several tables.

pub(super) use super::read::short;
use staya_controller::time::Duration;

pub(super) fn micros(seconds: f64) -> u32 {
    libm::round(seconds * 1e6) as u32
}

pub(super) fn duration(seconds: f64) -> Duration {
    Duration::from_micros(libm::round(seconds * 1e6) as i32)
}

/// First tick that does not begin before `at_s`. Exact for times that are multiples of a tick.
pub(super) fn tick(at_s: f64, tick_s: f64) -> u32 {
    let tick_us = f64::from(micros(tick_s).max(1));
    libm::ceil(libm::round(at_s * 1e6) / tick_us) as u32
}
