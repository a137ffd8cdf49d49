//! Robots on devices: starts emulators, opens serial ports, steps all of them in lockstep and compares each with its shadow, the same
//! robot in this process. Read [`fleet::Fleet`] first.
//!
//! ```no_run
//! use staya_runner::{Answer, Fleet, Options, Order};
//! # fn orders() -> Vec<Order> { Vec::new() }
//! # use staya_controller::agent::{Inputs, Pose};
//! # fn inputs(_: usize) -> Inputs<'static, f32> {
//! #     Inputs { pose: Pose::default(), cell: None, window: None, surroundings: None, inbox: &[] }
//! # }
//! # fn main() -> Result<(), staya_runner::FleetError> {
//! let mut fleet = Fleet::start(orders(), Options::new("target/firmware".into()))?;
//! for tick in 0..1000 {
//!     let now = staya_controller::time::Instant::from_micros(tick * 100_000);
//!     for index in 0..fleet.len() {
//!         fleet.send(index, tick, now, &inputs(index));
//!     }
//!     // While the devices decide, the host steps the other robots.
//!     for answer in fleet.collect() {
//!         match answer {
//!             Answer::Decided(report) => println!("{:?}", report.outputs.command),
//!             Answer::Down => println!("stands"),
//!             Answer::Mismatch(mismatch) => println!("{mismatch}"),
//!             Answer::Failed(error) => return Err(error),
//!         }
//!     }
//! }
//! # Ok(())
//! # }
//! ```

pub mod channel;
pub mod device;
mod emulator;
pub mod fleet;
mod line;
mod mismatch;
mod statistics;
mod unit;

pub use channel::{Channel, OpenError};
pub use device::{Device, DeviceError, Part};
pub use fleet::{Answer, Fleet, FleetError, Options, Order, Reset, Trouble};
pub use line::LineFaults;
pub use mismatch::Mismatch;
pub use statistics::{Spread, Statistics};
