//! Trajectories: the map, a line per robot, and the formation from early to late.

use super::canvas::{Canvas, Point, Shape, Stroke, extent, longest};
use super::colour::{self, Colour, INK, WHITE};
use super::crowd::{self, Density};
use super::layout::{Entry, heading, legend, note};
use super::map::{self, Map};
use super::story::evenly;
use super::{raster, ticks};
use staya_controller::grid::Cell;
use staya_record::scene::ColourBy;
use staya_sim::record::{Frame, History};
use staya_sim::terrain::Terrain;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io;

/// Larger swarms have one colour and no names.
const NAMED: usize = ColourBy::MOST_ROBOTS;
/// Larger swarms show the visits of each cell instead of paths and formation.
const CROWD: usize = 200;
/// Larger swarms show no starts and targets.
const MAX_ENDS: usize = 2000;
/// With more points, paths are pixels in the SVG too, which bounds its size.
const MAX_POINTS: usize = 60_000;
/// Side of a map that is always shown completely, cells.
const SMALL_MAP: f64 = 100.0;
const MOMENTS: usize = 8;
const PAD: f64 = 16.0;
const MIN_WIDTH: f64 = 480.0;

/// Points closer to the previous one are skipped; units.
const NEAR: f64 = 0.25;

/// Path in metres, and centre of the last target cell if it is on the map.
#[derive(Debug, Default)]
struct Way {
    positions_m: Vec<[f64; 2]>,
    target_m: Option<[f64; 2]>,
}

/// `changing`: sorted cells that differ from `terrain` at some time.
pub fn draw(
    of: &str,
    terrain: &Terrain,
    changing: &[Cell],
    history: &History,
    edges: &[(u32, u32)],
) -> io::Result<Canvas> {
    let ways = ways(terrain, history.frames());
    let view = view(terrain, &ways);
    let crowd = (ways.len() > CROWD).then(|| {
        let map = Map::new(&view, [0.0; 2]);
        Density::new(&map, ways.values().map(|way| &way.positions_m[..]))
    });
    let with_edges = crowd.is_none() && !edges.is_empty();

    let title = title(of, history.frames(), ways.len());
    let width = Map::new(&view, [0.0; 2]).area[2].max(MIN_WIDTH) + 2.0 * PAD;
    let room = width - 2.0 * PAD;
    let mut canvas = Canvas::new(width, 0.0, &title);
    heading(&mut canvas, &title, 16.0, [PAD, PAD + 15.0], room);
    note(&mut canvas, &about(terrain, &view, ways.len()), [PAD, PAD + 34.0], room);
    let mut entries = match &crowd {
        Some(density) => crowd_entries(density, ways.len()),
        None => entries(&ways, with_edges),
    };
    if !changing.is_empty() {
        entries.push(Entry::square("land that changes", CHANGING));
    }
    let top = legend(&mut canvas, &entries, [PAD, PAD + 42.0], width - PAD, 14.0) + 8.0;

    let map = Map::new(&view, [PAD, top]);
    canvas.height = top + map.area[3] + map::FOOTER + 6.0;
    canvas.clip(Some(map.area));
    map.ground(&mut canvas);
    for cells in changing.chunk_by(|below, cell| below.x == cell.x && below.y + 1 == cell.y) {
        let ([left, bottom], high) = (map.place(corner_m(terrain, cells[0])), map.cell * cells.len() as f64);
        canvas.rectangle([left, bottom - high, map.cell, high], Some(CHANGING), None);
    }
    if let Some(density) = crowd {
        map.image(&mut canvas, density.pixels());
        if ways.len() <= MAX_ENDS {
            draw_crowd_ends(&mut canvas, &map, &ways);
        }
    } else {
        draw_ways(&mut canvas, &map, &ways)?;
        if with_edges {
            draw_formation(&mut canvas, &map, history.frames(), edges, &ways);
        }
        draw_ends(&mut canvas, &map, &ways);
    }
    canvas.clip(None);
    map.frame(&mut canvas);
    map.footer(&mut canvas, PAD, width - PAD);
    Ok(canvas)
}

const CHANGING: Colour = colour::PALETTE[1].with_alpha(110);

fn corner_m(terrain: &Terrain, cell: Cell) -> [f64; 2] {
    let [x, y] = terrain.origin_m;
    [x + f64::from(cell.x) * terrain.cell_m, y + f64::from(cell.y) * terrain.cell_m]
}

fn title(of: &str, frames: &[Frame], robots: usize) -> String {
    let (Some(first), Some(last)) = (frames.first(), frames.last()) else {
        return format!("{of}: no robot was recorded");
    };
    let plural = if robots == 1 { "" } else { "s" };
    let seconds = last.time_s - first.time_s;
    let robots = ticks::grouped(robots as u64);
    format!("{of}: trajectories of {robots} robot{plural} over {seconds:.0} s")
}

fn about(terrain: &Terrain, view: &Terrain, robots: usize) -> String {
    let size = map::size(view);
    let all = (terrain.width(), terrain.height());
    let part = if (view.width(), view.height()) == all {
        String::new()
    } else {
        format!(", part of a map of {} × {}", all.0, all.1)
    };
    let lanes = if (2..=NAMED).contains(&robots) { "; ways through the same cells are drawn side by side" } else { "" };
    size + &part + lanes
}

fn ways(terrain: &Terrain, frames: &[Frame]) -> BTreeMap<u32, Way> {
    let mut ways: BTreeMap<u32, Way> = BTreeMap::new();
    for frame in frames {
        for sample in &frame.samples {
            let way = ways.entry(sample.id).or_default();
            way.target_m = terrain.index(sample.target).map(|_| terrain.center_m(sample.target));
            let [x, y, _] = sample.position_m;
            if x.is_finite() && y.is_finite() {
                way.positions_m.push([x, y]);
            }
        }
    }
    ways
}

fn view<'a>(terrain: &'a Terrain, ways: &BTreeMap<u32, Way>) -> Cow<'a, Terrain> {
    let sides = [terrain.width(), terrain.height()].map(f64::from);
    let places = ways.values().flat_map(|way| way.positions_m.iter().chain(&way.target_m));
    let cells = places.map(|at| [0, 1].map(|axis| (at[axis] - terrain.origin_m[axis]) / terrain.cell_m));
    let [low, high] = extent(cells);
    let reach = longest([low, high]);
    if !reach.is_finite() || sides[0].max(sides[1]) <= SMALL_MAP {
        return Cow::Borrowed(terrain);
    }
    let margin = (reach * 0.2).max(6.0);
    let part = map::part(terrain, low.map(|low| low - margin), high.map(|high| high + margin));
    let is_small = |part: &Terrain| f64::from(part.width()) * f64::from(part.height()) <= 0.4 * sides[0] * sides[1];
    part.filter(is_small).map_or(Cow::Borrowed(terrain), Cow::Owned)
}

fn look(index: usize, robots: usize) -> Stroke {
    match robots {
        0..=NAMED => Stroke::new(colour::nth(index), 1.9),
        8..=50 => Stroke::new(colour::nth(0), 1.3),
        _ => Stroke::new(colour::nth(0), 0.9),
    }
}

fn draw_ways(canvas: &mut Canvas, map: &Map<'_>, ways: &BTreeMap<u32, Way>) -> io::Result<()> {
    let lane = lane_width(map, ways.len());
    let middle = (ways.len().max(1) - 1) as f64 / 2.0;
    let lines: Vec<Vec<Point>> = ways
        .values()
        .enumerate()
        .map(|(index, way)| {
            let by = (index as f64 - middle) * lane;
            let line = line(map, way).into_iter();
            line.map(|[x, y]| [x + by, y + by]).collect()
        })
        .collect();
    let points: usize = lines.iter().map(Vec::len).sum();
    if points <= MAX_POINTS {
        draw_lines(canvas, lines, lane);
        return Ok(());
    }
    let [left, top, width, height] = map.area;
    let mut layer = Canvas::new(width, height, "");
    let lines = lines.into_iter().map(|line| {
        let moved = line.into_iter().map(|[x, y]| [x - left, y - top]);
        moved.collect()
    });
    draw_lines(&mut layer, lines.collect(), lane);
    canvas.shapes.push(Shape::Image { area: map.area, pixels: raster::layer(&layer, raster::SCALE)? });
    Ok(())
}

/// Offset of paths to the south-east, so that paths through the same cells run side by side: two
/// thirds of a cell for all paths together, or a line's width each if that is more. Dots, starts
/// and targets are not shifted.
fn lane_width(map: &Map<'_>, robots: usize) -> f64 {
    match robots {
        2..=NAMED => (map.cell * 0.67 / robots as f64).clamp(1.3, 2.2),
        _ => 0.0,
    }
}

fn line(map: &Map<'_>, way: &Way) -> Vec<Point> {
    let mut line: Vec<Point> = Vec::new();
    for position in &way.positions_m {
        let point = map.place(*position);
        match line[..] {
            [.., last] if close(last, point) => continue,
            [.., before, last] if straight(before, last, point) => {
                line.pop();
            }
            _ => {}
        }
        line.push(point);
    }
    line
}

fn close(a: Point, b: Point) -> bool {
    (a[0] - b[0]).abs() < NEAR && (a[1] - b[1]).abs() < NEAR
}

fn straight(a: Point, b: Point, c: Point) -> bool {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
    let cross = u[0] * v[1] - u[1] * v[0];
    let along = u[0] * v[0] + u[1] * v[1];
    along > 0.0 && cross.abs() <= 1e-6 * along
}

/// A pale outline separates the lines from dark ground.
fn draw_lines(canvas: &mut Canvas, lines: Vec<Vec<Point>>, lane: f64) {
    let robots = lines.len();
    if robots <= NAMED {
        let seam = Stroke::new(WHITE.with_alpha(170), 3.6);
        canvas.lines(lines.clone(), seam);
    }
    for (index, line) in lines.into_iter().enumerate() {
        let stroke = look(index, robots);
        let width = if lane > 0.0 { stroke.width.min(lane) } else { stroke.width };
        canvas.line(line, Stroke { width, ..stroke });
    }
}

fn draw_crowd_ends(canvas: &mut Canvas, map: &Map<'_>, ways: &BTreeMap<u32, Way>) {
    let places = |ends: Vec<&[f64; 2]>| ends.into_iter().map(|end| vec![map.place(*end)]).collect();
    let starts = ways.values().filter_map(|way| way.positions_m.first()).collect();
    let targets = ways.values().filter_map(|way| way.target_m.as_ref()).collect();
    let size = (map.cell * 0.6).clamp(1.2, 4.0);
    for ((colour, _), ends) in CROWD_ENDS.into_iter().zip([starts, targets]) {
        canvas.lines(places(ends), Stroke::new(colour, size));
    }
}

const CROWD_ENDS: [(Colour, &str); 2] = [(colour::PALETTE[2], "starts"), (colour::PALETTE[1], "targets")];

fn draw_ends(canvas: &mut Canvas, map: &Map<'_>, ways: &BTreeMap<u32, Way>) {
    let size = if ways.len() <= NAMED { 5.0 } else { (map.cell * 0.45).clamp(1.2, 4.0) };
    for (index, way) in ways.values().enumerate() {
        let colour = look(index, ways.len()).colour;
        if let Some(start) = way.positions_m.first() {
            ring(canvas, map.place(*start), size, colour);
        }
        if let Some(target) = way.target_m {
            cross(canvas, map.place(target), size, colour);
        }
    }
}

fn ring(canvas: &mut Canvas, at: Point, radius: f64, colour: Colour) {
    // Filled, because the path starts below the ring.
    canvas.circle(at, radius * 1.4, Some(WHITE), None);
    canvas.circle(at, radius, None, Some(Stroke::new(colour, radius * 0.4)));
}

fn cross(canvas: &mut Canvas, at: Point, size: f64, colour: Colour) {
    canvas.cross(at, size, size * 0.8, Stroke::new(colour, size * 0.4));
}

fn moment_colour(share: f64) -> Colour {
    Colour::hex(0xb0_8c_f0).towards(Colour::hex(0x1f_06_4a), share)
}

fn draw_formation(
    canvas: &mut Canvas,
    map: &Map<'_>,
    frames: &[Frame],
    edges: &[(u32, u32)],
    ways: &BTreeMap<u32, Way>,
) {
    let moments: Vec<usize> = evenly(frames.len(), MOMENTS).collect();
    for (number, &at) in moments.iter().enumerate() {
        let (frame, share) = (&frames[at], number as f64 / (moments.len() - 1).max(1) as f64);
        let places = frame.samples.iter().map(|sample| (sample.id, [sample.position_m[0], sample.position_m[1]]));
        let places = places.filter(|(_, at_m)| at_m.iter().all(|value| value.is_finite()));
        let places: BTreeMap<u32, Point> = places.map(|(id, at_m)| (id, map.place(at_m))).collect();
        let lines: Vec<Vec<Point>> =
            edges.iter().filter_map(|(a, b)| Some(vec![*places.get(a)?, *places.get(b)?])).collect();
        let colour = moment_colour(share);
        canvas.lines(lines.clone(), Stroke::new(WHITE.with_alpha(150), 2.6));
        canvas.lines(lines, Stroke::new(colour, 1.2));
        let radius = if ways.len() <= NAMED { 3.2 } else { 2.0 };
        for (index, id) in ways.keys().enumerate() {
            if let Some(place) = places.get(id) {
                let fill = look(index, ways.len()).colour;
                let edge = Stroke::new(colour, 1.0);
                canvas.circle(*place, radius, Some(fill), Some(edge));
            }
        }
    }
}

fn entries(ways: &BTreeMap<u32, Way>, with_edges: bool) -> Vec<Entry<'static>> {
    let robots = ways.len();
    let named = ways.keys().enumerate().filter(|_| robots <= NAMED);
    let name = |index, id| if index == 0 { format!("robot {id}") } else { format!("{id}") };
    let mut entries: Vec<_> = named.map(|(index, id)| Entry::line(name(index, id), look(index, robots))).collect();
    if robots > 0 {
        entries.push(Entry::mark("start", |canvas, at| ring(canvas, at, 4.5, INK)));
        entries.push(Entry::mark("goal", |canvas, at| cross(canvas, at, 4.5, INK)));
    }
    if robots > 0 && with_edges {
        entries.push(Entry::ramp("formation, early to late", 8, moment_colour));
    }
    entries
}

fn crowd_entries(density: &Density, robots: usize) -> Vec<Entry<'static>> {
    let most = ticks::grouped(density.most().into());
    let mut entries = vec![Entry::ramp(format!("times a cell was entered, 1 to {most}"), 10, crowd::colour)];
    if robots <= MAX_ENDS {
        entries.extend(CROWD_ENDS.map(|(colour, name)| Entry::disc(name, colour)));
    }
    entries
}
