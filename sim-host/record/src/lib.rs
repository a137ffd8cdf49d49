#![doc = include_str!("../README.md")]

pub mod frame;
pub mod page;
pub mod recording;
pub mod scene;
