//! `law = "NAME"` of a group of robots, and the table `NAME` beside it with the law's values.

use super::read::{Field as _, Limits, Line, Node, Table, Usual, Wrong, nearest};
use super::source::{Checked, Section, Source};
use super::table::Fields;
use crate::own_law::{NEGOTIATION, Own, Site, added, own};
use staya_controller::agent::{
    Around, Contradiction, FormationSettings, Goals, LawSettings, Motion, RouteSettings, Settings, TEMPLATE,
    WaypointSettings,
};
use staya_controller::negotiation::Moves;
use staya_controller::parameters::{Absent, BY_BODY, Parameter, Parameters};
use staya_controller::template::Template;
use staya_papers::{LookaheadSettings, PublishedSettings};
use std::path::Path;
use toml::de::DeValue;

/// A law of robots, with the values that it is made from.
#[derive(Clone, Debug, PartialEq)]
pub enum LawSetup {
    /// One of the controller's.
    BuiltIn(LawSettings),
    /// Formations as published.
    Published(PublishedSettings),
    /// Formations with followers that look ahead.
    Lookahead(LookaheadSettings),
    /// Negotiation, or one that the program adds.
    Added(AddedLaw),
}

/// A law that firmware does not have.
#[derive(Clone, Debug, PartialEq)]
pub struct AddedLaw {
    /// Its name.
    pub name: String,
    /// Given values by the names of its parameters.
    pub values: Vec<(String, f32)>,
    /// The moves of bodies on the grid.
    pub moves: Moves,
    /// The cruising speed of bodies in the plane, m/s.
    pub cruise_mps: Option<f32>,
    /// The bodies that it moves.
    pub motion: Motion,
    /// The goals that it takes.
    pub goals: Goals,
    /// Whether it goes through waypoints to its goal.
    pub takes_ways: bool,
}

impl AddedLaw {
    fn new(name: &str, moves: Moves, cruise_mps: Option<f32>) -> Option<Self> {
        let law = own(name, moves, cruise_mps)?;
        let (motion, goals, takes_ways) = (law.motion(), law.goals(), law.takes_ways());
        Some(Self { name: name.to_owned(), values: Vec::new(), moves, cruise_mps, motion, goals, takes_ways })
    }

    /// Creates the law of one robot.
    ///
    /// # Panics
    /// If the program does not add it; [`Scenario::load`](super::Scenario::load) refuses that.
    #[must_use]
    pub fn law(&self) -> Own {
        let mut law =
            own(&self.name, self.moves, self.cruise_mps).unwrap_or_else(|| panic!("no law {} here", self.name));
        law.tables(&mut |table| store(table, &self.values));
        law
    }
}

/// The names of all laws, each with a sentence; the laws of this program last.
#[must_use]
pub fn laws() -> Vec<(&'static str, &'static str)> {
    let of_papers =
        [(PublishedSettings::NAME, PublishedSettings::WHAT), (LookaheadSettings::NAME, LookaheadSettings::WHAT)];
    LawSettings::ALL.iter().copied().chain(of_papers).chain(added()).collect()
}

impl LawSetup {
    /// The law with this name and its defaults.
    #[must_use]
    pub fn by_name(name: &str, moves: Moves, cruise_mps: Option<f32>) -> Option<Self> {
        if let Some(settings) = LawSettings::by_name(name) {
            return Some(Self::BuiltIn(settings));
        }
        match name {
            PublishedSettings::NAME => Some(Self::Published(PublishedSettings::default())),
            LookaheadSettings::NAME => Some(Self::Lookahead(LookaheadSettings::default())),
            _ => AddedLaw::new(name, moves, cruise_mps).map(Self::Added),
        }
    }

    /// The name of the law.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::BuiltIn(settings) => settings.name(),
            Self::Published(_) => PublishedSettings::NAME,
            Self::Lookahead(_) => LookaheadSettings::NAME,
            Self::Added(law) => &law.name,
        }
    }

    /// The bodies that it moves.
    #[must_use]
    pub const fn motion(&self) -> Motion {
        match self {
            Self::BuiltIn(settings) => settings.motion(),
            Self::Published(_) => PublishedSettings::MOTION,
            Self::Lookahead(_) => LookaheadSettings::MOTION,
            Self::Added(law) => law.motion,
        }
    }

    /// Whether it goes from cell to cell, on the grid or in the plane.
    #[must_use]
    pub fn is_on_grid(&self) -> bool {
        self.motion() == Motion::Cells
    }

    /// The goals that it takes.
    #[must_use]
    pub fn goals(&self) -> Goals {
        match self {
            Self::BuiltIn(settings) => settings.goals(),
            Self::Published(_) => PublishedSettings::GOALS,
            Self::Lookahead(_) => LookaheadSettings::GOALS,
            Self::Added(law) => law.goals,
        }
    }

    /// Whether its robots have places in a formation.
    #[must_use]
    pub const fn keeps_formation(&self) -> bool {
        matches!(self, Self::BuiltIn(LawSettings::Formation(_)) | Self::Published(_) | Self::Lookahead(_))
    }

    /// The settings of its routes, if it plans them.
    #[must_use]
    pub const fn route(&self) -> Option<&RouteSettings> {
        match self {
            Self::BuiltIn(LawSettings::Route(route)) => Some(route),
            Self::BuiltIn(LawSettings::Formation(FormationSettings { route, .. }))
            | Self::Published(PublishedSettings { route, .. })
            | Self::Lookahead(LookaheadSettings(FormationSettings { route, .. })) => Some(route),
            _ => None,
        }
    }

    /// Whether robots with or without places in a formation can have it; laws of the program may
    /// know of no places.
    #[must_use]
    pub const fn fits_robots(&self, in_formation: bool) -> bool {
        self.keeps_formation() == in_formation || matches!(self, Self::Added(_))
    }

    /// Whether a robot may go through other waypoints to its goal.
    #[must_use]
    pub fn takes_ways(&self) -> bool {
        match self {
            Self::Added(law) => law.takes_ways,
            law => law.goals() == Goals::Waypoints,
        }
    }

    /// Whether it can decide there.
    pub(super) fn fits(&self, site: Site) -> bool {
        match self {
            Self::BuiltIn(settings) => settings.motion() == Motion::Cells || site != Site::Cells,
            Self::Published(_) | Self::Lookahead(_) => site == Site::Cells,
            Self::Added(law) => law.law().fits(site),
        }
    }

    /// Stores a value in each table that has the row.
    pub(super) fn set(&mut self, row: &str, value: f32) {
        match self {
            Self::Added(law) => law.values.push((row.to_owned(), value)),
            law => law.tables(&mut |table| store(table, &[(row.to_owned(), value)])),
        }
    }

    /// The settings, if it is a law of the controller.
    #[must_use]
    pub const fn built_in(&self) -> Option<&LawSettings> {
        match self {
            Self::BuiltIn(settings) => Some(settings),
            _ => None,
        }
    }

    /// The law as firmware has it. Firmware with a law of its own gets that one by other means.
    #[must_use]
    pub fn on_device(&self) -> LawSettings {
        match (self, self.motion()) {
            (Self::BuiltIn(settings), _) => settings.clone(),
            (_, Motion::Velocities) => LawSettings::Waypoint(WaypointSettings::default()),
            (_, Motion::Cells) => LawSettings::Route(RouteSettings::default()),
        }
    }

    /// Distance from its place within which a member of a formation counts as found, cells; 0
    /// without a formation.
    #[must_use]
    pub const fn eps(&self) -> u8 {
        match self {
            Self::BuiltIn(LawSettings::Formation(settings)) | Self::Lookahead(LookaheadSettings(settings)) => {
                settings.params.eps
            }
            Self::Published(settings) => settings.params.eps,
            _ => 0,
        }
    }

    /// The law of a robot with this place in its formation.
    #[must_use]
    pub fn with_template(mut self, own: Template<TEMPLATE>) -> Self {
        match &mut self {
            Self::BuiltIn(LawSettings::Formation(settings)) | Self::Lookahead(LookaheadSettings(settings)) => {
                settings.template = own;
            }
            Self::Published(settings) => settings.template = own,
            _ => {}
        }
        self
    }

    /// Calls `visit` with each table of values.
    pub fn tables(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        match self {
            Self::BuiltIn(settings) => settings.tables(visit),
            Self::Published(settings) => settings.tables(visit),
            Self::Lookahead(settings) => settings.tables(visit),
            Self::Added(law) => law.law().tables(visit),
        }
    }

    fn adapt(&mut self, is_given: &dyn Fn(&str) -> bool, around: &Around) -> Result<(), Contradiction> {
        match self {
            Self::BuiltIn(settings) => settings.adapt(is_given, around),
            Self::Published(settings) => settings.adapt(is_given, around),
            Self::Lookahead(settings) => settings.adapt(is_given, around),
            Self::Added(law) => match law.law().contradiction(is_given) {
                None => Ok(()),
                Some(row) => {
                    let (what, remedy) = ("contradicts the other values of the law", "change it or leave it out");
                    Err(Contradiction { row, what, remedy })
                }
            },
        }
    }
}

/// Stores the values that the table has, whatever the others are.
fn store(table: &mut dyn Parameters, values: &[(String, f32)]) {
    for (name, value) in values {
        if let Some(index) = table.index(name) {
            let _ = table.store(index, *value, false);
        }
    }
}

/// Calls a function with each table of a law, a layer or a behaviour.
pub type Tables<'a> = dyn FnMut(&mut dyn FnMut(&mut dyn Parameters)) + 'a;

/// A row, the fault of its value, and how to correct it.
type Fault = (&'static str, String, String);

/// The first value that is not a whole number although its row stores one.
fn rounded(tables: &mut Tables<'_>, values: &[(String, f32)]) -> Option<Fault> {
    /// Gains are rounded to sixteenths, lengths to parts of a cell.
    const FINE: f32 = 0.04;
    let mut found = None;
    tables(&mut |table| {
        for (name, value) in values {
            let Some(index) = table.index(name) else { continue };
            let stored = table.get(index).unwrap_or(*value);
            if value.fract() != 0.0 && stored.fract() == 0.0 && (stored - value).abs() > FINE {
                let what = format!("{value} is not a whole number");
                let remedy = format!("give {stored}, or another whole number");
                found.get_or_insert((table.table()[index].name, what, remedy));
            }
        }
    });
    found
}

/// Reads the values of these rows from a table.
fn read_values(node: &Node<'_>, rows: &[&'static Parameter]) -> Result<Vec<(String, f32)>, Wrong> {
    let names: Vec<_> = rows.iter().map(|row| row.name).collect();
    let table = Table::new(node, &names)?;
    let value = |row: &&'static Parameter| Ok(value(&table, row)?.map(|value| (row.name.to_owned(), value)));
    rows.iter().filter_map(|row| value(row).transpose()).collect()
}

/// Stores the values of `text`, a table in TOML, in tables, by the rules of scenario files. Returns
/// the names of the values. Rows of `needed` must be given, too.
///
/// # Errors
/// The field, the cause and the remedy; `list` is where all fields are documented.
pub fn store_given(
    text: &str,
    list: &str,
    needed: &[&str],
    tables: &mut Tables<'_>,
) -> Result<Vec<&'static str>, String> {
    let mut rows: Vec<&'static Parameter> = Vec::new();
    tables(&mut |table| rows.extend(table.table()));
    let source = Source::new(Path::new(""), text).map_err(|error| error.without_place())?;
    let values = source.read_by(|node| read_values(node, &rows), list).map_err(|error| error.without_place())?;
    let (given, others): (Vec<_>, Vec<_>) =
        rows.into_iter().partition(|row| values.iter().any(|(name, _)| name == row.name));
    let is_needed = |row: &&&Parameter| row.absent == Absent::Needed || needed.contains(&row.name);
    if let Some(row) = others.iter().find(is_needed) {
        return Err(format!("missing `{}`: {}; give {}", row.name, row.what, Limits::of(row)));
    }
    tables(&mut |table| store(table, &values));
    match rounded(tables, &values) {
        None => Ok(given.into_iter().map(|row| row.name).collect()),
        Some((row, what, remedy)) => Err(format!("{row}: {what}; {remedy}")),
    }
}

/// `law` and the tables of laws among the fields of robots in cells, or else of a group in the
/// plane.
#[derive(Clone, Debug, Default)]
pub struct LawPart<const CELLS: bool> {
    /// The name, if it is given.
    pub name: Option<String>,
    /// The tables of laws that are given, with their values.
    tables: Vec<(&'static str, Vec<(String, f32)>)>,
}

/// The rows of a law that files give, each with its default value.
fn rows(law: &mut LawSetup) -> Vec<(&'static Parameter, Option<f32>)> {
    let (mut rows, is_added) = (Vec::new(), matches!(law, LawSetup::Added(law) if law.name != NEGOTIATION));
    law.tables(&mut |table| {
        let all = table.table().iter().enumerate();
        let given = all.filter(|(_, row)| is_added || !matches!(row.absent, Absent::OfBody(_)));
        rows.extend(given.map(|(index, row)| (row, table.get(index))));
    });
    rows
}

fn usual(name: &str) -> Option<LawSetup> {
    LawSetup::by_name(name, Moves::EIGHT, Some(1.0))
}

/// The names of a law's values in files; `None` for an unknown law.
pub(super) fn names_of(law: &str) -> Option<Vec<&'static str>> {
    Some(rows(&mut usual(law)?).into_iter().map(|(row, _)| row.name).collect())
}

impl<const CELLS: bool> LawPart<CELLS> {
    /// The name of the law, `otherwise` if none is given.
    pub(super) fn name_or<'a>(&'a self, otherwise: &'a str) -> &'a str {
        self.name.as_deref().unwrap_or(otherwise)
    }

    /// Whether a value of the law is given.
    pub(super) fn given(&self, row: &str) -> bool {
        self.tables.iter().flat_map(|(_, values)| values).any(|(name, _)| name == row)
    }

    /// Whether a law or a value of one is given.
    pub(super) const fn is_empty(&self) -> bool {
        self.name.is_none() && self.tables.is_empty()
    }

    /// The law, with the values of the file and those that depend on others.
    pub(super) fn build(&self, at: &Section<'_>, otherwise: &str, moves: Moves, around: &Around) -> Checked<LawSetup> {
        let name = self.name_or(otherwise);
        let Some(mut law) = LawSetup::by_name(name, moves, around.cruise_mps) else {
            unreachable!("a law that was read is known");
        };
        if let Some((given, _)) = self.tables.iter().find(|(given, _)| *given != name) {
            let remedy = format!("give law = \"{given}\", or leave this table out");
            return Err(at.error(given, format!("these robots have the law \"{name}\""), remedy));
        }
        let missing = rows(&mut law).into_iter().find(|(row, _)| row.absent == Absent::Needed && !self.given(row.name));
        if let Some((row, _)) = missing {
            let remedy = format!("give {}, {}, in [{}]", row.name, Limits::of(row), at.field(name));
            return Err(at.error(name, format!("the law \"{name}\" needs `{}`: {}", row.name, row.what), remedy));
        }
        let values = self.tables.first().map_or(&[][..], |(_, values)| values);
        match &mut law {
            LawSetup::Added(law) => law.values = values.to_vec(),
            law => law.tables(&mut |table| store(table, values)),
        }
        if let Some((row, what, remedy)) = rounded(&mut |visit| law.tables(visit), values) {
            return Err(at.error(&format!("{name}.{row}"), what, remedy));
        }
        law.adapt(&|row| self.given(row), around)
            .map_err(|wrong| at.error(&format!("{name}.{}", wrong.row), wrong.what, wrong.remedy))?;
        Ok(law)
    }
}

fn unknown(node: &Node<'_>, name: &str) -> Wrong {
    let names: Vec<_> = laws().into_iter().map(|(name, _)| name).collect();
    let remedy = match nearest(name, names.iter().copied()) {
        Some(near) => format!("did you mean \"{near}\"?"),
        None => format!("it has {}; docs/project.md says how a program adds one", names.join(", ")),
    };
    let wrong = Wrong::new(node, format!("this program has no law \"{name}\""));
    Wrong { remedy: Some(remedy), is_listed: false, ..wrong }
}

fn value(table: &Table<'_>, row: &Parameter) -> Result<Option<f32>, Wrong> {
    if row.is_switch() {
        return Ok(table.read::<bool>(row.name, None)?.map(|is| f32::from(u8::from(is))));
    }
    if row.words.is_empty() {
        return Ok(table.read::<f64>(row.name, Some(&Limits::of(row)))?.map(|value| value as f32));
    }
    let Some(Word(word)) = table.read::<Word>(row.name, None)? else { return Ok(None) };
    match row.words.iter().position(|known| *known == word) {
        Some(index) => Ok(Some(index as f32)),
        None => {
            let known: Vec<_> = row.words.iter().map(|word| (*word, ())).collect();
            table.of(row.name, |node| super::word(node, &known)).map(|_| None)
        }
    }
}

struct Word(String);

impl super::Read for Word {
    const KIND: &'static str = "a name in quotes";

    fn read(node: &Node<'_>) -> Result<Self, Wrong> {
        match node.get_ref() {
            DeValue::String(text) => Ok(Self(text.clone().into_owned())),
            _ => Err(Wrong::not(node, Self::KIND)),
        }
    }
}

impl<const CELLS: bool> Fields for LawPart<CELLS> {
    fn names() -> Vec<&'static str> {
        ["law"].into_iter().chain(laws().into_iter().map(|(name, _)| name)).collect()
    }

    fn fields(table: &Table<'_>) -> Result<Self, Wrong> {
        let name = table.read::<Word>("law", None)?.map(|Word(name)| name);
        if let Some(name) = &name
            && usual(name).is_none()
        {
            return table.of("law", |node| Err(unknown(node, name)));
        }
        let mut tables = Vec::new();
        for (law, _) in laws() {
            let Some(mut setup) = table.has(law).then(|| usual(law)).flatten() else { continue };
            let rows: Vec<_> = rows(&mut setup).into_iter().map(|(row, _)| row).collect();
            tables.push((law, table.of(law, |node| read_values(node, &rows))?));
        }
        Ok(Self { name, tables })
    }

    fn part_lines() -> Vec<Line> {
        let line = |name, doc: &'static str, kind, inner| Line {
            name,
            doc: doc.into(),
            kind,
            limits: None,
            words: Vec::new(),
            default: Usual::None,
            reads: |node| Word::read(node).map(drop),
            inner,
        };
        let sites: &[Site] = if CELLS { &[Site::Cells] } else { &[Site::Plane, Site::PlaneOverCells] };
        let tables = laws().into_iter().filter_map(|(name, what)| {
            let mut law = usual(name).filter(|law| sites.iter().any(|site| law.fits(*site)))?;
            let rows: Vec<_> = rows(&mut law).into_iter().map(|(row, default)| self::line(row, default)).collect();
            let reads = |node: &Node<'_>| Table::any(node).map(drop);
            (!rows.is_empty()).then(|| Line { reads, ..line(name, what, "a table", rows) })
        });
        [line("law", "The law of the robots, by name.", Word::KIND, Vec::new())].into_iter().chain(tables).collect()
    }
}

/// The documentation of the rows of tables, with the values of the tables as defaults, also of rows
/// that in a run depend on the body.
pub fn lines_of(tables: &mut Tables<'_>) -> Vec<Line> {
    let mut all = Vec::new();
    tables(&mut |table| {
        for (index, row) in table.table().iter().enumerate() {
            let mut line = line(row, table.get(index));
            let of_body = matches!(row.absent, Absent::OfBody(_) | Absent::Depends(BY_BODY));
            if let Some(value) = table.get(index).filter(|_| of_body) {
                line.default = Usual::Value(value.to_string());
            }
            all.push(line);
        }
    });
    all
}

/// The documentation of a row.
pub(super) fn line(row: &'static Parameter, default: Option<f32>) -> Line {
    let (kind, limits, reads): (_, _, fn(&Node<'_>) -> _) = match (row.is_switch(), row.words.is_empty()) {
        (true, _) => (bool::KIND, None, |node| bool::read(node).map(drop)),
        (_, true) => (f64::KIND, Some(Limits::of(row)), |node| f64::read(node).map(drop)),
        _ => (Word::KIND, None, |node| Word::read(node).map(drop)),
    };
    let shown = |value: f32| match row.words.get(value as usize) {
        Some(word) if row.is_switch() => (*word).to_owned(),
        Some(word) => format!("\"{word}\""),
        None => value.to_string(),
    };
    let default = match row.absent {
        Absent::Default => default.map_or(Usual::None, |value| Usual::Value(shown(value))),
        Absent::Depends(on) => Usual::Words(on.into()),
        Absent::OfBody(name) => Usual::Words(format!("that of the body, `{name}`").into()),
        Absent::Needed => Usual::None,
    };
    let words = if row.is_switch() { Vec::new() } else { row.words.to_vec() };
    Line { name: row.name, doc: row.what.into(), kind, limits, words, default, reads, inner: Vec::new() }
}
