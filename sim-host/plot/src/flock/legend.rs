//! Legend of a sheet: rows below its title, for the marks that it contains.

use super::{Sheet, Snapshot, marks};
use crate::canvas::{Anchor, Canvas, Stroke, Text};
use crate::colour::{self, INK, WHITE};
use crate::{font, layout};

const SMALL: f64 = 11.5;
const ROW: f64 = 19.0;
const MARK: f64 = 24.0;
const PAD: f64 = 14.0;

enum Mark {
    Robot,
    Arrow,
    Way,
    Goal,
    Obstacle,
    Near,
}

/// Returns the lower end of the legend.
pub fn draw(sheet: &Sheet, canvas: &mut Canvas, mut top: f64, width: f64) -> f64 {
    let mut x = PAD;
    let keys = keys(sheet);
    for (mark, name) in &keys {
        let wide = MARK + 6.0 + font::width(name, SMALL, false) * layout::OTHER_FONTS;
        if x > PAD && x + wide > width - PAD {
            (x, top) = (PAD, top + ROW);
        }
        let y = top + ROW / 2.0;
        sample(mark, canvas, [x, y]);
        canvas.text(Text::new([x + MARK + 6.0, y], SMALL, Anchor::Start, name.clone()).centred());
        x += wide + 16.0;
    }
    if keys.is_empty() { top } else { top + ROW }
}

pub fn height(sheet: &Sheet, width: f64) -> f64 {
    draw(sheet, &mut Canvas::new(width, 1.0, ""), 0.0, width)
}

fn keys(sheet: &Sheet) -> Vec<(Mark, String)> {
    let any = |has: &dyn Fn(&Snapshot) -> bool| sheet.snapshots.iter().any(has);
    let speeds = sheet.snapshots.iter().flat_map(|moment| &moment.velocities_mps).map(|&[x, y]| libm::hypot(x, y));
    let fastest = speeds.filter(|speed| speed.is_finite()).fold(0.0, f64::max);
    let near_m = sheet.snapshots.iter().find_map(|moment| moment.edges_within_m);
    let keys = [
        (Mark::Robot, any(&|moment| !moment.positions_m.is_empty()).then(|| "robot".into())),
        (Mark::Arrow, (fastest > 0.0).then(|| format!("its velocity, {fastest:.2} m/s the longest"))),
        (Mark::Way, any(&|moment| moment.trails_m.iter().any(|way| way.len() > 1)).then(|| "its way so far".into())),
        (Mark::Goal, any(&|moment| !moment.goals_m.is_empty()).then(|| "a goal".into())),
        (Mark::Obstacle, any(&|moment| !moment.obstacles.is_empty()).then(|| "an obstacle".into())),
        (Mark::Near, near_m.map(|within_m| format!("{within_m} m apart at most"))),
    ];
    keys.into_iter().filter_map(|(mark, name)| Some((mark, name?))).collect()
}

fn sample(mark: &Mark, canvas: &mut Canvas, [x, y]: [f64; 2]) {
    let (middle, ends) = ([x + MARK / 2.0, y], vec![[x + 2.0, y], [x + MARK - 2.0, y]]);
    let colour = colour::nth(0);
    match mark {
        Mark::Robot => canvas.circle(middle, 6.0, Some(colour.towards(WHITE, 0.55)), Some(Stroke::new(colour, 1.0))),
        Mark::Arrow => canvas.lines(marks::arrow([x + 3.0, y], [1.0, 0.0], MARK - 6.0).to_vec(), Stroke::new(INK, 1.0)),
        Mark::Way => canvas.line(ends, Stroke::new(colour.towards(WHITE, 0.45), 1.2)),
        Mark::Goal => marks::cross(middle, canvas),
        Mark::Obstacle => canvas.line(ends, Stroke::new(marks::STONE_EDGE, 2.2)),
        Mark::Near => canvas.line(ends, Stroke::new(marks::EDGE, 1.0)),
    }
}
