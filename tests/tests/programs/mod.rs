//! The programs of Staya at the command line.

mod checkpoint;
mod crowd;
mod errors;
mod figures;
mod names;
mod orca;
mod recordings;
mod reported;
mod run;
mod shell;
mod sweep;
