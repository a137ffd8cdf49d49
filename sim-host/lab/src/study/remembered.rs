//! A second mission on land that robots have shared: the robots of the scenario cross the land and
//! merge maps over the radio; then one robot crosses it with a table of costs to go of the merged
//! map, and beside it without one, and with one of the whole map.

#[cfg(test)]
mod tests;

use super::{Given, Study};
use crate::error::SweepError;
use crate::measure::{Job, Measured, Watch};
use crate::probe::optimum;
use staya_controller::grid::Cell;
use staya_controller::land::CostToGo;
use staya_controller::land::cost_to_go::Header;
use staya_controller::robot::RobotId;
use staya_sim::engine::{Engine, Outcome, Table, agents_with, simulate};
use staya_sim::remembered::Remembered;
use staya_sim::scenario::{Robot, Scenario};
use staya_sim::table;
use staya_sim::terrain::Terrain;
use staya_sim::terrain::known::{LEAST_BYTES, MOST_BYTES, cost_to_go, nodes};
use staya_sim::terrain::scouted::{Scouted, usual_class};
use std::ops::ControlFlow;
use std::sync::Arc;

/// Most cells of a base station's map along a side.
const SIDE: u16 = 256;

/// The study.
#[derive(Debug)]
pub struct RememberedLand;

table! {
    /// Parameters of a run.
    #[derive(Copy)]
    pub struct Parameters {
        /// Start of the robot of the second mission, cells.
        pub start: [u16; 2] = [1, 1];
        /// Its goal.
        pub goal: [u16; 2] = [98, 98];
        /// Most bytes of its table.
        pub bytes: u32 = 4096;
        /// Share of the patches that have become other land since the first mission.
        pub wrong: f64 = 0.0, 0.0..=1.0, "";
        /// Side of such a patch, cells.
        pub patch_cells: u16 = 1;
    }
}

impl Study for RememberedLand {
    fn name(&self) -> &'static str {
        "remembered"
    }

    fn measures(&self) -> Vec<(String, &'static str)> {
        [
            ("arrived", "robots of the first mission that arrived"),
            ("sharing_percent", "dT of the first mission: mean loss of its robots, which share maps, percent"),
            ("known_percent", "tiles that the merged map knows, percent"),
            ("crossed", "robots of the second mission that arrived, of four alone: the next ones"),
            ("none_percent", "dT of the second mission without a table, percent; empty: it did not arrive"),
            ("board_percent", "the same by a table that a base station makes of the tiles on board"),
            ("file_percent", "the same by a table that the host makes of the map file"),
            ("whole_percent", "the same by a table of all cells at the time of the first mission"),
        ]
        .map(|(name, meaning)| (name.to_owned(), meaning))
        .to_vec()
    }

    fn takes_scenario(&self) -> bool {
        true
    }

    fn read(&self, given: &Given<'_>) -> Result<Job, SweepError> {
        let parameters: Parameters = given.parameters()?;
        let scenario = given.scenario()?;
        let land = &scenario.land.terrain;
        if scenario.laws.maps.is_none() || scenario.plane().is_some() || !scenario.formations.is_empty() {
            let what = "the scenario is not about single robots on the grid that share maps";
            return Err(given.error("bytes", what, "name one with maps.share = true"));
        }
        for (field, [x, y]) in [("start", parameters.start), ("goal", parameters.goal)] {
            if x >= land.width() || y >= land.height() || !land.is_passable(cell([x, y])) {
                let what = format!("{x}, {y} is blocked or off the land");
                return Err(given.error(field, what, "give a free cell"));
            }
        }
        let bytes = parameters.bytes as usize;
        if !(LEAST_BYTES..=MOST_BYTES).contains(&bytes) || land.width().min(land.height()) < 2 {
            let what = format!("{bytes} bytes hold no table of this land");
            return Err(given.error("bytes", what, format!("give {LEAST_BYTES} to {MOST_BYTES}, and wider land")));
        }
        if land.width().max(land.height()) > SIDE {
            let what = "the land does not fit into the map of a base station";
            return Err(given.error("bytes", what, format!("give land of at most {SIDE} cells along a side")));
        }
        Ok(Box::new(move |watch| parameters.measured(&scenario, watch)))
    }
}

fn cell([x, y]: [u16; 2]) -> Cell {
    Cell::new(x as i16, y as i16)
}

impl Parameters {
    fn measured(&self, scenario: &Scenario, watch: &Watch<'_>) -> Result<Measured, String> {
        let mut first = scenario.clone();
        first.land.terrain = self.before(scenario);
        let mut merged = Remembered::new(&first).ok_or("no robot shares a map")?;
        let mut is_cut = false;
        let outcome = simulate(&first, |moment, _| {
            is_cut = !watch(moment.row.tick);
            merged.look(moment);
            if is_cut { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        let outcome = outcome.map_err(|error| error.to_string())?;
        if is_cut {
            return Ok(Measured { is_cut, ..Measured::default() });
        }
        let sharing = (optimum::KIND.new)(&first).values(&first, &outcome).first().copied().flatten();
        let second = self.second(scenario);
        let tables = [
            None,
            Some(self.on_board(&second, &merged)?),
            Some(self.of(&second, &merged.map(&first.land.terrain))?),
            Some(self.of(&second, &first.land.terrain)?),
        ];
        let mut losses = Vec::new();
        for table in tables {
            let engine = Engine::new(&second, agents_with(&second, vec![table])).map_err(|error| error.to_string())?;
            let outcome: Outcome = engine.run(second.ticks, &mut |_, _| ControlFlow::Continue(()));
            losses.push((optimum::KIND.new)(&second).values(&second, &outcome).first().copied().flatten());
        }
        let crossed = losses.iter().flatten().count() as f64;
        let names = ["none_percent", "board_percent", "file_percent", "whole_percent"];
        let values = [
            ("arrived", Some(outcome.arrived as f64)),
            ("sharing_percent", sharing),
            ("known_percent", Some(100.0 * merged.share())),
            ("crossed", Some(crossed)),
        ];
        Ok(Measured::of(values.into_iter().chain(names.into_iter().zip(losses))))
    }

    /// The land at the time of the first mission.
    fn before(&self, scenario: &Scenario) -> Terrain {
        let land = &scenario.land.terrain;
        let (patch_cells, assumed) = (self.patch_cells, usual_class(land));
        Scouted { unknown: 0.0, wrong: self.wrong, patch_cells, assumed, seed: scenario.seed }.map(land)
    }

    fn second(&self, scenario: &Scenario) -> Scenario {
        let mut second = scenario.clone();
        second.robots = vec![Robot { id: RobotId(1), start: cell(self.start), goal: cell(self.goal) }];
        second.events.faults.clear();
        second.events.interventions.clear();
        second.laws.maps = None;
        second
    }

    fn of(&self, second: &Scenario, map: &Terrain) -> Result<Table, String> {
        let route = second.route().params;
        let moves = (route.norm, route.corner_cutting);
        cost_to_go(map, cell(self.goal), moves, self.bytes as usize).map_err(|error| error.to_string())
    }

    fn on_board(&self, second: &Scenario, merged: &Remembered) -> Result<Table, String> {
        let (route, land) = (second.route().params, &second.land.terrain);
        let cells = [land.width(), land.height()];
        let nodes = nodes(cells, self.bytes as usize).ok_or("too few bytes for a table")?;
        let header = Header { nodes, cells, origin: Cell::new(0, 0), goal: cell(self.goal), unit: 1 };
        let mut bytes = vec![0; header.length()];
        let written = merged.on_board().write_costs(&header, route.a3, route.norm, &mut bytes);
        written.ok_or("the base station knows no tile")?;
        CostToGo::from_bytes(Arc::from(bytes)).map_err(|error| error.to_string())
    }
}
