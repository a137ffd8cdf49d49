//! Staya's controller for firmware in C and C++, as declared in `include/staya.h`.
//!
//! An agent lives in the caller's memory ([`agent`]). It is created from a plain structure
//! ([`setup`]) and stepped with sensor values and received bytes; each step returns a command and
//! bytes to send ([`io`]). Behaviours are also available without an agent ([`alone`]).
//!
//! No function allocates, calls back or panics. Null, misaligned and undersized memory is rejected
//! with a [`status::StayaStatus`]; the header's introduction lists the caller's obligations.
//!
//! `docs/c.md` has the steps to build the library with the profile `firmware`. There the panic
//! handler calls a function that does not exist, so a program links only if no panic is reachable.
#![cfg_attr(not(test), no_std)]
#![expect(clippy::missing_safety_doc, reason = "the header's introduction has the conditions of all functions")]
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

// The standard library handles unwinding panics in tests and debug builds on a host.
#[cfg(all(not(test), not(panic = "abort")))]
extern crate std;

pub mod agent;
pub mod alone;
pub mod choices;
pub mod chosen;
pub mod external;
pub mod io;
pub mod law;
mod memory;
mod one_of;
pub mod parameter;
pub mod row;
pub mod setup;
pub mod speech;
pub mod status;

#[cfg(test)]
mod tests;

use core::ffi::{CStr, c_char};

/// The controller's scalar type.
#[cfg(not(feature = "fixed"))]
pub type Number = f32;
/// The controller's scalar type.
#[cfg(feature = "fixed")]
pub type Number = staya_controller::scalar::Q16;

/// Maximum number of neighbours that an agent tracks.
pub const NEIGHBORS: usize = if cfg!(feature = "small") { 8 } else { 16 };
/// Maximum number of ORCA's half-planes (in space half-spaces).
pub const HALF_PLANES: usize = if cfg!(feature = "small") { 16 } else { 32 };
/// Any safety layer of this build.
pub type Layer = staya_controller::agent::AnySafety<Number, HALF_PLANES>;
/// Maximum number of obstacles in a step.
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

/// In an optimised build the linker proves that this is never called: see `hil/firmware`.
#[cfg(all(not(test), panic = "abort"))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    #[cfg(not(debug_assertions))]
    {
        unsafe extern "C" {
            fn staya_panic_is_reachable() -> !;
        }
        // SAFETY: the function does not exist, so a program that calls it does not link.
        unsafe { staya_panic_is_reachable() }
    }
    #[cfg(debug_assertions)]
    loop {
        core::hint::spin_loop();
    }
}
