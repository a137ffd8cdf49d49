//! The cost of a move for the formation, and when to wait (KUZ algorithms 2 and 7).

use super::{FormationParams, Member};
use crate::cost::{Cost, EXCLUDED, Weights};
use crate::grid::{BLOCKED, Cell, DIAGONAL, Dir, Norm, UNIT, Window};
use crate::template::TemplateEntry;
use serde::{Deserialize, Serialize};

/// A robot relative to which this robot has a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Anchor {
    /// Its predicted cell.
    pub predicted: Cell,
    /// The place of this robot, relative to it.
    pub offset: Cell,
    /// The move that it wants to make next.
    pub heading: Dir,
}

impl Anchor {
    /// The place of this robot.
    #[must_use]
    pub fn place(&self) -> Cell {
        self.predicted + self.offset
    }
}

/// The place to head for: beside the anchor and `lead` cells further along its heading.
#[must_use]
pub fn aim(anchor: &Anchor, lead: u8) -> Cell {
    let step = anchor.heading.offset();
    let ahead = i16::from(lead);
    anchor.place() + Cell::new(step.x * ahead, step.y * ahead)
}

/// Distance of a robot in `cell` from its place beside a neighbour in `other`, [`UNIT`]s.
#[must_use]
pub fn deviation(cell: Cell, other: Cell, offset: Cell) -> u32 {
    (cell + offset).distance(other, Norm::Euclidean)
}

/// The cost of each move for the formation (KUZ algorithm 7): gain times the distance that it would
/// leave to the own place, half by the top leader, half by the mean of the direct neighbours found
/// (the paper: their sum). If one kind is missing, the other counts in full; without both, zero.
#[must_use]
pub fn distances(params: &FormationParams, cell: Cell, top: Option<Cell>, members: &[Member]) -> Weights {
    let direct = || members.iter().filter(|member| member.hops == 1);
    let count = u32::try_from(direct().count()).unwrap_or(u32::MAX);
    let price = |dir: Dir| -> Cost {
        let there = cell + dir.offset();
        let by_top = top.map(|place| there.distance(place, Norm::Euclidean));
        let sum = direct()
            .fold(0_u32, |sum, member| sum.saturating_add(deviation(there, member.seen.predicted, member.offset)));
        let length = match (by_top, sum.checked_div(count)) {
            (Some(top), Some(mean)) => (top >> 1).saturating_add(mean >> 1),
            (Some(only), None) | (None, Some(only)) => only,
            (None, None) => 0,
        };
        // A great distance must not act as a wall.
        params.gain.of(length).min(EXCLUDED - 1)
    };
    Weights::new(Dir::MOVES.map(price))
}

/// Whether to stay rather than move: near enough to the place, and the move leads away from it.
#[must_use]
pub fn should_stay(cell: Cell, place: Cell, first: Dir) -> bool {
    const NEAR: u32 = UNIT + (UNIT >> 1);
    let now = cell.distance(place, Norm::Euclidean);
    let then = (cell + first.offset()).distance(place, Norm::Euclidean);
    now < NEAR && then > now
}

/// How far `off` (actual minus desired, cells) is behind in direction `heading`, [`UNIT`]s: its
/// component against the heading, at least half of its length; all of it without a heading.
#[must_use]
pub fn lag(off: Cell, heading: Dir) -> u32 {
    let length = Cell::default().distance(off, Norm::Euclidean);
    let ahead = heading.offset();
    let dot = i32::from(off.x) * i32::from(ahead.x) + i32::from(off.y) * i32::from(ahead.y);
    let behind = u32::try_from(-dot).unwrap_or(0);
    match heading {
        Dir::Stay => length,
        dir if dir.is_diagonal() => (behind.saturating_mul(DIAGONAL) >> 1).max(length >> 1),
        _ => behind.saturating_mul(UNIT).max(length >> 1),
    }
}

/// The direction in which the others are displaced (KUZ section 7, `def`): the sum of actual minus
/// desired, rounded to one of the eight moves; `Stay` if it is 0.
#[must_use]
pub fn def(cell: Cell, members: &[Member]) -> Dir {
    let (x, y) = members.iter().fold((0_i32, 0_i32), |(x, y), member| {
        let off = member.seen.cell - (cell + member.offset);
        (x.saturating_add(off.x.into()), y.saturating_add(off.y.into()))
    });
    // tan 22.5 degrees = sqrt 2 - 1 = 29/70.
    const TAN: i64 = (DIAGONAL - UNIT) as i64;
    let (ax, ay) = (i64::from(x).abs(), i64::from(y).abs());
    let dx = if ax * (UNIT as i64) > ay * TAN { x.signum() } else { 0 };
    let dy = if ay * (UNIT as i64) > ax * TAN { y.signum() } else { 0 };
    let step = Cell::new(dx as i16, dy as i16);
    Dir::between(Cell::default(), step).unwrap_or(Dir::Stay)
}

/// Whether the top leader waits: hysteresis around r0 (KUZ algorithm 2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PaceControl {
    waits: bool,
}

impl PaceControl {
    /// Creates a leader that does not wait.
    #[must_use]
    pub const fn new() -> Self {
        Self { waits: false }
    }

    /// Returns whether to wait: from a largest `lag` above `halt_lag` down to `resume_lag`.
    pub fn update(&mut self, params: &FormationParams, lag: u32) -> bool {
        let limit = if self.waits { params.resume_lag.min(params.halt_lag) } else { params.halt_lag };
        self.waits = lag > u32::from(limit);
        self.waits
    }

    /// Whether the leader waits.
    #[must_use]
    pub const fn waits(&self) -> bool {
        self.waits
    }
}

/// The weight of the land under the others' places in their leader's price of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Footprint {
    /// Their mean counts this many sixteenths, the leader's own cell the rest.
    Mean(u8),
    /// The dearest cell of all counts: all robots move at the pace of the slowest.
    Dearest,
}

impl Footprint {
    /// For a formation on the grid by its `share`, sixteenths, `None` for 0; in the plane
    /// (`is_rigid`) all robots move at one pace.
    #[must_use]
    pub const fn of(share: u8, is_rigid: bool) -> Option<Self> {
        match (share, is_rigid) {
            (0, _) => None,
            (_, true) => Some(Self::Dearest),
            (share, false) => Some(Self::Mean(share)),
        }
    }
}

/// Writes to `out` the formation's price of each cell of its leader within `radius` of `center`.
///
/// The price combines the leader's cell and those of the others' visible and passable places, as
/// `footprint` defines. Walls remain walls. O(cells * entries). `None` if `out` is too short for (2
/// radius + 1)^2 cells, or for as many of them as the window shows.
#[must_use]
pub fn blended<'a>(
    window: &Window<'_>,
    (center, radius): (Cell, u8),
    entries: &[TemplateEntry],
    footprint: Footprint,
    out: &'a mut [u8],
) -> Option<Window<'a>> {
    let (origin, width, height) = window.cut(center, radius);
    let out = out.get_mut(..usize::from(width) * usize::from(height))?;
    let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    for (price, (x, y)) in out.iter_mut().zip(rows) {
        let cell = origin + Cell::new(x.cast_signed(), y.cast_signed());
        let own = window.get(cell).unwrap_or(BLOCKED);
        let others = entries.iter().filter_map(|entry| window.get(cell + entry.offset)).filter(|&u| u != BLOCKED);
        *price = match footprint {
            _ if own == BLOCKED => own,
            Footprint::Dearest => others.fold(own, u8::max),
            Footprint::Mean(share) => {
                let share = u32::from(share.min(16));
                let (sum, count) = others.fold((0_u32, 0_u32), |(sum, count), u| (sum + u32::from(u), count + 1));
                match (sum * share).checked_div(count) {
                    // Rounded to nearest; at least 1, as both parts are.
                    Some(others) => ((u32::from(own) * (16 - share) + others + 8) >> 4).clamp(1, 255) as u8,
                    None => own,
                }
            }
        };
    }
    Window::new(out, origin, width, height)
}
