//! Conditions on the measures of a plan, and values of a paper to compare with.

use super::table::AcceptTable;
use super::{LIST, Plan};
use crate::error::SweepError;
use crate::sweep::value::{Figure, Point, Value, short};
use serde::Serialize;
use staya_sim::file::{TEXT, read_text};
use staya_sim::scenario::{ScenarioError, Source, fields};
use staya_sim::shown::Shown as _;
use std::path::Path;

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

/// Values of a paper: a table whose first columns are axes and whose others are measures.
#[derive(Clone, Debug)]
pub struct Reference {
    axes: Vec<usize>,
    measures: Vec<String>,
    rows: Vec<(Vec<String>, Vec<Figure>)>,
}

impl Reference {
    /// Reads a CSV file; lines that begin with `#` are comments.
    pub fn load(plan: &Plan, path: &Path) -> Result<Self, SweepError> {
        let text = read_text(path, TEXT).map_err(|source| ScenarioError::Io { path: path.to_owned(), source })?;
        let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !line.starts_with('#') && !line.trim().is_empty());
        let wrong = |line: usize, what: String, remedy: &str| {
            SweepError::new(format_args!("{}:{line}", path.shown()), what, remedy)
        };
        let (line, header) = lines.next().unwrap_or((1, ""));
        let names: Vec<&str> = header.split(',').collect();
        let axes: Vec<usize> = names.iter().map_while(|name| plan.find(name)).collect();
        let measures: Vec<String> = names[axes.len()..].iter().map(ToString::to_string).collect();
        if let Some(name) = measures.iter().find(|name| !plan.measures.contains(name)) {
            let remedy = "give axes, then measures of the plan";
            return Err(wrong(line, format!("{name:?} is neither an axis nor a measure"), remedy));
        }
        let mut rows = Vec::new();
        for (line, text) in lines {
            let cells: Vec<&str> = text.split(',').collect();
            let figures = cells.iter().skip(axes.len()).map(|cell| Figure::read(cell)).collect::<Option<Vec<_>>>();
            let Some(figures) = figures.filter(|_| cells.len() == names.len()) else {
                return Err(wrong(line, "it does not fit the header".to_owned(), "give a number per measure"));
            };
            rows.push((cells[..axes.len()].iter().map(ToString::to_string).collect(), figures));
        }
        Ok(Self { axes, measures, rows })
    }

    /// Value of a measure at a point with these values of the axes.
    #[must_use]
    pub fn value(&self, values: &[String], measure: &str) -> Option<f64> {
        let column = self.measures.iter().position(|name| name == measure)?;
        let is_here = |cells: &[String]| self.axes.iter().zip(cells).all(|(axis, cell)| values[*axis] == *cell);
        self.rows.iter().find(|(cells, _)| is_here(cells))?.1[column].0
    }
}

/// A condition on a measure at some points.
#[derive(Clone, Debug)]
pub struct Acceptance {
    measure: usize,
    at: Choice,
    limits: [f64; 2],
    within: Option<f64>,
    is_mean: bool,
    text: String,
}

/// Whether the runs fulfil a condition.
#[derive(Clone, Debug, Serialize)]
pub struct Verdict {
    /// Measure, points and condition.
    pub condition: String,
    /// Whether it holds at all points.
    pub holds: bool,
    /// The smallest and largest value, or the first point where it does not hold.
    pub measured: String,
}

impl Acceptance {
    pub(super) fn read(
        plan: &Plan,
        table: AcceptTable,
        source: &Source<'_>,
        field: &str,
    ) -> Result<Self, ScenarioError> {
        let AcceptTable { measure, r#where: _, equals, at_most, at_least, within, mean } = table;
        let Some(number) = plan.measures.iter().position(|name| *name == measure) else {
            let remedy = format!("name it in `measures` ({LIST})");
            return Err(source.error(&format!("{field}.measure"), format!("{measure} is not measured"), remedy));
        };
        let low = equals.or(at_least).unwrap_or(f64::NEG_INFINITY);
        let high = equals.or(at_most).unwrap_or(f64::INFINITY);
        if low > high || (equals, at_most, at_least, within) == (None, None, None, None) {
            return Err(source.error(field, "it has no limit", "give equals, at_most, at_least or within"));
        }
        if within.is_some() && plan.reference.is_none() {
            return Err(source.error(&format!("{field}.within"), "there is no reference", "name its file"));
        }
        let mut text = measure;
        let field = format!("{field}.where");
        let points = source.get(&field).and_then(|node| node.get_ref().as_table());
        if let Some(points) = points.filter(|points| !points.is_empty()) {
            text += &format!(" where {}", fields(points).collect::<Vec<_>>().join(", "));
        }
        for (name, limit) in [("=", equals), ("at most", at_most), ("at least", at_least)] {
            text += &limit.map_or(String::new(), |limit| format!(" {name} {limit}"));
        }
        text += &within.map_or(String::new(), |share| format!(" within {} % of the reference", 100.0 * share));
        if mean {
            text += " on average";
        }
        let at = Choice::read(plan, source, &field)?;
        Ok(Self { measure: number, at, limits: [low, high], within, is_mean: mean, text })
    }

    /// Limits hold for each run, or for the mean: then unless its 95 % interval lies beyond them,
    /// as for a reference.
    #[must_use]
    pub fn judge(&self, plan: &Plan, points: &[Point]) -> Verdict {
        let [mut least, mut most] = [f64::INFINITY, f64::NEG_INFINITY];
        let verdict = |holds, measured| Verdict { condition: self.text.clone(), holds, measured };
        for point in points.iter().filter(|point| self.at.has(&point.values)) {
            let here = point.values.join(" ");
            let Some(summary) = point.figures[self.measure].filter(|s| self.is_mean || s.count == point.runs) else {
                return verdict(false, format!("a run of {here} has no value"));
            };
            let mean = summary.mean_interval95();
            let [low, high] = if self.is_mean { mean } else { [summary.min, summary.max] };
            let is_inside = match self.is_mean {
                true => low <= self.limits[1] && high >= self.limits[0],
                false => low >= self.limits[0] && high <= self.limits[1],
            };
            let name = &plan.measures[self.measure];
            let expected = plan.reference.as_ref().and_then(|reference| reference.value(&point.values, name));
            let is_near = self.within.zip(expected).is_none_or(|(share, expected)| {
                mean[0] <= expected + share * expected.abs() && mean[1] >= expected - share * expected.abs()
            });
            if !is_inside || !is_near {
                return verdict(false, format!("{} at {here}", span(low, high)));
            }
            [least, most] = [least.min(low), most.max(high)];
        }
        if least > most {
            verdict(false, "there is no such point".to_owned())
        } else {
            verdict(true, span(least, most))
        }
    }
}

fn span(low: f64, high: f64) -> String {
    let [a, b] = [low, high].map(short);
    if a == b { a } else { format!("{a} to {b}") }
}
