//! Cross-crate tests, one module per subject.

mod cases;
mod crossing;
mod damaged;
mod dead_members;
mod duplicates;
mod fades;
mod faults;
mod flocks;
mod formation_plane;
mod formats;
mod frames;
mod golden;
mod matrix;
mod movingai;
mod negotiation;
mod parameters;
mod printed;
mod programs;
mod scenes;
mod threads;
