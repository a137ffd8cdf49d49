//! `[grid]`: rules of cells, and the law of robots that move from cell to cell.

use super::Draft;
use super::law::{LawPart, LawSetup};
use super::source::Checked;
use crate::own_law::Site;
use crate::{defaults, names, table};
use staya_controller::agent::{Around, FormationSettings, RouteSettings, Settings as _};
use staya_controller::grid::Norm;
use staya_controller::negotiation::Moves;
use staya_controller::route::{ExitRule, Replan, SIGHT};

table! {
    /// `[grid]`: rules of cells. With `[plane]`, `law` and its table are in that one.
    pub struct GridTable {
        part law: LawPart<true>;
        /// Sight of a robot in each direction, cells.
        pub radius: u8 = 5, SIGHT;
        /// `"euclidean"` (a diagonal move is sqrt 2 long; the default) or `"chebyshev"` (1).
        pub norm: Norm = Default::default();
        /// Whether a diagonal move may pass a blocked orthogonal neighbour. Default: false.
        pub corner_cutting: bool = false;
        /// Number of neighbours of a cell to which robots move, 4 or 8. Default: 8.
        pub moves: u8 = 8;
        /// Whether all robots move at once, as in POGEMA; for 4 neighbours. Default: false.
        pub simultaneous: bool = false;
    }
}

names!(Norm, ExitRule, Replan);
defaults!(GridTable);

const MAX_RADIUS: u8 = SIGHT.range[1] as u8;

/// Sight of the robots in each direction, cells: that of a map which they know before they see it.
pub(super) fn radius(draft: &Draft<'_>) -> Checked<u8> {
    let sight = draft.file.grid.radius;
    let Some(scouting) = &draft.file.scouting else { return Ok(sight) };
    if scouting.model_bytes.is_some() {
        let (what, remedy) = ("robots with a model plan in their sight", "leave one of radius and model_bytes out");
        draft.require(scouting.radius.is_none(), "scouting.radius", what, remedy)?;
        return Ok(sight);
    }
    let wide = scouting.radius.unwrap_or(MAX_RADIUS);
    draft.within("scouting.radius", wide.into(), sight.into()..=MAX_RADIUS.into(), "cells")?;
    Ok(wide)
}

/// Moves of bodies from cell to cell.
pub(super) const fn moves(grid: &GridTable) -> Moves {
    Moves { diagonals: grid.moves == 8, circles: grid.simultaneous }
}

/// Properties on which the laws of bodies with this cruising speed depend; `None`: they move from
/// cell to cell.
pub(super) fn around(draft: &Draft<'_>, cruise_mps: Option<f64>, tolerance_m: f64) -> Checked<Around> {
    let (delay_s, rate_hz) = draft.file.radio.news(draft.step_s());
    Ok(Around {
        radius_m: 0.0,
        max_speed_mps: 0.0,
        fastest_mps: 0.0,
        brake_s: 0.0,
        has_goal: true,
        cruise_mps: cruise_mps.map(|speed| speed as f32),
        tolerance_m: tolerance_m as f32,
        delay_s: delay_s as f32,
        rate_hz: rate_hz as f32,
        seed: draft.file.seed,
        radius: radius(draft)?,
        norm: draft.file.grid.norm,
        corner_cutting: draft.file.grid.corner_cutting,
    })
}

/// Routes of robots whose law does not say otherwise.
pub(super) fn usual_route(draft: &Draft<'_>) -> Checked<RouteSettings> {
    let mut route = RouteSettings::default();
    let _ = route.adapt(&|_| false, &around(draft, None, 0.0)?);
    Ok(route)
}

/// The law of robots that move from cell to cell.
pub(super) fn law(draft: &Draft<'_>) -> Checked<LawSetup> {
    let (grid, in_formation) = (&draft.file.grid, draft.file.cells_in_formation());
    let usual = if in_formation { FormationSettings::NAME } else { RouteSettings::NAME };
    let at = draft.at("grid");
    let (is_free, what) =
        (draft.file.plane.is_none() || grid.law.is_empty(), "bodies in the plane have their own laws");
    draft.require(is_free, "grid", what, "give `law` and its table in [plane]")?;
    let kind = LawSetup::by_name(grid.law.name_or(usual), moves(grid), None);
    if let Some(law) = kind.filter(|law| !law.fits(Site::Cells)) {
        let what = format!("the law \"{}\" goes by velocities, and these robots from cell to cell", law.name());
        return Err(at.error("law", what, "give [plane] with this law, or another law"));
    }
    let law = grid.law.build(&at, usual, moves(grid), &around(draft, None, 0.0)?)?;
    let what = format!("robots.formation and the law \"{}\" do not go together", law.name());
    let remedy = if in_formation { "give law = \"formation\", or leave it out" } else { "give robots.formation" };
    at.require(law.fits_robots(in_formation), "law", what, remedy)?;
    Ok(law)
}
