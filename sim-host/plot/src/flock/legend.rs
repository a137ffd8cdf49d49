//! Legend of a sheet: rows below its title, for the marks that it contains.

use super::{Body, Sheet, Snapshot, marks};
use crate::canvas::{Canvas, Stroke};
use crate::colour::{Colour, INK, MUTED};
use crate::layout::{self, Entry};
use crate::map;
use staya_sim::world::plane::Solid;

const PAD: f64 = 14.0;
const ARROW: f64 = 20.0;

/// Returns the lower end of the legend.
pub fn draw(sheet: &Sheet, keys: &[(String, Colour)], canvas: &mut Canvas, top: f64) -> f64 {
    let right = canvas.width - PAD;
    layout::legend(canvas, &entries(sheet, keys), [PAD, top], right, 16.0)
}

fn entries(sheet: &Sheet, keys: &[(String, Colour)]) -> Vec<Entry<'static>> {
    let any = |has: &dyn Fn(&Snapshot) -> bool| sheet.snapshots.iter().any(has);
    let fastest = sheet.snapshots.iter().map(marks::fastest).fold(0.0, f64::max);
    let mut entries: Vec<_> = keys.iter().map(|(name, colour)| Entry::disc(name, *colour)).collect();
    if any(&|moment| moment.bodies.iter().any(|body| body.is_pale)) {
        let body = Body { colour: MUTED, is_pale: true, ..Body::default() };
        entries.push(Entry::mark("arrived", move |canvas, at| marks::disc(canvas, at, 5.0, &body)));
    }
    if fastest > 0.0 {
        entries.push(Entry::new(ARROW, format!("velocity, longest {fastest:.2} m/s"), |canvas, [x, y]| {
            canvas.lines(marks::arrow([x, y], [x + ARROW, y]).to_vec(), Stroke::new(INK, 1.0));
        }));
    }
    if any(&|moment| moment.trails.iter().any(|(way, _)| way.len() > 1)) {
        entries.push(Entry::line("past path", Stroke::new(MUTED, 1.2)));
    }
    if any(&|moment| !moment.goals.is_empty()) {
        entries.push(Entry::mark("goal", |canvas, at| marks::goal(at, MUTED, canvas)));
    }
    if any(&|moment| !moment.edges.is_empty()) {
        entries.push(Entry::line("formation", Stroke::new(marks::EDGE, 1.2)));
    }
    if any(&|moment| moment.solids.iter().any(|solid| !matches!(solid, Solid::Plane { .. }))) {
        entries.push(Entry::line("obstacle", Stroke::new(marks::STONE_EDGE, 2.2)));
    }
    if any(&|moment| moment.is_space && moment.downwash > 1.0) {
        entries.push(Entry::square("column of blown air", MUTED.with_alpha(marks::AIR)));
    }
    if let Some(land) = sheet.snapshots.iter().find_map(|moment| moment.land.as_ref()) {
        entries.extend(map::entries(land, map::PALE));
    }
    entries
}
