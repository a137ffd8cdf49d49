//! Scenarios with a law supplied by the caller, on the grid, in the plane or in space.

use super::ground::WrongWorld;
use super::laws::ScenarioLaw;
use super::operator::Operated;
use super::simulate::{AnyEngine, LawOf, SafetyOf};
use super::witness::Witness;
use super::{ExternalController, Ground as _, Moment, Outcome, PlaneGround, StartError, Watch};
use crate::own_law::{Own, OwnLaw};
use crate::record::RobotRow;
use crate::scenario::Scenario;
use staya_controller::agent::{AnySurroundings, CellState, Guided, InCell, InCells, InPlane, OnGrid};
use staya_controller::geom::Vec2;
use std::ops::ControlFlow;

/// Runs a scenario as [`simulate`](super::simulate()) does, with `law(i)` as the law of robot `i`
/// in [`Scenario::robots`] at each of its starts. The scenario determines the bodies, safety
/// layers, radio, faults and goals (given by orders).
///
/// # Errors
/// [`StartError::World`], and those of [`Grid::new`](super::Grid::new).
pub fn simulate_own<L: OwnLaw>(
    scenario: &Scenario,
    law: impl Fn(usize) -> L + Send + Sync + 'static,
    mut watch: impl FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>) -> ControlFlow<()>,
) -> Result<Outcome, StartError> {
    simulate_own_with(scenario, law, None, &mut watch)
}

/// Runs [`simulate_own`] with some controllers outside this process, which may use another law.
///
/// # Errors
/// Those of [`simulate_own`].
pub fn simulate_own_with<L: OwnLaw>(
    scenario: &Scenario,
    law: impl Fn(usize) -> L + Send + Sync + 'static,
    external: Option<Box<dyn ExternalController>>,
    watch: &mut Watch<'_>,
) -> Result<Outcome, StartError> {
    Ok(AnyEngine::with(scenario, own_agents(scenario, law)?)?.go(scenario, external, watch))
}

/// Resumes [`simulate_own`] from a checkpoint, as [`simulate_from`](super::simulate_from) does.
///
/// # Errors
/// Those of [`simulate_own`], and [`StartError::State`].
pub fn simulate_own_from<L: OwnLaw>(
    scenario: &Scenario,
    law: impl Fn(usize) -> L + Send + Sync + 'static,
    state: &[u8],
    watch: &mut Watch<'_>,
) -> Result<Outcome, StartError> {
    Ok(AnyEngine::with(scenario, own_agents(scenario, law)?)?.resume(scenario, state, watch)?)
}

/// Creates a run with the caller's law and an operator; for bridges and live views.
///
/// # Errors
/// Those of [`simulate_own`].
pub fn operated_own<L: OwnLaw>(
    scenario: &Scenario,
    law: impl Fn(usize) -> L + Send + Sync + 'static,
) -> Result<Box<dyn Operated>, StartError> {
    Ok(AnyEngine::with(scenario, own_agents(scenario, law)?)?.operated(scenario))
}

/// Returns a function that creates the caller's law, which an operator may override, and the safety
/// layer of a robot; as [`agents`](super::agents) does.
///
/// # Errors
/// [`WrongWorld`].
pub fn own_agents<L: OwnLaw>(
    scenario: &Scenario,
    law: impl Fn(usize) -> L + Send + Sync + 'static,
) -> Result<impl Fn(usize) -> (LawOf, SafetyOf) + Send + Sync + 'static, WrongWorld> {
    fits::<L>(scenario)?;
    let robots = (0..scenario.robots.len()).map(|index| {
        let group = scenario.plane.as_ref().map(|setup| setup.group(index));
        let limits = group.map_or([0.0; 2], |group| [group.cruise_mps, group.tolerance_m].map(|x| x as f32));
        (scenario.safety(index), limits)
    });
    let robots: Vec<_> = robots.collect();
    Ok(move |index: usize| {
        let (safety, [speed_mps, tolerance_m]) = &robots[index];
        let law = ScenarioLaw::Own(Own::new(law(index)));
        (Guided::new(law, *speed_mps, *tolerance_m), Witness::new(safety.safety()))
    })
}

fn fits<L: OwnLaw>(scenario: &Scenario) -> Result<(), WrongWorld> {
    let grid = OnGrid { cell: CellState::default(), window: None };
    let plane = InPlane { max_speed_mps: 0.0, obstacles: &[] };
    let in_cell = InCell { offset_m: Vec2::ZERO, cell_m: 1.0 };
    let (surroundings, wrong) = match &scenario.plane {
        None => (AnySurroundings::OnGrid(grid), WrongWorld::Grid),
        Some(setup) if PlaneGround::new(scenario, setup).terrain().is_none() => {
            (AnySurroundings::InPlane(plane), WrongWorld::Plane)
        }
        Some(_) => (AnySurroundings::InCells(InCells { grid, plane, in_cell }), WrongWorld::Land),
    };
    L::Surroundings::try_from(surroundings).map(|_| ()).map_err(|_| wrong)
}

#[cfg(test)]
mod tests;
