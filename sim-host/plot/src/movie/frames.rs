//! Frames of an animation: paths accumulate in the background, the rest is drawn in each frame.

use super::{MOST_WAYS, View, colour_of};
use crate::canvas::{Canvas, Stroke};
use crate::colour::WHITE;
use crate::raster;
use staya_sim::record::Frame;
use staya_sim::scenario::Scenario;
use std::io;
use tiny_skia::Pixmap;

#[derive(Clone)]
pub struct Frames {
    ground: Pixmap,
    before: Vec<[f64; 2]>,
}

impl Frames {
    pub const fn new(ground: Pixmap) -> Self {
        Self { ground, before: Vec::new() }
    }

    pub fn next(&mut self, scenario: &Scenario, view: &View, frame: &Frame) -> io::Result<Pixmap> {
        let now: Vec<_> = frame.samples.iter().take(MOST_WAYS).map(|sample| sample.position_m).collect();
        if frame.samples.len() <= MOST_WAYS && self.before.len() == now.len() {
            let mut ways = Canvas::new(view.size[0], view.size[1], "");
            for (index, (from, to)) in self.before.iter().zip(&now).enumerate().filter(|(_, (from, to))| from != to) {
                let colour = colour_of(scenario, index).towards(WHITE, 0.35);
                ways.line(vec![view.at(*from), view.at(*to)], Stroke::new(colour, 1.4));
            }
            self.ground = raster::over(Some(self.ground.clone()), &ways)?;
        }
        self.before = now;
        raster::over(Some(self.ground.clone()), &view.moving(scenario, frame))
    }
}
