//! Parameters of a running robot that an operator or its firmware can tune: names, units, limits
//! and descriptions. [`tunable`](super::tunable) maps each one to a field.

use super::safety::Safety;
use super::{Agent, Law, Perception};
use crate::names::named;
use crate::scalar::{Scalar, cast};
use crate::time::Duration;
use crate::wire::Wire;

named! {
    /// A number that may change while the robot runs; the linked field describes its effect.
    pub enum Parameter {
        /// [`AgentConfig::radius_m`](super::AgentConfig::radius_m); at least that of the body.
        Radius = "radius_m",
        /// [`AgentConfig::beacon_period`](super::AgentConfig::beacon_period).
        BeaconPeriod = "beacon_period_s",
        /// Cruising speed; the speed limit of the body holds too.
        Speed = "speed_mps",
        /// Distance at which the robot counts as arrived.
        Tolerance = "tolerance_m",
        /// [`AvoidParams::horizon_s`](crate::orca::AvoidParams::horizon_s).
        Horizon = "horizon_s",
        /// [`AvoidParams::wall_horizon_s`](crate::orca::AvoidParams::wall_horizon_s).
        WallHorizon = "wall_horizon_s",
        /// [`AvoidParams::share`](crate::orca::AvoidParams::share).
        Share = "share",
        /// [`AvoidParams::margin_m`](crate::orca::AvoidParams::margin_m).
        Margin = "margin_m",
        /// [`DeadlockParams::lean_rad`](crate::orca::DeadlockParams::lean_rad).
        Lean = "lean_rad",
        /// [`DeadlockParams::patience_radii`](crate::orca::DeadlockParams::patience_radii).
        PatienceRadii = "patience_radii",
        /// Minimum distance of push-out and of the goal flock (R_MinDist).
        MinDistance = "min_distance_m",
        /// [`GoalParams::neighborhood_m`](crate::flock::goal::GoalParams::neighborhood_m) (R_nbh).
        Neighborhood = "neighborhood_m",
        /// [`GoalParams::goal_gain`](crate::flock::goal::GoalParams::goal_gain).
        GoalGain = "k1",
        /// [`GoalParams::center_gain`](crate::flock::goal::GoalParams::center_gain).
        CenterGain = "k2",
        /// [`GoalParams::repulsion_gain`](crate::flock::goal::GoalParams::repulsion_gain).
        RepulsionGain = "k3",
        /// [`LatticeParams::spacing_m`](crate::flock::lattice::LatticeParams::spacing_m) (d).
        Spacing = "spacing_m",
        /// [`range_ratio`](crate::flock::lattice::LatticeParams::range_ratio): r / d.
        RangeRatio = "range_ratio",
        /// [`obstacle_ratio`](crate::flock::lattice::LatticeParams::obstacle_ratio): d' / d.
        ObstacleRatio = "obstacle_ratio",
        /// [`LatticeParams::attraction`](crate::flock::lattice::LatticeParams::attraction) (a).
        Attraction = "attraction",
        /// [`LatticeParams::repulsion`](crate::flock::lattice::LatticeParams::repulsion) (b).
        Repulsion = "repulsion",
        /// Weight of positions between robots.
        AlphaPosition = "c1_alpha",
        /// Weight of velocities between robots.
        AlphaVelocity = "c2_alpha",
        /// Weight of obstacle positions.
        BetaPosition = "c1_beta",
        /// Weight of obstacle velocities.
        BetaVelocity = "c2_beta",
        /// Weight of the position of the reference.
        GammaPosition = "c1_gamma",
        /// Weight of the velocity of the reference.
        GammaVelocity = "c2_gamma",
        /// Distance below which a boid turns away.
        Crowded = "crowded_m",
        /// Distance up to which a boid takes a neighbour into account.
        Closest = "closest_m",
        /// Largest turn of a boid per step.
        MaxTurn = "max_turn",
        /// Turn of a boid per step away from a robot that is too near.
        MaxTurnAway = "max_turn_away",
        /// [`RouteParams::a0`](crate::route::RouteParams::a0).
        TimeGain = "a0",
        /// [`RouteParams::a1`](crate::route::RouteParams::a1).
        OthersGain = "a1",
        /// [`RouteParams::a2`](crate::route::RouteParams::a2).
        VisitsGain = "a2",
        /// [`RouteParams::a3`](crate::route::RouteParams::a3).
        WayGain = "a3",
        /// [`FormationParams::eps`](crate::formation::FormationParams::eps).
        Eps = "eps_cells",
        /// [`FormationParams::gain`](crate::formation::FormationParams::gain).
        PlaceGain = "place_gain",
        /// [`FormationParams::halt_lag`](crate::formation::FormationParams::halt_lag).
        HaltLag = "halt_cells",
        /// [`FormationParams::resume_lag`](crate::formation::FormationParams::resume_lag).
        ResumeLag = "resume_cells",
        /// [`FormationParams::lead`](crate::formation::FormationParams::lead).
        Lead = "lead_cells",
        /// [`FormationParams::footprint`](crate::formation::FormationParams::footprint).
        Footprint = "footprint",
        /// [`FormationParams::patience`](crate::formation::FormationParams::patience).
        Patience = "patience",
    }
}

struct Facts {
    range: [f32; 2],
    unit: &'static str,
    what: &'static str,
}

const fn facts(least: f32, greatest: f32, unit: &'static str, what: &'static str) -> Facts {
    Facts { range: [least, greatest], unit, what }
}

impl Parameter {
    const fn facts(self) -> Facts {
        match self {
            Self::Radius => facts(0.001, 65.0, "m", "radius that others keep clear of; not less than the body's"),
            Self::BeaconPeriod => facts(0.001, 60.0, "s", "time between two beacons"),
            Self::Speed => facts(0.0, 32.0, "m/s", "preferred speed"),
            Self::Tolerance => facts(0.001, 10_000.0, "m", "distance at which a place counts as reached"),
            Self::Horizon => facts(0.01, 60.0, "s", "time ahead without a collision with a robot"),
            Self::WallHorizon => facts(0.01, 60.0, "s", "time ahead without a collision with an obstacle"),
            Self::Share => facts(0.0, 1.0, "", "own share of a correction"),
            Self::Margin => facts(0.0, 10.0, "m", "distance kept on top of the radii"),
            Self::Lean => facts(0.0, 1.5, "rad", "how far to turn right when a robot is in the way"),
            Self::PatienceRadii => facts(0.0, 100.0, "radii", "how long to wait for the robots whose turn it is"),
            Self::MinDistance => facts(0.001, 1000.0, "m", "least distance of two robots' centres"),
            Self::Neighborhood => facts(0.002, 10_000.0, "m", "largest distance of a neighbour that counts"),
            Self::GoalGain => facts(-1000.0, 1000.0, "", "pull of the goal (K1)"),
            Self::CenterGain => facts(-1000.0, 1000.0, "", "pull of the middle of the neighbours (K2)"),
            Self::RepulsionGain => facts(-1000.0, 1000.0, "", "push of neighbours that are too near (K3)"),
            Self::Spacing => facts(0.01, 100.0, "m", "distance of neighbours in the lattice (d)"),
            Self::RangeRatio => facts(1.001, 4.0, "", "range of interaction over spacing"),
            Self::ObstacleRatio => facts(0.001, 4.0, "", "distance from obstacles over spacing"),
            Self::Attraction => facts(0.001, 1000.0, "", "bound of the attraction (a)"),
            Self::Repulsion => facts(0.001, 1000.0, "", "bound of the repulsion (b), not less than a"),
            Self::AlphaPosition => facts(0.0, 1000.0, "1/s^2", "robots among each other, on places"),
            Self::AlphaVelocity => facts(0.0, 1000.0, "1/s", "robots among each other, on velocities"),
            Self::BetaPosition => facts(0.0, 10_000.0, "1/s^2", "obstacles, on places"),
            Self::BetaVelocity => facts(0.0, 1000.0, "1/s", "obstacles, on velocities"),
            Self::GammaPosition => facts(0.0, 1000.0, "1/s^2", "the reference, on places"),
            Self::GammaVelocity => facts(0.0, 1000.0, "1/s", "the reference, on velocities"),
            Self::Crowded => facts(0.0, 1000.0, "m", "nearer than this a boid turns away"),
            Self::Closest => facts(0.0, 10_000.0, "m", "largest distance of a neighbour that counts"),
            Self::MaxTurn => facts(0.0, 3.15, "rad", "largest turn towards the others in a step"),
            Self::MaxTurnAway => facts(0.0, 3.15, "rad", "largest turn away from a too near boid in a step"),
            Self::TimeGain => facts(0.0, 4095.0, "", "weight of travel time"),
            Self::OthersGain => facts(0.0, 4095.0, "ticks", "extra cost of a cell with another robot"),
            Self::VisitsGain => facts(0.0, 4095.0, "ticks", "extra cost of a cell for each earlier visit"),
            Self::WayGain => facts(0.0, 4095.0, "ticks", "price of a cell between the window and the target"),
            Self::Eps => facts(0.0, 255.0, "cells", "largest distance from a place that still counts as there"),
            Self::PlaceGain => facts(0.0, 4095.0, "ticks", "price of a cell off the own place"),
            Self::HaltLag => facts(0.0, 937.0, "cells", "lag of a robot at which the leader waits"),
            Self::ResumeLag => facts(0.0, 937.0, "cells", "lag at which the waiting leader continues"),
            Self::Lead => facts(0.0, 255.0, "cells", "how far ahead of the leader the others aim"),
            Self::Footprint => facts(0.0, 16.0, "/16", "share of the others' land in the leader's price"),
            Self::Patience => facts(0.0, 30_000.0, "decisions", "how long to wait before each robot continues alone"),
        }
    }

    /// The least and the greatest value that [`Agent::set_parameter`] accepts.
    #[must_use]
    pub const fn range(self) -> [f32; 2] {
        self.facts().range
    }

    /// The unit, such as `m/s`; empty for a plain number.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        self.facts().unit
    }

    /// A description in a few words.
    #[must_use]
    pub const fn what(self) -> &'static str {
        self.facts().what
    }
}

impl<S: Scalar, L: Law<S>, const N: usize, A: Safety<S>, W: Wire, P: Perception<S>> Agent<S, L, N, A, W, P> {
    /// Returns the current value, or `None` if this robot does not have the parameter.
    #[must_use]
    pub fn parameter(&self, parameter: Parameter) -> Option<f32> {
        let law = || self.law.parameter(parameter);
        let value = match parameter {
            Parameter::Radius => Some(self.config.radius_m),
            Parameter::BeaconPeriod => Some(S::from_micro(self.config.beacon_period.as_micros())),
            _ => law().or_else(|| self.safety.parameter(parameter)),
        };
        value.map(cast)
    }

    /// Changes a parameter from the next step on. Returns false, without a change, if the robot
    /// lacks it, `value` is outside [`Parameter::range`], or other parameters contradict it.
    pub fn set_parameter(&mut self, parameter: Parameter, value: f32) -> bool {
        let [least, greatest] = parameter.range();
        if !(least..=greatest).contains(&value) {
            return false;
        }
        match parameter {
            Parameter::Radius => self.config.radius_m = cast(value),
            // At most 60 s, so the rounding error of `f32` is negligible.
            Parameter::BeaconPeriod => {
                self.config.beacon_period = Duration::from_micros((value * 1e6) as i32);
            }
            _ => {
                let value = cast(value);
                return self.law.tune(parameter, value) | self.safety.tune(parameter, value);
            }
        }
        true
    }
}
