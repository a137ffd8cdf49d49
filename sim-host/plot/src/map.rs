//! Maps in pictures: shades of land with their legend, a scale, and the transformation from metres.

use super::canvas::{Anchor, Canvas, Pixels, Point, Shape, Stroke, Text};
use super::colour::{Colour, INK, WHITE};
use super::layout::{Entry, OTHER_FONTS, legend};
use super::{font, ticks};
use staya_controller::grid::BLOCKED;
use staya_sim::terrain::Terrain;
use staya_sim::terrain::rows::flip_row;

/// Pixels along the longer side; larger maps are averaged.
const MAX_PIXELS: u32 = 1720;
const ROOM: [f64; 2] = [860.0, 780.0];
/// Largest size of a cell in units, so that small maps stay small.
const MAX_CELL: f64 = 40.0;
const SMALL: f64 = 11.5;
/// Height of [`Map::footer`], units.
pub const FOOTER: f64 = 40.0;

/// Colours of land: easy, slowest, blocked. Those between are linear.
pub type Shades = [Colour; 3];

/// Below lines, which stand out from it.
pub const PALE: Shades = [WHITE, Colour::hex(0x93_93_93), Colour::hex(0x3a_3f_4a)];
/// For land alone (A. V. Kuznetsov 2017, figure 7).
pub const DARK: Shades = [WHITE, Colour::hex(0x3c_3c_3c), Colour::hex(0x00_00_00)];

/// Colour of an impassability from 1 to `classes`, or of a blocked cell.
pub(crate) fn shade(impassability: u8, classes: u8, [easy, slowest, blocked]: Shades) -> Colour {
    if impassability == BLOCKED {
        return blocked;
    }
    easy.towards(slowest, f64::from(impassability - 1) / f64::from(classes.max(2) - 1))
}

/// Largest impassability of a terrain, at least 1.
pub(crate) fn classes(terrain: &Terrain) -> u8 {
    terrain.cells().iter().copied().max().unwrap_or(1).max(1)
}

/// Entries of a legend for the shades that a map has.
pub(crate) fn entries(terrain: &Terrain, shades: Shades) -> Vec<Entry<'static>> {
    let land = match classes(terrain) {
        1 => Entry::square("open", shades[0]),
        most => Entry::ramp(format!("cost 1 to {most}"), most.min(9).into(), move |share| {
            shades[0].towards(shades[1], share)
        }),
    };
    let blocked = terrain.cells().contains(&BLOCKED).then(|| Entry::square("blocked", shades[2]));
    [land].into_iter().chain(blocked).collect()
}

/// A length with its unit.
pub(crate) fn metres(length: f64) -> String {
    let rounded = |length: f64| libm::round(length * 1e6) / 1e6;
    if length < 1000.0 { format!("{} m", rounded(length)) } else { format!("{} km", rounded(length / 1000.0)) }
}

/// Number and size of the cells.
pub(crate) fn size(terrain: &Terrain) -> String {
    let cell_m = (terrain.cell_m * 100.0).round() / 100.0;
    format!("{} × {} cells of {cell_m} m", terrain.width(), terrain.height())
}

/// Draws a bar of a round length up to `longest` units and writes its length, with
/// `more` text about it. Returns the right end of the text.
pub(crate) fn scale_bar(
    canvas: &mut Canvas,
    [left, y]: Point,
    per_m: f64,
    longest: f64,
    more: impl Fn(f64) -> String,
) -> f64 {
    let length_m = ticks::round_down(longest / per_m);
    let right = left + length_m * per_m;
    let ends = [left, right].map(|x| vec![[x, y - 4.0], [x, y + 4.0]]);
    canvas.lines([vec![vec![[left, y], [right, y]]], ends.into()].concat(), Stroke::new(INK, 1.4));
    let label = metres(length_m) + &more(length_m);
    canvas.text(Text::new([right + 8.0, y], SMALL, Anchor::Start, &label).centred());
    right + 8.0 + font::width(&label, SMALL, false) * OTHER_FONTS
}

/// A map in a picture.
#[derive(Clone, Copy, Debug)]
pub struct Map<'a> {
    terrain: &'a Terrain,
    shades: Shades,
    /// Most pixels along a side.
    most: u32,
    /// Left, top, width, height.
    pub area: [f64; 4],
    /// Units per cell.
    pub cell: f64,
}

impl<'a> Map<'a> {
    /// Places a map in pale shades with a size that suits a picture of its own.
    #[must_use]
    pub fn new(terrain: &'a Terrain, at: Point) -> Self {
        let sides = [terrain.width(), terrain.height()].map(f64::from);
        let map = Self::of_scale(terrain, at, (ROOM[0] / sides[0]).min(ROOM[1] / sides[1]).min(MAX_CELL));
        let [left, top, width, height] = map.area;
        // A very flat map is still visible as a line.
        Self { area: [left, top, width.max(2.0), height.max(2.0)], ..map }
    }

    /// Places a map in pale shades with `cell` units per cell.
    #[must_use]
    pub fn of_scale(terrain: &'a Terrain, [left, top]: Point, cell: f64) -> Self {
        let [width, height] = [terrain.width(), terrain.height()].map(|side| f64::from(side) * cell);
        Self { terrain, shades: PALE, most: MAX_PIXELS, area: [left, top, width, height], cell }
    }

    /// Returns the map in dark shades and with each of its cells, for a picture without lines.
    #[must_use]
    pub fn alone(self) -> Self {
        Self { shades: DARK, most: u32::MAX, ..self }
    }

    /// Position in the picture of x and y in metres.
    #[must_use]
    pub fn place(&self, position_m: [f64; 2]) -> Point {
        let Terrain { origin_m, cell_m, .. } = self.terrain;
        self.place_cells([0, 1].map(|axis| (position_m[axis] - origin_m[axis]) / cell_m))
    }

    /// Position in the picture of a place in cells from the south-west corner.
    #[must_use]
    pub fn place_cells(&self, [x, y]: [f64; 2]) -> Point {
        let [left, top, _, height] = self.area;
        [left + x * self.cell, top + height - y * self.cell]
    }

    /// Columns and rows of pixels, and cells along each side of a pixel.
    pub(crate) fn raster(&self) -> [u32; 3] {
        let [width, height] = [self.terrain.width(), self.terrain.height()].map(u32::from);
        let cells = width.max(height).div_ceil(self.most).max(1);
        [width.div_ceil(cells), height.div_ceil(cells), cells]
    }

    /// Column and row of a pixel from the north-west.
    pub(crate) fn square(&self, position_m: [f64; 2]) -> [i64; 2] {
        let [left, top, ..] = self.area;
        let [x, y] = self.place(position_m);
        let side = self.cell * f64::from(self.raster()[2]);
        // Limited outside the map, so that paths still enter at the right place.
        [x - left, y - top].map(|along| libm::floor(along / side).clamp(-1e5, 1e5) as i64)
    }

    /// Pixels of the last column and row may extend beyond the map.
    pub(crate) fn image(&self, canvas: &mut Canvas, pixels: Pixels) {
        let side = self.cell * f64::from(self.raster()[2]);
        let [width, height] = [pixels.width, pixels.height].map(|count| f64::from(count) * side);
        let [left, top, least_width, least_height] = self.area;
        let area = [left, top, width.max(least_width), height.max(least_height)];
        canvas.shapes.push(Shape::Image { area, pixels });
    }

    /// Draws the land.
    pub fn ground(&self, canvas: &mut Canvas) {
        self.image(canvas, self.pixels());
    }

    /// Draws the border.
    pub fn frame(&self, canvas: &mut Canvas) {
        canvas.rectangle(self.area, None, Some(Stroke::new(INK, 1.0)));
    }

    /// Draws scale, legend of shades and north arrow below the map, from `left` to `right`.
    pub fn footer(&self, canvas: &mut Canvas, left: f64, right: f64) {
        let middle = self.area[1] + self.area[3] + FOOTER / 2.0 + 3.0;
        let [_, _, width, height] = self.area;
        let longest = (width.max(height) * 0.25).min(120.0);
        let cell_m = self.terrain.cell_m;
        let from = scale_bar(canvas, [left, middle], self.cell / cell_m, longest, |length_m| {
            let exact = length_m / cell_m;
            let cells = (exact * 10.0).round() / 10.0;
            let relation = if (cells - exact).abs() < 1e-9 { "=" } else { "≈" };
            format!(" {relation} {cells} {}", if cells == 1.0 { "cell" } else { "cells" })
        });
        let north = right - 12.0;
        legend(canvas, &entries(self.terrain, self.shades), [from + 24.0, middle - 9.5], north - 14.0, 14.0);
        let arrow = [[0.0, -13.0], [5.0, 1.0], [0.0, -2.0], [-5.0, 1.0]];
        canvas.polygon(arrow.map(|[x, y]| [north + x, middle + y]).into(), Some(INK), None);
        let letter = Text::new([north, middle + 13.0], SMALL, Anchor::Middle, "N");
        canvas.text(Text { bold: true, ..letter });
    }

    /// One pixel per cell, north up, or per square of cells on larger maps than `most`.
    fn pixels(&self) -> Pixels {
        let [columns, rows, square] = self.raster();
        let [width, height] = [self.terrain.width(), self.terrain.height()].map(u32::from);
        let colours: Vec<Colour> =
            (0..=u8::MAX).map(|value| shade(value, classes(self.terrain), self.shades)).collect();
        let mut rgba = Vec::with_capacity(columns as usize * rows as usize);
        for row in 0..rows {
            let across =
                (row * square..((row + 1) * square).min(height)).map(|row| flip_row(row as u16, height as u16));
            for column in 0..columns {
                let (mut sum, mut count) = ([0_u32; 3], 0);
                for y in across.clone() {
                    for x in column * square..((column + 1) * square).min(width) {
                        let class = self.terrain.cells()[usize::from(y) * width as usize + x as usize];
                        (0..3).for_each(|i| sum[i] += u32::from(colours[usize::from(class)].rgb[i]));
                        count += 1;
                    }
                }
                let [red, green, blue] = sum.map(|sum| (sum / count) as u8);
                rgba.push([red, green, blue, 255]);
            }
        }
        Pixels { width: columns, height: rows, rgba }
    }
}

/// The part of a terrain between two places, in cells from its south-west corner: at least one
/// cell.
pub(crate) fn part(terrain: &Terrain, low: Point, high: Point) -> Option<Terrain> {
    let sides = [terrain.width(), terrain.height()].map(f64::from);
    let first = [0, 1].map(|axis| libm::floor(low[axis]).clamp(0.0, sides[axis] - 1.0));
    let size = [0, 1].map(|axis| (libm::ceil(high[axis]) - first[axis]).clamp(1.0, sides[axis] - first[axis]));
    let [x, y, width, height] = [first[0], first[1], size[0], size[1]].map(|value| value as u16);
    terrain.crop(x, y, width, height).ok()
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
    fn darker_means_less_passable_and_blocked_cells_are_darkest() {
        for shades in [PALE, DARK] {
            for classes in [1, 2, 9, 255] {
                let greys: Vec<u8> = (1..=classes).map(|u| shade(u, classes, shades).rgb[0]).collect();
                assert_eq!(greys[0], 255);
                assert!(greys.is_sorted_by(|a, b| a > b || classes == 255 && a >= b), "{greys:?}");
                assert!(classes == 1 || *greys.last().unwrap() == shades[1].rgb[0]);
                assert_eq!(shade(BLOCKED, classes, shades), shades[2]);
            }
        }
        let land = Terrain::from_cells(2, 2, vec![1, 9, BLOCKED, 1]).unwrap();
        let image = Map::new(&land, [0.0; 2]).alone().pixels();
        let greys: Vec<u8> = image.rgba.iter().map(|pixel| pixel[0]).collect();
        assert_eq!(greys, [0, 255, 255, DARK[1].rgb[0]], "north is up");
    }

    #[test]
    fn large_maps_are_averaged_and_none_is_lost() {
        for side in [1, 1720, 1721, 5000] {
            let terrain = Terrain::from_cells(side, 2, vec![1; usize::from(side) * 2]).unwrap();
            let map = Map::new(&terrain, [0.0; 2]);
            let image = map.pixels();
            assert!(image.width <= MAX_PIXELS, "{side}");
            assert_eq!(image.rgba.len(), (image.width * image.height) as usize);
            assert!(image.rgba.iter().all(|pixel| *pixel == [255; 4]));
            assert_eq!(map.alone().pixels().width, u32::from(side), "alone it is exact");
        }
    }
}
