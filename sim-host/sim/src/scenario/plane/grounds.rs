//! Checks of starts and goals against the terrain and the obstacles.

use super::super::Draft;
use super::super::ranges::short;
use super::super::source::{Checked, Section};
use super::body::Group;
use crate::terrain::Terrain;
use crate::world::plane::{Solid, Solids};
use staya_controller::agent::Goals;

/// The terrain and the obstacles around the robots at the start.
pub(super) struct Surroundings<'a> {
    terrain: Option<&'a Terrain>,
    solids: Solids,
    /// Whether obstacles, terrain or goals change, so that a goal may become free.
    changes: bool,
}

impl<'a> Surroundings<'a> {
    pub fn new(draft: &Draft<'_>, terrain: Option<&'a Terrain>, solids: &[Solid]) -> Self {
        let changes = ["intervention", "terrain.change", "plane.order"].into_iter().any(|name| draft.has(name));
        Self { terrain, solids: Solids::new(solids.to_vec(), 0.0), changes }
    }

    /// Whether a place is at least `least_m` metres from obstacles, from blocked cells and from the
    /// sides of the map.
    pub fn is_clear(&self, place_m: [f64; 3], least_m: f64) -> bool {
        self.solids.near(place_m, least_m).all(|solid| solid.distance_m(place_m) >= least_m)
            && self.is_open(place_m, least_m)
    }

    /// Whether a place is at least `least_m` metres from blocked cells and from the sides of the
    /// map.
    pub fn is_open(&self, [x, y, _]: [f64; 3], least_m: f64) -> bool {
        self.terrain.is_none_or(|land| land.is_clear([x, y], least_m))
    }

    /// Refuses the start of robot `number` off the map, in a blocked cell or in an obstacle.
    pub fn start(&self, at: &Section<'_>, name: &str, number: usize, place_m: [f64; 3], radius_m: f64) -> Checked {
        self.on_map(at, name, place_m)?;
        let is_in = |solid: &Solid| solid.distance_m(place_m) < radius_m - 1e-6;
        let what = format!("robot {number} starts in an obstacle");
        let is_free = !self.solids.near(place_m, radius_m).any(is_in);
        at.require(is_free, name, what, format!("keep its start {} m away", short(radius_m)))
    }

    /// Refuses a goal off the map, in a blocked cell or in an obstacle, unless it may become free.
    pub fn goal(&self, group: &Group<'_>, at: &Section<'_>, name: &str, place_m: [f64; 3]) -> Checked {
        if self.changes {
            return Ok(());
        }
        self.on_map(at, name, place_m)?;
        let (body, radius_m) = (&group.body, group.body.radius_m);
        if group.kind.goals() != Goals::Waypoints || body.layer.kind().is_none() {
            return Ok(());
        }
        let least_m = radius_m - body.tolerance_m.unwrap_or(radius_m / 10.0);
        let is_in = |solid: &Solid| solid.distance_m(place_m) < least_m;
        let what = "an obstacle is nearer to the goal than the body's radius";
        let is_free = !self.solids.near(place_m, radius_m).any(is_in);
        at.require(is_free, name, what, format!("keep the goal {} m away", short(radius_m)))
    }

    fn on_map(&self, at: &Section<'_>, name: &str, [x, y, _]: [f64; 3]) -> Checked {
        let Some(land) = self.terrain else { return Ok(()) };
        let place = format!("[{}, {}]", short(x), short(y));
        let Some(cell) = land.cell_at([x, y]) else {
            let [[west, east], [south, north]] = [land.sides_m(0), land.sides_m(1)];
            let extent = [west, east, south, north].map(short);
            let [west, east, south, north] = &extent;
            let remedy = format!("the map has x from {west} to {east} m and y from {south} to {north} m");
            return Err(at.error(name, format!("{place} is not on the map"), remedy));
        };
        let state = if land.is_unknown(cell) { "unknown" } else { "closed" };
        let what = format!("{place} is in the cell [{}, {}], which is {state}", cell.x, cell.y);
        at.require(land.is_passable(cell), name, what, "give a place in an open cell")
    }
}
