//! The guidance laws in this build, as one type. A digest contains only the law inside.

use crate::Number;
use crate::one_of::one_of;
use staya_controller::agent::{
    AnyMessage, AnyOrder, AnyPayload, AnyProtocol, AnySurroundings, BadInput, Decision, External, Law as AgentLaw,
    Radio, Report, Tools, View, WaypointGuidance, decide_as, payload_as,
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

    // Without clones of messages and orders, which make the library larger.
    #[inline(never)]
    fn receive(&mut self, from: RobotId, message: &AnyMessage, radio: &mut Radio<'_, AnyProtocol>) -> bool {
        match (self, message) {
            (Self::External(law), _) => law.receive(from, message, radio),
            #[cfg(feature = "grid")]
            (Self::Route(law), AnyMessage::Grid(message)) => law.receive(from, message, &mut radio.of()),
            #[cfg(feature = "grid")]
            (Self::Formation(law), AnyMessage::Grid(message)) => law.receive(from, message, &mut radio.of()),
            #[cfg(feature = "grid")]
            (Self::RouteOnGrid(law), AnyMessage::Grid(message)) => {
                AgentLaw::<Number>::receive(law, from, message, &mut radio.of())
            }
            #[cfg(feature = "grid")]
            (Self::FormationOnGrid(law), AnyMessage::Grid(message)) => {
                AgentLaw::<Number>::receive(law, from, message, &mut radio.of())
            }
            _ => false,
        }
    }

    #[inline(never)]
    fn order(&mut self, order: &AnyOrder) -> bool {
        match (self, order) {
            (Self::External(law), _) => law.order(order),
            (Self::Waypoint(law), AnyOrder::Waypoint(order)) => law.order(order),
            #[cfg(feature = "flocks")]
            (Self::Lattice(law), AnyOrder::Waypoint(order)) => law.order(order),
            #[cfg(feature = "flocks")]
            (Self::GoalFlock(law), AnyOrder::Waypoint(order)) => law.order(order),
            #[cfg(feature = "grid")]
            (Self::Route(law), AnyOrder::Grid(order)) => law.order(order),
            #[cfg(feature = "grid")]
            (Self::Formation(law), AnyOrder::Grid(order)) => law.order(order),
            #[cfg(feature = "grid")]
            (Self::RouteOnGrid(law), AnyOrder::Grid(order)) => AgentLaw::<Number>::order(law, order),
            #[cfg(feature = "grid")]
            (Self::FormationOnGrid(law), AnyOrder::Grid(order)) => AgentLaw::<Number>::order(law, order),
            _ => false,
        }
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
