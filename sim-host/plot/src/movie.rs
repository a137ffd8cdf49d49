//! Runs as animations (GIF): map, obstacles, and robots with past paths.

mod frames;
mod palette;

use super::canvas::{Anchor, Canvas, Point, Stroke, Text, extent, longest};
use super::colour::{self, Colour, INK, WHITE};
use super::map::{self, Map};
use super::raster;
use frames::Frames;
use gif::{DisposalMethod, Encoder, Repeat};
use palette::{CLEAR, Palette};
use staya_controller::robot::Mode;
use staya_sim::record::{Error, Frame, History, Sample};
use staya_sim::scenario::Scenario;
use staya_sim::terrain::Terrain;
use staya_sim::world::plane::Solid;
use std::path::Path;

/// Browsers do not show more.
const MOST_PER_SECOND: u32 = 20;
/// Hundredths of a second.
const LAST: u16 = 200;
const MOST_WAYS: usize = 60;
const NAMED: usize = 12;
/// Fraction of the longer side of all paths.
const MARGIN: f64 = 0.07;
/// Range of height / width.
const SHAPE: [f64; 2] = [0.5, 1.2];
const STONE: Colour = Colour::hex(0xc9_c4_bb);
const STONE_EDGE: Colour = Colour::hex(0x4f_48_3c);
const INTRUDER: Colour = Colour::hex(0xa0_1c_1c);
const EDGE: Colour = Colour::hex(0x4b_2e_83);

/// Size and length of an animation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    /// Width in pixels, 64 to 1920.
    pub width: u32,
    /// Length without the last frame, seconds.
    pub seconds: u32,
}

/// Encodes a run as a GIF of at most 20 frames per second with one palette. Frames contain only
/// changed pixels. O(pixels of all frames).
///
/// # Errors
/// The frames would have no pixels or too many.
pub fn of_run(scenario: &Scenario, history: &History, look: Look) -> Result<Vec<u8>, Error> {
    encode(scenario, history, look).map_err(|error| Error::new("draw", Path::new(&scenario.name))(error))
}

fn encode(scenario: &Scenario, history: &History, look: Look) -> std::io::Result<Vec<u8>> {
    let chosen = choose(history.frames(), look.seconds.saturating_mul(MOST_PER_SECOND));
    let view = View::new(scenario, history.frames(), look.width);
    let mut frames = Frames::new(raster::over(None, &view.ground(scenario, history))?);
    // The palette comes from some sample frames: drawing these twice costs less than storing them.
    let mut samples = Vec::new();
    let every = chosen.len().div_ceil(6).max(1);
    let mut drawn = frames.clone();
    for (number, frame) in chosen.iter().enumerate() {
        let pixmap = drawn.next(scenario, &view, frame)?;
        if number % every == every - 1 || number + 1 == chosen.len() {
            samples.push(pixmap);
        }
    }
    let palette = Palette::new(&samples);
    drop(samples);

    let mut bytes = Vec::new();
    let [width, height] = [view.size[0] as u16, view.size[1] as u16];
    let failed = |error: gif::EncodingError| std::io::Error::other(error.to_string());
    let mut encoder = Encoder::new(&mut bytes, width, height, palette.colours()).map_err(failed)?;
    encoder.set_repeat(Repeat::Infinite).map_err(failed)?;
    let delay = (look.seconds * 100).checked_div(chosen.len() as u32).unwrap_or(0).clamp(100 / MOST_PER_SECOND, 100);
    let mut before = None;
    for (number, frame) in chosen.iter().enumerate() {
        let now = palette.indices(&frames.next(scenario, &view, frame)?);
        let [left, top, wide, high] = changed(before.as_deref(), &now, width.into(), height.into());
        let buffer = cut(before.as_deref(), &now, width.into(), [left, top, wide, high]);
        let is_last = number + 1 == chosen.len();
        let picture = gif::Frame {
            delay: if is_last { LAST } else { delay as u16 },
            dispose: DisposalMethod::Keep,
            transparent: Some(CLEAR),
            left: left as u16,
            top: top as u16,
            width: wide as u16,
            height: high as u16,
            buffer: buffer.into(),
            ..gif::Frame::default()
        };
        encoder.write_frame(&picture).map_err(failed)?;
        before = Some(now);
    }
    drop(encoder);
    Ok(bytes)
}

/// Evenly spaced frames, with the first and the last one.
fn choose(frames: &[Frame], most: u32) -> Vec<&Frame> {
    let last = frames.len().saturating_sub(1);
    let count = frames.len().min(most.max(2) as usize);
    let at = |number: usize| last * number / count.saturating_sub(1).max(1);
    (0..count).map(|number| &frames[at(number)]).collect()
}

/// Left, top, width, height; at least one pixel.
fn changed(before: Option<&[u8]>, now: &[u8], width: usize, height: usize) -> [usize; 4] {
    let Some(before) = before else {
        return [0, 0, width, height];
    };
    let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
    for (at, _) in before.iter().zip(now).enumerate().filter(|(_, (before, now))| before != now) {
        let place = [at % width, at / width];
        for axis in 0..2 {
            low[axis] = low[axis].min(place[axis]);
            high[axis] = high[axis].max(place[axis]);
        }
    }
    if low[0] == usize::MAX { [0, 0, 1, 1] } else { [low[0], low[1], high[0] - low[0] + 1, high[1] - low[1] + 1] }
}

/// Unchanged pixels are transparent.
fn cut(before: Option<&[u8]>, now: &[u8], width: usize, [left, top, wide, high]: [usize; 4]) -> Vec<u8> {
    let rows = (top..top + high).flat_map(|row| row * width + left..row * width + left + wide);
    rows.map(|at| match before {
        Some(before) if before[at] == now[at] => CLEAR,
        _ => now[at],
    })
    .collect()
}

#[derive(Clone, Debug)]
struct View {
    low_m: [f64; 2],
    /// Pixels per metre.
    scale: f64,
    size: [f64; 2],
    /// Radius of each robot, pixels.
    radii: Vec<f64>,
}

impl View {
    fn new(scenario: &Scenario, frames: &[Frame], width: u32) -> Self {
        let places = frames.iter().flat_map(|frame| &frame.samples).map(|sample| sample.position_m);
        let [mut low, mut high] = extent(places.chain(goals(scenario).into_iter().map(|(_, goal)| goal)));
        let mut longest = longest([low, high]);
        if !longest.is_finite() {
            (low, high, longest) = ([0.0; 2], [1.0; 2], 1.0);
        }
        let body_m = scenario.plane.as_ref().map_or(scenario.terrain.cell_m, |setup| setup.general.radius_m * 2.0);
        let margin = longest * MARGIN + body_m;
        let sides = [0, 1].map(|axis| high[axis] - low[axis] + 2.0 * margin);
        let middle = [0, 1].map(|axis| low[axis] + (high[axis] - low[axis]) / 2.0);
        let width = f64::from(width);
        let height = libm::round(width * (sides[1] / sides[0]).clamp(SHAPE[0], SHAPE[1]));
        let scale = (width / sides[0]).min(height / sides[1]);
        let low_m = [middle[0] - width / scale / 2.0, middle[1] - height / scale / 2.0];
        let robots = scenario.robots.len();
        let least = match robots {
            0..=NAMED => 4.5,
            13..=100 => 3.0,
            101..=1000 => 2.0,
            _ => 1.2,
        };
        let radius_m = |index: usize| match &scenario.plane {
            Some(setup) => setup.group(index).radius_m,
            None => scenario.terrain.cell_m * 0.35,
        };
        let radii = (0..robots).map(|index| (radius_m(index) * scale).max(least)).collect();
        Self { low_m, scale, size: [width, height], radii }
    }

    fn at(&self, place_m: [f64; 2]) -> Point {
        let [x, y] = [0, 1].map(|axis| (place_m[axis] - self.low_m[axis]) * self.scale);
        [x.clamp(-1e5, 1e5), (self.size[1] - y).clamp(-1e5, 1e5)]
    }

    fn ground(&self, scenario: &Scenario, history: &History) -> Canvas {
        let mut canvas = Canvas::new(self.size[0], self.size[1], &scenario.name);
        canvas.rectangle([0.0, 0.0, self.size[0], self.size[1]], Some(WHITE), None);
        let setup = scenario.plane.as_ref();
        if setup.is_none_or(|setup| setup.has_terrain) {
            self.land(&scenario.terrain, &mut canvas);
        }
        for solid in setup.map_or(&[][..], |setup| &setup.solids) {
            match *solid {
                Solid::Wall(ends) => canvas.line(ends.map(|end| self.at(end)).into(), Stroke::new(STONE_EDGE, 2.4)),
                Solid::Ball { center_m: [x, y, _], radius_m } => {
                    let radius = (radius_m * self.scale).min(1e5);
                    canvas.circle(self.at([x, y]), radius, Some(STONE), Some(Stroke::new(STONE_EDGE, 1.0)));
                }
                Solid::Plane { .. } => {}
            }
        }
        let ends = ends(scenario, history);
        for (index, goal) in ends.into_iter().take(1000) {
            let arm = self.radii.get(index).copied().unwrap_or(4.0).clamp(2.0, 6.0);
            canvas.cross(self.at(goal), arm, 3.6, Stroke::new(colour_of(scenario, index), 1.8));
        }
        canvas
    }

    fn land(&self, terrain: &Terrain, canvas: &mut Canvas) {
        let cells = |metres: f64, axis: usize| (metres - terrain.origin_m[axis]) / terrain.cell_m;
        let low = [0, 1].map(|axis| cells(self.low_m[axis], axis));
        let high = [0, 1].map(|axis| cells(self.low_m[axis] + self.size[axis] / self.scale, axis));
        let Some(part) = map::part(terrain, low, high) else { return };
        let [left, bottom] = self.at(part.origin_m);
        let cell = part.cell_m * self.scale;
        Map::of_scale(&part, [left, bottom - f64::from(part.height()) * cell], cell).ground(canvas);
    }

    fn moving(&self, scenario: &Scenario, frame: &Frame) -> Canvas {
        let mut canvas = Canvas::new(self.size[0], self.size[1], "");
        if !scenario.formations.is_empty() {
            let at = |index: usize| frame.samples.get(index).map(|sample| self.at(sample.position_m));
            let edges: Vec<_> = scenario.edges().filter_map(|[a, b]| Some(vec![at(a)?, at(b)?])).collect();
            canvas.lines(edges.clone(), Stroke::new(WHITE.with_alpha(150), 2.8));
            canvas.lines(edges, Stroke::new(EDGE, 1.2));
        }
        for intruder in scenario.plane.iter().flat_map(|setup| &setup.intruders) {
            let [x, y] = [0, 1].map(|axis| intruder.position_m[axis] + intruder.velocity_mps[axis] * frame.time_s);
            let radius = (intruder.radius_m * self.scale).clamp(3.0, 1e5);
            canvas.circle(self.at([x, y]), radius, Some(INTRUDER), Some(Stroke::new(WHITE, 1.0)));
        }
        for (index, sample) in frame.samples.iter().enumerate() {
            self.body(&mut canvas, index, sample, colour_of(scenario, index));
        }
        let text = format!("{}   {:.0} s", scenario.name, frame.time_s);
        let mut clock = Text::new([10.0, self.size[1] - 10.0], 14.0, Anchor::Start, text);
        (clock.colour, clock.halo, clock.bold) = (INK, Some(WHITE), true);
        canvas.text(clock);
        canvas
    }

    fn body(&self, canvas: &mut Canvas, index: usize, sample: &Sample, colour: Colour) {
        let radius = self.radii.get(index).copied().unwrap_or(2.0);
        let (fill, edge) = match sample.mode {
            Mode::Arrived => (colour.towards(WHITE, 0.55), colour),
            Mode::Fault => (INK, colour),
            _ => (colour, WHITE),
        };
        let edge = (radius >= 2.0).then(|| Stroke::new(edge, (radius * 0.25).clamp(0.6, 1.6)));
        canvas.circle(self.at(sample.position_m), radius, Some(fill), edge);
    }
}

/// Few robots have individual colours, many have their group's.
fn colour_of(scenario: &Scenario, index: usize) -> Colour {
    let group = scenario.plane.as_ref().and_then(|setup| setup.starts.get(index)?.group);
    match group {
        Some(group) => colour::nth(group + 1),
        None if scenario.robots.len() <= MOST_WAYS => colour::nth(index),
        None => colour::nth(0),
    }
}

fn goals(scenario: &Scenario) -> Vec<(usize, [f64; 2])> {
    let starts = scenario.plane.iter().flat_map(|setup| setup.starts.iter().enumerate());
    let places = starts.flat_map(|(index, start)| start.places.iter().map(move |place| (index, place.position_m)));
    places.map(|(index, [x, y, _])| (index, [x, y])).collect()
}

/// Goals with robot indices: points in the plane, or the last target cells on a grid.
fn ends(scenario: &Scenario, history: &History) -> Vec<(usize, [f64; 2])> {
    let places = goals(scenario);
    if !places.is_empty() {
        return places;
    }
    let land = &scenario.terrain;
    let has_cells = scenario.plane.as_ref().is_none_or(|setup| setup.has_terrain);
    let last = history.frames().last().filter(|_| has_cells);
    let samples = last.map_or(&[][..], |frame| &frame.samples).iter().enumerate();
    samples.filter(|(_, s)| land.index(s.target).is_some()).map(|(i, s)| (i, land.center_m(s.target))).collect()
}

#[cfg(test)]
mod tests;
