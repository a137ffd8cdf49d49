//! Cuts the inputs of a step to the capacities of a device.

use crate::capacities::{Capacities, window_cells};
use crate::message::StepInputs;
use crate::surroundings::{OBSTACLE_BYTES, PackedSurroundings, TerrainWindow, pack};
use staya_controller::agent::{AnyInputs, AnySurroundings};
use staya_controller::obstacle::Obstacle;
use staya_controller::scalar::Scalar;
use staya_controller::time::Instant;
use staya_controller::wire::Wire;

/// Amount of input that [`Capacities::fit`] removed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cut {
    /// Bytes removed from the inbox.
    pub inbox_bytes: usize,
    /// Obstacles removed.
    pub obstacles: usize,
}

/// The terrain window has too many cells; cutting it would change the route.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WindowTooLarge {
    /// Cells of the window.
    pub cells: usize,
    /// Cells that fit.
    pub room: usize,
}

impl core::fmt::Display for WindowTooLarge {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { cells, room } = self;
        write!(f, "a window of {cells} cells, and the device has room for {room}")
    }
}

impl core::error::Error for WindowTooLarge {}

impl Capacities {
    /// Converts inputs to a step that fits the device; every host cuts them in the same way:
    ///
    /// - Inbox: the newest whole frames, split in the robot's wire format.
    /// - Obstacles: the nearest ones, in their original order; of equally near ones the first.
    ///
    /// `packed` is scratch memory of at least 17 bytes per obstacle; a shorter buffer keeps fewer.
    /// O(obstacles^2) if some have to be removed, otherwise O(obstacles).
    ///
    /// # Errors
    /// [`WindowTooLarge`]: terrain is not cut.
    pub fn fit<'a>(
        &self,
        tick: u32,
        now: Instant,
        inputs: &AnyInputs<'a, f32>,
        wire: &impl Wire,
        packed: &'a mut [u8],
    ) -> Result<(StepInputs<'a>, Cut), WindowTooLarge> {
        let (grid, plane, in_cell) = match inputs.surroundings {
            AnySurroundings::OnGrid(grid) => (Some(grid), None, None),
            AnySurroundings::InPlane(plane) => (None, Some(plane), None),
            AnySurroundings::InCells(all) => (Some(all.grid), Some(all.plane), Some(all.in_cell)),
        };
        let window = grid.and_then(|grid| grid.window).map(TerrainWindow::from);
        let cells = window.map_or(0, |window| window.cells.len());
        let room = window_cells(self.search_cells.into());
        if cells > room {
            return Err(WindowTooLarge { cells, room });
        }
        let inbox = newest(inputs.inbox, self.inbox_bytes.into(), wire);
        let mut cut = Cut { inbox_bytes: inputs.inbox.len() - inbox.len(), obstacles: 0 };
        let surroundings = plane.map(|seen| {
            let len = self.pack(seen.obstacles, packed);
            let obstacles = packed.get(..len).unwrap_or(&[]);
            let (kept, _) = obstacles.as_chunks::<OBSTACLE_BYTES>();
            cut.obstacles = seen.obstacles.len() - kept.len();
            PackedSurroundings { max_speed_mps: seen.max_speed_mps, in_cell, obstacles }
        });
        let step = StepInputs {
            tick,
            now,
            state: inputs.state,
            cell: grid.map(|grid| grid.cell),
            window,
            surroundings,
            inbox,
        };
        Ok((step, cut))
    }

    fn pack(&self, obstacles: &[Obstacle<f32>], packed: &mut [u8]) -> usize {
        let (free, _) = packed.as_chunks_mut::<OBSTACLE_BYTES>();
        let room = free.len().min(self.obstacles.into());
        let has_room = obstacles.len() <= room;
        let staying = obstacles.iter().enumerate().filter(|(index, _)| has_room || rank(obstacles, *index) < room);
        let mut count = 0;
        for ((_, obstacle), to) in staying.zip(free) {
            *to = pack(obstacle);
            count += 1;
        }
        count * OBSTACLE_BYTES
    }
}

/// Number of nearer obstacles. One without a nearest point is the farthest.
fn rank(obstacles: &[Obstacle<f32>], index: usize) -> usize {
    let distance = |obstacle: &Obstacle<f32>| {
        let nearest = obstacle.nearest_point();
        nearest.map_or(f32::NAN, |(_, distance_m)| distance_m)
    };
    let own = obstacles.get(index).map_or(f32::NAN, distance);
    let others = obstacles.iter().enumerate();
    others.filter(|(other, obstacle)| distance(obstacle).order(own).then(other.cmp(&index)).is_lt()).count()
}

fn newest<'a>(inbox: &'a [u8], room: usize, wire: &impl Wire) -> &'a [u8] {
    let mut rest = inbox;
    while rest.len() > room && wire.next_frame(&mut rest).is_some() {}
    if rest.len() > room { &[] } else { rest }
}
