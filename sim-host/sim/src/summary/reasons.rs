//! Why robots have not arrived.

use crate::engine::{End, EndBody, Outcome};
use crate::nearby::{Cells, Found, Query, Search as _, Space};
use crate::scenario::Scenario;
use crate::words::{because, does};
use crate::world::plane::Barrier;
use staya_controller::agent::Wait;
use staya_controller::robot::Mode;

/// States at the end of a run, and the places of bodies.
pub(super) struct Reasons<'a> {
    scenario: &'a Scenario,
    ends: &'a [End],
    has_intruders: bool,
    bodies: Cells<f64, 3>,
    widest_m: f64,
}

impl<'a> Reasons<'a> {
    /// Finds bodies in O(1) each if any robot waits for others.
    pub fn new(scenario: &'a Scenario, outcome: &'a Outcome) -> Self {
        let ends = outcome.ends.as_slice();
        let bodies = || ends.iter().filter_map(|end| end.body);
        let widest = |of: fn(&EndBody) -> f64| bodies().map(|body| of(&body)).fold(0.0, f64::max);
        let (widest_m, reach_m) = (widest(|body| body.radius_m), widest(|body| body.reach_m));
        let space = scenario.plane().map_or(Space::OPEN, |plane| plane.space());
        let mut cells = Cells::new(space, reach_m + widest_m);
        if ends.iter().any(|end| end.wait == Some(Wait::Robots)) {
            let place = |end: &End| end.body.map_or([f64::NAN; 3], |body| body.position_m);
            cells.rebuild(&ends.iter().map(place).collect::<Vec<_>>());
        }
        let has_intruders = scenario.plane().is_some_and(|plane| !plane.intruders.is_empty());
        Self { scenario, ends, has_intruders, bodies: cells, widest_m }
    }

    /// Why robot `index` has not arrived.
    pub fn of(&self, index: usize) -> &'static str {
        let end = &self.ends[index];
        let goals = self.scenario.law_of(index).goals();
        match (end.barrier, end.wait, end.mode) {
            (_, None, mode @ (Mode::Idle | Mode::Fault | Mode::Passive)) => does(mode, goals),
            (Some(Barrier::GoalTaken), ..) => "its goal is in an obstacle",
            (Some(Barrier::Enclosed), ..) => "obstacles enclose it or its goal",
            (None, Some(Wait::Robots), _) if !self.has_company(index) => because(Wait::Route),
            (None, Some(wait), _) => because(wait),
            (None, None, mode) => does(mode, goals),
        }
    }

    /// Whether another robot or an intruder may be in the way of robot `index`.
    fn has_company(&self, index: usize) -> bool {
        let Some(own) = self.ends[index].body else { return true };
        let (at, radius) = (own.position_m, own.reach_m + self.widest_m);
        let query = Query { at, radius, most: usize::MAX, except: u32::try_from(index).ok() };
        let mut found = Vec::new();
        self.bodies.within(&query, &mut found);
        let is_near = |near: &Found<f64, 3>| {
            let other = self.ends[near.index as usize].body;
            other.is_some_and(|other| libm::sqrt(near.distance_squared) < own.reach_m + other.radius_m)
        };
        self.has_intruders || found.iter().any(is_near)
    }
}
