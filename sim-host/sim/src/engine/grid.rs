//! The grid world as seen by the engine.

use super::Status;
use super::body::Kinematics;
use super::ground::{Ground, Senses, StateWords, View};
use super::hash::grid_words;
use super::state::{Reader, StateError, write};
use crate::record::Motion;
use crate::scenario::{Intervention, Robot, Scenario};
use crate::world::plane::{Barrier, CommandAge};
use crate::world::scouts::{Memory, Scouts};
use crate::world::{Body, Misplaced, MoveRules, Refusal, World};
use serde::{Deserialize, Serialize};
use staya_controller::agent::{AgentConfig, AnyInputs, AnySurroundings, CellState, Command, Inputs, OnGrid, Task};
use staya_controller::grid::{Cell, Dir, UNIT};
use staya_controller::robot::Mode;
use staya_controller::time::Duration;
use std::collections::BTreeMap;

/// Bodies that hold one cell each.
pub struct Grid {
    #[doc(hidden)]
    pub world: World,
    kinematics: Kinematics,
    robots: Vec<Robot>,
    changed: Changed,
    /// Robots' knowledge of terrain outside their sight.
    pub scouts: Option<Scouts>,
    /// Robot number of each body.
    pub numbers: Vec<u32>,
    radius: u8,
    tick_us: u32,
}

impl Grid {
    /// Creates the scenario's terrain with the robots at their starts, and rules of movement.
    ///
    /// # Errors
    /// Two robots start in one cell, or one starts in a wall.
    pub fn new(scenario: &Scenario, rules: MoveRules) -> Result<Self, Misplaced> {
        let starts = scenario.robots.iter().map(|robot| (robot.id, robot.start));
        let world = World::new(scenario.land.terrain.clone(), rules, scenario.seed, starts)?;
        Ok(Self {
            kinematics: Kinematics::new(world.terrain(), scenario.tick_s()),
            robots: scenario.numbered(),
            numbers: (0..scenario.robots.len() as u32).collect(),
            changed: Changed::new(),
            scouts: scenario.scouts(),
            radius: scenario.laws.radius,
            tick_us: scenario.tick_us,
            world,
        })
    }

    /// The world.
    #[must_use]
    pub const fn world(&self) -> &World {
        &self.world
    }
}

impl Grid {
    /// Updates the robots' memory with the terrain that they see in this tick.
    pub fn look(&mut self) {
        if let Some(scouts) = &mut self.scouts {
            let bodies = self.world.bodies();
            scouts.observe(self.world.terrain(), |index| Some(bodies[index].cell));
        }
    }

    fn number(&self, index: usize) -> usize {
        self.numbers[index] as usize
    }
}

pub(super) type Changed = BTreeMap<(i16, i16), u8>;

#[derive(Debug, Serialize, Deserialize)]
struct GridBody {
    cell: Cell,
    entered_by: Dir,
    free_at: u64,
    crossing: u64,
    is_shut_in: bool,
    goal: Cell,
    seen: Option<Memory>,
}

fn units(tick: u32) -> u64 {
    u64::from(tick) * u64::from(UNIT)
}

pub(super) fn duration(tick_us: u32) -> Duration {
    Duration::from_micros(i32::try_from(tick_us).unwrap_or(i32::MAX))
}

/// Time until a body may leave its cell; rounded up, so that it is not 0 too early.
pub(super) fn busy(free_at: u64, now_units: u64, tick_us: u32) -> Duration {
    let left = free_at.saturating_sub(now_units);
    let micros = (left * u64::from(tick_us)).div_ceil(u64::from(UNIT));
    Duration::from_micros(i32::try_from(micros).unwrap_or(i32::MAX))
}

impl Ground for Grid {
    fn save_body(&self, index: usize, bytes: &mut Vec<u8>) {
        let Body { id: _, cell, entered_by, free_at, crossing, is_shut_in } = self.world.bodies()[index];
        let goal = self.robots[self.number(index)].goal;
        let seen = self.scouts.as_ref().map(|scouts| scouts.memory(index).clone());
        write(&GridBody { cell, entered_by, free_at, crossing, is_shut_in, goal, seen }, bytes);
    }

    fn load_body(&mut self, number: usize, index: Option<usize>, from: &mut Reader<'_>) -> Result<(), StateError> {
        let GridBody { cell, entered_by, free_at, crossing, is_shut_in, goal, seen } = from.read("a body")?;
        self.robots[number].goal = goal;
        let Some(index) = index else { return Ok(()) };
        let id = self.world.bodies()[index].id;
        if !self.world.put(index, Body { id, cell, entered_by, free_at, crossing, is_shut_in }) {
            return Err(from.unfit("its body is in a wall or off the map"));
        }
        if let (Some(scouts), Some(seen)) = (&mut self.scouts, seen) {
            scouts.put(index, seen);
        }
        Ok(())
    }

    fn save_shared(&self, bytes: &mut Vec<u8>) {
        write(&self.changed, bytes);
    }

    fn load_shared(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
        let changed: Changed = from.read("the changes of the land")?;
        for (&(x, y), &class) in &changed {
            self.world.put_cell(Cell::new(x, y), class);
        }
        self.changed = changed;
        Ok(())
    }

    fn is_sound(&self) -> bool {
        self.world.is_sound()
    }

    fn sense<'a>(&'a self, index: usize, tick: u32, senses: &'a mut Senses) -> AnyInputs<'a, f32> {
        let body = &self.world.bodies()[index];
        Inputs {
            state: self.kinematics.pose(body, units(tick)).into(),
            surroundings: AnySurroundings::OnGrid(OnGrid {
                cell: CellState { cell: body.cell, busy: busy(body.free_at, units(tick), self.tick_us) },
                window: match &self.scouts {
                    None => self.world.window(body.cell, self.radius, &mut senses.cells),
                    Some(scouts) => scouts.window(self.world.terrain(), index, body.cell, &mut senses.cells),
                },
            }),
            inbox: &[],
        }
    }

    fn motion(&self, index: usize, tick: u32) -> Motion {
        let body = &self.world.bodies()[index];
        let pose = self.kinematics.pose(body, units(tick));
        let [x, y] = pose.position_m;
        let [vx, vy] = pose.velocity_mps;
        Motion { cell: body.cell, position_m: [x, y, 0.0], velocity_mps: [vx, vy, 0.0] }
    }

    fn forget(&mut self, index: usize) {
        if let Some(scouts) = &mut self.scouts {
            scouts.put(index, Memory::new());
        }
    }

    fn advance(&mut self, tick: u32, commands: &[Command<f32>], _: &[CommandAge]) -> u64 {
        self.look();
        self.world.advance(tick, commands);
        self.world.count_collisions(tick)
    }

    fn words(&self, index: usize, tick: u32, status: &Status) -> StateWords {
        let words = grid_words(tick, &self.world.bodies()[index], status.mode);
        words.into_iter().collect()
    }

    fn arrival(&self, index: usize, _: u32, status: &Status) -> Option<u64> {
        let body = &self.world.bodies()[index];
        let is_there = status.mode == Mode::Arrived && body.cell == status.target;
        is_there.then_some(body.free_at)
    }

    fn setup(&self, number: usize, _: u32) -> (AgentConfig<f32>, Task) {
        let robot = &self.robots[number];
        (AgentConfig::new(robot.id, 0.0, duration(self.tick_us)), Task::Cell(robot.goal))
    }

    fn view(&self, _: u32) -> View<'_> {
        View { terrain: Some(self.world.terrain()), ..View::default() }
    }

    fn goal_m(&self, number: usize) -> Option<[f64; 3]> {
        let [x, y] = self.world.terrain().center_m(self.robots[number].goal);
        Some([x, y, 0.0])
    }

    fn barriers(&self, _: u32, _: &[usize]) -> Vec<(usize, Barrier)> {
        Vec::new()
    }

    fn set_goal(&mut self, number: usize, _: u32, [x, y, _]: [f64; 3]) {
        // A place in a formation may be off the map: use the nearest cell.
        self.robots[number].goal = self.world.terrain().nearest_cell([x, y]);
    }

    fn change(&mut self, _: u32, what: &Intervention) -> Result<(), Refusal> {
        let Intervention::Cell { cell: [x, y], class } = *what else {
            let what = "these robots go from cell to cell";
            return Err(Refusal::new("kind", what, "change cells of the land instead"));
        };
        self.world.set_cell(Cell::new(x, y), class)?;
        self.changed.insert((x, y), class);
        Ok(())
    }

    fn change_land(&mut self, cells: &[(Cell, u8)]) {
        self.world.change(cells);
        self.changed.extend(cells.iter().map(|&(cell, class)| ((cell.x, cell.y), class)));
    }

    fn target_m(&self, _: usize, _: u32, status: &Status) -> Option<[f64; 3]> {
        let land = self.world.terrain();
        land.index(status.target)?;
        let [x, y] = land.center_m(status.target);
        Some([x, y, 0.0])
    }
}
