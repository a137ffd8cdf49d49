//! Observation and control of a run by an operator, between ticks.

use super::inspect::listed;
use super::{Engine, HostAgent, Moment, Status, View, agents};
use crate::radio::{self, HostWire, Reception};
use crate::record::{Motion, RobotRow};
use crate::scenario::Scenario;
use crate::world::Misplaced;
use staya_controller::agent::{Event, Law as _, Wish};
use staya_controller::auth::Master;
use staya_controller::parameters::{Parameter, Rejected};
use staya_controller::robot::RobotId;
use staya_controller::wire::{Header, Message, OperatorWire, Wire as _};
use staya_mavlink::frame::MAX_FRAME_LEN;

/// A robot's state as the robot itself knows it.
#[derive(Clone, Copy, Debug)]
pub struct Observation {
    /// Motion of the body.
    pub motion: Motion,
    /// Status after the last step.
    pub status: Status,
    /// Restarts of its computer.
    pub starts: u32,
    /// Whether its computer runs.
    pub is_up: bool,
    /// The operator's command that it follows.
    pub wish: Wish<f32>,
    /// Number of robots in its neighbour table.
    pub neighbors: usize,
}

/// Creates a run with an operator, before its first tick. Without commands it is identical to
/// [`simulate`](super::simulate), bit for bit, but continues after all robots have arrived.
///
/// # Errors
/// [`Misplaced`] when two robots start in one cell or one starts in a wall.
pub fn operated(scenario: &Scenario) -> Result<Engine, Misplaced> {
    Ok(Engine::new(scenario, agents(scenario))?.with_operator(scenario))
}

/// The operator's end of the wire to the robots.
pub(super) struct Operator {
    wire: HostWire,
    /// Wire for robots that have keys of their own.
    own: Option<OperatorWire<1>>,
    /// Sender id if the robots have a key; otherwise the header gives it.
    number: Option<RobotId>,
    sequence: u16,
}

impl Operator {
    fn new(scenario: &Scenario) -> Self {
        let key = scenario.key();
        let (wire, number) = radio::operator(scenario.radio.format, key, 1);
        let own = scenario.key_rotation().and_then(|keeping| {
            let (_, id) = radio::operator(scenario.radio.format, key, 0);
            OperatorWire::at_start(Master::new(&keeping.master), id, 0)
        });
        Self { wire, own, number: key.map(|_| number), sequence: 0 }
    }
}

impl Engine {
    /// Adds an operator, and stores the robots' events. Call it before the first tick.
    #[must_use]
    pub fn with_operator(mut self, scenario: &Scenario) -> Self {
        self.operator = Some(Operator::new(scenario));
        self.row = self.first_row();
        self
    }

    /// State of robot `index`.
    #[must_use]
    pub fn observation(&self, index: usize) -> Observation {
        let computer = &self.computers[index];
        let agent = computer.agent.as_ref();
        Observation {
            motion: self.ground.motion(index, self.tick),
            status: self.statuses[index],
            starts: computer.starts,
            is_up: self.is_up(index),
            wish: agent.map_or(Wish::Own, |agent| *agent.law().wish()),
            neighbors: agent.map_or(0, |agent| agent.neighbors().len()),
        }
    }

    /// Events of robot `index` in the last tick; empty without an operator.
    #[must_use]
    pub fn events(&self, index: usize) -> &[Event] {
        &self.computers[index].events
    }

    /// The agent of robot `index`; `None` if it is down or external.
    fn agent_mut(&mut self, index: usize) -> Option<&mut HostAgent> {
        let is_up = self.is_up(index);
        self.computers[index].agent.as_mut().filter(|_| is_up)
    }

    /// Commands robot `index`; false if its computer is down or its law lacks the command.
    pub fn command(&mut self, index: usize, wish: Wish<f32>) -> bool {
        let has_bodies = self.ground.view(self.tick).clearance.is_some();
        let Some(agent) = self.agent_mut(index) else { return false };
        let is_possible = match wish {
            Wish::Own | Wish::Off | Wish::Hold => true,
            Wish::Velocity { .. } | Wish::Waypoint { .. } => has_bodies,
            Wish::Cell(_) => agent.law().report().goal.is_some(),
        };
        is_possible && agent.law_mut().command(wish).is_ok()
    }

    /// Delivers an operator's message to robot `index` in the next tick, in its wire format but
    /// without the radio; lost while the computer is down. Replaces the sequence number of
    /// `header`.
    pub fn tell(&mut self, index: usize, header: Header, message: &Message) {
        let (robot, is_up) = (self.id(index), self.is_up(index));
        let starts = self.computers.iter().map(|computer| computer.starts).max().unwrap_or(0);
        let Some(operator) = self.operator.as_mut() else { return };
        radio::keep_up(&mut operator.wire, starts);
        let mut frame = heapless::Vec::<u8, MAX_FRAME_LEN>::new();
        let is_said = match &mut operator.own {
            Some(own) => is_up && own.say(robot, message, &mut frame).is_ok(),
            None => {
                let sender = operator.number.unwrap_or(header.sender);
                let header = Header { sender, sequence: operator.sequence, ..header };
                operator.sequence = operator.sequence.wrapping_add(1);
                // All messages of the controller fit into a frame.
                is_up && operator.wire.encode(header, message, &mut frame).is_ok()
            }
        };
        if is_said {
            self.computers[index].mail.extend_from_slice(&frame);
        }
    }

    /// Parameters of a robot and their values; empty if it is down.
    pub fn parameters(&mut self, index: usize) -> Vec<(&'static Parameter, f32)> {
        self.agent_mut(index).map_or_else(Vec::new, |agent| listed(|visit| agent.parameters(visit)))
    }

    /// Value of a parameter; `None` if the robot does not have it or is down.
    pub fn parameter(&mut self, index: usize, name: &str) -> Option<f32> {
        self.parameters(index).into_iter().find(|(row, _)| row.name == name).map(|(_, value)| value)
    }

    /// Sets a parameter.
    ///
    /// # Errors
    /// The robot is down, does not have the parameter, or does not accept the value.
    pub fn set_parameter(&mut self, index: usize, name: &str, value: f32) -> Result<(), Rejected> {
        self.agent_mut(index).ok_or(Rejected::Unknown)?.set_parameter(name, value)
    }

    /// Calls `watch` with the current state, as [`simulate`](super::simulate) does after a tick.
    pub fn show(&self, watch: &mut dyn FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>)) {
        watch(&self.moment(&self.row), &mut self.rows());
    }

    /// Goal of robot `index`, metres; `None`: it has no fixed goal.
    #[must_use]
    pub fn goal_m(&self, index: usize) -> Option<[f64; 3]> {
        self.ground.goal_m(index)
    }

    /// The world now.
    #[must_use]
    pub fn view(&self) -> View<'_> {
        self.ground.view(self.tick)
    }

    /// Enables or disables the log of [`Engine::receptions`] from the next tick on.
    pub fn log_receptions(&mut self, wanted: bool) {
        self.radio.log_receptions(wanted);
    }

    /// Fate of each packet of the last tick at robot `index`, with the sender's id.
    #[must_use]
    pub fn receptions(&self, index: usize) -> &[(RobotId, Reception)] {
        self.radio.receptions(index)
    }
}
