//! `plane.torus_m`: a plane with periodic borders.

use super::super::Draft;
use super::super::law::LawSetup;
use super::super::source::Checked;
use super::PlaneSetup;
use super::table::PlaneTable;
use crate::nearby::Space;
use staya_controller::agent::LawSettings;

/// Height of the space, metres. A minimal height keeps the spatial index to one layer.
const HIGH_M: f64 = 0.001;

pub(super) fn space(torus_m: Option<[f64; 2]>) -> Space<f64, 3> {
    torus_m.and_then(|[width, height]| Space::torus([width, height, HIGH_M])).unwrap_or(Space::OPEN)
}

pub(super) fn check(draft: &Draft<'_>, table: &PlaneTable, setup: &PlaneSetup) -> Checked {
    let Some(sides) = setup.torus_m else { return Ok(()) };
    let (at, field) = (draft.at("plane"), "torus_m");
    for (axis, side_m) in sides.into_iter().enumerate() {
        let side_mm = side_m * 1000.0;
        let is_whole = (side_mm - libm::round(side_mm)).abs() <= 1e-6;
        let what = format!("{side_m} m is not a whole number of millimetres");
        let remedy = "round it; robots transmit positions in millimetres";
        at.require(is_whole, &format!("{field}[{axis}]"), what, remedy)?;
    }
    let shortest_m = sides[0].min(sides[1]);
    for group in setup.kinds() {
        let LawSetup::BuiltIn(LawSettings::Boids(boids)) = &group.law else {
            let what = format!("robots with the law \"{}\" know of no torus", group.law.name());
            let remedy = "give all of them law = \"boids\", or leave it out";
            return Err(at.error(field, what, remedy));
        };
        let what = format!("boids that see {} m see others twice on a side of {shortest_m} m", boids.closest_m);
        let remedy = "give sides of twice plane.boids.closest_m at least";
        at.require(f64::from(boids.closest_m) <= shortest_m / 2.0, field, what, remedy)?;
    }
    let has_obstacles = !(setup.solids.is_empty() && setup.intruders.is_empty() && table.balls.is_empty());
    let is_empty = !has_obstacles && !setup.has_terrain && draft.file.attack.is_empty();
    let what = "land, obstacles, intruders and attackers know of no torus";
    at.require(is_empty, field, what, "leave them out, or the torus")?;
    let [width, height] = sides;
    let is_out = |[x, y, z]: [f64; 3]| z != 0.0 || !(0.0..width).contains(&x) || !(0.0..height).contains(&y);
    let Some(index) = setup.starts.iter().position(|start| is_out(start.position_m)) else { return Ok(()) };
    let what = format!("robot {} starts beside the torus", index + 1);
    Err(at.error("robots", what, format!("start within 0 to {width} and 0 to {height}, at height 0")))
}
