//! Law chosen at run time, for simulators and configurable firmware.

use super::any_protocol::{AnyMessage, AnyOrder, AnyPayload, AnyProtocol, FromPayload};
use crate::grid::Dir;
use crate::law::{
    AnySurroundings, BadInput, Decision, Known, Law, MessageOf, OrderOf, PayloadOf, Protocol, Radio, Tools, View,
};
use crate::neighbor::Neighbor;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;

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

#[doc(hidden)]
pub const fn inside<G>(law: &Large<G>) -> &G {
    law
}

#[doc(hidden)]
pub const fn inside_mut<G>(law: &mut Large<G>) -> &mut G {
    law
}

/// Declares an enum of laws that is itself a law with [`AnyProtocol`]: one memory for any of them.
///
/// `of`: its scalar type. `in`: its scratch memory, which is `AsMut` of that of each law. Then the
/// generics of the `impl`, with bounds and as arguments. A law in [`Large`] is marked `large`.
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
            $($(#[$attribute:meta])* $variant:ident($law:ty $(, $large:ident)?)),+ $(,)?
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
                        $crate::laws!(@inside_mut law $($large)?), view, here, sends, workspace.as_mut(),
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
                        $crate::laws!(@inside_mut law $($large)?), here, heading, radio,
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
                        $crate::laws!(@inside_mut law $($large)?), from, message, radio,
                    ),
                )+}
            }

            #[inline(never)]
            fn order(&mut self, order: &$crate::agent::AnyOrder) -> bool {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => $crate::agent::dispatch::order::<$number, _>(
                        $crate::laws!(@inside_mut law $($large)?), order,
                    ),
                )+}
            }

            fn needs(&self, id: $crate::robot::RobotId) -> bool {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => {
                        $crate::agent::Law::<$number>::needs($crate::laws!(@inside law $($large)?), id)
                    }
                )+}
            }

            fn report(&self) -> $crate::agent::Report {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => {
                        $crate::agent::Law::<$number>::report($crate::laws!(@inside law $($large)?))
                    }
                )+}
            }

            fn expects(&self, id: $crate::robot::RobotId) -> Option<$crate::grid::Cell> {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => {
                        $crate::agent::Law::<$number>::expects($crate::laws!(@inside law $($large)?), id)
                    }
                )+}
            }

            fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn $crate::parameters::Parameters)) {
                match self {$(
                    $(#[$attribute])*
                    Self::$variant(law) => {
                        $crate::agent::Law::<$number>::parameters($crate::laws!(@inside_mut law $($large)?), visit)
                    }
                )+}
            }
        }
    };
    (@inside $law:ident) => { $law };
    (@inside $law:ident large) => { $crate::agent::dispatch::inside($law) };
    (@inside_mut $law:ident) => { $law };
    (@inside_mut $law:ident large) => { $crate::agent::dispatch::inside_mut($law) };
}

/// The robots of an enum of laws as one of its laws knows them.
struct Narrow<'a, S>(&'a dyn Known<S, AnyPayload>);

impl<S: Scalar, Q: TryFrom<AnyPayload>> Known<S, Q> for Narrow<'_, S> {
    fn count(&self) -> usize {
        self.0.count()
    }

    fn at(&self, index: usize) -> Option<Neighbor<S, Q>> {
        self.0.at(index).map(|robot| robot.map(|payload| payload.try_into().ok()))
    }

    fn find(&self, id: RobotId) -> Option<Neighbor<S, Q>> {
        self.0.find(id).map(|robot| robot.map(|payload| payload.try_into().ok()))
    }
}

/// What [`laws!`](crate::laws!) calls for each of its laws.
#[doc(hidden)]
pub mod dispatch {
    use super::*;

    pub use super::{inside, inside_mut};

    /// Decides.
    ///
    /// # Errors
    /// [`BadInput`] also for surroundings of another kind.
    pub fn decide<S: Scalar, L: Law<S>>(
        law: &mut L,
        view: &View<'_, S, AnyProtocol>,
        here: &AnySurroundings<'_, S>,
        (rng, radio): (&mut Rng, &mut Radio<'_, AnyProtocol>),
        workspace: &mut L::Workspace,
    ) -> Result<Decision<S>, BadInput>
    where
        PayloadOf<L, S>: TryFrom<AnyPayload>,
    {
        let here = L::Surroundings::try_from(*here).map_err(|_| BadInput)?;
        let known = Narrow(view.known);
        law.decide(&view.with(&known), &here, Tools { rng, radio: radio.of(), workspace })
    }

    /// Asks for the payload.
    pub fn payload<S: Scalar, L: Law<S>>(
        law: &mut L,
        here: &AnySurroundings<'_, S>,
        heading: Dir,
        radio: &mut Radio<'_, AnyProtocol>,
    ) -> AnyPayload
    where
        AnyPayload: FromPayload<PayloadOf<L, S>>,
    {
        let Ok(here) = L::Surroundings::try_from(*here) else { return AnyPayload::default() };
        AnyPayload::from_payload(<L::Protocol as Protocol>::ID, law.payload(&here, heading, &mut radio.of()))
    }

    /// Gives a message.
    pub fn receive<S: Scalar, L: Law<S>>(
        law: &mut L,
        from: RobotId,
        message: &AnyMessage,
        radio: &mut Radio<'_, AnyProtocol>,
    ) -> bool
    where
        for<'a> &'a MessageOf<L, S>: TryFrom<&'a AnyMessage>,
    {
        <&MessageOf<L, S>>::try_from(message).is_ok_and(|message| law.receive(from, message, &mut radio.of()))
    }

    /// Gives an order.
    pub fn order<S: Scalar, L: Law<S>>(law: &mut L, order: &AnyOrder) -> bool
    where
        for<'a> &'a OrderOf<L, S>: TryFrom<&'a AnyOrder>,
    {
        <&OrderOf<L, S>>::try_from(order).is_ok_and(|order| law.order(order))
    }
}
