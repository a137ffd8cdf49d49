//! Runs that an operator observes and controls.

use super::inspect::listed;
use super::simulate::{AnyEngine, SafetyOf};
use super::{Engine, Ground, HostLaw, Inspection, Moment, Outcome, Status};
use crate::radio::{self, HostWire, Reception};
use crate::record::{Motion, RobotRow, TickRow};
use crate::scenario::{Intervention, Scenario};
use crate::terrain::Terrain;
use crate::world::plane::{Disc, Solid};
use crate::world::{Misplaced, Refusal};
use staya_controller::agent::{Event, Guided, Law, Wish};
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
    /// Restart number of its computer.
    pub boot: u8,
    /// Whether its computer runs.
    pub is_up: bool,
    /// The operator's command that it follows.
    pub wish: Wish<f32>,
    /// Number of robots in its neighbour table.
    pub neighbors: usize,
}

/// A running scenario whose robots, numbered as in [`Scenario::robots`], accept commands between
/// ticks. Without commands it is identical to [`simulate`](super::simulate), bit for bit, but
/// continues after all robots have arrived.
pub trait Operated: Send {
    /// Runs one tick.
    fn advance(&mut self);

    /// State of robot `index`.
    fn observation(&self, index: usize) -> Observation;

    /// Events of robot `index` in the last tick.
    fn events(&self, index: usize) -> &[Event];

    /// Commands robot `index`; false if its computer is down or its law lacks the command.
    fn command(&mut self, index: usize, wish: Wish<f32>) -> bool;

    /// Delivers a message to robot `index` in the next tick, in its wire format but without the
    /// radio; lost while the computer is down. Replaces the sequence number of `header`.
    fn tell(&mut self, index: usize, header: Header, message: &Message);

    /// Parameters of a robot and their values; empty if it is down.
    fn parameters(&mut self, index: usize) -> Vec<(&'static Parameter, f32)>;

    /// Value of a parameter; `None` if the robot does not have it or is down.
    fn parameter(&mut self, index: usize, name: &str) -> Option<f32> {
        self.parameters(index).into_iter().find(|(row, _)| row.name == name).map(|(_, value)| value)
    }

    /// Sets a parameter.
    ///
    /// # Errors
    /// The robot is down, does not have the parameter, or does not accept the value.
    fn set_parameter(&mut self, index: usize, name: &str, value: f32) -> Result<(), Rejected>;

    /// Results of the run so far.
    fn outcome(&self) -> Outcome;

    /// Calls `watch` with the current state, as [`simulate`](super::simulate) does after a tick.
    fn show(&self, watch: &mut dyn FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>));

    /// Whether [`simulate`](super::simulate) would end here because all robots have arrived.
    fn is_over(&self) -> bool;

    /// Applies an intervention before the next tick.
    ///
    /// # Errors
    /// It is invalid for these robots or this world, or has no effect.
    fn intervene(&mut self, what: &Intervention) -> Result<(), Refusal>;

    /// Knowledge and next decision of robot `index`.
    fn inspect(&self, index: usize) -> Inspection;

    /// Goal of robot `index`, metres; `None`: it has no fixed goal.
    fn goal_m(&self, index: usize) -> Option<[f64; 3]>;

    /// Current terrain, if there is any.
    fn terrain(&self) -> Option<&Terrain>;

    /// Current obstacles in the plane.
    fn solids(&self) -> &[Solid];

    /// Foreign bodies.
    fn intruders(&self) -> &[Disc];

    /// Enables or disables the log of [`Operated::receptions`] from the next tick on.
    fn log_receptions(&mut self, wanted: bool);

    /// Fate of each packet of the last tick at robot `index`, with the sender's id.
    fn receptions(&self, index: usize) -> &[(RobotId, Reception)];
}

/// Creates a run with an operator, before its first tick.
///
/// # Errors
/// [`Misplaced`] when two robots start in one cell or one starts in a wall.
pub fn operated(scenario: &Scenario) -> Result<Box<dyn Operated>, Misplaced> {
    Ok(AnyEngine::new(scenario)?.operated(scenario))
}

impl AnyEngine {
    pub(super) fn operated(self, scenario: &Scenario) -> Box<dyn Operated> {
        match self {
            Self::Plane(engine) => boxed(scenario, *engine),
            Self::Cells(engine) => boxed(scenario, *engine),
        }
    }
}

fn boxed<W, G>(scenario: &Scenario, mut engine: Engine<W, Guided<f32, G>, SafetyOf>) -> Box<dyn Operated>
where
    W: Ground + 'static,
    G: HostLaw + Clone + 'static,
{
    engine.keeps_events = true;
    let row = engine.first_row();
    let key = scenario.key.as_ref();
    let (wire, number) = radio::operator(scenario.radio.format, key, 1);
    let own = scenario.keeping.as_ref().and_then(|keeping| {
        let (_, id) = radio::operator(scenario.radio.format, key, 0);
        OperatorWire::at_start(Master::new(&keeping.master), id, 0)
    });
    Box::new(OperatedEngine { engine, row, wire, own, number: key.map(|_| number), sequence: 0 })
}

struct OperatedEngine<W, G: Law<f32>> {
    engine: Engine<W, Guided<f32, G>, SafetyOf>,
    row: TickRow,
    wire: HostWire,
    /// Wire for robots that have keys of their own.
    own: Option<OperatorWire<1>>,
    /// Sender id if the robots have a key; otherwise the header gives it.
    number: Option<RobotId>,
    sequence: u16,
}

impl<W, G> Operated for OperatedEngine<W, G>
where
    W: Ground,
    G: HostLaw + Clone,
{
    fn advance(&mut self) {
        self.row = self.engine.step();
    }

    fn observation(&self, index: usize) -> Observation {
        let computer = &self.engine.computers[index];
        let agent = computer.agent.as_ref();
        Observation {
            motion: self.engine.ground.motion(index, self.engine.tick),
            status: self.engine.statuses[index],
            boot: computer.boot,
            is_up: self.engine.is_up(index),
            wish: agent.map_or(Wish::Own, |agent| *agent.law().wish()),
            neighbors: agent.map_or(0, |agent| agent.neighbors().len()),
        }
    }

    fn events(&self, index: usize) -> &[Event] {
        &self.engine.computers[index].events
    }

    fn command(&mut self, index: usize, wish: Wish<f32>) -> bool {
        let is_up = self.engine.is_up(index);
        let agent = self.engine.computers[index].agent.as_mut();
        let Some(agent) = agent.filter(|_| is_up) else { return false };
        let is_possible = match wish {
            Wish::Own | Wish::Off | Wish::Hold => true,
            Wish::Velocity { .. } | Wish::Waypoint { .. } => self.engine.ground.has_bodies(),
            Wish::Cell(_) => agent.law().report().goal.is_some(),
        };
        is_possible && agent.law_mut().command(wish).is_ok()
    }

    fn tell(&mut self, index: usize, header: Header, message: &Message) {
        let mut frame = heapless::Vec::<u8, MAX_FRAME_LEN>::new();
        if let Some(own) = &mut self.own {
            let robot = self.engine.config(index, 0).id;
            if self.engine.is_up(index) && own.say(robot, message, &mut frame).is_ok() {
                self.engine.computers[index].mail.extend_from_slice(&frame);
            }
            return;
        }
        let header = Header { sender: self.number.unwrap_or(header.sender), sequence: self.sequence, ..header };
        self.sequence = self.sequence.wrapping_add(1);
        // All messages of the controller fit into a frame.
        if self.engine.is_up(index) && self.wire.encode(header, message, &mut frame).is_ok() {
            self.engine.computers[index].mail.extend_from_slice(&frame);
        }
    }

    fn parameters(&mut self, index: usize) -> Vec<(&'static Parameter, f32)> {
        let is_up = self.engine.is_up(index);
        let agent = self.engine.computers[index].agent.as_mut().filter(|_| is_up);
        agent.map_or_else(Vec::new, |agent| listed(|visit| agent.parameters(visit)))
    }

    fn set_parameter(&mut self, index: usize, name: &str, value: f32) -> Result<(), Rejected> {
        let is_up = self.engine.is_up(index);
        let agent = self.engine.computers[index].agent.as_mut().filter(|_| is_up);
        agent.ok_or(Rejected::Unknown)?.set_parameter(name, value)
    }

    fn outcome(&self) -> Outcome {
        self.engine.outcome()
    }

    fn show(&self, watch: &mut dyn FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>)) {
        watch(&self.engine.moment(&self.row), &mut self.engine.rows());
    }

    fn is_over(&self) -> bool {
        self.engine.is_over()
    }

    fn intervene(&mut self, what: &Intervention) -> Result<(), Refusal> {
        self.engine.intervene(what)
    }

    fn inspect(&self, index: usize) -> Inspection {
        self.engine.inspect(index)
    }

    fn goal_m(&self, index: usize) -> Option<[f64; 3]> {
        self.engine.ground.goal_m(index)
    }

    fn terrain(&self) -> Option<&Terrain> {
        self.engine.ground.terrain()
    }

    fn solids(&self) -> &[Solid] {
        self.engine.ground.solids()
    }

    fn intruders(&self) -> &[Disc] {
        self.engine.ground.intruders()
    }

    fn log_receptions(&mut self, wanted: bool) {
        self.engine.radio.log_receptions(wanted);
    }

    fn receptions(&self, index: usize) -> &[(RobotId, Reception)] {
        self.engine.radio.receptions(index)
    }
}
