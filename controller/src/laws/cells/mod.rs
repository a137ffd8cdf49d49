//! The common parts of laws on the grid: protocol, maps, and the way from cell to cell.

mod assembly;
mod cell_follower;
mod far_map;
mod known_map;
mod move_history;
mod over_cells;
mod protocol;
mod shared_map;
mod workspace;

pub use assembly::{MAX_TEMPLATE, PartError, TEMPLATE_PART, TemplateAssembler, TemplatePart};
pub use cell_follower::CellFollower;
pub use far_map::FarMap;
pub use known_map::KnownMap;
pub(crate) use move_history::{MoveHistory, PATIENCE, avoid_crossing};
pub use over_cells::OverCells;
pub(crate) use protocol::is_over;
pub use protocol::{Grid, GridMessage, GridNeighbor, GridOrder, GridPayload, GridTask};
pub use shared_map::SharedMap;
pub use workspace::GridWorkspace;
#[cfg(not(feature = "list_cells"))]
pub use workspace::NoWorkspace;
