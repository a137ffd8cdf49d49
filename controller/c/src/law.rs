//! The guidance laws in this build, as one type. A digest contains only the law inside, so an agent
//! made through C has the digest of the Rust agent with these types.

use crate::Number;
use crate::choices::StayaLaw;
use serde::{Serialize, Serializer};
use staya_controller::agent::{
    AnySurroundings, BadInput, Decision, Guidance, GuidanceInput, Surroundings as _, Teamwork, ToAny, Waypoint,
    WaypointGuidance,
};
#[cfg(feature = "flocks")]
use staya_controller::agent::{BoidsGuidance, GoalFlockGuidance, LatticeGuidance};
#[cfg(feature = "grid")]
use staya_controller::agent::{
    CELLS, CellFollower, FormationGuidance, FormationInPlane, GridWorkspace, RouteGuidance, TEMPLATE,
};
use staya_controller::grid::Cell;
use staya_controller::parameters::Parameters;
use staya_controller::rand::Rng;
use staya_controller::robot::RobotId;
use staya_controller::wire::TemplateAssignment;

#[cfg(feature = "grid")]
const VISITS: usize = if cfg!(feature = "small") { 32 } else { staya_controller::agent::VISITS };
#[cfg(feature = "grid")]
const LEARNED: usize = if cfg!(feature = "small") { 0 } else { staya_controller::agent::LEARNED };

#[cfg(feature = "grid")]
pub(crate) type Route = RouteGuidance<CELLS, VISITS, LEARNED>;
#[cfg(feature = "grid")]
pub(crate) type Formation = FormationGuidance<CELLS, VISITS, TEMPLATE, LEARNED>;

#[cfg(feature = "grid")]
pub(crate) type Workspace = GridWorkspace<CELLS>;
#[cfg(not(feature = "grid"))]
pub(crate) type Workspace = ();

/// A guidance law.
#[derive(Clone, Debug)]
#[expect(missing_docs, reason = "StayaLaw says what each is")]
pub enum Law {
    Waypoint(WaypointGuidance<Number>),
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

macro_rules! each {
    ($any:expr, $inside:ident => $action:expr) => {
        match $any {
            Law::Waypoint($inside) => $action,
            #[cfg(feature = "flocks")]
            Law::Lattice($inside) => $action,
            #[cfg(feature = "flocks")]
            Law::GoalFlock($inside) => $action,
            #[cfg(feature = "flocks")]
            Law::Boids($inside) => $action,
            #[cfg(feature = "grid")]
            Law::Route($inside) => $action,
            #[cfg(feature = "grid")]
            Law::Formation($inside) => $action,
            #[cfg(feature = "grid")]
            Law::RouteOnGrid($inside) => $action,
            #[cfg(feature = "grid")]
            Law::FormationOnGrid($inside) => $action,
        }
    };
}

impl Law {
    pub(crate) const fn kind(&self) -> StayaLaw {
        match self {
            Self::Waypoint(_) => StayaLaw::Waypoint,
            #[cfg(feature = "flocks")]
            Self::Lattice(_) => StayaLaw::Lattice,
            #[cfg(feature = "flocks")]
            Self::GoalFlock(_) => StayaLaw::GoalFlock,
            #[cfg(feature = "flocks")]
            Self::Boids(_) => StayaLaw::Boids,
            #[cfg(feature = "grid")]
            Self::Route(_) => StayaLaw::Route,
            #[cfg(feature = "grid")]
            Self::Formation(_) => StayaLaw::Formation,
            #[cfg(feature = "grid")]
            Self::RouteOnGrid(_) => StayaLaw::RouteOnGrid,
            #[cfg(feature = "grid")]
            Self::FormationOnGrid(_) => StayaLaw::FormationOnGrid,
        }
    }
}

impl Serialize for Law {
    fn serialize<Z: Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        each!(self, law => law.serialize(serializer))
    }
}

impl Teamwork for Law {
    fn redirect(&mut self) {
        each!(self, law => law.redirect());
    }

    fn assign_template(&mut self, part: &TemplateAssignment, is_restarted: bool) -> bool {
        each!(self, law => law.assign_template(part, is_restarted))
    }

    fn goal_offset(&self) -> Cell {
        each!(self, law => law.goal_offset())
    }

    fn needs(&self, id: RobotId) -> bool {
        each!(self, law => law.needs(id))
    }
}

impl Guidance<Number> for Law {
    type Input<'a> = AnySurroundings<'a, Number>;
    type Destination = ToAny;
    type Workspace = Workspace;
    type Payload = ();

    #[cfg_attr(not(feature = "grid"), expect(unused_variables, reason = "only the laws of the grid have one"))]
    fn decide(
        &mut self,
        input: &GuidanceInput<'_, Number>,
        here: &AnySurroundings<'_, Number>,
        rng: &mut Rng,
        workspace: &mut Workspace,
    ) -> Result<Decision<Number>, BadInput> {
        let plane = || here.in_plane().ok_or(BadInput);
        #[cfg(feature = "grid")]
        let cells = || match here {
            AnySurroundings::InCells(cells) => Ok(cells),
            AnySurroundings::OnGrid(_) | AnySurroundings::InPlane(_) => Err(BadInput),
        };
        #[cfg(feature = "grid")]
        let grid = || match here {
            AnySurroundings::OnGrid(grid) => Ok(grid),
            AnySurroundings::InPlane(_) | AnySurroundings::InCells(_) => Err(BadInput),
        };
        match self {
            Self::Waypoint(law) => law.decide(input, &plane()?, rng, &mut ()),
            #[cfg(feature = "flocks")]
            Self::Lattice(law) => law.decide(input, &plane()?, rng, &mut ()),
            #[cfg(feature = "flocks")]
            Self::GoalFlock(law) => law.decide(input, &plane()?, rng, &mut ()),
            #[cfg(feature = "flocks")]
            Self::Boids(law) => law.decide(input, &plane()?, rng, &mut ()),
            #[cfg(feature = "grid")]
            Self::Route(law) => law.decide(input, cells()?, rng, workspace),
            #[cfg(feature = "grid")]
            Self::Formation(law) => law.decide(input, cells()?, rng, workspace),
            #[cfg(feature = "grid")]
            Self::RouteOnGrid(law) => Guidance::<Number>::decide(law, input, grid()?, rng, workspace),
            #[cfg(feature = "grid")]
            Self::FormationOnGrid(law) => Guidance::<Number>::decide(law, input, grid()?, rng, workspace),
        }
    }

    fn goes_to_cells(&self) -> bool {
        each!(self, law => Guidance::<Number>::goes_to_cells(law))
    }

    fn goes_by_velocity(&self) -> bool {
        each!(self, law => Guidance::<Number>::goes_by_velocity(law))
    }

    fn has_own_goal(&self) -> bool {
        each!(self, law => Guidance::<Number>::has_own_goal(law))
    }

    fn assign_waypoint(&mut self, index: u8, waypoint: &Waypoint<Number>) -> bool {
        each!(self, law => law.assign_waypoint(index, waypoint))
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        each!(self, law => Guidance::<Number>::parameters(law, visit));
    }
}
