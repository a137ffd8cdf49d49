//! Conditions on the measures of a plan.

use super::table::AcceptTable;
use super::{LIST, Plan};
use crate::sweep::value::{Figure, Point, Value, short};
use serde::{Deserialize, Serialize};
use staya_sim::scenario::{ScenarioError, Source, fields};
use staya_stats::Summary;
use std::fmt::{self, Display, Formatter};

/// Fewest runs of a point whose mean is judged: with fewer, equal values by chance would have an
/// interval of no width.
pub(super) const LEAST: usize = 5;

/// Points of a plan, by values of some axes.
#[derive(Clone, Debug, Default)]
pub struct Choice(Vec<(usize, Vec<String>)>);

impl Choice {
    /// Reads a table of axes and their values, one or a list.
    pub fn read(plan: &Plan, source: &Source<'_>, field: &str) -> Result<Self, ScenarioError> {
        let mut choice = Vec::new();
        for (name, value) in source.get(field).and_then(|node| node.get_ref().as_table()).into_iter().flatten() {
            let name = name.get_ref();
            let wrong = |what: String, remedy: String| source.error(field, what, remedy);
            let Some(axis) = plan.find(name) else {
                let axes: Vec<_> = plan.axes().collect();
                return Err(wrong(format!("{name} is not an axis"), format!("give some of {}", axes.join(", "))));
            };
            let known = &plan.axes[axis].values;
            let list = value.get_ref().as_array().map_or(std::slice::from_ref(value), |list| &list[..]);
            let mut values = Vec::new();
            for value in list {
                let value =
                    Value::read(value.get_ref()).map_err(|what| wrong(what, "give values of the axis".to_owned()))?;
                let text = value.to_string();
                if !known.iter().any(|known| known.to_string() == text) {
                    let what = format!("{text} is not a value of {name}");
                    return Err(wrong(what, "give values of the axis".to_owned()));
                }
                values.push(text);
            }
            choice.push((axis, values));
        }
        Ok(Self(choice))
    }

    /// Whether a point with these values, one per axis, is chosen.
    pub fn has(&self, values: &[String]) -> bool {
        self.0.iter().all(|(axis, chosen)| chosen.contains(&values[*axis]))
    }
}

/// A condition on a measure at some points.
#[derive(Clone, Debug)]
pub struct Acceptance {
    measure: usize,
    at: Choice,
    beside: Option<Beside>,
    limits: [f64; 2],
    within: Option<f64>,
    is_mean: bool,
    is_of_reference: bool,
    claim: String,
    paper: String,
    text: String,
    fails: Option<String>,
}

/// The other point of a comparison.
#[derive(Clone, Debug)]
enum Beside {
    /// With these values of some axes.
    Values(Vec<(usize, String)>),
    /// With the value of an axis that precedes the point's own one.
    Previous(usize),
}

/// The judgement of runs on a condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Judgement {
    /// It holds at all points.
    Holds,
    /// At some point it neither holds nor fails by the 95 % interval of the mean.
    TooFewRuns,
    /// It fails at some point.
    DoesNotHold,
}

impl Display for Judgement {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Holds => "holds",
            Self::TooFewRuns => "too few runs",
            Self::DoesNotHold => "does not hold",
        })
    }
}

/// A condition with the judgement of the runs on it, and the expected one.
#[derive(Clone, Debug, Serialize)]
pub struct Verdict {
    /// The claim that the condition expresses; empty for a condition without one.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub claim: String,
    /// The paper's figure; may be empty.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub paper: String,
    /// Measure, points and condition.
    pub condition: String,
    /// The judgement of the runs.
    pub judgement: Judgement,
    /// The smallest and largest value, or those of the point that decides.
    pub measured: String,
    /// Why the condition is known not to hold.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fails: Option<String>,
}

impl Verdict {
    /// Whether the runs show what the plan says: the condition holds, or fails as is known.
    #[must_use]
    pub fn is_expected(&self) -> bool {
        let expected = if self.fails.is_some() { Judgement::DoesNotHold } else { Judgement::Holds };
        self.judgement == expected
    }
}

impl Acceptance {
    pub(super) fn read(
        plan: &Plan,
        table: AcceptTable,
        source: &Source<'_>,
        field: &str,
    ) -> Result<Self, ScenarioError> {
        let AcceptTable { claim, paper, fails, measure, r#where: _, beside: _, previous, .. } = table;
        let AcceptTable { equals, at_most, at_least, within, mean, of_reference, .. } = table;
        let of = |name: &str| format!("{field}.{name}");
        let Some(number) = plan.measures.iter().position(|name| *name == measure) else {
            let remedy = format!("name it in `measures` ({LIST})");
            return Err(source.error(&of("measure"), format!("{measure} is not measured"), remedy));
        };
        let low = equals.or(at_least).unwrap_or(f64::NEG_INFINITY);
        let high = equals.or(at_most).unwrap_or(f64::INFINITY);
        if low > high || (equals, at_most, at_least, within) == (None, None, None, None) {
            return Err(source.error(field, "it has no limit", "give equals, at_most, at_least or within"));
        }
        if within.is_some() && plan.reference.is_none() {
            return Err(source.error(&of("within"), "there is no reference", "name its file"));
        }
        if of_reference && (plan.reference.is_none() || !mean || within.is_some()) {
            let remedy = "name the file of `reference`, and give mean = true without within";
            return Err(source.error(&of("of_reference"), "these limits are not shares of a reference", remedy));
        }
        let (at, other) = (Choice::read(plan, source, &of("where"))?, Choice::read(plan, source, &of("beside"))?);
        let beside = match (&other.0[..], &previous) {
            ([], None) => None,
            ([], Some(axis)) => {
                let remedy = format!("give one of {}", plan.axes().collect::<Vec<_>>().join(", "));
                let found = plan.find(axis);
                let found =
                    found.ok_or_else(|| source.error(&of("previous"), format!("{axis} is not an axis"), remedy))?;
                Some(Beside::Previous(found))
            }
            (others, None) => {
                let single = |(axis, values): &(usize, Vec<String>)| match &values[..] {
                    [value] => Ok((*axis, value.clone())),
                    _ => Err(source.error(&of("beside"), "an axis has several values", "give one for each")),
                };
                Some(Beside::Values(others.iter().map(single).collect::<Result<_, _>>()?))
            }
            (_, Some(_)) => {
                return Err(source.error(&of("previous"), "`beside` is given, too", "give one of them"));
            }
        };
        if beside.is_some() && !(mean && within.is_none() && !of_reference && (low >= 0.0 || low.is_infinite())) {
            let remedy = "give mean = true, and limits of 0 or more for the ratio of the means";
            return Err(source.error(field, "it compares points without means", remedy));
        }
        let mut text = measure;
        let shown = |name: &str, word: &str| {
            let points = source.get(&of(name)).and_then(|node| node.get_ref().as_table());
            let points = points.filter(|points| !points.is_empty());
            points.map_or(String::new(), |points| format!(" {word} {}", fields(points).collect::<Vec<_>>().join(", ")))
        };
        text += &shown("where", "where");
        text += &shown("beside", "over its value where");
        text += &previous.map_or(String::new(), |axis| format!(" over its value at the previous {axis}"));
        for (name, limit) in [("=", equals), ("at most", at_most), ("at least", at_least)] {
            text += &limit.map_or(String::new(), |limit| format!(" {name} {limit}"));
        }
        text += &within.map_or(String::new(), |share| format!(" within {} % of the reference", short(100.0 * share)));
        if of_reference {
            text += " of the reference";
        }
        if mean {
            text += " on average";
        }
        let limits = [low, high];
        Ok(Self {
            measure: number,
            at,
            beside,
            limits,
            within,
            is_mean: mean,
            is_of_reference: of_reference,
            claim,
            paper,
            text,
            fails,
        })
    }

    /// The verdict with this judgement.
    #[must_use]
    pub fn verdict(&self, judgement: Judgement, measured: String) -> Verdict {
        Verdict {
            claim: self.claim.clone(),
            paper: self.paper.clone(),
            condition: self.text.clone(),
            judgement,
            measured,
            fails: self.fails.clone(),
        }
    }

    /// Limits hold for each run, or for the mean: then its whole 95 % interval must lie inside. It
    /// fails where that lies outside, and needs more runs between. So it is with a reference.
    #[must_use]
    pub fn judge(&self, plan: &Plan, points: &[Point]) -> Verdict {
        let verdict = |judgement, measured| self.verdict(judgement, measured);
        let (mut worst, mut spread) = (None::<(Judgement, String)>, None::<[f64; 2]>);
        for point in points.iter().filter(|point| self.at.has(&point.values)) {
            let here = point.values.join(" ");
            let found = match &self.beside {
                None => self.alone(plan, point),
                Some(beside) => {
                    let Some(other) = beside.of(plan, points, point) else { continue };
                    self.compared([point, other])
                }
            };
            let Some((judgement, [low, high])) = found else {
                return verdict(Judgement::DoesNotHold, format!("a run or the reference of {here} has no value"));
            };
            if judgement > worst.as_ref().map_or(Judgement::Holds, |(worst, _)| *worst) {
                worst = Some((judgement, format!("{} at {here}", span(low, high))));
            }
            spread = Some(spread.map_or([low, high], |[least, most]| [least.min(low), most.max(high)]));
        }
        match (worst, spread) {
            (Some((judgement, measured)), _) => verdict(judgement, measured),
            (None, Some([low, high])) => verdict(Judgement::Holds, span(low, high)),
            (None, None) => verdict(Judgement::DoesNotHold, "there is no such point".to_owned()),
        }
    }

    fn alone(&self, plan: &Plan, point: &Point) -> Option<(Judgement, [f64; 2])> {
        let summary = point.figures[self.measure].filter(|summary| self.is_mean || summary.count == point.runs)?;
        let [low, high] = self.limits;
        if self.is_of_reference {
            let value = plan.reference.as_ref()?.value(&point.values, &plan.measures[self.measure])?;
            let share = summary.of_unit(value);
            return Some((of_mean(&share, self.limits), share.mean_interval95()));
        }
        let expected = plan.reference.as_ref().zip(self.within).and_then(|(reference, share)| {
            let value = reference.value(&point.values, &plan.measures[self.measure])?;
            Some([value - share * value.abs(), value + share * value.abs()])
        });
        let near = expected.map(|limits| of_mean(&summary, limits));
        let (judgement, shown) = if self.is_mean || expected.is_some() {
            (of_mean(&summary, self.limits), summary.mean_interval95())
        } else {
            let is_inside = low <= summary.min && summary.max <= high;
            let judgement = if is_inside { Judgement::Holds } else { Judgement::DoesNotHold };
            (judgement, [summary.min, summary.max])
        };
        Some((near.map_or(judgement, |near| near.max(judgement)), shown))
    }

    /// The ratio of the means of two points whose runs have the same seeds, by the interval of the
    /// mean of x - limit * y.
    fn compared(&self, [point, other]: [&Point; 2]) -> Option<(Judgement, [f64; 2])> {
        let value = |figures: &Vec<Figure>| figures.get(self.measure)?.0;
        let runs = point.of_runs.iter().zip(&other.of_runs);
        let pairs: Vec<_> = runs.map(|(x, y)| value(x).zip(value(y))).collect::<Option<_>>()?;
        let [low, high] = self.limits;
        let side = |limit: f64, limits: [f64; 2]| {
            let rest: Vec<f64> = pairs.iter().map(|(x, y)| x - limit * y).collect();
            Summary::of(&rest).map(|rest| of_mean(&rest, limits))
        };
        let least = if low.is_finite() { side(low, [0.0, f64::INFINITY])? } else { Judgement::Holds };
        let most = if high.is_finite() { side(high, [f64::NEG_INFINITY, 0.0])? } else { Judgement::Holds };
        let sum = pairs.iter().fold((0.0, 0.0), |sum, pair| (sum.0 + pair.0, sum.1 + pair.1));
        let ratio = sum.0 / sum.1;
        Some((least.max(most), [ratio, ratio]))
    }
}

impl Beside {
    /// The point that another one is compared with. Axes that advance with a changed one follow it.
    fn of<'a>(&self, plan: &Plan, points: &'a [Point], point: &Point) -> Option<&'a Point> {
        let others = match self {
            Self::Values(others) => others.clone(),
            Self::Previous(axis) => {
                let known = &plan.axes[*axis].values;
                let at = known.iter().position(|value| value.to_string() == point.values[*axis])?;
                vec![(*axis, known[at.checked_sub(1)?].to_string())]
            }
        };
        let follows = |axis: usize| {
            let group = plan.groups.iter().find(|group| group.contains(&axis));
            group.is_some_and(|group| others.iter().any(|(changed, _)| group.contains(changed)))
        };
        let is_it = |other: &&Point| {
            let has = others.iter().all(|(axis, value)| other.values[*axis] == *value);
            let is_else_equal =
                (0..point.values.len()).all(|axis| follows(axis) || other.values[axis] == point.values[axis]);
            has && is_else_equal && other.number != point.number
        };
        points.iter().find(is_it)
    }
}

/// Whether the 95 % interval of a mean lies inside limits, outside, or needs more runs.
fn of_mean(summary: &Summary, [low, high]: [f64; 2]) -> Judgement {
    let [least, most] = summary.mean_interval95();
    if most < low || least > high {
        Judgement::DoesNotHold
    } else if summary.count >= LEAST && low <= least && most <= high {
        Judgement::Holds
    } else {
        Judgement::TooFewRuns
    }
}

fn span(low: f64, high: f64) -> String {
    let [a, b] = [low, high].map(short);
    if a == b { a } else { format!("{a} to {b}") }
}

#[cfg(test)]
mod tests;
