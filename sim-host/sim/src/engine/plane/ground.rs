//! The plane (or space) as seen by the engine.

use super::{PlaneGround, frames};
use crate::engine::Status;
use crate::engine::grid::Changed;
use crate::engine::ground::{Ground, Senses, StateWords, View};
use crate::engine::state::{Reader, StateError, write};
use crate::record::Motion;
use crate::scenario::{Intervention, Order, Target};
use crate::world::Refusal;
use crate::world::plane::{Barrier, Clearance, CommandAge, Disc, Solid};
use crate::world::scouts::Memory;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{AgentConfig, AnyInputs, Command, Task};
use staya_controller::grid::{Cell, UNIT};
use staya_controller::neighbor::Sighting;
use staya_controller::robot::Mode;
use std::collections::{HashMap, VecDeque};

/// Includes the task that its robot gets at a restart.
#[derive(Debug, Serialize, Deserialize)]
struct PlaneBody {
    position_m: [f64; 3],
    velocity_mps: [f64; 3],
    target_mps: [f64; 3],
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

impl Ground for PlaneGround {
    fn save_body(&self, index: usize, bytes: &mut Vec<u8>) {
        let (disc, number) = (&self.plane.discs()[index], self.number(index));
        let body = PlaneBody {
            position_m: disc.position_m,
            velocity_mps: disc.velocity_mps,
            target_mps: disc.target_mps,
            goal: self.robots[number].goal,
            places: self.setup.starts[number].places.clone(),
            since: self.since[number],
            shut: self.plane.shut(index).to_vec(),
            seen: self.scouts.as_ref().map(|scouts| scouts.memory(index).clone()),
        };
        write(&body, bytes);
    }

    fn load_body(&mut self, number: usize, index: Option<usize>, from: &mut Reader<'_>) -> Result<(), StateError> {
        let PlaneBody { position_m, velocity_mps, target_mps, goal, places, since, shut, seen } =
            from.read("a body")?;
        self.robots[number].goal = goal;
        self.setup.starts[number].places = places;
        self.since[number] = since;
        let Some(index) = index else { return Ok(()) };
        let motion = [position_m, velocity_mps, target_mps];
        if !is_finite(&motion) {
            return Err(from.unfit("its body is nowhere"));
        }
        self.plane.put(index, motion);
        self.plane.put_shut(index, shut);
        if let (Some(scouts), Some(seen)) = (&mut self.scouts, seen) {
            scouts.put(index, seen);
        }
        Ok(())
    }

    fn save_shared(&self, bytes: &mut Vec<u8>) {
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

    fn load_shared(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
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
            self.plane.put(index, [position_m, velocity_mps, velocity_mps]);
        }
        (self.clearance, self.gap_m, self.changed) = (clearance, gap_m, changed);
        self.plane.put_solids(solids);
        self.orders = frames(&orders, self.format, self.key.as_ref(), self.restarts);
        self.setup.orders = orders;
        Ok(())
    }

    fn sense<'a>(&'a self, index: usize, _: u32, senses: &'a mut Senses) -> AnyInputs<'a, f32> {
        let Disc { position_m, velocity_mps, .. } = self.plane.discs()[index];
        self.sense_at(index, position_m, velocity_mps, senses)
    }

    fn sightings(&self, index: usize, tick: u32, within_ticks: u32, sightings: &mut Vec<Sighting<f32>>) {
        match &self.sight {
            Some(sight) => sight.sightings(&self.plane, index, tick, within_ticks, sightings),
            None => sightings.clear(),
        }
    }

    fn motion(&self, index: usize, _: u32) -> Motion {
        let disc = &self.plane.discs()[index];
        Motion {
            cell: self.plane.cell(disc.position_m).unwrap_or_default(),
            position_m: disc.position_m,
            velocity_mps: disc.velocity_mps,
        }
    }

    fn forget(&mut self, index: usize) {
        if let Some(scouts) = &mut self.scouts {
            scouts.put(index, Memory::new());
        }
    }

    fn advance(&mut self, _: u32, commands: &[Command<f32>], ages: &[CommandAge]) -> u64 {
        if let (Some(scouts), Some(land)) = (&mut self.scouts, self.plane.terrain()) {
            let (plane, discs) = (&self.plane, self.plane.discs());
            scouts.observe(land, |index| plane.cell(discs[index].position_m));
        }
        self.plane.advance(commands, ages);
        if let Some(sight) = &mut self.sight {
            sight.look(&self.plane);
        }
        let now = self.plane.clearance();
        self.clearance.add(&now);
        self.gap_m = Some(now.bodies_m).filter(|gap_m| gap_m.is_finite());
        now.overlaps + now.intrusions
    }

    fn words(&self, index: usize, tick: u32, status: &Status) -> StateWords {
        let disc = &self.plane.discs()[index];
        let head = (u64::from(tick) << 8) | status.mode as u64;
        let numbers = disc.position_m.into_iter().chain(disc.velocity_mps);
        // Makes negative zero equal to zero.
        core::iter::once(head).chain(numbers.map(|x| (x + 0.0).to_bits())).collect()
    }

    fn arrival(&self, index: usize, tick: u32, status: &Status) -> Option<u64> {
        let disc = &self.plane.discs()[index];
        let has_places = !self.setup.starts[self.number(index)].places.is_empty();
        let stands = disc.velocity_mps.iter().all(|v| v.abs() < 1e-3);
        let is_there = status.mode == Mode::Arrived && (has_places || stands);
        is_there.then(|| (u64::from(tick) + 1) * u64::from(UNIT))
    }

    fn setup(&self, number: usize, tick: u32) -> (AgentConfig<f32>, Task) {
        (self.config(number), self.task(number, tick))
    }

    fn view(&self, tick: u32) -> View<'_> {
        let orders = self.orders.binary_search_by_key(&tick, |(tick, _)| *tick).map(|at| &self.orders[at].1[..]);
        View {
            terrain: self.plane.terrain(),
            solids: self.plane.solids(),
            discs: self.plane.discs(),
            intruders: self.plane.intruders(),
            goals_m: self.goals_m(tick),
            clearance: Some(self.clearance),
            gap_m: self.gap_m,
            orders: orders.unwrap_or_default(),
        }
    }

    fn target_m(&self, index: usize, tick: u32, status: &Status) -> Option<[f64; 3]> {
        let number = self.number(index);
        if self.setup.group(number).law.is_on_grid() {
            let land = self.plane.terrain().filter(|land| land.index(status.target).is_some())?;
            let [x, y] = land.center_m(status.target);
            return Some([x, y, 0.0]);
        }
        let (mut target, mut since) = match &self.setup.starts[number].places[..] {
            [one] => (one, 0),
            _ => return None,
        };
        for order in self.ordered(number, tick) {
            if order.index > 0 {
                return None;
            }
            (target, since) = (&order.target, order.tick);
        }
        let age_s = f64::from(tick - since) * f64::from(self.tick_us) / 1e6;
        Some([0, 1, 2].map(|axis| target.position_m[axis] + target.velocity_mps[axis] * age_s))
    }

    fn goal_m(&self, number: usize) -> Option<[f64; 3]> {
        self.setup.starts[number].places.first().map(|target| target.position_m)
    }

    fn barriers(&self, tick: u32, of: &[usize]) -> Vec<(usize, Barrier)> {
        let mut known = HashMap::new();
        let barrier = |&index: &usize| {
            let goal_m = self.last_goal_m(self.number(index), tick)?;
            Some((index, self.barrier(index, goal_m, &mut known)?))
        };
        of.iter().filter_map(barrier).collect()
    }

    fn set_goal(&mut self, number: usize, tick: u32, place_m: [f64; 3]) {
        let goals = self.setup.group(number).law.goals();
        let target = Target { position_m: place_m, velocity_mps: [0.0; 3] };
        let places = &mut self.setup.starts[number].places;
        match places.first_mut() {
            Some(first) if goals.movable() > 1 => *first = target,
            _ => *places = vec![target],
        }
        if let Some(land) = self.plane.terrain() {
            self.robots[number].goal = land.nearest_cell([place_m[0], place_m[1]]);
        }
        self.since[number] = tick;
    }

    fn change(&mut self, tick: u32, what: &Intervention) -> Result<(), Refusal> {
        match *what {
            Intervention::Waypoint { goal, place_m } => {
                if self.setup.kinds().all(|group| goal >= group.law.goals().movable()) {
                    let what = format!("these robots have no goal {goal}");
                    return Err(Refusal::new("goal", what, "give one that they have, from 0"));
                }
                let target = Target { position_m: place_m, velocity_mps: [0.0; 3] };
                let at = self.setup.orders.partition_point(|order| order.tick <= tick);
                self.setup.orders.insert(at, Order { tick, index: goal, target });
                self.orders = frames(&self.setup.orders, self.format, self.key.as_ref(), self.restarts);
            }
            Intervention::Solid { ref solid } => self.plane.add_solids(Solid::of(solid)),
            Intervention::Move { index, by_m } => self.plane.move_solid(index, by_m)?,
            Intervention::Remove { index } => self.plane.remove_solid(index)?,
            Intervention::Cell { cell: [x, y], class } => {
                self.plane.set_cell(Cell::new(x, y), class)?;
                self.changed.insert((x, y), class);
            }
            // They change robots and their radio.
            Intervention::Goal { .. }
            | Intervention::Parameter { .. }
            | Intervention::Down { .. }
            | Intervention::Radio { .. } => {}
        }
        Ok(())
    }

    fn change_land(&mut self, cells: &[(Cell, u8)]) {
        self.plane.change(cells);
        self.changed.extend(cells.iter().map(|&(cell, class)| ((cell.x, cell.y), class)));
    }
}
