//! Goals of robots in the plane or in space, and the law that goes straight to them.

mod goal_occupancy;
mod law;
mod make_way;
mod protocol;
mod settings;

pub(crate) use goal_occupancy::{Claim, GoalOccupancy};
pub use law::WaypointGuidance;
pub use protocol::{WAYPOINTS, Waypoint, WaypointOrder, Waypoints};
pub use settings::WaypointSettings;
