//! A map as the background of a picture, and the transformation from metres to picture units.

use super::canvas::{Anchor, Canvas, Pixels, Point, Shape, Stroke, Text};
use super::colour::{Colour, INK, MUTED, WHITE};
use super::layout::OTHER_FONTS;
use super::{font, ticks};
use crate::terrain::{self, shade};
use staya_controller::grid::BLOCKED;
use staya_sim::terrain::Terrain;

const WALL: Colour = Colour::hex(0x3a_3f_4a);
/// Pixels along the longer side; larger maps are averaged.
const MAX_PIXELS: u32 = 1720;
const ROOM: [f64; 2] = [860.0, 780.0];
/// Largest size of a cell in units, so that small maps stay small.
const MAX_CELL: f64 = 40.0;
const SMALL: f64 = 11.5;
pub const FOOTER: f64 = 40.0;

/// Paler than the brightness of [`terrain::render`], so that lines stand out.
fn land(brightness: u8) -> Colour {
    if brightness == shade(BLOCKED, 1) {
        return WALL;
    }
    let grey = 255 - (u32::from(255 - brightness) * 5 / 9) as u8;
    Colour { rgb: [grey; 3], alpha: 255 }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Raster {
    pub columns: u32,
    pub rows: u32,
    /// Cells along each side of a pixel.
    pub cells: u32,
}

impl Raster {
    fn new(terrain: &Terrain) -> Self {
        let [width, height] = [terrain.width(), terrain.height()].map(u32::from);
        let cells = width.max(height).div_ceil(MAX_PIXELS).max(1);
        Self { columns: width.div_ceil(cells), rows: height.div_ceil(cells), cells }
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Map<'a> {
    terrain: &'a Terrain,
    /// Left, top, width, height.
    pub area: [f64; 4],
    /// Units per cell.
    pub cell: f64,
}

impl<'a> Map<'a> {
    pub fn new(terrain: &'a Terrain, [left, top]: Point) -> Self {
        let sides = [terrain.width(), terrain.height()].map(f64::from);
        let cell = (ROOM[0] / sides[0]).min(ROOM[1] / sides[1]).min(MAX_CELL);
        // A very flat map is still visible as a line.
        let [width, height] = sides.map(|side| (side * cell).max(2.0));
        Self { terrain, area: [left, top, width, height], cell }
    }

    pub fn of_scale(terrain: &'a Terrain, [left, top]: Point, cell: f64) -> Self {
        let [width, height] = [terrain.width(), terrain.height()].map(|side| f64::from(side) * cell);
        Self { terrain, area: [left, top, width, height], cell }
    }

    pub fn place(&self, position_m: [f64; 2]) -> Point {
        let cells: [f64; 2] =
            std::array::from_fn(|axis| (position_m[axis] - self.terrain.origin_m[axis]) / self.terrain.cell_m);
        self.place_cells(cells)
    }

    pub fn place_cells(&self, [x, y]: [f64; 2]) -> Point {
        let [left, top, _, height] = self.area;
        [left + x * self.cell, top + height - y * self.cell]
    }

    pub fn raster(&self) -> Raster {
        Raster::new(self.terrain)
    }

    /// Column and row of a pixel from the north-west.
    pub fn square(&self, position_m: [f64; 2]) -> [i64; 2] {
        let [left, top, ..] = self.area;
        let [x, y] = self.place(position_m);
        let side = self.cell * f64::from(self.raster().cells);
        // Limited outside the map, so that paths still enter at the right place.
        [x - left, y - top].map(|along| libm::floor(along / side).clamp(-1e5, 1e5) as i64)
    }

    /// Pixels of the last column and row may extend beyond the map.
    pub fn image(&self, canvas: &mut Canvas, pixels: Pixels) {
        let side = self.cell * f64::from(self.raster().cells);
        let [width, height] = [pixels.width, pixels.height].map(|count| f64::from(count) * side);
        let [left, top, least_width, least_height] = self.area;
        let area = [left, top, width.max(least_width), height.max(least_height)];
        canvas.shapes.push(Shape::Image { area, pixels });
    }

    pub fn ground(&self, canvas: &mut Canvas) {
        self.image(canvas, pixels(self.terrain));
    }

    pub fn frame(&self, canvas: &mut Canvas) {
        canvas.rectangle(self.area, None, Some(Stroke::new(INK, 1.0)));
    }

    /// Scale, legend of shades and north arrow below the map.
    pub fn footer(&self, canvas: &mut Canvas, left: f64, right: f64) {
        let middle = self.area[1] + self.area[3] + FOOTER / 2.0 + 3.0;
        let from = self.scale_bar(canvas, [left, middle]);
        let north = right - 12.0;
        self.shades(canvas, middle, from + 24.0, north - 30.0);
        let arrow = vec![
            [north, middle - 13.0],
            [north + 5.0, middle + 1.0],
            [north, middle - 2.0],
            [north - 5.0, middle + 1.0],
        ];
        canvas.polygon(arrow, Some(INK), None);
        let mut letter = Text::new([north, middle + 13.0], SMALL, Anchor::Middle, "N");
        letter.bold = true;
        canvas.text(letter);
    }

    /// Returns the right end of its text.
    fn scale_bar(&self, canvas: &mut Canvas, [left, y]: Point) -> f64 {
        let per_m = self.cell / self.terrain.cell_m;
        let [_, _, width, height] = self.area;
        let longest = (width.max(height) * 0.25).min(200.0);
        let metres = ticks::round_down(longest / per_m);
        let length = metres * per_m;
        let ends = [left, left + length].map(|x| vec![[x, y - 4.0], [x, y + 4.0]]);
        let bar = vec![vec![[left, y], [left + length, y]]];
        let lines = bar.into_iter().chain(ends).collect();
        canvas.lines(lines, Stroke::new(INK, 1.4));
        let exact = metres / self.terrain.cell_m;
        let cells = (exact * 10.0).round() / 10.0;
        let relation = if (cells - exact).abs() < 1e-9 { "=" } else { "≈" };
        let unit = if cells == 1.0 { "cell" } else { "cells" };
        let distance = if metres < 1000.0 { format!("{metres} m") } else { format!("{} km", metres / 1000.0) };
        let label = format!("{distance} {relation} {cells} {unit}");
        let at = left + length + 8.0;
        canvas.text(Text::new([at, y], SMALL, Anchor::Start, &label).centred());
        at + font::width(&label, SMALL, false) * OTHER_FONTS
    }

    fn shades(&self, canvas: &mut Canvas, y: f64, from: f64, to: f64) {
        let classes = terrain::classes(self.terrain);
        let walls = self.terrain.cells().contains(&BLOCKED);
        let mut keys = vec![(WHITE, "open")];
        if classes > 1 {
            keys.push((land(shade(classes, classes)), "slowest"));
        }
        if walls {
            keys.push((WALL, "wall"));
        }
        let width = |text: &str| 18.0 + font::width(text, SMALL, false) * OTHER_FONTS + 14.0;
        let wanted: f64 = keys.iter().map(|(_, text)| width(text)).sum();
        let mut x = to - wanted;
        if keys.len() < 2 || x < from {
            return;
        }
        for (colour, text) in keys {
            let edge = Stroke::new(MUTED, 0.8);
            canvas.rectangle([x, y - 6.0, 12.0, 12.0], Some(colour), Some(edge));
            let label = Text::new([x + 18.0, y], SMALL, Anchor::Start, text);
            canvas.text(label.centred());
            x += width(text);
        }
    }
}

/// The part of a terrain between two places, in cells from its south-west corner: at least one
/// cell.
pub fn part(terrain: &Terrain, low: Point, high: Point) -> Option<Terrain> {
    let sides = [terrain.width(), terrain.height()].map(f64::from);
    let first = [0, 1].map(|axis| libm::floor(low[axis]).clamp(0.0, sides[axis] - 1.0));
    let size = [0, 1].map(|axis| (libm::ceil(high[axis]) - first[axis]).clamp(1.0, sides[axis] - first[axis]));
    let [x, y, width, height] = [first[0], first[1], size[0], size[1]].map(|value| value as u16);
    terrain.crop(x, y, width, height).ok()
}

/// One pixel per cell, or per square of cells on maps beyond [`MAX_PIXELS`].
fn pixels(terrain: &Terrain) -> Pixels {
    let (width, height, brightness) = terrain::render(terrain, 1);
    let Raster { columns, rows, cells: square } = Raster::new(terrain);
    let mut rgba = Vec::with_capacity(columns as usize * rows as usize);
    for row in 0..rows {
        for column in 0..columns {
            let (mut sum, mut count) = ([0_u32; 3], 0);
            for y in row * square..((row + 1) * square).min(height) {
                for x in column * square..((column + 1) * square).min(width) {
                    let at = y as usize * width as usize + x as usize;
                    let colour = land(brightness[at]).rgb;
                    (0..3).for_each(|i| sum[i] += u32::from(colour[i]));
                    count += 1;
                }
            }
            let [red, green, blue] = sum.map(|sum| (sum / count) as u8);
            rgba.push([red, green, blue, 255]);
        }
    }
    Pixels { width: columns, height: rows, rgba }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_follow_origin_cell_size_and_north() {
        let mut terrain = Terrain::from_cells(4, 2, vec![1; 8]).unwrap();
        (terrain.cell_m, terrain.origin_m) = (10.0, [100.0, -20.0]);
        let map = Map::new(&terrain, [5.0, 7.0]);
        assert_eq!((map.cell, map.area), (40.0, [5.0, 7.0, 160.0, 80.0]));
        assert_eq!(map.place([100.0, -20.0]), [5.0, 87.0]);
        assert_eq!(map.place([140.0, 0.0]), [165.0, 7.0]);
        assert_eq!(map.place([105.0, -15.0]), map.place_cells([0.5, 0.5]));
    }

    #[test]
    fn land_is_paler_than_drawn_alone_and_walls_are_darkest() {
        let terrain = Terrain::from_cells(3, 1, vec![1, 9, BLOCKED]).unwrap();
        let image = pixels(&terrain);
        assert_eq!((image.width, image.height), (3, 1));
        assert_eq!(image.rgba[0], [255; 4]);
        assert!(image.rgba[1][0] > shade(9, 9) && image.rgba[1][0] < 200);
        assert_eq!(image.rgba[2][..3], WALL.rgb);
        let greys: Vec<u8> = (1..=9).map(|u| land(shade(u, 9)).rgb[0]).collect();
        assert!(greys.is_sorted_by(|a, b| a > b), "{greys:?}");
    }

    #[test]
    fn large_maps_are_averaged_and_none_is_lost() {
        for side in [1, 1720, 1721, 5000] {
            let land = vec![1; usize::from(side) * 2];
            let image = pixels(&Terrain::from_cells(side, 2, land).unwrap());
            assert!(image.width <= MAX_PIXELS, "{side}");
            assert_eq!(image.rgba.len(), (image.width * image.height) as usize);
            assert!(image.rgba.iter().all(|pixel| *pixel == [255; 4]));
        }
    }
}
