//! Capacities of a device, and the buffer sizes that follow from them.

use crate::frame;
use crate::surroundings::OBSTACLE_BYTES;
use serde::{Deserialize, Serialize};

/// Most bytes of an encoded step without terrain, obstacles and inbox. A test fills one.
const FIXED: usize = 104;

/// Largest inputs and tables that a device can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Capacities {
    /// Neighbours in the robot's table.
    pub neighbors: u16,
    /// Cells of a grid search: (2 r + 3)^2 for a search radius r.
    pub search_cells: u16,
    /// Cells in the robot's memory of visits.
    pub visits: u16,
    /// Half-planes of the safety layer.
    pub half_planes: u16,
    /// Obstacles in one step.
    pub obstacles: u16,
    /// Bytes of received packets in one step.
    pub inbox_bytes: u16,
}

/// Cells of the largest terrain window that a search of `search_cells` uses.
#[must_use]
pub const fn window_cells(search_cells: usize) -> usize {
    let side = search_cells.isqrt().saturating_sub(2);
    side * side
}

/// Largest content of a step's frame, bytes.
#[must_use]
pub const fn step_bytes(search_cells: usize, obstacles: usize, inbox_bytes: usize) -> usize {
    FIXED + window_cells(search_cells) + obstacles * OBSTACLE_BYTES + inbox_bytes
}

impl Capacities {
    /// Length of the longest frame from the host, bytes, delimiters included.
    #[must_use]
    pub const fn frame_bytes(&self) -> usize {
        frame::frame_len(step_bytes(self.search_cells as usize, self.obstacles as usize, self.inbox_bytes as usize))
    }
}
