//! Scenarios in the plane or in space whose robots go by a guidance law that is nobody's here: the caller's own.

use super::operator::{Operated, boxed};
use super::simulate::{SafetyOf, go};
use super::state::State;
use super::witness::Witness;
use super::{Engine, ExternalController, Moment, Outcome, PlaneGround, Watch};
use crate::record::RobotRow;
use crate::scenario::Scenario;
use staya_controller::agent::{AnyWorld, Commanded, Guidance, InPlane, NeighborTracking};
use std::ops::ControlFlow;
use thiserror::Error;

/// A law of the caller's own. What it keeps between steps serde must know, for checkpoints and for its fingerprint.
pub trait OwnLaw:
    for<'a> Guidance<f32, Input<'a> = InPlane<'a, f32>, Workspace = ()> + State + Clone + Send + 'static
{
}

impl<G> OwnLaw for G where
    G: for<'a> Guidance<f32, Input<'a> = InPlane<'a, f32>, Workspace = ()> + State + Clone + Send + 'static
{
}

/// A law of the plane in a scenario without one.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("the scenario has no table [plane], and the law goes by velocities; give it one")]
pub struct NotInPlane;

/// Runs a scenario as [`simulate`](super::simulate()) does, with `law(i)` as the guidance law of robot number `i` in
/// [`Scenario::robots`], made at its first start and at each restart. Everything else is the scenario's: bodies, safety layers, radio,
/// faults, places to go to (by [`Guidance::assign_waypoint`]).
///
/// # Errors
/// [`NotInPlane`].
pub fn simulate_own<G: OwnLaw>(
    scenario: &Scenario,
    law: impl Fn(usize) -> G + Send + Sync + 'static,
    mut watch: impl FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>) -> ControlFlow<()>,
) -> Result<Outcome, NotInPlane> {
    simulate_own_with(scenario, law, None, &mut watch)
}

/// The same with some of the robots' controllers outside of this process; where those have another law than `law(i)`, the run is another one.
///
/// # Errors
/// [`NotInPlane`].
pub fn simulate_own_with<G: OwnLaw>(
    scenario: &Scenario,
    law: impl Fn(usize) -> G + Send + Sync + 'static,
    external: Option<Box<dyn ExternalController>>,
    watch: &mut Watch<'_>,
) -> Result<Outcome, NotInPlane> {
    Ok(go(scenario, engine(scenario, law)?, external, watch))
}

/// The same before its first tick, for who looks into robots and tells them what to do: bridges and live pages.
///
/// # Errors
/// [`NotInPlane`].
pub fn operated_own<G: OwnLaw>(
    scenario: &Scenario,
    law: impl Fn(usize) -> G + Send + Sync + 'static,
) -> Result<Box<dyn Operated>, NotInPlane> {
    Ok(boxed(scenario, engine(scenario, law)?))
}

/// What a robot's agent is made of: the law, which an operator may take over.
type GuidanceOf<G> = Commanded<f32, NeighborTracking<f32, AnyWorld<G>>>;

fn engine<G: OwnLaw>(
    scenario: &Scenario,
    law: impl Fn(usize) -> G + Send + Sync + 'static,
) -> Result<Engine<PlaneGround, GuidanceOf<G>, SafetyOf>, NotInPlane> {
    let setup = scenario.plane.as_ref().ok_or(NotInPlane)?;
    let robots = (0..scenario.robots.len()).map(|index| {
        let group = setup.group(index);
        (scenario.safety(index), [group.cruise_mps, group.tolerance_m].map(|x| x as f32))
    });
    let robots: Vec<_> = robots.collect();
    let tracking = scenario.eyes.map(|eyes| eyes.tracking);
    let brains = move |index: usize| {
        let (safety, [speed_mps, tolerance_m]) = &robots[index];
        let law = NeighborTracking::new(AnyWorld(law(index)), tracking);
        let guidance = Commanded::new(law, *speed_mps, *tolerance_m);
        (guidance, Witness::new(safety.safety()))
    };
    Ok(Engine::new(scenario, PlaneGround::new(scenario, setup), brains))
}

#[cfg(test)]
mod tests;
