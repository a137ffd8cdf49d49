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
    cell_m: Option<f64>,
    /// Position along x and y, and whether it is that of a cell's centre.
    origin: [Option<(f64, bool)>; 2],
    no_data: Option<f32>,
}

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
            "cellsize" => {
                let cell_m = finite(path, line, "cellsize", word)?;
                if cell_m <= 0.0 {
                    return Err(format_error(
                        path,
                        Place::Line(line),
                        format!("cellsize is {word}"),
                        "give the side of a cell in metres, more than 0",
                    ));
                }
                self.cell_m = Some(cell_m);
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

    fn origin_m(&self, axis: usize, cell_m: f64) -> Option<f64> {
        let (at, is_center) = self.origin[axis]?;
        Some(if is_center { at - cell_m / 2.0 } else { at })
    }
}

/// Reads an ESRI ASCII grid with heights and cell sizes in metres.
///
/// Header lines may have any order and case. Line breaks between values are ignored. `NODATA_value`
/// (-9999 if the header has none) and numbers that are not finite become NaN. O(size).
///
/// # Errors
/// A [`TerrainError::Format`] with the line, if the file violates the format.
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
    let cell_m = header.cell_m.ok_or_else(|| missing("cellsize"))?;
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
            let metre: f32 = word.parse().map_err(|_| {
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
            let is_known = metre.is_finite() && metre != no_data;
            metres.push(if is_known { metre } else { f32::NAN });
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
    Ok(Heights { width, height, metres, cell_m, origin_m })
}

impl Heights {
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
