//! What the agent asks of a guidance.

use super::{CellState, Pose};
use crate::grid::{Cell, Dir, Window};
use crate::neighbor::{Ages, Neighbor};
use crate::rand::Rng;
use crate::time::{Duration, Instant};
use crate::wire::{RequestKind, RobotId, TemplateAssignment};
use heapless::Vec;

/// What a guidance may know at a decision.
#[derive(Clone, Copy, Debug)]
pub struct View<'a, S> {
    /// Own number.
    pub id: RobotId,
    /// The moment of the decision.
    pub now: Instant,
    /// The time in which a robot crosses a cell of impassability 1.
    pub tick: Duration,
    /// Own state.
    pub pose: Pose<S>,
    /// Own state on the grid, if there is one.
    pub cell: Option<CellState>,
    /// The terrain in sight, if there is any.
    pub window: Option<Window<'a>>,
    /// The cell to go to.
    pub goal: Cell,
    /// Who was heard, by rising number; nobody older than [`Ages::expire_after`].
    pub neighbors: &'a [Neighbor<S>],
    /// How old news may be.
    pub ages: Ages,
}

impl<'a, S> View<'a, S> {
    /// A neighbour by its number. O(log N).
    #[must_use]
    pub fn neighbor(&self, id: RobotId) -> Option<&'a Neighbor<S>> {
        let at = self.neighbors.binary_search_by_key(&id, |n| n.id).ok()?;
        self.neighbors.get(at)
    }
}

/// A request that the guidance wants made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ask {
    /// To whom.
    pub to: RobotId,
    /// What for.
    pub kind: RequestKind,
}

/// What a guidance decided.
#[derive(Clone, Debug, Default, PartialEq)]
#[must_use]
pub struct Guided {
    /// The moves to try, best first; what the robot does with them is the supervisor's matter.
    pub moves: Vec<Dir, 8>,
    /// The cell that it really heads for: the goal, or near it if the goal is a wall.
    pub target: Cell,
    /// Whom the robot follows.
    pub leader: RobotId,
    /// Its place in the formation.
    pub slot: u8,
    /// It stands where it should.
    pub is_at_goal: bool,
    /// It should wait for others.
    pub waits: bool,
    /// No exit of the window can be reached.
    pub is_stuck: bool,
    /// It heads for where its followers are off to, and so goes on though they ask it to stop.
    pub recovers: bool,
    /// It is too far from its place in the formation.
    pub is_off_place: bool,
    /// It was asked to make way: it moves even if it has arrived or waits.
    pub makes_way: bool,
    /// What it asks of others.
    pub asks: Vec<Ask, 3>,
}

/// An input without which the guidance cannot decide is missing, or contradicts another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BadInput;

/// Chooses where to go. An agent has one; each composes behaviours of the layer below.
pub trait Guidance<S> {
    /// Scratch memory; holds nothing between calls, so that many robots can share one.
    type Workspace;

    /// Chooses the next move. Called when the robot is free to move.
    ///
    /// # Errors
    /// [`BadInput`] puts the robot into [`Mode::Fault`](crate::wire::Mode::Fault).
    fn decide(
        &mut self,
        view: &View<'_, S>,
        rng: &mut Rng,
        workspace: &mut Self::Workspace,
    ) -> Result<Guided, BadInput>;

    /// "Choose another direction" (KUZ section 7): excludes the last choice from the next one.
    fn redirect(&mut self) {}

    /// Takes a part of a formation template in; whether the part was of use. `is_anew`: its sender is
    /// another one than before, or has started anew.
    fn assign_template(&mut self, _part: &TemplateAssignment, _is_anew: bool) -> bool {
        false
    }

    /// From the top leader's goal to the own goal.
    fn goal_offset(&self) -> Cell {
        Cell::default()
    }

    /// Whether a full neighbour table must keep this robot.
    fn needs(&self, _id: RobotId) -> bool {
        false
    }
}
