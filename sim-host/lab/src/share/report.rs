//! Results with shared maps.

use super::{Plan, Trip};
use crate::experiment::Maybe;
use serde::Serialize;
use staya_stats::{Summary, mean};
use std::fmt::{self, Display, Formatter};

/// Results of the groups of a point, with or without sharing.
#[derive(Clone, Debug, Serialize)]
pub struct Outlook {
    /// Whether maps are shared.
    pub shared: bool,
    /// Loss of packets, 0 to 1.
    pub loss: f64,
    /// Robots that arrived.
    pub arrived: u32,
    /// dT, means of the groups, percent.
    pub loss_percent: Summary,
    /// dT of the first robots, percent.
    pub first_percent: Option<f64>,
    /// dT of the last robots, percent.
    pub last_percent: Option<f64>,
    /// Packets per group.
    pub packets: f64,
    /// Overlapping robots, summed over ticks.
    pub collisions: u64,
}

/// Results for one group size and number of obstacles.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    /// Arrangement of starts and goals.
    pub starts: &'static str,
    /// Robots per group.
    pub robots: u32,
    /// Number of obstacles N.
    pub obstacles: u32,
    /// Number of groups.
    pub runs: usize,
    /// Without sharing, then with shared maps at each loss.
    pub outlooks: Vec<Outlook>,
}

/// Results of the experiment.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Cells along each side.
    pub size: u16,
    /// Radius of the windows.
    pub radius: u8,
    /// Seed of the experiment.
    pub seed: u64,
    /// Results by starts, group size and obstacles.
    pub points: Vec<Point>,
}

impl Outlook {
    /// `shared`: packet loss at which robots share maps. `None` if no robot arrived.
    pub(crate) fn of(shared: Option<f64>, trips: &[Trip]) -> Option<Self> {
        let over = |value: fn(&Trip) -> Option<f64>| mean(&trips.iter().filter_map(value).collect::<Vec<_>>());
        let arrived = trips.iter().filter(|trip| trip.arrived > 0);
        let losses: Vec<f64> = arrived.map(|trip| trip.loss_percent).collect();
        Some(Self {
            shared: shared.is_some(),
            loss: shared.unwrap_or(0.0),
            arrived: trips.iter().map(|trip| trip.arrived).sum(),
            loss_percent: Summary::of(&losses)?,
            first_percent: over(|trip| trip.first_percent),
            last_percent: over(|trip| trip.last_percent),
            packets: over(|trip| Some(trip.packets as f64))?,
            collisions: trips.iter().map(|trip| trip.collisions).sum(),
        })
    }

    pub(crate) fn maps(&self) -> String {
        if self.shared { format!("shared, {:.0} %", 100.0 * self.loss) } else { String::from("own") }
    }
}

impl Report {
    pub(super) fn of(plan: &Plan, runs: &[Vec<Trip>]) -> Self {
        let cases = plan.cases();
        let of_point = 1 + plan.losses.len();
        let points = cases.chunks(of_point).zip(runs.chunks(of_point)).filter_map(|(cases, runs)| {
            let outlooks: Option<Vec<Outlook>> =
                cases.iter().zip(runs).map(|(case, trips)| Outlook::of(case.shared, trips)).collect();
            Some(Point {
                starts: cases[0].starts.name(),
                robots: cases[0].group,
                obstacles: cases[0].obstacles,
                runs: runs.iter().map(Vec::len).min().unwrap_or(0),
                outlooks: outlooks?,
            })
        });
        Self { size: plan.size, radius: plan.route.radius, seed: plan.seed, points: points.collect() }
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { size, radius, seed, .. } = self;
        writeln!(f, "{size} x {size} cells, natural land, window radius {radius}, seed {seed}")?;
        writeln!(
            f,
            "{:<9}{:>7}{:>5}{:>6}  {:<14}{:>8}{:>8}{:>7}{:>8}{:>8}{:>10}",
            "starts", "robots", "N", "runs", "maps", "arrived", "dT %", "+-", "first", "last", "packets"
        )?;
        for point in &self.points {
            for outlook in &point.outlooks {
                let maps = outlook.maps();
                writeln!(
                    f,
                    "{:<9}{:>7}{:>5}{:>6}  {maps:<14}{:>8}{:>8.1}{:>7}{:>8}{:>8}{:>10.0}",
                    point.starts,
                    point.robots,
                    point.obstacles,
                    point.runs,
                    outlook.arrived,
                    outlook.loss_percent.mean,
                    Maybe(outlook.loss_percent.mean_error95, 1),
                    Maybe(outlook.first_percent, 1),
                    Maybe(outlook.last_percent, 1),
                    outlook.packets,
                )?;
            }
        }
        f.write_str("dT: travel time above the fastest route on the whole map, mean over groups of robots' means. first, last: robot 1, the last robot\n+-: half the 95 % interval. shared: at that loss of packets; own: each by its window alone\n")
    }
}
