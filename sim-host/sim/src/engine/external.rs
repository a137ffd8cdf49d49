//! Robots whose controllers run elsewhere: on emulated parts, or on boards.

use super::Status;
use staya_controller::agent::{AnyInputs, Command, OUTBOX, Setup, Task};
use staya_controller::time::Instant;

/// Controllers external of this process. Robots are numbered as in the scenario.
///
/// A tick has three calls: [`ExternalController::send`] for each robot that is up, then the engine steps its own robots, then
/// [`ExternalController::collect`], so that all work at the same time. What goes wrong is the implementation's to keep and its
/// owner's to ask for: the swarm carries on without the robot.
pub trait ExternalController: Send {
    /// The robots whose controllers run elsewhere, rising.
    fn robots(&self) -> Vec<usize>;

    /// Makes the controller of robot `index` anew; `setup.agent.boot` counts its starts.
    fn start(&mut self, index: usize, setup: Setup, task: Task);

    /// Whether the controller of robot `index` has lost its state since it was last asked, and waits to be made anew. Asked
    /// once at the beginning of each tick.
    fn has_restarted(&mut self, index: usize) -> bool;

    /// Lets robot `index` begin its step.
    fn send(&mut self, index: usize, tick: u32, now: Instant, inputs: &AnyInputs<'_, f32>);

    /// What the robot decided that was sent last; `None` when its controller is not there.
    fn collect(&mut self, index: usize) -> Option<Decision>;
}

/// What a controller elsewhere decided.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    /// For its body.
    pub command: Command<f32>,
    /// For the radio.
    pub outbox: heapless::Vec<u8, OUTBOX>,
    /// Frames that it refused.
    pub rejected: u16,
    /// What it is doing.
    pub status: Status,
}
