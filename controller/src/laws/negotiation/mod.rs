//! Negotiation: each robot computes the moves of all robots near it by the same deterministic rule,
//! and makes its own. Start with [`Plan::new`].

mod area;
mod distance;
#[cfg(feature = "agent")]
mod law;
mod moves;
mod negotiator;
mod plan;
mod wish;

pub use area::{Area, SIDE, SIGHT, Sight};
pub use distance::{Distances, Nearby};
#[cfg(feature = "agent")]
pub use law::{Beat, InStep, InStepPayload, Negotiation, NegotiationGuidance, NegotiationInPlane, NegotiationPayload};
pub use moves::Moves;
pub use negotiator::{MOST_WAITING, Negotiator, RANGE, REPORTED, Report, Said, Sensed};
pub use plan::{Member, Plan};
pub use wish::{Manners, Wish};

#[cfg(all(test, feature = "wire"))]
mod tests;
