#![doc = include_str!("../README.md")]

pub mod cli;
mod command;
pub mod mcap;
mod observers;
pub mod pace;
pub mod playback;
mod series;
pub mod server;
pub mod session;
pub mod watch;

use staya_record::{frame, mind, page, recording, scene};
