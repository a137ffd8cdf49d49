//! The guidance laws in this build, as one type. A digest contains only the law inside.

use crate::Number;
use crate::one_of::one_of;
use staya_controller::agent::{
    AnyMessage, AnyOrder, AnyPayload, AnyProtocol, AnySurroundings, BadInput, Decision, External, Law as AgentLaw,
    Radio, Report, Tools, View, WaypointGuidance, decide_as, order_as, payload_as, receive_as,
};
#[cfg(feature = "flocks")]
use staya_controller::agent::{BoidsGuidance, GoalFlockGuidance, LatticeGuidance};
#[cfg(feature = "grid")]
use staya_controller::agent::{
    CELLS, CellFollower, FormationGuidance, FormationInPlane, GridWorkspace, RouteGuidance, TEMPLATE,
};
use staya_controller::grid::Dir;
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

one_of! { $ each:
    /// A guidance law.
    #[expect(missing_docs, reason = "StayaLaw says what each is")]
    #[allow(clippy::large_enum_variant, reason = "it has no heap")]
    Law {
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

impl AgentLaw<Number> for Law {
    type Surroundings<'a> = AnySurroundings<'a, Number>;
    type Protocol = AnyProtocol;
    type Workspace = Workspace;

    fn decide(
        &mut self,
        view: &View<'_, Number, AnyProtocol>,
        here: &AnySurroundings<'_, Number>,
        tools: Tools<'_, Number, Self>,
    ) -> Result<Decision<Number>, BadInput> {
        let Tools { rng, mut radio, workspace } = tools;
        each!(self, law => decide_as(law, view, here, (rng, &mut radio), workspace.as_mut()))
    }

    fn payload(
        &mut self,
        here: &AnySurroundings<'_, Number>,
        heading: Dir,
        radio: &mut Radio<'_, AnyProtocol>,
    ) -> AnyPayload {
        each!(self, law => payload_as(law, here, heading, radio))
    }

    fn receive(&mut self, from: RobotId, message: &AnyMessage, radio: &mut Radio<'_, AnyProtocol>) -> bool {
        each!(self, law => receive_as::<Number, _, _>(law, from, message, radio))
    }

    fn order(&mut self, order: &AnyOrder) -> bool {
        each!(self, law => order_as::<Number, _, _>(law, order))
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
