//! `[scouting]`: the terrain that robots know before they see it.

use super::source::Source;
use super::{ScenarioError, ScenarioFile};
use crate::terrain::Terrain;
use crate::terrain::scouted::{Scouted, usual_class};
use crate::world::scouts::Scouting;
use std::sync::Arc;

/// Checks the table. `land` is `None` for robots that move without terrain; `sight` is in cells.
pub(super) fn scouting(
    source: &Source<'_>,
    file: &ScenarioFile,
    land: Option<&Terrain>,
    sight: u8,
) -> Result<Option<Scouting>, ScenarioError> {
    let Some(table) = &file.scouting else {
        return Ok(None);
    };
    let guidance = file.plane.as_ref().map(|plane| plane.body.guidance);
    let Some(land) = land.filter(|_| guidance.is_none_or(|guidance| guidance.is_on_grid())) else {
        let (what, remedy) = ("these robots plan on no land", "leave this table out, or give guidance = \"route\"");
        return Err(source.error("scouting", what, remedy));
    };
    if table.unknown + table.wrong > 1.0 {
        let what = format!("unknown {} and wrong {} add up to more than 1", table.unknown, table.wrong);
        return Err(source.error("scouting.wrong", what, "give shares with a sum of at most 1"));
    }
    let old = match &table.map {
        None => None,
        Some(name) => Some(super::check::map(source, file, name)?),
    };
    let old = old.as_ref().unwrap_or(land);
    if (old.width(), old.height()) != (land.width(), land.height()) {
        let sides = |map: &Terrain| format!("{} x {} cells", map.width(), map.height());
        let what = format!("it has {}, the land has {}", sides(old), sides(land));
        return Err(source.error("scouting.map", what, "give a map of the same land"));
    }
    let scouted = Scouted {
        unknown: table.unknown,
        wrong: table.wrong,
        patch_cells: table.patch_cells.unwrap_or(1),
        assumed: table.assumed.unwrap_or_else(|| usual_class(old)),
        seed: table.seed.unwrap_or(file.seed),
    };
    Ok(Some(Scouting { map: Arc::new(scouted.map(old)), sight }))
}

#[cfg(test)]
mod tests;
