//! `[[terrain.change]]`: terrain that changes during a run.

use super::intervention::tick;
use super::ranges::within;
use super::schema::ChangeTable;
use super::source::Source;
use super::{ScenarioError, ScenarioFile};
use crate::terrain::Terrain;
use crate::terrain::change::{ChangeKind, LandChange};
use crate::world::plane::contains;
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
                    let remedy = "give three corners or more, in metres";
                    return Err(self.error("polygon_m", "this is not a polygon", remedy));
                }
                let cells: Vec<Cell> = all().filter(|cell| contains(corners, land.center_m(*cell))).collect();
                if cells.is_empty() {
                    let remedy = "give a larger one, on the map";
                    return Err(self.error("polygon_m", "no cell has its middle in it", remedy));
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
                    let remedy = "give cells, rectangle or polygon_m";
                    return Err(self.error("class", "it is not said of which cells", remedy));
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

#[cfg(test)]
mod tests;
