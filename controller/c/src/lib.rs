//! Staya's controller for firmware in C and C++: what `include/staya.h` declares.
//!
//! An agent lives in the caller's memory ([`agent`]). It is made from a plain structure ([`setup`]), stepped with what the robot
//! senses and hears, and gives a command and bytes to send ([`io`]). Behaviours are there by themselves, too ([`alone`]).
//!
//! No function allocates, calls back or panics, and each takes null, misaligned and undersized memory: it gives a
//! [`status::StayaStatus`]. What no library can check is left to the caller, and stands in the header's introduction.
//!
//! `cargo rustc` with the profile `firmware` makes the library; `docs/c.md` has the steps. Then the panic handler calls a function
//! that exists nowhere, so that a program links only if no panic is reachable, as in `hil/firmware`.
#![cfg_attr(not(test), no_std)]
#![cfg_attr(
    not(test),
    deny(
        clippy::expect_used,
        clippy::indexing_slicing,
        clippy::integer_division_remainder_used,
        clippy::panic,
        clippy::unwrap_used
    )
)]

// Where panics unwind, which is in tests and debug builds on a host, the standard library brings what they need.
#[cfg(all(not(test), not(panic = "abort")))]
extern crate std;

pub mod agent;
pub mod alone;
pub mod choices;
pub mod io;
pub mod law;
pub mod layer;
mod memory;
pub mod parameter;
pub mod setup;
pub mod speech;
pub mod status;

#[cfg(test)]
mod tests;

use core::ffi::{CStr, c_char};

/// What the controller computes with.
#[cfg(not(feature = "fixed"))]
pub type Number = f32;
/// What the controller computes with.
#[cfg(feature = "fixed")]
pub type Number = staya_controller::scalar::Q16;

/// Neighbours that an agent knows.
pub const NEIGHBORS: usize = if cfg!(feature = "small") { 8 } else { 16 };
/// Half-planes (in space half-spaces) that ORCA reckons with.
pub const HALF_PLANES: usize = if cfg!(feature = "small") { 16 } else { 32 };
/// Obstacles that a step takes.
pub const OBSTACLES: usize = if cfg!(feature = "small") { 16 } else { 32 };

/// The library's version, such as "0.1.0".
#[unsafe(no_mangle)]
pub const extern "C" fn staya_version() -> *const c_char {
    const VERSION: &CStr = match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
        Ok(version) => version,
        Err(_) => c"",
    };
    VERSION.as_ptr()
}

/// In an optimised build the linker shows that nobody calls it: see `hil/firmware`.
#[cfg(all(not(test), panic = "abort"))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    #[cfg(not(debug_assertions))]
    {
        unsafe extern "C" {
            fn staya_panic_is_reachable() -> !;
        }
        // SAFETY: it exists nowhere, so what calls it does not link.
        unsafe { staya_panic_is_reachable() }
    }
    #[cfg(debug_assertions)]
    loop {
        core::hint::spin_loop();
    }
}
