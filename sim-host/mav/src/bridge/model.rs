use crate::geo::Origin;
use staya_controller::grid::Cell;
use staya_sim::scenario::{PlaneSetup, RobotGroup, Scenario};
use staya_sim::terrain::Terrain;
use staya_sim::world::plane::Solid;

/// World and capabilities of all vehicles of a scenario.
#[derive(Clone, Debug)]
pub struct VehicleModel {
    /// Whether the vehicles can fly. The ground is z = 0.
    pub flies: bool,
    /// The map of vehicles that move from cell to cell; these accept no velocities.
    pub grid: Option<Terrain>,
    /// Whether the vehicles form a team on the grid and so have no goals of their own.
    pub in_formation: bool,
    /// Whether the swarm has one vehicle, so that messages to system 0 are for it.
    pub is_alone: bool,
    /// Highest speed of the fastest vehicle, m/s; 0 on a grid.
    pub max_speed_mps: f32,
    /// Radius of the largest body, metres; 0 on a grid.
    pub radius_m: f32,
    /// Geographic position of the scenario's origin.
    pub origin: Origin,
    /// Static obstacles.
    pub solids: Vec<Solid>,
}

impl VehicleModel {
    /// Describes the vehicles of `scenario`.
    pub fn new(scenario: &Scenario, origin: Origin) -> Self {
        let on_grid = scenario.plane().is_none();
        let plane = scenario.plane();
        let largest = |of: fn(&RobotGroup) -> f64| {
            let groups = plane.into_iter().flat_map(PlaneSetup::kinds);
            groups.map(of).fold(0.0, f64::max) as f32
        };
        Self {
            flies: plane.is_some_and(|plane| plane.kinds().any(|group| group.safety.flies())),
            grid: on_grid.then(|| scenario.land.terrain.clone()),
            in_formation: on_grid && !scenario.formations.is_empty(),
            is_alone: scenario.robots.len() == 1,
            max_speed_mps: largest(|group| group.abilities.max_speed_mps),
            radius_m: largest(|group| group.radius_m),
            solids: plane.map_or_else(Vec::new, |plane| plane.solids.clone()),
            origin,
        }
    }

    /// The grid cell at a position in metres; `None` off the map, inside a wall, or without a grid.
    pub fn cell(&self, [x, y, _]: [f64; 3]) -> Option<Cell> {
        let land = self.grid.as_ref()?;
        land.cell_at([x, y]).filter(|cell| land.is_passable(*cell))
    }

    /// Whether a body fits between the obstacles at a position in metres.
    pub fn has_room(&self, place_m: [f64; 3]) -> bool {
        let radius_m = f64::from(self.radius_m);
        self.solids.iter().all(|solid| solid.distance_m(place_m) >= radius_m)
    }
}

/// The source of a vehicle's goals, named and numbered as in ArduPilot's Copter or Rover.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlightMode {
    /// The behaviour of the scenario.
    Auto,
    /// The mission; clients see AUTO.
    Mission {
        /// Arrival at the current item, simulated microseconds.
        there_since_us: Option<u64>,
    },
    /// The operator.
    Guided,
    /// No goal: the vehicle stays where it is.
    Hold,
    /// The same, in the mode that flying vehicles have for a stop.
    Brake,
    /// Home; a flying vehicle lands there.
    Return,
    /// Lands here, then disarms.
    Land {
        /// Whether that is an item of the mission.
        is_item: bool,
    },
}

impl FlightMode {
    const ALL: [Self; 6] = [Self::Auto, Self::Guided, Self::Hold, Self::Brake, Self::Return, Self::LAND];
    /// A landing on command.
    pub const LAND: Self = Self::Land { is_item: false };

    /// Custom mode numbers and names in ArduPilot's Rover and Copter.
    const fn codes(self) -> [(u32, &'static str); 2] {
        match self {
            Self::Auto | Self::Mission { .. } => [(10, "AUTO"), (3, "AUTO")],
            Self::Guided => [(15, "GUIDED"), (4, "GUIDED")],
            Self::Hold => [(4, "HOLD"), (5, "LOITER")],
            Self::Brake => [(17, "BRAKE"), (17, "BRAKE")],
            Self::Return => [(11, "RTL"), (6, "RTL")],
            Self::Land { .. } => [(9, "LAND"), (9, "LAND")],
        }
    }

    /// The custom mode number in MAVLink.
    pub fn number(self, flies: bool) -> u32 {
        self.codes()[usize::from(flies)].0
    }

    /// The name that ArduPilot uses.
    pub fn name(self, flies: bool) -> &'static str {
        self.codes()[usize::from(flies)].1
    }

    /// The mode with this number; `None` if these vehicles do not have it.
    pub fn from_number(number: u32, flies: bool) -> Option<Self> {
        let mut modes = Self::ALL.into_iter();
        modes.find(|mode| mode.number(flies) == number && (flies || !matches!(*mode, Self::LAND | Self::Brake)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mode_numbers_round_trip_and_rovers_neither_land_nor_brake() {
        for flies in [false, true] {
            for mode in FlightMode::ALL {
                let found = FlightMode::from_number(mode.number(flies), flies);
                let has = flies || !matches!(mode, FlightMode::LAND | FlightMode::Brake);
                assert_eq!(found, has.then_some(mode));
            }
            for number in [1, 2, 99, u32::MAX] {
                assert_eq!(FlightMode::from_number(number, flies), None);
            }
        }
    }
}
