//! The programs of Staya at the command line.

mod checkpoint;
mod crossing;
mod crowd;
mod errors;
mod orca;
mod recordings;
mod run;
mod shell;
mod sweep;
