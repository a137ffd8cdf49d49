//! The programs of Staya as a user or a script meets them.

mod checkpoint;
mod crossing;
mod crowd;
mod orca;
mod recordings;
mod run;
mod shell;
mod sweep;
