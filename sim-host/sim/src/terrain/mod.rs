//! Terrain: a grid of impassability, with readers, generators and metrics.
//!
//! File formats: [`movingai`] (`.map`, `.scen`), [`esri`] heights (`.asc`) through [`slope`], and
//! [`ros`] (`.yaml` with `.pgm`; also the format that Staya writes). [`Terrain::load`] chooses by
//! extension. [`generate`] creates random terrain, [`metrics`] measures it, [`change`] changes it
//! during a run, and [`scouted`] creates incomplete maps of it. [`optimal`] finds routes on the
//! whole map, [`known`] makes tables of them that robots carry.

pub mod change;
pub mod esri;
pub mod generate;
pub mod known;
pub mod metrics;
pub mod movingai;
pub mod optimal;
pub mod ros;
pub mod rows;
pub mod scouted;
pub mod slope;

mod error;
mod text;

pub use error::{MAX_SIDE, Place, TerrainError};
pub use slope::SlopeRule;

use crate::shown::Shown as _;
use crate::{defaults, table};
use error::format_error;
pub use error::{parameter_error, read};
use serde::Serialize;
use staya_controller::grid::{BLOCKED, Cell};
use std::path::{Path, PathBuf};

table! {
    /// Options for the conversion of files to impassability.
    #[derive(Copy, PartialEq, Serialize)]
    pub struct LoadOptions {
        /// `.map`: impassability of swamp, 1 to 255 (0: blocked).
        pub swamp: u8 = movingai::SWAMP;
        /// `.asc`: cells along each side that are combined before slopes are computed, 1 or more.
        pub downsample: u16 = 1;
        /// `.asc`: conversion of slopes to impassability.
        pub slope: SlopeRule = Default::default();
        /// `.yaml`: impassability of unknown cells in mode `trinary`; 0: blocked.
        pub unknown: u8 = BLOCKED;
        /// `.yaml`: number of classes in mode `scale` if the file gives none, 1 to 255.
        pub classes: u8 = 9;
    }
}

defaults!(LoadOptions);

/// A grid of impassability, row by row from the south-west corner.
#[derive(Clone, Debug, PartialEq)]
pub struct Terrain {
    width: u16,
    height: u16,
    /// Ticks to cross each cell, or [`BLOCKED`]; row by row from the south-west corner.
    cells: Vec<u8>,
    /// Indices of blocked cells of which the file knows nothing, in ascending order.
    unknown: Vec<u32>,
    /// Side of a cell, metres.
    pub cell_m: f64,
    /// World position of the south-west corner, metres (x east, y north).
    pub origin_m: [f64; 2],
}

impl Terrain {
    /// Creates flat terrain of `width` x `height` cells of 1 m with impassability 1.
    #[must_use]
    pub fn flat(width: u16, height: u16) -> Self {
        let cells = vec![1; usize::from(width) * usize::from(height)];
        Self { width, height, cells, unknown: Vec::new(), cell_m: 1.0, origin_m: [0.0; 2] }
    }

    /// Creates terrain from impassabilities, row by row from the south-west; cells of 1 m.
    ///
    /// # Errors
    /// A [`TerrainError::Size`] unless both sides are 1..=[`MAX_SIDE`] and `cells` has `width *
    /// height` entries.
    pub fn from_cells(width: u16, height: u16, cells: Vec<u8>) -> Result<Self, TerrainError> {
        let sides = 1..=MAX_SIDE;
        let fits = cells.len() == usize::from(width) * usize::from(height);
        if !(sides.contains(&width) && sides.contains(&height) && fits) {
            return Err(TerrainError::Size { width: width.into(), height: height.into(), cells: cells.len() });
        }
        Ok(Self { width, height, cells, unknown: Vec::new(), cell_m: 1.0, origin_m: [0.0; 2] })
    }

    /// Marks the blocked ones of these cells as unknown; `is_unknown` has a value for each cell.
    pub(crate) fn mark_unknown(&mut self, is_unknown: impl Iterator<Item = bool>) {
        let cells = (0..).zip(&self.cells).zip(is_unknown);
        let blocked = cells.filter(|((_, class), is_unknown)| *is_unknown && **class == BLOCKED);
        self.unknown = blocked.map(|((index, _), _)| index).collect();
    }

    /// Reads a terrain file with the default [`LoadOptions`].
    ///
    /// # Errors
    /// See [`Terrain::load_with`].
    pub fn load(path: &Path) -> Result<Self, TerrainError> {
        Self::load_with(path, &LoadOptions::default())
    }

    /// Reads a terrain file: `.map`, `.asc`, or `.yaml` / `.yml` with the `.pgm` that it names.
    ///
    /// # Errors
    /// A [`TerrainError`] that names file, line and remedy.
    pub fn load_with(path: &Path, options: &LoadOptions) -> Result<Self, TerrainError> {
        let extension = path.extension().and_then(|extension| extension.to_str());
        match extension.unwrap_or("").to_ascii_lowercase().as_str() {
            "map" => movingai::parse_map(&read(path)?, path, options.swamp),
            "asc" => {
                let heights = esri::parse_heights(&read(path)?, path)?;
                let terrain = options.slope.apply(&heights.downsample(options.downsample)?)?;
                if terrain.cells.iter().all(|u| *u == BLOCKED) {
                    return Err(format_error(
                        path,
                        Place::File,
                        "every cell is steeper than the maximum slope or unknown",
                        "heights and cellsize must both be in metres; or raise slope.max_slope",
                    ));
                }
                Ok(terrain)
            }
            "yaml" | "yml" => ros::load(path, options),
            "pgm" => Err(parameter_error(
                format!("{} is the picture of a map", path.shown()),
                "name the .yaml file that describes it",
            )),
            _ => Err(TerrainError::UnknownKind(path.to_owned())),
        }
    }

    /// The picture that a `.yaml` file names.
    #[must_use]
    pub fn picture(path: &Path) -> Option<PathBuf> {
        let is_yaml = path.extension().is_some_and(|extension| extension == "yaml" || extension == "yml");
        if is_yaml { ros::picture(path).ok() } else { None }
    }

    /// The part of `width` x `height` cells whose south-west cell is column `x`, row `y`; its world
    /// position is unchanged.
    ///
    /// # Errors
    /// A [`TerrainError::Crop`] if the part is empty or not inside the map.
    pub fn crop(&self, x: u16, y: u16, width: u16, height: u16) -> Result<Self, TerrainError> {
        let (right, top) = (u32::from(x) + u32::from(width), u32::from(y) + u32::from(height));
        let inside = right <= u32::from(self.width) && top <= u32::from(self.height);
        if !inside || width == 0 || height == 0 {
            return Err(TerrainError::Crop { x, y, width, height, map_width: self.width, map_height: self.height });
        }
        let columns = usize::from(x)..usize::from(x) + usize::from(width);
        let cells = self
            .cells
            .chunks_exact(self.width.into())
            .skip(y.into())
            .take(height.into())
            .flat_map(|row| &row[columns.clone()])
            .copied()
            .collect();
        let place = |index: &u32| {
            let [column, row] = [index % u32::from(self.width), index / u32::from(self.width)];
            let [column, row] = [column.checked_sub(x.into())?, row.checked_sub(y.into())?];
            (column < u32::from(width) && row < u32::from(height)).then_some(row * u32::from(width) + column)
        };
        Ok(Self {
            width,
            height,
            cells,
            unknown: self.unknown.iter().filter_map(place).collect(),
            cell_m: self.cell_m,
            origin_m: [self.origin_m[0] + f64::from(x) * self.cell_m, self.origin_m[1] + f64::from(y) * self.cell_m],
        })
    }

    /// Cells from west to east.
    #[must_use]
    pub const fn width(&self) -> u16 {
        self.width
    }

    /// Cells from south to north.
    #[must_use]
    pub const fn height(&self) -> u16 {
        self.height
    }

    /// Impassabilities, row by row from the south-west corner.
    #[must_use]
    pub fn cells(&self) -> &[u8] {
        &self.cells
    }

    /// Index of a cell in [`Terrain::cells`]; `None` outside the map.
    #[must_use]
    pub fn index(&self, cell: Cell) -> Option<usize> {
        let (x, y) = (u16::try_from(cell.x).ok()?, u16::try_from(cell.y).ok()?);
        (x < self.width && y < self.height).then(|| usize::from(y) * usize::from(self.width) + usize::from(x))
    }

    /// Cell at a position, metres; `None` outside the map.
    #[must_use]
    pub fn cell_at(&self, place_m: [f64; 2]) -> Option<Cell> {
        let at = |axis: usize| {
            let cells = (place_m[axis] - self.origin_m[axis]) / self.cell_m;
            (cells >= 0.0 && cells < f64::from(i16::MAX)).then_some(cells as i16)
        };
        let cell = Cell::new(at(0)?, at(1)?);
        self.index(cell).map(|_| cell)
    }

    /// Cell at a position, metres, or the nearest cell of the map.
    #[must_use]
    pub fn nearest_cell(&self, place_m: [f64; 2]) -> Cell {
        let at = |axis: usize, side: u16| {
            let cells = (place_m[axis] - self.origin_m[axis]) / self.cell_m;
            cells.clamp(0.0, f64::from(side) - 1.0) as i16
        };
        Cell::new(at(0, self.width), at(1, self.height))
    }

    /// Centre of a cell, metres.
    #[must_use]
    pub fn center_m(&self, cell: Cell) -> [f64; 2] {
        let at = |cells: i16, axis: usize| self.origin_m[axis] + (f64::from(cells) + 0.5) * self.cell_m;
        [at(cell.x, 0), at(cell.y, 1)]
    }

    /// Ticks to cross a cell; [`BLOCKED`] for walls and outside the map.
    #[must_use]
    pub fn get(&self, cell: Cell) -> u8 {
        self.index(cell).map_or(BLOCKED, |at| self.cells[at])
    }

    /// Sets the impassability of a cell; a cell outside the map is ignored.
    pub fn set(&mut self, cell: Cell, impassability: u8) {
        if let Some(at) = self.index(cell) {
            self.cells[at] = impassability;
        }
    }

    /// Whether a robot can be in the cell.
    #[must_use]
    pub fn is_passable(&self, cell: Cell) -> bool {
        self.get(cell) != BLOCKED
    }

    /// Whether the cell is blocked because the map file knows nothing of it.
    #[must_use]
    pub fn is_unknown(&self, cell: Cell) -> bool {
        let index = self.index(cell).filter(|at| self.cells[*at] == BLOCKED);
        index.is_some_and(|at| self.unknown.binary_search(&(at as u32)).is_ok())
    }

    /// World coordinates of the map's sides along an axis, metres.
    #[must_use]
    pub fn sides_m(&self, axis: usize) -> [f64; 2] {
        let cells = if axis == 0 { self.width } else { self.height };
        [self.origin_m[axis], self.origin_m[axis] + f64::from(cells) * self.cell_m]
    }

    /// Whether a place on the map is `within_m` metres or more from blocked cells and from the
    /// map's sides. O(cells around it).
    #[must_use]
    pub fn is_clear(&self, place_m: [f64; 2], within_m: f64) -> bool {
        let is_inside = (0..2).all(|axis| {
            let [low, high] = self.sides_m(axis);
            place_m[axis] - low >= within_m && high - place_m[axis] >= within_m
        });
        is_inside && self.blocked_within(place_m, within_m).is_none()
    }

    /// A blocked cell of the map that is nearer to a place than `within_m` metres.
    #[must_use]
    pub fn blocked_within(&self, [x, y]: [f64; 2], within_m: f64) -> Option<Cell> {
        let (low, high) =
            (self.nearest_cell([x - within_m, y - within_m]), self.nearest_cell([x + within_m, y + within_m]));
        let mut cells = (low.y..=high.y).flat_map(|row| (low.x..=high.x).map(move |column| Cell::new(column, row)));
        cells.find(|&cell| {
            let [middle_x, middle_y] = self.center_m(cell);
            let off = |way: f64| (way.abs() - self.cell_m / 2.0).max(0.0);
            !self.is_passable(cell) && libm::hypot(off(x - middle_x), off(y - middle_y)) < within_m
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inconsistent_sizes_are_refused() {
        assert!(Terrain::from_cells(2, 3, vec![1; 6]).is_ok());
        assert!(Terrain::from_cells(2, 3, vec![1; 5]).is_err());
        assert!(Terrain::from_cells(0, 3, vec![]).is_err());
        assert!(Terrain::from_cells(32_768, 1, vec![1; 32_768]).is_err());
        assert!(Terrain::from_cells(32_767, 1, vec![1; 32_767]).is_ok());
    }

    #[test]
    fn a_cropped_part_keeps_its_cells_and_world_position() {
        let mut map = Terrain::from_cells(4, 3, (1..=12).collect()).unwrap();
        map.cell_m = 2.0;
        map.origin_m = [10.0, 20.0];
        let piece = map.crop(1, 1, 2, 2).unwrap();
        assert_eq!(piece.cells(), [6, 7, 10, 11]);
        assert_eq!((piece.cell_m, piece.origin_m), (2.0, [12.0, 22.0]));
        assert_eq!(map.crop(0, 0, 4, 3).unwrap(), map);
        for (x, y, width, height) in [(3, 0, 2, 1), (0, 0, 0, 1), (0, 3, 1, 1), (u16::MAX, 0, 2, 1)] {
            let message = map.crop(x, y, width, height).unwrap_err().to_string();
            assert!(message.contains("leaves the map of 4 x 3"), "{message}");
        }
    }

    #[test]
    fn a_cropped_part_keeps_its_unknown_cells() {
        let mut map = Terrain::from_cells(4, 3, vec![BLOCKED; 12]).unwrap();
        map.mark_unknown((0..12).map(|at| at % 5 == 0));
        map.set(Cell::new(2, 2), 1);
        let unknown = |map: &Terrain| {
            let all = (0..3).flat_map(|y| (0..4).map(move |x| Cell::new(x, y)));
            all.filter(|cell| map.is_unknown(*cell)).map(|cell| (cell.x, cell.y)).collect::<Vec<_>>()
        };
        assert_eq!(unknown(&map), [(0, 0), (1, 1)]);
        assert_eq!(unknown(&map.crop(1, 0, 3, 3).unwrap()), [(0, 1)]);
    }

    #[test]
    fn places_are_clear_of_blocked_cells_and_of_the_sides() {
        // Cells of 2 m; the south-west corner is (10, 20), and the cell in the middle is blocked.
        let mut map = Terrain::from_cells(3, 3, vec![1; 9]).unwrap();
        map.set(Cell::new(1, 1), BLOCKED);
        (map.cell_m, map.origin_m) = (2.0, [10.0, 20.0]);
        for (place, within, is_clear) in [
            ([11.0, 23.0], 1.0, true),
            ([11.0, 23.0], 1.001, false),
            ([11.0, 21.0], 1.0, true),
            ([13.0, 23.0], 0.0, true),
            ([13.0, 23.0], 1e-9, false),
            ([11.5, 21.5], 0.7, true),
            ([11.5, 21.5], 0.71, false),
            ([10.4, 21.0], 0.5, false),
            ([9.0, 21.0], 0.0, false),
            ([16.0, 26.0], 0.0, true),
            ([16.1, 26.0], 0.0, false),
        ] {
            assert_eq!(map.is_clear(place, within), is_clear, "{place:?}, {within}");
        }
        assert_eq!(map.blocked_within([11.5, 21.5], 0.71), Some(Cell::new(1, 1)));
    }

    #[test]
    fn the_maps_of_the_repository_load() {
        let maps = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../maps");
        let sizes = [
            ("jacksboro.asc", (324, 344)),
            ("figure-5.map", (60, 30)),
            ("corridor.map", (16, 3)),
            ("arena-40.map", (40, 30)),
            ("office.yaml", (48, 32)),
        ];
        for (name, size) in sizes {
            let terrain = Terrain::load(&maps.join(name)).unwrap();
            assert_eq!((terrain.width(), terrain.height()), size, "{name}");
        }
    }

    #[test]
    fn an_unknown_extension_is_refused_with_the_known_ones() {
        let message = |name: &str| Terrain::load(Path::new(name)).unwrap_err().to_string();
        assert!(message("a.tif").contains("a.tif: unknown kind of terrain file; use .map"));
        assert!(message("a").contains("unknown kind"));
        assert!(message("a.pgm").contains("name the .yaml file"));
        assert!(message("no/such.map").starts_with("no/such.map: "));
    }

    #[test]
    fn heights_on_a_grid_in_degrees_are_refused() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("degrees.asc");
        let text = "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 0.00083\n100 130\n";
        std::fs::write(&path, text).unwrap();
        let message = Terrain::load(&path).unwrap_err().to_string();
        assert!(message.contains("degrees.asc:5: cells of 0.00083 are degrees"), "{message}");
        std::fs::write(&path, text.replace("0.00083", "5")).unwrap();
        let message = Terrain::load(&path).unwrap_err().to_string();
        assert!(message.contains("degrees.asc: every cell is steeper"), "{message}");
        std::fs::write(&path, text.replace("0.00083", "92")).unwrap();
        assert_eq!(Terrain::load(&path).unwrap().cells(), [6, 6]);
    }
}
