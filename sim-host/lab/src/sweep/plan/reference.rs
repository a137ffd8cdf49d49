//! Values of a paper to compare with.

use super::Plan;
use crate::error::SweepError;
use crate::sweep::value::Figure;
use staya_sim::file::{TEXT, read_text};
use staya_sim::scenario::ScenarioError;
use staya_sim::shown::Shown as _;
use std::path::Path;

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
