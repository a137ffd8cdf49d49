//! The guidance laws in this build, as one type. A digest contains only the law inside, so an agent
//! made through C has the digest of the Rust agent with these types.

use crate::Number;
use crate::choices::StayaLaw;
use serde::{Serialize, Serializer};
use staya_controller::agent::{
    AnyOrder, AnyProtocol, AnySurroundings, BadInput, Decision, GridMessage, Law as AgentLaw, Radio, Report, Tools,
    View, WaypointGuidance, decide_as, order_as, receive_as,
};
#[cfg(feature = "flocks")]
use staya_controller::agent::{BoidsGuidance, GoalFlockGuidance, LatticeGuidance};
#[cfg(feature = "grid")]
use staya_controller::agent::{
    CELLS, CellFollower, FormationGuidance, FormationInPlane, GridWorkspace, RouteGuidance, TEMPLATE,
};
use staya_controller::parameters::Parameters;
use staya_controller::robot::RobotId;

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

impl AgentLaw<Number> for Law {
    type Surroundings<'a> = AnySurroundings<'a, Number>;
    type Protocol = AnyProtocol;
    type Workspace = Workspace;

    fn decide(
        &mut self,
        view: &View<'_, Number>,
        here: &AnySurroundings<'_, Number>,
        tools: Tools<'_, Number, Self>,
    ) -> Result<Decision<Number>, BadInput> {
        let Tools { rng, mut radio, workspace } = tools;
        #[cfg(not(feature = "grid"))]
        let () = *workspace;
        let sends = (rng, &mut radio);
        match self {
            Self::Waypoint(law) => decide_as(law, view, here, sends, &mut ()),
            #[cfg(feature = "flocks")]
            Self::Lattice(law) => decide_as(law, view, here, sends, &mut ()),
            #[cfg(feature = "flocks")]
            Self::GoalFlock(law) => decide_as(law, view, here, sends, &mut ()),
            #[cfg(feature = "flocks")]
            Self::Boids(law) => decide_as(law, view, here, sends, &mut ()),
            #[cfg(feature = "grid")]
            Self::Route(law) => decide_as(law, view, here, sends, workspace),
            #[cfg(feature = "grid")]
            Self::Formation(law) => decide_as(law, view, here, sends, workspace),
            #[cfg(feature = "grid")]
            Self::RouteOnGrid(law) => decide_as(law, view, here, sends, workspace),
            #[cfg(feature = "grid")]
            Self::FormationOnGrid(law) => decide_as(law, view, here, sends, workspace),
        }
    }

    fn payload(&mut self, radio: &mut Radio<'_, GridMessage>) {
        each!(self, law => AgentLaw::<Number>::payload(law, &mut radio.of()));
    }

    fn receive(&mut self, from: RobotId, message: GridMessage) -> bool {
        each!(self, law => receive_as::<Number, _>(law, from, message))
    }

    fn order(&mut self, order: AnyOrder) -> bool {
        each!(self, law => order_as::<Number, _>(law, order))
    }

    fn needs(&self, id: RobotId) -> bool {
        each!(self, law => AgentLaw::<Number>::needs(law, id))
    }

    fn report(&self) -> Report {
        each!(self, law => AgentLaw::<Number>::report(law))
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        each!(self, law => AgentLaw::<Number>::parameters(law, visit));
    }
}
