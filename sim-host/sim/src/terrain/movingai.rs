//! Moving AI benchmark files: octile `.map` grids and `.scen` lists of queries.
//!
//! Source: N. Sturtevant, "Benchmarks for Grid-Based Pathfinding", IEEE TCIAIG 2012. Files list
//! rows from the north; [`super::rows`] reverses them.

use super::Terrain;
use super::error::{Place, TerrainError, fits, format_error, read};
use super::rows::{flip_row, flip_rows};
use super::text::{finite, integer, lines, quoted, side, text};
use staya_controller::grid::{BLOCKED, Cell};
use std::path::Path;

/// Default impassability of swamp (`S`); 1, as in the benchmark, reproduces its optimal lengths.
pub const SWAMP: u8 = 3;

/// Reads a `.map`: `.` and `G` are ground (impassability 1), `S` is `swamp`, and `@`, `O`, `T`, `W`
/// are blocked. Cells are 1 m wide, and the south-west corner is the origin. O(size).
///
/// A map with an `E` is one of the League of Robot Runners (github.com/MAPF-Competition): there `E`
/// is an emitter and `S` a service point, both ground.
///
/// # Errors
/// A [`TerrainError::Format`] with the line, if the file violates the format.
pub fn parse_map(bytes: &[u8], path: &Path, swamp: u8) -> Result<Terrain, TerrainError> {
    let text = text(bytes, path)?;
    let mut rows = lines(text);
    let (width, height) = header(&mut rows, path)?;
    fits(path, width, height, 2)?;
    let rows: Vec<_> = rows.collect();
    let swamp = if rows.iter().any(|(_, row)| row.contains('E')) { 1 } else { swamp };
    let mut cells = Vec::new();
    let mut found = 0;
    let mut last = 0;
    for (line, row) in rows {
        last = line;
        if found == height {
            if row.trim().is_empty() {
                continue;
            }
            return Err(format_error(
                path,
                Place::Line(line),
                format!("a row after the {height} that the header promises"),
                "correct height, or remove the row",
            ));
        }
        if row.chars().count() != usize::from(width) {
            return Err(format_error(
                path,
                Place::Line(line),
                format!("a row of {} cells", row.chars().count()),
                format!("each row must have the {width} cells that the header promises"),
            ));
        }
        for (column, letter) in row.chars().enumerate() {
            cells.push(match letter {
                '.' | 'G' | 'E' => 1,
                'S' => swamp,
                '@' | 'O' | 'T' | 'W' => BLOCKED,
                other => {
                    return Err(format_error(
                        path,
                        Place::Line(line),
                        format!("{other:?} in column {}", column + 1),
                        "cells are . G S E (passable) or @ O T W (blocked)",
                    ));
                }
            });
        }
        found += 1;
    }
    if found < height {
        return Err(format_error(
            path,
            Place::Line(last),
            format!("the file ends after {found} of {height} rows"),
            "it is truncated: fetch it again, or correct height",
        ));
    }
    flip_rows(&mut cells, width);
    Terrain::from_cells(width, height, cells)
}

fn header<'a>(rows: &mut impl Iterator<Item = (usize, &'a str)>, path: &Path) -> Result<(u16, u16), TerrainError> {
    let (mut width, mut height, mut last) = (None, None, 1);
    for (line, row) in rows {
        last = line;
        let words: Vec<&str> = row.split_whitespace().collect();
        match words[..] {
            [] | ["type", "octile"] => {}
            ["width", word] => width = Some(side(path, line, "width", word)?),
            ["height", word] => height = Some(side(path, line, "height", word)?),
            ["map"] => match (width, height) {
                (Some(width), Some(height)) => return Ok((width, height)),
                _ => break,
            },
            _ => {
                return Err(format_error(
                    path,
                    Place::Line(line),
                    format!("{} in the header", quoted(row)),
                    "a Moving AI map begins with the lines: type octile, height N, width N, map",
                ));
            }
        }
    }
    Err(format_error(
        path,
        Place::Line(last),
        "the header has no width, no height or no line \"map\"",
        "a Moving AI map begins with the lines: type octile, height N, width N, map",
    ))
}

/// A query of a `.scen` file.
#[derive(Clone, Debug, PartialEq)]
pub struct Query {
    /// Line of the file, counted from 1.
    pub line: usize,
    /// Bucket; queries of similar length share one.
    pub bucket: u32,
    /// Name of the map in the file.
    pub map: String,
    /// Columns of the map.
    pub width: u16,
    /// Rows of the map.
    pub height: u16,
    /// Start cell, with row 0 in the south.
    pub start: Cell,
    /// Goal cell, with row 0 in the south.
    pub goal: Cell,
    /// Length of the shortest route in cells; a diagonal move is sqrt 2 long and cuts no corner.
    pub optimal_length: f64,
}

impl Query {
    /// Column and row of a cell as in the file, where row 0 is in the north.
    #[must_use]
    pub const fn in_file(&self, cell: Cell) -> [u16; 2] {
        in_file(cell, self.height)
    }

    /// The last part of the map's name.
    #[must_use]
    pub fn map_name(&self) -> &str {
        self.map.rsplit(['/', '\\']).next().unwrap_or_default()
    }
}

/// Column and row, counted from the north-west, of a cell on a map of `height` rows.
#[must_use]
pub const fn in_file(cell: Cell, height: u16) -> [u16; 2] {
    [cell.x.cast_unsigned(), flip_row(cell.y.cast_unsigned(), height)]
}

/// Reads a `.scen`, versions 1 and 1.0. O(size).
///
/// # Errors
/// A [`TerrainError::Format`] with the line, if the file violates the format.
pub fn parse_scen(bytes: &[u8], path: &Path) -> Result<Vec<Query>, TerrainError> {
    let text = text(bytes, path)?;
    let mut rows = lines(text);
    let version = rows.next().map_or("", |(_, row)| row).trim();
    if !matches!(version, "version 1" | "version 1.0") {
        return Err(format_error(
            path,
            Place::Line(1),
            format!("the first line is {}", quoted(version)),
            "a Moving AI scenario begins with: version 1",
        ));
    }
    rows.filter(|(_, row)| !row.trim().is_empty()).map(|(line, row)| query(row, line, path)).collect()
}

/// Reads a `.scen` file; see [`parse_scen`].
///
/// # Errors
/// A [`TerrainError::Read`], or the errors of [`parse_scen`].
pub fn load_scen(path: &Path) -> Result<Vec<Query>, TerrainError> {
    parse_scen(&read(path)?, path)
}

fn query(row: &str, line: usize, path: &Path) -> Result<Query, TerrainError> {
    // Map names may contain spaces if the fields are separated by tabs.
    let fields: Vec<&str> =
        if row.contains('\t') { row.split('\t').map(str::trim).collect() } else { row.split_whitespace().collect() };
    let [bucket, map, width, height, start_x, start_y, goal_x, goal_y, length] = fields[..] else {
        return Err(format_error(
            path,
            Place::Line(line),
            format!("{} fields", fields.len()),
            "a query has nine: bucket, map, width, height, start x, start y, goal x, goal y, optimal length",
        ));
    };
    let width = side(path, line, "map width", width)?;
    let height = side(path, line, "map height", height)?;
    let cell = |field: &str, x: &str, y: &str| -> Result<Cell, TerrainError> {
        let column: u16 = integer(path, line, &format!("{field} x"), x)?;
        let row: u16 = integer(path, line, &format!("{field} y"), y)?;
        if column >= width || row >= height {
            return Err(format_error(
                path,
                Place::Line(line),
                format!("the {field} ({column}, {row}) lies outside the map of {width} x {height}"),
                "columns and rows count from 0 at the top left",
            ));
        }
        // Both are below MAX_SIDE, hence in the range of i16.
        Ok(Cell::new(column as i16, flip_row(row, height) as i16))
    };
    let optimal_length = finite(path, line, "optimal length", length)?;
    if optimal_length < 0.0 {
        return Err(format_error(
            path,
            Place::Line(line),
            format!("optimal length is {length}"),
            "a length is not negative",
        ));
    }
    Ok(Query {
        line,
        bucket: integer(path, line, "bucket", bucket)?,
        map: map.to_owned(),
        width,
        height,
        start: cell("start", start_x, start_y)?,
        goal: cell("goal", goal_x, goal_y)?,
        optimal_length,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const MAP: &str = "type octile\nheight 3\nwidth 4\nmap\n.G@T\nSSOW\n....\n";

    fn map(text: &str) -> Result<Terrain, TerrainError> {
        parse_map(text.as_bytes(), Path::new("a.map"), SWAMP)
    }

    fn message<T: std::fmt::Debug>(result: Result<T, TerrainError>) -> String {
        result.unwrap_err().to_string()
    }

    #[test]
    fn the_last_file_row_is_the_southernmost() {
        let terrain = map(MAP).unwrap();
        assert_eq!((terrain.width(), terrain.height()), (4, 3));
        assert_eq!(terrain.cells(), [1, 1, 1, 1, 3, 3, BLOCKED, BLOCKED, 1, 1, BLOCKED, BLOCKED]);
        assert_eq!(terrain.get(Cell::new(2, 2)), BLOCKED);
    }

    #[test]
    fn emitters_and_service_points_of_robot_runners_are_ground() {
        let runners = MAP.replace('G', "E");
        let terrain = map(&runners).unwrap();
        assert_eq!(terrain.cells(), [1, 1, 1, 1, 1, 1, BLOCKED, BLOCKED, 1, 1, BLOCKED, BLOCKED]);
        let message = message(map(&MAP.replace('G', "e")));
        assert!(message.starts_with("a.map:5: 'e' in column 2; cells are . G S E (passable)"), "{message}");
    }

    #[test]
    fn windows_line_ends_and_a_missing_last_one_are_accepted() {
        let expected = map(MAP).unwrap();
        assert_eq!(map(&MAP.replace('\n', "\r\n")).unwrap(), expected);
        assert_eq!(map(MAP.trim_end()).unwrap(), expected);
        assert_eq!(map(&format!("{MAP}\n\n")).unwrap(), expected);
    }

    #[test]
    fn errors_name_file_line_and_remedy() {
        let cases = [
            (MAP.replace("height 3", "height 4"), "a.map:7: the file ends after 3 of 4 rows; it is truncated"),
            (MAP.replace("height 3", "height 2"), "a.map:7: a row after the 2"),
            (MAP.replace("SSOW", "SSO"), "a.map:6: a row of 3 cells; each row must have the 4"),
            (MAP.replace("SSOW", "SSXW"), "a.map:6: 'X' in column 3; cells are"),
            (MAP.replace("width 4", "width 0"), "a.map:3: width is \"0\"; give a whole number from 1 to 32767"),
            (MAP.replace("width 4", "width 32768"), "a.map:3: width"),
            (MAP.replace("width 4\n", ""), "a.map:3: the header has no width"),
            (MAP.replace("octile", "hex"), "a.map:1: \"type hex\" in the header"),
            (String::new(), "a.map:1: the header has no width"),
        ];
        for (text, expected) in cases {
            let message = message(map(&text));
            assert!(message.starts_with(expected), "{message}");
        }
        let bytes = b"type octile\nheight 1\n\xFF";
        let message = message(parse_map(bytes, Path::new("a.map"), SWAMP));
        assert!(message.starts_with("a.map:3: bytes that are not text"), "{message}");
    }

    #[test]
    fn queries_are_converted_to_south_first_rows() {
        let text = "version 1\n3\tdir/my map.map\t4\t3\t0\t0\t3\t2\t3.41421\n\n0 a.map 4 3 1 1 1 1 0\n";
        let queries = parse_scen(text.as_bytes(), Path::new("a.scen")).unwrap();
        assert_eq!(queries.len(), 2);
        assert_eq!(queries[0].map, "dir/my map.map");
        assert_eq!(queries[0].start, Cell::new(0, 2));
        assert_eq!(queries[0].goal, Cell::new(3, 0));
        assert_eq!(queries[0].optimal_length, 3.41421);
        assert_eq!(queries[1].start, Cell::new(1, 1));
        assert_eq!(queries.iter().map(|query| query.line).collect::<Vec<_>>(), [2, 4]);
        assert_eq!(queries[0].in_file(queries[0].goal), [3, 2]);
        assert_eq!([queries[0].map_name(), queries[1].map_name()], ["my map.map", "a.map"]);
    }

    #[test]
    fn invalid_queries_are_named() {
        let cases = [
            ("version 2\n", "a.scen:1: the first line is \"version 2\"; a Moving AI scenario begins with"),
            ("version 1\n0 m 4 3 4 0 0 0 1", "a.scen:2: the start (4, 0) lies outside the map of 4 x 3"),
            ("version 1\n0 m 4 3 0 0 0 3 1", "a.scen:2: the goal (0, 3) lies outside"),
            ("version 1\n0 m 4 3 0 0 0 -1 1", "a.scen:2: goal y is \"-1\"; give a whole number"),
            ("version 1\n0 m 4 3 0 0 0 1 NaN", "a.scen:2: optimal length is \"NaN\"; give a finite number"),
            ("version 1\n0 m 4 3 0 0 0 1 -1", "a.scen:2: optimal length is -1"),
            ("version 1\n0 m 4 3 0 0 0 1", "a.scen:2: 8 fields; a query has nine"),
            ("version 1\n\n0 m 4 99999 0 0 0 1 1", "a.scen:3: map height is \"99999\""),
        ];
        for (text, expected) in cases {
            let message = message(parse_scen(text.as_bytes(), Path::new("a.scen")));
            assert!(message.starts_with(expected), "{message}");
        }
    }

    proptest! {
        #[test]
        fn any_bytes_are_a_map_or_an_error(bytes: Vec<u8>) {
            let _ = parse_map(&bytes, Path::new("a.map"), SWAMP);
            let _ = parse_scen(&bytes, Path::new("a.scen"));
        }

        #[test]
        fn any_body_is_a_map_or_an_error(
            height in 0..5_u32,
            width in 0..5_u32,
            body in "[.@GSTW\r\n]{0,30}",
        ) {
            let text = format!("type octile\nheight {height}\nwidth {width}\nmap\n{body}");
            if let Ok(terrain) = map(&text) {
                prop_assert_eq!(terrain.cells().len() as u32, width * height);
            }
        }

        #[test]
        fn any_query_is_read_or_an_error(row in "[0-9.\t -]{0,40}") {
            let text = format!("version 1\n{row}");
            let _ = parse_scen(text.as_bytes(), Path::new("a.scen"));
        }
    }
}
