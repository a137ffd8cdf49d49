//! Pictures of terrain: darker is less passable (A. V. Kuznetsov 2017, figure 7), walls are black.

use staya_controller::grid::BLOCKED;
use staya_sim::record::write_atomically;
use staya_sim::terrain::{Terrain, TerrainError, parameter_error, rows::flip_row};
use std::fmt::Write as _;
use std::path::Path;

/// Largest side of a picture, pixels.
pub const MAX_PIXELS: u32 = 16_384;
const DARKEST: u8 = 60;

/// Brightness of an impassability from 1 to `classes`: 255 for 1, then linear; 0 for walls.
#[must_use]
pub fn shade(impassability: u8, classes: u8) -> u8 {
    if impassability == BLOCKED {
        return 0;
    }
    let steps = u32::from(classes.max(2) - 1);
    let span = u32::from(255 - DARKEST);
    255 - (u32::from(impassability - 1).min(steps) * span / steps) as u8
}

/// Largest impassability of a terrain, at least 1.
#[must_use]
pub fn classes(terrain: &Terrain) -> u8 {
    terrain.cells().iter().copied().max().unwrap_or(1).max(1)
}

/// Pixels per cell for a picture of about `pixels` along the longer side; at least 1.
#[must_use]
pub fn scale_for(terrain: &Terrain, pixels: u32) -> u32 {
    let longest = u32::from(terrain.width().max(terrain.height()));
    (pixels / longest).max(1)
}

/// Renders terrain in grey, north up, each cell as a square of `scale` pixels. Returns width,
/// height, and the brightness of each pixel, row by row from the top. O(pixels).
#[must_use]
pub fn render(terrain: &Terrain, scale: u32) -> (u32, u32, Vec<u8>) {
    let (scale, classes) = (scale.max(1), classes(terrain));
    let repeat = scale as usize;
    let mut pixels = Vec::with_capacity(terrain.cells().len() * repeat * repeat);
    for (_, row) in file_rows(terrain) {
        let line: Vec<u8> = row.iter().flat_map(|u| std::iter::repeat_n(shade(*u, classes), repeat)).collect();
        for _ in 0..scale {
            pixels.extend_from_slice(&line);
        }
    }
    let [width, height] = [terrain.width(), terrain.height()].map(|side| u32::from(side) * scale);
    (width, height, pixels)
}

fn file_rows(terrain: &Terrain) -> impl Iterator<Item = (u16, &[u8])> {
    let width = usize::from(terrain.width());
    (0..terrain.height()).map(move |file_row| {
        let row = usize::from(flip_row(file_row, terrain.height()));
        (file_row, &terrain.cells()[row * width..(row + 1) * width])
    })
}

/// Draws a terrain into a `.png` or `.svg` file, `scale` pixels per cell.
///
/// # Errors
/// [`TerrainError::Parameter`] for another extension or a picture beyond [`MAX_PIXELS`];
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
        "png" => png(terrain, scale)?,
        "svg" => svg(terrain, scale).into_bytes(),
        _ => {
            return Err(parameter_error(
                format!("{} is not a picture format", path.display()),
                "choose a file name that ends in .png or .svg",
            ));
        }
    };
    Ok(write_atomically(path, &bytes)?)
}

fn png(terrain: &Terrain, scale: u32) -> Result<Vec<u8>, TerrainError> {
    let (width, height, pixels) = render(terrain, scale);
    encode_png(width, height, png::ColorType::Grayscale, &pixels)
        .map_err(|error| parameter_error(error.to_string(), "choose a smaller scale"))
}

pub(crate) fn encode_png(
    width: u32,
    height: u32,
    colour: png::ColorType,
    pixels: &[u8],
) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(colour);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(pixels)?;
    Ok(bytes)
}

fn svg(terrain: &Terrain, scale: u32) -> String {
    let classes = classes(terrain);
    let (columns, rows) = (terrain.width(), terrain.height());
    let [width, height] = [columns, rows].map(|side| u32::from(side) * scale);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {columns} {rows}\" shape-rendering=\"crispEdges\">\n\
         <rect width=\"{columns}\" height=\"{rows}\" fill=\"#fff\"/>\n"
    );
    for (y, row) in file_rows(terrain) {
        let mut x = 0;
        for run in row.chunk_by(|a, b| a == b) {
            let grey = shade(run[0], classes);
            if grey < 255 {
                // Writing to a string cannot fail.
                let _ = writeln!(
                    text,
                    "<rect x=\"{x}\" y=\"{y}\" width=\"{}\" height=\"1\" fill=\"#{grey:02x}{grey:02x}{grey:02x}\"/>",
                    run.len()
                );
            }
            x += run.len();
        }
    }
    text.push_str("</svg>\n");
    text
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
        assert_eq!((width, height, pixels.len()), (4, 4, 16));
        let grey = |x: usize, y: usize| pixels[y * 4 + x];
        assert_eq!(grey(0, 0), 0);
        assert_eq!(grey(1, 1), 0);
        assert_eq!(grey(2, 1), 255);
        assert_eq!(grey(0, 3), 255);
        assert_eq!(grey(3, 2), DARKEST);
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
        let message = |scale, name: &str| draw(&land, scale, &dir.path().join(name)).unwrap_err().to_string();
        assert!(message(4, "a.gif").contains(".png or .svg"));
        assert!(message(4, "no/folder/a.png").contains("a.png: "));
        assert!(message(4, "no/folder/a.svg").contains("a.svg: "));
        assert!(message(0, "a.png").contains("choose a scale"));
        assert!(message(6000, "a.png").contains("choose a scale"));
    }
}
