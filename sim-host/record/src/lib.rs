#![doc = include_str!("../README.md")]

pub mod claims;
pub mod frame;
pub mod mind;
pub mod page;
pub mod recording;
pub mod scene;
