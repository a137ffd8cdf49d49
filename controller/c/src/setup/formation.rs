//! The place of a robot in a formation.

use crate::memory::{answers, plain};
use crate::status::{Checked, StayaStatus};
use staya_controller::agent::TEMPLATE;
use staya_controller::grid::Cell;
use staya_controller::robot::RobotId;
use staya_controller::template::{Template, TemplateEntry, TemplateError};

/// Maximum number of entries in a formation's template.
pub const STAYA_TEMPLATE: usize = 8;

const _: () = assert!(STAYA_TEMPLATE == TEMPLATE);

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

/// The place of a robot in a formation, as `staya_formation_from_graph` fills it in.
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

plain!(StayaCell, StayaPlace, StayaFormation, StayaEdge);

impl StayaFormation {
    #[cfg_attr(not(feature = "grid"), expect(dead_code))]
    pub(crate) fn template(&self) -> Checked<Template<TEMPLATE>> {
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

    fn of(template: &Template<TEMPLATE>) -> Self {
        let mut neighbors = [StayaPlace::default(); STAYA_TEMPLATE];
        for (to, from) in neighbors.iter_mut().zip(&template.entries) {
            *to = StayaPlace { robot: from.id.0, offset: from.offset.into(), hops: from.hops };
        }
        let (neighbor_count, slot) = (template.entries.len() as u8, template.slot);
        Self { neighbors, neighbor_count, slot, offset: template.offset.into() }
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
        call.write(formation, StayaFormation::of(&template))
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
