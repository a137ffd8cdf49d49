use super::{LandMap, TILE, Tile, tile_of};
use crate::cost::{Cost, EXCLUDED, Gain};
use crate::grid::{Cell, DIAGONAL, Norm, UNIT};
use core::fmt::Debug;

/// Sixteenths of a surplus that count, chosen on seed 1 of `staya experiment share` (dT
/// 12.2 to 14.8 % at 70 to 160 obstacles; with 8, 12.3 to 16.2 %; with 16, 12.3 to 15.6 %).
const BELIEVED_16: i64 = 10;
const HALF_TILE: u32 = TILE.unsigned_abs() as u32 >> 1;
/// Rounds of two sweeps; a path that turns back more often is priced too high.
const ROUNDS: u8 = 12;

/// The route parameters that matter here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Gains {
    /// Weight of travel time.
    pub a0: Gain,
    /// Ticks per cell of unknown land.
    pub a3: Gain,
    /// Length of a diagonal move.
    pub norm: Norm,
}

/// A source of knowledge about the land beyond the window.
pub trait FarLand: Debug {
    /// Calls `to` with the prices of paths to the cell `target`, if any are known. For a map of `T`
    /// tiles O(T), with 6 bytes per tile on the stack.
    fn look(&self, gains: &Gains, target: Cell, to: &mut dyn FnMut(&dyn Outlook));

    /// Whether it covers all the land, so that a long detour can be right.
    fn is_whole(&self) -> bool {
        false
    }
}

/// Prices of paths to the target.
pub trait Outlook {
    /// Cost of the path from `cell` to the target, below [`EXCLUDED`]; `straight` is that of a
    /// straight line across unknown land.
    fn price(&self, cell: Cell, straight: Cost) -> Cost;
}

/// The cost of the path to the target from each tile, compared to unknown land.
#[derive(Clone, Copy, Debug)]
struct OverTiles<'a> {
    costs: &'a [Cost],
    origin: Cell,
    bits: u32,
    target: Cell,
    gains: Gains,
}

impl OverTiles<'_> {
    /// How much more (below 0: less) the path from `cell` to the target costs than across unknown
    /// land; interpolated between four tiles, 0 where no tile is known.
    fn surplus(&self, cell: Cell) -> i64 {
        // Eighths of a tile, from the centre of the first one.
        let last = (8 << self.bits) - 9;
        // Not `clamp`, which could panic.
        let along = |at: i16, origin: i16| (2 * i32::from(at) - 3 - 8 * i32::from(origin)).min(last).max(0);
        let (x, y) = (along(cell.x, self.origin.x), along(cell.y, self.origin.y));
        let at = |dx: i32, dy: i32| {
            let (x, y) = ((x >> 3) + dx, (y >> 3) + dy);
            let place = self.origin + Cell::new(x as i16, y as i16);
            let cost = self.costs.get((y << self.bits | x) as usize).copied().unwrap_or(0);
            i64::from(cost) - i64::from(unknown(&self.gains, place, self.target))
        };
        let (east, north) = (i64::from(x & 7), i64::from(y & 7));
        let sum = at(0, 0) * (8 - east) * (8 - north)
            + at(1, 0) * east * (8 - north)
            + at(0, 1) * (8 - east) * north
            + at(1, 1) * east * north;
        // The best path through a tile is cheaper than its mean.
        (sum * BELIEVED_16) >> 10
    }
}

impl Outlook for OverTiles<'_> {
    fn price(&self, cell: Cell, straight: Cost) -> Cost {
        let price = i64::from(straight).saturating_add(self.surplus(cell));
        price.clamp(0, (EXCLUDED - 1).into()) as Cost
    }
}

fn unknown(gains: &Gains, from: Cell, to: Cell) -> Cost {
    let (dx, dy) = (from.x.abs_diff(to.x), from.y.abs_diff(to.y));
    let (longer, shorter) = (u32::from(dx.max(dy)), u32::from(dx.min(dy)));
    let tiles = match gains.norm {
        Norm::Chebyshev => longer * UNIT,
        Norm::Euclidean => (longer - shorter) * UNIT + shorter * DIAGONAL,
    };
    gains.a3.of(tiles.saturating_mul(TILE.unsigned_abs().into()))
}

pub(super) struct Search<const T: usize> {
    /// Price per cell, sixteenths.
    pub(super) price: [u16; T],
    pub(super) cost: [Cost; T],
}

impl<const T: usize> Search<T> {
    /// Tries paths over the neighbours on one side; returns whether the tile improved.
    fn relax(&mut self, at: usize, (x, y): (i32, i32), sides: [(i32, i32); 4], norm: Norm) -> bool {
        let bits = LandMap::<T>::BITS;
        let inside = 0..1_i32 << bits;
        let (Some(&own), Some(&before)) = (self.price.get(at), self.cost.get(at)) else { return false };
        let mut best = before;
        for (dx, dy) in sides {
            let (x, y) = (x + dx, y + dy);
            if !(inside.contains(&x) && inside.contains(&y)) {
                continue;
            }
            let beside = (y << bits | x) as usize;
            let (Some(&price), Some(&cost)) = (self.price.get(beside), self.cost.get(beside)) else { continue };
            let is_diagonal = dx != 0 && dy != 0 && norm == Norm::Euclidean;
            let length = if is_diagonal { DIAGONAL } else { UNIT };
            let step = (u32::from(own) + u32::from(price)).saturating_mul(length * HALF_TILE);
            best = best.min(cost.saturating_add(step));
        }
        if let Some(cost) = self.cost.get_mut(at) {
            *cost = best;
        }
        best < before
    }

    fn sweep(&mut self, norm: Norm) {
        const BEFORE: [(i32, i32); 4] = [(-1, 0), (-1, -1), (0, -1), (1, -1)];
        const BEHIND: [(i32, i32); 4] = [(1, 0), (1, 1), (0, 1), (-1, 1)];
        let bits = LandMap::<T>::BITS;
        let place = |at: usize| ((at & ((1 << bits) - 1)) as i32, (at >> bits) as i32);
        for _ in 0..ROUNDS {
            let mut is_better = false;
            for at in 0..T {
                is_better |= self.relax(at, place(at), BEFORE, norm);
            }
            for at in (0..T).rev() {
                is_better |= self.relax(at, place(at), BEHIND, norm);
            }
            if !is_better {
                break;
            }
        }
    }
}

impl<const T: usize> LandMap<T> {
    /// Land changes gradually: unknown tiles get a mean of their neighbours and of unknown land.
    fn price(&self, gains: &Gains, at: Cell) -> u16 {
        let known =
            |tile: Tile| tile.ticks_16().map(|ticks| (u32::from(gains.a0.sixteenths()) * u32::from(ticks)) >> 4);
        let narrow = |price: u32| price.min(u16::MAX.into()) as u16;
        if let Some(price) = known(self.get(at)) {
            return narrow(price);
        }
        let beside = (-1..=1).flat_map(|y| (-1..=1).map(move |x| at + Cell::new(x, y)));
        let (count, sum) = beside
            .filter_map(|at| known(self.get(at)))
            .fold((0_u32, 0_u32), |(count, sum), price| (count + 1, sum.saturating_add(price)));
        let unknown = u32::from(gains.a3.sixteenths());
        let mean = sum.checked_div(count);
        narrow(mean.map_or(unknown, |mean| (3 * unknown).saturating_add(mean.saturating_mul(5)) >> 3))
    }
}

impl<const T: usize> LandMap<T> {
    /// The cost of the path to the tile `target` from each tile; those off the land are as dear as
    /// can be. O(T).
    #[inline]
    pub(super) fn search(&self, gains: &Gains, target: Cell, is_land: impl Fn(Cell) -> bool) -> Search<T> {
        let mut search = Search::<T> { price: [0; T], cost: [Cost::MAX; T] };
        let (bits, origin) = (Self::BITS, self.origin());
        let side = 1_i32 << bits;
        let place = |at: usize| ((at & ((1 << bits) - 1)) as i32, (at >> bits) as i32);
        let is_edge = |along: i32| along == 0 || along == side - 1;
        let to_target = (i32::from(target.x) - i32::from(origin.x), i32::from(target.y) - i32::from(origin.y));
        let is_inside = (0..side).contains(&to_target.0) && (0..side).contains(&to_target.1);
        for (at, (price, cost)) in search.price.iter_mut().zip(&mut search.cost).enumerate() {
            let (x, y) = place(at);
            let here = origin + Cell::new(x as i16, y as i16);
            *price = if is_land(here) { self.price(gains, here) } else { u16::MAX };
            if (x, y) == to_target {
                *cost = 0;
            } else if !is_inside && (is_edge(x) || is_edge(y)) {
                *cost = unknown(gains, here, target);
            }
        }
        search.sweep(gains.norm);
        search
    }
}

impl<const T: usize> FarLand for LandMap<T> {
    #[inline(never)]
    fn look(&self, gains: &Gains, target: Cell, to: &mut dyn FnMut(&dyn Outlook)) {
        if self.is_empty() {
            return;
        }
        let (bits, origin, target) = (Self::BITS, self.origin(), tile_of(target));
        let search = self.search(gains, target, |_| true);
        to(&OverTiles { costs: &search.cost, origin, bits, target, gains: *gains });
    }
}
