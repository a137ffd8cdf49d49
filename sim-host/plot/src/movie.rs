//! Runs as animations (GIF): map or floor, obstacles, and robots with past paths.

mod palette;

use super::canvas::{Anchor, Canvas, Stroke, Text, extent};
use super::colour::WHITE;
use super::flock::marks;
use super::map::scale_bar;
use super::raster;
use super::story::{MOST_TRAILS, Story, evenly};
use super::view::View;
use gif::{DisposalMethod, Encoder, Repeat};
use palette::{CLEAR, Palette};
use staya_sim::record::{Error, Frame, History};
use staya_sim::scenario::Scenario;
use std::path::Path;
use std::sync::Arc;
use tiny_skia::Pixmap;

/// Browsers do not show more.
const MOST_PER_SECOND: u32 = 20;
/// Hundredths of a second.
const LAST: u16 = 200;
/// Range of height / width.
const SHAPE: [f64; 2] = [0.5, 1.2];
/// Height of the line with the scenario, the time and the scale, pixels.
const CAPTION: f64 = 26.0;

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
    let most = look.seconds.saturating_mul(MOST_PER_SECOND) as usize;
    let chosen: Vec<&Frame> = evenly(history.frames().len(), most).map(|at| &history.frames()[at]).collect();
    let mut frames = Frames::new(scenario, history, look.width)?;
    // The palette comes from some sample frames: drawing these twice costs less than storing them.
    let mut samples = Vec::new();
    let every = chosen.len().div_ceil(6).max(1);
    let mut drawn = frames.clone();
    for (number, frame) in chosen.iter().enumerate() {
        let pixmap = drawn.next(frame)?;
        if number % every == every - 1 || number + 1 == chosen.len() {
            samples.push(pixmap);
        }
    }
    let palette = Palette::new(&samples);
    drop(samples);

    let mut bytes = Vec::new();
    let [width, height] = frames.size.map(|side| side as u16);
    let failed = |error: gif::EncodingError| std::io::Error::other(error.to_string());
    let mut encoder = Encoder::new(&mut bytes, width, height, palette.colours()).map_err(failed)?;
    encoder.set_repeat(Repeat::Infinite).map_err(failed)?;
    let delay = (look.seconds * 100).checked_div(chosen.len() as u32).unwrap_or(0).clamp(100 / MOST_PER_SECOND, 100);
    let mut before = None;
    for (number, frame) in chosen.iter().enumerate() {
        let now = palette.indices(&frames.next(frame)?);
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

/// Left, top, width, height; at least one pixel.
fn changed(before: Option<&[u8]>, now: &[u8], width: usize, height: usize) -> [usize; 4] {
    let Some(before) = before else {
        return [0, 0, width, height];
    };
    let changes = before.iter().zip(now).enumerate().filter(|(_, (before, now))| before != now);
    let [low, high] = extent(changes.map(|(at, _)| [at % width, at / width].map(|side| side as f64)));
    if low[0] > high[0] {
        return [0, 0, 1, 1];
    }
    let size = [0, 1].map(|axis| (high[axis] - low[axis]) as usize + 1);
    [low[0] as usize, low[1] as usize, size[0], size[1]]
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

/// Pictures of frames: paths accumulate in the background, the rest is drawn in each picture.
#[derive(Clone)]
struct Frames<'a> {
    story: Arc<Story<'a>>,
    view: View,
    size: [f64; 2],
    ground: Pixmap,
    before: Vec<[f64; 3]>,
}

impl<'a> Frames<'a> {
    fn new(scenario: &'a Scenario, history: &'a History, width: u32) -> std::io::Result<Self> {
        let story = Story::new(scenario, history);
        let (stage, width) = (&story.stage, f64::from(width));
        let sides = View::sides(stage.is_space, stage.span());
        let height = libm::round(width * (sides[1] / sides[0]).clamp(SHAPE[0], SHAPE[1]));
        let size = [width, height + CAPTION];
        let view = View::new(stage.is_space, stage.span(), [0.0, 0.0, width, height]);
        let mut canvas = Canvas::new(width, size[1], "");
        canvas.rectangle([0.0, 0.0, width, size[1]], Some(WHITE), None);
        canvas.clip(Some([0.0, 0.0, width, height]));
        marks::ground(stage, &view, &mut canvas);
        Ok(Self { ground: raster::over(None, &canvas)?, story: Arc::new(story), view, size, before: Vec::new() })
    }

    fn next(&mut self, frame: &Frame) -> std::io::Result<Pixmap> {
        let Self { story, view, size: [width, height], .. } = self;
        let plot = Some([0.0, 0.0, *width, *height - CAPTION]);
        let now: Vec<_> = frame.samples.iter().take(MOST_TRAILS).map(|sample| sample.position_m).collect();
        if frame.samples.len() <= MOST_TRAILS {
            let mut ways = Canvas::new(*width, *height, "");
            ways.clip(plot);
            for (robot, (&from, &to)) in self.before.iter().zip(&now).enumerate() {
                if from != to
                    && story.is_way(from, to)
                    && let [Some(from), Some(to)] = [from, to].map(|at| view.at(at))
                {
                    let colour = story.trail_colour(robot).towards(WHITE, 0.35);
                    ways.line(vec![from, to], Stroke::new(colour, 1.4));
                }
            }
            self.ground = raster::over(Some(self.ground.clone()), &ways)?;
        }
        self.before = now;
        let mut canvas = Canvas::new(*width, *height, "");
        canvas.clip(plot);
        marks::moving(&story.moment(frame), view, &mut canvas);
        canvas.clip(None);
        let middle = *height - CAPTION / 2.0;
        let text = format!("{}   {:.0} s", story.name(), frame.time_s);
        canvas.text(Text { bold: true, ..Text::new([10.0, middle], 13.0, Anchor::Start, text).centred() });
        if story.stage.is_space {
            let text = marks::lines_apart(story.stage.span());
            canvas.text(Text::new([*width - 10.0, middle], 12.0, Anchor::End, text).centred());
        } else {
            scale_bar(&mut canvas, [0.72 * *width, middle], view.scale, 0.16 * *width, |_| String::new());
        }
        raster::over(Some(self.ground.clone()), &canvas)
    }
}

#[cfg(test)]
mod tests;
