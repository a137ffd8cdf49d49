//! Controller setup of each robot of a scenario.

use super::law::LawSetup;
use super::{Formation, Intervention, Movement, Scenario};
use crate::terrain::change::ChangeKind;
use crate::voxel::NeighborModel;
use crate::world::scouts::Scouts;
use staya_controller::agent::{LayerSettings, RouteSettings, UnguardedSettings};
use staya_controller::grid::Cell;

impl Scenario {
    /// Law of robot `index`, with its place in a formation. O(formations).
    #[must_use]
    pub fn law(&self, index: usize) -> LawSetup {
        let law = self.law_of(index).clone();
        let Some(formation) = self.formation_of(index) else { return law };
        law.with_template(formation.templates.get(index - formation.first).cloned().unwrap_or_default())
    }

    /// Law of robot `index`, which it shares with its group.
    #[must_use]
    pub fn law_of(&self, index: usize) -> &LawSetup {
        self.plane().map_or(&self.laws.on_grid, |plane| &plane.group(index).law)
    }

    /// The laws of the groups.
    pub fn laws(&self) -> impl Iterator<Item = &LawSetup> {
        let on_grid = Some(&self.laws.on_grid).filter(|_| self.plane().is_none());
        on_grid.into_iter().chain(self.plane().into_iter().flat_map(|plane| plane.kinds().map(|group| &group.law)))
    }

    /// Routes of the first law that plans them, else those of the scenario's cells.
    #[must_use]
    pub fn route(&self) -> RouteSettings {
        self.laws().find_map(LawSetup::route).copied().unwrap_or(self.laws.usual_route)
    }

    /// Stores a value in each law that has the row, unchecked.
    pub fn set_in_laws(&mut self, row: &str, value: f32) {
        self.laws.on_grid.set(row, value);
        if let Movement::Plane(setup) = &mut self.movement {
            setup.groups.iter_mut().chain([&mut setup.general]).for_each(|group| group.law.set(row, value));
        }
    }

    /// Formation of robot `index`, if it is in one. O(formations).
    #[must_use]
    pub fn formation_of(&self, index: usize) -> Option<&Formation> {
        self.formations.iter().find(|formation| formation.members().contains(&index))
    }

    /// Pairs of robot indices, counted from 0, that are neighbours in a formation.
    pub fn edges(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let edges = |formation: &'_ Formation| {
            let first = formation.first;
            formation.edges.clone().into_iter().map(move |(a, b)| [a, b].map(|place| first + usize::from(place)))
        };
        self.formations.iter().flat_map(edges)
    }

    /// Pairs of robot ids that are neighbours in a formation.
    #[must_use]
    pub fn numbered_edges(&self) -> Vec<(u32, u32)> {
        let id = |index: usize| self.robots.get(index).map_or(0, |robot| robot.id.0);
        self.edges().map(|[a, b]| (id(a), id(b))).collect()
    }

    /// Sorted cells that a rule or an intervention sets, without drifting cells. O(cells).
    #[must_use]
    pub fn changing_cells(&self) -> Vec<Cell> {
        let by_rule = self.land.changes.iter().flat_map(|rule| match &rule.kind {
            ChangeKind::Become { cells, .. } => &cells[..],
            ChangeKind::Drift { .. } => &[],
        });
        let by_hand = self.events.interventions.iter().filter_map(|(_, what)| match what {
            Intervention::Cell { cell: [x, y], .. } => Some(Cell::new(*x, *y)),
            _ => None,
        });
        let mut cells: Vec<Cell> = by_rule.map(|(cell, _)| *cell).chain(by_hand).collect();
        cells.sort_unstable();
        cells.dedup();
        cells
    }

    pub(crate) fn scouts(&self) -> Option<Scouts> {
        self.land.scouting.as_ref().map(|known| Scouts::new(known, self.laws.radius, self.robots.len()))
    }

    /// The model that replaces ORCA's formula on robot `index`, if it has one.
    #[must_use]
    pub fn half_planes(&self, index: usize) -> Option<&NeighborModel> {
        self.plane()?.group(index).half_planes.as_ref()
    }

    /// Safety layer of robot `index`.
    #[must_use]
    pub fn safety(&self, index: usize) -> LayerSettings {
        self.plane().map_or(LayerSettings::None(UnguardedSettings), |plane| plane.group(index).safety)
    }
}
