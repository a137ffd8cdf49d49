//! Applies [`Intervention`]s to a running simulation.

use super::Engine;
use super::roster::Tuned;
use crate::scenario::{Fault, Intervention};
use crate::world::Refusal;
use staya_controller::robot::RobotId;

impl Engine {
    /// Applies the scenario's terrain changes of this tick.
    pub fn change_land(&mut self) {
        for (number, rule) in self.changes.iter().enumerate().filter(|(_, rule)| rule.is_due(self.tick)) {
            let land = self.ground.view(self.tick).terrain;
            let due = land.map(|land| rule.due(number, self.roster.seed, self.tick, land));
            if let Some(cells) = due.filter(|cells| !cells.is_empty()) {
                self.ground.change_land(&cells);
            }
        }
    }

    /// Applies the scenario's interventions of this tick.
    pub fn apply_interventions(&mut self) {
        while let Some((_, what)) = self.interventions.front().filter(|(tick, _)| *tick <= self.tick) {
            let what = what.clone();
            // If it has no effect, that was reported when it was made by hand.
            let _ = self.intervene(&what);
            self.interventions.pop_front();
        }
    }

    /// Applies an intervention before the next tick.
    ///
    /// # Errors
    /// It is invalid for these robots or this world, or has no effect.
    pub fn intervene(&mut self, what: &Intervention) -> Result<(), Refusal> {
        what.check(&self.robots)?;
        let number = what.robot().and_then(|id| self.number_of(RobotId(id)));
        match what {
            Intervention::Goal { place_m, .. } => self.set_goals(number, *place_m),
            Intervention::Parameter { name, value, .. } => self.tune(number, name, *value),
            Intervention::Down { robot, for_s } => {
                let ticks = for_s.map_or(f64::INFINITY, |for_s| libm::ceil(for_s * 1e6 / f64::from(self.tick_us)));
                let to_tick = self.tick.saturating_add(ticks as u32);
                self.faults.push(Fault { robot: RobotId(*robot), from_tick: self.tick, to_tick });
                Ok(())
            }
            Intervention::Radio { loss, range_m } => {
                self.radio.change(*loss, *range_m);
                Ok(())
            }
            Intervention::Waypoint { .. }
            | Intervention::Solid { .. }
            | Intervention::Move { .. }
            | Intervention::Remove { .. }
            | Intervention::Cell { .. } => self.ground.change(self.tick, what),
        }
    }

    fn number_of(&self, id: RobotId) -> Option<usize> {
        self.robots.binary_search_by_key(&id, |robot| robot.id).ok()
    }

    pub(super) fn index_of(&self, id: RobotId) -> Option<usize> {
        let number = self.number_of(id)?;
        match self.here.len() == self.robots.len() && self.here[number] as usize == number {
            true => Some(number),
            false => self.here.iter().position(|&here| here as usize == number),
        }
    }

    fn set_goals(&mut self, number: Option<usize>, place_m: [f64; 3]) -> Result<(), Refusal> {
        if self.external.is_some() {
            return Err(Refusal::new("kind", "some of these robots run elsewhere", "run them here"));
        }
        if !self.ground.view(self.tick).is_open(place_m) {
            return Err(Refusal::new(
                "place_m",
                "no robot can stand there",
                "give a place on the map and not in a wall",
            ));
        }
        let robots = number.map_or(0..self.robots.len(), |number| number..number + 1);
        let tops = self.shapes.iter().filter(|_| number.is_none());
        let tops: Vec<_> = tops.map(|members| (members.clone(), self.ground.goal_m(members.start))).collect();
        for number in robots.clone() {
            let top = tops.iter().find(|(members, _)| members.contains(&number)).and_then(|(_, goal_m)| *goal_m);
            let own = top.zip(self.ground.goal_m(number));
            let off_m = own.map_or([0.0; 3], |(first, own)| [0, 1, 2].map(|axis| own[axis] - first[axis]));
            self.ground.set_goal(number, self.tick, [0, 1, 2].map(|axis| place_m[axis] + off_m[axis]));
        }
        let mut is_of_use = false;
        for index in 0..self.here.len() {
            if !robots.contains(&self.number(index)) {
                continue;
            }
            let ((_, task), is_up) = (self.ground.setup(self.number(index), self.tick), self.is_up(index));
            let agent = self.computers[index].agent.as_mut();
            // A robot that is down receives the goal at its restart.
            is_of_use |= agent.filter(|_| is_up).is_none_or(|agent| agent.assign(&task).is_ok());
        }
        if is_of_use {
            return Ok(());
        }
        Err(Refusal::new("kind", "these robots have no goal", "give them another guidance law"))
    }

    fn tune(&mut self, robot: Option<usize>, name: &str, value: f32) -> Result<(), Refusal> {
        let tuned = Tuned { robot, name: name.to_owned(), value };
        let mut is_known = false;
        for (&number, computer) in self.here.iter().zip(&mut self.computers) {
            if robot.is_none_or(|robot| robot == number as usize)
                && let Some(agent) = &mut computer.agent
            {
                is_known |= agent.set_parameter(name, value).is_ok();
            }
        }
        // A robot of another rank may have the parameter.
        if !is_known && self.here.len() == self.robots.len() {
            let what = format!("none of these robots has the parameter {name}");
            return Err(Refusal::new("name", what, "give one that its guidance law or its safety layer has"));
        }
        self.roster.tuned.push(tuned);
        Ok(())
    }

    pub(super) fn is_up(&self, index: usize) -> bool {
        !self.is_down(index)
    }

    /// Whether the computer of robot `index` is down.
    pub fn is_down(&self, index: usize) -> bool {
        self.tick < self.computers[index].down_until
    }
}
