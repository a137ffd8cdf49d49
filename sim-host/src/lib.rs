//! The library of the program `staya`: its commands, and how it finds the programs of other
//! commands.

pub mod cli;
pub mod page;
pub mod programs;
pub mod run;
pub mod terrain;
