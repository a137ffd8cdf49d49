//! Saves and restores the mutable state of the plane.

use super::{PlaneGround, frames};
use crate::engine::grid::{Changed, restore_meter};
use crate::metrics::FormationMeters;
use crate::scenario::{Order, Target};
use crate::world::plane::{Clearance, Solid};
use crate::world::scouts::Memory;
use serde::{Deserialize, Serialize};
use staya_controller::grid::Cell;
use std::collections::VecDeque;

/// Includes the task that its robot gets at a restart.
#[derive(Debug, Serialize, Deserialize)]
pub struct PlaneBody {
    position_m: [f64; 3],
    velocity_mps: [f64; 3],
    goal: Cell,
    places: Vec<Target>,
    since: u32,
    shut: Vec<(Cell, u8)>,
    seen: Option<Memory>,
}

#[derive(Debug, Serialize, Deserialize)]
pub struct PlaneShared {
    clearance: Clearance,
    gap_m: Option<f64>,
    meter: Option<FormationMeters>,
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
    pub(super) fn body_now(&self, index: usize) -> PlaneBody {
        let (disc, number) = (&self.plane.discs()[index], self.number(index));
        PlaneBody {
            position_m: disc.position_m,
            velocity_mps: disc.velocity_mps,
            goal: self.robots[number].goal,
            places: self.setup.starts[number].places.clone(),
            since: self.since[number],
            shut: self.plane.shut(index).to_vec(),
            seen: self.scouts.as_ref().map(|scouts| scouts.memory(index).clone()),
        }
    }

    pub(super) fn put_body(&mut self, index: usize, mut body: PlaneBody) -> Result<(), &'static str> {
        if !is_finite(&[body.position_m, body.velocity_mps]) {
            return Err("its body is nowhere");
        }
        self.plane.put(index, body.position_m, body.velocity_mps);
        self.plane.put_shut(index, std::mem::take(&mut body.shut));
        if let (Some(scouts), Some(seen)) = (&mut self.scouts, body.seen.take()) {
            scouts.put(index, seen);
        }
        self.note_body(self.number(index), body);
        Ok(())
    }

    pub(super) fn note_body(&mut self, number: usize, body: PlaneBody) {
        let PlaneBody { goal, places, since, .. } = body;
        self.robots[number].goal = goal;
        self.setup.starts[number].places = places;
        self.since[number] = since;
    }

    pub(super) fn shared_now(&self) -> PlaneShared {
        let intruders = self.plane.intruders().iter();
        PlaneShared {
            clearance: self.clearance,
            gap_m: self.gap_m,
            meter: self.meter.clone(),
            changed: self.changed.clone(),
            solids: self.plane.solids().to_vec(),
            orders: self.setup.orders.clone(),
            intruders: intruders.map(|disc| [disc.position_m, disc.velocity_mps]).collect(),
            past: self.sight.as_ref().map(|sight| sight.past().clone()).unwrap_or_default(),
        }
    }

    pub(super) fn put_shared(&mut self, shared: PlaneShared) -> Result<(), &'static str> {
        let PlaneShared { clearance, gap_m, meter, changed, solids, orders, intruders, past } = shared;
        if intruders.len() != self.plane.intruders().len() || !is_finite(intruders.as_flattened()) {
            return Err("it has other intruders");
        }
        if let Some(sight) = &mut self.sight {
            let bodies = self.plane.discs().len() + self.plane.intruders().len();
            if past.is_empty() || past.iter().any(|places| places.len() != bodies || !is_finite(places)) {
                return Err("its robots have seen others");
            }
            sight.put_past(past);
        }
        restore_meter(&mut self.meter, meter)?;
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
