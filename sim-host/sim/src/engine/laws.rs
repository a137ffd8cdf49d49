//! The laws of robots in a scenario: Staya's, those of papers, and one of the caller.

use super::safety::ScenarioSafety;
use super::witness::Witness;
use crate::own_law::{Own, OwnLaw, Site};
use crate::scenario::{KnownLand, LawSetup, Robot, Scenario};
use crate::terrain::known::{cost_to_go, under};
use crate::voxel::NeighborModel;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{
    AnyLaw, FormationGuidance, GridWorkspace, Guided, KnownMap, LEARNED, LayerSettings, MAP_TILES, OverCells,
    SharedMap, TEMPLATE, VISITS,
};
use staya_controller::land::{CostToGo, LandMap};
use staya_controller::laws;
use staya_papers::{Course, PublishedFormation};
use std::collections::HashMap;
use std::sync::Arc;
use thiserror::Error;

/// Law of an agent: any law of scenario files or of a caller, which an operator may override.
pub type HostLaw = Guided<f32, ScenarioLaw>;
/// Safety layer of an agent: any layer of scenario files.
pub type HostSafety = Witness<ScenarioSafety>;
/// Creates the law and the safety layer of a robot, at each of its starts.
pub type Agents = Box<dyn Fn(usize) -> (HostLaw, HostSafety) + Send + Sync>;

/// Cells of a search for windows up to radius 16 with their border: (2 * 16 + 3)^2.
pub const WIDE: usize = 1225;

/// A table of costs to go; robots with one goal share its bytes.
pub type Table = CostToGo<Arc<[u8]>>;
type Map = (Option<Box<KnownMap<Arc<[u8]>>>>, Option<Box<SharedMap<MAP_TILES>>>);

laws! {
    /// A law of a robot in a scenario.
    #[derive(Clone, Debug, Serialize, Deserialize)]
    #[expect(missing_docs, reason = "each variant's type says it")]
    pub enum ScenarioLaw[] of f32, in GridWorkspace<WIDE>, [] for [] {
        BuiltIn(AnyLaw<f32, WIDE, VISITS, LEARNED, Map>),
        Published(Box<PublishedFormation<WIDE, VISITS, TEMPLATE>>),
        LooksAhead(Box<FormationGuidance<WIDE, VISITS, TEMPLATE, LEARNED, Course, Map>>),
        Own(Own),
    }
}

fn law_of(setup: &LawSetup, map: Map) -> ScenarioLaw {
    match setup {
        LawSetup::BuiltIn(settings) => ScenarioLaw::BuiltIn(settings.law(map)),
        LawSetup::Published(settings) => ScenarioLaw::Published(Box::new(settings.law())),
        LawSetup::Lookahead(settings) => ScenarioLaw::LooksAhead(Box::new(settings.law(map))),
        LawSetup::Added(law) => ScenarioLaw::Own(law.law()),
    }
}

/// The map that a robot shares, if it shares one.
pub(super) fn shared_map(law: &HostLaw) -> Option<&LandMap<MAP_TILES>> {
    let (_, shared) = match law.inside() {
        ScenarioLaw::BuiltIn(AnyLaw::Route(OverCells::OnGrid(law))) => law.map(),
        ScenarioLaw::BuiltIn(AnyLaw::Route(OverCells::InPlane(law))) => law.inside().map(),
        ScenarioLaw::BuiltIn(AnyLaw::Formation(OverCells::OnGrid(law))) => law.map(),
        ScenarioLaw::BuiltIn(AnyLaw::Formation(OverCells::InPlane(law))) => law.inside().map(),
        ScenarioLaw::LooksAhead(law) => law.map(),
        _ => return None,
    };
    shared.as_ref().map(|shared| shared.inside())
}

/// Returns a function that creates the law and the safety layer of a robot.
#[must_use]
pub fn agents(scenario: &Scenario) -> Agents {
    agents_with(scenario, tables(scenario))
}

/// As [`agents`], with these tables of costs to go instead of those that the scenario describes, by
/// the robots' indices; robots beyond the last one have none.
#[must_use]
pub fn agents_with(scenario: &Scenario, tables: Vec<Option<Table>>) -> Agents {
    let kind = |index| (scenario.law(index), layer(scenario, index), limits(scenario, index));
    // Members of formations differ individually, others only by group; each kind is created once.
    let groups = scenario.plane().map_or(0, |plane| plane.groups.len());
    let group_of = |index: usize| match (scenario.formation_of(index), scenario.plane()) {
        (Some(_), _) => groups + 1 + index,
        (None, Some(plane)) => plane.starts[index].group.map_or(0, |group| group + 1),
        (None, None) => 0,
    };
    let (mut kinds, mut known) = (Vec::new(), HashMap::new());
    let of_robots = (0..scenario.robots.len()).map(|index| {
        *known.entry(group_of(index)).or_insert_with(|| {
            kinds.push(kind(index));
            kinds.len() - 1
        })
    });
    let of_robots: Vec<usize> = of_robots.collect();
    let maps = scenario.laws.maps;
    Box::new(move |index| {
        let (law, (safety, model), [speed_mps, tolerance_m]) = &kinds[of_robots[index]];
        // Robots that do not plan on terrain have no map to share.
        let shared = maps.filter(|_| law.is_on_grid()).map(|params| Box::new(SharedMap::new(params)));
        let table = tables.get(index).cloned().flatten();
        let map = (table.map(|table| Box::new(KnownMap::new(table))), shared);
        (
            Guided::new(law_of(law, map), *speed_mps, *tolerance_m),
            Witness::new(ScenarioSafety::new(safety, model.as_ref())),
        )
    })
}

/// The robots' tables, by index; `None` where the map shows no way, empty if they have none.
fn tables(scenario: &Scenario) -> Vec<Option<Table>> {
    let Some(KnownLand { map, bytes, moves }) = &scenario.land.known else { return Vec::new() };
    // The land under a formation differs by place.
    let kind = |(index, robot): (usize, &Robot)| (robot.goal, scenario.formation_of(index).map(|_| index));
    let kinds: Vec<_> = scenario.robots.iter().enumerate().map(kind).collect();
    let mut different = kinds.clone();
    different.sort_unstable();
    different.dedup();
    let made = different.into_par_iter().map(|kind @ (goal, place)| {
        let law = place.map(|index| scenario.law(index));
        let priced = law.as_ref().and_then(LawSetup::formation).and_then(|settings| {
            settings.footprint().map(|footprint| under(map, &settings.template.entries, footprint))
        });
        (kind, cost_to_go(priced.as_ref().unwrap_or(map), goal, *moves, *bytes).ok())
    });
    let made: HashMap<_, _> = made.collect();
    kinds.iter().map(|kind| made[kind].clone()).collect()
}

fn layer(scenario: &Scenario, index: usize) -> (LayerSettings, Option<NeighborModel>) {
    (scenario.safety(index), scenario.half_planes(index).cloned())
}

/// Speed and arrival distance of a robot that an operator sends to a waypoint, m/s and metres.
fn limits(scenario: &Scenario, index: usize) -> [f32; 2] {
    let group = scenario.plane().map(|setup| setup.group(index));
    group.map_or([0.0; 2], |group| [group.cruise_mps, group.tolerance_m].map(|x| x as f32))
}

/// As [`agents`], with `law(i)` as the law of robot `i`. The scenario determines the bodies, safety
/// layers, radio, faults and goals (given by orders).
///
/// # Errors
/// [`WrongWorld`].
pub fn own_agents<L: OwnLaw>(
    scenario: &Scenario,
    law: impl Fn(usize) -> L + Send + Sync + 'static,
) -> Result<Agents, WrongWorld> {
    fits::<L>(scenario)?;
    let robots = (0..scenario.robots.len()).map(|index| (layer(scenario, index), limits(scenario, index)));
    let robots: Vec<_> = robots.collect();
    Ok(Box::new(move |index| {
        let ((safety, model), [speed_mps, tolerance_m]) = &robots[index];
        let law = ScenarioLaw::Own(Own::new(law(index)));
        (Guided::new(law, *speed_mps, *tolerance_m), Witness::new(ScenarioSafety::new(safety, model.as_ref())))
    }))
}

fn fits<L: OwnLaw>(scenario: &Scenario) -> Result<(), WrongWorld> {
    let (site, wrong) = match scenario.plane() {
        None => (Site::Cells, WrongWorld::Grid),
        Some(setup) if !setup.has_terrain => (Site::Plane, WrongWorld::Plane),
        Some(_) => (Site::PlaneOverCells, WrongWorld::Land),
    };
    L::Surroundings::try_from(site.surroundings()).map(|_| ()).map_err(|_| wrong)
}

/// The law needs other surroundings than the scenario's robots have.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum WrongWorld {
    /// The scenario has no `[plane]`.
    #[error("the scenario has no table [plane], and the law goes by velocities; give it one")]
    Grid,
    /// The scenario has `[plane]` and no land.
    #[error("the scenario has no [terrain], and the law plans on land; give it one")]
    Plane,
    /// The scenario has `[plane]` on land.
    #[error("the scenario has a table [plane], and the law moves from cell to cell; leave it out")]
    Land,
}
