//! Legend of a sheet: rows below its title, for the marks that it contains.

use super::{Sheet, Snapshot, marks};
use crate::canvas::{Canvas, Point, Stroke};
use crate::colour::{self, INK, WHITE};
use crate::layout::{self, Entry};

const MARK: f64 = 24.0;
const PAD: f64 = 14.0;

/// Returns the lower end of the legend.
pub fn draw(sheet: &Sheet, canvas: &mut Canvas, top: f64) -> f64 {
    let right = canvas.width - PAD;
    layout::legend(canvas, &entries(sheet), [PAD, top], right, 16.0)
}

fn entries(sheet: &Sheet) -> Vec<Entry<'static>> {
    let any = |has: &dyn Fn(&Snapshot) -> bool| sheet.snapshots.iter().any(has);
    let speeds = sheet.snapshots.iter().flat_map(|moment| &moment.velocities_mps).map(|&[x, y]| libm::hypot(x, y));
    let fastest = speeds.filter(|speed| speed.is_finite()).fold(0.0, f64::max);
    let near_m = sheet.snapshots.iter().find_map(|moment| moment.edges_within_m);
    let colour = colour::nth(0);
    let middle = |[x, y]: Point| [x + MARK / 2.0, y];
    let line =
        |stroke| move |canvas: &mut Canvas, [x, y]: Point| canvas.line(vec![[x + 2.0, y], [x + MARK - 2.0, y]], stroke);
    let mut entries = Vec::new();
    if any(&|moment| !moment.positions_m.is_empty()) {
        entries.push(Entry::new(MARK, "robot", move |canvas, at| {
            canvas.circle(middle(at), 6.0, Some(colour.towards(WHITE, 0.55)), Some(Stroke::new(colour, 1.0)));
        }));
    }
    if fastest > 0.0 {
        let name = format!("its velocity, {fastest:.2} m/s the longest");
        entries.push(Entry::new(MARK, name, |canvas, [x, y]| {
            let arrow = marks::arrow([x + 3.0, y], [1.0, 0.0], MARK - 6.0);
            canvas.lines(arrow.to_vec(), Stroke::new(INK, 1.0));
        }));
    }
    if any(&|moment| moment.trails_m.iter().any(|way| way.len() > 1)) {
        entries.push(Entry::new(MARK, "its way so far", line(Stroke::new(colour.towards(WHITE, 0.45), 1.2))));
    }
    if any(&|moment| !moment.goals_m.is_empty()) {
        entries.push(Entry::new(MARK, "a goal", move |canvas, at| marks::goal(middle(at), canvas)));
    }
    if any(&|moment| !moment.obstacles.is_empty()) {
        entries.push(Entry::new(MARK, "an obstacle", line(Stroke::new(marks::STONE_EDGE, 2.2))));
    }
    if let Some(within_m) = near_m {
        entries.push(Entry::new(MARK, format!("{within_m} m apart at most"), line(Stroke::new(marks::EDGE, 1.0))));
    }
    entries
}
