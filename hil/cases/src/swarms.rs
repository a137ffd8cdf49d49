mod flocks;
pub(crate) mod on_grid;
mod waypoints;

use crate::{Probe, Summary};
use staya_controller::orca::{Analytic, VoxelTable2k};
use staya_controller::scalar::Scalar;
use staya_controller::wire::Postcard;

/// A canned swarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Case {
    /// Independent robots cross rough terrain with walls (A. V. Kuznetsov 2017, KUZ, algorithm 1).
    Route,
    /// Two rows of two keep formation across rough terrain (KUZ algorithm 2).
    Formation,
    /// Like [`Case::Formation`], with reflexive prediction.
    FormationReflexive,
    /// Like [`Case::FormationReflexive`], over a bad radio and with an operator's orders.
    Packets,
    /// The grid's route law for bodies that move in the plane, with ORCA.
    RouteInPlane,
    /// Five robots on a circle change sides with ORCA, half-planes by formula.
    OrcaAnalytic,
    /// Like [`Case::OrcaAnalytic`], with half-planes from a table of 2 KiB.
    OrcaTemplate2k,
    /// Robots in two rooms change places through a door that is one robot wide, while links fade
    /// for a fifth of the time.
    Doorway,
    /// Five robots on a sphere change sides above a floor and around a ball.
    Fly,
    /// Robots on crossing routes around a ball, with push-out.
    PushOut,
    /// An alpha flock follows a reference past a ball.
    Lattice,
    /// A goal flock moves to the middle of its goals and splits up.
    GoalFlock,
    /// Boids align their headings.
    Boids,
    /// Robots that negotiate change rooms through a corridor that is one robot wide. Eight of them
    /// do not fit the RAM of the nRF51.
    #[cfg(feature = "all-cases")]
    Negotiation,
}

impl Case {
    /// All cases.
    pub const ALL: &[Self] = &[
        Self::Route,
        Self::Formation,
        Self::FormationReflexive,
        Self::Packets,
        Self::RouteInPlane,
        Self::OrcaAnalytic,
        Self::OrcaTemplate2k,
        Self::Doorway,
        Self::Fly,
        Self::PushOut,
        Self::Lattice,
        Self::GoalFlock,
        Self::Boids,
        #[cfg(feature = "all-cases")]
        Self::Negotiation,
    ];

    /// Name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Route => "route",
            Self::Formation => "formation",
            Self::FormationReflexive => "formation_reflexive",
            Self::Packets => "packets",
            Self::RouteInPlane => "route_in_plane",
            Self::OrcaAnalytic => "orca_analytic",
            Self::OrcaTemplate2k => "orca_template_2k",
            Self::Doorway => "doorway",
            Self::Fly => "fly",
            Self::PushOut => "push_out",
            Self::Lattice => "lattice",
            Self::GoalFlock => "goal_flock",
            Self::Boids => "boids",
            #[cfg(feature = "all-cases")]
            Self::Negotiation => "negotiation",
        }
    }

    /// Runs the case to its end. Stack: about 12 KiB, of `negotiation` 48 KiB, plus the stack
    /// of a step.
    // Inlined, so that a program which names its cases contains only these.
    #[inline(always)]
    pub fn run<S: Scalar, P: Probe<S>>(self, probe: &mut P) -> Summary {
        match self {
            Self::Route => on_grid::route(probe),
            Self::Formation => on_grid::formation(probe),
            Self::FormationReflexive => on_grid::reflexive(probe),
            Self::Packets => on_grid::packets(Postcard, probe),
            Self::RouteInPlane => waypoints::route_in_plane(probe),
            Self::OrcaAnalytic => waypoints::swap(Analytic, probe),
            Self::OrcaTemplate2k => waypoints::swap(VoxelTable2k, probe),
            Self::Doorway => waypoints::doorway(probe),
            Self::Fly => waypoints::fly(probe),
            Self::PushOut => waypoints::push_out(probe),
            Self::Lattice => flocks::lattice(probe),
            Self::GoalFlock => flocks::goals(probe),
            Self::Boids => flocks::boids(probe),
            #[cfg(feature = "all-cases")]
            Self::Negotiation => crate::negotiation::swarm(probe),
        }
    }
}
