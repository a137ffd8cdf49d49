//! Robots whose controllers run outside the simulator: on emulated or real microcontrollers.

use super::{Engine, Senses, Status, Tick};
use crate::scenario::Scenario;
use staya_controller::agent::{AnyInputs, Command, LawSettings, LayerSettings, OUTBOX, Setup, Task};
use staya_controller::time::Instant;

/// Controllers outside this process. Robots are numbered as in the scenario. They decide in each
/// tick, so the scenario's clocks must be synchronous
/// ([`Clocks::is_synchronous`](crate::scenario::Clocks::is_synchronous)).
///
/// Each tick calls [`ExternalController::send`] for each robot that is up, steps the engine's own
/// robots, and then calls [`ExternalController::collect`], so that all controllers work in
/// parallel. The implementation keeps its errors; the swarm continues without the robot.
pub trait ExternalController: Send {
    /// Sorted indices of the robots whose controllers are external.
    fn robots(&self) -> Vec<usize>;

    /// Restarts the controller of robot `index`; `setup.agent.boot` is the low byte of its
    /// number of restarts.
    fn start(&mut self, index: usize, setup: Setup, task: Task);

    /// Whether controller `index` has lost its state and waits for a restart; called once per tick.
    fn has_restarted(&mut self, index: usize) -> bool;

    /// Starts the step of robot `index`.
    fn send(&mut self, index: usize, tick: u32, now: Instant, inputs: &AnyInputs<'_, f32>);

    /// Decision that follows the last `send`; `None` if the controller does not respond.
    fn collect(&mut self, index: usize) -> Option<Decision>;
}

/// Decision of an external controller.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    /// Command for the body.
    pub command: Command<f32>,
    /// Encoded frames for the radio.
    pub outbox: heapless::Vec<u8, OUTBOX>,
    /// Number of frames that it rejected.
    pub rejected: u16,
    /// Status after the step.
    pub status: Status,
}

pub(super) struct External {
    pub(super) controllers: Box<dyn ExternalController>,
    /// Sorted by index.
    pub(super) robots: Vec<(usize, LawSettings, LayerSettings)>,
}

impl Engine {
    /// Moves the controllers of some robots out of this process. Call it before the first tick.
    #[must_use]
    pub fn with_external(mut self, scenario: &Scenario, controllers: Box<dyn ExternalController>) -> Self {
        let robots = controllers.robots().into_iter();
        let robots = robots.filter(|&index| index < self.robots.len());
        let robots = robots.map(|index| (index, scenario.law(index).on_device(), scenario.safety(index)));
        let robots: Vec<_> = robots.collect();
        let indices: Vec<_> = robots.iter().map(|&(index, ..)| index).collect();
        self.external = Some(External { controllers, robots });
        for index in indices {
            self.restart(index, 0);
        }
        self
    }

    pub(super) fn send_out(&mut self) {
        let Some(external) = &mut self.external else {
            return;
        };
        let (tick, mut senses, mut heard) = (self.tick, Senses::default(), Vec::new());
        let orders = self.ground.view(tick).orders;
        for &(index, ..) in &external.robots {
            let computer = &self.computers[index];
            if tick < computer.down_until {
                continue;
            }
            let moment = Tick { tick, ground: &*self.ground, radio: &self.radio, orders };
            let delivered = moment.inbox(index, computer).pieces();
            let inputs = moment.inputs(index, computer, &mut senses, delivered, &mut heard);
            let now = computer.clock.now(tick, self.robots[self.here[index] as usize].id, &self.timing);
            external.controllers.send(index, tick, now, &inputs);
        }
    }

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
