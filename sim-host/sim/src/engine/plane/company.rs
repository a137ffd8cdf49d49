//! Which robots have others near them at the start.

use crate::nearby::{Cells, Query, Search};
use crate::scenario::{PlaneSetup, Scenario};
use std::collections::BTreeSet;

/// Side of the index's cells, metres; the index doubles it until they suit the number of robots.
const SIDE_M: f64 = 0.01;

/// Returns for each robot whether another one that works and sends starts within radio range; false
/// behind layers that do not track silent neighbours. O(n log n) for robots that are spread evenly.
pub(super) fn company(scenario: &Scenario, setup: &PlaneSetup) -> Vec<bool> {
    if scenario.sensing().is_some_and(|sensing| !sensing.has_beacons) {
        return vec![false; setup.starts.len()];
    }
    let faults = scenario.events.faults.iter().filter(|fault| fault.from_tick == 0);
    let down: BTreeSet<_> = faults.map(|fault| fault.robot).collect();
    let starts = || scenario.robots.iter().zip(setup.starts.iter().map(|start| start.position_m));
    // The index never finds a robot without a place.
    let place = |is_down: bool, position_m| if is_down { [f64::NAN; 3] } else { position_m };
    let places: Vec<_> = starts().map(|(robot, at)| place(down.contains(&robot.id), at)).collect();
    let mut near = Cells::new(setup.space(), SIDE_M);
    near.rebuild(&places);
    let (radius, mut found) = (scenario.radio.range_m, Vec::new());
    let mut has_company = |(index, (_, at))| {
        if !setup.group(index as usize).tracks_silence() {
            return false;
        }
        near.within(&Query { at, radius, most: 1, except: Some(index) }, &mut found);
        !found.is_empty()
    };
    (0..).zip(starts()).map(&mut has_company).collect()
}
