//! Neighbour search with a uniform grid.

use super::nearest::Nearest;
use super::space::margin;
use super::{Found, Query, Real, Search, Space, numbered};
use std::ops::Range;

/// Points sorted by squares (in space, cubes); the points of a cell are contiguous in memory.
///
/// Built by a counting sort: O(n + cells), without hash maps, and without allocation once the
/// buffers have grown. A query costs O(points in the cells that its ball may touch). There are at
/// most about two cells per point (or 4096 in all), however far apart the points are; if this limit
/// applies, cells are larger and queries slower. Bytes: 8 per cell, 8 + the point per point.
#[derive(Clone, Debug)]
pub struct Cells<R, const D: usize> {
    space: Space<R, D>,
    side: R,
    origin: [R; D],
    counts: [u32; D],
    /// Cells per unit of length along each axis.
    scale: [R; D],
    width: [R; D],
    /// Start of each cell's points in `order`, and the end of the last.
    starts: Vec<u32>,
    /// Indices of the points by cell, ascending in each.
    order: Vec<u32>,
    points: Vec<[R; D]>,
    cell_of: Vec<u32>,
}

impl<R: Real, const D: usize> Cells<R, D> {
    /// Creates an empty index. The best `side` is the radius of the queries, or half of it for
    /// dense points. The side does not affect results; one that is not above 0 means a single cell.
    #[must_use]
    pub fn new(space: Space<R, D>, side: R) -> Self {
        Self {
            space,
            side,
            origin: [R::ZERO; D],
            counts: [1; D],
            scale: [R::ZERO; D],
            width: [R::ZERO; D],
            starts: vec![0, 0],
            order: Vec::new(),
            points: Vec::new(),
            cell_of: Vec::new(),
        }
    }

    /// Indices of the points by cell. Queries in this order are cache-friendly.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Number of cells.
    #[must_use]
    pub const fn cells(&self) -> usize {
        self.starts.len() - 1
    }

    fn lay(&mut self, points: &[[R; D]]) {
        let (low, length) = match self.space.period() {
            Some(period) => ([R::ZERO; D], period),
            None => extent(points),
        };
        self.origin = low;
        let most = (2 * points.len() as u64).max(4096);
        // The loop ends because doubling the side leads to one cell per axis.
        let mut side = if self.side > R::ZERO { self.side } else { R::MAX };
        loop {
            self.counts = length.map(|length| length.over(side).cell(u32::MAX).max(1));
            let all = self.counts.iter().fold(1_u64, |all, &n| all.saturating_mul(n.into()));
            if all <= most {
                break;
            }
            side *= R::TWO;
        }
        let count = |axis: usize| R::from_f64(self.counts[axis].into()).unwrap_or(R::ONE);
        self.width = std::array::from_fn(|axis| length[axis].over(count(axis)));
        self.scale = std::array::from_fn(|axis| {
            let scale = count(axis).over(length[axis]);
            if scale.is_finite() { scale } else { R::ZERO }
        });
    }

    #[inline]
    fn along(&self, axis: usize, coordinate: R) -> u32 {
        let steps = (coordinate - self.origin[axis]) * self.scale[axis];
        steps.cell(self.counts[axis])
    }

    /// Number of a cell; cells along the first axis are consecutive.
    #[inline]
    fn cell(&self, point: &[R; D]) -> u32 {
        let mut cell = 0;
        for axis in (0..D).rev() {
            cell = cell * self.counts[axis] + self.along(axis, point[axis]);
        }
        cell
    }

    fn span(&self, axis: usize, at: R, radius: R) -> Span {
        let count = self.counts[axis];
        // Both ends use the same monotonic function as the points, so rounding cannot exclude a
        // point within the radius. The margin exceeds the rounding error of the sums.
        let around = self.space.period().map(|period| period[axis]);
        let margin = margin(at, radius + around.unwrap_or(R::ZERO));
        let reach = radius + margin;
        let (low, high) = (at - reach, at + reach);
        let straight = || Span::Straight(self.along(axis, low), self.along(axis, high) + 1);
        let Some(period) = around else {
            return straight();
        };
        if reach + reach >= period {
            return Span::Around(0, count);
        }
        let (from, to) = if low < R::ZERO {
            let from = self.along(axis, low + period - margin);
            (from, self.along(axis, high) + 1)
        } else if high >= period {
            let to = self.along(axis, high - period + margin) + 1;
            (self.along(axis, low), to)
        } else {
            return straight();
        };
        if from < to { Span::Around(0, count) } else { Span::Around(from, to) }
    }

    fn is_beyond(&self, axis: usize, place: u32, at: R, nearest: &Nearest<'_, R, D>) -> bool {
        let place = R::from_f64(place.into()).unwrap_or(R::ZERO);
        let low = self.origin[axis] + place * self.width[axis];
        let high = low + self.width[axis];
        let gap = (low - at).max(at - high);
        let safe = gap - margin(at, high.abs() + self.origin[axis].abs());
        safe > R::ZERO && nearest.is_beyond(safe)
    }

    #[inline]
    fn scan(&self, at: [R; D], row: usize, columns: Range<u32>, nearest: &mut Nearest<'_, R, D>) {
        let from = self.starts[row + columns.start as usize] as usize;
        let to = self.starts[row + columns.end as usize] as usize;
        for (&index, &point) in self.order[from..to].iter().zip(&self.points[from..to]) {
            nearest.offer(index, self.space.offset(at, point));
        }
    }

    /// Visits the axes from last to first, and the cells of each axis from the middle outwards, so
    /// that outer rows can be skipped once the nearest points are found.
    fn descend(&self, at: [R; D], axis: usize, row: usize, spans: &[Span; D], nearest: &mut Nearest<'_, R, D>) {
        let row = row * self.counts[axis] as usize;
        let inner = |place: u32, nearest: &mut Nearest<'_, R, D>| {
            self.descend(at, axis - 1, row + place as usize, spans, nearest);
        };
        match spans[axis] {
            Span::Straight(from, to) if axis == 0 => self.scan(at, row, from..to, nearest),
            Span::Around(from, to) if axis == 0 => {
                for part in around(from, to, self.counts[axis]) {
                    self.scan(at, row, part, nearest);
                }
            }
            Span::Around(from, to) => {
                let parts = around(from, to, self.counts[axis]);
                parts.into_iter().flatten().for_each(|place| inner(place, nearest));
            }
            Span::Straight(from, to) => {
                let middle = self.along(axis, at[axis]).max(from).min(to - 1);
                let (mut below, mut above) = (middle, middle);
                while from < below || above < to {
                    if above < to && !self.is_beyond(axis, above, at[axis], nearest) {
                        inner(above, nearest);
                        above += 1;
                    } else {
                        above = to;
                    }
                    if from < below && !self.is_beyond(axis, below - 1, at[axis], nearest) {
                        below -= 1;
                        inner(below, nearest);
                    } else {
                        below = from;
                    }
                }
            }
        }
    }
}

#[derive(Clone, Copy, Debug)]
enum Span {
    /// From one place to before another; distances along them are plain differences.
    Straight(u32, u32),
    /// From the first place to the end and from the beginning to before the second; all if the
    /// first is smaller. Distances may be shorter the other way around.
    Around(u32, u32),
}

fn around(from: u32, to: u32, count: u32) -> [Range<u32>; 2] {
    if from < to { [from..to, 0..0] } else { [0..to, from..count] }
}

impl<R: Real, const D: usize> Search<R, D> for Cells<R, D> {
    fn rebuild(&mut self, points: &[[R; D]]) {
        let count = numbered(points);
        self.lay(points);
        let cells: usize = self.counts.iter().map(|&n| n as usize).product();
        self.starts.clear();
        self.starts.resize(cells + 1, 0);
        self.cell_of.clear();
        for &point in points {
            let cell = self.cell(&self.space.fold(point));
            self.cell_of.push(cell);
            self.starts[cell as usize] += 1;
        }
        let mut end = 0;
        for start in &mut self.starts {
            end += *start;
            *start = end;
        }
        // Filled from the back: ends become starts, and indices ascend.
        self.order.resize(points.len(), 0);
        self.points.resize(points.len(), [R::ZERO; D]);
        for index in (0..count).rev() {
            let place = &mut self.starts[self.cell_of[index as usize] as usize];
            *place -= 1;
            self.order[*place as usize] = index;
            self.points[*place as usize] = self.space.fold(points[index as usize]);
        }
    }

    fn within(&self, query: &Query<R, D>, found: &mut Vec<Found<R, D>>) {
        let mut nearest = Nearest::new(query, found);
        let at = self.space.fold(query.at);
        let is_sound = at.iter().all(|&c| c.is_finite());
        if is_sound && query.radius >= R::ZERO {
            let spans = std::array::from_fn(|axis| self.span(axis, at[axis], query.radius));
            self.descend(at, D - 1, 0, &spans, &mut nearest);
        }
        nearest.finish();
    }
}

fn extent<R: Real, const D: usize>(points: &[[R; D]]) -> ([R; D], [R; D]) {
    let (mut low, mut high) = ([R::MAX; D], [-R::MAX; D]);
    for point in points {
        for axis in 0..D {
            if point[axis].is_finite() {
                if point[axis] < low[axis] {
                    low[axis] = point[axis];
                }
                if point[axis] > high[axis] {
                    high[axis] = point[axis];
                }
            }
        }
    }
    let length = std::array::from_fn(|axis| if high[axis] > low[axis] { high[axis] - low[axis] } else { R::ZERO });
    (low, length)
}
