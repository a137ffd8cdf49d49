//! A run that an operator watches and commands.

use super::simulate::AnyEngine;
use super::{Engine, Ground, HostLaw, Outcome, Status};
use crate::radio::{self, HostWire};
use crate::record::Motion;
use crate::scenario::Scenario;
use crate::world::Misplaced;
use staya_controller::agent::{Commanded, Event, Parameter, Safety, Wish};
use staya_controller::robot::RobotId;
use staya_controller::wire::{Header, Message, Wire as _};
use staya_mavlink::frame::MAX_FRAME_LEN;

/// What an operator can see of a robot: what the robot itself knows.
#[derive(Clone, Copy, Debug)]
pub struct Observation {
    /// How it moves.
    pub motion: Motion,
    /// What it is doing.
    pub status: Status,
    /// Changes with each start of its computer.
    pub boot: u8,
    /// Whether its computer runs.
    pub is_up: bool,
    /// The operator's wish that it follows.
    pub wish: Wish<f32>,
    /// Robots that it knows.
    pub neighbors: usize,
}

/// A scenario whose robots can be commanded between ticks. Robots are numbered as in [`Scenario::robots`].
///
/// While nobody commands, it is the run that [`simulate`](super::simulate) makes, to the bit. It goes on when all have arrived.
pub trait Operated: Send {
    /// One tick.
    fn advance(&mut self);

    /// Robot `index` now.
    fn observation(&self, index: usize) -> Observation;

    /// What happened to it in the last tick.
    fn events(&self, index: usize) -> &[Event];

    /// Gives it a wish; whether it takes it: it does not while its computer is down, nor what its guidance has no use for.
    fn command(&mut self, index: usize, wish: Wish<f32>) -> bool;

    /// Lets it hear a message in the next tick, over no radio, in the format that robots speak (frames are counted here, whatever the header's number);
    /// lost while its computer is down.
    fn tell(&mut self, index: usize, header: Header, message: &Message);

    /// What a parameter of it is; `None` when it has no such one or is down.
    fn parameter(&self, index: usize, parameter: Parameter) -> Option<f32>;

    /// Changes a parameter; whether it has such one and takes the value.
    fn set_parameter(&mut self, index: usize, parameter: Parameter, value: f32) -> bool;

    /// What came of the run so far.
    fn outcome(&self) -> Outcome;
}

/// A scenario before its first tick, with an operator.
///
/// # Errors
/// [`Misplaced`] when two robots start in one cell or one starts in a wall.
pub fn operated(scenario: &Scenario) -> Result<Box<dyn Operated>, Misplaced> {
    Ok(match AnyEngine::new(scenario)? {
        AnyEngine::Plane(engine) => boxed(scenario, *engine),
        AnyEngine::Narrow(engine) => boxed(scenario, *engine),
        AnyEngine::Wide(engine) => boxed(scenario, *engine),
    })
}

fn boxed<W, G, A>(scenario: &Scenario, mut engine: Engine<W, Commanded<f32, G>, A>) -> Box<dyn Operated>
where
    W: Ground + 'static,
    G: HostLaw + 'static,
    A: Safety<f32> + Send + 'static,
{
    engine.keeps_events = true;
    let key = scenario.key.as_ref();
    let (wire, number) = radio::operator(scenario.radio.format, key, 1);
    Box::new(OperatedEngine { engine, wire, number: key.map(|_| number), sequence: 0 })
}

/// A swarm, and what its operator speaks.
struct OperatedEngine<W, G, A> {
    engine: Engine<W, Commanded<f32, G>, A>,
    wire: HostWire,
    /// As whom it speaks if the robots have a key; otherwise as whom it is told to.
    number: Option<RobotId>,
    /// Of the next frame.
    sequence: u16,
}

impl<W, G, A> OperatedEngine<W, G, A> {
    fn is_up(&self, index: usize) -> bool {
        self.engine.tick >= self.engine.computers[index].down_until
    }
}

impl<W, G, A> Operated for OperatedEngine<W, G, A>
where
    W: Ground,
    G: HostLaw,
    A: Safety<f32> + Send,
{
    fn advance(&mut self) {
        self.engine.step();
    }

    fn observation(&self, index: usize) -> Observation {
        let computer = &self.engine.computers[index];
        let agent = computer.agent.as_ref();
        Observation {
            motion: self.engine.ground.motion(index, self.engine.tick),
            status: self.engine.statuses[index],
            boot: computer.boot,
            is_up: self.is_up(index),
            wish: agent.map_or(Wish::Own, |agent| *agent.guidance().wish()),
            neighbors: agent.map_or(0, |agent| agent.neighbors().len()),
        }
    }

    fn events(&self, index: usize) -> &[Event] {
        &self.engine.computers[index].events
    }

    fn command(&mut self, index: usize, wish: Wish<f32>) -> bool {
        let is_up = self.is_up(index);
        let agent = self.engine.computers[index].agent.as_mut();
        let agent = agent.filter(|_| is_up);
        agent.is_some_and(|agent| agent.guidance_mut().command(wish).is_ok())
    }

    fn tell(&mut self, index: usize, header: Header, message: &Message) {
        let mut frame = heapless::Vec::<u8, MAX_FRAME_LEN>::new();
        let header = Header { sender: self.number.unwrap_or(header.sender), sequence: self.sequence, ..header };
        self.sequence = self.sequence.wrapping_add(1);
        // What the controller's messages can be fits.
        if self.is_up(index) && self.wire.encode(header, message, &mut frame).is_ok() {
            self.engine.computers[index].mail.extend_from_slice(&frame);
        }
    }

    fn parameter(&self, index: usize, parameter: Parameter) -> Option<f32> {
        let agent = self.engine.computers[index].agent.as_ref();
        agent.filter(|_| self.is_up(index))?.parameter(parameter)
    }

    fn set_parameter(&mut self, index: usize, parameter: Parameter, value: f32) -> bool {
        let is_up = self.is_up(index);
        let agent = self.engine.computers[index].agent.as_mut().filter(|_| is_up);
        agent.is_some_and(|agent| agent.set_parameter(parameter, value))
    }

    fn outcome(&self) -> Outcome {
        self.engine.outcome()
    }
}
