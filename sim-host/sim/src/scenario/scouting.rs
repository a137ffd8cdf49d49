//! `[scouting]`: the terrain that robots know before they see it.

use super::law::LawSetup;
use super::source::Checked;
use super::{Draft, Scenario, check, maps};
use crate::terrain::Terrain;
use crate::terrain::scouted::{Scouted, usual_class};
use crate::world::scouts::Scouting;
use staya_controller::grid::Norm;
use std::sync::Arc;

/// A map that robots carry as tables of costs to go to their goals.
#[derive(Clone, Debug)]
pub struct KnownLand {
    /// The map, of the terrain's size.
    pub map: Arc<Terrain>,
    /// Most bytes of a table.
    pub bytes: usize,
    /// Length of diagonal moves, and whether they may pass a blocked corner.
    pub moves: (Norm, bool),
}

/// Most cells of all tables together: a quarter of an hour on one processor.
const MOST_WORK: u64 = 1_000_000_000;

/// The map that robots keep as it is, or as tables.
type Known = (Option<Scouting>, Option<KnownLand>);

/// Checks the table; `land` is `None` for robots that move without terrain.
pub(super) fn scouting(
    draft: &Draft<'_>,
    law: &LawSetup,
    all: &[&LawSetup],
    robots: usize,
    land: Option<&Terrain>,
) -> Checked<Known> {
    let Some(table) = &draft.file.scouting else { return Ok((None, None)) };
    let land = land.filter(|_| law.is_on_grid());
    let (Some(land), Some(terrain)) = (land, &draft.file.terrain) else {
        let (what, remedy) = ("these robots plan on no land", "leave this table out, or give law = \"route\"");
        return Err(draft.error("scouting", what, remedy));
    };
    let what = format!("unknown {} and wrong {} add up to more than 1", table.unknown, table.wrong);
    let is_share = table.unknown + table.wrong <= 1.0;
    draft.require(is_share, "scouting.wrong", what, "give shares with a sum of at most 1")?;
    let old = table.map.as_ref().map(|name| check::map(draft, terrain, name)).transpose()?;
    let old = old.as_ref().unwrap_or(land);
    let size = |map: &Terrain| [map.width(), map.height()];
    let ([x, y], [width, height]) = (size(old), size(land));
    let what = format!("it has {x} x {y} cells, the land has {width} x {height} cells");
    draft.require(size(old) == size(land), "scouting.map", what, "give a map of the same land")?;
    let scouted = Scouted {
        unknown: table.unknown,
        wrong: table.wrong,
        patch_cells: table.patch_cells.unwrap_or(1),
        assumed: table.assumed.unwrap_or_else(|| usual_class(old)),
        seed: table.seed.unwrap_or(draft.file.seed),
    };
    let (map, grid) = (Arc::new(scouted.map(old)), &draft.file.grid);
    let Some(bytes) = table.model_bytes else { return Ok((Some(Scouting { map, sight: grid.radius }), None)) };
    let field = "scouting.model_bytes";
    maps::plans_far(draft, all, field)?;
    let what = format!("tables for {robots} robots, each from {width} x {height} cells, take hours to make");
    let is_wide = width.min(height) > 1;
    draft.require(is_wide, field, "the land is one cell wide", "give wider land, or leave it out")?;
    let work = robots as u64 * u64::from(width) * u64::from(height);
    draft.require(work <= MOST_WORK, field, what, "give fewer robots or less land: in all 1,000,000,000 cells")?;
    Ok((None, Some(KnownLand { map, bytes: bytes as usize, moves: (grid.norm, grid.corner_cutting) })))
}

/// Robots without a table, as the map shows no way to their goals.
pub(super) fn remark(scenario: &Scenario) -> Option<String> {
    let known = scenario.land.known.as_ref()?;
    let blocked = scenario.robots.iter().filter(|robot| !known.map.is_passable(robot.goal));
    let ids: Vec<String> = blocked.map(|robot| robot.id.0.to_string()).collect();
    let first = ids.iter().take(5).cloned().collect::<Vec<_>>().join(", ");
    let rest = if ids.len() > 5 { ", ..." } else { "" };
    (!ids.is_empty()).then(|| {
        format!(
            "scouting.model_bytes: {} robots plan without a table (robot {first}{rest}), as their goals are blocked on the map",
            ids.len()
        )
    })
}

#[cfg(test)]
mod tests;
