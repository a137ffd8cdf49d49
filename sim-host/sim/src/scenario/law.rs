//! `[law]`: a law that the program adds, instead of those of Staya.

use super::ranges;
use super::read::nearest;
use super::source::{ScenarioError, Source};
use super::{PlaneSetup, ScenarioFile};
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
    source: &Source<'_>,
    file: &ScenarioFile,
    plane: Option<&PlaneSetup>,
    terrain: Option<&Terrain>,
) -> Result<Option<NamedLaw>, ScenarioError> {
    let Some(table) = &file.law else { return Ok(None) };
    let moves = Moves { diagonals: file.grid.moves == 8, circles: file.grid.simultaneous };
    let cruise_mps = plane.map(|setup| setup.general.cruise_mps as f32);
    let mut law = named(&table.name, moves, cruise_mps).map_err(|known| {
        let what = format!("this program has no law \"{}\"", table.name);
        let remedy = match nearest(&table.name, known.iter().copied()) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None if known.is_empty() => "build a program that adds it, see docs/project.md".to_owned(),
            None => format!("it has {}", known.join(", ")),
        };
        source.error("law.name", what, remedy)
    })?;
    let grid = OnGrid { cell: CellState::default(), window: None };
    let in_plane = InPlane { max_speed_mps: 0.0, obstacles: &[] };
    let (here, place) = match (plane.is_some(), file.terrain.is_some()) {
        (false, _) => (AnySurroundings::OnGrid(grid), "the robots go from cell to cell, and the law does not"),
        (true, false) => (AnySurroundings::InPlane(in_plane), "the robots have no cells, and the law needs them"),
        (true, true) => {
            let in_cell = InCell { offset_m: Vec2::ZERO, cell_m: 1.0 };
            let here = AnySurroundings::InCells(InCells { grid, plane: in_plane, in_cell });
            (here, "the robots go by velocities, and the law does not")
        }
    };
    if !law.fits(&here) {
        let remedy = if plane.is_some() { "give [terrain], or another law" } else { "give [plane], or another law" };
        return Err(source.error("law.name", place, remedy));
    }
    if let (true, Some(setup), Some(land)) = (table.name == NEGOTIATION, plane, terrain) {
        if !setup.kinds().all(|group| group.guidance.kind().is_on_grid()) {
            let what = "robots that negotiate have goals in cells";
            return Err(source.error("plane.guidance", what, "give guidance = \"route\""));
        }
        let widest_m = land.cell_m * WIDEST;
        if let Some(group) = setup.kinds().find(|group| group.radius_m > widest_m) {
            let what = format!("{} m are more than {WIDEST} cells: robots touch at a corner", group.radius_m);
            let remedy = format!("give at most {widest_m}, or a larger terrain.cell_m");
            return Err(source.error("plane.radius_m", what, remedy));
        }
    }
    let mut parameters = Vec::new();
    for (name, &value) in &table.parameters {
        let field = format!("law.parameters.{name}");
        let (mut result, mut known) = (None, Vec::new());
        Law::<f32>::parameters(&mut law, &mut |tables| {
            known.extend(tables.table().iter().map(|row| row.name));
            if result.is_none() && tables.index(name).is_some() {
                result = Some(ranges::set(source, &field, Some(value), tables, name));
            }
        });
        result.unwrap_or_else(|| {
            let remedy = match nearest(name, known.iter().copied()) {
                Some(near) => format!("did you mean \"{near}\"?"),
                None if known.is_empty() => "leave it out: it has none".to_owned(),
                None => format!("it has {}", known.join(", ")),
            };
            Err(source.error(&field, "the law has no such parameter", remedy))
        })?;
        parameters.push((name.clone(), value as f32));
    }
    Ok(Some(NamedLaw { name: table.name.clone(), parameters, moves, cruise_mps }))
}
