//! `plane.torus_m`: a plane with periodic borders.

use super::super::source::Source;
use super::super::{ScenarioError, ScenarioFile};
use super::PlaneSetup;
use super::table::PlaneTable;
use crate::nearby::Space;
use staya_controller::agent::{GuidanceKind, GuidanceSetup};

/// Height of the space, metres. A minimal height keeps the spatial index to one layer.
const HIGH_M: f64 = 0.001;

pub(super) fn space(torus_m: Option<[f64; 2]>) -> Space<f64, 3> {
    torus_m.and_then(|[width, height]| Space::torus([width, height, HIGH_M])).unwrap_or(Space::OPEN)
}

pub(super) fn check(
    source: &Source<'_>,
    file: &ScenarioFile,
    table: &PlaneTable,
    setup: &PlaneSetup,
) -> Result<(), ScenarioError> {
    let Some(sides) = setup.torus_m else {
        return Ok(());
    };
    let refuse = |field: &str, what: String, remedy: &str| Err(source.error(field, what, remedy));
    for (axis, side_m) in sides.into_iter().enumerate() {
        let field = format!("plane.torus_m[{axis}]");
        let side_mm = side_m * 1000.0;
        if (side_mm - libm::round(side_mm)).abs() > 1e-6 {
            return refuse(
                &field,
                format!("{side_m} m is not a whole number of millimetres"),
                "round it; robots transmit positions in millimetres",
            );
        }
    }
    let shortest_m = sides[0].min(sides[1]);
    for group in setup.kinds() {
        let GuidanceSetup::Boids { params, .. } = &group.guidance else {
            let what = format!("robots with guidance \"{}\" know of no torus", group.guidance.kind().name());
            let remedy = format!("give all of them guidance \"{}\", or leave it out", GuidanceKind::Boids.name());
            return refuse("plane.torus_m", what, &remedy);
        };
        if f64::from(params.closest_m) > shortest_m / 2.0 {
            let what = format!("boids that see {} m see others twice on a side of {shortest_m} m", params.closest_m);
            return refuse("plane.torus_m", what, "give sides of twice plane.boids.closest_m at least");
        }
    }
    let has_obstacles = !(setup.solids.is_empty() && setup.intruders.is_empty() && table.balls.is_empty());
    if has_obstacles || setup.has_terrain || !file.attack.is_empty() {
        let what = String::from("land, obstacles, intruders and attackers know of no torus");
        return refuse("plane.torus_m", what, "leave them out, or the torus");
    }
    let is_out = |place: [f64; 3]| place[2] != 0.0 || (0..2).any(|axis| !(0.0..sides[axis]).contains(&place[axis]));
    match setup.starts.iter().position(|start| is_out(start.position_m)) {
        None => Ok(()),
        Some(index) => {
            let [width, height] = sides;
            let what = format!("robot {} starts beside the torus", index + 1);
            refuse("plane.robots", what, &format!("start within 0 to {width} and 0 to {height}, at height 0"))
        }
    }
}
