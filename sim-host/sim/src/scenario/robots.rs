//! Builds robots with starts and goals from the `[robots]` table.

mod table;

pub use table::{RobotEntry, RobotsTable, ScatteredEntry, ScenEntry};

use super::formation::FormationEntry;
use super::source::Source;
use super::{ScenarioError, ScenarioFile};
use crate::terrain::Terrain;
use crate::terrain::movingai;
use staya_controller::agent::TEMPLATE;
use staya_controller::grid::Cell;
use staya_controller::rand::Rng;
use staya_controller::robot::RobotId;
use staya_controller::template::{Template, TemplateError};
use std::collections::BTreeSet;
use std::ops::Range;

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
}

pub(super) fn build(
    source: &Source<'_>,
    file: &ScenarioFile,
    terrain: &Terrain,
) -> Result<(Vec<Robot>, Vec<Formation>), ScenarioError> {
    let Some(table) = &file.robots else {
        let remedy = "give exactly one of list, formation, scen, scattered";
        return Err(source.error("robots", "the table is missing", remedy));
    };
    let mut formations = Vec::new();
    let entries = match (&table.list, &table.formation.0[..], &table.scen, &table.scattered) {
        (Some(list), [], None, None) => listed(list),
        (None, [_, ..], None, None) => {
            let mut entries = Vec::new();
            for (index, entry) in table.formation.0.iter().enumerate() {
                let field = match table.formation.0.len() {
                    1 => "robots.formation".to_owned(),
                    _ => format!("robots.formation[{index}]"),
                };
                let (graph, mut members) = formation(source, &field, entry, file.formation.rho, entries.len())?;
                entries.append(&mut members);
                formations.push(graph);
            }
            entries
        }
        (None, [], Some(entry), None) => from_scen(source, entry, terrain)?,
        (None, [], None, Some(entry)) => scattered(source, entry, terrain, file.seed)?,
        _ => {
            let remedy = "give exactly one of list, formation, scen, scattered";
            return Err(source.error("robots", "the robots are not defined exactly once", remedy));
        }
    };
    check(source, &entries, terrain)?;
    let mut robots: Vec<_> = entries.into_iter().map(|entry| entry.robot).collect();
    robots.sort_unstable_by_key(|robot| robot.id);
    Ok((robots, formations))
}

pub(super) fn of_group(
    source: &Source<'_>,
    field: &str,
    entry: &FormationEntry,
    file: &ScenarioFile,
    terrain: &Terrain,
) -> Result<(Vec<Robot>, Formation), ScenarioError> {
    let (formation, entries) = formation(source, field, entry, file.formation.rho, 0)?;
    check(source, &entries, terrain)?;
    Ok((entries.into_iter().map(|entry| entry.robot).collect(), formation))
}

fn formation(
    source: &Source<'_>,
    field: &str,
    entry: &FormationEntry,
    rho: Option<u8>,
    before: usize,
) -> Result<(Formation, Vec<Entry>), ScenarioError> {
    let graph = graph(source, field, entry, rho)?;
    let first = u32::try_from(before).unwrap_or(u32::MAX).saturating_add(1);
    let entries = placed(source, field, entry, &graph, first)?;
    Ok((graph.of(before, first), entries))
}

fn cell([x, y]: [i16; 2]) -> Cell {
    Cell::new(x, y)
}

fn listed(list: &[RobotEntry]) -> Vec<Entry> {
    (1..)
        .zip(list)
        .map(|(number, entry)| Entry {
            robot: Robot { id: RobotId(entry.id.unwrap_or(number)), start: cell(entry.start), goal: cell(entry.goal) },
            field: format!("robots.list[{}]", number - 1),
            goal_moves: false,
        })
        .collect()
}

type Graph = (Vec<Cell>, Vec<(u16, u16)>);

fn graph(
    source: &Source<'_>,
    field: &str,
    entry: &FormationEntry,
    rho: Option<u8>,
) -> Result<Formation, ScenarioError> {
    let (places, edges) = match (entry.rows, entry.columns, &entry.places, &entry.edges) {
        (Some(rows), Some(columns), None, None) => grid_graph(rows, columns, entry.spacing.unwrap_or([3, -3]))
            .ok_or_else(|| {
                source.error(
                    field,
                    format!("{rows} rows of {columns} robots do not fit any map or any memory"),
                    format!("give 1 or more of both, at most {MAX_PLACES} robots, and a smaller spacing"),
                )
            }),
        (None, None, Some(places), Some(edges)) => given_graph(source, field, places, edges),
        _ => Err(source.error(
            field,
            "its shape is not clear",
            "give rows and columns (and spacing), or places and edges",
        )),
    }?;
    if rho == Some(0) {
        return Err(source.error("formation.rho", "with rho = 0 no robot knows its neighbours", "give 1 or more"));
    }
    let templates =
        |rho| (0..places.len()).map(|own| Template::from_graph(&places, &edges, own, rho)).collect::<Result<_, _>>();
    // More knowledge keeps the formation better: use the largest rho that fits.
    let templates = match rho {
        Some(rho) => templates(rho),
        None => templates(3).or_else(|_| templates(2)).or_else(|_| templates(1)),
    }
    .map_err(|error| template_error(source, field, error))?;
    Ok(Formation { places, edges, templates, first: 0 })
}

fn template_error(source: &Source<'_>, field: &str, error: TemplateError) -> ScenarioError {
    match error {
        TemplateError::TooMany => source.error(
            "formation.rho",
            format!("a robot would have more than {TEMPLATE} neighbours in the formation"),
            "give a smaller rho, or fewer edges per robot",
        ),
        TemplateError::NoSuchPlace | TemplateError::BadEdge => source.error(
            field,
            format!("the formation has more than {MAX_PLACES} places"),
            format!("give at most {MAX_PLACES} robots"),
        ),
    }
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

fn given_graph(
    source: &Source<'_>,
    field: &str,
    places: &[[i16; 2]],
    edges: &[[u32; 2]],
) -> Result<Graph, ScenarioError> {
    if places.first() != Some(&[0, 0]) {
        let remedy = "places are relative to robot 1, the top leader";
        return Err(source.error(&format!("{field}.places"), "the first place is not [0, 0]", remedy));
    }
    if places.len() > usize::from(MAX_PLACES) {
        let what = format!("{} robots are more than a formation holds", places.len());
        return Err(source.error(&format!("{field}.places"), what, format!("give at most {MAX_PLACES}")));
    }
    let mut pairs = BTreeSet::new();
    for (index, &[a, b]) in edges.iter().enumerate() {
        let place = |id: u32| {
            let place = u16::try_from(id.checked_sub(1)?).ok()?;
            (usize::from(place) < places.len()).then_some(place)
        };
        match (place(a), place(b)) {
            (Some(a), Some(b)) if a != b => {
                pairs.insert((a.min(b), a.max(b)));
            }
            _ => {
                let what = format!("[{a}, {b}] joins no two robots of the formation");
                let remedy = format!("give two different numbers from 1 to {}", places.len());
                return Err(source.error(&format!("{field}.edges[{index}]"), what, remedy));
            }
        }
    }
    if let Some(lost) = unreached(places.len(), &pairs) {
        let what = format!("no edges lead from robot 1 to robot {}", lost + 1);
        return Err(source.error(&format!("{field}.edges"), what, "join every robot to the formation"));
    }
    let places = places.iter().copied().map(cell).collect();
    Ok((places, pairs.into_iter().collect()))
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

fn placed(
    source: &Source<'_>,
    field: &str,
    entry: &FormationEntry,
    graph: &Formation,
    first: u32,
) -> Result<Vec<Entry>, ScenarioError> {
    let shifted = |[x, y]: [i16; 2], by: Cell| Some(Cell::new(x.checked_add(by.x)?, y.checked_add(by.y)?));
    let count = graph.places.len();
    match (&entry.start, &entry.starts) {
        (Some(_), None) => {}
        (None, Some(starts)) if starts.len() == count => {}
        (None, Some(starts)) => {
            let what = format!("{} starts for {count} robots", starts.len());
            return Err(source.error(&format!("{field}.starts"), what, "give one for each robot, by their numbers"));
        }
        _ => {
            let remedy = "give start, of robot 1, or starts, of all, and not both";
            return Err(source.error(field, "it is not clear where they start", remedy));
        }
    }
    let start = |index: usize, place: Cell| match (&entry.starts, entry.start) {
        (Some(starts), _) => starts.get(index).copied().map(cell),
        (None, start) => shifted(start?, place),
    };
    let placed = |(index, &place): (usize, &Cell)| {
        let number = index as u32 + first;
        match (start(index, place), shifted(entry.goal, place)) {
            (Some(start), Some(goal)) => Ok(Entry {
                robot: Robot { id: RobotId(number), start, goal },
                field: field.to_owned(),
                goal_moves: index > 0,
            }),
            _ => Err(source.error(
                field,
                format!("robot {number} would be outside of any map"),
                "give a smaller formation or another start and goal",
            )),
        }
    };
    graph.places.iter().enumerate().map(placed).collect()
}

fn from_scen(source: &Source<'_>, entry: &ScenEntry, terrain: &Terrain) -> Result<Vec<Entry>, ScenarioError> {
    let path = source.file(&entry.file);
    let queries = movingai::load_scen(&path).map_err(|error| {
        source.error("robots.scen.file", error.to_string(), "file names are relative to the scenario file")
    })?;
    let count = entry.count as usize;
    if count == 0 || count > queries.len() {
        let what = format!("{count} robots are wanted, the file has {}", queries.len());
        return Err(source.error("robots.scen.count", what, format!("give 1 to {}", queries.len())));
    }
    (1..)
        .zip(&queries[..count])
        .map(|(number, query)| {
            if (query.width, query.height) != (terrain.width(), terrain.height()) {
                return Err(source.error(
                    "robots.scen.file",
                    format!(
                        "it is for a map of {} x {} cells, the terrain has {} x {}",
                        query.width,
                        query.height,
                        terrain.width(),
                        terrain.height()
                    ),
                    format!("use the map {} uncropped", query.map),
                ));
            }
            Ok(Entry {
                robot: Robot { id: RobotId(number), start: query.start, goal: query.goal },
                field: "robots.scen".to_owned(),
                goal_moves: false,
            })
        })
        .collect()
}

/// Numbers robots row by row from the south: neighbours on the land are neighbours in memory.
fn scattered(
    source: &Source<'_>,
    entry: &ScatteredEntry,
    terrain: &Terrain,
    seed: u64,
) -> Result<Vec<Entry>, ScenarioError> {
    let (width, height) = (i32::from(terrain.width()), i32::from(terrain.height()));
    let mut free: Vec<u32> = (0..)
        .zip(terrain.cells())
        .filter_map(|(at, &u)| (u != staya_controller::grid::BLOCKED).then_some(at))
        .collect();
    let count = entry.count as usize;
    if count == 0 || count > free.len() {
        let what = format!("{count} robots on {} passable cells", free.len());
        return Err(source.error("robots.scattered.count", what, format!("give 1 to {}", free.len())));
    }
    let mut rng = Rng::keyed(seed, PLACES, 0, 0);
    for at in 0..count {
        let other = at + rng.below((free.len() - at) as u32) as usize;
        free.swap(at, other);
    }
    free.truncate(count);
    free.sort_unstable();
    let cell_at = |at: u32| {
        let at = at as i32;
        (at % width, at / width)
    };
    let travel = entry.travel.map_or(i32::MAX, i32::from);
    let mut taken = vec![false; terrain.cells().len()];
    (1..)
        .zip(free)
        .map(|(number, at)| {
            let (x, y) = cell_at(at);
            let mut rng = Rng::keyed(seed, GOALS, number, 0);
            let mut draw = |at: i32, length: i32| {
                let low = at.saturating_sub(travel).max(0);
                let high = at.saturating_add(travel).min(length - 1);
                low + rng.below((high - low + 1) as u32) as i32
            };
            let goal = (0..TRIES).map(|_| Cell::new(draw(x, width) as i16, draw(y, height) as i16)).find(|&goal| {
                let is_far = goal.chebyshev(Cell::new(x as i16, y as i16)) >= u32::from(entry.least);
                let at = terrain.index(goal).filter(|_| is_far && terrain.is_passable(goal));
                at.is_some_and(|at| !std::mem::replace(&mut taken[at], true))
            });
            let Some(goal) = goal else {
                let what = format!("no free goal is left within reach of robot {number}");
                return Err(source.error("robots.scattered", what, "give fewer robots or a longer travel"));
            };
            Ok(Entry {
                robot: Robot { id: RobotId(number), start: Cell::new(x as i16, y as i16), goal },
                field: "robots.scattered".to_owned(),
                goal_moves: false,
            })
        })
        .collect()
}

fn check(source: &Source<'_>, entries: &[Entry], terrain: &Terrain) -> Result<(), ScenarioError> {
    if entries.is_empty() {
        return Err(source.error("robots", "there are no robots", "give at least one robot"));
    }
    let mut ids = BTreeSet::new();
    let mut starts = vec![0; terrain.cells().len()];
    let mut goals = starts.clone();
    for entry in entries {
        let RobotId(id) = entry.robot.id;
        if id == 0 || !ids.insert(id) {
            let remedy = "numbers are 1 or more, and each robot has its own";
            return Err(source.error(&format!("{}.id", entry.field), format!("{id} is not free"), remedy));
        }
        for (name, place, taken) in [("start", entry.robot.start, &mut starts), ("goal", entry.robot.goal, &mut goals)]
        {
            let field = format!("{}.{name}", entry.field);
            let Some(at) = terrain.index(place) else {
                return Err(source.error(
                    &field,
                    format!("the {name} ({}, {}) of robot {id} is not on the map", place.x, place.y),
                    format!("the map has columns 0 to {} and rows 0 to {}", terrain.width() - 1, terrain.height() - 1),
                ));
            };
            if !(terrain.is_passable(place) || name == "goal" && entry.goal_moves) {
                let what = format!("the {name} ({}, {}) of robot {id} is in a wall", place.x, place.y);
                let remedy = match nearest_passable(terrain, place) {
                    Some(near) => format!("the nearest free cell is [{}, {}]", near.x, near.y),
                    None => "the map has no free cell at all".to_owned(),
                };
                return Err(source.error(&field, what, remedy));
            }
            let other = std::mem::replace(&mut taken[at], id);
            if other != 0 {
                let what = format!("robots {other} and {id} have the same {name} ({}, {})", place.x, place.y);
                return Err(source.error(&field, what, "a cell holds one robot: move one of them"));
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
