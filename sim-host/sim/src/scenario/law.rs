//! `[law]`: a law that the program adds, instead of those of Staya.

use super::read::{Limits, nearest};
use super::source::Checked;
use super::{Draft, PlaneSetup};
use crate::own_law::{NEGOTIATION, Own, named};
use crate::table;
use crate::terrain::Terrain;
use serde::Serialize;
use staya_controller::agent::{AnySurroundings, CellState, InCell, InCells, InPlane, Law, OnGrid};
use staya_controller::geom::Vec2;
use staya_controller::negotiation::Moves;
use std::collections::BTreeMap;

/// Largest radius of robots that negotiate, cells: two that follow each other around a corner pass
/// at 0.7 cells.
const WIDEST: f64 = 0.35;

table! {
    /// `[law]`: all robots have a law that the program adds with
    /// [`add_law`](crate::engine::add_law). The guidance still decides which goals the file gives.
    pub struct LawTable {
        /// The name that the program gives to the law.
        pub name: String;
        /// Parameters of the law by their names. Default: those of the law.
        pub parameters: BTreeMap<String, f64> = Default::default();
    }
}

/// A law that the program adds, with its parameters.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NamedLaw {
    /// Its name.
    pub name: String,
    /// Values by the names of its parameters.
    pub parameters: Vec<(String, f32)>,
    /// The moves of the bodies, for a law that needs them.
    pub moves: Moves,
    /// The cruising speed of bodies in the plane, m/s.
    pub cruise_mps: Option<f32>,
}

impl NamedLaw {
    /// Creates the law of one robot.
    ///
    /// # Panics
    /// If the program does not add it; [`Scenario::load`](super::Scenario::load) refuses that.
    #[must_use]
    pub fn law(&self) -> Own {
        let mut law = named(&self.name, self.moves, self.cruise_mps)
            .unwrap_or_else(|_| panic!("no law {} in this program", self.name));
        for (name, value) in &self.parameters {
            Law::<f32>::parameters(&mut law, &mut |table| {
                if let Some(index) = table.index(name) {
                    let _ = table.set(index, *value);
                }
            });
        }
        law
    }
}

pub(super) fn law(
    draft: &Draft<'_>,
    plane: Option<&PlaneSetup>,
    terrain: Option<&Terrain>,
) -> Checked<Option<NamedLaw>> {
    let Some(table) = &draft.file.law else { return Ok(None) };
    let grid = &draft.file.grid;
    let moves = Moves { diagonals: grid.moves == 8, circles: grid.simultaneous };
    let cruise_mps = plane.map(|setup| setup.general.cruise_mps as f32);
    let mut law = named(&table.name, moves, cruise_mps).map_err(|known| {
        let remedy = suggestion(&table.name, &known, "build a program that adds it, see docs/project.md");
        draft.error("law.name", format!("this program has no law \"{}\"", table.name), remedy)
    })?;
    let grid = OnGrid { cell: CellState::default(), window: None };
    let in_plane = InPlane { max_speed_mps: 0.0, obstacles: &[] };
    let (here, place) = match (plane.is_some(), terrain.is_some()) {
        (false, _) => (AnySurroundings::OnGrid(grid), "the robots go from cell to cell, and the law does not"),
        (true, false) => (AnySurroundings::InPlane(in_plane), "the robots have no cells, and the law needs them"),
        (true, true) => {
            let in_cell = InCell { offset_m: Vec2::ZERO, cell_m: 1.0 };
            let here = AnySurroundings::InCells(InCells { grid, plane: in_plane, in_cell });
            (here, "the robots go by velocities, and the law does not")
        }
    };
    let remedy = if plane.is_some() { "give [terrain], or another law" } else { "give [plane], or another law" };
    draft.require(law.fits(&here), "law.name", place, remedy)?;
    if let (NEGOTIATION, Some(setup), Some(land)) = (&table.name[..], plane, terrain) {
        let are_in_cells = setup.kinds().all(|group| group.guidance.kind().is_on_grid());
        let what = "robots that negotiate have goals in cells";
        draft.require(are_in_cells, "plane.guidance", what, "give guidance = \"route\"")?;
        let widest_m = land.cell_m * WIDEST;
        let radius_m = setup.kinds().map(|group| group.radius_m).fold(0.0, f64::max);
        let what = format!("{radius_m} m are more than {WIDEST} cells: robots touch at a corner");
        let remedy = format!("give at most {widest_m}, or a larger terrain.cell_m");
        draft.require(radius_m <= widest_m, "plane.radius_m", what, remedy)?;
    }
    let mut parameters = Vec::new();
    for (name, &value) in &table.parameters {
        let field = format!("law.parameters.{name}");
        let (mut limits, mut known) = (None, Vec::new());
        Law::<f32>::parameters(&mut law, &mut |table| {
            known.extend(table.table().iter().map(|row| row.name));
            limits = limits.take().or_else(|| table.index(name).map(|index| Limits::of(&table.table()[index])));
        });
        let limits = limits.ok_or_else(|| {
            draft.error(&field, "the law has no such parameter", suggestion(name, &known, "leave it out: it has none"))
        })?;
        draft.limit(&field, value, &limits)?;
        parameters.push((name.clone(), value as f32));
    }
    Ok(Some(NamedLaw { name: table.name.clone(), parameters, moves, cruise_mps }))
}

/// The remedy for an unknown name.
fn suggestion(name: &str, known: &[&str], if_empty: &str) -> String {
    match nearest(name, known.iter().copied()) {
        Some(near) => format!("did you mean \"{near}\"?"),
        None if known.is_empty() => if_empty.to_owned(),
        None => format!("it has {}", known.join(", ")),
    }
}
