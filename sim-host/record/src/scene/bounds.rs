//! The part of the world that a page shows at first.

use super::is_in_space;
use staya_sim::scenario::Scenario;
use staya_sim::world::plane;

/// A fraction of the view's longer side.
const MARGIN: f64 = 0.08;
/// Obstacles this near to starts and goals are in the initial view; a fraction of its longer side.
const AROUND: f64 = 0.5;

/// The rectangle to show (west, south, east, north), and the lowest and highest place; metres from
/// the origin.
pub(super) fn bounds(scenario: &Scenario, origin_m: [f64; 3]) -> ([f64; 4], [f64; 2]) {
    let mut extent = Extent { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };
    let land = &scenario.land.terrain;
    match scenario.plane() {
        None => {
            for cell in scenario.robots.iter().flat_map(|robot| [robot.start, robot.goal]) {
                let [x, y] = land.center_m(cell);
                extent.take([x, y, 0.0], land.cell_m);
            }
        }
        Some(setup) => {
            for (index, start) in setup.starts.iter().enumerate() {
                let radius_m = setup.group(index).radius_m;
                extent.take(start.position_m, radius_m);
                start.places.iter().for_each(|place| extent.take(place.position_m, radius_m));
            }
            let most = extent.grown(AROUND);
            for solid in &setup.solids {
                match *solid {
                    plane::Solid::Wall(ends) => {
                        ends.iter().for_each(|&[x, y]| extent.take(most.nearest([x, y, extent.low[2]]), 0.0));
                    }
                    plane::Solid::Ball { center_m, radius_m } => {
                        let corners = [-radius_m, radius_m].map(|by| center_m.map(|at| at + by));
                        corners.iter().for_each(|&corner| extent.take(most.nearest(corner), 0.0));
                    }
                    plane::Solid::Plane { .. } => {}
                }
            }
        }
    }
    if !extent.longest().is_finite() {
        return ([0.0, 0.0, 1.0, 1.0], [0.0, 0.0]);
    }
    let shown = extent.grown(MARGIN);
    let millimetres = |x: f64| libm::round(x * 1000.0) / 1000.0;
    let near = |at: [f64; 3]| [0, 1].map(|axis| millimetres(at[axis] - origin_m[axis]));
    let ([west, south], [east, north]) = (near(shown.low), near(shown.high));
    let heights = [extent.low[2], extent.high[2]].map(|z| millimetres(z - origin_m[2]));
    ([west, south, east, north], if is_in_space(scenario) { heights } else { [0.0; 2] })
}

#[derive(Clone, Copy, Debug)]
struct Extent {
    low: [f64; 3],
    high: [f64; 3],
}

impl Extent {
    fn take(&mut self, at: [f64; 3], radius_m: f64) {
        for ((low, high), at) in self.low.iter_mut().zip(&mut self.high).zip(at) {
            *low = low.min(at - radius_m);
            *high = high.max(at + radius_m);
        }
    }

    /// The longer horizontal side, at least 1.
    fn longest(&self) -> f64 {
        (self.high[0] - self.low[0]).max(self.high[1] - self.low[1]).max(1.0)
    }

    fn grown(&self, share: f64) -> Self {
        let by = self.longest() * share;
        Self { low: self.low.map(|low| low - by), high: self.high.map(|high| high + by) }
    }

    fn nearest(&self, at: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| at[axis].max(self.low[axis]).min(self.high[axis]))
    }
}
