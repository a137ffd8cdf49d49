//! Saves and restores the mutable state of the plane.

use super::{PlaneGround, frames};
use crate::engine::grid::Changed;
use crate::engine::state::{Reader, StateError, write};
use crate::scenario::{Order, Target};
use crate::world::plane::{Clearance, Solid};
use crate::world::scouts::Memory;
use serde::{Deserialize, Serialize};
use staya_controller::grid::Cell;
use std::collections::VecDeque;

/// Includes the task that its robot gets at a restart.
#[derive(Debug, Serialize, Deserialize)]
struct PlaneBody {
    position_m: [f64; 3],
    velocity_mps: [f64; 3],
    goal: Cell,
    places: Vec<Target>,
    since: u32,
    shut: Vec<(Cell, u8)>,
    seen: Option<Memory>,
}

#[derive(Debug, Serialize, Deserialize)]
struct PlaneShared {
    clearance: Clearance,
    gap_m: Option<f64>,
    changed: Changed,
    solids: Vec<Solid>,
    orders: Vec<Order>,
    intruders: Vec<[[f64; 3]; 2]>,
    past: VecDeque<Vec<[f64; 3]>>,
}

fn is_finite(vectors: &[[f64; 3]]) -> bool {
    vectors.as_flattened().iter().all(|x| x.is_finite())
}

impl PlaneGround {
    pub(super) fn write_body(&self, index: usize, bytes: &mut Vec<u8>) {
        let (disc, number) = (&self.plane.discs()[index], self.number(index));
        let body = PlaneBody {
            position_m: disc.position_m,
            velocity_mps: disc.velocity_mps,
            goal: self.robots[number].goal,
            places: self.setup.starts[number].places.clone(),
            since: self.since[number],
            shut: self.plane.shut(index).to_vec(),
            seen: self.scouts.as_ref().map(|scouts| scouts.memory(index).clone()),
        };
        write(&body, bytes);
    }

    pub(super) fn read_body(
        &mut self,
        number: usize,
        index: Option<usize>,
        from: &mut Reader<'_>,
    ) -> Result<(), StateError> {
        let PlaneBody { position_m, velocity_mps, goal, places, since, shut, seen } = from.read("a body")?;
        self.robots[number].goal = goal;
        self.setup.starts[number].places = places;
        self.since[number] = since;
        let Some(index) = index else { return Ok(()) };
        if !is_finite(&[position_m, velocity_mps]) {
            return Err(from.unfit("its body is nowhere"));
        }
        self.plane.put(index, position_m, velocity_mps);
        self.plane.put_shut(index, shut);
        if let (Some(scouts), Some(seen)) = (&mut self.scouts, seen) {
            scouts.put(index, seen);
        }
        Ok(())
    }

    pub(super) fn write_shared(&self, bytes: &mut Vec<u8>) {
        let intruders = self.plane.intruders().iter();
        let shared = PlaneShared {
            clearance: self.clearance,
            gap_m: self.gap_m,
            changed: self.changed.clone(),
            solids: self.plane.solids().to_vec(),
            orders: self.setup.orders.clone(),
            intruders: intruders.map(|disc| [disc.position_m, disc.velocity_mps]).collect(),
            past: self.sight.as_ref().map(|sight| sight.past().clone()).unwrap_or_default(),
        };
        write(&shared, bytes);
    }

    pub(super) fn read_shared(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
        let PlaneShared { clearance, gap_m, changed, solids, orders, intruders, past } = from.read("the plane")?;
        if intruders.len() != self.plane.intruders().len() || !is_finite(intruders.as_flattened()) {
            return Err(from.unfit("it has other intruders"));
        }
        if let Some(sight) = &mut self.sight {
            let bodies = self.plane.discs().len() + self.plane.intruders().len();
            if past.is_empty() || past.iter().any(|places| places.len() != bodies || !is_finite(places)) {
                return Err(from.unfit("its robots have seen others"));
            }
            sight.put_past(past);
        }
        for (&(x, y), &class) in &changed {
            self.plane.put_cell(Cell::new(x, y), class);
        }
        for (index, [position_m, velocity_mps]) in (self.plane.discs().len()..).zip(intruders) {
            self.plane.put(index, position_m, velocity_mps);
        }
        (self.clearance, self.gap_m, self.changed) = (clearance, gap_m, changed);
        self.plane.put_solids(solids);
        self.orders = frames(&orders, self.format, self.key.as_ref());
        self.setup.orders = orders;
        Ok(())
    }
}
