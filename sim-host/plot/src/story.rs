//! Moments of a run as snapshots: colours, goals, past paths and the visible range.

use super::canvas::{extent, longest};
use super::colour::{self, Colour};
use super::flock::{Body, Snapshot, corners, marks};
use super::view::View;
use staya_controller::names::Named as _;
use staya_controller::robot::Mode;
use staya_record::scene::{self, ColourBy};
use staya_sim::nearby::Space;
use staya_sim::record::{Frame, History};
use staya_sim::scenario::Scenario;
use std::sync::Arc;

/// Larger swarms have no past paths.
pub const MOST_TRAILS: usize = 100;
const MOMENTS: usize = 4;
/// Width of a moment's picture, and the room of its axes and title, units.
const SIDE: f64 = 430.0;
const ABOVE: f64 = 72.0;
const TRAIL_POINTS: usize = 400;
/// Obstacles larger than this multiple of the extent of the robots are clipped.
const LARGE: f64 = 2.0;
/// Colour of a robot whose computer does not run, unless modes have colours.
const DOWN: Colour = colour::INK;

pub struct Story<'a> {
    scenario: &'a Scenario,
    pub frames: &'a [Frame],
    colour_by: ColourBy,
    groups: Vec<u32>,
    space: Space<f64, 3>,
    /// Obstacles, map and visible range.
    pub stage: Snapshot,
}

impl<'a> Story<'a> {
    pub fn new(scenario: &'a Scenario, history: &'a History) -> Self {
        let groups: Vec<u32> = (0..scenario.robots.len()).map(|index| scene::group(scenario, index)).collect();
        let setup = scenario.plane();
        let has_land = setup.is_none_or(|setup| setup.has_terrain);
        let samples = || history.frames().iter().flat_map(|frame| &frame.samples);
        let is_space = scene::is_in_space(scenario) || samples().any(|sample| sample.position_m[2] != 0.0);
        let mut this = Self {
            scenario,
            frames: history.frames(),
            colour_by: ColourBy::of(&groups),
            groups,
            space: setup.map_or(Space::OPEN, |setup| setup.space()),
            stage: Snapshot {
                solids: setup.map_or([].into(), |setup| setup.solids.clone().into()),
                land: has_land.then(|| Arc::new(scenario.land.terrain.clone())),
                is_space,
                downwash: scene::downwash(scenario),
                ..Snapshot::default()
            },
        };
        this.stage.span_m = this.span();
        let [width, height] = View::sides(is_space, this.stage.span());
        this.stage.size = [SIDE, ABOVE + (SIDE - ABOVE) * (height / width).clamp(0.4, 1.0)];
        this.stage.fastest_mps =
            this.moments().flat_map(|at| this.velocities(at)).map(marks::speed).fold(0.0, f64::max);
        this
    }

    /// Name and seed of the scenario.
    pub fn name(&self) -> String {
        format!("{} (seed {})", self.scenario.name, self.scenario.seed)
    }

    /// Frames of the run's pictures.
    pub fn moments(&self) -> impl Iterator<Item = usize> + use<> {
        evenly(self.frames.len(), MOMENTS)
    }

    /// Goals, and bodies without velocities.
    pub fn moment(&self, frame: &Frame) -> Snapshot {
        let robots = frame.samples.iter().enumerate().map(|(index, sample)| {
            let is_own = self.colour_by != ColourBy::Mode;
            let is_down = is_own && sample.mode == Mode::Fault;
            Body {
                position_m: sample.position_m,
                radius_m: scene::radius_m(self.scenario, index),
                colour: if is_down { DOWN } else { self.colour(index, sample.mode) },
                is_pale: is_own && sample.mode == Mode::Arrived,
                ..Body::default()
            }
        });
        let intruders = self.scenario.plane().into_iter().flat_map(|setup| &setup.intruders).map(|intruder| Body {
            position_m: moved(intruder.position_m, intruder.velocity_mps, frame.time_s),
            radius_m: intruder.radius_m,
            colour: marks::INTRUDER,
            ..Body::default()
        });
        Snapshot {
            bodies: robots.chain(intruders).collect(),
            edges: self.scenario.edges().collect(),
            goals: self.goals(frame),
            ..self.stage.clone()
        }
    }

    /// The moment of a frame with velocities and past paths.
    pub fn full_moment(&self, at: usize) -> Snapshot {
        let mut moment = self.moment(&self.frames[at]);
        for (body, velocity_mps) in moment.bodies.iter_mut().zip(self.velocities(at)) {
            body.velocity_mps = velocity_mps;
        }
        let frames = &self.frames[..=at];
        let every = frames.len().div_ceil(TRAIL_POINTS).max(1);
        let robots = self.groups.len().min(MOST_TRAILS);
        moment.trails = (0..robots)
            .map(|robot| {
                let thinned = frames.iter().step_by(every).chain(frames.last());
                let places = thinned.filter_map(|frame| frame.samples.get(robot)).map(|sample| sample.position_m);
                let mut trail: Vec<[f64; 3]> = Vec::new();
                for place in places {
                    if trail.last().is_some_and(|&last| !self.is_way(last, place)) {
                        trail.push([f64::NAN; 3]);
                    }
                    trail.push(place);
                }
                (trail, self.trail_colour(robot))
            })
            .collect();
        moment
    }

    /// Whether the straight way between two places does not cross the seam of a torus.
    pub fn is_way(&self, from: [f64; 3], to: [f64; 3]) -> bool {
        let way_m = self.space.offset(from, to);
        (0..2).all(|axis| (to[axis] - from[axis] - way_m[axis]).abs() < 1e-3)
    }

    pub fn trail_colour(&self, index: usize) -> Colour {
        if self.colour_by == ColourBy::Mode { colour::MUTED } else { self.colour(index, Mode::Idle) }
    }

    fn colour(&self, index: usize, mode: Mode) -> Colour {
        match self.colour_by {
            ColourBy::Group => colour::of_group(self.groups.get(index).copied().unwrap_or(0)),
            ColourBy::Robot => colour::nth(index),
            ColourBy::Mode => colour::of_mode(mode),
        }
    }

    /// Meanings of the colours of bodies.
    pub fn keys(&self) -> Vec<(String, Colour)> {
        let mut keys: Vec<(String, Colour)> = Vec::new();
        let samples = || self.moments().flat_map(|at| &self.frames[at].samples);
        match self.colour_by {
            ColourBy::Group => {
                let mut groups = self.groups.clone();
                groups.sort_unstable();
                groups.dedup();
                keys.extend(groups.into_iter().take(colour::PALETTE.len()).map(|group| {
                    let name = if group == 0 { "no group".to_owned() } else { format!("group {group}") };
                    (name, colour::of_group(group))
                }));
            }
            ColourBy::Robot => keys.extend(self.scenario.robots.iter().enumerate().map(|(index, robot)| {
                (if index == 0 { format!("robot {}", robot.id.0) } else { robot.id.0.to_string() }, colour::nth(index))
            })),
            ColourBy::Mode => {
                let seen = Mode::NAMES.iter().filter(|(_, mode)| samples().any(|sample| sample.mode == *mode));
                keys.extend(seen.map(|(name, mode)| ((*name).to_owned(), colour::of_mode(*mode))));
            }
        }
        if self.colour_by != ColourBy::Mode && samples().any(|sample| sample.mode == Mode::Fault) {
            keys.push((Mode::Fault.name().to_owned(), DOWN));
        }
        if self.scenario.plane().is_some_and(|setup| !setup.intruders.is_empty()) {
            keys.push(("intruder".into(), marks::INTRUDER));
        }
        keys
    }

    /// By the scenario: goals of the start, or of the last order; on cells the target cells. Goals
    /// of several robots with different colours are grey.
    fn goals(&self, frame: &Frame) -> Vec<([f64; 3], Colour)> {
        let samples = frame.samples.iter().enumerate();
        let mut goals: Vec<([f64; 3], Colour)> = samples
            .flat_map(|(index, sample)| {
                let colour = self.colour(index, sample.mode);
                self.goals_of(index, frame.tick).into_iter().map(move |goal| (goal, colour))
            })
            .collect();
        if goals.is_empty() && (self.scenario.plane().is_none() || self.stage.land.is_some()) {
            let land = &self.scenario.land.terrain;
            let is_on_map = |(_, sample): &(usize, &staya_sim::record::Sample)| land.index(sample.target).is_some();
            let samples = frame.samples.iter().enumerate().filter(is_on_map);
            goals.extend(samples.map(|(index, sample)| {
                let [x, y] = land.center_m(sample.target);
                ([x, y, 0.0], self.colour(index, sample.mode))
            }));
        }
        goals.sort_by(|(a, _), (b, _)| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        let shared = goals.chunk_by(|(a, _), (b, _)| a == b).map(|same| {
            let is_one = same.iter().all(|(_, colour)| *colour == same[0].1);
            (same[0].0, if is_one { same[0].1 } else { colour::MUTED })
        });
        shared.collect()
    }

    fn goals_of(&self, robot: usize, tick: u32) -> Vec<[f64; 3]> {
        let Some((setup, start)) = self.scenario.plane().and_then(|setup| Some((setup, setup.starts.get(robot)?)))
        else {
            return Vec::new();
        };
        let tick_s = self.scenario.tick_s();
        let goal = |(number, place)| {
            let mut orders =
                setup.orders.iter().filter(|order| usize::from(order.index) == number && order.tick <= tick);
            let (since, place) = orders.next_back().map_or((0, place), |order| (order.tick, &order.target));
            moved(place.position_m, place.velocity_mps, f64::from(tick - since) * tick_s)
        };
        start.places.iter().enumerate().map(goal).collect()
    }

    /// Around the robots at all times, their goals, and the obstacles nearby; `None` without
    /// robots.
    fn span(&self) -> Option<[[f64; 3]; 2]> {
        if let Some([width, height]) = self.scenario.torus_m() {
            return Some([[0.0; 3], [width, height, 0.0]]);
        }
        let robots = 0..self.scenario.robots.len();
        let radius_m = robots.map(|index| scene::radius_m(self.scenario, index)).fold(0.0, f64::max);
        let places = self.frames.iter().flat_map(|frame| &frame.samples).map(|sample| sample.position_m);
        let goals = self.moments().flat_map(|at| self.goals(&self.frames[at])).map(|(goal, _)| goal);
        let robots = extent(places.chain(goals));
        let most_m = LARGE * longest(robots).max(2.0 * radius_m);
        let near =
            self.stage.solids.iter().map(corners).filter(|corners| longest(extent(corners.iter().copied())) < most_m);
        let [low, high] = extent(near.flatten().chain(robots));
        let margin = 2.0 * radius_m + 0.05 * longest([low, high]);
        let margins = [margin, margin, radius_m];
        margin.is_finite().then(|| [[0, 1, 2].map(|i| low[i] - margins[i]), [0, 1, 2].map(|i| high[i] + margins[i])])
    }

    /// Velocities as differences of neighbouring frames.
    fn velocities(&self, at: usize) -> Vec<[f64; 3]> {
        let [from, to] = match self.frames.get(at + 1) {
            Some(_) => [at, at + 1],
            None => [at.saturating_sub(1), at],
        };
        let span_s = self.frames[to].time_s - self.frames[from].time_s;
        let pairs = self.frames[from].samples.iter().zip(&self.frames[to].samples);
        pairs
            .map(|(before, after)| {
                let way_m = self.space.offset(before.position_m, after.position_m);
                way_m.map(|way_m| if span_s > 0.0 { way_m / span_s } else { 0.0 })
            })
            .collect()
    }
}

/// Indices of evenly spaced items, at most `most` and at least two, with the first and the last
/// one.
pub fn evenly(items: usize, most: usize) -> impl Iterator<Item = usize> {
    let (last, count) = (items.saturating_sub(1), items.min(most.max(2)));
    (0..count).map(move |number| last * number / (count - 1).max(1))
}

fn moved(from: [f64; 3], velocity_mps: [f64; 3], time_s: f64) -> [f64; 3] {
    [0, 1, 2].map(|axis| from[axis] + velocity_mps[axis] * time_s)
}
