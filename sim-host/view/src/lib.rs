//! Runs to look at: what a page in the browser is told, live or from a recording. `PROTOCOL.md` says how.

pub mod frame;
pub mod mcap;
pub mod pace;
pub mod page;
pub mod playback;
pub mod recording;
pub mod scene;
pub mod server;
pub mod session;
pub mod watch;
