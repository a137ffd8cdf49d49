//! Settings of laws, safety layers and behaviours: how Python gives them, and their types.
//!
//! Names, ranges, defaults and words are those of the controller's tables. They are read as in
//! scenario files.

use staya_controller::agent::{
    Around, BoidsSettings, Contradiction, FlySettings, GoalFlockSettings, LatticeSettings, LayerSettings,
    RouteSettings, Settings,
};
use staya_controller::goal_flock::GoalParams;
use staya_controller::grid::Norm;
use staya_controller::orca::AvoidParams;
use staya_sim::scenario::{Line, Read as _, Tables, Usual, laws, lines_of, store_given};
use std::fmt::Write as _;

/// Where the settings are documented.
const LIST: &str = "help(staya.settings)";

/// The parameters of ORCA, in space with `downwash`; in the plane that is 1.
///
/// # Errors
/// A value that scenario files refuse, too; likewise below.
pub fn orca(text: &str, in_space: bool) -> Result<(AvoidParams<f32>, FlySettings), String> {
    let (mut params, mut fly) = (AvoidParams::default(), FlySettings::default());
    store_given(text, LIST, &[], &mut |visit| {
        visit(&mut params);
        if in_space {
            visit(&mut fly);
        }
    })?;
    Ok((params, fly))
}

/// The parameters of an alpha flock.
///
/// # Errors
/// See [`orca`].
pub fn lattice(text: &str) -> Result<LatticeSettings, String> {
    let mut settings = LatticeSettings::default();
    let given = store_given(text, LIST, &[], &mut |visit| settings.tables(visit))?;
    adapted(&mut settings, &given, 0.0).map(|()| settings)
}

/// The parameters of a goal flock. Goals are given, so it has no distance of arrival.
///
/// # Errors
/// See [`orca`].
pub fn goal(text: &str) -> Result<GoalParams<f32>, String> {
    let mut settings = GoalFlockSettings::default();
    let given = store_given(text, LIST, GOAL_NEEDS, &mut |visit| visit(&mut settings.params))?;
    let speed_mps = settings.params.speed_mps;
    adapted(&mut settings, &given, speed_mps).map(|()| settings.params)
}

/// In a run the body has the speed.
const GOAL_NEEDS: &[&str] = &["speed_mps"];

/// The parameters of boids.
///
/// # Errors
/// See [`orca`].
pub fn boids(text: &str) -> Result<BoidsSettings, String> {
    let mut settings = BoidsSettings::default();
    store_given(text, LIST, &[], &mut |visit| settings.tables(visit)).map(|_| settings)
}

/// The parameters of routes; norm and corners are those of the grid.
///
/// # Errors
/// See [`orca`].
pub fn route(text: &str, norm: Norm, corner_cutting: bool) -> Result<RouteSettings, String> {
    let mut settings = RouteSettings::default();
    (settings.params.norm, settings.params.corner_cutting) = (norm, corner_cutting);
    store_given(text, LIST, &[], &mut |visit| settings.tables(visit)).map(|_| settings)
}

/// Sets the values that depend on others, for robots that know each other's present places.
fn adapted(settings: &mut impl Settings, given: &[&str], speed_mps: f32) -> Result<(), String> {
    let around = Around {
        radius_m: 0.0,
        max_speed_mps: speed_mps,
        fastest_mps: speed_mps,
        brake_s: 0.0,
        has_goal: true,
        cruise_mps: Some(speed_mps),
        tolerance_m: 0.0,
        delay_s: 0.0,
        rate_hz: f32::MAX,
        seed: 0,
        radius: 1,
        norm: Norm::Euclidean,
        corner_cutting: false,
    };
    let adapted = settings.adapt(&|row| given.contains(&row), &around);
    adapted.map_err(|Contradiction { row, what, remedy, .. }| format!("{row}: {what}; {remedy}"))
}

/// The begin of `staya/settings.py`.
const HEAD: &str = r#""""Names of laws and safety layers, and the settings of behaviours alone. `cargo xtask bless` writes
this file from the tables of the controller, which also check the values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypedDict

if TYPE_CHECKING:
    from typing_extensions import Required

"#;

/// The text of `staya/settings.py`.
#[must_use]
pub fn page() -> String {
    let mut page = String::from(HEAD);
    let names = laws().into_iter().map(|(name, _)| name);
    let _ = writeln!(page, "Law = Literal[{}]", quoted(names));
    let _ = writeln!(page, "Layer = Literal[{}]", quoted(LayerSettings::ALL.iter().map(|(name, _)| *name)));
    let (mut orca, mut fly) = (AvoidParams::<f32>::default(), FlySettings::default());
    let (mut lattice, mut goal) = (LatticeSettings::default(), GoalFlockSettings::default().params);
    let (mut boids, mut route) = (BoidsSettings::default(), RouteSettings::default());
    let mut class = |name: &str, what: &str, needed: &[&str], tables: &mut Tables<'_>| {
        write_class(&mut page, name, what, needed, &lines_of(tables));
    };
    class("Orca", "`staya.Orca` and `staya.orca`, with `downwash` only in space", &[], &mut |visit| {
        visit(&mut orca);
        visit(&mut fly);
    });
    class("Lattice", "`staya.flock.lattice`", &[], &mut |visit| lattice.tables(visit));
    class("Goal", "`staya.flock.goal`", GOAL_NEEDS, &mut |visit| visit(&mut goal));
    class("Boids", "`staya.flock.boids`", &[], &mut |visit| boids.tables(visit));
    class("Route", "`staya.route`", &[], &mut |visit| route.tables(visit));
    page
}

fn quoted<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    words.into_iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(", ")
}

/// Writes a class with a type and a description of each setting.
fn write_class(page: &mut String, name: &str, what: &str, needed: &[&str], lines: &[Line]) {
    let _ = write!(page, "\n\nclass {name}(TypedDict, total=False):\n    \"\"\"Settings of {what}.\n\n");
    let (mut fields, is_needed) =
        (String::new(), |line: &Line| line.default == Usual::None || needed.contains(&line.name));
    for line in lines {
        let limits = line.limits.as_ref().map_or_else(String::new, |limits| format!("; {limits}"));
        let default = match &line.default {
            _ if is_needed(line) => String::new(),
            Usual::Words(words) => format!("; default: {words}"),
            Usual::Value(value) if line.kind == bool::KIND => {
                format!("; default {}", if value == "true" { "True" } else { "False" })
            }
            usual => format!("; default {usual}"),
        };
        wrap(page, &format!("- `{}`: {}{limits}{default}.", line.name, line.doc));
        let kind = match (&line.words[..], line.kind) {
            ([], bool::KIND) => "bool".to_owned(),
            ([], _) => "float".to_owned(),
            (words, _) => format!("Literal[{}]", quoted(words.iter().copied())),
        };
        let kind = if is_needed(line) { format!("Required[{kind}]") } else { kind };
        let _ = writeln!(fields, "    {}: {kind}", line.name);
    }
    let _ = write!(page, "    \"\"\"\n\n{fields}");
}

/// Writes an entry of a list in lines of at most 100 characters.
fn wrap(page: &mut String, entry: &str) {
    let mut line = String::from("   ");
    for word in entry.split(' ') {
        if line.len() + 1 + word.len() > 100 {
            let _ = writeln!(page, "{line}");
            line = String::from("     ");
        }
        line = format!("{line} {word}");
    }
    let _ = writeln!(page, "{line}");
}
