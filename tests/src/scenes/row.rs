//! Runs of scenes, and their figures.

use super::{Kind, Scene, distance_m};
use anyhow::{Context as _, Result, anyhow};
use staya_controller::grid::UNIT;
use staya_controller::robot::{Mode, RobotId};
use staya_sim::engine::{Outcome, simulate};
use staya_sim::scenario::{Overrides, Scenario, Setting};
use std::collections::BTreeMap;
use std::fmt::{self, Display, Formatter};
use std::ops::ControlFlow;
use std::path::Path;
use std::str::FromStr;

/// Names of the columns of a [`Row`].
pub const HEADER: &str = "seed,kind,robots,overlap_mm,wall_overlap_mm,missing,covered,last_s,run_s,packets,trace";

/// Overlaps of at most this depth do not count, millimetres.
const TOUCH_MM: f64 = 1.0;

/// Figures of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Seed of the scene.
    pub seed: u32,
    /// The trouble of the scene.
    pub kind: Kind,
    /// Number of robots.
    pub robots: usize,
    /// Deepest overlap of two robots, millimetres; 0 without overlap.
    pub overlap_mm: f64,
    /// Deepest overlap of a robot and a wall, millimetres.
    pub wall_overlap_mm: f64,
    /// Living robots that are not at their goal at the end, without those in `covered`.
    pub missing: usize,
    /// Living robots that are not at their goal because a dead robot covers it.
    pub covered: usize,
    /// Time of the last arrival, seconds; `None` if robots are missing.
    pub last_s: Option<f64>,
    /// Simulated time, seconds.
    pub run_s: f64,
    /// Packets sent.
    pub packets: u64,
    /// Trace hash.
    pub trace: u64,
}

impl Row {
    /// Whether two robots overlap by more than a millimetre.
    #[must_use]
    pub fn overlaps(&self) -> bool {
        self.overlap_mm > TOUCH_MM
    }
}

/// Runs a scene with settings of scenario fields.
///
/// # Errors
/// A setting does not fit, or the robots cannot be placed.
pub fn run(scene: &Scene, settings: &[Setting]) -> Result<Row> {
    let path = format!("{}-{}.toml", scene.kind, scene.seed);
    let scenario = Scenario::parse_with(&scene.text, Path::new(&path), &Overrides::default(), settings)?;
    let dead = dead(&scenario);
    let mut places_m = BTreeMap::new();
    let outcome = simulate(&scenario, |moment, robots| {
        if dead.is_empty() {
            return ControlFlow::Continue(());
        }
        let mut all_arrived = moment.arrived + dead.len() >= scenario.robots.len();
        for row in robots {
            if dead.contains(&RobotId(row.id)) {
                places_m.insert(RobotId(row.id), row.motion.position_m);
            } else {
                all_arrived &= row.mode == Mode::Arrived;
            }
        }
        // The dead do not arrive.
        if all_arrived { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let outcome = outcome.with_context(|| path.clone())?;
    Ok(row(scene, &scenario, &outcome, &places_m))
}

/// Robots that go down for the rest of the run.
fn dead(scenario: &Scenario) -> Vec<RobotId> {
    let lasting = scenario.events.faults.iter().filter(|fault| fault.to_tick > scenario.ticks);
    lasting.map(|fault| fault.robot).collect()
}

fn row(scene: &Scene, scenario: &Scenario, outcome: &Outcome, dead_m: &BTreeMap<RobotId, [f64; 3]>) -> Row {
    let (mut missing, mut covered, mut last) = (0, 0, 0);
    let members = scene.crowd.members.iter().zip(&outcome.arrival_times).zip(&scenario.robots);
    for ((member, arrival), _) in members.filter(|(_, robot)| !dead_m.contains_key(&robot.id)) {
        // Around a dead robot others keep a ball of twice its radius.
        let mut balls = dead_m.iter().map(|(id, place_m)| (id.0 as usize - 1, place_m));
        let is_covered = balls.any(|(index, &place_m)| {
            let keep_m = member.radius_m + 2.0 * scene.crowd.members[index].radius_m;
            distance_m(member.goal_m, place_m) < keep_m
        });
        match arrival {
            Some(units) => last = last.max(*units),
            None if is_covered => covered += 1,
            None => missing += 1,
        }
    }
    let clearance = outcome.clearance.unwrap_or(staya_sim::world::plane::Clearance::FREE);
    let depth_mm = |gap_m: f64| (-gap_m * 1000.0).max(0.0);
    Row {
        seed: scene.seed,
        kind: scene.kind,
        robots: scenario.robots.len(),
        overlap_mm: depth_mm(clearance.bodies_m),
        wall_overlap_mm: depth_mm(clearance.solids_m),
        missing,
        covered,
        last_s: (missing == 0).then(|| last as f64 / f64::from(UNIT) * scenario.tick_s()),
        run_s: outcome.seconds,
        packets: outcome.packets.sent,
        trace: outcome.trace_hash,
    }
}

impl Display for Row {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { seed, kind, robots, overlap_mm, wall_overlap_mm, missing, covered, last_s, run_s, packets, trace } =
            self;
        let last_s = last_s.map_or_else(String::new, |last_s| format!("{last_s:.3}"));
        write!(
            f,
            "{seed},{kind},{robots},{overlap_mm:.3},{wall_overlap_mm:.3},{missing},{covered},{last_s},{run_s:.2},\
             {packets},{trace:016x}"
        )
    }
}

impl FromStr for Row {
    type Err = anyhow::Error;

    fn from_str(line: &str) -> Result<Self> {
        let mut fields = line.trim_end().split(',');
        let mut next = || fields.next().context("a column is missing; give a file that --out has written");
        let row = Self {
            seed: next()?.parse()?,
            kind: next()?.parse().map_err(|error: String| anyhow!(error))?,
            robots: next()?.parse()?,
            overlap_mm: next()?.parse()?,
            wall_overlap_mm: next()?.parse()?,
            missing: next()?.parse()?,
            covered: next()?.parse()?,
            last_s: Some(next()?).filter(|text| !text.is_empty()).map(str::parse).transpose()?,
            run_s: next()?.parse()?,
            packets: next()?.parse()?,
            trace: u64::from_str_radix(next()?, 16)?,
        };
        Ok(row)
    }
}
