#![doc = include_str!("../README.md")]

pub mod cli;
mod command;
mod mcap;
mod observers;
mod pace;
mod playback;
mod series;
pub mod server;
mod session;
pub mod watch;

use staya_record::{frame, mind, page, recording, scene};
