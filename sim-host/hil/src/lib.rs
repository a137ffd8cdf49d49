//! Hardware in the loop: robots of a scenario run as firmware on emulated microcontrollers or
//! boards, in lockstep with the others. Use [`run`] for Staya's guidance laws and [`Own`] for your
//! own law.
//!
//! A complete program for your own law, with the arguments of `staya hil`:
//!
//! ```ignore
//! #[derive(Clone, Debug, Serialize, Deserialize)]
//! struct East {
//!     speed_mps: f32,
//! }
//! fn main() -> std::process::ExitCode {
//!     staya_hil::Own::new(staya_hil::package!(), |_robot| East { speed_mps: 0.5 }).main()
//! }
//! ```
//!
//! Its firmware, in the same package, is `staya_firmware::lockstep!(East);`. See docs/project.md.

pub mod cli;
mod command;
mod devices;
mod firmware;
mod mixed;
mod options;
mod own;
mod pace;
mod run;
mod summary;
mod swarm;

pub use options::DeviceArgs;
pub use own::{Own, Package};
pub use run::{HilArgs, run};
