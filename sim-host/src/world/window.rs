//! What a robot sees of the terrain.

use super::World;
use staya_controller::grid::{Cell, Window};

impl World {
    /// The square of `radius` cells around `cell`, clipped to the map; `None` when nothing of it
    /// lies on the map.
    ///
    /// Rows are copied into `buffer`, except when the square is as wide as the map: then its rows
    /// already lie side by side and are borrowed.
    #[must_use]
    pub fn window<'a>(
        &'a self,
        cell: Cell,
        radius: u16,
        buffer: &'a mut Vec<u8>,
    ) -> Option<Window<'a>> {
        let (x0, width) = clip(cell.x, radius, self.terrain.width())?;
        let (y0, height) = clip(cell.y, radius, self.terrain.height())?;
        let row_length = usize::from(self.terrain.width());
        let first = usize::from(y0) * row_length;
        let rows = &self.terrain.cells()[first..first + usize::from(height) * row_length];
        let origin = Cell::new(i16::try_from(x0).ok()?, i16::try_from(y0).ok()?);
        if width == self.terrain.width() {
            return Window::new(rows, origin, width, height);
        }
        buffer.clear();
        let columns = usize::from(x0)..usize::from(x0) + usize::from(width);
        for row in rows.chunks_exact(row_length) {
            buffer.extend_from_slice(&row[columns.clone()]);
        }
        Window::new(buffer, origin, width, height)
    }
}

/// The part of `at - radius ..= at + radius` inside `0..length`: its first index and its length.
fn clip(at: i16, radius: u16, length: u16) -> Option<(u16, u16)> {
    let (at, radius) = (i32::from(at), i32::from(radius));
    let low = (at - radius).max(0);
    let high = (at + radius + 1).min(i32::from(length));
    let (low, high) = (u16::try_from(low).ok()?, u16::try_from(high).ok()?);
    (low < high).then(|| (low, high - low))
}
