//! Pictures of terrain: darker is less passable (A. V. Kuznetsov 2017, figure 7), walls are black.

use super::canvas::{Anchor, Canvas, Text};
use super::map::{FOOTER, Map, size};
use super::{raster, svg};
use staya_sim::record::write_atomically;
use staya_sim::shown::Shown as _;
use staya_sim::terrain::{Terrain, TerrainError, parameter_error};
use std::path::Path;

/// Largest side of a map, pixels.
pub const MAX_PIXELS: u32 = 16_384;
const PAD: f64 = 12.0;
/// Height of the line above the map, units.
const TOP: f64 = 34.0;
/// Of the scale and the legend, units.
const MIN_WIDTH: f64 = 480.0;

/// Pixels per cell for a map of about `pixels` along the longer side; at least 1.
#[must_use]
pub fn scale_for(terrain: &Terrain, pixels: u32) -> u32 {
    let longest = u32::from(terrain.width().max(terrain.height()));
    (pixels / longest).max(1)
}

/// Draws a terrain with its scale and legend into a `.png` or `.svg` file, `scale` pixels per cell.
///
/// # Errors
/// [`TerrainError::Parameter`] for another extension or a map beyond [`MAX_PIXELS`];
/// [`TerrainError::Write`] if the file cannot be written.
pub fn draw(terrain: &Terrain, scale: u32, path: &Path) -> Result<(), TerrainError> {
    let longest = u64::from(terrain.width().max(terrain.height()));
    if scale == 0 || longest * u64::from(scale) > u64::from(MAX_PIXELS) {
        return Err(parameter_error(
            format!("a picture of {longest} cells with {scale} pixels each is too large or empty"),
            format!("choose a scale so that the longer side has 1 to {MAX_PIXELS} pixels, or a piece of the map"),
        ));
    }
    let extension = path.extension().and_then(|extension| extension.to_str());
    let bytes = match extension.unwrap_or("").to_ascii_lowercase().as_str() {
        "png" => raster::png(&picture(terrain, f64::from(scale) / raster::SCALE)),
        "svg" => svg::text(&picture(terrain, f64::from(scale))).map(String::into_bytes),
        _ => {
            return Err(parameter_error(
                format!("{} is not a picture format", path.shown()),
                "choose a file name that ends in .png or .svg",
            ));
        }
    };
    let bytes = bytes.map_err(|error| parameter_error(error.to_string(), "choose a smaller scale"))?;
    Ok(write_atomically(path, &bytes)?)
}

/// `cell`: units per cell.
fn picture(terrain: &Terrain, cell: f64) -> Canvas {
    let room = (f64::from(terrain.width()) * cell).max(MIN_WIDTH);
    let left = PAD + libm::round((room - f64::from(terrain.width()) * cell) / 2.0);
    let map = Map::of_scale(terrain, [left, TOP], cell).alone();
    let (height, right) = (map.area[3], PAD + room);
    let mut canvas = Canvas::new(right + PAD, TOP + height + FOOTER, size(terrain));
    canvas.text(Text::new([PAD, TOP - 12.0], 12.5, Anchor::Start, size(terrain)));
    map.ground(&mut canvas);
    map.frame(&mut canvas);
    map.footer(&mut canvas, PAD, right);
    canvas
}

#[cfg(test)]
mod tests {
    use super::*;
    use staya_controller::grid::BLOCKED;

    #[test]
    fn cells_are_squares_of_the_wanted_pixels_with_a_legend_below() {
        let dir = tempfile::tempdir().unwrap();
        let mut land = Terrain::from_cells(100, 1, vec![1; 100]).unwrap();
        land.set(staya_controller::grid::Cell::new(1, 0), BLOCKED);
        land.set(staya_controller::grid::Cell::new(2, 0), 9);
        let png = dir.path().join("a.png");
        draw(&land, 10, &png).unwrap();
        let (width, _, rgb) = crate::tests::decode(&png);
        let row = ((TOP * raster::SCALE) as u32 + 3) * width;
        let black = |x: u32| rgb[3 * (row + x) as usize] < 3;
        let left = (PAD * raster::SCALE) as u32;
        assert!((left + 10..left + 20).all(black));
        assert_eq!([left + 9, left + 20].map(black), [false; 2]);
        let svg = dir.path().join("a.svg");
        draw(&land, 10, &svg).unwrap();
        let text = std::fs::read_to_string(&svg).unwrap();
        for part in ["width=\"1000\"", "cost 1 to 9", "blocked", "100 × 1 cells of 1 m", " cells<"] {
            assert!(text.contains(part), "{part}: {text}");
        }
        land.cell_m = 92.5;
        for cell in [0.5, 3.0, 20.0] {
            crate::tests::assert_texts_apart(&picture(&land, cell));
        }
    }

    #[test]
    fn other_formats_and_sizes_are_refused() {
        let dir = tempfile::tempdir().unwrap();
        let land = Terrain::from_cells(3, 1, vec![1, 1, 2]).unwrap();
        let message = |scale, name: &str| draw(&land, scale, &dir.path().join(name)).unwrap_err().to_string();
        assert!(message(4, "a.gif").contains(".png or .svg"));
        assert!(message(4, "no/folder/a.png").contains("a.png: "));
        assert!(message(4, "no/folder/a.svg").contains("a.svg: "));
        assert!(message(0, "a.png").contains("choose a scale"));
        assert!(message(6000, "a.png").contains("choose a scale"));
    }
}
