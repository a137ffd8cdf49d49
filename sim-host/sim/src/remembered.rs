//! The map that robots have merged over the radio, collected over a whole run, as by a base station
//! in contact with all of them. It forgets nothing.
//!
//! [`Remembered::map`] is a map file for `scouting.map` and `staya terrain model`,
//! [`Remembered::on_board`] what a base station itself makes tables of.

#[cfg(test)]
mod tests;

use crate::engine::Moment;
use crate::scenario::Scenario;
use crate::terrain::Terrain;
use staya_controller::grid::Cell;
use staya_controller::land::{LandMap, LandPatch, PATCH_HEIGHT, PATCH_TILES, PATCH_WIDTH, TILE, Tile};

/// Ticks between two looks at the robots' maps. In so few moves no tile leaves their squares.
const EVERY: u32 = 16;
/// Sixteenths of a tick, per cell of a tile, by which a cell is a tick dearer: each row, column and
/// diagonal of a tile has its share of them.
const STEPS: [[u16; 4]; 4] = [[0, 11, 6, 13], [14, 5, 8, 3], [9, 2, 15, 4], [7, 12, 1, 10]];

/// Tiles of the base station's map: 256 cells along each side.
pub const TILES: usize = 4096;

/// A tile, and the tick from which it is known at the latest.
type Seen = (i64, Tile);

/// The newest price of each tile.
#[derive(Clone, Debug, PartialEq)]
pub struct Remembered {
    sides: [u16; 2],
    /// Ticks in which a tile grows older by one age.
    ages_in: f64,
    /// Sixteenths of a tick per unknown cell.
    unknown: u16,
    tiles: Vec<Option<Seen>>,
}

impl Remembered {
    /// Creates the map of a scenario's land without known tiles; `None` if no robot shares a map.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Option<Self> {
        let forget_after = scenario.laws.maps?.forget_after;
        let ages_in = f64::from(forget_after.as_micros()) / 16.0 / f64::from(scenario.tick_us);
        let land = &scenario.land.terrain;
        let sides = [land.width(), land.height()].map(|cells| cells.div_ceil(TILE.unsigned_abs()));
        let [columns, rows] = sides.map(usize::from);
        let unknown = scenario.route().params.a3.sixteenths();
        Some(Self { sides, ages_in, unknown, tiles: vec![None; columns * rows] })
    }

    /// Looks at a moment of the run. O(robots x tiles) in every 16th tick.
    pub fn look(&mut self, moment: &Moment<'_>) {
        let tick = moment.row.tick;
        if let Some(run) = moment.run.filter(|_| tick.is_multiple_of(EVERY)) {
            run.shared_maps(&mut |map| self.merge(map, tick));
        }
    }

    /// Merges a robot's map: the newer price wins, of equally new ones the dearer. O(tiles).
    pub fn merge<const T: usize>(&mut self, map: &LandMap<T>, tick: u32) {
        let worth = |(since, tile): Seen| (since, tile.ticks_16());
        for (at, known) in cells(self.sides).zip(&mut self.tiles) {
            let tile = map.get(at);
            let seen = (i64::from(tick) - (f64::from(tile.age()) * self.ages_in) as i64, tile);
            if tile.is_known() && known.is_none_or(|old| worth(old) < worth(seen)) {
                *known = Some(seen);
            }
        }
    }

    /// Share of the tiles that are known, 0 to 1.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.tiles.iter().flatten().count() as f64 / self.tiles.len() as f64
    }

    /// The tile at this position (in tiles).
    #[must_use]
    pub fn get(&self, at: Cell) -> Tile {
        let [x, y] = [at.x, at.y].map(u16::try_from);
        let inside = x.ok().zip(y.ok()).filter(|&(x, y)| x < self.sides[0] && y < self.sides[1]);
        let index = inside.map(|(x, y)| usize::from(y) * usize::from(self.sides[0]) + usize::from(x));
        index.and_then(|index| self.tiles[index]).map_or(Tile::UNKNOWN, |(_, tile)| tile)
    }

    /// The map as land of the size of `land`: whole ticks per cell, on average over a tile its
    /// price. Unknown tiles cost what robots suppose of them ([`LandMap::write_costs`]).
    #[must_use]
    pub fn map(&self, land: &Terrain) -> Terrain {
        let mut map = land.clone();
        map.mark_unknown(std::iter::empty());
        for at in cells(self.sides) {
            let price = self.price(at);
            for (y, row) in (0..).zip(STEPS) {
                for (x, step) in (0..).zip(row) {
                    let class = (price >> 4) + u16::from(step < (price & 15));
                    map.set(Cell::new(at.x * TILE + x, at.y * TILE + y), class.clamp(1, 255) as u8);
                }
            }
        }
        map
    }

    /// Sixteenths of a tick per cell.
    fn price(&self, at: Cell) -> u16 {
        if let Some(price) = self.get(at).ticks_16() {
            return price;
        }
        let beside = (-1..=1).flat_map(|y| (-1..=1).map(move |x| at + Cell::new(x, y)));
        let known: Vec<u32> = beside.filter_map(|at| self.get(at).ticks_16()).map(u32::from).collect();
        let mean = known.iter().sum::<u32>().checked_div(known.len() as u32);
        mean.map_or(self.unknown, |mean| ((3 * u32::from(self.unknown) + 5 * mean) >> 3) as u16)
    }

    /// The map of a base station in the middle of the land, which makes tables of it; the tiles
    /// within 128 cells.
    #[must_use]
    pub fn on_board(&self) -> LandMap<TILES> {
        let [columns, rows] = self.sides.map(|side| side as i16);
        let mut map = LandMap::around(Cell::new(columns / 2 * TILE, rows / 2 * TILE));
        for y in (0..rows).step_by(PATCH_HEIGHT as usize) {
            for x in (0..columns).step_by(PATCH_WIDTH as usize) {
                let unseen = LandPatch { corner: Cell::new(x, y), tiles: [Tile::UNKNOWN; PATCH_TILES] };
                let mut patch = unseen;
                for ((at, _), tile) in unseen.iter().zip(&mut patch.tiles) {
                    *tile = self.get(at);
                }
                map.hear(&patch);
            }
        }
        map
    }
}

/// Positions of tiles, row by row.
fn cells([columns, rows]: [u16; 2]) -> impl Iterator<Item = Cell> {
    (0..rows as i16).flat_map(move |y| (0..columns as i16).map(move |x| Cell::new(x, y)))
}
