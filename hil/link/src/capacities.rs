//! What a device has room for.

use crate::frame;
use crate::surroundings::OBSTACLE_BYTES;
use serde::{Deserialize, Serialize};

/// Bytes of a step without terrain, obstacles and inbox, at most: overhead included (a test fills one).
const FIXED: usize = 104;

/// What a device has room for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Capacities {
    /// Neighbours that its robot knows.
    pub neighbors: u16,
    /// Cells of a search: (2 r + 3)^2 for a radius r.
    pub search_cells: u16,
    /// Cells whose visits its robot remembers.
    pub visits: u16,
    /// Half-planes that its safety layer reckons with.
    pub half_planes: u16,
    /// Obstacles in sight.
    pub obstacles: u16,
    /// Bytes that its radio delivers in a step.
    pub inbox_bytes: u16,
}

/// Cells of the largest window that a search of `search_cells` uses: its border lies outside of the window.
#[must_use]
pub const fn window_cells(search_cells: usize) -> usize {
    let side = search_cells.isqrt().saturating_sub(2);
    side * side
}

/// Bytes of the content of a step's frame, at most.
#[must_use]
pub const fn step_bytes(search_cells: usize, obstacles: usize, inbox_bytes: usize) -> usize {
    FIXED + window_cells(search_cells) + obstacles * OBSTACLE_BYTES + inbox_bytes
}

impl Capacities {
    /// Bytes of the longest frame from the host, delimiters included.
    #[must_use]
    pub const fn frame_bytes(&self) -> usize {
        frame::frame_len(step_bytes(self.search_cells as usize, self.obstacles as usize, self.inbox_bytes as usize))
    }
}
