//! Robots with a user-defined guidance law: the host sends its initial state in postcard format.

use crate::body::{Body, capacities, check};
use crate::capacities::Capacities;
use crate::message::{StepInputs, StepResult};
use crate::refusal::Refusal;
use crate::robot::Controller;
use postcard::take_from_bytes;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{Agent, AnySafety, HALF_PLANES, InAny, InPlane, Law, NEIGHBORS, Setup, Task};
use staya_controller::scalar::{NumberFormat, Q16, Scalar};
use staya_controller::wire::FromFormat;
use staya_mavlink::any::AnyWire;

/// A robot with law `G` on an STM32F405 or larger: 16 neighbours, 32 obstacles.
pub type OwnLarge<G, S = f32> = Own<S, G, NEIGHBORS, HALF_PLANES, 32, AnyWire>;
/// A robot with law `G` on the micro:bit's nRF51: 8 neighbours, 16 obstacles, fixed point.
pub type OwnSmall<G> = Own<Q16, G, 8, 16, 16, AnyWire>;

/// A user-defined guidance law, in the plane or in space, whose state a host can send to a device.
/// Its orders come from the [`Task`] of the host, for example
/// [`WaypointOrder`](staya_controller::agent::WaypointOrder).
pub trait LinkedLaw<S: Scalar>:
    for<'a> Law<S, Surroundings<'a> = InPlane<'a, S>, Protocol: InAny, Workspace = ()>
    + Serialize
    + for<'de> Deserialize<'de>
{
}

impl<S: Scalar, G> LinkedLaw<S> for G where
    G: for<'a> Law<S, Surroundings<'a> = InPlane<'a, S>, Protocol: InAny, Workspace = ()>
        + Serialize
        + for<'de> Deserialize<'de>
{
}

/// A robot with law `G`: `N` neighbours, `K` half-planes, `O` obstacles, wire format `W`.
#[derive(Clone, Debug)]
pub struct Own<S: Scalar, G: LinkedLaw<S>, const N: usize, const K: usize, const O: usize, W> {
    body: Body<S, G, AnySafety<S, K>, W, N, O>,
}

impl<S: Scalar, G: LinkedLaw<S>, const N: usize, const K: usize, const O: usize, W> Own<S, G, N, K, O, W> {
    /// Creates a robot that is not configured.
    #[must_use]
    pub const fn new() -> Self {
        Self { body: Body::new(()) }
    }
}

impl<S: Scalar, G: LinkedLaw<S>, const N: usize, const K: usize, const O: usize, W> Default for Own<S, G, N, K, O, W> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: Scalar, G: LinkedLaw<S>, const N: usize, const K: usize, const O: usize, W: FromFormat + Serialize> Controller
    for Own<S, G, N, K, O, W>
{
    fn number(&self) -> NumberFormat {
        S::FORMAT
    }

    fn capacities(&self) -> Capacities {
        capacities(N, K, O)
    }

    fn configure(&mut self, setup: &Setup, task: Option<&Task>, law: &[u8]) -> Result<u64, Refusal> {
        self.body.forget();
        check(setup)?;
        let Ok((law, [])) = take_from_bytes::<G>(law) else {
            return Err(Refusal::Law);
        };
        let wire = W::from_format(setup.format).ok_or(Refusal::Format(setup.format))?;
        self.body.start(task, || Agent::new(&setup.agent.cast(), law, setup.safety.layer(), wire))
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
