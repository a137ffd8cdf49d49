//! Parameters of routes and formations across land in cells.

use crate::memory::{self, plain, row, shared};
use crate::status::{Checked, StayaStatus, answer};
use staya_controller::agent::TEMPLATE;
use staya_controller::grid::Cell;
use staya_controller::robot::RobotId;
use staya_controller::template::{Template, TemplateEntry, TemplateError};

/// Entries of a formation's template.
pub const STAYA_TEMPLATE: usize = 8;
/// Largest radius of a search over a window, cells.
pub const STAYA_MAX_RADIUS: u8 = 5;

const _: () = assert!(STAYA_TEMPLATE == TEMPLATE);

/// What a route across cells costs (A. V. Kuznetsov 2017); gains are in sixteenths of a tick.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaRoute {
    /// Weight of travel time (a0), sixteenths.
    pub time_gain_16ths: u16,
    /// What a cell with another robot costs extra (a1), sixteenths of a tick.
    pub others_gain_16ths: u16,
    /// What a cell costs extra for each earlier visit (a2), sixteenths of a tick.
    pub visits_gain_16ths: u16,
    /// Price of a cell between window and target (a3), sixteenths of a tick: near the time that a cell takes on a good way.
    pub way_gain_16ths: u16,
    /// Moves that cost so much more, in sixteenths of a tick, come first half as often; 0: the cheapest always comes first.
    pub halved_per_16ths: u16,
    /// Radius of the window that is searched, cells; 1 to STAYA_MAX_RADIUS.
    pub radius_cells: u8,
    /// Other than 0: the exit of the window lies on the ray to the target; else it is the best of all.
    pub exit_on_ray: u8,
    /// Other than 0: a diagonal move counts as long as a straight one.
    pub diagonals_count_as_one: u8,
    /// Other than 0: diagonal moves may pass a blocked corner.
    pub cuts_corners: u8,
    /// Other than 0: it plans anew only when something on its way has changed, for fewer searches.
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

/// Where a neighbour in the formation should be.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct StayaPlace {
    /// Which robot; 0 for anyone.
    pub robot: u32,
    /// Its cell minus the own one.
    pub offset: StayaCell,
    /// How many edges of the formation's graph are between; 1 or more.
    pub hops: u8,
}

/// Keeping a formation (A. V. Kuznetsov 2017); a unit is 1/70 of a cell. `staya_formation_from_graph` fills in the place.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaFormation {
    /// The neighbours, `neighbor_count` of them.
    pub neighbors: [StayaPlace; STAYA_TEMPLATE],
    /// How many of `neighbors` there are.
    pub neighbor_count: u8,
    /// The robot's place: 0 for the top leader.
    pub slot: u8,
    /// The place's cell minus the top leader's.
    pub offset: StayaCell,
    /// Price of being off one's place, sixteenths of a tick per cell.
    pub gain_16ths: u16,
    /// How far somebody falls behind before the top leader waits, units.
    pub halt_lag_units: u16,
    /// How near he must have come again, units; at most `halt_lag_units`.
    pub resume_lag_units: u16,
    /// Decisions (in the plane seconds) for which they wait for each other.
    pub patience: u16,
    /// How far from its place a neighbour still counts as found, cells.
    pub eps_cells: u8,
    /// How far ahead of the leader the others aim, cells.
    pub lead_cells: u8,
    /// Share of the others' land in the leader's price, sixteenths.
    pub footprint_16ths: u8,
    /// Other than 0: those behind a dead robot move up.
    pub closes_ranks: u8,
    /// Other than 0: others are foreseen by asking what one would do in their place; dear.
    pub foresees_others: u8,
    /// Other than 0: a leader heads for where the others are off to instead of waiting.
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
        let entries = self.neighbors.get(..self.neighbor_count.into()).ok_or(StayaStatus::TooMany)?;
        let mut template = Template { slot: self.slot, offset: self.offset.into(), entries: heapless::Vec::new() };
        for StayaPlace { robot, offset, hops } in entries {
            let entry = TemplateEntry { offset: (*offset).into(), id: RobotId(*robot), hops: *hops };
            let kept = (*hops > 0).then(|| template.entries.push(entry)).ok_or(StayaStatus::Shape)?;
            kept.map_err(|_| StayaStatus::TooMany)?;
        }
        Ok(template)
    }

    fn place(&mut self, template: &Template<TEMPLATE>) {
        self.slot = template.slot;
        self.offset = template.offset.into();
        self.neighbors = [StayaPlace::default(); STAYA_TEMPLATE];
        self.neighbor_count = 0;
        for (to, from) in self.neighbors.iter_mut().zip(&template.entries) {
            *to = StayaPlace { robot: from.id.0, offset: from.offset.into(), hops: from.hops };
            self.neighbor_count += 1;
        }
    }
}

/// Fills in the place number `own` of a formation: its cells in any common frame, the top leader's first, and the edges of its graph.
/// Who is within `hops` edges becomes a neighbour; the robot at place i has the number i + 1.
///
/// `STAYA_STATUS_SHAPE` for a place or an edge that does not exist, `STAYA_STATUS_TOO_MANY` for more than STAYA_TEMPLATE neighbours.
///
/// # Safety
/// See the header's introduction.
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
    let template = || {
        // SAFETY: the caller gives so many places and edges, or what `row` refuses.
        let (places, edges) = unsafe { (row(places, place_count)?, row(edges, edge_count)?) };
        from_graph(places, edges, own, hops)
    };
    let placed = || {
        let template = template()?;
        // SAFETY: the caller gives a formation, or what `shared` refuses; nothing else uses it meanwhile.
        let mut filled = unsafe { *shared(formation)? };
        filled.place(&template);
        // SAFETY: as above, and the reference is no more.
        unsafe { memory::write(formation, filled) }
    };
    answer(placed())
}

fn from_graph(places: &[StayaCell], edges: &[StayaEdge], own: usize, hops: u8) -> Checked<Template<TEMPLATE>> {
    // As many as a formation of this library can need: its slots are bytes.
    let mut cells = heapless::Vec::<Cell, 64>::new();
    let mut pairs = heapless::Vec::<(u16, u16), 256>::new();
    for place in places {
        cells.push((*place).into()).map_err(|_| StayaStatus::TooMany)?;
    }
    for edge in edges {
        pairs.push((edge.a, edge.b)).map_err(|_| StayaStatus::TooMany)?;
    }
    Template::from_graph(&cells, &pairs, own, hops).map_err(|error| match error {
        TemplateError::NoSuchPlace | TemplateError::BadEdge => StayaStatus::Shape,
        TemplateError::TooMany => StayaStatus::TooMany,
    })
}
