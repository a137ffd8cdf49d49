//! Law chosen at run time, for simulators and configurable firmware.

use super::any_protocol::{AnyMessage, AnyOrder, AnyPayload, AnyProtocol, InAny};
#[cfg(feature = "host")]
use crate::grid::Cell;
use crate::grid::Dir;
use crate::law::{AnySurroundings, BadInput, Decision, Known, Law, Radio, Tools, View};
#[cfg(feature = "host")]
use crate::law::{MessageOf, OrderOf, PayloadOf, Report};
use crate::neighbor::Neighbor;
#[cfg(feature = "host")]
use crate::parameters::Parameters;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::Instant;
use core::marker::PhantomData;

/// A large law: in place in firmware, allocated on a host, so small laws do not pay for its size.
#[cfg(not(feature = "host"))]
pub type Large<G> = G;
#[cfg(feature = "host")]
#[expect(missing_docs, reason = "as without the feature")]
pub type Large<G> = alloc::boxed::Box<G>;

#[cfg(not(feature = "host"))]
pub(crate) const fn large<G>(law: G) -> Large<G> {
    law
}
#[cfg(feature = "host")]
pub(crate) fn large<G>(law: G) -> Large<G> {
    Large::new(law)
}

/// A large law is a law, wherever it is.
#[cfg(feature = "host")]
impl<S: Scalar, G: Law<S>> Law<S> for Large<G> {
    type Surroundings<'a> = G::Surroundings<'a>;
    type Protocol = G::Protocol;
    type Workspace = G::Workspace;

    fn decide(
        &mut self,
        view: &View<'_, S, G::Protocol>,
        here: &G::Surroundings<'_>,
        tools: Tools<'_, S, Self>,
    ) -> Result<Decision<S>, BadInput> {
        let Tools { rng, radio, workspace } = tools;
        (**self).decide(view, here, Tools { rng, radio, workspace })
    }

    fn payload(
        &mut self,
        here: &G::Surroundings<'_>,
        heading: Dir,
        radio: &mut Radio<'_, G::Protocol>,
    ) -> PayloadOf<G, S> {
        (**self).payload(here, heading, radio)
    }

    fn receive_payload(&mut self, from: RobotId, payload: &PayloadOf<G, S>, sent: Instant) {
        (**self).receive_payload(from, payload, sent);
    }

    fn receive(&mut self, from: RobotId, message: &MessageOf<G, S>, radio: &mut Radio<'_, G::Protocol>) -> bool {
        (**self).receive(from, message, radio)
    }

    fn order(&mut self, order: &OrderOf<G, S>) -> bool {
        (**self).order(order)
    }

    fn needs(&self, id: RobotId) -> bool {
        (**self).needs(id)
    }

    fn report(&self) -> Report {
        (**self).report()
    }

    fn expects(&self, id: RobotId) -> Option<Cell> {
        (**self).expects(id)
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        (**self).parameters(visit);
    }
}

/// Declares an enum of laws that is itself a law with [`AnyProtocol`]: one memory for any of them.
///
/// `of`: its scalar type. `in`: its scratch memory, which is `AsMut` of that of each law. Then the
/// generics of the `impl`, with bounds and as arguments. The line `Drives(WaypointGuidance<f32>)`
/// becomes a variant, and an arm of each method of [`Law`] that calls the law inside.
///
/// ```
/// use staya_controller::agent::{CELLS, GridWorkspace, Law, RouteGuidance, WaypointGuidance};
///
/// staya_controller::laws! {
///     /// Drives, or goes from cell to cell.
///     #[derive(Clone, Debug)]
///     pub enum Rover[] of f32, in GridWorkspace<CELLS>, [] for [] {
///         Drives(WaypointGuidance<f32>),
///         Steps(RouteGuidance<CELLS, 32>),
///     }
/// }
/// fn is_law(_: impl Law<f32>) {}
/// is_law(Rover::Drives(WaypointGuidance::new(0.5, 0.02)));
/// ```
#[macro_export]
macro_rules! laws {
    (
        $(#[$about:meta])*
        $visible:vis enum $name:ident[$($declared:tt)*] of $number:ty,
        in $workspace:ty, [$($bounds:tt)*] for [$($arguments:tt)*] {
            $($(#[$attribute:meta])* $variant:ident($law:ty)),+ $(,)?
        }
    ) => {
        $(#[$about])*
        $visible enum $name<$($declared)*> {
            $($(#[$attribute])* $variant($law)),+
        }

        impl<$($bounds)*> $crate::agent::Law<$number> for $name<$($arguments)*> {
            type Surroundings<'a> = $crate::agent::AnySurroundings<'a, $number>;
            type Protocol = $crate::agent::AnyProtocol;
            type Workspace = $workspace;

            fn decide(
                &mut self,
                view: &$crate::agent::View<'_, $number, $crate::agent::AnyProtocol>,
                here: &$crate::agent::AnySurroundings<'_, $number>,
                tools: $crate::agent::Tools<'_, $number, Self>,
            ) -> Result<$crate::agent::Decision<$number>, $crate::agent::BadInput> {
                let $crate::agent::Tools { rng, mut radio, workspace } = tools;
                let sends = (rng, &mut radio);
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => $crate::agent::dispatch::decide(
                        law, view, here, sends, workspace.as_mut(),
                    ),
                )+}
            }

            fn payload(
                &mut self,
                here: &$crate::agent::AnySurroundings<'_, $number>,
                heading: $crate::grid::Dir,
                radio: &mut $crate::agent::Radio<'_, $crate::agent::AnyProtocol>,
            ) -> $crate::agent::AnyPayload {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => $crate::agent::dispatch::payload(
                        law, here, heading, radio,
                    ),
                )+}
            }

            fn receive_payload(
                &mut self,
                from: $crate::robot::RobotId,
                payload: &$crate::agent::AnyPayload,
                sent: $crate::time::Instant,
            ) {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => $crate::agent::dispatch::receive_payload::<$number, _>(
                        law, from, payload, sent,
                    ),
                )+}
            }

            #[inline(never)]
            fn receive(
                &mut self,
                from: $crate::robot::RobotId,
                message: &$crate::agent::AnyMessage,
                radio: &mut $crate::agent::Radio<'_, $crate::agent::AnyProtocol>,
            ) -> bool {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => $crate::agent::dispatch::receive::<$number, _>(
                        law, from, message, radio,
                    ),
                )+}
            }

            #[inline(never)]
            fn order(&mut self, order: &$crate::agent::AnyOrder) -> bool {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => $crate::agent::dispatch::order::<$number, _>(
                        law, order,
                    ),
                )+}
            }

            fn needs(&self, id: $crate::robot::RobotId) -> bool {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => {
                        $crate::agent::Law::<$number>::needs(law, id)
                    }
                )+}
            }

            fn report(&self) -> $crate::agent::Report {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => {
                        $crate::agent::Law::<$number>::report(law)
                    }
                )+}
            }

            fn expects(&self, id: $crate::robot::RobotId) -> Option<$crate::grid::Cell> {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => {
                        $crate::agent::Law::<$number>::expects(law, id)
                    }
                )+}
            }

            fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn $crate::parameters::Parameters)) {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => {
                        $crate::agent::Law::<$number>::parameters(law, visit)
                    }
                )+}
            }
        }
    };
}

/// The robots of an enum of laws as one of its laws knows them.
struct Narrow<'a, S, P>(&'a dyn Known<S, AnyPayload>, PhantomData<P>);

impl<S: Scalar, P: InAny> Known<S, P::Payload> for Narrow<'_, S, P> {
    fn count(&self) -> usize {
        self.0.count()
    }

    fn at(&self, index: usize) -> Option<Neighbor<S, P::Payload>> {
        self.0.at(index).map(|robot| robot.map(P::payload))
    }

    fn find(&self, id: RobotId) -> Option<Neighbor<S, P::Payload>> {
        self.0.find(id).map(|robot| robot.map(P::payload))
    }
}

/// What [`laws!`](crate::laws!) calls for each of its laws.
#[doc(hidden)]
pub mod dispatch {
    use super::*;

    /// Decides.
    ///
    /// # Errors
    /// [`BadInput`] also for surroundings of another kind.
    pub fn decide<S: Scalar, L: Law<S, Protocol: InAny>>(
        law: &mut L,
        view: &View<'_, S, AnyProtocol>,
        here: &AnySurroundings<'_, S>,
        (rng, radio): (&mut Rng, &mut Radio<'_, AnyProtocol>),
        workspace: &mut L::Workspace,
    ) -> Result<Decision<S>, BadInput> {
        let here = L::Surroundings::try_from(*here).map_err(|_| BadInput)?;
        let known = Narrow::<S, L::Protocol>(view.known, PhantomData);
        law.decide(&view.with(&known), &here, Tools { rng, radio: radio.of(), workspace })
    }

    /// Asks for the payload.
    pub fn payload<S: Scalar, L: Law<S, Protocol: InAny>>(
        law: &mut L,
        here: &AnySurroundings<'_, S>,
        heading: Dir,
        radio: &mut Radio<'_, AnyProtocol>,
    ) -> AnyPayload {
        let Ok(here) = L::Surroundings::try_from(*here) else { return AnyPayload::default() };
        L::Protocol::wrap(law.payload(&here, heading, &mut radio.of()))
    }

    /// Gives a payload.
    pub fn receive_payload<S: Scalar, L: Law<S, Protocol: InAny>>(
        law: &mut L,
        from: RobotId,
        payload: &AnyPayload,
        sent: Instant,
    ) {
        if let Some(payload) = L::Protocol::payload(*payload) {
            law.receive_payload(from, &payload, sent);
        }
    }

    /// Gives a message.
    pub fn receive<S: Scalar, L: Law<S, Protocol: InAny>>(
        law: &mut L,
        from: RobotId,
        message: &AnyMessage,
        radio: &mut Radio<'_, AnyProtocol>,
    ) -> bool {
        L::Protocol::message(message).is_some_and(|message| law.receive(from, &message, &mut radio.of()))
    }

    /// Gives an order.
    pub fn order<S: Scalar, L: Law<S, Protocol: InAny>>(law: &mut L, order: &AnyOrder) -> bool {
        L::Protocol::order_in(order).is_some_and(|order| law.order(&order))
    }
}
