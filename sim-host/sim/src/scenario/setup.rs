//! Controller setup of each robot of a scenario.

use super::{Formation, Intervention, Scenario};
use crate::terrain::change::ChangeKind;
use crate::world::scouts::Scouts;
use staya_controller::agent::{GuidanceSetup, SafetySetup};
use staya_controller::grid::Cell;

impl Scenario {
    /// Guidance law of robot `index`, with its formation template. Another
    /// [`Laws::formation`](super::Laws::formation) than Staya's replaces the formation on the grid.
    #[must_use]
    pub fn guidance(&self, index: usize) -> GuidanceSetup {
        let mut guidance = match (self.plane(), self.formation_of(index)) {
            (Some(plane), _) => plane.group(index).guidance.clone(),
            (None, None) => GuidanceSetup::Route { route: self.laws.route, speed_mps: None },
            (None, Some(_)) => GuidanceSetup::Formation {
                route: self.laws.route,
                formation: self.laws.formation.params(),
                template: Default::default(),
                speed_mps: None,
            },
        };
        if let GuidanceSetup::Formation { template, .. } = &mut guidance {
            let graph = self.formation_of(index);
            let own = graph.and_then(|graph| graph.templates.get(index - graph.first));
            *template = own.cloned().unwrap_or_default();
        }
        guidance
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
        self.land.scouting.as_ref().map(|known| Scouts::new(known, self.laws.route.params.radius, self.robots.len()))
    }

    /// Safety layer of robot `index`.
    #[must_use]
    pub fn safety(&self, index: usize) -> SafetySetup {
        self.plane().map_or(SafetySetup::None, |plane| plane.group(index).safety)
    }
}
