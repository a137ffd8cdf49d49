//! Other laws compared with ours.

use super::{Journey, Point, Report};
use crate::experiment::Maybe;
use crate::formation::laws::Law;
use serde::Serialize;
use staya_plot::{Chart, Panels, Series};
use std::fmt::{self, Formatter};

/// Results with another law.
#[derive(Clone, Debug, Serialize)]
pub struct LawJourney {
    /// The law.
    pub law: Law,
    /// Results of the crossings.
    #[serde(flatten)]
    pub journey: Journey,
}

impl Point {
    fn under(&self, law: Law, loss: f64) -> Option<&Journey> {
        if law == Law::Staya {
            return self.with_loss(loss);
        }
        let mut others = self.other_laws.iter().filter(|other| other.law == law);
        others.find(|other| other.journey.loss == loss).map(|other| &other.journey)
    }

    fn with_loss(&self, loss: f64) -> Option<&Journey> {
        [&self.formation].into_iter().chain(&self.other_losses).find(|journey| journey.loss == loss)
    }
}

impl Report {
    fn laws(&self) -> (Vec<Law>, Vec<f64>) {
        let tried = self.points.first().map_or(&[][..], |point| &point.other_laws);
        let has = |law: Law| law == Law::Staya || tried.iter().any(|other| other.law == law);
        let mut losses: Vec<f64> = tried.iter().map(|other| other.journey.loss).collect();
        losses.sort_by(f64::total_cmp);
        losses.dedup();
        (Law::ALL.into_iter().filter(|&law| has(law)).collect(), losses)
    }

    pub(super) fn write_laws(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (laws, losses) = self.laws();
        if losses.is_empty() {
            return Ok(());
        }
        f.write_str("\nother laws on the same landscapes; staya: ours as above; lookahead: ours, followers plan their way to where their\n")?;
        f.write_str("places will be; loose: the same, the leader waits from 12 cells on; shared: ours, maps shared over the radio; unwaiting: ours,\n")?;
        f.write_str("no robot waits for those behind; paper: each robot weighs its own way against all neighbours found (algorithms 2 and 5 to 7)\n")?;
        f.write_str("landscapes that all six crossed, dPhi/6 over all, travel time ratio over those crossed; S: entropy of the land;\n")?;
        f.write_str("figure 6: the paper's dPhi/6 at this N, and on land of this S\n")?;
        write!(f, "{:>8}{:>11}", "loss %", "law")?;
        for point in &self.points {
            write!(f, "{:>18}", format!("N = {}", point.obstacles))?;
        }
        writeln!(f)?;
        write!(f, "{:>19}", "S")?;
        for point in &self.points {
            write!(f, "{:>18.3}", point.entropy)?;
        }
        write!(f, "\n{:>19}", "figure 6")?;
        for point in &self.points {
            let [same_n, same_s] = [point.paper_error_per_agent, point.paper_error_at_entropy].map(|at| Maybe(at, 2));
            write!(f, "{:>18}", format!("{same_n} {same_s}"))?;
        }
        writeln!(f)?;
        for &loss in &losses {
            for &law in &laws {
                write!(f, "{:>8.0}{:>11}", 100.0 * loss, law.name())?;
                for point in &self.points {
                    let entry = point.under(law, loss).map(|journey| {
                        let (error, ratio) = (journey.error_per_agent.mean, Maybe(journey.time_ratio, 2));
                        format!("{} {error:.2} {ratio}", journey.arrived)
                    });
                    write!(f, "{:>18}", entry.unwrap_or_default())?;
                }
                writeln!(f)?;
            }
        }
        self.write_waiting(f)
    }

    fn write_waiting(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (laws, losses) = self.laws();
        let (Some(&loss), true) = (losses.first(), laws.contains(&Law::Unwaiting)) else {
            return Ok(());
        };
        f.write_str("\nwhat our waiting buys and costs: dPhi/6 and worst error of any tick without and with it, cells; ticks without and with it\n")?;
        writeln!(
            f,
            "{:>4}{:>10}{:>8}{:>10}{:>8}{:>10}{:>8}{:>8}",
            "N", "without", "with", "worst", "with", "ticks", "with", "ratio"
        )?;
        for point in &self.points {
            let (Some(without), Some(with)) = (point.under(Law::Unwaiting, loss), point.under(Law::Staya, loss)) else {
                continue;
            };
            let ratio = with.time_ticks.zip(without.time_ticks).map(|(with, without)| with / without);
            writeln!(
                f,
                "{:>4}{:>10.2}{:>8.2}{:>10.1}{:>8.1}{:>10}{:>8}{:>8}",
                point.obstacles,
                without.error_per_agent.mean,
                with.error_per_agent.mean,
                without.worst_error,
                with.worst_error,
                Maybe(without.time_ticks, 0),
                Maybe(with.time_ticks, 0),
                Maybe(ratio, 2),
            )?;
        }
        Ok(())
    }

    pub(in crate::formation) fn laws_picture(&self) -> Option<Panels> {
        let (laws, losses) = self.laws();
        let loss = *losses.first()?;
        let over_n = |law: Law, value: fn(&Journey) -> Option<f64>| -> Vec<[f64; 2]> {
            let value = |point: &Point| value(point.under(law, loss)?);
            self.points.iter().filter_map(|p| Some([f64::from(p.obstacles), value(p)?])).collect()
        };
        let chart = |title: &str, label: &str| Chart::new(title, "obstacles N", label).size(720.0, 320.0);
        let mut error = chart("Formation error per robot", "error (cells)").note(self.note());
        let mut time = chart("Travel time over that without formation, where all arrived", "ratio");
        let mut arrived = chart("Landscapes that all six crossed", "share").y_range(0.0, 1.05);
        for law in laws {
            let named = |points| Series::points(law.name(), points).joined();
            error = error.with(named(over_n(law, |j| Some(j.error_per_agent.mean))));
            time = time.with(named(over_n(law, |j| j.time_ratio)));
            arrived = arrived.with(named(over_n(law, |j| Some(j.arrived as f64 / j.error_per_agent.count as f64))));
        }
        let paper = self.axis().map(|n| [n, self.paper.at(n)]).filter(|at| at[1] >= 0.0);
        error = error.with(Series::reference("figure 6: 0.901 ln(N + 1) - 0.674", paper));
        Some(Panels::new("Six robots in formation by each law").with(error).with(time).with(arrived))
    }
}

pub(super) fn journeys(ways: impl Iterator<Item = (Law, Option<Journey>)>) -> Vec<LawJourney> {
    ways.filter_map(|(law, journey)| Some(LawJourney { law, journey: journey? })).collect()
}
