//! Quality of the formations of a swarm, separately and together.

use super::{FormationMeter, FormationQuality, Member, PlaceError};
use crate::scenario::Scenario;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Quality of one formation over a run.
#[derive(Clone, Debug, PartialEq)]
pub struct FormationKept {
    /// Robot indices of the members, counted from 0.
    pub members: Range<usize>,
    /// Means over the run; `None` before the first tick.
    pub keeping: Option<FormationQuality>,
    /// Place errors of robots in the plane after the forming time.
    pub place_error: Option<PlaceError>,
}

/// Measures all formations of a scenario tick by tick.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FormationMeters {
    each: Vec<(Range<usize>, FormationMeter)>,
    numbers: Vec<u32>,
}

impl FormationMeters {
    /// Creates meters without measurements; `None` if the scenario has no formation.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Option<Self> {
        let meter = |graph| {
            FormationMeter::new(graph, scenario.law_of(graph.first).eps(), &scenario.land.terrain, scenario.tick_s())
        };
        let each: Vec<_> = scenario.formations.iter().map(|graph| (graph.members(), meter(graph))).collect();
        let numbers = scenario.robots.iter().map(|robot| robot.id.0).collect();
        (!each.is_empty()).then_some(Self { each, numbers })
    }

    pub(crate) fn is_of(&self, other: &Self) -> bool {
        let mut pairs = self.each.iter().zip(&other.each);
        self.numbers == other.numbers
            && self.each.len() == other.each.len()
            && pairs.all(|((mine, one), (theirs, other))| mine == theirs && one.is_of(other))
    }

    /// Measures one tick and adds it to the means; see [`FormationMeters::look`].
    ///
    /// # Panics
    /// If there are fewer bodies than members.
    pub fn measure(&mut self, bodies: &[Member]) -> FormationQuality {
        self.over(|members, meter| meter.measure(&bodies[members]))
    }

    /// Measures the quality of all formations as [`FormationMeter::look`] does: errors are means
    /// over robots, graph distances are summed. `bodies[i]` is robot i.
    ///
    /// # Panics
    /// If there are fewer bodies than members.
    pub fn look(&mut self, bodies: &[Member]) -> FormationQuality {
        self.over(|members, meter| meter.look(&bodies[members]))
    }

    fn over(&mut self, mut one: impl FnMut(Range<usize>, &mut FormationMeter) -> FormationQuality) -> FormationQuality {
        let kept = self.each.iter_mut();
        let kept: Vec<_> = kept.map(|(members, meter)| (members.len(), one(members.clone(), meter))).collect();
        together(&kept)
    }

    /// Means over all ticks so far; `None` before the first.
    #[must_use]
    pub fn mean(&self) -> Option<FormationQuality> {
        let kept: Option<Vec<_>> =
            self.each.iter().map(|(members, meter)| Some((members.len(), meter.mean()?))).collect();
        kept.map(|kept| together(&kept))
    }

    /// Place errors of all formations together after the forming time.
    #[must_use]
    pub fn place_error(&self) -> Option<PlaceError> {
        let errors: Option<Vec<_>> =
            self.each.iter().map(|each| Some((each.0.len(), self.place_error_of(each)?))).collect();
        let errors = errors?;
        let worst = errors
            .iter()
            .map(|(_, error)| *error)
            .reduce(|worst, next| if next.worst_m > worst.worst_m { next } else { worst })?;
        Some(PlaceError { mean_m: mean_over(errors.iter().map(|(robots, error)| (*robots, error.mean_m))), ..worst })
    }

    fn place_error_of(&self, (members, meter): &(Range<usize>, FormationMeter)) -> Option<PlaceError> {
        let error = meter.place_error()?;
        let place = (error.robot as usize).checked_sub(1);
        let number = place.and_then(|place| self.numbers.get(members.start + place));
        Some(PlaceError { robot: number.copied().unwrap_or(0), ..error })
    }

    /// Quality of each formation; with place errors in metres if `has_bodies`.
    #[must_use]
    pub fn each(&self, has_bodies: bool) -> Vec<FormationKept> {
        let each = self.each.iter().map(|each| FormationKept {
            members: each.0.clone(),
            keeping: each.1.mean(),
            place_error: self.place_error_of(each).filter(|_| has_bodies),
        });
        each.collect()
    }

    /// Last distance of robot `index` from its place at its own leader ([`Member`]), cells; NaN
    /// without one.
    #[must_use]
    pub fn error_of(&self, index: usize) -> f64 {
        let own = self.each.iter().find(|(members, _)| members.contains(&index));
        let error = own.and_then(|(members, meter)| meter.errors().get(index - members.start));
        error.copied().unwrap_or(f64::NAN)
    }
}

fn together(kept: &[(usize, FormationQuality)]) -> FormationQuality {
    let mean =
        |figure: fn(&FormationQuality) -> f64| mean_over(kept.iter().map(|(robots, kept)| (*robots, figure(kept))));
    FormationQuality {
        error_per_agent: mean(|kept| kept.error_per_agent),
        best_fit_error_per_agent: mean(|kept| kept.best_fit_error_per_agent),
        graph_distance: kept.iter().map(|(_, kept)| kept.graph_distance).sum(),
    }
}

/// Mean over robots; for a single formation its own value, bit for bit.
fn mean_over(each: impl ExactSizeIterator<Item = (usize, f64)> + Clone) -> f64 {
    if each.len() == 1 {
        return each.map(|(_, value)| value).sum();
    }
    let robots: usize = each.clone().map(|(robots, _)| robots).sum();
    each.map(|(of, value)| of as f64 * value).sum::<f64>() / robots as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Overrides;

    #[test]
    fn each_formation_is_measured_at_its_own_leader() {
        let text = "name = 's'\nticks = 9\ntick_s = 6\n[terrain]\nuniform = { width = 40, height = 40, classes = 1 }\n\
            [[robots.formation]]\nrows = 1\ncolumns = 2\nstart = [4, 4]\ngoal = [4, 30]\n\
            [[robots.formation]]\nrows = 1\ncolumns = 3\nstart = [20, 4]\ngoal = [20, 30]\n";
        let scenario = Scenario::parse(text, "s.toml".as_ref(), &Overrides::default()).expect("two formations");
        let mut meters = FormationMeters::new(&scenario).expect("two formations");
        let place = |cell| Member { at: super::super::in_cells(cell), is_down: false };
        let mut bodies: Vec<_> = scenario.robots.iter().map(|robot| place(robot.start)).collect();
        // The second formation is displaced as a whole; robot 5 is off by a further (3, 4).
        bodies[2..].iter_mut().for_each(|body| body.at[1] += 11.0);
        bodies[4].at = [bodies[4].at[0] + 3.0, bodies[4].at[1] + 4.0];
        for _ in 0..2 {
            assert_eq!(meters.measure(&bodies).error_per_agent, 1.0);
        }
        assert_eq!([0, 1, 2, 3, 4, 5].map(|robot| meters.error_of(robot).to_bits()), {
            [0.0, 0.0, 0.0, 0.0, 5.0, f64::NAN].map(f64::to_bits)
        });
        let worst = PlaceError { mean_m: 1.0, worst_m: 5.0, robot: 5, at_s: 12.0 };
        assert_eq!(meters.place_error(), Some(worst));
        let each = meters.each(true);
        let errors: Vec<_> =
            each.iter().filter_map(|kept| Some((kept.members.clone(), kept.place_error?.mean_m))).collect();
        assert_eq!(errors, [(0..2, 0.0), (2..5, 5.0 / 3.0)]);
        assert_eq!(meters.each(false)[1].place_error, None);
    }
}
