//! Builds robots with starts and goals from the `[robots]` table.

mod table;

pub use table::{RobotEntry, RobotsTable, ScatteredEntry, ScenEntry};

use super::formation::{FormationEntries, FormationEntry, FormationStarts};
use super::source::{Checked, Section};
use super::{Draft, LandSource, Part, Placed};
use crate::shown::Shown as _;
use crate::terrain::Terrain;
use crate::terrain::movingai;
use staya_controller::agent::TEMPLATE;
use staya_controller::grid::{BLOCKED, Cell};
use staya_controller::rand::Rng;
use staya_controller::robot::RobotId;
use staya_controller::template::{Template, TemplateError};
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::ops::Range;
use std::path::Path;

const PLACES: u32 = 0x0053_0001;
const GOALS: u32 = 0x0053_0002;

const TRIES: u32 = 10_000;

/// Largest number of places in a formation: a beacon encodes a place in one byte.
const MAX_PLACES: u16 = 255;

/// A robot of a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Robot {
    /// Id of the robot.
    pub id: RobotId,
    /// Start cell.
    pub start: Cell,
    /// Goal cell.
    pub goal: Cell,
}

/// A formation's graph (KUZ section 2: Phi).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Formation {
    /// Place of each robot, in cells relative to the first.
    pub places: Vec<Cell>,
    /// Pairs of neighbouring places, each pair once, the smaller index first.
    pub edges: Vec<(u16, u16)>,
    /// Knowledge of the formation in the robot of each place.
    pub templates: Vec<Template<TEMPLATE>>,
    /// Index of the robot at the first place, the top leader; the others follow in order of places.
    pub first: usize,
}

impl Formation {
    /// Robot indices of the members, counted from 0, in the order of their places.
    #[must_use]
    pub fn members(&self) -> Range<usize> {
        self.first..self.first + self.places.len()
    }

    /// Templates contain member ids, which distinguish formations.
    pub(super) fn of(mut self, first: usize, id: u32) -> Self {
        self.first = first;
        for entry in self.templates.iter_mut().flat_map(|template| &mut template.entries) {
            entry.id = RobotId(entry.id.0 - 1 + id);
        }
        self
    }
}

struct Entry {
    robot: Robot,
    field: String,
    /// The robot itself moves a goal in a wall to the nearest free cell (KUZ formation targets).
    goal_moves: bool,
    /// Line of the `.scen` that has the robot.
    line: Option<usize>,
}

impl Entry {
    fn new(number: u32, start: Cell, goal: Cell, field: impl Into<String>) -> Self {
        Self { robot: Robot { id: RobotId(number), start, goal }, field: field.into(), goal_moves: false, line: None }
    }
}

pub(super) fn build(draft: &Draft<'_>, terrain: &Terrain) -> Checked<(Vec<Robot>, Vec<Formation>)> {
    let mut formations = Vec::new();
    let entries = match &draft.file.robots {
        None => {
            let remedy = "give exactly one of list, formation, scen, scattered";
            return Err(draft.error("robots", "the table is missing", remedy));
        }
        Some(RobotsTable::List(list)) => listed(list),
        Some(RobotsTable::Formation(FormationEntries(list))) => {
            let mut entries = Vec::new();
            for (index, entry) in list.iter().enumerate() {
                let number = if list.len() == 1 { String::new() } else { format!("[{index}]") };
                let at = draft.at(format!("robots.formation{number}"));
                let (graph, mut members) = formation(&at, entry, entries.len())?;
                entries.append(&mut members);
                formations.push(graph);
            }
            entries
        }
        Some(RobotsTable::Scen(entry)) => from_scen(draft, entry, terrain)?,
        Some(RobotsTable::Scattered(entry)) => scattered(draft, entry, terrain)?,
    };
    check(draft, &entries, terrain)?;
    let mut robots: Vec<_> = entries.into_iter().map(|entry| entry.robot).collect();
    robots.sort_unstable_by_key(|robot| robot.id);
    Ok((robots, formations))
}

/// Robots that move from cell to cell.
pub(super) fn in_cells(draft: &Draft<'_>, terrain: Option<&Terrain>) -> Checked<Placed> {
    let Some(terrain) = terrain else {
        return Err(draft.error("terrain", "it is missing", "say what land is meant"));
    };
    let (robots, formations) = build(draft, terrain)?;
    let parts = formations.iter().enumerate().filter(|_| formations.len() > 1);
    let part = |(index, formation): (usize, &Formation)| Part {
        table: format!("robots.formation[{index}]"),
        members: formation.members(),
    };
    Ok(Placed { parts: parts.map(part).collect(), robots, formations })
}

pub(super) fn of_group(
    draft: &Draft<'_>,
    at: &Section<'_>,
    entry: &FormationEntry,
    terrain: &Terrain,
) -> Checked<(Vec<Robot>, Formation)> {
    let (formation, entries) = formation(at, entry, 0)?;
    check(draft, &entries, terrain)?;
    Ok((entries.into_iter().map(|entry| entry.robot).collect(), formation))
}

fn formation(at: &Section<'_>, entry: &FormationEntry, before: usize) -> Checked<(Formation, Vec<Entry>)> {
    let graph = graph(at, entry)?;
    let first = u32::try_from(before).unwrap_or(u32::MAX).saturating_add(1);
    let entries = placed(at, entry, &graph, first)?;
    Ok((graph.of(before, first), entries))
}

fn cell([x, y]: [i16; 2]) -> Cell {
    Cell::new(x, y)
}

fn listed(list: &[RobotEntry]) -> Vec<Entry> {
    let entry = |(number, entry): (u32, &RobotEntry)| {
        let field = format!("robots.list[{}]", number - 1);
        Entry::new(entry.id.unwrap_or(number), cell(entry.start), cell(entry.goal), field)
    };
    (1..).zip(list).map(entry).collect()
}

type Graph = (Vec<Cell>, Vec<(u16, u16)>);

fn graph(at: &Section<'_>, entry: &FormationEntry) -> Checked<Formation> {
    let (places, edges) = match (entry.rows, entry.columns, &entry.places, &entry.edges) {
        (Some(rows), Some(columns), None, None) => grid_graph(rows, columns, entry.spacing.unwrap_or([3, -3]))
            .ok_or_else(|| {
                let what = format!("{rows} rows of {columns} robots do not fit any map or any memory");
                let least = format!("give 1 or more of both, at most {MAX_PLACES} robots, and a smaller spacing");
                at.unfit(what, least)
            }),
        (None, None, Some(places), Some(edges)) => given_graph(at, places, edges),
        _ => {
            let remedy = "give rows and columns (and spacing), or places and edges";
            Err(at.unfit("its shape is not clear", remedy))
        }
    }?;
    let rho = entry.rho;
    at.require(rho != Some(0), "rho", "with rho = 0 no robot knows its neighbours", "give 1 or more")?;
    let templates =
        |rho| (0..places.len()).map(|own| Template::from_graph(&places, &edges, own, rho)).collect::<Result<_, _>>();
    // More knowledge keeps the formation better: use the largest rho that fits.
    let templates = match rho {
        Some(rho) => templates(rho),
        None => templates(3).or_else(|_| templates(2)).or_else(|_| templates(1)),
    }
    .map_err(|error| match error {
        TemplateError::TooMany => {
            let what = format!("a robot would have more than {TEMPLATE} neighbours in the formation");
            at.error("rho", what, "give a smaller rho, or fewer edges per robot")
        }
        TemplateError::NoSuchPlace | TemplateError::BadEdge => {
            let what = format!("the formation has more than {MAX_PLACES} places");
            at.unfit(what, format!("give at most {MAX_PLACES} robots"))
        }
    })?;
    Ok(Formation { places, edges, templates, first: 0 })
}

fn grid_graph(rows: u16, columns: u16, [dx, dy]: [i16; 2]) -> Option<Graph> {
    let count = rows.checked_mul(columns)?;
    if count == 0 || count > MAX_PLACES {
        return None;
    }
    let mut places = Vec::new();
    let mut edges = Vec::new();
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let x = dx.checked_mul(i16::try_from(column).ok()?)?;
        let y = dy.checked_mul(i16::try_from(row).ok()?)?;
        let place = row * columns + column;
        places.push(Cell::new(x, y));
        if column + 1 < columns {
            edges.push((place, place + 1));
        }
        if row + 1 < rows {
            edges.push((place, place + columns));
        }
    }
    Some((places, edges))
}

fn given_graph(at: &Section<'_>, places: &[[i16; 2]], edges: &[[u32; 2]]) -> Checked<Graph> {
    let remedy = "places are relative to robot 1, the top leader";
    at.require(places.first() == Some(&[0, 0]), "places", "the first place is not [0, 0]", remedy)?;
    let what = format!("{} robots are more than a formation holds", places.len());
    at.require(places.len() <= usize::from(MAX_PLACES), "places", what, format!("give at most {MAX_PLACES}"))?;
    let mut pairs = BTreeSet::new();
    for (index, &[a, b]) in edges.iter().enumerate() {
        let place = |id: u32| {
            let place = u16::try_from(id.checked_sub(1)?).ok()?;
            (usize::from(place) < places.len()).then_some(place)
        };
        let Some((a, b)) = place(a).zip(place(b)).filter(|(a, b)| a != b) else {
            let what = format!("[{a}, {b}] joins no two robots of the formation");
            let remedy = format!("give two different numbers from 1 to {}", places.len());
            return Err(at.error(&format!("edges[{index}]"), what, remedy));
        };
        pairs.insert((a.min(b), a.max(b)));
    }
    if let Some(lost) = unreached(places.len(), &pairs) {
        let what = format!("no edges lead from robot 1 to robot {}", lost + 1);
        return Err(at.error("edges", what, "join every robot to the formation"));
    }
    Ok((places.iter().copied().map(cell).collect(), pairs.into_iter().collect()))
}

/// First place that is not connected to place 0. O(places * edges).
fn unreached(count: usize, edges: &BTreeSet<(u16, u16)>) -> Option<usize> {
    let mut reached = vec![false; count];
    *reached.first_mut()? = true;
    // A path has fewer edges than there are places.
    for _ in 1..count {
        for &(a, b) in edges {
            let (a, b) = (usize::from(a), usize::from(b));
            let either = reached[a] || reached[b];
            (reached[a], reached[b]) = (either, either);
        }
    }
    reached.iter().position(|is_reached| !is_reached)
}

fn placed(at: &Section<'_>, entry: &FormationEntry, graph: &Formation, first: u32) -> Checked<Vec<Entry>> {
    let shifted = |[x, y]: [i16; 2], by: Cell| Some(Cell::new(x.checked_add(by.x)?, y.checked_add(by.y)?));
    if let FormationStarts::All(starts) = &entry.starts {
        let what = format!("{} starts for {} robots", starts.len(), graph.places.len());
        let is_complete = starts.len() == graph.places.len();
        at.require(is_complete, "starts", what, "give one for each robot, by their numbers")?;
    }
    let placed = |(index, &place): (usize, &Cell)| {
        let number = index as u32 + first;
        let start = match &entry.starts {
            FormationStarts::All(starts) => starts.get(index).copied().map(cell),
            FormationStarts::First(start) => shifted(*start, place),
        };
        let Some((start, goal)) = start.zip(shifted(entry.goal, place)) else {
            let what = format!("robot {number} would be outside of any map");
            return Err(at.unfit(what, "give a smaller formation or another start and goal"));
        };
        Ok(Entry { goal_moves: index > 0, ..Entry::new(number, start, goal, &at.path) })
    };
    graph.places.iter().enumerate().map(placed).collect()
}

fn from_scen(draft: &Draft<'_>, entry: &ScenEntry, terrain: &Terrain) -> Checked<Vec<Entry>> {
    let (at, count) = (draft.at("robots.scen"), entry.count as usize);
    let path = draft.source.file(&entry.file);
    let queries = movingai::load_scen(&path)
        .map_err(|error| at.error("file", error.to_string(), "file names are relative to the scenario file"))?;
    let what = format!("{count} robots are wanted, the file has {}", queries.len());
    at.require((1..=queries.len()).contains(&count), "count", what, format!("give 1 to {}", queries.len()))?;
    let land = match draft.file.terrain.as_ref().map(|table| &table.land) {
        Some(LandSource::File(land)) => land.file_name().and_then(OsStr::to_str),
        _ => None,
    };
    let robot = |(number, query): (u32, &movingai::Query)| {
        let refuse = |what: String| {
            let what = format!("{}:{}: {what}", path.shown(), query.line);
            Err(at.error("file", what, format!("use the map {} uncropped", query.map)))
        };
        if let Some(land) = land.filter(|land| *land != query.map_name()) {
            return refuse(format!("the query is for the map {}, the terrain is {land}", query.map_name()));
        }
        let (map, [width, height]) = ([query.width, query.height], [terrain.width(), terrain.height()]);
        if map != [width, height] {
            let [columns, rows] = map;
            return refuse(format!("the map has {columns} x {rows} cells, the terrain {width} x {height}"));
        }
        Ok(Entry { line: Some(query.line), ..Entry::new(number, query.start, query.goal, &at.path) })
    };
    (1..).zip(&queries[..count]).map(robot).collect()
}

/// Numbers robots row by row from the south: neighbours on the land are neighbours in memory.
fn scattered(draft: &Draft<'_>, entry: &ScatteredEntry, terrain: &Terrain) -> Checked<Vec<Entry>> {
    let (at, seed) = (draft.at("robots.scattered"), draft.file.seed);
    let (width, height) = (i32::from(terrain.width()), i32::from(terrain.height()));
    let cells = (0..).zip(terrain.cells());
    let mut free: Vec<u32> = cells.filter_map(|(at, &class)| (class != BLOCKED).then_some(at)).collect();
    let count = entry.count as usize;
    let what = format!("{count} robots on {} passable cells", free.len());
    at.require((1..=free.len()).contains(&count), "count", what, format!("give 1 to {}", free.len()))?;
    let mut rng = Rng::keyed(seed, PLACES, 0, 0);
    for index in 0..count {
        let other = index + rng.below((free.len() - index) as u32) as usize;
        free.swap(index, other);
    }
    free.truncate(count);
    free.sort_unstable();
    let travel = entry.travel.map_or(i32::MAX, i32::from);
    let mut taken = vec![false; terrain.cells().len()];
    let place = |(number, index): (u32, u32)| {
        let (x, y) = (index as i32 % width, index as i32 / width);
        let start = Cell::new(x as i16, y as i16);
        let mut rng = Rng::keyed(seed, GOALS, number, 0);
        let mut draw = |at: i32, length: i32| {
            let low = at.saturating_sub(travel).max(0);
            let high = at.saturating_add(travel).min(length - 1);
            (low + rng.below((high - low + 1) as u32) as i32) as i16
        };
        let mut goals = (0..TRIES).map(|_| Cell::new(draw(x, width), draw(y, height)));
        let goal = goals.find(|&goal| {
            let is_far = goal.chebyshev(start) >= u32::from(entry.least);
            let at = terrain.index(goal).filter(|_| is_far && terrain.is_passable(goal));
            at.is_some_and(|at| !std::mem::replace(&mut taken[at], true))
        });
        let goal = goal.ok_or_else(|| {
            let what = format!("no free goal is left within reach of robot {number}");
            at.unfit(what, "give fewer robots or a longer travel")
        })?;
        Ok(Entry::new(number, start, goal, &at.path))
    };
    (1..).zip(free).map(place).collect()
}

fn check(draft: &Draft<'_>, entries: &[Entry], terrain: &Terrain) -> Checked {
    draft.require(!entries.is_empty(), "robots", "there are no robots", "give at least one robot")?;
    let mut ids = BTreeSet::new();
    let mut starts = vec![0; terrain.cells().len()];
    let mut goals = starts.clone();
    for Entry { robot, field, goal_moves, line } in entries {
        let RobotId(id) = robot.id;
        let refuse = |name: &str, what: String, remedy: String| {
            let at = draft.at(field);
            Err(match (line, &draft.file.robots) {
                (Some(line), Some(RobotsTable::Scen(entry))) => {
                    let path = draft.source.path().parent().unwrap_or(Path::new("")).join(&entry.file);
                    at.error("file", format!("{}:{line}: {what}", path.shown()), remedy)
                }
                _ => at.error(name, what, remedy),
            })
        };
        // A .scen counts columns and rows from the north-west.
        let shown = |place: Cell| match line {
            Some(_) => movingai::in_file(place, terrain.height()).map(i32::from),
            None => [place.x, place.y].map(i32::from),
        };
        if id == 0 || !ids.insert(id) {
            let remedy = "numbers are 1 or more, and each robot has its own";
            return refuse("id", format!("{id} is not free"), remedy.to_owned());
        }
        for (name, place, taken) in [("start", robot.start, &mut starts), ("goal", robot.goal, &mut goals)] {
            let Some(index) = terrain.index(place) else {
                let (columns, rows) = (terrain.width() - 1, terrain.height() - 1);
                let remedy = format!("the map has columns 0 to {columns} and rows 0 to {rows}");
                let what = format!("the {name} ({}, {}) of robot {id} is not on the map", place.x, place.y);
                return refuse(name, what, remedy);
            };
            let [x, y] = shown(place);
            if !(terrain.is_passable(place) || name == "goal" && *goal_moves) {
                let remedy = match nearest_passable(terrain, place).map(shown) {
                    Some([x, y]) => format!("the nearest free cell is [{x}, {y}]"),
                    None => "the map has no free cell at all".to_owned(),
                };
                let kind = if terrain.is_unknown(place) { "an unknown cell" } else { "a wall" };
                return refuse(name, format!("the {name} ({x}, {y}) of robot {id} is in {kind}"), remedy);
            }
            let other = std::mem::replace(&mut taken[index], id);
            if other != 0 {
                let first = entries.iter().find(|entry| entry.robot.id.0 == other).and_then(|entry| entry.line);
                let line = first.map_or_else(String::new, |line| format!(", which line {line} has, too"));
                let what = format!("robots {other} and {id} have the same {name} ({x}, {y}){line}");
                return refuse(name, what, "a cell holds one robot: move one of them".to_owned());
            }
        }
    }
    Ok(())
}

fn nearest_passable(terrain: &Terrain, to: Cell) -> Option<Cell> {
    let (width, height) = (terrain.width(), terrain.height());
    let rows = (0..height).filter_map(|y| i16::try_from(y).ok());
    rows.flat_map(|y| (0..width).filter_map(|x| i16::try_from(x).ok()).map(move |x| Cell::new(x, y)))
        .filter(|&cell| terrain.is_passable(cell))
        .min_by_key(|cell| (cell.distance_squared(to), cell.y, cell.x))
}
