//! The controller interface of a session, and the controller for all built-in guidance laws.

use crate::body::{Body, capacities, check, count};
use crate::capacities::Capacities;
use crate::message::{StepInputs, StepResult};
use crate::refusal::Refusal;
use staya_controller::agent::{
    AnyAgent, AnyLaw, AnySafety, CELLS, GridWorkspace, HALF_PLANES, LEARNED, NEIGHBORS, Setup, Task, VISITS,
};
use staya_controller::scalar::{NumberFormat, Q16, Scalar};
use staya_controller::wire::{FromFormat, Postcard};
use staya_mavlink::any::AnyWire;

/// The robot of an STM32F405. Its packet format is configurable.
pub type Large = LargeIn<f32>;
/// [`Large`] in another number format.
pub type LargeIn<S> = Robot<S, CELLS, VISITS, NEIGHBORS, HALF_PLANES, 32, AnyWire, LEARNED>;
/// The robot of the micro:bit's nRF51. Its packet format is configurable.
pub type Small = Robot<Q16, CELLS, VISITS, 8, 16, 16, AnyWire>;
/// Inbox of a [`Large`], bytes.
pub const LARGE_INBOX: usize = 8192;
/// Inbox of a [`Small`], bytes.
pub const SMALL_INBOX: usize = 1024;

/// The deciding part of a device. Object-safe: a host holds shadows of different parts.
pub trait Controller {
    /// Number format of the arithmetic.
    fn number(&self) -> NumberFormat;

    /// Capacities; the inbox depends on the owner of the receive buffer.
    fn capacities(&self) -> Capacities;

    /// Replaces the robot by a new one and returns the digest of its initial state. `law` is a
    /// user-defined guidance law in postcard format, empty for a built-in law.
    ///
    /// # Errors
    /// See [`Refusal`]; the controller is then not configured.
    fn configure(&mut self, setup: &Setup, task: Option<&Task>, law: &[u8]) -> Result<u64, Refusal>;

    /// Executes one step; the result stays in [`Controller::result`] to save stack.
    ///
    /// # Errors
    /// [`Refusal::NotConfigured`], or inputs that do not fit; the robot's state is unchanged.
    fn step(&mut self, inputs: &StepInputs<'_>) -> Result<(), Refusal>;

    /// Result of the last step; `None` before the robot is configured.
    fn result(&self) -> Option<StepResult>;

    /// Removes the robot.
    fn forget(&mut self);
}

/// A robot with a configurable law: `CELLS` of a search, `M` remembered visits, `N` neighbours, `K`
/// half-planes, `O` obstacles, wire format `W`.
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
    body: Body<S, AnyLaw<S, CELLS, M, L>, AnySafety<S, K>, W, N, O>,
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
    /// Creates a robot that is not configured.
    #[must_use]
    pub const fn new() -> Self {
        Self { body: Body::new(GridWorkspace::new()) }
    }

    /// The agent, once it is configured.
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
        S::FORMAT
    }

    fn capacities(&self) -> Capacities {
        Capacities { search_cells: count(CELLS), visits: count(M), ..capacities(N, K, O) }
    }

    fn configure(&mut self, setup: &Setup, task: Option<&Task>, law: &[u8]) -> Result<u64, Refusal> {
        self.body.forget();
        check(setup)?;
        let (needs, room) = (setup.law.cells(), CELLS);
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
