//! Results of the goal flock.

use super::setting::{Setting, short, varying};
use super::threshold::{self, Gain, Threshold};
use super::watch::{Frame, Run, Way};
use super::{Plan, Scene};
use crate::experiment::Maybe;
use crate::sweep::Value;
use serde::{Serialize, Serializer};
use staya_stats::mean;
use std::fmt::{self, Display, Formatter};

/// Means over the runs of one setting.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    /// The setting.
    #[serde(flatten, serialize_with = "as_rows")]
    pub setting: Setting,
    /// K1 / K2; `null` when K2 is 0.
    pub k1_over_k2: Option<f64>,
    /// Number of runs.
    pub runs: usize,
    /// Mean length of the mean direction on the way, 0 to 1.
    pub polarisation: Option<f64>,
    /// Share of the robots in the largest group on the way.
    pub together: Option<f64>,
    /// Robots within four R_MinDist of a robot on the way.
    pub company: Option<f64>,
    /// Difference of `together` to the point with K2 = 0 and all else equal, if there is one.
    pub together_gain: Option<f64>,
    /// Difference of `company` to independent robots.
    pub company_gain: Option<f64>,
    /// Radius of the crowd on the way divided by that at the start.
    pub spread: Option<f64>,
    /// Share of the robots that reached the middle.
    pub gathered: f64,
    /// Mean time until half of the robots had gathered, seconds.
    pub half_gathered_s: Option<f64>,
    /// Share of the robots at a goal at the end.
    pub arrived: f64,
    /// Share of each goal among these robots.
    pub goal_shares: Vec<f64>,
    /// Smallest distance of two centres / R_MinDist; `null` if all were farther apart.
    pub least_pair_over_min_distance: Option<f64>,
    /// Pairs of overlapping bodies (radius 0.3 R_MinDist), summed over ticks and runs.
    pub overlaps: usize,
    /// Exclusive or of the runs' trace hashes.
    pub trace_hash: String,
    #[serde(skip)]
    pub(super) frames: Vec<Frame>,
}

fn as_rows<S: Serializer>(setting: &Setting, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(setting.given().into_iter().map(|(name, value)| (name, json(&value))))
}

fn json(value: &Value) -> serde_json::Value {
    match value {
        Value::Whole(number) => (*number).into(),
        Value::Number(number) => (*number).into(),
        Value::Truth(truth) => (*truth).into(),
        Value::Word(word) => word.clone().into(),
    }
}

/// Results of the experiment.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Seed of the experiment.
    pub seed: u64,
    /// R_MinDist, metres.
    pub min_distance_m: f64,
    /// Radius of a body, metres.
    pub radius_m: f64,
    /// Length of a tick, seconds.
    pub step_s: f64,
    /// Length of a run, seconds.
    pub seconds: f64,
    /// Whether places of the goals are random.
    pub random_goals: bool,
    /// Whether the first goal was moved.
    pub moves_goal: bool,
    /// Points in the order of the lists, K1 innermost, without points that have no runs.
    pub points: Vec<Point>,
    /// Threshold of K1 / K2 of each curve.
    pub thresholds: Vec<Threshold>,
    #[serde(skip)]
    pub(super) plan: Plan,
}

impl Report {
    pub(super) fn of(plan: &Plan, runs: &[Vec<Run>]) -> Self {
        let settings = plan.settings().into_iter().zip(runs);
        let mut points: Vec<Point> = settings.filter_map(|(setting, runs)| Point::of(plan, setting, runs)).collect();
        compare(&mut points);
        Self {
            seed: plan.seed,
            min_distance_m: plan.min_distance_m,
            radius_m: plan.radius_m(),
            step_s: plan.step_s,
            seconds: plan.seconds,
            random_goals: plan.random_goals,
            moves_goal: plan.moves_goal,
            thresholds: threshold::of(&points.iter().map(Point::gain).collect::<Vec<_>>()),
            points,
            plan: plan.clone(),
        }
    }

    pub(super) fn scene(&self, setting: &Setting) -> Option<Scene> {
        Scene::new(&self.plan, setting, 0).ok()
    }
}

fn compare(points: &mut [Point]) {
    let alone = points.iter().filter(|point| point.setting.k2 == 0.0);
    let alone: Vec<_> = alone.map(|point| (point.setting, point.together, point.company)).collect();
    for point in points.iter_mut().filter(|point| point.setting.k2 != 0.0) {
        let independent = Setting { k2: 0.0, ..point.setting };
        if let Some((_, together, company)) = alone.iter().find(|(setting, ..)| *setting == independent) {
            let gain = |own: Option<f64>, other: Option<f64>| Some(own? - other?);
            point.together_gain = gain(point.together, *together);
            point.company_gain = gain(point.company, *company);
        }
    }
}

impl Point {
    fn gain(&self) -> Gain {
        Gain { setting: self.setting, together: self.together_gain, company: self.company_gain }
    }

    fn of(plan: &Plan, setting: Setting, runs: &[Run]) -> Option<Self> {
        let first = runs.first()?;
        let robots = f64::from(setting.robots) * runs.len() as f64;
        let way = |value: fn(&Way) -> f64| {
            let values = runs.iter().filter_map(|run| run.way.as_ref());
            mean(&values.map(value).collect::<Vec<_>>())
        };
        let at = |goal: usize| runs.iter().map(|run| run.at_goals[goal]).sum::<usize>() as f64;
        let at_goals: Vec<f64> = (0..setting.goals as usize).map(at).collect();
        let arrived: f64 = at_goals.iter().sum();
        let halves: Vec<f64> = runs.iter().filter_map(|run| run.half_gathered_s).collect();
        let least_m = runs.iter().map(|run| run.least_pair_m).fold(f64::INFINITY, f64::min);
        Some(Self {
            setting,
            k1_over_k2: setting.ratio(),
            runs: runs.len(),
            polarisation: way(|way| way.polarisation),
            together: way(|way| way.together),
            company: way(|way| way.company),
            together_gain: None,
            company_gain: None,
            spread: way(|way| way.spread),
            gathered: runs.iter().map(|run| run.gathered).sum::<usize>() as f64 / robots,
            half_gathered_s: mean(&halves),
            arrived: arrived / robots,
            goal_shares: at_goals.iter().map(|at| if arrived == 0.0 { 0.0 } else { at / arrived }).collect(),
            least_pair_over_min_distance: least_m.is_finite().then(|| least_m / plan.min_distance_m),
            overlaps: runs.iter().map(|run| run.overlaps).sum(),
            trace_hash: format!("{:016x}", runs.iter().fold(0, |all, run| all ^ run.hash)),
            frames: first.frames.clone(),
        })
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let settings: Vec<Setting> = self.points.iter().map(|point| point.setting).collect();
        let varying = varying(&settings);
        if let Some(first) = settings.first() {
            let given = first.given();
            let same = (0..given.len()).filter(|place| !varying.contains(place));
            let same = same.map(|place| format!("{} {}", short(given[place].0), given[place].1));
            writeln!(
                f,
                "{}; R_MinDist {} m, radius {} m, {} s in steps of {} s, {}{}seed {}",
                same.collect::<Vec<_>>().join(", "),
                self.min_distance_m,
                self.radius_m,
                self.seconds,
                self.step_s,
                if self.random_goals { "goals at random, " } else { "" },
                if self.moves_goal { "the first goal moved, " } else { "" },
                self.seed
            )?;
            for &place in &varying {
                write!(f, "{:>11}", short(given[place].0))?;
            }
        }
        writeln!(
            f,
            "{:>8}{:>6}{:>7}{:>10}{:>8}{:>9}{:>7}{:>8}{:>10}{:>8}{:>9}{:>16}{:>7}{:>9}",
            "K1/K2",
            "runs",
            "order",
            "together",
            "gain",
            "company",
            "gain",
            "spread",
            "gathered",
            "half s",
            "arrived",
            "goals %",
            "pair",
            "overlaps"
        )?;
        for point in &self.points {
            let given = point.setting.given();
            for &place in &varying {
                write!(f, "{:>11}", given[place].1.to_string())?;
            }
            let goals: Vec<_> = point.goal_shares.iter().map(|share| format!("{:.0}", 100.0 * share)).collect();
            writeln!(
                f,
                "{:>8}{:>6}{:>7}{:>10}{:>8}{:>9}{:>7}{:>8}{:>10.3}{:>8}{:>9.3}{:>16}{:>7}{:>9}",
                Maybe(point.k1_over_k2, 2),
                point.runs,
                Maybe(point.polarisation, 3),
                Maybe(point.together, 3),
                Maybe(point.together_gain, 3),
                Maybe(point.company, 1),
                Maybe(point.company_gain, 1),
                Maybe(point.spread, 2),
                point.gathered,
                Maybe(point.half_gathered_s, 0),
                point.arrived,
                goals.join(" "),
                Maybe(point.least_pair_over_min_distance, 3),
                point.overlaps
            )?;
        }
        f.write_str("on the way to the middle of the goals: order: polarisation; together: share of the largest group; company: robots within 4 R_MinDist of one; gain: over those of independent robots, K2 = 0;\n")?;
        f.write_str("spread: radius of the crowd over that at the start; gathered: share that came to the middle, half s: when half had; arrived: share at a goal at the\n")?;
        f.write_str("end; goals: their shares of these; pair: least distance of centres over R_MinDist; overlaps: pairs of bodies, over all ticks\n")?;
        threshold::table(f, &self.thresholds)
    }
}
