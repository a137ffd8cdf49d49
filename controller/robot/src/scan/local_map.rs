//! The land nearby as seen by range scans (J. Borenstein, Y. Koren 1991, "Histogramic in-motion
//! mapping for mobile robot obstacle avoidance", HIMM): a hit adds 3 to its cell, a beam that
//! crosses a cell subtracts 1, on 0..=15. Here a cell counts once per scan, a hit wins over
//! crossing beams, and evidence fades.

use super::Scan;
use staya_controller::geom::Vec2;
use staya_controller::grid::{BLOCKED, Cell, GridFrame, Window};
use staya_controller::scalar::Scalar;
use staya_controller::time::{Duration, Instant};

/// How cells gain and lose evidence of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MapParams {
    /// Added by a scan with a hit in the cell. A larger value makes obstacles of wrong ranges.
    pub hit: u8,
    /// Subtracted by a scan with a beam through the cell and no hit.
    pub free: u8,
    /// The maximum evidence; divided by `free`, the number of scans that clear a cell.
    pub ceiling: u8,
    /// Evidence from which the cell is blocked; more than 0.
    pub blocked_at: u8,
    /// Period after which a cell loses one point; above 0. A longer period remembers what is behind
    /// the robot; a shorter one forgets robots that left unseen.
    pub fade_every: Duration,
    /// Impassability of unknown land, 1..=255; the robot avoids unseen cells with [`BLOCKED`].
    pub ground: u8,
}

impl Default for MapParams {
    /// HIMM's 3, 1 and 15; blocked by the second scan with a hit; forgotten after 15 s unseen.
    fn default() -> Self {
        Self { hit: 3, free: 1, ceiling: 15, blocked_at: 6, fade_every: Duration::from_millis(1000), ground: 1 }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Known {
    evidence: u8,
    ground: u8,
    news: News,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum News {
    None,
    Free,
    Hit,
}

/// A square of `SIDE` by `SIDE` cells that moves with the robot, in its middle if `SIDE` is odd;
/// route guidance of default capacity uses 11. Four bytes per cell. It forgets all other cells.
#[derive(Clone, Debug)]
pub struct LocalMap<const SIDE: usize = 11> {
    params: MapParams,
    origin: Cell,
    known: [[Known; SIDE]; SIDE],
    window: [[u8; SIDE]; SIDE],
    own: Cell,
    faded: Option<Instant>,
}

impl<const SIDE: usize> LocalMap<SIDE> {
    const SIDE_CELLS: i16 = {
        assert!(SIDE > 0 && SIDE <= 255, "a side of 1 to 255 cells");
        SIDE as i16
    };

    /// Creates a map around `own` without observations.
    #[must_use]
    pub const fn new(params: MapParams, own: Cell) -> Self {
        let known = Known { evidence: 0, ground: params.ground, news: News::None };
        Self {
            params,
            origin: Self::corner(own),
            known: [[known; SIDE]; SIDE],
            window: [[params.ground; SIDE]; SIDE],
            own,
            faded: None,
        }
    }

    /// Adds a scan made at `now` by a robot whose reference point is at `place_m` in the world, at
    /// `heading_rad`. Hits for which `is_robot` (relative position, metres along the world's axes)
    /// returns true clear their beam but mark nothing.
    ///
    /// Beams are followed in steps of half a cell up to the square's edge. Returns false without
    /// any change if the robot is off the grid. Bounded work: O(SIDE^2) for the cells, O(SIDE) and
    /// one call of `is_robot` for each range.
    pub fn observe<S: Scalar>(
        &mut self,
        frame: &GridFrame<S>,
        place_m: Vec2<S>,
        heading_rad: S,
        scan: &Scan<'_, S>,
        now: Instant,
        is_robot: impl Fn(Vec2<S>) -> bool,
    ) -> bool {
        let per_cell = S::ONE.checked_div(frame.cell_m);
        let Some((own, per_cell)) = frame.cell(place_m).zip(per_cell) else {
            return false;
        };
        self.follow(own);
        self.fade(now);
        // Cells from the corner are small numbers at any position.
        let half = frame.cell_m * S::HALF;
        let corner_m = frame.center(self.origin) - Vec2::new(half, half);
        let robot = (place_m - corner_m) * per_cell;
        for ray in scan.rays(heading_rad).flatten() {
            let from = robot + ray.from_m * per_cell;
            self.clear(from, ray.ahead * S::HALF, ray.free_m * per_cell);
            let end_m = ray.end_m();
            if ray.is_hit && !is_robot(end_m) {
                self.set(robot + end_m * per_cell, News::Hit);
            }
        }
        self.judge();
        self.show();
        true
    }

    /// Sets the ground in `cell` from another sensor: impassability, or [`BLOCKED`] for a cliff,
    /// until it is set again or the cell leaves the square. Returns false outside the square.
    pub fn set_ground(&mut self, cell: Cell, ground: u8) -> bool {
        let Some(known) = self.at_mut(cell) else {
            return false;
        };
        known.ground = ground;
        self.show();
        true
    }

    /// Moves the square so that it is around `own`. O(SIDE^2).
    pub fn follow(&mut self, own: Cell) {
        let origin = Self::corner(own);
        if origin != self.origin {
            let shift = |to: i16, from: i16| i32::from(to) - i32::from(from);
            let (dx, dy) = (shift(origin.x, self.origin.x), shift(origin.y, self.origin.y));
            let old = self.known;
            let nothing = Known { evidence: 0, ground: self.params.ground, news: News::None };
            let from = |at: usize, shift: i32| {
                usize::try_from(i32::try_from(at).unwrap_or(i32::MAX).saturating_add(shift)).ok()
            };
            self.known = core::array::from_fn(|y| {
                let row = from(y, dy).and_then(|y| old.get(y));
                core::array::from_fn(|x| {
                    let known = row.zip(from(x, dx)).and_then(|(row, x)| row.get(x));
                    known.copied().unwrap_or(nothing)
                })
            });
            self.origin = origin;
        }
        self.own = own;
        self.show();
    }

    /// The cells, for [`OnGrid::window`](staya_controller::agent::OnGrid::window) and
    /// [`grid_walls`](staya_controller::obstacle::grid_walls). The own cell is passable.
    #[must_use]
    pub fn window(&self) -> Option<Window<'_>> {
        let side = Self::SIDE_CELLS.cast_unsigned();
        Window::new(self.window.as_flattened(), self.origin, side, side)
    }

    const fn corner(own: Cell) -> Cell {
        let half = Self::SIDE_CELLS >> 1;
        Cell::new(own.x.saturating_sub(half), own.y.saturating_sub(half))
    }

    fn at_mut(&mut self, cell: Cell) -> Option<&mut Known> {
        let along = |at: i16, origin: i16| usize::try_from(i32::from(at) - i32::from(origin)).ok();
        let (x, y) = along(cell.x, self.origin.x).zip(along(cell.y, self.origin.y))?;
        self.known.get_mut(y)?.get_mut(x)
    }

    /// Lengths are in cells from the corner; `step` is half a cell long.
    fn clear<S: Scalar>(&mut self, from: Vec2<S>, step: Vec2<S>, length: S) {
        let (mut place, mut gone) = (from, S::ZERO);
        for _ in 0..SIDE.saturating_mul(4) {
            if !(gone < length && self.set(place, News::Free)) {
                return;
            }
            place += step;
            gone += S::HALF;
        }
    }

    /// `place` is in cells from the corner; false outside the square.
    fn set<S: Scalar>(&mut self, place: Vec2<S>, news: News) -> bool {
        let along = |at: S| usize::try_from(at.floor_to_i32()?).ok();
        let Some((x, y)) = along(place.x).zip(along(place.y)) else {
            return false;
        };
        let Some(known) = self.known.get_mut(y).and_then(|row| row.get_mut(x)) else {
            return false;
        };
        if known.news != News::Hit {
            known.news = news;
        }
        true
    }

    fn judge(&mut self) {
        let params = self.params;
        for known in self.known.as_flattened_mut() {
            let evidence = match known.news {
                News::None => known.evidence,
                News::Free => known.evidence.saturating_sub(params.free),
                News::Hit => known.evidence.saturating_add(params.hit),
            };
            known.evidence = evidence.min(params.ceiling);
            known.news = News::None;
        }
    }

    fn fade(&mut self, now: Instant) {
        let Some(mut last) = self.faded else {
            self.faded = Some(now);
            return;
        };
        let every = self.params.fade_every;
        let mut loss: u8 = 0;
        while every > Duration::ZERO && now.since(last) >= every && loss < self.params.ceiling {
            last = last + every;
            loss = loss.saturating_add(1);
        }
        if loss == 0 && now.since(last) >= Duration::ZERO {
            return;
        }
        // The period restarts after a long pause, or if the clock was set back.
        self.faded = Some(if loss == self.params.ceiling || loss == 0 { now } else { last });
        for known in self.known.as_flattened_mut() {
            known.evidence = known.evidence.saturating_sub(loss);
        }
    }

    fn show(&mut self) {
        let blocked_at = self.params.blocked_at;
        let known = self.known.as_flattened().iter();
        for (shown, known) in self.window.as_flattened_mut().iter_mut().zip(known) {
            *shown = if known.evidence >= blocked_at { BLOCKED } else { known.ground };
        }
        let along = |at: i16, origin: i16| usize::try_from(i32::from(at) - i32::from(origin)).ok();
        let own = along(self.own.x, self.origin.x).zip(along(self.own.y, self.origin.y));
        let shown = own.and_then(|(x, y)| self.window.get_mut(y)?.get_mut(x));
        if let Some(shown) = shown {
            *shown = (*shown).max(1);
        }
    }
}
