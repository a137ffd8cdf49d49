//! `[[terrain.change]]`: terrain that changes during a run.

use super::source::{Checked, Section};
use super::{Area, ChangeSource, ChangeTable, Draft};
use crate::terrain::Terrain;
use crate::terrain::change::{ChangeKind, LandChange};
use crate::world::plane::contains;
use staya_controller::grid::Cell;
use std::num::NonZeroU32;

const LONGEST_S: f64 = 4000.0 * 3600.0;

pub(super) fn changes(draft: &Draft<'_>, land: &Terrain) -> Checked<Vec<LandChange>> {
    let tables = draft.file.terrain.iter().flat_map(|terrain| &terrain.change);
    tables.enumerate().map(|(index, table)| change(draft, index, table, land)).collect()
}

fn change(draft: &Draft<'_>, index: usize, table: &ChangeTable, land: &Terrain) -> Checked<LandChange> {
    let at = draft.at(format!("terrain.change[{index}]"));
    let ticks = |name: &str, seconds: Option<f64>| {
        let Some(seconds) = seconds else { return Ok(None) };
        at.within(name, seconds, draft.file.tick_s..=LONGEST_S, "seconds (a tick at least)")?;
        Ok(NonZeroU32::new(draft.tick(seconds)))
    };
    let (every, lasts) = (ticks("every_s", table.every_s)?, ticks("for_s", table.for_s)?);
    let is_over = every.zip(lasts).is_none_or(|(every, lasts)| lasts < every);
    at.require(is_over, "for_s", "it begins again before it is over", "give less than every_s")?;
    let cells = table.area.as_ref().map(|area| cells(&at, area, land)).transpose()?;
    let kind = match &table.becomes {
        ChangeSource::Class(class) => {
            let Some(cells) = cells else {
                return Err(at.error("class", "it is not said of which cells", "give cells, rectangle or polygon_m"));
            };
            let ends = every.is_none() || lasts.is_some();
            at.require(ends, "every_s", "a change without an end cannot repeat", "give for_s, too")?;
            let cells = cells.into_iter().map(|cell| (cell, land.get(cell))).collect();
            ChangeKind::Become { cells, class: *class, lasts }
        }
        ChangeSource::Drift(drift) => {
            at.require(lasts.is_none(), "for_s", "a drift is never over", "leave it out")?;
            let slowest = land.cells().iter().copied().max().unwrap_or(1);
            let count = cells.as_ref().map_or(land.cells().len(), Vec::len);
            let draws = libm::round(drift.share * count as f64).max(1.0) as u32;
            ChangeKind::Drift { cells, draws, step: drift.step, classes: drift.classes.unwrap_or(slowest) }
        }
    };
    Ok(LandChange { first: draft.tick(table.at_s), every, kind })
}

fn cells(at: &Section<'_>, area: &Area, land: &Terrain) -> Checked<Vec<Cell>> {
    let of = |columns: std::ops::Range<u16>, rows: std::ops::Range<u16>| {
        rows.flat_map(move |y| columns.clone().map(move |x| Cell::new(x as i16, y as i16)))
    };
    match area {
        Area::Cells(cells) => {
            let cells: Vec<Cell> = cells.iter().map(|&[x, y]| Cell::new(x, y)).collect();
            if let Some(index) = cells.iter().position(|cell| land.index(*cell).is_none()) {
                let what = format!("({}, {}) is outside the map", cells[index].x, cells[index].y);
                let remedy = format!("give a cell of the map of {} x {} cells", land.width(), land.height());
                return Err(at.error(&format!("cells[{index}]"), what, remedy));
            }
            Ok(cells)
        }
        Area::Rectangle(part) => {
            let piece = land.crop(part.x, part.y, part.width, part.height);
            piece.map_err(|error| at.error("rectangle", error.to_string(), "give a part of the map"))?;
            Ok(of(part.x..part.x + part.width, part.y..part.y + part.height).collect())
        }
        Area::Polygon(corners) => {
            let is_polygon = corners.len() >= 3 && corners.as_flattened().iter().all(|x| x.is_finite());
            let remedy = "give three corners or more, in metres";
            at.require(is_polygon, "polygon_m", "this is not a polygon", remedy)?;
            let all = of(0..land.width(), 0..land.height());
            let cells: Vec<Cell> = all.filter(|cell| contains(corners, land.center_m(*cell))).collect();
            let (what, remedy) = ("no cell has its middle in it", "give a larger one, on the map");
            at.require(!cells.is_empty(), "polygon_m", what, remedy)?;
            Ok(cells)
        }
    }
}

#[cfg(test)]
mod tests;
