//! Robots whose controllers run elsewhere: on emulated parts, or on boards.

use super::{Engine, Ground, HostLaw, Status, Tick};
use crate::scenario::Scenario;
use staya_controller::agent::{AnyInputs, Command, GuidanceSetup, OUTBOX, Safety, SafetySetup, Setup, Task};
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

/// The controllers that run elsewhere, and what they are made of.
pub(super) struct External {
    pub(super) controllers: Box<dyn ExternalController>,
    /// By number, rising.
    pub(super) robots: Vec<(usize, GuidanceSetup, SafetySetup)>,
}

impl<W, G, A> Engine<W, G, A>
where
    W: Ground,
    G: HostLaw,
    A: Safety<f32> + Send,
{
    /// The same with some of its robots' controllers outside of this process; before the first tick.
    #[must_use]
    pub fn with_external(mut self, scenario: &Scenario, controllers: Box<dyn ExternalController>) -> Self {
        let robots = controllers.robots().into_iter();
        let robots = robots.filter(|&index| index < self.robots.len());
        let robots = robots.map(|index| (index, scenario.guidance(index), scenario.safety(index)));
        let robots: Vec<_> = robots.collect();
        let indices: Vec<_> = robots.iter().map(|&(index, ..)| index).collect();
        self.external = Some(External { controllers, robots });
        for index in indices {
            self.restart(index, 0);
        }
        self
    }

    /// Lets those begin whose controllers are elsewhere.
    pub(super) fn send_out(&mut self) {
        let Some(external) = &mut self.external else {
            return;
        };
        let (tick, mut senses, mut heard) = (self.tick, W::Scratch::default(), Vec::new());
        for &(index, ..) in &external.robots {
            let computer = &self.computers[index];
            if tick < computer.down_until {
                continue;
            }
            let moment = Tick { tick, ground: &self.ground, radio: &self.radio };
            let inputs = moment.inputs(index, computer, &mut senses, &mut heard);
            let now = computer.now(tick, self.tick_us);
            external.controllers.send(index, tick, now, &inputs);
        }
    }

    /// Takes in what those decided. Returns how many frames they refused.
    pub(super) fn collect(&mut self) -> u64 {
        let Some(external) = &mut self.external else {
            return 0;
        };
        let mut rejected = 0;
        for &(index, ..) in &external.robots {
            let computer = &mut self.computers[index];
            if self.tick < computer.down_until {
                continue;
            }
            match external.controllers.collect(index) {
                Some(decision) => {
                    computer.outbox.extend_from_slice(&decision.outbox);
                    self.commands[index] = decision.command;
                    self.statuses[index] = decision.status;
                    rejected += u64::from(decision.rejected);
                }
                None => self.statuses[index].fall_silent(),
            }
        }
        rejected
    }
}
