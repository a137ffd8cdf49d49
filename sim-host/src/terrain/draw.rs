//! Pictures of land: the darker, the less passable (KUZ figure 7); walls are black.

use super::error::parameter_error;
use super::rows::flip_row;
use super::{Terrain, TerrainError};
use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::style::RGBColor;
use staya_controller::grid::BLOCKED;
use std::path::Path;

/// Longest side of a picture in pixels.
pub const MAX_PIXELS: u32 = 16_384;
/// Brightness of the least passable class; walls are darker still.
const DARKEST: u8 = 60;

/// The brightness of an impassability where `classes` is the greatest one: 255 for 1, then linear, 0 for walls.
#[must_use]
pub fn shade(impassability: u8, classes: u8) -> u8 {
    if impassability == BLOCKED {
        return 0;
    }
    let steps = u32::from(classes.max(2) - 1);
    let span = u32::from(255 - DARKEST);
    255 - (u32::from(impassability - 1).min(steps) * span / steps) as u8
}

/// The greatest impassability of a terrain, at least 1.
#[must_use]
pub fn classes(terrain: &Terrain) -> u8 {
    terrain.cells().iter().copied().max().unwrap_or(1).max(1)
}

/// Pixels per cell that make a picture of about `pixels` along the longer side; at least 1.
#[must_use]
pub fn scale_for(terrain: &Terrain, pixels: u32) -> u32 {
    let longest = u32::from(terrain.width().max(terrain.height()));
    (pixels / longest).max(1)
}

/// A picture with north up: its width and height in pixels, and three bytes (red, green, blue) per pixel, row by row from
/// the top. Each cell is a square of `scale` pixels. O(pixels).
#[must_use]
pub fn render(terrain: &Terrain, scale: u32) -> (u32, u32, Vec<u8>) {
    let (scale, classes) = (scale.max(1), classes(terrain));
    let (width, height) = (terrain.width(), terrain.height());
    let repeat = scale as usize;
    let mut pixels = Vec::with_capacity(terrain.cells().len() * repeat * repeat * 3);
    for file_row in 0..height {
        let start = usize::from(flip_row(file_row, height)) * usize::from(width);
        let row = &terrain.cells()[start..start + usize::from(width)];
        let line: Vec<u8> = row
            .iter()
            .flat_map(|u| std::iter::repeat_n(shade(*u, classes), 3 * repeat))
            .collect();
        for _ in 0..scale {
            pixels.extend_from_slice(&line);
        }
    }
    (u32::from(width) * scale, u32::from(height) * scale, pixels)
}

/// Draws a terrain into a `.png` or `.svg` file, `scale` pixels per cell.
///
/// # Errors
/// [`TerrainError::Parameter`] for another extension, a picture beyond [`MAX_PIXELS`], or a file that cannot be written.
pub fn draw(terrain: &Terrain, scale: u32, path: &Path) -> Result<(), TerrainError> {
    let longest = u64::from(terrain.width().max(terrain.height()));
    if scale == 0 || longest * u64::from(scale) > u64::from(MAX_PIXELS) {
        return Err(parameter_error(
            format!("a picture of {longest} cells with {scale} pixels each"),
            format!(
                "choose a scale so that the longer side has 1 to {MAX_PIXELS} pixels, or a piece of the map"
            ),
        ));
    }
    let size = (
        u32::from(terrain.width()) * scale,
        u32::from(terrain.height()) * scale,
    );
    let extension = path.extension().and_then(|extension| extension.to_str());
    match extension.unwrap_or("").to_ascii_lowercase().as_str() {
        "png" => bitmap(terrain, scale, BitMapBackend::new(path, size)),
        "svg" => rectangles(terrain, scale, SVGBackend::new(path, size)),
        _ => {
            return Err(parameter_error(
                format!("{} is no picture", path.display()),
                "choose a file name that ends in .png or .svg",
            ));
        }
    }
    .map_err(|error| {
        parameter_error(
            format!("{}: {error}", path.display()),
            "choose a folder that exists and can be written to",
        )
    })
}

fn bitmap(terrain: &Terrain, scale: u32, mut picture: BitMapBackend<'_>) -> Result<(), String> {
    let (width, height, pixels) = render(terrain, scale);
    picture
        .blit_bitmap((0, 0), (width, height), &pixels)
        .and_then(|()| picture.present())
        .map_err(|error| error.to_string())
}

/// Cells as filled rectangles, neighbours of equal shade in one.
fn rectangles(terrain: &Terrain, scale: u32, mut picture: SVGBackend<'_>) -> Result<(), String> {
    let (scale, classes) = (scale as i32, classes(terrain));
    let height = terrain.height();
    let mut fill = |columns: std::ops::Range<i32>, file_row: i32, u: u8| {
        let grey = shade(u, classes);
        let corner = (columns.start * scale, file_row * scale);
        let opposite = (columns.end * scale, (file_row + 1) * scale);
        picture
            .draw_rect(corner, opposite, &RGBColor(grey, grey, grey), true)
            .map_err(|error| error.to_string())
    };
    for (y, row) in (0..height).zip(terrain.cells().chunks_exact(terrain.width().into())) {
        let file_row = i32::from(flip_row(y, height));
        let mut x = 0;
        for run in row.chunk_by(|a, b| a == b) {
            let end = x + run.len() as i32;
            fill(x..end, file_row, run[0])?;
            x = end;
        }
    }
    picture.present().map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn darker_means_less_passable_and_walls_are_black() {
        for classes in [1, 2, 9, 255] {
            let shades: Vec<u8> = (1..=classes).map(|u| shade(u, classes)).collect();
            assert_eq!(shades[0], 255);
            assert!(shades.is_sorted_by(|a, b| a >= b));
            assert!(*shades.last().unwrap() >= DARKEST);
            assert_eq!(shade(BLOCKED, classes), 0);
        }
        assert_eq!(shade(9, 9), DARKEST);
        assert_eq!(shade(9, 3), DARKEST);
    }

    #[test]
    fn north_is_up_and_cells_are_squares() {
        let land = Terrain::from_cells(2, 2, vec![1, 9, BLOCKED, 1]).unwrap();
        let (width, height, pixels) = render(&land, 2);
        assert_eq!((width, height, pixels.len()), (4, 4, 48));
        let grey = |x: usize, y: usize| pixels[(y * 4 + x) * 3..][..3].to_vec();
        assert_eq!(grey(0, 0), [0; 3]);
        assert_eq!(grey(1, 1), [0; 3]);
        assert_eq!(grey(2, 1), [255; 3]);
        assert_eq!(grey(0, 3), [255; 3]);
        assert_eq!(grey(3, 2), [DARKEST; 3]);
    }

    #[test]
    fn both_kinds_of_picture_are_written_and_others_refused() {
        let dir = tempfile::tempdir().unwrap();
        let land = Terrain::from_cells(3, 1, vec![1, 1, 2]).unwrap();
        let png = dir.path().join("a.png");
        draw(&land, 4, &png).unwrap();
        assert!(std::fs::read(&png).unwrap().starts_with(b"\x89PNG"));
        let svg = dir.path().join("a.svg");
        draw(&land, 4, &svg).unwrap();
        let text = std::fs::read_to_string(&svg).unwrap();
        assert_eq!(text.matches("<rect").count(), 2);
        let message = |scale, name: &str| {
            draw(&land, scale, &dir.path().join(name))
                .unwrap_err()
                .to_string()
        };
        assert!(message(4, "a.gif").contains(".png or .svg"));
        assert!(message(4, "no/folder/a.png").contains("folder that exists"));
        assert!(message(4, "no/folder/a.svg").contains("folder that exists"));
        assert!(message(0, "a.png").contains("choose a scale"));
        assert!(message(6000, "a.png").contains("choose a scale"));
    }
}
