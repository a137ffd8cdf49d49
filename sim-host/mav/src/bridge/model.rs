//! What a robot is as a vehicle: the world that it knows, what it can do, and its flight modes.

use crate::geo::Origin;
use staya_controller::agent::SafetyKind;
use staya_controller::agent::Wish;
use staya_controller::grid::{BLOCKED, Cell};
use staya_controller::robot::Mode;
use staya_sim::engine::Observation;
use staya_sim::scenario::{PlaneSetup, RobotGroup, Scenario};
use staya_sim::terrain::Terrain;
use staya_sim::world::plane::Solid;

/// What all vehicles of a scenario have in common.
#[derive(Clone, Debug)]
pub struct VehicleModel {
    /// It can leave the ground, which is z = 0.
    pub flies: bool,
    /// It moves from cell to cell of this land, and knows no velocities.
    pub grid: Option<Terrain>,
    /// It keeps its place in a formation on the grid, and has no goal of its own.
    pub in_formation: bool,
    /// Highest speed, m/s, of the fastest; 0 on the grid.
    pub max_speed_mps: f32,
    /// Radius of the body, metres, of the largest; 0 on the grid.
    pub radius_m: f32,
    /// Where the scenario is on the Earth.
    pub origin: Origin,
    /// What does not move.
    pub solids: Vec<Solid>,
}

impl VehicleModel {
    /// The vehicles of a scenario.
    #[must_use]
    pub fn new(scenario: &Scenario, origin: Origin) -> Self {
        let on_grid = scenario.plane.is_none();
        let plane = scenario.plane.as_ref();
        let largest = |of: fn(&RobotGroup) -> f64| {
            let groups = plane.into_iter().flat_map(PlaneSetup::kinds);
            groups.map(of).fold(0.0, f64::max) as f32
        };
        Self {
            flies: plane.is_some_and(|plane| plane.kinds().any(|group| group.safety.kind() == SafetyKind::Fly)),
            grid: on_grid.then(|| scenario.terrain.clone()),
            in_formation: on_grid && !scenario.formations.is_empty(),
            max_speed_mps: largest(|group| group.abilities.max_speed_mps),
            radius_m: largest(|group| group.radius_m),
            solids: plane.map_or_else(Vec::new, |plane| plane.solids.clone()),
            origin,
        }
    }

    /// The cell of the grid at a place; `None` off the map, for a wall and without a grid.
    #[must_use]
    pub fn cell(&self, [x, y, _]: [f64; 3]) -> Option<Cell> {
        let land = self.grid.as_ref()?;
        let at = |metres: f64, axis: usize| {
            let cells = libm::floor((metres - land.origin_m[axis]) / land.cell_m);
            (0.0..f64::from(i16::MAX)).contains(&cells).then_some(cells as i16)
        };
        let cell = Cell::new(at(x, 0)?, at(y, 1)?);
        land.index(cell)?;
        (land.get(cell) != BLOCKED).then_some(cell)
    }

    /// Whether a body has room at a place.
    #[must_use]
    pub fn has_room(&self, place_m: [f64; 3]) -> bool {
        if self.grid.is_some() {
            return self.cell(place_m).is_some();
        }
        let radius_m = f64::from(self.radius_m);
        self.solids.iter().all(|solid| solid.distance_m(place_m) >= radius_m)
    }
}

/// Who decides where a vehicle goes. Clients know the modes by the numbers that ArduPilot gives them: those of a rover, or of a
/// copter where the vehicle flies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlightMode {
    /// Its own behaviour in the scenario, or its mission once that was started.
    Auto,
    /// The operator.
    Guided,
    /// Nobody: it stays where it is.
    Hold,
    /// Home, and there it stays, or lands.
    Return,
    /// Down to the ground; there its motors go off.
    Land,
}

impl FlightMode {
    const ALL: [Self; 5] = [Self::Auto, Self::Guided, Self::Hold, Self::Return, Self::Land];

    /// Its number.
    #[must_use]
    pub const fn number(self, flies: bool) -> u32 {
        match (self, flies) {
            (Self::Auto, false) => 10,
            (Self::Guided, false) => 15,
            (Self::Hold, false) => 4,
            (Self::Return, false) => 11,
            // A rover has no such mode, and never is in it.
            (Self::Land, _) => 9,
            (Self::Auto, true) => 3,
            (Self::Guided, true) => 4,
            (Self::Hold, true) => 5,
            (Self::Return, true) => 6,
        }
    }

    /// The mode of a number; `None` for one that these vehicles do not have.
    #[must_use]
    pub fn from_number(number: u32, flies: bool) -> Option<Self> {
        let mut modes = Self::ALL.into_iter();
        modes.find(|mode| mode.number(flies) == number && (flies || *mode != Self::Land))
    }

    /// Its name, as ArduPilot's users know it.
    #[must_use]
    pub const fn name(self, flies: bool) -> &'static str {
        match self {
            Self::Auto => "AUTO",
            Self::Guided => "GUIDED",
            Self::Hold if flies => "LOITER",
            Self::Hold => "HOLD",
            Self::Return => "RTL",
            Self::Land => "LAND",
        }
    }
}

/// What a vehicle knows of itself at a moment.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Simulated time, microseconds.
    pub time_us: u64,
    /// East, north, up, metres.
    pub position_m: [f64; 3],
    /// The same, m/s.
    pub velocity_mps: [f64; 3],
    /// On the grid.
    pub cell: Cell,
    /// What the controller is doing.
    pub mode: Mode,
    /// The wish that it follows.
    pub wish: Wish<f32>,
    /// Whether its computer runs.
    pub is_up: bool,
}

impl Sample {
    /// What the engine says of it.
    #[must_use]
    pub fn new(time_us: u64, observation: &Observation) -> Self {
        Self {
            time_us,
            position_m: observation.motion.position_m,
            velocity_mps: observation.motion.velocity_mps,
            cell: observation.motion.cell,
            mode: observation.status.mode,
            wish: observation.wish,
            is_up: observation.is_up,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_modes_lead_back_and_no_rover_lands() {
        for flies in [false, true] {
            for mode in FlightMode::ALL {
                let found = FlightMode::from_number(mode.number(flies), flies);
                let has = flies || mode != FlightMode::Land;
                assert_eq!(found, has.then_some(mode));
            }
            for number in [1, 2, 99, u32::MAX] {
                assert_eq!(FlightMode::from_number(number, flies), None);
            }
        }
    }
}
