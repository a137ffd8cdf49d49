//! Content of a snapshot, from bottom to top: map or floor, obstacles, paths, edges, goals, bodies.

use super::{Body, MOST_DISCS, Snapshot};
use crate::canvas::{Canvas, Point, Shape, Stroke, longest};
use crate::colour::{Colour, GRID, INK, MUTED, WHITE};
use crate::map::{self, Map};
use crate::ticks::{self, Tick};
use crate::view::{Seen, Span, View};
use staya_sim::terrain::Terrain;
use staya_sim::world::plane::Solid;

const STONE: Colour = Colour::hex(0xc9_c4_bb);
pub const STONE_EDGE: Colour = Colour::hex(0x6f_68_5c);
pub const EDGE: Colour = Colour::hex(0x4b_2e_83);
pub const INTRUDER: Colour = Colour::hex(0xa0_1c_1c);
/// Opacity of the columns of blown air.
pub const AIR: u8 = 64;
/// Corners of the lower end of a column.
const CORNERS: u32 = 16;
/// Larger swarms have no lines from the bodies down to the floor.
const MOST_STEMS: usize = 200;
/// More goals are dots.
const MOST_CROSSES: usize = 200;
/// More goals are not drawn.
const MOST_GOALS: usize = 2000;
/// Length of the fastest body's arrow outside its disc, units; it grows with the smallest radius.
const ARROW: f64 = 4.0;
/// Larger swarms have no arrows on discs with a smaller radius than that, units.
const MOST_ARROWS: usize = 100;
const LEAST_DISC: f64 = 2.6;
/// A larger part of a map is not drawn on the floor.
const MOST_FLOOR_CELLS: usize = 40_000;

pub fn ground(snapshot: &Snapshot, view: &View, canvas: &mut Canvas) {
    let [low, high] = snapshot.span();
    match &snapshot.land {
        Some(land) if snapshot.is_space => draw_land_on_floor(land, [low, high], view, canvas),
        Some(land) => draw_land(land, [low, high], view, canvas),
        None => {}
    }
    if snapshot.is_space {
        draw_floor([low, high], view, canvas);
    }
    for solid in &*snapshot.solids {
        match *solid {
            Solid::Wall(ends) => {
                if let [Some(from), Some(to)] = ends.map(|[x, y]| view.at([x, y, low[2]])) {
                    canvas.line(vec![from, to], Stroke::new(STONE_EDGE, 2.2));
                }
            }
            Solid::Ball { center_m, radius_m } if !snapshot.is_space => {
                if let Some(Seen { at, scale, .. }) = view.see(center_m) {
                    stone(canvas, at, radius_m * scale);
                }
            }
            Solid::Ball { .. } | Solid::Plane { .. } => {}
        }
    }
}

/// Draws the part of the map that is visible from above.
fn draw_land(land: &Terrain, span: Span, view: &View, canvas: &mut Canvas) {
    // Beside the span, the plot may show as much again.
    let Some(part) = part(land, span, 1.0) else { return };
    let [west, south] = part.origin_m;
    if let Some(corner) = view.at([west, south + f64::from(part.height()) * part.cell_m, 0.0]) {
        Map::of_scale(&part, corner, part.cell_m * view.scale).ground(canvas);
    }
}

/// Draws the map on the floor of a span: neighbouring cells of one class in a row as one area.
fn draw_land_on_floor(land: &Terrain, span: Span, view: &View, canvas: &mut Canvas) {
    let part = part(land, span, 0.0).filter(|part| part.cells().len() <= MOST_FLOOR_CELLS);
    let Some(part) = part else { return };
    let (most, mut areas) = (map::classes(land), Vec::new());
    let [west, south] = part.origin_m;
    for (row, cells) in (0_u32..).zip(part.cells().chunks(part.width().into())) {
        let mut x = 0;
        for run in cells.chunk_by(|a, b| a == b) {
            let ends = [x, x + run.len()].map(|x| west + x as f64 * part.cell_m);
            let [bottom, top] = [row, row + 1].map(|y| south + f64::from(y) * part.cell_m);
            let corners = [[ends[0], bottom], [ends[1], bottom], [ends[1], top], [ends[0], top]];
            let corners: Option<Vec<Point>> = corners.iter().map(|&[x, y]| view.at([x, y, span[0][2]])).collect();
            areas.extend(corners.map(|corners| (corners, map::shade(run[0], most, map::PALE))));
            x += run.len();
        }
    }
    for (colour, lines) in by_colour(areas.into_iter()) {
        // The outline closes the seams between areas.
        let stroke = Some(Stroke::new(colour, 0.4));
        canvas.shapes.push(Shape::Path { lines, closed: true, stroke, fill: Some(colour) });
    }
}

/// The part of a map in a span and `beside` it, in multiples of the span.
fn part(land: &Terrain, [low, high]: Span, beside: f64) -> Option<Terrain> {
    let margin = beside * (high[0] - low[0] + high[1] - low[1]);
    let cells = |metres: f64, axis: usize| (metres - land.origin_m[axis]) / land.cell_m;
    let ends = [(low, -margin), (high, margin)].map(|(at, by)| [0, 1].map(|axis| cells(at[axis] + by, axis)));
    map::part(land, ends[0], ends[1])
}

/// Ticks of x, y and z around a span in space.
pub fn ticks([low, high]: Span) -> [Vec<Tick>; 3] {
    let wide = longest([low, high]);
    [0, 1, 2].map(|axis| {
        let most = (6.0 * (high[axis] - low[axis]) / wide) as usize;
        ticks::linear(low[axis], high[axis], if axis == 2 { 4 } else { most.max(1) })
    })
}

/// Says what the lines of the floor measure.
pub fn lines_apart(span: Span) -> String {
    match &ticks(span)[0][..] {
        [first, second, ..] => format!("lines {} apart", map::metres(second.value - first.value)),
        _ => String::new(),
    }
}

fn draw_floor(span: Span, view: &View, canvas: &mut Canvas) {
    let [low, high] = span;
    let ([x, y, _], floor) = (ticks(span), low[2]);
    let along_y = x.iter().map(|tick| [[tick.value, low[1], floor], [tick.value, high[1], floor]]);
    let along_x = y.iter().map(|tick| [[low[0], tick.value, floor], [high[0], tick.value, floor]]);
    let line = |ends: [[f64; 3]; 2]| Some(vec![view.at(ends[0])?, view.at(ends[1])?]);
    canvas.lines(along_y.chain(along_x).filter_map(line).collect(), Stroke::new(GRID, 1.0));
    let corners = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]];
    let corners: Option<Vec<Point>> = corners.iter().map(|&[x, y]| view.at([x, y, floor])).collect();
    if let Some(corners) = corners {
        canvas.polygon(corners, None, Some(Stroke::new(MUTED, 0.9)));
    }
    let upright = line([[low[0], high[1], floor], [low[0], high[1], high[2]]]);
    canvas.lines(upright.into_iter().collect(), Stroke::new(MUTED, 0.9));
}

pub fn trails(snapshot: &Snapshot, view: &View, canvas: &mut Canvas) {
    for (trail, colour) in &snapshot.trails {
        // Pale lines would be invisible on a map.
        let colour = colour.towards(WHITE, if snapshot.land.is_some() { 0.0 } else { 0.35 });
        let lines = trail
            .split(|&at| view.at(at).is_none())
            .map(|part| part.iter().filter_map(|&at| view.at(at)).collect())
            .filter(|line: &Vec<Point>| line.len() > 1)
            .collect();
        canvas.lines(lines, Stroke::new(colour, 0.9));
    }
}

pub fn goal(at: Point, colour: Colour, canvas: &mut Canvas) {
    canvas.cross(at, 5.0, 4.2, Stroke::new(colour, 2.2));
}

/// Draws edges, goals, columns of air, and bodies, in space the far ones first.
pub fn moving(snapshot: &Snapshot, view: &View, canvas: &mut Canvas) {
    let place = |body: usize| view.at(snapshot.bodies.get(body)?.position_m);
    let edges: Vec<_> = snapshot.edges.iter().filter_map(|&[a, b]| Some(vec![place(a)?, place(b)?])).collect();
    canvas.lines(edges.clone(), Stroke::new(WHITE.with_alpha(150), 2.8));
    canvas.lines(edges, Stroke::new(EDGE, 1.2));
    goals(snapshot, view, canvas);
    if snapshot.is_space && snapshot.bodies.len() <= MOST_STEMS {
        let floor = snapshot.span()[0][2];
        let foot = |[x, y, _]: [f64; 3]| [x, y, floor];
        let stem = |body: &Body| Some(vec![view.at(foot(body.position_m))?, view.at(body.position_m)?]);
        canvas.lines(snapshot.bodies.iter().filter_map(stem).collect(), Stroke::new(MUTED.with_alpha(110), 0.8));
    }
    bodies(snapshot, view, canvas);
}

fn goals(snapshot: &Snapshot, view: &View, canvas: &mut Canvas) {
    let count = snapshot.goals.len();
    let seen = snapshot.goals.iter().filter_map(|&(goal, colour)| Some((view.at(goal)?, colour)));
    if count <= MOST_CROSSES {
        seen.for_each(|(at, colour)| goal(at, colour, canvas));
    } else if count <= MOST_GOALS {
        dots(canvas, seen.map(|(at, colour)| (at, colour.with_alpha(120))), 2.4);
    }
}

/// Draws dots, one shape for each colour.
fn dots(canvas: &mut Canvas, dots: impl Iterator<Item = (Point, Colour)>, width: f64) {
    for (colour, dots) in by_colour(dots.map(|(at, colour)| (vec![at], colour))) {
        canvas.lines(dots, Stroke::new(colour, width));
    }
}

fn by_colour(items: impl Iterator<Item = (Vec<Point>, Colour)>) -> Vec<(Colour, Vec<Vec<Point>>)> {
    let mut found: Vec<(Colour, Vec<Vec<Point>>)> = Vec::new();
    for (item, colour) in items {
        match found.iter_mut().find(|(known, _)| *known == colour) {
            Some((_, items)) => items.push(item),
            None => found.push((colour, vec![item])),
        }
    }
    found
}

/// Speed of the longest arrow, m/s.
pub fn fastest(snapshot: &Snapshot) -> f64 {
    snapshot.bodies.iter().map(|body| speed(body.velocity_mps)).fold(snapshot.fastest_mps.max(0.0), f64::max)
}

/// 0 if it is not finite.
pub fn speed(velocity: [f64; 3]) -> f64 {
    let speed = libm::sqrt(velocity.iter().map(|c| c * c).sum());
    if speed.is_finite() { speed } else { 0.0 }
}

/// Smallest radius of a body, units.
const fn least_radius(bodies: usize) -> f64 {
    match bodies {
        0..=12 => 4.5,
        13..=100 => 3.0,
        101..=1000 => 2.0,
        1001..=MOST_DISCS => 1.2,
        _ => 0.8,
    }
}

/// Bodies with a size are discs with arrows, others and the small ones of many are darts;
/// stationary ones of these are dots.
fn bodies(snapshot: &Snapshot, view: &View, canvas: &mut Canvas) {
    let (count, fastest) = (snapshot.bodies.len(), fastest(snapshot));
    let mut seen: Vec<(Seen, f64, Option<&Body>)> = Vec::new();
    seen.extend(
        snapshot.bodies.iter().filter_map(|body| Some((view.see(body.position_m)?, body.radius_m, Some(body)))),
    );
    if snapshot.is_space {
        seen.extend(snapshot.solids.iter().filter_map(|solid| match *solid {
            Solid::Ball { center_m, radius_m } => Some((view.see(center_m)?, radius_m, None)),
            _ => None,
        }));
        seen.sort_by(|(a, ..), (b, ..)| a.near.total_cmp(&b.near));
    }
    let (mut arrows, mut darts, mut dots) = (Vec::new(), Vec::new(), Vec::new());
    for (Seen { at, scale, .. }, radius_m, body) in seen {
        let Some(body) = body else {
            stone(canvas, at, radius_m * scale);
            continue;
        };
        let is_small = radius_m * scale < LEAST_DISC && count > MOST_ARROWS;
        let is_disc = radius_m > 0.0 && count <= MOST_DISCS && !is_small;
        let radius = if is_disc { (radius_m * scale).clamp(least_radius(count), 1e5) } else { 0.0 };
        let speed = speed(body.velocity_mps);
        let length = (radius + (ARROW + 1.6 * least_radius(count)) * speed / fastest) / scale;
        let ahead = [0, 1, 2].map(|axis| body.position_m[axis] + body.velocity_mps[axis] / speed * length);
        // Without a speed this is not a number.
        let tip = view.at(ahead);
        if is_disc {
            if snapshot.is_space && snapshot.downwash > 1.0 {
                column(body, snapshot.downwash, view, canvas);
            }
            disc(canvas, at, radius, body);
            arrows.extend(tip.into_iter().flat_map(|tip| arrow(at, tip)));
        } else if let Some(tip) = tip {
            darts.push((dart(at, tip, 1.4 * least_radius(count)), body.colour));
        } else {
            dots.push((at, body.colour));
        }
    }
    for (colour, lines) in by_colour(darts.into_iter()) {
        canvas.shapes.push(Shape::Path { lines, closed: true, stroke: None, fill: Some(colour) });
    }
    self::dots(canvas, dots.into_iter(), 2.0 * least_radius(count));
    canvas.lines(arrows, Stroke::new(INK.with_alpha(190), 1.0));
}

pub fn disc(canvas: &mut Canvas, at: Point, radius: f64, body: &Body) {
    let (fill, edge) =
        if body.is_pale { (body.colour.towards(WHITE, 0.55), body.colour) } else { (body.colour, WHITE) };
    canvas.circle(at, radius, Some(fill), Some(Stroke::new(edge, (radius * 0.2).clamp(0.5, 1.4))));
}

fn stone(canvas: &mut Canvas, at: Point, radius: f64) {
    if radius > 0.0 && radius < 1e5 {
        canvas.circle(at, radius, Some(STONE), Some(Stroke::new(STONE_EDGE, 1.0)));
    }
}

/// Draws the space below a flyer that others keep free: the lower half of an ellipsoid.
fn column(body: &Body, high: f64, view: &View, canvas: &mut Canvas) {
    let corner = |corner: u32| {
        let (sin, cos) = libm::sincos(std::f64::consts::PI * f64::from(corner) / f64::from(CORNERS));
        let right = view.right().map(|c| c * cos * body.radius_m);
        let [x, y, z] = [0, 1, 2].map(|axis| body.position_m[axis] + right[axis]);
        view.at([x, y, z - high * body.radius_m * sin])
    };
    if let Some(corners) = (0..=CORNERS).map(corner).collect() {
        canvas.polygon(corners, Some(body.colour.with_alpha(AIR)), None);
    }
}

pub fn arrow(from: Point, tip: Point) -> [Vec<Point>; 2] {
    let [dx, dy] = direction(from, tip);
    let barb = |side: f64| {
        let back = 3.4;
        [tip[0] - back * (dx - side * 0.55 * dy), tip[1] - back * (dy + side * 0.55 * dx)]
    };
    [vec![from, tip], vec![barb(1.0), tip, barb(-1.0)]]
}

fn dart(at: Point, tip: Point, half: f64) -> Vec<Point> {
    let [dx, dy] = direction(at, tip);
    let corner =
        |ahead: f64, left: f64| [at[0] + half * (ahead * dx + left * dy), at[1] + half * (ahead * dy - left * dx)];
    vec![corner(1.2, 0.0), corner(-0.9, 0.65), corner(-0.5, 0.0), corner(-0.9, -0.65)]
}

/// Unit vector, or 0 between equal points.
pub fn direction(from: Point, to: Point) -> Point {
    let by = [to[0] - from[0], to[1] - from[1]];
    let length = libm::hypot(by[0], by[1]);
    by.map(|c| if length > 0.0 { c / length } else { 0.0 })
}
