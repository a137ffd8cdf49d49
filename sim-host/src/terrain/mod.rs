//! The land: a grid of impassability, where it comes from, what describes it.

use staya_controller::grid::{BLOCKED, Cell};

/// A grid of impassability. Row 0 is the southernmost row; picture and file rows exist only at the
/// file edge.
#[derive(Clone, Debug, PartialEq)]
pub struct Terrain {
    width: u16,
    height: u16,
    /// Ticks to cross each cell, or [`BLOCKED`]; row by row from the south-west corner.
    cells: Vec<u8>,
    /// Side of a cell, metres.
    pub cell_m: f64,
    /// World position of the south-west corner, metres (x east, y north).
    pub origin_m: [f64; 2],
}

impl Terrain {
    /// Flat passable land of `width` x `height` cells of 1 m with impassability 1.
    #[must_use]
    pub fn flat(width: u16, height: u16) -> Self {
        let cells = vec![1; usize::from(width) * usize::from(height)];
        Self {
            width,
            height,
            cells,
            cell_m: 1.0,
            origin_m: [0.0; 2],
        }
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

    /// Position of a cell in [`Terrain::cells`]; `None` outside the map.
    #[must_use]
    pub fn index(&self, cell: Cell) -> Option<usize> {
        let (x, y) = (u16::try_from(cell.x).ok()?, u16::try_from(cell.y).ok()?);
        (x < self.width && y < self.height)
            .then(|| usize::from(y) * usize::from(self.width) + usize::from(x))
    }

    /// Ticks to cross a cell; [`BLOCKED`] for walls and everything outside the map.
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

    /// Whether a robot can stand there.
    #[must_use]
    pub fn is_passable(&self, cell: Cell) -> bool {
        self.get(cell) != BLOCKED
    }
}
