//! Runs robots on devices: starts emulators, opens serial ports, steps all devices in lockstep and
//! compares each with its shadow, the same robot in this process. Start with [`Fleet`].
//!
//! `tests/fleet.rs` steps fleets in the same way:
//!
//! ```ignore
//! use staya_runner::{Answer, Fleet, Options, DeviceConfig};
//! # fn configs() -> Vec<DeviceConfig> { Vec::new() }
//! # use staya_controller::agent::{AnyInputs, InPlane, Inputs, KinematicState};
//! # fn inputs(_: usize) -> AnyInputs<'static, f32> {
//! #     let plane = InPlane { max_speed_mps: 1.0, obstacles: &[] };
//! #     Inputs { state: KinematicState::default(), surroundings: plane.into(), inbox: &[] }
//! # }
//! # fn main() -> Result<(), staya_runner::FleetError> {
//! let mut fleet = Fleet::start(configs(), Options::new("target/firmware".into()))?;
//! for tick in 0..1000 {
//!     let now = staya_controller::time::Instant::from_micros(tick * 100_000);
//!     for index in 0..fleet.len() {
//!         fleet.send(index, tick, now, &inputs(index));
//!     }
//!     // While the devices decide, the host can step other robots.
//!     for answer in fleet.collect() {
//!         match answer {
//!             Answer::Decided(result) => println!("{:?}", result.outputs.command),
//!             Answer::Down => println!("down"),
//!             Answer::Mismatch(mismatch) => println!("{mismatch}"),
//!             Answer::Failed(error) => return Err(error),
//!         }
//!     }
//! }
//! # Ok(())
//! # }
//! ```

mod answer;
mod channel;
mod config;
mod device;
mod emulator;
mod fleet;
mod line;
mod mismatch;
mod note;
mod part;
mod printable;
mod start;
mod statistics;
mod unit;

pub use answer::{Answer, Cause, FleetError};
pub use channel::{Channel, OpenError};
pub use config::{DeviceConfig, Options, Reset, Shadow};
pub use device::{Device, DeviceError};
pub use emulator::{EmulatorError, find_emulator};
pub use fleet::Fleet;
pub use line::LineFaults;
pub use mismatch::Mismatch;
pub use note::{Note, NoteError};
pub use part::{Machine, Part};
pub use statistics::{Load, Spread, Statistics};
