//! Pictures of runs in the plane.

use super::canvas::{extent, longest};
use super::flock::{Obstacle, Sheet, Snapshot};
use super::run::packets;
use staya_sim::nearby::Space;
use staya_sim::record::{Error, Frame, History};
use staya_sim::scenario::{PlaneSetup, Scenario};
use staya_sim::terrain::Terrain;
use staya_sim::world::plane::Solid;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const MOMENTS: usize = 4;
const MOST_TRAILS: usize = 100;
const TRAIL_POINTS: usize = 400;
/// Obstacles larger than this multiple of the extent of the robots are clipped.
const LARGE: f64 = 2.0;

pub(super) fn in_plane(
    of: &str,
    scenario: &Scenario,
    setup: &PlaneSetup,
    history: &History,
    out_dir: &Path,
) -> Result<Vec<PathBuf>, Error> {
    let mut files = Vec::new();
    if !history.frames().is_empty() {
        let land = setup.has_terrain.then_some(&scenario.terrain);
        files.extend(motion_sheet(of, setup, land, history).draw().write(&out_dir.join("motion"))?);
    }
    files.extend(packets(of, history).write(&out_dir.join("packets"))?);
    Ok(files)
}

/// Draws four moments of a run side by side; the title may be empty.
#[must_use]
pub fn motion_sheet(title: &str, setup: &PlaneSetup, land: Option<&Terrain>, history: &History) -> Sheet {
    let frames = history.frames();
    let obstacles: Vec<_> = setup.solids.iter().filter_map(drawn).collect();
    let last = frames.len().saturating_sub(1);
    let mut moments: Vec<_> = (0..MOMENTS).map(|moment| last * moment / (MOMENTS - 1)).collect();
    moments.dedup();
    moments.retain(|&at| at < frames.len());
    let goals: Vec<_> = moments.iter().map(|&at| goals(setup, frames[at].tick)).collect();
    let largest_m = setup.kinds().map(|group| group.radius_m).fold(0.0, f64::max);
    let view_m = match setup.torus_m {
        Some(sides) => Some([0, 1].map(|axis| [0.0, sides[axis]])),
        None => view(frames, largest_m, goals.iter().flatten(), &obstacles),
    };
    let land = land.cloned().map(Arc::new);
    let space = setup.space();
    let velocities: Vec<_> = moments.iter().map(|&at| velocities(frames, at, &space)).collect();
    let speeds = velocities.iter().flatten().map(|&[x, y]| libm::hypot(x, y));
    let fastest_mps = speeds.filter(|speed| speed.is_finite()).fold(0.0, f64::max);
    let mut sheet = Sheet::new(title, 2).with_legend();
    for ((at, goals_m), velocities_mps) in moments.into_iter().zip(goals).zip(velocities) {
        let frame = &frames[at];
        let robots = frame.samples.len();
        sheet = sheet.with(Snapshot {
            title: format!("after {:.1} s", frame.time_s),
            positions_m: frame.samples.iter().map(|s| s.position_m).collect(),
            velocities_mps,
            fastest_mps,
            radius_m: largest_m,
            radii_m: (0..robots).map(|robot| setup.group(robot).radius_m).collect(),
            groups: (0..robots).collect(),
            obstacles: obstacles.clone(),
            goals_m,
            trails_m: trails(&frames[..=at], robots.min(MOST_TRAILS), &space),
            land: land.clone(),
            view_m,
            ..Snapshot::default()
        });
    }
    sheet
}

/// By the scenario: goals of the start, or of the last order.
fn goals(setup: &PlaneSetup, tick: u32) -> Vec<[f64; 2]> {
    let places = (0..setup.starts.len()).flat_map(|robot| {
        let step_s = setup.group(robot).abilities.step_s;
        setup.starts[robot].places.iter().enumerate().map(move |(goal, place)| {
            let mut orders = setup.orders.iter().filter(|order| usize::from(order.index) == goal && order.tick <= tick);
            let (since, place) = orders.next_back().map_or((0, place), |order| (order.tick, &order.target));
            let time_s = f64::from(tick - since) * step_s;
            [0, 1].map(|axis| place.position_m[axis] + place.velocity_mps[axis] * time_s)
        })
    });
    let mut places: Vec<_> = places.collect();
    places.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    places.dedup();
    places
}

fn drawn(solid: &Solid) -> Option<Obstacle> {
    match *solid {
        Solid::Wall(ends) => Some(Obstacle::Segment(ends)),
        Solid::Ball { center_m, radius_m } => Some(Obstacle::Disc { centre_m: [center_m[0], center_m[1]], radius_m }),
        // The border of a half-space has no ends.
        Solid::Plane { .. } => None,
    }
}

fn view<'a>(
    frames: &[Frame],
    radius_m: f64,
    goals_m: impl Iterator<Item = &'a [f64; 2]>,
    obstacles: &[Obstacle],
) -> Option<[[f64; 2]; 2]> {
    let places = frames.iter().flat_map(|frame| &frame.samples).map(|sample| sample.position_m);
    let robots = extent(places.chain(goals_m.copied()));
    let most_m = LARGE * longest(robots).max(2.0 * radius_m);
    let corners = obstacles.iter().map(Obstacle::corners);
    let near = corners.filter(|corners| longest(extent(corners.iter().copied())) < most_m);
    let [low, high] = extent(near.flatten().chain(robots));
    let margin = 2.0 * radius_m + 0.05 * longest([low, high]);
    let is_sound = margin.is_finite();
    is_sound.then(|| [0, 1].map(|axis| [low[axis] - margin, high[axis] + margin]))
}

/// Velocities as differences of neighbouring frames.
fn velocities(frames: &[Frame], at: usize, space: &Space<f64, 3>) -> Vec<[f64; 2]> {
    let [from, to] = match frames.get(at + 1) {
        Some(_) => [at, at + 1],
        None => [at.saturating_sub(1), at],
    };
    let span_s = frames[to].time_s - frames[from].time_s;
    let pairs = frames[from].samples.iter().zip(&frames[to].samples);
    pairs
        .map(|(before, after)| {
            let way_m = way(before.position_m, after.position_m, space);
            way_m.map(|way_m| if span_s > 0.0 { way_m / span_s } else { 0.0 })
        })
        .collect()
}

fn way([x, y]: [f64; 2], [to_x, to_y]: [f64; 2], space: &Space<f64, 3>) -> [f64; 2] {
    let [x, y, _] = space.offset([x, y, 0.0], [to_x, to_y, 0.0]);
    [x, y]
}

/// A robot that crosses the seam of a torus leaves a gap in its path.
fn trails(frames: &[Frame], robots: usize, space: &Space<f64, 3>) -> Vec<Vec<[f64; 2]>> {
    let every = frames.len().div_ceil(TRAIL_POINTS).max(1);
    let thinned = || frames.iter().step_by(every).chain(frames.last());
    (0..robots)
        .map(|robot| {
            let samples = thinned().filter_map(|frame| frame.samples.get(robot));
            let mut trail: Vec<[f64; 2]> = Vec::new();
            for at in samples.map(|sample| sample.position_m) {
                let is_over_a_seam = trail.last().is_some_and(|&last| {
                    let way_m = way(last, at, space);
                    (0..2).any(|axis| (at[axis] - last[axis] - way_m[axis]).abs() > 1e-3)
                });
                if is_over_a_seam {
                    trail.push([f64::NAN; 2]);
                }
                trail.push(at);
            }
            trail
        })
        .collect()
}
