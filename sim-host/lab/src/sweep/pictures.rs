//! Charts of figures over one or two axes.

use crate::sweep::merge::Merged;
use crate::sweep::plan::{Plan, PlotTable};
use crate::sweep::value::{Figure, Value};
use staya_plot::{Chart, HeatMap, Series};
use staya_sim::record::Error;
use staya_stats::{Goodness, Histogram, NortonRice, Summary};
use std::path::{Path, PathBuf};

const MOST: usize = 24;
const PARTS: [usize; 2] = [4, 12];
/// Average number of runs per part or cell, if there are enough.
const RUNS: usize = 4;
const CURVES: usize = 6;
const UNASKED: usize = 8;
const BINS: usize = 30;
/// Ends of names of fields and figures, and their units.
const UNITS: [(&str, &str); 8] = [
    ("s", "s"),
    ("seconds", "s"),
    ("ms", "ms"),
    ("m", "m"),
    ("mps", "m/s"),
    ("mps2", "m/s²"),
    ("percent", "%"),
    ("cells", "cells"),
];

/// Pictures that a plan requests, also over axes of the command line; by default its first figures
/// over its first two axes.
#[must_use]
pub fn plots(plan: &Plan) -> Vec<PlotTable> {
    if !plan.plots.is_empty() {
        let mut plots = plan.plots.clone();
        for (axis, plot) in plan.added().flat_map(|axis| plan.plots.iter().map(move |plot| (axis, plot))) {
            let (figure, and) = (plot.figure.clone(), Some(plot.over.clone()));
            let plot = PlotTable { figure, over: axis.to_owned(), and, log: false };
            if !plots.contains(&plot) {
                plots.push(plot);
            }
        }
        return plots;
    }
    let varies = |axis: &&str| plan.values(axis).is_some_and(|values| values.iter().any(|value| value != &values[0]));
    let mut axes = plan.axes().filter(varies).map(str::to_owned);
    let (Some(over), and) = (axes.next(), axes.next()) else {
        return Vec::new();
    };
    let plot = |figure: &String| PlotTable { figure: figure.clone(), over: over.clone(), and: and.clone(), log: false };
    if plan.measures().len() <= UNASKED {
        return plan.measures().iter().map(plot).collect();
    }
    let usual = ["arrived", "arrival_last_seconds", "collisions", "formation_error_per_agent", "least_gap_m"];
    plan.measures().iter().filter(|name| usual.contains(&name.as_str())).map(plot).collect()
}

/// Draws a picture into a folder, as SVG and PNG.
///
/// # Errors
/// A file cannot be written.
///
/// # Panics
/// If the plan has no such figure or axis: see [`Plan::check_plot`].
pub fn draw(plan: &Plan, merged: &Merged, plot: &PlotTable, folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let figure = plan.measures().iter().position(|name| *name == plot.figure).expect("a figure that was checked");
    let find = |axis: &String| plan.find(axis).expect("an axis that was checked");
    let over = find(&plot.over);
    let and = plot.and.as_ref().map(find);
    let values = |run: u64, axis: usize| plan.run(run).values[axis].clone();
    let rows: Vec<(Value, Option<Value>, f64)> = merged
        .rows
        .iter()
        .filter_map(|row| {
            let value = row.figures[figure].0.filter(|value| value.is_finite())?;
            Some((values(row.run, over), and.map(|axis| values(row.run, axis)), value))
        })
        .collect();
    let parts = if and.is_some() { (rows.len() / RUNS).isqrt() } else { rows.len() / RUNS };
    let levels = |axis| Levels::new(plan, axis, parts.clamp(PARTS[0], PARTS[1]));
    let (x, y) = (levels(over), and.map(levels));
    let picture = Picture { plan, plot, rows, x, y, reference: reference(plan, merged, &plot.figure, over) };
    let stem = folder.join(picture.file_name());
    match &picture.y {
        Some(y) if y.is_parts || y.names.len() > CURVES || picture.x.numbers.is_none() => {
            picture.heat_map(y).draw().write(&stem)
        }
        _ => picture.chart().draw().write(&stem),
    }
}

/// Values of a paper over an axis of numbers, with the first values of the other axes.
fn reference(plan: &Plan, merged: &Merged, figure: &str, over: usize) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    for row in &merged.rows {
        let value = plan.reference.as_ref().and_then(|it| it.value(&plan.values_of(row.run), figure));
        let Some((x, y)) = plan.run(row.run).values[over].number().zip(value) else { continue };
        if points.iter().all(|point| point[0] != x) {
            points.push([x, y]);
        }
    }
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points
}

/// Draws the distribution of a figure over the runs of each chosen point, with the Norton-Rice law
/// of largest likelihood and its chi-square test (KUZ, figure 4).
///
/// # Errors
/// A file cannot be written.
pub fn histograms(plan: &Plan, merged: &Merged, folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let mut files = Vec::new();
    for (name, choice) in &plan.histograms {
        let Some(figure) = plan.measures().iter().position(|it| it == name) else { continue };
        let seeds = plan.seeds();
        for rows in merged.rows.chunk_by(|a, b| a.run / seeds == b.run / seeds) {
            let point = plan.values_of(rows[0].run);
            let values: Vec<f64> = rows.iter().filter_map(|row| row.figures[figure].0).collect();
            let at: Vec<_> = plan.axes().zip(&point).map(|(axis, value)| valued(axis, value)).collect();
            let title = format!("{}: {} of {} runs, {}", plan.name, worded(name), values.len(), at.join(", "));
            let chart = choice.has(&point).then(|| histogram(&title, name, &values)).flatten();
            if let Some(chart) = chart {
                files.extend(chart.draw().write(&folder.join(format!("{name}-{}", point.join("-"))))?);
            }
        }
    }
    Ok(files)
}

fn histogram(title: &str, name: &str, values: &[f64]) -> Option<Chart> {
    let Histogram { low, width, counts } = Histogram::new(values, BINS)?;
    let edge = |bin: usize| low + bin as f64 * width;
    let bars = counts.iter().enumerate().map(|(bin, &count)| [edge(bin), edge(bin + 1), count as f64]);
    let mut chart = Chart::new(title, worded(name), "runs").with(Series::bars("runs", bars));
    let Ok(law) = NortonRice::fit(values) else { return Some(chart) };
    let area = values.len() as f64 * width;
    let curve = (0..=200).map(|i| {
        let x = low + (edge(counts.len()) - low) * f64::from(i) / 200.0;
        [x, area * law.pdf(x)]
    });
    chart = chart.with(Series::line("Norton-Rice law", curve));
    if let Some(Goodness { chi2, freedom, p_value, .. }) = law.goodness(values) {
        let [m, alpha, beta] = [law.m(), law.alpha(), law.beta()];
        let test = format!("chi-square {chi2:.1} with {freedom} degrees of freedom, p = {p_value:.3}");
        chart.note = format!("m = {m:.2}, alpha = {alpha:.2}, beta = {beta:.2}; {test}");
    }
    Some(chart)
}

struct Levels {
    names: Vec<String>,
    numbers: Option<Vec<f64>>,
    is_parts: bool,
    is_log: bool,
    ends: [f64; 2],
}

impl Levels {
    fn new(plan: &Plan, axis: usize, parts: usize) -> Self {
        let name = plan.axes().nth(axis).unwrap_or_default();
        let mut values: Vec<Value> = plan.values(name).unwrap_or_default().to_vec();
        let numbers: Option<Vec<f64>> = values.iter().map(Value::number).collect();
        let Some(mut numbers) = numbers else {
            let mut names: Vec<String> = Vec::new();
            for value in values.drain(..).map(|value| value.to_string()) {
                if !names.contains(&value) {
                    names.push(value);
                }
            }
            return Self { names, numbers: None, is_parts: false, is_log: false, ends: [0.0; 2] };
        };
        numbers.sort_by(f64::total_cmp);
        numbers.dedup();
        let is_log = plan.is_log(axis) || is_crowded(&numbers);
        let ends = [numbers[0], numbers[numbers.len() - 1]];
        let is_parts = numbers.len() > MOST;
        if is_parts {
            let at = |share: f64| {
                let [low, high] = ends;
                if is_log { low * libm::pow(high / low, share) } else { low + (high - low) * share }
            };
            numbers = (0..parts).map(|part| at((part as f64 + 0.5) / parts as f64)).collect();
        }
        let name = |number: &f64| if is_parts { short(*number) } else { Figure(Some(*number)).to_string() };
        Self { names: numbers.iter().map(name).collect(), numbers: Some(numbers), is_parts, is_log, ends }
    }

    fn of(&self, value: &Value) -> usize {
        let Some((number, numbers)) = value.number().zip(self.numbers.as_ref()) else {
            let name = value.to_string();
            return self.names.iter().position(|known| *known == name).unwrap_or_default();
        };
        if !self.is_parts {
            return numbers.iter().position(|known| *known == number).unwrap_or_default();
        }
        let [low, high] = self.ends;
        let share =
            if self.is_log { libm::log(number / low) / libm::log(high / low) } else { (number - low) / (high - low) };
        ((share * self.names.len() as f64) as usize).min(self.names.len() - 1)
    }
}

/// Whether most of these sorted numbers would be in the first quarter of a linear axis.
fn is_crowded(numbers: &[f64]) -> bool {
    let [low, .., high] = numbers else { return false };
    *low > 0.0 && numbers.len() > 3 && numbers[numbers.len() / 2] < low + (high - low) / 4.0
}

/// The words and the unit of a field or figure: "orca horizon (s)" of `plane.orca.horizon_s`.
fn worded(path: &str) -> String {
    let parts: Vec<&str> = path.split('.').collect();
    let joined = parts[parts.len().saturating_sub(2)..].join("_");
    let mut words: Vec<&str> = joined.split(['_', '[', ']']).filter(|word| !word.is_empty()).collect();
    if let ["arrival", which, "seconds"] = words[..] {
        words = vec![which, "arrival", "s"];
    }
    words.iter_mut().filter(|word| **word == "us").for_each(|word| *word = "µs");
    let unit = words.last().and_then(|last| UNITS.iter().find(|(end, _)| end == last));
    match unit {
        Some((_, unit)) if words.len() > 1 && words[words.len() - 2] != "per" => {
            words.pop();
            format!("{} ({unit})", words.join(" "))
        }
        _ => words.join(" "),
    }
}

/// A field and its value: "orca horizon = 3 s".
pub fn valued(path: &str, value: impl std::fmt::Display) -> String {
    let words = worded(path);
    match words.strip_suffix(')').and_then(|words| words.split_once(" (")) {
        Some((words, unit)) => format!("{words} = {value} {unit}"),
        None => format!("{words} = {value}"),
    }
}

fn short(number: f64) -> String {
    let rounded: f64 = format!("{number:.2e}").parse().unwrap_or(number);
    Figure(Some(rounded)).to_string()
}

struct Picture<'a> {
    plan: &'a Plan,
    plot: &'a PlotTable,
    rows: Vec<(Value, Option<Value>, f64)>,
    x: Levels,
    y: Option<Levels>,
    reference: Vec<[f64; 2]>,
}

impl Picture<'_> {
    fn file_name(&self) -> String {
        let PlotTable { figure, over, and, .. } = self.plot;
        let and = and.as_ref().map_or(String::new(), |and| format!("-and-{and}"));
        format!("{figure}-over-{over}{and}").replace('[', ".").replace(']', "")
    }

    fn title(&self) -> String {
        let PlotTable { figure, over, and, .. } = self.plot;
        let and = and.as_ref().map_or(String::new(), |and| format!(" and {}", worded(and)));
        format!("{}: {} over {}{and}", self.plan.name, worded(figure), worded(over))
    }

    fn note(&self, what: &str) -> String {
        let others = self.plan.axes().filter(|axis| *axis != self.plot.over && Some(*axis) != self.plot.and.as_deref());
        let others: Vec<String> = others.map(worded).collect();
        let over =
            if others.is_empty() { String::new() } else { format!(", over all values of {}", others.join(", ")) };
        let points = self.x.names.len() * self.y.as_ref().map_or(1, |levels| levels.names.len());
        let runs = match self.rows.len() {
            0 => return "no run has this figure".to_owned(),
            runs if runs == points => return format!("one run each{over}"),
            runs if runs.is_multiple_of(points) => format!("{} runs each", runs / points),
            runs => format!("{runs} runs in all"),
        };
        format!("{what} of {runs}{over}")
    }

    fn summary(&self, x: usize, y: Option<usize>) -> Option<Summary> {
        let is_here = |(over, and, _): &&(Value, Option<Value>, f64)| {
            let at_y = self.y.as_ref().zip(and.as_ref()).map(|(levels, value)| levels.of(value));
            self.x.of(over) == x && (y.is_none() || at_y == y)
        };
        let figures: Vec<f64> = self.rows.iter().filter(is_here).map(|(.., figure)| *figure).collect();
        Summary::of(&figures)
    }

    fn chart(&self) -> Chart {
        let PlotTable { figure, over, and, .. } = self.plot;
        let mut chart = Chart::new(self.title(), worded(over), worded(figure));
        chart.note = self.note("means with 95 % intervals");
        (chart.log_x, chart.log_y) = (self.x.is_log || self.plot.log, self.plot.log);
        // The interval of a count ends at 0.
        let is_positive = self.rows.iter().all(|(.., figure)| *figure >= 0.0);
        let least = if is_positive { 0.0 } else { f64::NEG_INFINITY };
        let point = |at: f64, summary: &Summary| {
            let [low, high] = summary.mean_interval95();
            [at, summary.mean, low.max(least), high]
        };
        let Some(numbers) = &self.x.numbers else {
            let summaries =
                (0..self.x.names.len()).filter_map(|index| Some((index as f64 + 1.0, self.summary(index, None)?)));
            let points = summaries.map(|(at, summary)| point(at, &summary));
            return chart.with(Series::intervals("", points)).names(self.x.names.clone());
        };
        let curve = |y: Option<usize>| {
            let points = numbers.iter().enumerate().filter_map(|(x, &at)| Some(point(at, &self.summary(x, y)?)));
            points.collect::<Vec<_>>()
        };
        match (&self.y, and) {
            (Some(levels), Some(and)) => {
                for (y, name) in levels.names.iter().enumerate() {
                    chart = chart.with(Series::intervals(valued(and, name), curve(Some(y))).joined());
                }
            }
            _ => {
                if self.x.is_parts {
                    let each = self.rows.iter().filter_map(|(over, _, figure)| Some([over.number()?, *figure]));
                    chart = chart.with(Series::points("runs", each).colour(staya_plot::colour::MUTED));
                }
                chart = chart.with(
                    Series::intervals(if self.x.is_parts { "parts of the axis" } else { "" }, curve(None)).joined(),
                );
            }
        }
        if !self.reference.is_empty() {
            chart = chart.with(Series::reference("paper", self.reference.iter().copied()));
        }
        chart
    }

    fn heat_map(&self, levels: &Levels) -> HeatMap {
        let columns = self.x.names.len();
        let value = |index: usize| Some(self.summary(index % columns, Some(index / columns))?.mean);
        HeatMap {
            title: self.title(),
            note: self.note("means"),
            x_label: worded(&self.plot.over),
            y_label: self.plot.and.as_deref().map_or(String::new(), worded),
            columns: self.x.names.clone(),
            rows: levels.names.clone(),
            values: (0..columns * levels.names.len()).map(value).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_fields_and_figures_become_words_and_units() {
        let words = [
            ("plane.orca.horizon_s", "orca horizon (s)"),
            ("arrival_last_seconds", "last arrival (s)"),
            ("flow.per_s", "flow per s"),
            ("terrain.change[0].drift.share", "drift share"),
            ("collisions", "collisions"),
        ];
        for (path, text) in words {
            assert_eq!(worded(path), text, "{path}");
        }
        assert_eq!(valued("plane.orca.horizon_s", 3), "orca horizon = 3 s");
        assert_eq!(valued("radio.loss", "0.5"), "radio loss = 0.5");
        assert_eq!(worded("us_per_boid"), "µs per boid");
    }

    #[test]
    fn an_axis_of_powers_is_logarithmic() {
        assert!(is_crowded(&[0.5, 1.0, 2.0, 4.0, 8.0]));
        for even in [&[1.0, 2.0, 3.0, 4.0][..], &[0.0, 0.1, 1.0, 10.0], &[1.0, 10.0, 100.0]] {
            assert!(!is_crowded(even), "{even:?}");
        }
    }
}
