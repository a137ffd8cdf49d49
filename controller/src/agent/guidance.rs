//! What the agent asks of a guidance.

use super::{CellState, InCell, Parameter, Pose};
use crate::body::Body;
use crate::geom::{Position, Vec3};
use crate::grid::{Cell, Dir, Window};
use crate::neighbor::{Ages, Nearby, Neighbor};
use crate::obstacle::Obstacle;
use crate::rand::Rng;
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use crate::wire::{RequestKind, TemplateAssignment};
use heapless::Vec;
use serde::{Deserialize, Serialize};

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
    /// The cell to go to; for a guidance that has a goal of its own any cell.
    pub goal: Cell,
    /// Own body.
    pub body: Body<S>,
    /// Who is near by, nearest first; nobody for robots that move cell by cell.
    pub nearby: &'a [Nearby<S>],
    /// What it sees that does not move.
    pub obstacles: &'a [Obstacle<S>],
    /// Where in its cell it is.
    pub in_cell: Option<InCell<S>>,
    /// Who was heard, by rising number; nobody older than [`Ages::expire_after`].
    pub neighbors: &'a [Neighbor<S>],
    /// How old news may be.
    pub ages: Ages,
}

impl<S: Scalar> View<'_, S> {
    /// Whether the body goes by velocities at all.
    ///
    /// # Errors
    /// [`BadInput`] when [`Inputs::surroundings`](super::Inputs::surroundings) are missing, or say that it cannot move.
    pub fn can_go(&self) -> Result<(), BadInput> {
        if self.body.max_speed_mps > S::ZERO {
            Ok(())
        } else {
            Err(BadInput)
        }
    }
}

impl<'a, S> View<'a, S> {
    /// A neighbour by its number. O(log N).
    #[must_use]
    pub fn neighbor(&self, id: RobotId) -> Option<&'a Neighbor<S>> {
        let at = self.neighbors.binary_search_by_key(&id, |n| n.id).ok()?;
        self.neighbors.get(at)
    }
}

/// Span after which a moving place is taken note of.
const LONG: Duration = Duration::from_millis(600_000);

/// A place to go to, which may move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Place<S> {
    /// Where it was.
    pub position: Position,
    /// Its velocity since, m/s.
    pub velocity_mps: Vec3<S>,
    /// When it was there, own clock.
    pub at: Instant,
}

impl<S: Scalar> Place<S> {
    /// The same in another kind of number.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> Place<T> {
        Place {
            position: self.position,
            velocity_mps: self.velocity_mps.cast(),
            at: self.at,
        }
    }

    /// A place that stays where it is.
    #[must_use]
    pub const fn fixed(position: Position) -> Self {
        Self {
            position,
            velocity_mps: Vec3::ZERO,
            at: Instant::from_micros(0),
        }
    }

    /// The way there from `from` at `now`, metres. Call it at least every half hour: what moves is taken note of
    /// on the way, lest the clock run round (each time rounds to a millimetre).
    #[must_use]
    pub fn way(&mut self, from: Position, now: Instant) -> Vec3<S> {
        let span = now.since(self.at);
        let moved = self.velocity_mps * S::from_micro(span.as_micros());
        if span < Duration::ZERO || span > LONG {
            self.position = self.position.moved(moved).unwrap_or(self.position);
            self.at = now;
            return self.position.since(from);
        }
        self.position.since(from) + moved
    }
}

/// A request that the guidance wants made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Ask {
    /// To whom.
    pub to: RobotId,
    /// What for.
    pub kind: RequestKind,
}

/// What a guidance decided.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[must_use]
pub struct Guided<S> {
    /// The moves to try, best first; what the robot does with them is the supervisor's matter.
    pub moves: Vec<Dir, 8>,
    /// The velocity that it would have with nobody in the way, m/s, for robots that do not move cell by
    /// cell; what becomes of it is the supervisor's and the safety layer's matter.
    pub velocity_mps: Vec3<S>,
    /// Where it goes, relative to its own place, metres; `None` when it only roams.
    pub way_m: Option<Vec3<S>>,
    /// The cell that it really heads for: the goal, or near it if the goal is a wall.
    pub target: Cell,
    /// Whom the robot follows.
    pub leader: RobotId,
    /// Its place in the formation.
    pub slot: u8,
    /// Nobody is to steer it from here: its motors are off, or somebody else steers.
    pub is_passive: bool,
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
    /// It was asked to make way, or its place moves: it moves even if it has arrived or waits.
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
    /// [`BadInput`] puts the robot into [`Mode::Fault`](crate::robot::Mode::Fault).
    fn decide(
        &mut self,
        view: &View<'_, S>,
        rng: &mut Rng,
        workspace: &mut Self::Workspace,
    ) -> Result<Guided<S>, BadInput>;

    /// "Choose another direction" (KUZ section 7): excludes the last choice from the next one.
    fn redirect(&mut self) {}

    /// Takes a part of a formation template in; whether the part was of use. `is_anew`: its sender is
    /// another one than before, or has started anew.
    fn assign_template(&mut self, _part: &TemplateAssignment, _is_anew: bool) -> bool {
        false
    }

    /// Takes a place to go to, number `index` of those that the robot has; whether it was of use.
    fn assign_place(&mut self, _index: u8, _place: &Place<S>) -> bool {
        false
    }

    /// Whether a cell of the grid is what it goes to.
    fn goes_to_cells(&self) -> bool {
        false
    }

    /// Whether it wishes velocities, not moves from cell to cell.
    fn goes_by_velocity(&self) -> bool {
        true
    }

    /// Whether it knows where to go without a cell as its goal.
    fn has_own_goal(&self) -> bool {
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

    /// What a parameter is now; `None` when it has no such one.
    fn parameter(&self, _parameter: Parameter) -> Option<S> {
        None
    }

    /// Changes a parameter; whether it has such one. `value` is within [`Parameter::range`].
    fn tune(&mut self, _parameter: Parameter, _value: S) -> bool {
        false
    }
}
