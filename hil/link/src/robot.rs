//! What a session asks of a robot's controller, and the one controller that can be any robot with a law of this repository.

use crate::body::{Body, capacities, check, count, number};
use crate::capacities::Capacities;
use crate::message::{NumberFormat, StepInputs, StepResult};
use crate::refusal::Refusal;
use staya_controller::agent::{
    AnyAgent, AnyGuidance, AnySafety, CELLS, GridWorkspace, HALF_PLANES, LEARNED, NEIGHBORS, Setup, TEMPLATE, Task,
    VISITS,
};
use staya_controller::scalar::{Q16, Scalar};
use staya_controller::wire::{FromFormat, Postcard};
use staya_mavlink::any::AnyWire;

/// The robot that an STM32F405 has room for. As the small one, it speaks whatever format it is told to.
pub type Large = Robot<f32, CELLS, VISITS, NEIGHBORS, HALF_PLANES, 32, AnyWire, LEARNED>;
/// The robot that the micro:bit's nRF51 has room for.
pub type Small = Robot<Q16, CELLS, VISITS, 8, 16, 16, AnyWire>;
/// Bytes of the inbox beside a [`Large`].
pub const LARGE_INBOX: usize = 8192;
/// Bytes of the inbox beside a [`Small`].
pub const SMALL_INBOX: usize = 1024;

/// The part of a device that decides. Object-safe, so that a host can hold the shadows of different parts.
pub trait Controller {
    /// What it computes with.
    fn number(&self) -> NumberFormat;

    /// What it has room for; the inbox is up to who owns the buffer.
    fn capacities(&self) -> Capacities;

    /// Becomes this robot, just started; the digest of its state. `law` is a guidance law of somebody's own as postcard writes it,
    /// empty where [`Setup::guidance`] names one.
    ///
    /// # Errors
    /// What does not fit, see [`Refusal`]; then it is no robot at all.
    fn configure(&mut self, setup: &Setup, task: Option<&Task>, law: &[u8]) -> Result<u64, Refusal>;

    /// One step of the robot. What it decided is kept for [`Controller::result`]: on the way through a step it would only take stack.
    ///
    /// # Errors
    /// [`Refusal::NotConfigured`], or inputs that do not fit or make no sense; the robot is as it was.
    fn step(&mut self, inputs: &StepInputs<'_>) -> Result<(), Refusal>;

    /// What the last step decided; `None` for no robot.
    fn result(&self) -> Option<StepResult>;

    /// Is no robot any more.
    fn forget(&mut self);
}

/// A robot that is told what to be. `CELLS` of a search, `M` remembered visits, `N` neighbours, `K` half-planes, `O` obstacles,
/// wire format `W`.
#[derive(Clone, Debug)]
pub struct Robot<
    S: Scalar,
    const CELLS: usize,
    const M: usize,
    const N: usize,
    const K: usize,
    const O: usize,
    W = Postcard,
    const L: usize = 0,
> {
    body: Body<S, AnyGuidance<S, CELLS, M, TEMPLATE, L>, AnySafety<S, K>, W, N, O>,
}

impl<
    S: Scalar,
    const CELLS: usize,
    const M: usize,
    const N: usize,
    const K: usize,
    const O: usize,
    W: FromFormat,
    const L: usize,
> Robot<S, CELLS, M, N, K, O, W, L>
{
    /// Nobody yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { body: Body::new(GridWorkspace::new()) }
    }

    /// The robot, once it was told what to be.
    #[must_use]
    pub const fn agent(&self) -> Option<&AnyAgent<S, CELLS, M, N, K, W, L>> {
        self.body.agent()
    }
}

impl<
    S: Scalar,
    const CELLS: usize,
    const M: usize,
    const N: usize,
    const K: usize,
    const O: usize,
    W: FromFormat,
    const L: usize,
> Default for Robot<S, CELLS, M, N, K, O, W, L>
{
    fn default() -> Self {
        Self::new()
    }
}

impl<
    S: Scalar,
    const CELLS: usize,
    const M: usize,
    const N: usize,
    const K: usize,
    const O: usize,
    W: FromFormat,
    const L: usize,
> Controller for Robot<S, CELLS, M, N, K, O, W, L>
{
    fn number(&self) -> NumberFormat {
        number::<S>()
    }

    fn capacities(&self) -> Capacities {
        Capacities { search_cells: count(CELLS), visits: count(M), ..capacities(N, K, O) }
    }

    fn configure(&mut self, setup: &Setup, task: Option<&Task>, law: &[u8]) -> Result<u64, Refusal> {
        self.body.forget();
        check(setup)?;
        let (needs, room) = (setup.cells(), CELLS);
        if needs > room {
            return Err(Refusal::Search { needs, room });
        }
        if !law.is_empty() {
            return Err(Refusal::Law);
        }
        let wire = W::from_format(setup.format).ok_or(Refusal::Format(setup.format))?;
        self.body.start(task, || setup.speaking(wire))
    }

    fn step(&mut self, inputs: &StepInputs<'_>) -> Result<(), Refusal> {
        self.body.step(inputs)
    }

    fn result(&self) -> Option<StepResult> {
        self.body.result()
    }

    fn forget(&mut self) {
        self.body.forget();
    }
}
