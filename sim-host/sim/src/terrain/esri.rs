//! ESRI ASCII grids (`.asc`): terrain heights in a text format that every GIS can write.
//!
//! Source: ESRI, "ASCII raster format" (ArcGIS documentation). Files list rows from the north;
//! [`super::rows`] reverses them.

use super::error::{Place, TerrainError, fits, format_error, parameter_error};
use super::rows::flip_rows;
use super::text::{finite, lines, quoted, side, text};
use std::path::Path;

/// Heights on a grid, row 0 in the south.
#[derive(Clone, Debug, PartialEq)]
pub struct Heights {
    /// Cells from west to east.
    pub width: u16,
    /// Cells from south to north.
    pub height: u16,
    /// Metres above any datum, row by row from the south-west corner; NaN if unknown.
    pub metres: Vec<f32>,
    /// Side of a cell, metres; more than 0.
    pub cell_m: f64,
    /// World position of the south-west corner of the grid, metres.
    pub origin_m: [f64; 2],
}

#[derive(Default)]
struct Header {
    columns: Option<u16>,
    rows: Option<u16>,
    /// Sides of a cell along x and y, with the line that gives them.
    cell_m: [Option<(f64, usize)>; 2],
    /// Position along x and y, and whether it is that of a cell's centre.
    origin: [Option<(f64, bool)>; 2],
    no_data: Option<f64>,
}

/// No height is larger, metres. Programs write such numbers for unknown heights only.
const HIGHEST_M: f64 = 1e30;

/// Rounding of a no-data value in the body: a few units in the last place of an `f32`.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

impl Header {
    /// Stores the value of a header line; false if the line is not a header, so the data begins.
    fn take(&mut self, key: &str, word: &str, line: usize, path: &Path) -> Result<bool, TerrainError> {
        let key = key.to_ascii_lowercase();
        match key.as_str() {
            "ncols" => self.columns = Some(side(path, line, "ncols", word)?),
            "nrows" => self.rows = Some(side(path, line, "nrows", word)?),
            "xllcorner" | "xllcenter" => {
                self.origin[0] = Some((finite(path, line, &key, word)?, key == "xllcenter"));
            }
            "yllcorner" | "yllcenter" => {
                self.origin[1] = Some((finite(path, line, &key, word)?, key == "yllcenter"));
            }
            "cellsize" | "dx" | "dy" => {
                let cell_m = finite(path, line, &key, word)?;
                if cell_m <= 0.0 {
                    return Err(format_error(
                        path,
                        Place::Line(line),
                        format!("{key} is {word}"),
                        "give the side of a cell in metres, more than 0",
                    ));
                }
                let axes = match key.as_str() {
                    "dx" => 0..1,
                    "dy" => 1..2,
                    _ => 0..2,
                };
                for side in &mut self.cell_m[axes] {
                    let before = *side.get_or_insert((cell_m, line));
                    same_side(path, line, before.0, cell_m)?;
                }
            }
            // Some programs write "nan" here, which is valid.
            "nodata_value" => {
                self.no_data = Some(word.parse().map_err(|_| {
                    format_error(path, Place::Line(line), format!("NODATA_value is {}", quoted(word)), "give a number")
                })?);
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Side of a cell, with the line that gives it.
    fn cell_m(&self, path: &Path) -> Result<Option<(f64, usize)>, TerrainError> {
        let [Some((along_x, _)), Some((along_y, line))] = self.cell_m else { return Ok(None) };
        same_side(path, line, along_x, along_y)?;
        Ok(Some((along_x, line)))
    }

    fn origin_m(&self, axis: usize, cell_m: f64) -> Option<f64> {
        let (at, is_center) = self.origin[axis]?;
        Some(if is_center { at - cell_m / 2.0 } else { at })
    }
}

/// Refuses cells that are not square.
fn same_side(path: &Path, line: usize, one: f64, other: f64) -> Result<(), TerrainError> {
    if (one - other).abs() <= 1e-6 * one {
        return Ok(());
    }
    let what = format!("the cells are not square: sides of {one} and {other}");
    Err(format_error(path, Place::Line(line), what, "resample the grid to square cells"))
}

/// Reads an ESRI ASCII grid with heights and cell sizes in metres.
///
/// Header lines may have any order and case, with equal `dx` and `dy` in place of `cellsize`. Line
/// breaks between values are ignored. Numbers within a few units in the last place of
/// `NODATA_value` (-9999 if the header has none), beyond 1e30 or not finite become NaN. O(size).
///
/// # Errors
/// A [`TerrainError::Format`] with the line, if the file violates the format or its cells are
/// degrees wide.
pub fn parse_heights(bytes: &[u8], path: &Path) -> Result<Heights, TerrainError> {
    let text = text(bytes, path)?;
    let mut header = Header::default();
    let mut rows = lines(text).peekable();
    while let Some((line, row)) = rows.peek().copied() {
        let mut words = row.split_whitespace();
        match (words.next(), words.next(), words.next()) {
            (None, _, _) => {}
            (Some(key), Some(word), None) if header.take(key, word, line, path)? => {}
            _ => break,
        }
        rows.next();
    }
    let first_line = rows.peek().map_or(1, |(line, _)| *line);
    let missing = |field: &str| {
        format_error(
            path,
            Place::Line(first_line),
            format!("the header has no {field}"),
            "an ESRI ASCII grid begins with the lines ncols, nrows, xllcorner (or xllcenter), yllcorner (or yllcenter), cellsize, NODATA_value, each with a number",
        )
    };
    let width = header.columns.ok_or_else(|| missing("ncols"))?;
    let height = header.rows.ok_or_else(|| missing("nrows"))?;
    let (cell_m, cell_line) = header.cell_m(path)?.ok_or_else(|| missing("cellsize"))?;
    let origin_m = [
        header.origin_m(0, cell_m).ok_or_else(|| missing("xllcorner"))?,
        header.origin_m(1, cell_m).ok_or_else(|| missing("yllcorner"))?,
    ];
    let no_data = header.no_data.unwrap_or(-9999.0);

    let wanted = usize::from(width) * usize::from(height);
    fits(path, width, height, 8)?;
    let mut metres = Vec::new();
    let mut last = first_line;
    for (line, row) in rows {
        for word in row.split_whitespace() {
            last = line;
            let metre: f64 = word.parse().map_err(|_| {
                format_error(
                    path,
                    Place::Line(line),
                    format!("{} where a height should be", quoted(word)),
                    "heights are numbers in metres; unknown ones are written as NODATA_value",
                )
            })?;
            if metres.len() == wanted {
                return Err(format_error(
                    path,
                    Place::Line(line),
                    format!("more than the {wanted} values of {height} rows with {width} columns"),
                    "correct ncols and nrows, or remove what is too much",
                ));
            }
            let is_no_data = (metre - no_data).abs() <= ROUNDING * no_data.abs();
            let is_known = metre.abs() < HIGHEST_M && !is_no_data;
            metres.push(if is_known { metre as f32 } else { f32::NAN });
        }
    }
    if metres.len() < wanted {
        return Err(format_error(
            path,
            Place::Line(last),
            format!("the file ends after {} of {wanted} values", metres.len()),
            "it is truncated: fetch it again, or correct ncols and nrows",
        ));
    }
    flip_rows(&mut metres, width);
    let heights = Heights { width, height, metres, cell_m, origin_m };
    if heights.is_in_degrees() {
        return Err(format_error(
            path,
            Place::Line(cell_line),
            format!("cells of {cell_m} are degrees: as metres, the land would be a wall"),
            "project the grid to metres, for example to UTM with gdalwarp; if these are metres, give another corner",
        ));
    }
    Ok(heights)
}

/// Steeper steps to neighbours, rise over run, do not exist on land.
const CLIFF: f64 = 20.0;
/// Land is not this much higher than it is wide.
const SPIRE: f64 = 4.0;
/// No object is this much higher than the map is wide.
const NEEDLE: f64 = 100.0;
/// Walls on a floor have fewer heights than land.
const LEVELS: usize = 5;

impl Heights {
    /// Whether the sides of the cells must be degrees of longitude and latitude: the map lies
    /// within their ranges, and as metres most of its slopes would be cliffs and the map higher
    /// than wide. So grids of degrees are found with lakes and seas in them, and floors with cells
    /// of millimetres are not. O(size).
    fn is_in_degrees(&self) -> bool {
        let sides = [self.width, self.height].map(|cells| f64::from(cells) * self.cell_m);
        let is_within = |axis: usize, low: f64, high: f64| {
            self.origin_m[axis] >= low - self.cell_m && self.origin_m[axis] + sides[axis] <= high + self.cell_m
        };
        if !(is_within(0, -180.0, 360.0) && is_within(1, -90.0, 90.0)) {
            return false;
        }
        let known = || self.metres.iter().filter(|metre| !metre.is_nan());
        let [low, high] = known().fold([f32::MAX, f32::MIN], |[low, high], &metre| [low.min(metre), high.max(metre)]);
        let slenderness = f64::from(high - low) / sides[0].max(sides[1]);
        if slenderness < SPIRE || (slenderness < NEEDLE && levels(known()) < LEVELS) {
            return false;
        }
        let width = usize::from(self.width);
        let along_x = self.metres.chunks_exact(width).flat_map(|row| row.windows(2).map(|pair| pair[1] - pair[0]));
        let along_y = self.metres.iter().zip(self.metres.iter().skip(width)).map(|(south, north)| north - south);
        // A step from or to an unknown height is NaN, and not more than 0.
        let (mut cliffs, mut slopes) = (0_usize, 0_usize);
        for step in along_x.chain(along_y).map(f32::abs).filter(|step| *step > 0.0) {
            if f64::from(step) > CLIFF * self.cell_m {
                cliffs += 1;
            } else {
                slopes += 1;
            }
        }
        cliffs > slopes
    }

    /// Combines `factor` x `factor` cells into one: the mean of their known heights, or unknown if
    /// fewer than half are known. Drops incomplete cells in the east and north. O(size).
    ///
    /// # Errors
    /// A [`TerrainError::Parameter`] if `factor` is 0 or no cell would remain.
    pub fn downsample(&self, factor: u16) -> Result<Self, TerrainError> {
        if factor == 0 || factor > self.width.min(self.height) {
            return Err(parameter_error(
                format!("downsample is {factor} for heights on {} x {} cells", self.width, self.height),
                "give a whole number from 1 to the shorter side",
            ));
        }
        let (width, height) = (self.width / factor, self.height / factor);
        let side = usize::from(factor);
        let mut metres = Vec::with_capacity(usize::from(width) * usize::from(height));
        for y in 0..usize::from(height) {
            for x in 0..usize::from(width) {
                let (mut sum, mut known) = (0.0, 0);
                for row in y * side..(y + 1) * side {
                    let at = row * usize::from(self.width) + x * side;
                    for metre in self.metres[at..at + side].iter().filter(|m| !m.is_nan()) {
                        sum += f64::from(*metre);
                        known += 1;
                    }
                }
                let is_known = known > 0 && known * 2 >= side * side;
                metres.push(if is_known { (sum / known as f64) as f32 } else { f32::NAN });
            }
        }
        Ok(Self { width, height, metres, cell_m: self.cell_m * f64::from(factor), origin_m: self.origin_m })
    }
}

/// The number of different heights, at most [`LEVELS`].
fn levels<'a>(heights: impl Iterator<Item = &'a f32>) -> usize {
    let mut levels = Vec::new();
    for height in heights {
        if !levels.contains(height) {
            levels.push(*height);
        }
        if levels.len() == LEVELS {
            break;
        }
    }
    levels.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GRID: &str =
        "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 200.5\ncellsize 10\nNODATA_value -1\n1 2 3\n4 -1 6\n";

    fn heights(text: &str) -> Result<Heights, TerrainError> {
        parse_heights(text.as_bytes(), Path::new("a.asc"))
    }

    #[test]
    fn the_last_file_row_is_the_southernmost() {
        let grid = heights(GRID).unwrap();
        assert_eq!((grid.width, grid.height, grid.cell_m), (3, 2, 10.0));
        assert_eq!(grid.origin_m, [100.0, 200.5]);
        assert_eq!(grid.metres[0], 4.0);
        assert!(grid.metres[1].is_nan());
        assert_eq!(grid.metres[2..], [6.0, 1.0, 2.0, 3.0]);
    }

    #[test]
    fn centre_origins_letter_case_and_line_breaks_do_not_matter() {
        let other = "NROWS 2\r\nNCOLS 3\r\ncellsize 10\r\nXLLCENTER 105\r\nyllCenter 205.5\r\nnodata_VALUE -1\r\n1 2\r\n3 4 -1\r\n\r\n6";
        let (a, b) = (heights(GRID).unwrap(), heights(other).unwrap());
        assert_eq!((a.width, a.height, a.cell_m, a.origin_m), (b.width, b.height, b.cell_m, b.origin_m));
        assert_eq!(a.metres[2..], b.metres[2..]);
    }

    #[test]
    fn no_data_is_minus_9999_by_default_and_may_be_nan() {
        let text = "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n-9999 nan\n";
        assert!(heights(text).unwrap().metres.iter().all(|m| m.is_nan()));
        let text = "ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value nan\n-9999";
        assert_eq!(heights(text).unwrap().metres, [-9999.0]);
    }

    #[test]
    fn no_data_is_found_if_it_was_rounded() {
        let pairs = [
            ("-3.4028234663852886e+38", "-3.402823e+38"),
            ("-3.40282347e+38", "-3.4028234663852886e+38"),
            ("-1.70141183460469231731687303715884105728e+38", "-1.70141e+38"),
            ("-9999", "-9.999000e+03"),
            ("-32767.9999", "-32768"),
            ("1e20", "1.0000001e20"),
        ];
        for (header, body) in pairs {
            let text = GRID.replace("_value -1", &format!("_value {header}")).replace("4 -1", &format!("4 {body}"));
            assert!(heights(&text).unwrap().metres[1].is_nan(), "{header}, {body}");
        }
        for (header, body) in [("-9999", "-9998"), ("0", "1e-6"), ("-32768", "-32767")] {
            let text = GRID.replace("_value -1", &format!("_value {header}")).replace("4 -1", &format!("4 {body}"));
            assert_eq!(heights(&text).unwrap().metres[1], body.parse::<f32>().unwrap(), "{header}, {body}");
        }
    }

    #[test]
    fn no_height_is_beyond_1e30() {
        for word in ["1e30", "-3.4e38", "1.70141e38", "inf", "-1e400"] {
            assert!(heights(&GRID.replace("4 -1", &format!("4 {word}"))).unwrap().metres[1].is_nan(), "{word}");
        }
    }

    #[test]
    fn square_cells_may_have_two_sides() {
        let both = |sides: &str| heights(&GRID.replace("cellsize 10", sides));
        for sides in ["dx 10\ndy 10", "DY 10\nDX 10.0", "dx 10\ndy 10.000001", "cellsize 10\ndx 10\ndy 10"] {
            assert_eq!(both(sides).unwrap().cell_m, 10.0, "{sides}");
        }
        for (sides, expected) in [
            ("dx 20\ndy 25", "a.asc:6: the cells are not square: sides of 20 and 25; resample"),
            ("dx 20\ndy 25\ncellsize 20", "a.asc:7: the cells are not square: sides of 25 and 20"),
            ("dx 20", "a.asc:7: the header has no cellsize"),
            ("dx 20\ndy -20", "a.asc:6: dy is -20; give the side"),
        ] {
            let message = both(sides).unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}");
        }
    }

    /// A grid with a corner, a side of its cells, and heights by column and row.
    fn grid(corner: [f64; 2], cell: f64, sides: [usize; 2], height: impl Fn(usize, usize) -> f64) -> String {
        let ([x, y], [columns, rows]) = (corner, sides);
        let mut text = format!("ncols {columns}\nnrows {rows}\nxllcorner {x}\nyllcorner {y}\ncellsize {cell}\n");
        for row in 0..rows {
            let row: Vec<String> = (0..columns).map(|column| height(column, row).to_string()).collect();
            text += &format!("{}\n", row.join(" "));
        }
        text
    }

    /// Land with hills, metres.
    fn hills(x: usize, y: usize) -> f64 {
        let [x, y] = [x as f64, y as f64];
        300.0 + 12.0 * libm::sin(x / 3.0) + 9.0 * libm::cos(y / 4.0) + (x * 7.0 + y * 3.0) % 2.0
    }

    #[test]
    fn grids_in_degrees_are_refused() {
        let lake = |x: usize, y: usize| if x < 16 { 284.0 } else { hills(x, y) };
        let isle = |x: usize, y: usize| if (x + y) % 40 < 34 { 0.0 } else { hills(x, y) / 10.0 };
        let sea = |x: usize, y: usize| if x < 10 { -9999.0 } else { hills(x, y) };
        let polder = |x: usize, y: usize| ((x / 7 + y / 5) % 6) as f64 / 4.0 - 2.0;
        let grids = [
            grid([8.5, 47.2], 3.0 / 3600.0, [20, 20], hills),
            grid([-122.0, -45.0], 1.0 / 3600.0, [20, 20], lake),
            grid([0.0, 0.0], 1.0 / 10_800.0, [20, 20], hills),
            grid([8.5, 47.2], 3.0 / 3600.0, [20, 20], sea),
            grid([8.5, 47.2], 3.0 / 3600.0, [40, 40], isle),
            grid([4.5, 52.0], 1.0 / 3600.0, [60, 60], polder),
            grid([-180.0, -90.0], 0.25, [10, 10], |x, y| 10.0 * hills(x, y)),
            grid([170.0, -45.0], 1.0 / 60.0, [20, 20], hills),
        ];
        for text in grids {
            let message = heights(&text).unwrap_err().to_string();
            assert!(message.starts_with("a.asc:5: cells of "), "{message}");
            assert!(message.contains("project the grid to metres"), "{message}");
        }
    }

    #[test]
    fn grids_in_metres_are_read_however_small_their_cells_are() {
        let floor = |x: usize, y: usize| 0.04 + 0.0004 * ((x * 5 + y * 3) % 7) as f64;
        let walls = |x: usize, y: usize| if x.is_multiple_of(9) || y.is_multiple_of(11) { 2.5 } else { 0.0 };
        let boxes = |x: usize, y: usize| [0.0, 12.0, 21.0][usize::from(x % 8 > 4) + usize::from(y % 9 > 5)];
        let rough = |x: usize, y: usize| walls(x, y) + floor(x, y);
        let grids = [
            grid([2.4, 1.1], 0.005, [8, 6], floor),
            grid([0.0, 0.0], 0.005, [100, 80], walls),
            grid([0.0, 0.0], 0.005, [100, 80], rough),
            grid([0.0, 0.0], 1.0, [60, 60], boxes),
            grid([0.0, 0.0], 0.5, [100, 100], hills),
            grid([500_000.0, 4e6], 0.0008, [20, 20], hills),
            grid([8.0, 47.0], 30.0, [3, 3], hills),
            grid([0.0, 0.0], 0.001, [30, 30], |_, _| 100.0),
        ];
        for text in grids {
            heights(&text).unwrap();
        }
    }

    #[test]
    fn errors_name_file_line_and_remedy() {
        let cases = [
            (GRID.replace(" 6\n", "\n"), "a.asc:8: the file ends after 5 of 6 values; it is truncated"),
            (GRID.replace(" 6\n", " 6 7\n"), "a.asc:8: more than the 6 values"),
            (GRID.replace("2 3", "2 x"), "a.asc:7: \"x\" where a height should be"),
            (GRID.replace("ncols 3\n", ""), "a.asc:6: the header has no ncols; an ESRI ASCII grid begins"),
            (GRID.replace("yllcorner 200.5\n", ""), "a.asc:6: the header has no yllcorner"),
            (GRID.replace("ncols 3", "ncols 0"), "a.asc:1: ncols is \"0\"; give a whole number from 1"),
            (GRID.replace("cellsize 10", "cellsize 0"), "a.asc:5: cellsize is 0; give the side of a cell in metres"),
            (GRID.replace("cellsize 10", "cellsize NaN"), "a.asc:5: cellsize is \"NaN\"; give a finite number"),
            (GRID.replace("_value -1", "_value x"), "a.asc:6: NODATA_value is \"x\"; give a number"),
            (String::new(), "a.asc:1: the header has no ncols"),
        ];
        for (text, expected) in cases {
            let message = heights(&text).unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}");
        }
    }

    #[test]
    fn downsampling_takes_means_of_known_heights() {
        let grid = Heights {
            width: 5,
            height: 2,
            metres: vec![1.0, 2.0, f32::NAN, f32::NAN, 9.0, 3.0, 4.0, f32::NAN, 8.0, 9.0],
            cell_m: 2.0,
            origin_m: [7.0, 8.0],
        };
        let half = grid.downsample(2).unwrap();
        assert_eq!((half.width, half.height, half.cell_m), (2, 1, 4.0));
        assert_eq!(half.origin_m, [7.0, 8.0]);
        assert_eq!(half.metres[0], 2.5);
        assert!(half.metres[1].is_nan());
        assert!(grid.downsample(0).is_err());
        assert!(grid.downsample(3).is_err());
        assert_eq!(grid.downsample(1).unwrap().metres[..2], grid.metres[..2]);
    }

    proptest! {
        #[test]
        fn any_bytes_are_heights_or_an_error(bytes: Vec<u8>) {
            let _ = parse_heights(&bytes, Path::new("a.asc"));
        }

        #[test]
        fn any_header_and_body_are_heights_or_an_error(
            header in "(ncols|nrows|cellsize|xllcorner|yllcenter) [0-9.e-]{1,3}\n{0,6}",
            body in "[0-9naif.e \n-]{0,30}",
        ) {
            let text = format!("ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n{header}{body}");
            if let Ok(grid) = heights(&text) {
                let wanted = usize::from(grid.width) * usize::from(grid.height);
                prop_assert_eq!(grid.metres.len(), wanted);
                prop_assert!(grid.cell_m > 0.0);
            }
        }
    }
}
