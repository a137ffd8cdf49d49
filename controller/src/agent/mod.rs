//! The one composer of behaviours: [`Agent::step`].

mod io;

pub use io::{CellState, Command, EVENTS, Event, Inputs, OUTBOX, Outputs, Pose};
