//! Content of a snapshot, from bottom to top: map, obstacles, paths, edges, goals, robots.

use super::frame::Frame;
use super::{MOST_DISCS, Obstacle, Snapshot};
use crate::canvas::{Canvas, Point, Shape, Stroke};
use crate::colour::{self, Colour, INK, WHITE};
use crate::map::Map;
use staya_sim::nearby::{Cells, Query, Search as _, Space};
use staya_sim::terrain::Terrain;

const STONE: Colour = Colour::hex(0xc9_c4_bb);
pub const STONE_EDGE: Colour = Colour::hex(0x6f_68_5c);
pub const EDGE: Colour = Colour::hex(0x9a_a8_b5);
const GOAL: Colour = Colour::hex(0xd5_5e_00);
/// Smaller discs are drawn as darts; units.
const LEAST_RADIUS: f64 = 2.6;
/// Length of the fastest robot's arrow outside its disc, units.
const ARROW: f64 = 11.0;
const DART: f64 = 4.2;
const SMALL_DART: f64 = 2.2;

pub fn draw(snapshot: &Snapshot, frame: &Frame, canvas: &mut Canvas) {
    if let Some(land) = &snapshot.land {
        ground(land, frame, canvas);
    }
    obstacles(&snapshot.obstacles, frame, canvas);
    trails(snapshot, frame, canvas);
    if let Some(range) = snapshot.edges_within_m {
        canvas.lines(edges(&snapshot.positions_m, range, frame), Stroke::new(EDGE, 0.7));
    }
    for at in snapshot.goals_m.iter().filter_map(|&goal| frame.at(goal)) {
        goal(at, canvas);
    }
    robots(snapshot, frame, canvas);
}

fn ground(land: &Terrain, frame: &Frame, canvas: &mut Canvas) {
    let [west, south] = land.origin_m;
    if let Some(corner) = frame.at([west, south + f64::from(land.height()) * land.cell_m]) {
        Map::of_scale(land, corner, land.cell_m * frame.scale).ground(canvas);
    }
}

fn obstacles(obstacles: &[Obstacle], frame: &Frame, canvas: &mut Canvas) {
    let edge = Stroke::new(STONE_EDGE, 1.0);
    for obstacle in obstacles {
        match obstacle {
            Obstacle::Polygon(corners) => {
                let corners: Option<Vec<Point>> = corners.iter().map(|&at| frame.at(at)).collect();
                if let Some(corners) = corners.filter(|corners| corners.len() > 2) {
                    canvas.polygon(corners, Some(STONE), Some(edge));
                }
            }
            Obstacle::Disc { centre_m, radius_m } => {
                let radius = radius_m * frame.scale;
                let is_sound = radius > 0.0 && radius < 1e5;
                if let Some(centre) = frame.at(*centre_m).filter(|_| is_sound) {
                    canvas.circle(centre, radius, Some(STONE), Some(edge));
                }
            }
            Obstacle::Segment(ends) => {
                if let [Some(from), Some(to)] = ends.map(|end| frame.at(end)) {
                    canvas.line(vec![from, to], Stroke::new(STONE_EDGE, 2.2));
                }
            }
        }
    }
}

fn trails(snapshot: &Snapshot, frame: &Frame, canvas: &mut Canvas) {
    for (robot, trail) in snapshot.trails_m.iter().enumerate() {
        // Pale lines would be invisible on a map.
        let paler = if snapshot.land.is_some() { 0.0 } else { 0.45 };
        let colour = colour_of(snapshot, robot).towards(WHITE, paler);
        let lines = trail
            .split(|&at| frame.at(at).is_none())
            .map(|part| part.iter().filter_map(|&at| frame.at(at)).collect())
            .filter(|line: &Vec<Point>| line.len() > 1)
            .collect();
        canvas.lines(lines, Stroke::new(colour, 0.9));
    }
}

fn edges(positions: &[[f64; 2]], range: f64, frame: &Frame) -> Vec<Vec<Point>> {
    let mut cells = Cells::new(Space::OPEN, range);
    cells.rebuild(positions);
    let (mut lines, mut found) = (Vec::new(), Vec::new());
    for (robot, &at) in (0..).zip(positions) {
        let query = Query { at, radius: range, most: usize::MAX, except: Some(robot) };
        cells.within(&query, &mut found);
        for other in found.iter().filter(|other| other.index > robot) {
            let ends = [at, positions[other.index as usize]].map(|end| frame.at(end));
            if let [Some(from), Some(to)] = ends {
                lines.push(vec![from, to]);
            }
        }
    }
    lines
}

pub fn goal(at: Point, canvas: &mut Canvas) {
    canvas.cross(at, 5.0, 4.2, Stroke::new(GOAL, 2.2));
}

fn colour_of(snapshot: &Snapshot, robot: usize) -> Colour {
    colour::nth(snapshot.groups.get(robot).copied().unwrap_or(0))
}

/// Large robots are discs with arrows, small ones darts; stationary small robots are dots.
fn robots(snapshot: &Snapshot, frame: &Frame, canvas: &mut Canvas) {
    let is_crowd = snapshot.positions_m.len() > MOST_DISCS;
    let radius = snapshot.radius_m * frame.scale;
    let are_discs = (LEAST_RADIUS..1e5).contains(&radius) && !is_crowd;
    let still = [0.0; 2];
    let velocity = |robot: usize| {
        let velocity = snapshot.velocities_mps.get(robot).copied().unwrap_or(still);
        let speed = velocity.iter().map(|c| c * c).sum::<f64>().sqrt();
        if speed.is_finite() { (velocity, speed) } else { (still, 0.0) }
    };
    let fastest = (0..snapshot.velocities_mps.len()).map(|robot| velocity(robot).1);
    let fastest = fastest.fold(snapshot.fastest_mps.max(0.0), f64::max);
    // One shape per colour, for any number of robots.
    let groups = snapshot.groups.iter().max().map_or(1, |most| most + 1);
    let groups = groups.min(colour::COUNT);
    let (mut arrows, mut darts) = (Vec::new(), vec![Vec::new(); groups]);
    let mut dots = vec![Vec::new(); groups];
    for (robot, &place) in snapshot.positions_m.iter().enumerate() {
        let Some([x, y]) = frame.at(place) else {
            continue;
        };
        let (velocity, speed) = velocity(robot);
        let ahead = if speed > 0.0 { [velocity[0] / speed, -velocity[1] / speed] } else { still };
        let group = snapshot.groups.get(robot).copied().unwrap_or(0) % groups;
        if are_discs {
            let colour = colour_of(snapshot, robot);
            let edge = Stroke::new(colour, 1.0);
            let radius = snapshot.radii_m.get(robot).map_or(radius, |own_m| own_m * frame.scale);
            canvas.circle([x, y], radius, Some(colour.towards(WHITE, 0.55)), Some(edge));
            if speed > 0.0 {
                let length = radius + ARROW * speed / fastest;
                arrows.extend(arrow([x, y], ahead, length));
            }
        } else if speed > 0.0 {
            let half = if is_crowd { SMALL_DART } else { DART };
            darts[group].push(dart([x, y], ahead, half));
        } else {
            dots[group].push(vec![[x, y]]);
        }
    }
    for (group, (darts, dots)) in darts.into_iter().zip(dots).enumerate() {
        let colour = colour::nth(group);
        if !darts.is_empty() {
            canvas.shapes.push(Shape::Path { lines: darts, closed: true, stroke: None, fill: Some(colour) });
        }
        let width = if is_crowd { 1.6 } else { 4.0 };
        canvas.lines(dots, Stroke::new(colour, width));
    }
    canvas.lines(arrows, Stroke::new(INK, 1.0));
}

pub fn arrow([x, y]: Point, [dx, dy]: Point, length: f64) -> [Vec<Point>; 2] {
    let tip = [x + dx * length, y + dy * length];
    let barb = |side: f64| {
        let back = 3.4;
        [tip[0] - back * (dx - side * 0.55 * dy), tip[1] - back * (dy + side * 0.55 * dx)]
    };
    [vec![[x, y], tip], vec![barb(1.0), tip, barb(-1.0)]]
}

fn dart([x, y]: Point, [dx, dy]: Point, half: f64) -> Vec<Point> {
    let corner = |ahead: f64, left: f64| [x + half * (ahead * dx + left * dy), y + half * (ahead * dy - left * dx)];
    vec![corner(1.2, 0.0), corner(-0.9, 0.65), corner(-0.5, 0.0), corner(-0.9, -0.65)]
}
