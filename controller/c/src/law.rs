//! The guidance laws in this build, as one type. A digest contains only the law inside.

use crate::Number;
use serde::Serialize;
#[cfg(feature = "flocks")]
use staya_controller::agent::{BoidsGuidance, GoalFlockGuidance, LatticeGuidance};
#[cfg(feature = "grid")]
use staya_controller::agent::{
    CELLS, CellFollower, FormationGuidance, FormationInPlane, GridWorkspace, RouteGuidance, TEMPLATE,
};
use staya_controller::agent::{External, WaypointGuidance};
use staya_controller::laws;

#[cfg(feature = "grid")]
const VISITS: usize = if cfg!(feature = "small") { 32 } else { staya_controller::agent::VISITS };
#[cfg(feature = "grid")]
const LEARNED: usize = if cfg!(feature = "small") { 0 } else { staya_controller::agent::LEARNED };

#[cfg(feature = "grid")]
pub(crate) type Route = RouteGuidance<CELLS, VISITS, LEARNED>;
#[cfg(feature = "grid")]
pub(crate) type Formation = FormationGuidance<CELLS, VISITS, TEMPLATE, LEARNED>;

laws! {
    /// A guidance law.
    #[expect(missing_docs, reason = "StayaLaw says what each is")]
    #[allow(clippy::large_enum_variant, reason = "it has no heap")]
    #[derive(Clone, Debug, Serialize)]
    #[serde(untagged)]
    pub enum Law[] of Number, in Workspace, [] for [] {
        Waypoint(WaypointGuidance<Number>),
        External(External<Number>),
        #[cfg(feature = "flocks")]
        Lattice(LatticeGuidance<Number>),
        #[cfg(feature = "flocks")]
        GoalFlock(GoalFlockGuidance<Number>),
        #[cfg(feature = "flocks")]
        Boids(BoidsGuidance<Number>),
        #[cfg(feature = "grid")]
        Route(CellFollower<Number, Route>),
        #[cfg(feature = "grid")]
        Formation(FormationInPlane<Number, CELLS, VISITS, TEMPLATE, LEARNED>),
        #[cfg(feature = "grid")]
        RouteOnGrid(Route),
        #[cfg(feature = "grid")]
        FormationOnGrid(Formation),
    }
}

/// The scratch memory of any law.
pub struct Workspace {
    #[cfg(feature = "grid")]
    grid: GridWorkspace<CELLS>,
    none: (),
}

impl Workspace {
    pub(crate) const fn new() -> Self {
        Self {
            #[cfg(feature = "grid")]
            grid: GridWorkspace::new(),
            none: (),
        }
    }
}

impl AsMut<()> for Workspace {
    fn as_mut(&mut self) -> &mut () {
        &mut self.none
    }
}

#[cfg(feature = "grid")]
impl AsMut<GridWorkspace<CELLS>> for Workspace {
    fn as_mut(&mut self) -> &mut GridWorkspace<CELLS> {
        &mut self.grid
    }
}
