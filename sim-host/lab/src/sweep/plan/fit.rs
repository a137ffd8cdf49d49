//! Laws fitted to the measures of a plan.

use super::accept::{Choice, Judgement, LEAST, Verdict};
use super::table::{FitTable, Law};
use super::{LIST, Plan};
use crate::sweep::value::{Figure, Point, short};
use staya_sim::scenario::{ScenarioError, Source, fields};
use staya_stats::{Goodness, Line, NortonRice, Summary};

/// A law that a measure follows, and how well it must.
#[derive(Clone, Debug)]
pub struct Fit {
    measure: usize,
    at: Choice,
    kind: Kind,
    least: f64,
    claim: String,
    paper: String,
    text: String,
    fails: Option<String>,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Over this axis.
    Logarithm(usize),
    NortonRice,
}

/// The judgement on one fit, and its values.
type Found = (Judgement, String);

/// ln(x + 1) and the mean there, with the summary of its runs.
type Curve = Vec<([f64; 2], Summary)>;

impl Fit {
    pub(super) fn read(plan: &Plan, table: FitTable, source: &Source<'_>, field: &str) -> Result<Self, ScenarioError> {
        let FitTable { claim, paper, fails, figure, law, over, at_least: least, r#where: _ } = table;
        let of = |name: &str| format!("{field}.{name}");
        let Some(measure) = plan.measures.iter().position(|name| *name == figure) else {
            let remedy = format!("name it in `measures` ({LIST})");
            return Err(source.error(&of("figure"), format!("{figure} is not measured"), remedy));
        };
        if !(least > 0.0 && least < 1.0) {
            let what = format!("{least} is not between 0 and 1");
            return Err(source.error(&of("at_least"), what, "give a limit that some fits reach and others miss"));
        }
        let axes = || format!("give one of {}", plan.axes().collect::<Vec<_>>().join(", "));
        let (kind, quality) = match (law, &over) {
            (Law::NortonRice, None) => (Kind::NortonRice, "p"),
            (Law::NortonRice, Some(_)) => {
                return Err(source.error(&of("over"), "norton_rice is about the runs of a point", "leave it out"));
            }
            (Law::Logarithm, None) => return Err(source.error(field, "logarithm needs `over`", axes())),
            (Law::Logarithm, Some(over)) => {
                let axis = plan.find(over);
                let axis = axis.ok_or_else(|| source.error(&of("over"), format!("{over} is not an axis"), axes()))?;
                (Kind::Logarithm(axis), "R2")
            }
        };
        let law = match over {
            Some(over) => format!("a ln({over} + 1) + b"),
            None => "Norton-Rice law".to_owned(),
        };
        let at = Choice::read(plan, source, &of("where"))?;
        let points = source.get(&of("where")).and_then(|node| node.get_ref().as_table());
        let points = points.filter(|points| !points.is_empty());
        let shown =
            points.map_or(String::new(), |points| format!(" where {}", fields(points).collect::<Vec<_>>().join(", ")));
        let text = format!("{figure}{shown} follows {law}, {quality} at least {least}");
        Ok(Self { measure, at, kind, least, claim, paper, text, fails })
    }

    /// Each curve, or each point, must follow the law.
    #[must_use]
    pub fn judge(&self, points: &[Point]) -> Verdict {
        let chosen: Vec<&Point> = points.iter().filter(|point| self.at.has(&point.values)).collect();
        let found: Vec<Found> = match self.kind {
            Kind::Logarithm(axis) => self.curves(axis, &chosen),
            Kind::NortonRice => chosen.iter().map(|point| self.distribution(point)).collect(),
        };
        let worst = found.iter().map(|(judgement, _)| *judgement).max();
        let measured: Vec<String> = found.into_iter().map(|(_, measured)| measured).collect();
        let measured = if measured.is_empty() { "there is no such point".to_owned() } else { measured.join("; ") };
        self.verdict(worst.unwrap_or(Judgement::DoesNotHold), measured)
    }

    /// The verdict with this judgement.
    #[must_use]
    pub fn verdict(&self, judgement: Judgement, measured: String) -> Verdict {
        let (claim, paper, condition) = (self.claim.clone(), self.paper.clone(), self.text.clone());
        Verdict { claim, paper, condition, judgement, measured, fails: self.fails.clone() }
    }

    /// The means over the axis, for each combination of the other axes.
    fn curves(&self, axis: usize, points: &[&Point]) -> Vec<Found> {
        let mut curves: Vec<(String, Curve)> = Vec::new();
        for point in points {
            let mut others = point.values.clone();
            let value = others.remove(axis).parse().ok().zip(point.figures[self.measure]);
            let Some((x, figure)) = value else { continue };
            let others = others.join(" ");
            let at = ([libm::log1p(x), figure.mean], figure);
            match curves.iter_mut().find(|(known, _)| *known == others) {
                Some((_, curve)) => curve.push(at),
                None => curves.push((others, vec![at])),
            }
        }
        curves.into_iter().map(|(others, curve)| self.curve(&others, &curve)).collect()
    }

    fn curve(&self, others: &str, curve: &[([f64; 2], Summary)]) -> Found {
        let place = if others.is_empty() { String::new() } else { format!(" at {others}") };
        let means: Vec<[f64; 2]> = curve.iter().map(|(at, _)| *at).collect();
        let Some(Line { slope, intercept, r2 }) = Line::fit(&means) else {
            return (Judgement::DoesNotHold, format!("no fit{place}"));
        };
        let sign = if intercept < 0.0 { '-' } else { '+' };
        let shown = format!("{} ln(x + 1) {sign} {}, R2 {}{place}", short(slope), short(intercept.abs()), short(r2));
        // A line through all intervals may only miss the means by their noise.
        let is_inside = |([x, _], figure): &([f64; 2], Summary)| {
            let [low, high] = figure.mean_interval95();
            (low..=high).contains(&(slope * x + intercept))
        };
        let is_noise = r2 < self.least && curve.iter().all(is_inside);
        let is_sure = !is_noise && curve.iter().all(|(_, figure)| figure.count >= LEAST);
        (judgement(r2, self.least, is_sure), shown)
    }

    /// The law of largest likelihood for the runs of a point, with its chi-square test.
    fn distribution(&self, point: &Point) -> Found {
        let here = point.values.join(" ");
        let value = |figures: &Vec<Figure>| figures.get(self.measure)?.0;
        let values: Option<Vec<f64>> = point.of_runs.iter().map(value).collect();
        let Some(values) = values else {
            return (Judgement::DoesNotHold, format!("a run of {here} has no value"));
        };
        let law = match NortonRice::fit(&values) {
            Ok(law) => law,
            Err(why) => return (Judgement::TooFewRuns, format!("{why} at {here}")),
        };
        let [m, alpha, beta] = [law.m(), law.alpha(), law.beta()].map(short);
        let limit = if law.is_degenerate() { ", degenerate" } else { "" };
        let shown = format!("m {m}, alpha {alpha}, beta {beta}{limit} at {here}");
        match law.goodness(&values) {
            Some(Goodness { p_value, .. }) => {
                (judgement(p_value, self.least, true), format!("p {}: {shown}", short(p_value)))
            }
            None => (Judgement::TooFewRuns, format!("too few values for a test: {shown}")),
        }
    }
}

fn judgement(value: f64, least: f64, is_sure: bool) -> Judgement {
    match is_sure {
        false => Judgement::TooFewRuns,
        true if value >= least => Judgement::Holds,
        true => Judgement::DoesNotHold,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::aggregate::points;
    use crate::sweep::merge::Merged;
    use crate::sweep::plan::Changes;
    use crate::sweep::row::{Outcome, Row};
    use std::fs;

    const SCENARIO: &str = "name = 'walk'\nterrain.uniform = { width = 9, height = 9 }\n\
        robots.list = [{ start = [1, 1], goal = [7, 7] }]\n";

    fn plan(fit: &str, seeds: usize) -> Result<Plan, String> {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("walk.toml"), SCENARIO).expect("room");
        let text = format!(
            "name = 'p'\nscenario = 'walk.toml'\nseeds = {seeds}\nmeasures = ['arrived']\n\
             [axes]\nticks = [1, 2, 4, 8]\n[[fit]]\nfigure = 'arrived'\n{fit}\n"
        );
        let path = folder.path().join("plan.toml");
        Plan::parse(&text, &path, &Changes::default()).map_err(|error| error.to_string())
    }

    /// Judges runs whose figure is a function of the axis and the number of the seed.
    fn verdict(fit: &str, seeds: usize, figure: impl Fn(f64, u64) -> Option<f64>) -> Verdict {
        let plan = plan(fit, seeds).expect("a plan");
        let row = |run| {
            let ticks = plan.run(run).values[0].number().expect("a number");
            let figures = vec![Figure(figure(ticks, run % plan.seeds()))];
            Row { run, outcome: Outcome::Done, figures, trace_hash: String::new() }
        };
        let rows: Vec<Row> = (0..plan.runs()).map(row).collect();
        let merged = Merged { rows, ..Merged::default() };
        plan.fits[0].judge(&points(&plan, &merged))
    }

    #[test]
    fn a_curve_over_a_logarithm_is_found_and_another_one_is_refused() {
        let fit = "law = 'logarithm'\nover = 'ticks'\nat_least = 0.95";
        let curve = verdict(fit, 5, |ticks, _| Some(2.0 * libm::log1p(ticks) - 0.5));
        assert_eq!((curve.judgement, &*curve.measured), (Judgement::Holds, "2 ln(x + 1) - 0.5, R2 1"));
        assert_eq!(verdict(fit, 4, |ticks, _| Some(libm::log1p(ticks))).judgement, Judgement::TooFewRuns);
        // Means 1, 9, 3 and 7, each of runs that differ by much more.
        let noise = |ticks: f64, seed: u64| {
            let mean = [1.0, 9.0, 3.0, 7.0][libm::log2(ticks) as usize];
            Some(mean + 100.0 * (seed as f64 - 2.0))
        };
        assert_eq!(verdict(fit, 5, noise).judgement, Judgement::TooFewRuns, "noise");
        let other = verdict(fit, 5, |ticks, _| Some(if ticks == 2.0 { 9.0 } else { ticks }));
        assert_eq!(other.judgement, Judgement::DoesNotHold);
        let chosen = verdict(&format!("{fit}\nwhere = {{ ticks = [1, 2] }}"), 5, |ticks, _| Some(ticks));
        assert_eq!((chosen.judgement, &*chosen.measured), (Judgement::DoesNotHold, "no fit"), "two points");
        assert_eq!(verdict(fit, 5, |_, _| None).judgement, Judgement::DoesNotHold);
    }

    #[test]
    fn a_distribution_is_tested_for_each_point_and_needs_enough_runs() {
        let fit = "law = 'norton_rice'\nat_least = 0.05\nwhere = { ticks = [2, 4] }";
        // Quantiles of Rayleigh's law, Norton-Rice with m = 1 and without location.
        let rayleigh = |_: f64, seed: u64| Some(300.0 * libm::sqrt(-libm::log((seed as f64 + 0.5) / 200.0)));
        let found = verdict(fit, 200, rayleigh);
        assert_eq!(found.judgement, Judgement::Holds, "{}", found.measured);
        assert_eq!(found.measured.matches("p ").count(), 2, "{}", found.measured);
        let two = |_: f64, seed: u64| Some(if seed.is_multiple_of(2) { 10.0 } else { 1000.0 } + seed as f64);
        assert_eq!(verdict(fit, 200, two).judgement, Judgement::DoesNotHold);
        assert_eq!(verdict(fit, 9, rayleigh).judgement, Judgement::TooFewRuns);
        assert_eq!(verdict(fit, 30, rayleigh).judgement, Judgement::TooFewRuns);
        let lost = |ticks: f64, seed: u64| rayleigh(ticks, seed).filter(|_| seed > 0);
        assert_eq!(verdict(fit, 200, lost).judgement, Judgement::DoesNotHold, "a run has no value");
    }

    #[test]
    fn fits_without_axis_or_limit_are_refused() {
        for (fit, expected) in [
            ("law = 'logarithm'\nat_least = 0.9", "logarithm needs `over`"),
            ("law = 'logarithm'\nover = 'tocks'\nat_least = 0.9", "tocks is not an axis"),
            ("law = 'norton_rice'\nover = 'ticks'\nat_least = 0.9", "is about the runs of a point"),
            ("law = 'norton_rice'\nat_least = 0", "0 is not between 0 and 1"),
            ("law = 'line'\nat_least = 0.9", "law"),
        ] {
            let error = plan(fit, 5).expect_err(fit);
            assert!(error.contains(expected), "{error}");
        }
    }
}
