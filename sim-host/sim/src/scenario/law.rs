//! `law = "NAME"` of a group of robots, and the table `NAME` beside it with the law's values.

use super::read::{Line, Node, Table, Wrong, nearest};
use super::rows::{Word, contradicts, fill, heading, line, read, rows, store};
use super::source::{Checked, Section};
use super::table::Fields;
use crate::own_law::{NEGOTIATION, Own, Site, added, own};
use staya_controller::agent::{
    Around, CELLS, Contradiction, FormationSettings, Goals, Law, LawSettings, Motion, RouteSettings, Settings,
    SettingsOfLaw, TEMPLATE, WaypointSettings,
};
use staya_controller::negotiation::Moves;
use staya_controller::parameters::{Absent, Parameter, Parameters};
use staya_controller::template::Template;
use staya_papers::{LookaheadSettings, PublishedSettings};

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

    /// Settings of a law that keeps a formation, as far as Staya's own.
    #[must_use]
    pub const fn formation(&self) -> Option<&FormationSettings> {
        match self {
            Self::BuiltIn(LawSettings::Formation(settings)) | Self::Lookahead(LookaheadSettings(settings)) => {
                Some(settings)
            }
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

    /// Calls `visit` with each table of a running law.
    pub(super) fn running(&self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        fn of(mut law: impl Law<f32>, visit: &mut dyn FnMut(&mut dyn Parameters)) {
            law.parameters(visit);
        }
        match self {
            Self::BuiltIn(settings) => of(settings.law::<f32, CELLS, 1, 0, ()>(()), visit),
            Self::Published(settings) => of(settings.law::<CELLS, 1>(), visit),
            Self::Lookahead(settings) => of(settings.law::<CELLS, 1, 0, ()>(()), visit),
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
                    Err(Contradiction::new(row, what, remedy))
                }
            },
        }
    }
}

/// The rows of a law that files give.
fn rows_of(law: &mut LawSetup) -> Vec<(&'static Parameter, Option<f32>)> {
    let is_added = matches!(law, LawSetup::Added(law) if law.name != NEGOTIATION);
    let all = rows(&mut |visit| law.tables(visit)).into_iter();
    all.filter(|(row, _)| is_added || !matches!(row.absent, Absent::OfBody(_))).collect()
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

fn usual(name: &str) -> Option<LawSetup> {
    LawSetup::by_name(name, Moves::EIGHT, Some(1.0))
}

/// The names of a law's values in files; `None` for an unknown law.
pub(super) fn names_of(law: &str) -> Option<Vec<&'static str>> {
    Some(rows_of(&mut usual(law)?).into_iter().map(|(row, _)| row.name).collect())
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
        let values = self.tables.first().map_or(&[][..], |(_, values)| values);
        if let LawSetup::Added(law) = &mut law {
            law.values = values.to_vec();
        }
        fill(&mut |visit| law.tables(visit), at, (name, &format!("the law \"{name}\"")), values)?;
        law.adapt(&|row| self.given(row), around).map_err(|wrong| contradicts(at, name, wrong))?;
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
            let values = table.of(law, |node| {
                let rows: Vec<_> = rows_of(&mut setup).into_iter().map(|(row, _)| row).collect();
                let names: Vec<_> = rows.iter().map(|row| row.name).collect();
                read(&Table::new(node, &names)?, &rows)
            })?;
            tables.push((law, values));
        }
        Ok(Self { name, tables })
    }

    fn part_lines() -> Vec<Line> {
        let law = heading("law", "The law of the robots, by name.", Vec::new());
        let sites: &[Site] = if CELLS { &[Site::Cells] } else { &[Site::Plane, Site::PlaneOverCells] };
        let tables = laws().into_iter().filter_map(|(name, what)| {
            let mut law = usual(name).filter(|law| sites.iter().any(|site| law.fits(*site)))?;
            let rows = rows_of(&mut law);
            let inner: Vec<_> = rows.into_iter().map(|(row, default)| line(row, default)).collect();
            (!inner.is_empty()).then(|| heading(name, what, inner))
        });
        [law].into_iter().chain(tables).collect()
    }
}
