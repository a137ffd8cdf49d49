//! Parameters of routes and formations across land in cells.

use crate::memory::{answers, plain};
use crate::status::{Checked, StayaStatus};
use staya_controller::agent::TEMPLATE;
use staya_controller::grid::Cell;
use staya_controller::robot::RobotId;
use staya_controller::template::{Template, TemplateEntry, TemplateError};

/// Maximum number of entries in a formation's template.
pub const STAYA_TEMPLATE: usize = 8;
/// Largest radius of a search over a window, cells.
pub const STAYA_MAX_RADIUS: u8 = 5;

const _: () = assert!(STAYA_TEMPLATE == TEMPLATE);

/// The costs of a route across cells (A. V. Kuznetsov 2017); gains are in sixteenths of a tick.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaRoute {
    /// Weight of travel time (a0), sixteenths.
    pub time_gain_16ths: u16,
    /// Additional cost of a cell with another robot (a1), sixteenths of a tick.
    pub others_gain_16ths: u16,
    /// Additional cost of a cell for each earlier visit (a2), sixteenths of a tick.
    pub visits_gain_16ths: u16,
    /// Price of a cell between window and target (a3), sixteenths of a tick: about the time that a
    /// cell takes on a good route.
    pub way_gain_16ths: u16,
    /// A move that costs this much more, in 16ths of a tick, comes first half as often; 0: never.
    pub halved_per_16ths: u16,
    /// Radius of the window that is searched, cells; 1 to STAYA_MAX_RADIUS.
    pub radius_cells: u8,
    /// Other than 0: the window's exit is on the ray to the target; otherwise it is the best one.
    pub exit_on_ray: u8,
    /// Other than 0: a diagonal move is as long as a straight one.
    pub diagonals_count_as_one: u8,
    /// Other than 0: diagonal moves may pass a blocked corner.
    pub cuts_corners: u8,
    /// Other than 0: plans again only when the land on its route has changed, for fewer searches.
    pub keeps_plan: u8,
}

/// A cell of the grid, or the difference of two.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct StayaCell {
    /// To the east.
    pub x: i16,
    /// To the north.
    pub y: i16,
}

impl From<StayaCell> for Cell {
    fn from(cell: StayaCell) -> Self {
        Self::new(cell.x, cell.y)
    }
}

impl From<Cell> for StayaCell {
    fn from(cell: Cell) -> Self {
        Self { x: cell.x, y: cell.y }
    }
}

/// The place of a neighbour in the formation.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct StayaPlace {
    /// The neighbour's number; 0 for any robot.
    pub robot: u32,
    /// Its cell minus that of this robot.
    pub offset: StayaCell,
    /// Its distance in edges of the formation's graph; 1 or more.
    pub hops: u8,
}

/// Formation keeping (A. V. Kuznetsov 2017); a unit is 1/70 of a cell. `staya_formation_from_graph`
/// fills in the place.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaFormation {
    /// The neighbours, `neighbor_count` of them.
    pub neighbors: [StayaPlace; STAYA_TEMPLATE],
    /// Length of `neighbors`.
    pub neighbor_count: u8,
    /// The robot's place: 0 for the top leader.
    pub slot: u8,
    /// The place's cell minus the top leader's.
    pub offset: StayaCell,
    /// Price of being off the own place, sixteenths of a tick per cell.
    pub gain_16ths: u16,
    /// How far a robot may fall behind before the top leader waits, units.
    pub halt_lag_units: u16,
    /// Lag at which the leader continues, units; at most `halt_lag_units`.
    pub resume_lag_units: u16,
    /// Number of decisions (in the plane seconds) for which robots wait for each other.
    pub patience: u16,
    /// Distance from its place up to which a neighbour is found, cells.
    pub eps_cells: u8,
    /// How far ahead of the leader the others aim, cells.
    pub lead_cells: u8,
    /// Share of the others' land in the leader's price, sixteenths.
    pub footprint_16ths: u8,
    /// Other than 0: robots behind a dead robot move up.
    pub closes_ranks: u8,
    /// Other than 0: predicts others by computing their moves in their place; expensive.
    pub foresees_others: u8,
    /// Other than 0: instead of waiting, the leader heads for where the others are displaced.
    pub turns_back: u8,
}

/// Two neighbouring places of a formation, by their indices.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct StayaEdge {
    /// One of them.
    pub a: u16,
    /// The other one.
    pub b: u16,
}

plain!(StayaRoute, StayaCell, StayaPlace, StayaFormation, StayaEdge);

impl StayaFormation {
    #[cfg(feature = "grid")]
    pub(super) fn template(&self) -> Checked<Template<TEMPLATE>> {
        let places = self.neighbors.get(..self.neighbor_count.into()).ok_or(StayaStatus::TooMany)?;
        let mut template = Template { slot: self.slot, offset: self.offset.into(), entries: heapless::Vec::new() };
        for &StayaPlace { robot, offset, hops } in places {
            if hops == 0 {
                return Err(StayaStatus::Shape);
            }
            let entry = TemplateEntry { offset: offset.into(), id: RobotId(robot), hops };
            template.entries.push(entry).map_err(|_| StayaStatus::TooMany)?;
        }
        Ok(template)
    }

    fn place(&mut self, template: &Template<TEMPLATE>) {
        (self.slot, self.offset) = (template.slot, template.offset.into());
        self.neighbors = [StayaPlace::default(); STAYA_TEMPLATE];
        self.neighbor_count = template.entries.len() as u8;
        for (to, from) in self.neighbors.iter_mut().zip(&template.entries) {
            *to = StayaPlace { robot: from.id.0, offset: from.offset.into(), hops: from.hops };
        }
    }
}

/// Fills in the place number `own` of a formation, given the cells of all places in any common
/// frame, the top leader's first, and the edges of its graph. Robots within `hops` edges become
/// neighbours; the robot at place i has the number i + 1. `STAYA_STATUS_SHAPE` for a place or edge
/// that does not exist, `STAYA_STATUS_TOO_MANY` above STAYA_TEMPLATE neighbours.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_formation_from_graph(
    formation: *mut StayaFormation,
    places: *const StayaCell,
    place_count: usize,
    edges: *const StayaEdge,
    edge_count: usize,
    own: usize,
    hops: u8,
) -> StayaStatus {
    answers!(|call| {
        let template = from_graph(call.row(places, place_count)?, call.row(edges, edge_count)?, own, hops)?;
        let mut filled = *call.shared(formation)?;
        filled.place(&template);
        call.write(formation, filled)
    })
}

fn from_graph(places: &[StayaCell], edges: &[StayaEdge], own: usize, hops: u8) -> Checked<Template<TEMPLATE>> {
    // As many as a formation of this library can need: its slots are bytes.
    let mut cells = heapless::Vec::<Cell, 64>::new();
    let mut pairs = heapless::Vec::<(u16, u16), 256>::new();
    let too_many = |()| StayaStatus::TooMany;
    places.iter().try_for_each(|place| cells.push((*place).into()).map_err(|_| ())).map_err(too_many)?;
    edges.iter().try_for_each(|edge| pairs.push((edge.a, edge.b)).map_err(|_| ())).map_err(too_many)?;
    Template::from_graph(&cells, &pairs, own, hops).map_err(|error| match error {
        TemplateError::NoSuchPlace | TemplateError::BadEdge => StayaStatus::Shape,
        TemplateError::TooMany => StayaStatus::TooMany,
    })
}
