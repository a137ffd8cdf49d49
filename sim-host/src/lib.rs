#![doc = include_str!("../README.md")]

pub mod cli;
pub mod page;
pub mod programs;
pub mod run;
pub mod terrain;
