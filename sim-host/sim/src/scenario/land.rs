//! `[[terrain.change]]`: terrain that changes during a run.

use super::intervention::tick;
use super::ranges::within;
use super::schema::ChangeTable;
use super::source::Source;
use super::{ScenarioError, ScenarioFile};
use crate::terrain::Terrain;
use crate::terrain::change::{ChangeKind, LandChange};
use staya_controller::grid::Cell;
use std::num::NonZeroU32;

const LONGEST_S: f64 = 4000.0 * 3600.0;

struct Entry<'a> {
    source: &'a Source<'a>,
    index: usize,
    table: &'a ChangeTable,
}

impl Entry<'_> {
    fn field(&self, name: &str) -> String {
        format!("terrain.change[{}].{name}", self.index)
    }

    fn error(&self, name: &str, what: impl Into<String>, remedy: &str) -> ScenarioError {
        self.source.error(&self.field(name), what, remedy)
    }

    fn ticks(&self, name: &str, seconds: Option<f64>, tick_s: f64) -> Result<Option<NonZeroU32>, ScenarioError> {
        let Some(seconds) = seconds else {
            return Ok(None);
        };
        within(self.source, &self.field(name), seconds, tick_s, LONGEST_S, "seconds (a tick at least)")?;
        Ok(NonZeroU32::new(tick(seconds, tick_s)))
    }

    fn cells(&self, land: &Terrain) -> Result<Option<Vec<Cell>>, ScenarioError> {
        let all = || (0..land.height()).flat_map(|y| (0..land.width()).map(move |x| Cell::new(x as i16, y as i16)));
        match (&self.table.cells, self.table.rectangle, &self.table.polygon_m) {
            (None, None, None) => Ok(None),
            (Some(cells), None, None) => {
                let cells: Vec<Cell> = cells.iter().map(|&[x, y]| Cell::new(x, y)).collect();
                if let Some(at) = cells.iter().position(|cell| land.index(*cell).is_none()) {
                    let what = format!("({}, {}) is outside the map", cells[at].x, cells[at].y);
                    let remedy = format!("give a cell of the map of {} x {} cells", land.width(), land.height());
                    return Err(self.error(&format!("cells[{at}]"), what, &remedy));
                }
                Ok(Some(cells))
            }
            (None, Some(part), None) => {
                let piece = land.crop(part.x, part.y, part.width, part.height);
                piece.map_err(|error| self.error("rectangle", error.to_string(), "give a part of the map"))?;
                let rows = part.y..part.y + part.height;
                let row = |y| (part.x..part.x + part.width).map(move |x| Cell::new(x as i16, y as i16));
                Ok(Some(rows.flat_map(row).collect()))
            }
            (None, None, Some(corners)) => {
                if corners.len() < 3 || corners.as_flattened().iter().any(|x| !x.is_finite()) {
                    return Err(self.error(
                        "polygon_m",
                        "this is not a polygon",
                        "give three corners or more, in metres",
                    ));
                }
                let cells: Vec<Cell> = all().filter(|cell| contains(corners, land.center_m(*cell))).collect();
                if cells.is_empty() {
                    return Err(self.error(
                        "polygon_m",
                        "no cell has its middle in it",
                        "give a larger one, on the map",
                    ));
                }
                Ok(Some(cells))
            }
            _ => Err(self.error("cells", "it is not clear which cells", "give one of cells, rectangle, polygon_m")),
        }
    }

    fn change(&self, file: &ScenarioFile, land: &Terrain) -> Result<LandChange, ScenarioError> {
        let table = self.table;
        let every = self.ticks("every_s", table.every_s, file.tick_s)?;
        let lasts = self.ticks("for_s", table.for_s, file.tick_s)?;
        if let (Some(every), Some(lasts)) = (every, lasts)
            && lasts >= every
        {
            return Err(self.error("for_s", "it begins again before it is over", "give less than every_s"));
        }
        let cells = self.cells(land)?;
        let kind = match (table.class, table.drift) {
            (Some(class), None) => {
                let Some(cells) = cells else {
                    return Err(self.error(
                        "class",
                        "it is not said of which cells",
                        "give cells, rectangle or polygon_m",
                    ));
                };
                if every.is_some() && lasts.is_none() {
                    return Err(self.error("every_s", "a change without an end cannot repeat", "give for_s, too"));
                }
                let cells = cells.into_iter().map(|cell| (cell, land.get(cell))).collect();
                ChangeKind::Become { cells, class, lasts }
            }
            (None, Some(drift)) => {
                if lasts.is_some() {
                    return Err(self.error("for_s", "a drift is never over", "leave it out"));
                }
                if drift.step == 0 || drift.classes == Some(0) {
                    let name = if drift.step == 0 { "drift.step" } else { "drift.classes" };
                    return Err(self.error(name, "0 ticks change nothing", "give 1 to 255"));
                }
                let slowest = land.cells().iter().copied().max().unwrap_or(1);
                let count = cells.as_ref().map_or(land.cells().len(), Vec::len);
                let draws = libm::round(drift.share * count as f64).max(1.0) as u32;
                let classes = drift.classes.unwrap_or(slowest);
                ChangeKind::Drift { cells, draws, step: drift.step, classes }
            }
            _ => return Err(self.error("class", "it is not clear what becomes of them", "give one of class, drift")),
        };
        Ok(LandChange { first: tick(table.at_s, file.tick_s), every, kind })
    }
}

pub(super) fn changes(
    source: &Source<'_>,
    file: &ScenarioFile,
    land: &Terrain,
) -> Result<Vec<LandChange>, ScenarioError> {
    let tables = file.terrain.iter().flat_map(|terrain| &terrain.change);
    tables.enumerate().map(|(index, table)| Entry { source, index, table }.change(file, land)).collect()
}

/// Even-odd test: a ray to the east crosses an odd number of the polygon's sides.
fn contains(corners: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let before = corners.iter().cycle().skip(corners.len() - 1);
    let sides = before.zip(corners).filter(|([_, from], [_, to])| (*from > y) != (*to > y));
    let crossed = sides.filter(|([x0, y0], [x1, y1])| x < x0 + (x1 - x0) * (y - y0) / (y1 - y0));
    crossed.count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Overrides, Scenario};
    use std::path::Path;

    fn parse(change: &str) -> Result<Scenario, String> {
        let text = format!(
            "name = \"t\"\nticks = 9\ntick_s = 0.5\n[terrain]\ncell_m = 2\nuniform = {{ width = 8, height = 6, classes = 4 }}\n\
             [[terrain.change]]\n{change}\n[robots]\nlist = [{{ start = [0, 0], goal = [7, 5] }}]\n"
        );
        Scenario::parse(&text, Path::new("t.toml"), &Overrides::default()).map_err(|error| error.to_string())
    }

    fn cells(change: &str) -> Vec<(i16, i16)> {
        match &parse(change).expect("good").changes[0].kind {
            ChangeKind::Become { cells, .. } => cells.iter().map(|(cell, _)| (cell.x, cell.y)).collect(),
            ChangeKind::Drift { cells, .. } => cells.iter().flatten().map(|cell| (cell.x, cell.y)).collect(),
        }
    }

    #[test]
    fn cells_are_given_by_list_rectangle_or_polygon() {
        assert_eq!(cells("class = 0\ncells = [[3, 4], [7, 5]]"), [(3, 4), (7, 5)]);
        let rectangle = "class = 0\nrectangle = { x = 6, y = 1, width = 2, height = 2 }";
        assert_eq!(cells(rectangle), [(6, 1), (7, 1), (6, 2), (7, 2)]);
        assert_eq!(cells("class = 0\npolygon_m = [[0, 0], [6, 0], [0, 6]]"), [(0, 0), (1, 0), (0, 1)]);
        assert_eq!(cells("class = 0\npolygon_m = [[0, 0], [0, 6.1], [6.1, 0]]").len(), 6);
    }

    #[test]
    fn times_are_converted_to_ticks() {
        let gate = parse("at_s = 2\nevery_s = 3\nfor_s = 1.2\nclass = 0\ncells = [[3, 4]]").expect("good");
        let LandChange { first, every, kind: ChangeKind::Become { lasts, .. } } = &gate.changes[0] else {
            panic!("it is a gate");
        };
        assert_eq!((*first, every.map(NonZeroU32::get), lasts.map(NonZeroU32::get)), (4, Some(6), Some(3)));
    }

    #[test]
    fn a_drift_draws_its_share_of_cells_and_at_least_one() {
        for (share, expected) in [(0.5, 24), (0.0, 1), (1.0, 48)] {
            let scenario = parse(&format!("every_s = 1\ndrift = {{ share = {share} }}")).expect("good");
            let ChangeKind::Drift { cells: None, draws, step: 1, classes } = scenario.changes[0].kind else {
                panic!("it is a drift of all cells");
            };
            assert_eq!((draws, classes), (expected, 4));
        }
    }

    #[test]
    fn invalid_changes_are_refused_with_place_and_remedy() {
        for (change, field, remedy) in [
            ("class = 0", "class", "give cells"),
            ("cells = [[1, 1]]", "class", "one of class, drift"),
            ("class = 0\ndrift = { share = 0.5 }\ncells = [[1, 1]]", "class", "one of class, drift"),
            ("class = 0\ncells = [[1, 1], [8, 1]]", "cells[1]", "map of 8 x 6"),
            ("class = 0\ncells = [[1, -1]]", "cells[0]", "map of 8 x 6"),
            ("class = 0\nrectangle = { x = 7, y = 0, width = 2, height = 1 }", "rectangle", "part of the map"),
            ("class = 0\npolygon_m = [[0, 0], [1, 1]]", "polygon_m", "three corners"),
            ("class = 0\npolygon_m = [[0, 0], [0.5, 0], [0, 0.5]]", "polygon_m", "larger"),
            ("class = 0\ncells = [[1, 1]]\npolygon_m = [[0, 0], [5, 0], [0, 5]]", "cells", "one of cells, rectangle"),
            ("class = 0\ncells = [[1, 1]]\nevery_s = 4", "every_s", "for_s"),
            ("class = 0\ncells = [[1, 1]]\nevery_s = 4\nfor_s = 4", "for_s", "less than every_s"),
            ("class = 0\ncells = [[1, 1]]\nat_s = -1", "at_s", "seconds"),
            ("class = 0\ncells = [[1, 1]]\nfor_s = 0.1", "for_s", "a tick at least"),
            ("drift = { share = 1.5 }", "drift.share", "share"),
            ("drift = { share = 0.5, step = 0 }", "drift.step", "1 to 255"),
            ("drift = { share = 0.5, classes = 0 }", "drift.classes", "1 to 255"),
            ("drift = { share = 0.5 }\nfor_s = 1", "for_s", "leave it out"),
        ] {
            let message = parse(change).unwrap_err();
            assert!(message.contains(&format!("terrain.change[0].{field}: ")), "{change}: {message}");
            assert!(message.contains(remedy), "{change}: {message}");
        }
    }
}
