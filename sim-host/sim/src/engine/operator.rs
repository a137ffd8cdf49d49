//! A run that an operator watches and commands.

use super::simulate::{AnyEngine, SafetyOf};
use super::{Engine, Ground, HostLaw, Inspection, Moment, Outcome, Status};
use crate::radio::{self, HostWire, Reception};
use crate::record::{Motion, RobotRow, TickRow};
use crate::scenario::{Intervention, Scenario};
use crate::terrain::Terrain;
use crate::world::plane::{Disc, Solid};
use crate::world::{Misplaced, Refusal};
use staya_controller::agent::{Commanded, Event, Guidance, Parameter, Wish};
use staya_controller::auth::Master;
use staya_controller::robot::RobotId;
use staya_controller::wire::{Header, Message, OperatorWire, Wire as _};
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

    /// The swarm and its robots now, as [`simulate`](super::simulate) shows them after each tick.
    fn show(&self, watch: &mut dyn FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>));

    /// Whether [`simulate`](super::simulate) would end here: all have arrived.
    fn is_over(&self) -> bool;

    /// Does it before the next tick.
    ///
    /// # Errors
    /// It makes no sense for these robots or this world, or nobody has a use for it.
    fn intervene(&mut self, what: &Intervention) -> Result<(), Refusal>;

    /// What robot `index` knows, and is going to decide.
    fn inspect(&self, index: usize) -> Inspection;

    /// Where robot `index` is to go, metres; `None`: nowhere in particular.
    fn goal_m(&self, index: usize) -> Option<[f64; 3]>;

    /// The land as it is now, if there is any.
    fn terrain(&self) -> Option<&Terrain>;

    /// What stands in the plane now.
    fn solids(&self) -> &[Solid];

    /// Bodies that are no robots.
    fn intruders(&self) -> &[Disc];

    /// Whether [`Operated::receptions`] tells from the next tick on.
    fn log_receptions(&mut self, wanted: bool);

    /// What became of the last tick's packets at robot `index`, with the numbers of their senders.
    fn receptions(&self, index: usize) -> &[(RobotId, Reception)];
}

/// A scenario before its first tick, with an operator.
///
/// # Errors
/// [`Misplaced`] when two robots start in one cell or one starts in a wall.
pub fn operated(scenario: &Scenario) -> Result<Box<dyn Operated>, Misplaced> {
    Ok(match AnyEngine::new(scenario)? {
        AnyEngine::Plane(engine) => boxed(scenario, *engine),
        AnyEngine::Cells(engine) => boxed(scenario, *engine),
    })
}

pub(super) fn boxed<W, G>(scenario: &Scenario, mut engine: Engine<W, Commanded<f32, G>, SafetyOf>) -> Box<dyn Operated>
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

/// A swarm, and what its operator speaks.
struct OperatedEngine<W, G: Guidance<f32>> {
    engine: Engine<W, Commanded<f32, G>, SafetyOf>,
    /// The swarm's line of the record after the last tick.
    row: TickRow,
    wire: HostWire,
    /// For robots that have keys of their own.
    own: Option<OperatorWire<1>>,
    /// As whom it speaks if the robots have a key; otherwise as whom it is told to.
    number: Option<RobotId>,
    /// Of the next frame.
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
            wish: agent.map_or(Wish::Own, |agent| *agent.guidance().wish()),
            neighbors: agent.map_or(0, |agent| agent.neighbors().len()),
        }
    }

    fn events(&self, index: usize) -> &[Event] {
        &self.engine.computers[index].events
    }

    fn command(&mut self, index: usize, wish: Wish<f32>) -> bool {
        let is_up = self.engine.is_up(index);
        let agent = self.engine.computers[index].agent.as_mut();
        let agent = agent.filter(|_| is_up);
        agent.is_some_and(|agent| agent.guidance_mut().command(wish).is_ok())
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
        // What the controller's messages can be fits.
        if self.engine.is_up(index) && self.wire.encode(header, message, &mut frame).is_ok() {
            self.engine.computers[index].mail.extend_from_slice(&frame);
        }
    }

    fn parameter(&self, index: usize, parameter: Parameter) -> Option<f32> {
        let agent = self.engine.computers[index].agent.as_ref();
        agent.filter(|_| self.engine.is_up(index))?.parameter(parameter)
    }

    fn set_parameter(&mut self, index: usize, parameter: Parameter, value: f32) -> bool {
        let is_up = self.engine.is_up(index);
        let agent = self.engine.computers[index].agent.as_mut().filter(|_| is_up);
        agent.is_some_and(|agent| agent.set_parameter(parameter, value))
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
