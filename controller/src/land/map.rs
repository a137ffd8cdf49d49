use super::tile::{AGES, LandPatch, PATCH_HEIGHT, PATCH_TILES, PATCH_WIDTH, Tile};
use super::tile_of;
use crate::grid::{Cell, Window};
use crate::list::SparseVec;
use crate::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

/// Own observations up to this age override messages.
const OWN_STANDS: u8 = AGES >> 2;
const PATCH_BITS: [u32; 2] = [PATCH_WIDTH.trailing_zeros(), PATCH_HEIGHT.trailing_zeros()];

/// Parameters of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MapParams {
    /// Observations older than this are forgotten, 16 times the step of ages; above 0, at most 35
    /// minutes. A shorter time adapts faster and drops false reports sooner; a longer one remembers
    /// more.
    pub forget_after: Duration,
}

impl Default for MapParams {
    fn default() -> Self {
        Self { forget_after: Duration::from_millis(600_000) }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Known {
    pub(super) tile: Tile,
    is_own: bool,
    /// Seen by the robot itself, and not sent yet.
    is_news: bool,
}

/// A square of `T` tiles that moves with the robot. `T` is 0 (none), 256, 1024 or 4096, for 64, 128
/// or 256 cells along each side; at least three eighths of a side lie ahead.
///
/// Memory: 3 bytes per tile, on a host none before the first tile is known.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct LandMap<const T: usize> {
    tiles: SparseVec<Known, T>,
    origin: Cell,
    aged_at: Option<Instant>,
    next: u16,
    repeats: bool,
}

impl<const T: usize> Default for LandMap<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const T: usize> LandMap<T> {
    pub(super) const BITS: u32 = {
        let bits = T.trailing_zeros() >> 1;
        assert!(T == 0 || T == 256 || T == 1024 || T == 4096, "a map has 0, 256, 1024 or 4096 tiles");
        if T == 0 { 0 } else { bits }
    };
    const SIDE: i16 = if T == 0 { 0 } else { 1 << Self::BITS };

    /// Creates a map without known tiles.
    #[must_use]
    pub const fn new() -> Self {
        Self { tiles: SparseVec::new(), origin: Cell::new(0, 0), aged_at: None, next: 0, repeats: false }
    }

    /// Creates a map without known tiles around `cell`, for a base station, which hears patches and
    /// sees nothing itself.
    #[must_use]
    pub fn around(cell: Cell) -> Self {
        let mut map = Self::new();
        map.center(cell);
        map
    }

    /// The tile at this position (in tiles).
    #[must_use]
    pub fn get(&self, at: Cell) -> Tile {
        self.index(at).and_then(|index| self.tiles.get(index)).map_or(Tile::UNKNOWN, |known| known.tile)
    }

    pub(super) const fn origin(&self) -> Cell {
        self.origin
    }

    /// Whether no tile has ever been known.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.tiles.is_empty()
    }

    fn index(&self, at: Cell) -> Option<usize> {
        let inside = |at: i16, origin: i16| (0..i32::from(Self::SIDE)).contains(&(i32::from(at) - i32::from(origin)));
        let mask = Self::SIDE.saturating_sub(1);
        let index =
            usize::from((at.x & mask).cast_unsigned()) | usize::from((at.y & mask).cast_unsigned()) << Self::BITS;
        (inside(at.x, self.origin.x) && inside(at.y, self.origin.y)).then_some(index)
    }

    fn get_mut(&mut self, at: Cell) -> Option<&mut Known> {
        let index = self.index(at)?;
        self.tiles.get_mut(index)
    }

    fn center(&mut self, cell: Cell) {
        while T > 0 && self.tiles.push(Known::default()).is_ok() {}
        let at = tile_of(cell);
        let along = |at: i16, bits: u32| {
            let half = 1_i16 << (bits - 1);
            (at.saturating_add(half) >> bits << bits).saturating_sub(Self::SIDE >> 1)
        };
        let [x, y] = PATCH_BITS;
        let before = self.origin;
        self.origin = Cell::new(along(at.x, x), along(at.y, y));
        if self.origin == before {
            return;
        }
        for place in self.places(self.origin) {
            let was_inside =
                |at: i16, origin: i16| i32::from(at) - i32::from(origin) < i32::from(Self::SIDE) && at >= origin;
            if !(was_inside(place.x, before.x) && was_inside(place.y, before.y))
                && let Some(known) = self.get_mut(place)
            {
                *known = Known::default();
            }
        }
    }

    fn places(&self, origin: Cell) -> impl Iterator<Item = Cell> + use<T> {
        (0..Self::SIDE).flat_map(move |y| (0..Self::SIDE).map(move |x| origin + Cell::new(x, y)))
    }

    /// Ages the tiles, and forgets the oldest; call it regularly. O(T) when tiles age.
    pub fn age(&mut self, params: &MapParams, now: Instant) {
        let step = Duration::from_micros(params.forget_after.as_micros() >> 4);
        let since = self.aged_at.map(|at| now.since(at));
        match since {
            // The clock wrapped halfway: start over.
            Some(since) if since >= Duration::ZERO => {
                let due = since.as_micros().checked_div(step.as_micros()).unwrap_or(0).min(AGES.into());
                if due <= 0 {
                    return;
                }
                for known in self.tiles.iter_mut() {
                    for _ in 0..due {
                        known.tile = known.tile.older();
                    }
                    if !known.tile.is_known() {
                        *known = Known::default();
                    }
                }
            }
            _ => {}
        }
        self.aged_at = Some(now);
    }

    /// Adds what the robot in `cell` sees. O(cells of the window).
    pub fn see(&mut self, window: &Window<'_>, cell: Cell) {
        self.center(cell);
        let origin = self.origin;
        let last = |from: i16, size: u16| from.saturating_add_unsigned(size.saturating_sub(1));
        let from = tile_of(window.origin());
        let to = tile_of(Cell::new(last(window.origin().x, window.width()), last(window.origin().y, window.height())));
        let inside = |at: i16, origin: i16| at >= origin && at < origin.saturating_add(Self::SIDE);
        for y in (from.y..=to.y).filter(|&y| inside(y, origin.y)) {
            for x in (from.x..=to.x).filter(|&x| inside(x, origin.x)) {
                let at = Cell::new(x, y);
                let (Some(tile), Some(known)) = (Tile::seen(window, at), self.get_mut(at)) else { continue };
                let is_same = known.is_own && known.tile.level() == tile.level();
                *known = Known { tile, is_own: true, is_news: known.is_news || !is_same };
            }
        }
    }

    /// Adds a received patch: the newer tile wins, except against recent own observations; tiles
    /// outside the square are dropped. O([`PATCH_TILES`]).
    pub fn hear(&mut self, patch: &LandPatch) {
        for (at, tile) in patch.iter() {
            let Some(known) = self.get_mut(at) else { continue };
            if known.is_own && known.tile.age() < OWN_STANDS {
                continue;
            }
            let merged = known.tile.merged(tile);
            if merged != known.tile {
                *known = Known { tile: merged, is_own: false, is_news: false };
            }
        }
    }

    /// Returns the patch to send next: the one with the most unsent observations, and in every
    /// second message an old one in turn, for robots that missed it. `None` without a tile. O(T).
    pub fn say(&mut self) -> Option<LandPatch> {
        self.repeats = !self.repeats;
        let news = self.corners().map(|corner| (corner, self.count(corner, |known| known.is_news)));
        let news = news.filter(|&(_, news)| news > 0).max_by_key(|&(_, news)| news).map(|(corner, _)| corner);
        let again = || {
            let count = self.corners().count();
            let turns = self.corners().zip(0..).cycle().skip(self.next.into()).take(count);
            turns.into_iter().find(|&(corner, _)| self.count(corner, |known| known.tile.is_known()) > 0)
        };
        let corner = match news {
            Some(corner) if self.repeats => corner,
            _ => {
                let (corner, turn) = again()?;
                self.next = turn + 1;
                corner
            }
        };
        let mut patch = LandPatch { corner, tiles: [Tile::UNKNOWN; PATCH_TILES] };
        let places = (0..PATCH_HEIGHT).flat_map(|y| (0..PATCH_WIDTH).map(move |x| Cell::new(x, y)));
        for (place, tile) in places.zip(&mut patch.tiles) {
            if let Some(known) = self.get_mut(corner + place) {
                *tile = known.tile;
                known.is_news = false;
            }
        }
        Some(patch)
    }

    fn corners(&self) -> impl Iterator<Item = Cell> + Clone + use<T> {
        let (origin, [x_bits, y_bits]) = (self.origin, PATCH_BITS);
        let rows = 0..Self::SIDE >> y_bits;
        rows.flat_map(move |y| (0..Self::SIDE >> x_bits).map(move |x| origin + Cell::new(x << x_bits, y << y_bits)))
    }

    fn count(&self, corner: Cell, is_counted: impl Fn(&Known) -> bool) -> usize {
        let places = (0..PATCH_HEIGHT).flat_map(|y| (0..PATCH_WIDTH).map(move |x| corner + Cell::new(x, y)));
        let known = places.filter_map(|at| self.tiles.get(self.index(at)?));
        known.filter(|known| is_counted(known)).count()
    }
}
