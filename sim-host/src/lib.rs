//! The commands of the program `staya`, and the search for the programs of other commands.

pub mod cli;
pub mod page;
pub mod programs;
pub mod run;
pub mod terrain;
