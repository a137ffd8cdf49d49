//! Means, medians and intervals over the runs of each point.

use crate::sweep::merge::Merged;
use crate::sweep::plan::Plan;
use crate::sweep::value::{Figure, Point};
use staya_stats::Summary;

/// Aggregates all points that have runs, in order. O(rows).
#[must_use]
pub fn points(plan: &Plan, merged: &Merged) -> Vec<Point> {
    let seeds = plan.seeds();
    let by_point = merged.rows.chunk_by(|a, b| a.run / seeds == b.run / seeds);
    let point = |rows: &[crate::sweep::row::Row]| {
        let run = rows[0].run;
        let figure = |index: usize| {
            let values: Vec<f64> = rows.iter().filter_map(|row| row.figures[index].0).collect();
            Summary::of(&values)
        };
        let figures = (0..plan.measures().len()).map(figure).collect();
        let of_runs = rows.iter().map(|row| row.figures.clone()).collect();
        Point { number: run / seeds, values: plan.values_of(run), runs: rows.len(), of_runs, figures }
    };
    by_point.map(point).collect()
}

/// Formats points as CSV, one line per point and figure; `low95` and `high95` are the ends of the
/// mean's 95 % interval (Student).
#[must_use]
pub fn text(plan: &Plan, points: &[Point]) -> String {
    let statistics = "figure,runs,values,mean,low95,high95,median,deviation,min,max";
    let mut names = vec!["point".to_owned()];
    names.extend(plan.axes().map(str::to_owned));
    names.push(statistics.to_owned());
    let mut text = names.join(",") + "\n";
    let figures = plan.measures();
    for point in points {
        for (name, summary) in figures.iter().zip(&point.figures) {
            let mut cells = vec![point.number.to_string()];
            cells.extend(point.values.iter().cloned());
            cells.extend([name.clone(), point.runs.to_string()]);
            cells.push(summary.map_or(0, |summary| summary.count).to_string());
            let ends = summary.filter(|s| s.mean_error95.is_some()).map(|s| s.mean_interval95());
            let of = |figure: fn(&Summary) -> f64| summary.as_ref().map(figure);
            let figures = [
                of(|s| s.mean),
                ends.map(|[low, _]| low),
                ends.map(|[_, high]| high),
                of(|s| s.median),
                of(|s| s.deviation),
                of(|s| s.min),
                of(|s| s.max),
            ];
            cells.extend(figures.map(|figure| Figure(figure).to_string()));
            text.push_str(&cells.join(","));
            text.push('\n');
        }
    }
    text
}
