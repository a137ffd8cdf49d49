//! Checks the runs of a plan before the first one starts.

use super::Plan;
use crate::error::SweepError;
use crate::sweep::jobs;
use staya_sim::scenario::{ScenarioError, Source};
use staya_sim::summary::Summary;
use std::collections::BTreeSet;
use std::ops::ControlFlow;

const MOST: u64 = 500;

/// Checks points with the reader of the scenario or study and returns the names of all figures.
pub fn check(plan: &Plan, source: &Source<'_>) -> Result<Vec<String>, SweepError> {
    let known = match plan.study {
        Some(study) => study.measures().into_iter().map(|(name, _)| name).collect(),
        None => figures(plan, source)?,
    };
    let points: Vec<u64> = points(plan).into_iter().collect();
    let mut wrong = None;
    jobs::each(
        points.len(),
        usize::MAX,
        |index| plan.job(&plan.run(points[index] * plan.seeds())).map(drop),
        |index, read| match read {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                // The error of the first point, whichever thread was first.
                if wrong.as_ref().is_none_or(|(before, _)| index < *before) {
                    wrong = Some((index, error));
                }
                ControlFlow::Break(())
            }
        },
    );
    match wrong {
        Some((_, error)) => Err(error),
        None => Ok(known),
    }
}

fn figures(plan: &Plan, source: &Source<'_>) -> Result<Vec<String>, ScenarioError> {
    let run = plan.run(0);
    let given = plan.given(&run)?;
    let scenario = given.scenario().map_err(|error| plan.said_of_plan(&run, error))?;
    let outcome = staya_numbers::simulate(&scenario, &mut |_, _| ControlFlow::Break(()))
        .map_err(|error| source.error("scenario", error, "name a scenario that `staya run` runs"))?;
    Ok(Summary::new(&scenario, &outcome, Vec::new()).figures().into_iter().map(|(name, _)| name).collect())
}

/// All points or, in large plans, each value of each axis with the first values of the others, and
/// points in between.
fn points(plan: &Plan) -> BTreeSet<u64> {
    let count = plan.runs() / plan.seeds();
    if count <= MOST {
        return (0..count).collect();
    }
    let mut points: BTreeSet<u64> = (0..MOST / 2).map(|number| number * (count - 1) / (MOST / 2 - 1)).collect();
    let mut stride = 1;
    for group in plan.groups.iter().rev() {
        let values = plan.axes[group.start].values.len() as u64;
        // A sample has too many values; its extremes show whether its range is valid.
        let extremes = group.clone().flat_map(|index| {
            let by_size = |number: &u64| {
                let value = plan.axes[index].values[*number as usize].number();
                value.unwrap_or(0.0)
            };
            let order = |a: &u64, b: &u64| by_size(a).total_cmp(&by_size(b));
            [(0..values).min_by(order), (0..values).max_by(order)].into_iter().flatten()
        });
        let all = if values <= MOST { 0..values } else { 0..0 };
        points.extend(all.chain(extremes).map(|number| number * stride));
        stride *= values;
    }
    points
}
