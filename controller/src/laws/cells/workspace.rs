//! Scratch memory of the laws on the grid.

use crate::route::CostField;

/// Scratch memory of the guidance laws on the grid; `CELLS` as for [`CostField`].
#[derive(Clone, Debug)]
pub struct GridWorkspace<const CELLS: usize> {
    pub(crate) field: CostField<CELLS>,
    pub(crate) land: [u8; CELLS],
    none: (),
}

impl<const CELLS: usize> Default for GridWorkspace<CELLS> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const CELLS: usize> GridWorkspace<CELLS> {
    /// Creates a workspace.
    #[must_use]
    pub const fn new() -> Self {
        Self { field: CostField::new(), land: [0; CELLS], none: () }
    }

    /// The field, for a search.
    pub const fn field_mut(&mut self) -> &mut CostField<CELLS> {
        &mut self.field
    }

    /// The last search.
    #[must_use]
    pub const fn field(&self) -> &CostField<CELLS> {
        &self.field
    }
}

/// For an enum of laws.
impl<const CELLS: usize> AsMut<Self> for GridWorkspace<CELLS> {
    fn as_mut(&mut self) -> &mut Self {
        self
    }
}

/// For laws in it that need none.
impl<const CELLS: usize> AsMut<()> for GridWorkspace<CELLS> {
    fn as_mut(&mut self) -> &mut () {
        &mut self.none
    }
}

/// In place of a [`GridWorkspace`] for a list without laws over cells.
#[cfg(not(feature = "list_cells"))]
#[derive(Clone, Debug, Default)]
pub struct NoWorkspace<const CELLS: usize>(());

#[cfg(not(feature = "list_cells"))]
impl<const CELLS: usize> AsMut<Self> for NoWorkspace<CELLS> {
    fn as_mut(&mut self) -> &mut Self {
        self
    }
}

#[cfg(not(feature = "list_cells"))]
impl<const CELLS: usize> AsMut<()> for NoWorkspace<CELLS> {
    fn as_mut(&mut self) -> &mut () {
        &mut self.0
    }
}
