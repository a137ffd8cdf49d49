//! What can be asked of an agent.

use super::{Agent, Guidance, Safety};
use crate::digest::digest;
use crate::grid::Cell;
use crate::neighbor::{Knowledge, Neighbor};
use crate::robot::{Mode, RobotId};
use crate::scalar::Scalar;
use crate::time::Instant;
use crate::wire::Wire;
use serde::Serialize;

impl<S: Scalar, G: Guidance<S>, const N: usize, A: Safety<S>, W: Wire> Agent<S, G, N, A, W> {
    /// A fingerprint of the whole state: two agents with equal ones have the same future. The same on every target and in
    /// every build for the same history. O(bytes of the state).
    #[must_use]
    pub fn digest(&self) -> u64
    where
        Self: Serialize,
    {
        digest(self)
    }

    /// What the robot is doing.
    #[must_use]
    pub const fn mode(&self) -> Mode {
        self.mode
    }

    /// Whom it follows.
    #[must_use]
    pub const fn leader(&self) -> RobotId {
        self.last.leader
    }

    /// Where it is going; `None` without a goal.
    #[must_use]
    pub fn target(&self) -> Option<Cell> {
        self.goal.map(|_| self.last.target)
    }

    /// Whom it knows, by rising number.
    #[must_use]
    pub fn neighbors(&self) -> &[Neighbor<S, G::Payload>] {
        self.link.table.as_slice()
    }

    /// What is known of robot `id` at `now`, and whether it can still be trusted. O(log N).
    #[must_use]
    pub fn neighbor(&self, id: RobotId, now: Instant) -> Knowledge<'_, S, G::Payload> {
        self.link.table.get(id, now)
    }

    /// The guidance law, for what it can tell of itself.
    #[must_use]
    pub const fn guidance(&self) -> &G {
        &self.guidance
    }

    /// The safety layer, for what it can tell of itself.
    #[must_use]
    pub const fn safety(&self) -> &A {
        &self.safety
    }

    /// The safety layer, to be told something between two steps.
    pub const fn safety_mut(&mut self) -> &mut A {
        &mut self.safety
    }

    /// The wire format.
    #[must_use]
    pub const fn wire(&self) -> &W {
        self.link.wire()
    }

    /// The wire format, to tell it what it must know besides: MAVLink's signatures the time.
    pub const fn wire_mut(&mut self) -> &mut W {
        self.link.wire_mut()
    }
}
