//! MAVLink at the edge of the host: where frames come from and go to. What robots and autopilots say in them is not known here.
//!
//! [`Endpoint`] names a line as other MAVLink programs do, [`Lines`] opens any number of them and gives whole frames, [`Tlog`] keeps them;
//! [`geo`] is where metres become degrees.

mod endpoint;
pub mod geo;
mod lines;
mod stream;
mod tlog;
mod udp;

pub use endpoint::{Endpoint, EndpointError};
pub use lines::{Counts, Lines, OpenError, Peer, Received};
pub use tlog::{Tlog, TlogError};
