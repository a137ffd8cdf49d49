//! The interface to a transmitter outside the swarm.

use super::state::{Reader, StateError};
use crate::world::plane::Disc;
use staya_controller::robot::RobotId;
use staya_controller::wire::Ring;

/// A transmitter outside the swarm.
pub trait Transmitter: Send + Sync {
    /// Id at the radio.
    fn id(&self) -> RobotId;

    /// Position of its antenna, metres; `intruders` are all foreign bodies.
    fn place_m(&self, intruders: &[Disc]) -> [f64; 3];

    /// Receives frames and prepares its own.
    fn act(&mut self, tick: u32, inbox: &[u8], intruders: &[Disc]);

    /// Frames of the last [`Transmitter::act`].
    fn outbox(&self) -> &[u8];

    /// The robot that it captures before it acts at `tick`.
    fn captures(&self, _tick: u32) -> Option<RobotId> {
        None
    }

    /// Takes the keys of the captured robot.
    fn take(&mut self, _ring: &Ring) {}

    /// Appends its mutable state.
    fn save(&self, bytes: &mut Vec<u8>);

    /// Restores the bytes of [`Transmitter::save`].
    ///
    /// # Errors
    /// They cannot be decoded.
    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), StateError>;
}
