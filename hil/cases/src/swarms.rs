//! The cases: which robots, their tasks, and their controllers.

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
    /// Each for itself across rough land with walls, to the opposite corner (A. V. Kuznetsov 2017, KUZ, algorithm 1).
    Route,
    /// Two rows of two keep their places across rough land (KUZ algorithm 2).
    Formation,
    /// The same, each foreseeing the others by asking itself what it would do in their place.
    FormationReflexive,
    /// The same over a radio that loses, damages and repeats packets, everything that the robots know coming
    /// as packets from an operator: places, goal, "stop", "resume".
    Packets,
    /// The grid's route on bodies that move in the plane, behind ORCA.
    RouteInPlane,
    /// Five robots on a circle change sides, half-planes by the formula.
    OrcaAnalytic,
    /// The same with half-planes from a table of 2 KiB.
    OrcaTemplate2k,
    /// Robots in two rooms change places through a door for one.
    Doorway,
    /// Five robots on a sphere change sides above a floor, around a ball.
    Fly,
    /// Crossing ways behind push-out, around a ball.
    PushOut,
    /// An alpha flock follows a reference past a ball.
    Lattice,
    /// A goal flock goes to the middle, parts, and each robot goes to its goal.
    GoalFlock,
    /// Boids take on one heading.
    Boids,
}

impl Case {
    /// Every case.
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
    ];

    /// Its name in tables.
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
        }
    }

    /// Runs it to its end.
    ///
    /// Stack: agents, radio and workspace, about 12 KiB for the largest case, beside what a step needs.
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
        }
    }
}
