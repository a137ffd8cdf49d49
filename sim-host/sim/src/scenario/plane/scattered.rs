//! Random placement of robots with goals, and of balls.

use super::super::Draft;
use super::super::source::Checked;
use super::body::Group;
use super::grounds::Surroundings;
use super::place::{Start, Target};
use super::table::{BallsEntry, Place, ScatteredDiscs};
use crate::world::plane::Solid;
use staya_controller::agent::Goals;
use staya_controller::rand::Rng;
use std::collections::HashMap;

const SCATTERED: u32 = 0x0053_0004;
const BALLS: u32 = 0x0053_0005;

/// Draws of a place before the scenario is refused as too crowded.
pub(super) const TRIES: u32 = 1000;

pub(super) fn unit(rng: &mut Rng) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

pub(super) fn between(rng: &mut Rng, from: Place, to: Place) -> [f64; 3] {
    let mut place = [0.0; 3];
    for (axis, place) in place.iter_mut().enumerate() {
        *place = from.0[axis] + (to.0[axis] - from.0[axis]) * unit(rng);
    }
    place
}

fn squared(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]) * (a[axis] - b[axis])).sum()
}

/// Whether a body at `place` touches none of `others` (place, radius).
pub(super) fn is_clear(place: [f64; 3], radius_m: f64, others: &[([f64; 3], f64)]) -> bool {
    others.iter().all(|&(other, other_m)| squared(place, other) >= (radius_m + other_m) * (radius_m + other_m))
}

/// Accepted places, at least `spacing_m` metres apart, with heights divided by `downwash`. O(1) per
/// place.
pub(super) struct Taken {
    spacing_m: f64,
    downwash: f64,
    buckets: HashMap<[i64; 3], Vec<[f64; 3]>>,
}

impl Taken {
    pub(super) fn new(spacing_m: f64, downwash: f64) -> Self {
        Self { spacing_m, downwash, buckets: HashMap::new() }
    }

    fn lowered(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        [x, y, z / self.downwash]
    }

    fn bucket(&self, lowered: [f64; 3]) -> [i64; 3] {
        lowered.map(|x| libm::floor(x / self.spacing_m) as i64)
    }

    pub(super) fn is_free(&self, place: [f64; 3]) -> bool {
        let place = self.lowered(place);
        let [x, y, z] = self.bucket(place);
        let around = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy)));
        let around = around.flat_map(|(dx, dy)| (-1..=1).map(move |dz| [x + dx, y + dy, z + dz]));
        let mut near = around.filter_map(|at| self.buckets.get(&at)).flatten();
        !near.any(|other| squared(place, *other) < self.spacing_m * self.spacing_m)
    }

    pub(super) fn take(&mut self, place: [f64; 3]) {
        let place = self.lowered(place);
        self.buckets.entry(self.bucket(place)).or_default().push(place);
    }
}

/// Places are two radii or more from obstacles, blocked cells and the sides of the map; starts are
/// also clear of `others` (place, radius).
pub(super) fn starts(
    group: &Group<'_>,
    entry: &ScatteredDiscs,
    others: &[([f64; 3], f64)],
    surroundings: &Surroundings<'_>,
) -> Checked<Vec<Start>> {
    let (body, at) = (&group.body, group.at.at("robots.scattered"));
    if matches!(group.kind.goals(), Goals::None | Goals::Cell) {
        let what = format!("robots with the law \"{}\" have no goals in metres", group.kind.name());
        return Err(at.unfit(what, "give a cloud, or law = \"waypoint\""));
    }
    let (least_m, spacing_m) = (2.0 * body.radius_m, entry.spacing_m.unwrap_or(3.0 * body.radius_m));
    at.within("spacing_m", spacing_m, least_m..=1e6, "metres")?;
    let [low, high] = corners(entry.from_m, entry.to_m);
    let downwash = f64::from(body.layer.get("downwash").unwrap_or(1.0));
    let (mut taken, mut aims) = (Taken::new(spacing_m, downwash), Taken::new(spacing_m, downwash));
    let (first, mut starts) = (others.len() as u32, Vec::with_capacity(entry.count as usize));
    for index in 0..entry.count {
        let mut rng = Rng::keyed(group.draft.file.seed, SCATTERED, first + index, 0);
        let mut draw = |low, high, taken: &mut Taken, is_start: bool| {
            let mut places = (0..TRIES).map(|_| between(&mut rng, Place(low), Place(high)));
            let place = places.find(|&at| {
                taken.is_free(at)
                    && surroundings.is_clear(at, least_m)
                    && (!is_start || is_clear(at, body.radius_m, others))
            });
            place.inspect(|&place| taken.take(place)).ok_or_else(|| {
                let what =
                    format!("robot {} finds no free {}", first + index + 1, if is_start { "start" } else { "goal" });
                at.unfit(
                    what,
                    "give fewer robots, less spacing_m, more travel_m, or corners farther apart on open land",
                )
            })
        };
        let position_m = draw(low, high, &mut taken, true)?;
        let from_m = std::array::from_fn(|axis| low[axis].max(position_m[axis] - entry.travel_m));
        let to_m = std::array::from_fn(|axis| high[axis].min(position_m[axis] + entry.travel_m));
        let goal = Target::fixed(draw(from_m, to_m, &mut aims, false)?);
        starts.push(Start { position_m, velocity_mps: [0.0; 3], places: vec![goal], group: None, phase_ticks: None });
    }
    Ok(starts)
}

pub(super) fn balls(draft: &Draft<'_>, entries: &[BallsEntry]) -> Checked<Vec<Solid>> {
    let mut balls = Vec::new();
    for (number, entry) in (0..).zip(entries) {
        let at = draft.at(format!("plane.balls[{number}]"));
        let [low, high] = corners(entry.from_m, entry.to_m);
        let mut taken = Taken::new(2.0 * entry.radius_m + entry.gap_m, 1.0);
        for index in 0..entry.count {
            let mut rng = Rng::keyed(draft.file.seed, BALLS, number, index);
            let mut places = (0..TRIES).map(|_| between(&mut rng, Place(low), Place(high)));
            let center_m = places.find(|&place| taken.is_free(place)).ok_or_else(|| {
                let what = format!("ball {index} of {} finds no room", entry.count);
                at.unfit(what, "give fewer balls, less gap_m or corners farther apart")
            })?;
            taken.take(center_m);
            balls.push(Solid::Ball { center_m, radius_m: entry.radius_m });
        }
    }
    Ok(balls)
}

/// The least and the greatest corner of a box.
fn corners(from: Place, to: Place) -> [[f64; 3]; 2] {
    let axes = |pick: fn(f64, f64) -> f64| std::array::from_fn(|axis| pick(from.0[axis], to.0[axis]));
    [axes(f64::min), axes(f64::max)]
}
