//! What a device has room for, and what is cut so that a step fits.

use crate::frame;
use crate::message::{Around, Land, OBSTACLE, StepInputs, pack};
use serde::{Deserialize, Serialize};
use staya_controller::agent::Inputs;
use staya_controller::obstacle::Obstacle;
use staya_controller::scalar::Scalar;
use staya_controller::time::Instant;
use staya_controller::wire::Wire;

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

/// What [`Capacities::fit`] cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cut {
    /// Bytes of the inbox.
    pub inbox_bytes: usize,
    /// Obstacles.
    pub obstacles: usize,
}

/// The terrain has more cells than the device can hold. What cannot be cut without changing what the robot sees is an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LandTooLarge {
    /// Cells in sight.
    pub cells: usize,
    /// Cells that fit.
    pub room: usize,
}

impl core::fmt::Display for LandTooLarge {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { cells, room } = self;
        write!(
            f,
            "a window of {cells} cells, and the device has room for {room}"
        )
    }
}

impl core::error::Error for LandTooLarge {}

/// Cells of the largest window that a search of `search_cells` uses: its border lies outside of the window.
#[must_use]
pub const fn window_cells(search_cells: usize) -> usize {
    let side = search_cells.isqrt().saturating_sub(2);
    side * side
}

/// Bytes of the content of a step's frame, at most.
#[must_use]
pub const fn step_bytes(search_cells: usize, obstacles: usize, inbox_bytes: usize) -> usize {
    FIXED + window_cells(search_cells) + obstacles * OBSTACLE + inbox_bytes
}

impl Capacities {
    /// Bytes of the longest frame from the host, delimiters included.
    #[must_use]
    pub const fn frame_bytes(&self) -> usize {
        frame::frame_len(step_bytes(
            self.search_cells as usize,
            self.obstacles as usize,
            self.inbox_bytes as usize,
        ))
    }

    /// Makes a step of inputs. What is too much is cut by these rules, so that all that see the same inputs cut alike:
    ///
    /// - of the inbox, in the robot's wire format, the newest whole frames that fit stay: news replace older ones;
    /// - of the obstacles the nearest ones stay (of two equally near ones that which comes first), in their order.
    ///
    /// `packed` is scratch memory of at least 17 bytes per obstacle; with less, fewer obstacles stay. O(obstacles^2) when
    /// there are too many, otherwise O(obstacles).
    ///
    /// # Errors
    /// [`LandTooLarge`]: terrain is not cut.
    pub fn fit<'a>(
        &self,
        tick: u32,
        now: Instant,
        inputs: &Inputs<'a, f32>,
        wire: &impl Wire,
        packed: &'a mut [u8],
    ) -> Result<(StepInputs<'a>, Cut), LandTooLarge> {
        let land = inputs.window.map(Land::from);
        let cells = land.map_or(0, |land| land.cells.len());
        let room = window_cells(self.search_cells.into());
        if cells > room {
            return Err(LandTooLarge { cells, room });
        }
        let inbox = newest(inputs.inbox, self.inbox_bytes.into(), wire);
        let mut cut = Cut {
            inbox_bytes: inputs.inbox.len() - inbox.len(),
            obstacles: 0,
        };
        let around = inputs.surroundings.map(|seen| {
            let len = self.pack(seen.obstacles, packed);
            let obstacles = packed.get(..len).unwrap_or(&[]);
            let (kept, _) = obstacles.as_chunks::<OBSTACLE>();
            cut.obstacles = seen.obstacles.len() - kept.len();
            Around {
                max_speed_mps: seen.max_speed_mps,
                in_cell: seen.in_cell,
                obstacles,
            }
        });
        let step = StepInputs {
            tick,
            now,
            pose: inputs.pose,
            cell: inputs.cell,
            land,
            around,
            inbox,
        };
        Ok((step, cut))
    }

    /// Writes the obstacles that stay and returns their bytes.
    fn pack(&self, obstacles: &[Obstacle<f32>], packed: &mut [u8]) -> usize {
        let (free, _) = packed.as_chunks_mut::<OBSTACLE>();
        let room = free.len().min(self.obstacles.into());
        let has_room = obstacles.len() <= room;
        let staying = obstacles
            .iter()
            .enumerate()
            .filter(|(index, _)| has_room || rank(obstacles, *index) < room);
        let mut count = 0;
        for ((_, obstacle), to) in staying.zip(free) {
            *to = pack(obstacle);
            count += 1;
        }
        count * OBSTACLE
    }
}

/// How many obstacles are nearer than that of this number; one without a nearest point is the farthest.
fn rank(obstacles: &[Obstacle<f32>], index: usize) -> usize {
    let distance = |obstacle: &Obstacle<f32>| {
        let nearest = obstacle.nearest_point();
        nearest.map_or(f32::NAN, |(_, distance_m)| distance_m)
    };
    let own = obstacles.get(index).map_or(f32::NAN, distance);
    let others = obstacles.iter().enumerate();
    others
        .filter(|(other, obstacle)| {
            distance(obstacle)
                .order(own)
                .then(other.cmp(&index))
                .is_lt()
        })
        .count()
}

/// The newest whole frames of `inbox` that fit into `room` bytes.
fn newest<'a>(inbox: &'a [u8], room: usize, wire: &impl Wire) -> &'a [u8] {
    let mut rest = inbox;
    while rest.len() > room && wire.next_frame(&mut rest).is_some() {}
    if rest.len() > room { &[] } else { rest }
}
