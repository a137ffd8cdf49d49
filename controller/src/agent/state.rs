//! Queries of the state of an agent.

use super::{Agent, Law, PayloadOf, Perception, Safety};
use crate::digest::digest;
use crate::grid::Cell;
use crate::neighbor::{Knowledge, Neighbor};
use crate::robot::{Mode, RobotId};
use crate::scalar::Scalar;
use crate::time::Instant;
use crate::wire::Wire;
use serde::Serialize;

impl<S: Scalar, L: Law<S>, const N: usize, A: Safety<S>, W: Wire, P: Perception<S>> Agent<S, L, N, A, W, P> {
    /// Returns a hash of the whole state, identical on all targets and in all builds for identical
    /// inputs. Agents with equal hashes behave identically from then on. O(bytes of the state).
    #[must_use]
    pub fn digest(&self) -> u64
    where
        Self: Serialize,
    {
        digest(self)
    }

    /// The current mode.
    #[must_use]
    pub const fn mode(&self) -> Mode {
        self.mode
    }

    /// The leader of this robot.
    #[must_use]
    pub fn leader(&self) -> RobotId {
        self.law.report().leader
    }

    /// The cell that it heads for; `None` without a goal.
    #[must_use]
    pub fn target(&self) -> Option<Cell> {
        self.law.report().target
    }

    /// The known robots in ascending order of ids.
    #[must_use]
    pub fn neighbors(&self) -> &[Neighbor<S, PayloadOf<L, S>>] {
        self.link.table.as_slice()
    }

    /// Returns the knowledge about robot `id`: fresh, stale or unknown. O(log N).
    #[must_use]
    pub fn neighbor(&self, id: RobotId, now: Instant) -> Knowledge<'_, S, PayloadOf<L, S>> {
        self.link.table.get(id, now)
    }

    /// The law, for inspection.
    #[must_use]
    pub const fn law(&self) -> &L {
        &self.law
    }

    /// The law, to change it between two steps.
    pub const fn law_mut(&mut self) -> &mut L {
        &mut self.law
    }

    /// The safety layer, for inspection.
    #[must_use]
    pub const fn safety(&self) -> &A {
        &self.safety
    }

    /// The safety layer, to change it between two steps.
    pub const fn safety_mut(&mut self) -> &mut A {
        &mut self.safety
    }

    /// The wire format.
    #[must_use]
    pub const fn wire(&self) -> &W {
        self.link.wire()
    }

    /// The wire format, to change it between two steps, such as the time for MAVLink signatures.
    pub const fn wire_mut(&mut self) -> &mut W {
        self.link.wire_mut()
    }
}
