//! Scenarios in the plane or in space with a guidance law supplied by the caller.

use super::operator::{Operated, boxed};
use super::simulate::{SafetyOf, go};
use super::state::State;
use super::witness::Witness;
use super::{Engine, ExternalController, Moment, Outcome, PlaneGround, Watch};
use crate::record::RobotRow;
use crate::scenario::Scenario;
use staya_controller::agent::{Guided, InPlane, Law};
use std::ops::ControlFlow;
use thiserror::Error;

/// A guidance law supplied by the caller. Its state is serialized in checkpoints.
pub trait OwnLaw:
    for<'a> Law<f32, Surroundings<'a> = InPlane<'a, f32>, Workspace = ()> + State + Clone + Send + 'static
{
}

impl<G> OwnLaw for G where
    G: for<'a> Law<f32, Surroundings<'a> = InPlane<'a, f32>, Workspace = ()> + State + Clone + Send + 'static
{
}

/// The scenario has no `[plane]`, but the law commands velocities.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("the scenario has no table [plane], and the law goes by velocities; give it one")]
pub struct NotInPlane;

/// Runs a scenario as [`simulate`](super::simulate()) does, with `law(i)` as the guidance law of
/// robot `i` in [`Scenario::robots`] at each of its starts. The scenario determines the bodies,
/// safety layers, radio, faults and goals (given by orders).
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

/// Runs [`simulate_own`] with some controllers outside this process, which may use another law.
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

/// Creates a run with the caller's law and an operator; for bridges and live views.
///
/// # Errors
/// [`NotInPlane`].
pub fn operated_own<G: OwnLaw>(
    scenario: &Scenario,
    law: impl Fn(usize) -> G + Send + Sync + 'static,
) -> Result<Box<dyn Operated>, NotInPlane> {
    Ok(boxed(scenario, engine(scenario, law)?))
}

fn engine<G: OwnLaw>(
    scenario: &Scenario,
    law: impl Fn(usize) -> G + Send + Sync + 'static,
) -> Result<Engine<PlaneGround, Guided<f32, G>, SafetyOf>, NotInPlane> {
    let setup = scenario.plane.as_ref().ok_or(NotInPlane)?;
    let robots = (0..scenario.robots.len()).map(|index| {
        let group = setup.group(index);
        (scenario.safety(index), [group.cruise_mps, group.tolerance_m].map(|x| x as f32))
    });
    let robots: Vec<_> = robots.collect();
    let factory = move |index: usize| {
        let (safety, [speed_mps, tolerance_m]) = &robots[index];
        (Guided::new(law(index), *speed_mps, *tolerance_m), Witness::new(safety.safety()))
    };
    Ok(Engine::new(scenario, PlaneGround::new(scenario, setup), factory))
}

#[cfg(test)]
mod tests;
