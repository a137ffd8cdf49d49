//! What a robot must be told in a step besides its own state and the radio: each guidance law names the type that it needs.

use crate::geom::Vec2;
use crate::grid::{Cell, Window};
use crate::obstacle::Obstacle;
use crate::scalar::Scalar;
use crate::time::Duration;
use core::fmt::Debug;
use serde::{Deserialize, Serialize};

/// The robot's state on the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CellState {
    /// The cell it occupies.
    pub cell: Cell,
    /// Time until it may leave; zero or less: free now (A. V. Kuznetsov 2017, KUZ, eq. 6).
    pub busy: Duration,
}

/// For guidance laws that move cell by cell.
#[derive(Clone, Copy, Debug)]
pub struct OnGrid<'a> {
    /// Own state on the grid.
    pub cell: CellState,
    /// The terrain that the robot can see, its own cell included; while it sees none it is in
    /// [`Mode::Fault`](crate::robot::Mode::Fault) and stands. Of any size: routes are searched within the radius of
    /// [`RouteParams`](crate::route::RouteParams) in it.
    pub window: Option<Window<'a>>,
}

/// For guidance laws that move by velocities, in the plane or in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InPlane<'a, S> {
    /// How fast the body can go where it is, m/s: rough land slows it down. With 0, or less, the robot is in
    /// [`Mode::Fault`](crate::robot::Mode::Fault).
    pub max_speed_mps: S,
    /// What it sees that does not move. Walls of a terrain window come from [`grid_walls`](crate::obstacle::grid_walls).
    pub obstacles: &'a [Obstacle<S>],
}

/// For guidance laws that plan on the grid and move by velocities.
#[derive(Clone, Copy, Debug)]
pub struct InCells<'a, S> {
    /// Own state on the grid, never busy.
    pub grid: OnGrid<'a>,
    /// What the body can do and must avoid.
    pub plane: InPlane<'a, S>,
    /// Where in its cell it is.
    pub in_cell: InCell<S>,
}

/// A place within a cell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct InCell<S> {
    /// The place minus the cell's centre, metres.
    pub offset_m: Vec2<S>,
    /// Side of a cell, metres; more than 0.
    pub cell_m: S,
}

/// For [`AnyGuidance`](super::AnyGuidance). One that is not what the law inside needs puts the robot into
/// [`Mode::Fault`](crate::robot::Mode::Fault).
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs, reason = "each variant's type says it")]
pub enum AnySurroundings<'a, S> {
    OnGrid(OnGrid<'a>),
    InPlane(InPlane<'a, S>),
    InCells(InCells<'a, S>),
}

/// What the agent itself takes from the input of its guidance law: for the beacon, and for the safety layer.
pub trait Surroundings<S>: Copy + Debug {
    /// The part on the grid, if there is one.
    fn on_grid(&self) -> Option<OnGrid<'_>>;

    /// The part in the plane or in space; `None` for a robot that moves cell by cell, which has no safety layer.
    fn in_plane(&self) -> Option<InPlane<'_, S>>;
}

impl<S: Scalar> Surroundings<S> for OnGrid<'_> {
    fn on_grid(&self) -> Option<OnGrid<'_>> {
        Some(*self)
    }

    fn in_plane(&self) -> Option<InPlane<'_, S>> {
        None
    }
}

impl<S: Scalar> Surroundings<S> for InPlane<'_, S> {
    fn on_grid(&self) -> Option<OnGrid<'_>> {
        None
    }

    fn in_plane(&self) -> Option<InPlane<'_, S>> {
        Some(*self)
    }
}

impl<S: Scalar> Surroundings<S> for InCells<'_, S> {
    fn on_grid(&self) -> Option<OnGrid<'_>> {
        Some(self.grid)
    }

    fn in_plane(&self) -> Option<InPlane<'_, S>> {
        Some(self.plane)
    }
}

impl<S: Scalar> Surroundings<S> for AnySurroundings<'_, S> {
    fn on_grid(&self) -> Option<OnGrid<'_>> {
        match self {
            Self::OnGrid(grid) | Self::InCells(InCells { grid, .. }) => Some(*grid),
            Self::InPlane(_) => None,
        }
    }

    fn in_plane(&self) -> Option<InPlane<'_, S>> {
        match self {
            Self::InPlane(plane) | Self::InCells(InCells { plane, .. }) => Some(*plane),
            Self::OnGrid(_) => None,
        }
    }
}

/// A law of the plane does without the cells.
impl<'a, S> From<InCells<'a, S>> for InPlane<'a, S> {
    fn from(cells: InCells<'a, S>) -> Self {
        cells.plane
    }
}

impl<'a, S> From<OnGrid<'a>> for AnySurroundings<'a, S> {
    fn from(grid: OnGrid<'a>) -> Self {
        Self::OnGrid(grid)
    }
}

impl<'a, S> From<InPlane<'a, S>> for AnySurroundings<'a, S> {
    fn from(plane: InPlane<'a, S>) -> Self {
        Self::InPlane(plane)
    }
}

impl<'a, S> From<InCells<'a, S>> for AnySurroundings<'a, S> {
    fn from(cells: InCells<'a, S>) -> Self {
        Self::InCells(cells)
    }
}
