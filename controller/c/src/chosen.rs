//! Laws and safety layers by name, their values by the rows of the controller's tables.

use crate::law::Law;
use crate::memory::{answers, plain};
use crate::row::{StayaParameter, text};
use crate::setup::{STAYA_LAW_VALUES, STAYA_LAYER_VALUES, STAYA_MAX_RADIUS, StayaSetup};
use crate::status::{Checked, StayaStatus};
use core::ffi::c_char;
use heapless::Vec;
use staya_controller::agent::{Around, Contradiction, External, Goals, LawSettings, LayerSettings, Motion};
use staya_controller::grid::Norm;
use staya_controller::parameters::{Absent, Parameter, Parameters, TOLERANCE};
use staya_controller::wire::ProtocolId;

/// The law of the caller, behind those of the controller.
const EXTERNAL: (&str, &str) = ("external", "your own: `staya_decide` gives the decision of each step");

/// The first protocol of users.
const FIRST_PROTOCOL: u8 = 64;

/// A law or a safety layer. Texts end with a zero.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaKind {
    /// The name for `staya_choose_law` or `staya_choose_layer`.
    pub name: [c_char; 20],
    /// A description in a sentence.
    pub text: [c_char; 108],
}

/// Why `staya_init` refuses the law or the layer of a setup. Texts end with a zero, and are empty
/// if no row is to blame.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaFault {
    /// StayaStatus; STAYA_STATUS_OK: the setup has no such fault.
    pub status: i32,
    /// The row to change, as `staya_set` takes it, or the field of StayaSetup.
    pub row: [c_char; 36],
    /// The fault in a few words.
    pub what: [c_char; 96],
    /// How to correct it.
    pub remedy: [c_char; 96],
    /// The least value that is accepted, if that is the remedy; otherwise NaN.
    pub least: f32,
}

plain!(StayaKind, StayaFault);

/// A refused value of a setup.
#[derive(Debug)]
pub(crate) struct Fault {
    status: StayaStatus,
    /// The section of the row; empty for a field of the setup.
    kind: &'static str,
    wrong: Contradiction,
}

impl Fault {
    /// A refused field of the setup.
    fn field<T>(status: StayaStatus, row: &'static str, what: &'static str, remedy: &'static str) -> Result<T, Self> {
        Err(Self { status, kind: "", wrong: Contradiction::new(row, what, remedy) })
    }
}

impl From<StayaStatus> for Fault {
    fn from(status: StayaStatus) -> Self {
        Self { status, kind: "", wrong: Contradiction::new("", "", "") }
    }
}

impl From<Fault> for StayaStatus {
    fn from(fault: Fault) -> Self {
        fault.status
    }
}

/// The surroundings of a law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// The plane or space.
    Plane,
    /// The plane, over land in cells.
    Cells,
    /// The grid.
    Grid,
    /// As the inputs say.
    Any,
}

type Adapt<T> = fn(&mut T, &dyn Fn(&str) -> bool, &Around) -> Result<(), Contradiction>;
type Visit<'a> = &'a mut dyn FnMut(&mut dyn Parameters);
type Rows<'a> = &'a mut dyn FnMut(&'static str, &'static Parameter, f32, &mut f32);

fn laws() -> impl Iterator<Item = &'static (&'static str, &'static str)> {
    LawSettings::ALL.iter().chain([&EXTERNAL])
}

fn name_at(mut all: impl Iterator<Item = &'static (&'static str, &'static str)>, number: u8) -> Checked<&'static str> {
    all.nth(number.into()).map(|(name, _)| *name).ok_or(StayaStatus::Law)
}

fn number(mut all: impl Iterator<Item = &'static (&'static str, &'static str)>, name: &str) -> Checked<u8> {
    all.position(|(known, _)| *known == name).map(|number| number as u8).ok_or(StayaStatus::Law)
}

/// Calls `visit` with the rows of a table that are not of the body: its section, the row, its
/// default (NaN for none) and its place in the setup.
fn rows(kind: &'static str, table: &dyn Parameters, values: &mut core::slice::IterMut<'_, f32>, visit: Rows<'_>) {
    for (index, (row, value)) in table.table().iter().zip(values).enumerate() {
        let usual = table.get(index).filter(|_| row.absent == Absent::Default).unwrap_or(f32::NAN);
        if !matches!(row.absent, Absent::OfBody(_)) {
            visit(kind, row, usual, value);
        }
    }
}

/// Settings with the given values, and with those that depend on others.
fn filled<T>(
    kind: &'static str,
    mut settings: T,
    tables: fn(&mut T, Visit<'_>),
    adapt: Adapt<T>,
    values: &[f32],
    around: &Around,
) -> Result<T, Fault> {
    let (mut given, mut refused) = (Vec::<&str, STAYA_LAW_VALUES>::new(), Ok(()));
    let mut refuse = |status, row: &Parameter, remedy| {
        let fault = Fault { status, kind, wrong: Contradiction::new(row.name, row.what, remedy) };
        refused = core::mem::replace(&mut refused, Ok(())).and(Err(fault));
    };
    let mut values = values.iter();
    tables(&mut settings, &mut |table| {
        for (index, (row, &value)) in table.table().iter().zip(&mut values).enumerate() {
            let [least, greatest] = row.range;
            if (least..=greatest).contains(&value) {
                let _ = (table.store(index, value, false), given.push(row.name));
            } else if !value.is_nan() {
                refuse(StayaStatus::Range, row, "use staya_set, which knows the range");
            } else if row.absent == Absent::Needed {
                refuse(StayaStatus::Needed, row, "give it with staya_set");
            }
        }
    });
    refused?;
    let wrong = adapt(&mut settings, &|name| given.contains(&name), around);
    wrong.map_err(|wrong| Fault { status: StayaStatus::Contradiction, kind, wrong })?;
    Ok(settings)
}

impl StayaSetup {
    fn law_name(&self) -> Checked<&'static str> {
        name_at(laws(), self.law)
    }

    fn layer_name(&self) -> Checked<&'static str> {
        name_at(LayerSettings::ALL.iter(), self.layer)
    }

    pub(crate) fn choose_law(&mut self, name: &str) -> Checked<()> {
        (self.law, self.law_values) = (number(laws(), name)?, [f32::NAN; STAYA_LAW_VALUES]);
        Ok(())
    }

    pub(crate) fn choose_layer(&mut self, name: &str) -> Checked<()> {
        let layer = number(LayerSettings::ALL.iter(), name)?;
        (self.layer, self.layer_values) = (layer, [f32::NAN; STAYA_LAYER_VALUES]);
        Ok(())
    }

    fn law_rows(&mut self, visit: Rows<'_>) -> Checked<()> {
        let (name, mut values) = (self.law_name()?, self.law_values.iter_mut());
        if let Some(mut law) = LawSettings::by_name(name) {
            let kind = law.section();
            law.tables(&mut |table| rows(kind, table, &mut values, visit));
        }
        Ok(())
    }

    fn layer_rows(&mut self, visit: Rows<'_>) -> Checked<()> {
        let (name, mut values) = (self.layer_name()?, self.layer_values.iter_mut());
        if let Some(mut layer) = LayerSettings::by_name(name) {
            let kind = layer.section();
            layer.tables(&mut |table| rows(kind, table, &mut values, visit));
        }
        Ok(())
    }

    /// Sets the rows with this name, or with `SECTION.NAME` that of the law or layer alone, to the
    /// value that `pick` finds.
    fn set(&mut self, path: &str, pick: &dyn Fn(&Parameter) -> Option<f32>) -> Checked<()> {
        let (kind, name) = path.split_once('.').unwrap_or(("", path));
        let mut answer = Err(StayaStatus::Row);
        let mut set = |of: &str, row: &Parameter, _: f32, value: &mut f32| {
            if row.name == name && (kind.is_empty() || kind == of) {
                match pick(row) {
                    Some(picked) if answer != Err(StayaStatus::Range) => (*value, answer) = (picked, Ok(())),
                    _ => answer = Err(StayaStatus::Range),
                }
            }
        };
        self.law_rows(&mut set)?;
        self.layer_rows(&mut set)?;
        answer
    }

    fn around(&self, goals: Goals) -> Around {
        let s = |us: i32| us as f32 * 1e-6;
        let or = |speed_mps: f32, other_mps| if speed_mps > 0.0 { speed_mps } else { other_mps };
        let max_speed_mps = or(self.max_speed_mps, self.speed_mps);
        Around {
            radius_m: self.radius_m,
            max_speed_mps,
            fastest_mps: or(self.fastest_mps, max_speed_mps),
            brake_s: (2.0 * (max_speed_mps / self.max_acceleration_mps2 + self.lag_s)).min(60.0),
            has_goal: goals.are_own(),
            cruise_mps: (self.on_grid == 0).then_some(self.speed_mps),
            tolerance_m: self.tolerance_m,
            delay_s: s(self.latency_us.max(0)),
            rate_hz: 1.0 / s(self.beacon_period_us.max(1)),
            seed: self.common_seed,
            radius: self.sight_cells,
            norm: if self.diagonals_count_as_one == 0 { Norm::Euclidean } else { Norm::Chebyshev },
            corner_cutting: self.cuts_corners != 0,
        }
    }

    /// Refuses a body that a law with this motion cannot move.
    fn check_body(&self, motion: Motion) -> Result<(), Fault> {
        let is_on_grid = self.on_grid != 0;
        if is_on_grid && motion == Motion::Velocities {
            let what = "this law moves by velocities";
            return Fault::field(
                StayaStatus::Contradiction,
                "on_grid",
                what,
                "set it to 0, or choose a law over cells",
            );
        }
        if motion == Motion::Cells && !(1..=STAYA_MAX_RADIUS).contains(&self.sight_cells) {
            return Fault::field(StayaStatus::Search, "sight_cells", "out of range", "use 1 to STAYA_MAX_RADIUS");
        }
        if !(is_on_grid || self.speed_mps > 0.0 && self.speed_mps.is_finite()) {
            return Fault::field(
                StayaStatus::Number,
                "speed_mps",
                "not above 0, or not finite",
                "give the usual speed",
            );
        }
        let [least, greatest] = TOLERANCE.range;
        if !(least..=greatest).contains(&self.tolerance_m) {
            return Fault::field(StayaStatus::Number, "tolerance_m", "out of range", "use a tenth of the radius");
        }
        Ok(())
    }

    /// Settings of the chosen law; `None`: the caller decides.
    pub(crate) fn law_settings(&self) -> Result<Option<LawSettings>, Fault> {
        let name = self.law_name()?;
        let Some(law) = LawSettings::by_name(name) else {
            if self.protocol < FIRST_PROTOCOL {
                return Fault::field(StayaStatus::Choice, "protocol", "not one of users", "use 64 to 255");
            }
            return Ok(None);
        };
        self.check_body(law.motion())?;
        let (tables, adapt, around) = (LawSettings::tables, LawSettings::adapt, self.around(law.goals()));
        let law = filled(law.section(), law, tables, adapt, &self.law_values, &around)?;
        #[cfg(feature = "grid")]
        let law = match law {
            LawSettings::Formation(mut formation) => {
                formation.template = self.formation.template()?;
                LawSettings::Formation(formation)
            }
            law => law,
        };
        Ok(Some(law))
    }

    /// Settings of a law without an agent.
    #[cfg(feature = "flocks")]
    pub(crate) fn settings<T: staya_controller::agent::SettingsOfLaw>(&self) -> Result<T, Fault> {
        self.check_version()?;
        if self.law_name()? != T::NAME {
            return Err(StayaStatus::Law.into());
        }
        self.check_body(T::MOTION)?;
        filled(T::SECTION, T::default(), T::tables, T::adapt, &self.law_values, &self.around(T::GOALS))
    }

    /// Settings of the chosen layer.
    pub(crate) fn layer_settings(&self) -> Result<LayerSettings, Fault> {
        let name = self.layer_name()?;
        let layer = LayerSettings::by_name(name).ok_or(StayaStatus::Law)?;
        let goals = LawSettings::by_name(self.law_name()?).map_or(Goals::None, |law| law.goals());
        let (tables, adapt) = (LayerSettings::tables, LayerSettings::adapt);
        filled(layer.section(), layer, tables, adapt, &self.layer_values, &self.around(goals))
    }

    /// Creates the law in place.
    pub(crate) fn law(&self, law: &mut Law) -> Checked<Place> {
        let Some(settings) = self.law_settings()? else {
            *law = Law::External(External::new(ProtocolId(self.protocol)));
            return Ok(Place::Any);
        };
        *law = Law::Listed(settings.law(()));
        Ok(match (settings.motion(), self.on_grid) {
            (Motion::Velocities, _) => Place::Plane,
            (Motion::Cells, 0) => Place::Cells,
            (Motion::Cells, _) => Place::Grid,
        })
    }
}

/// Chooses the law of a robot by its name (`staya_law` lists all), with its defaults.
/// `STAYA_STATUS_LAW` if this build does not have it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_choose_law(setup: *mut StayaSetup, name: *const c_char) -> StayaStatus {
    answers!(|call| {
        let mut changed = *call.shared(setup)?.check_version()?;
        changed.choose_law(call.text(name)?)?;
        call.write(setup, changed)
    })
}

/// Chooses the safety layer of a robot by its name (`staya_layer` lists all), with its defaults.
/// `STAYA_STATUS_LAW` if this build does not have it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_choose_layer(setup: *mut StayaSetup, name: *const c_char) -> StayaStatus {
    answers!(|call| {
        let mut changed = *call.shared(setup)?.check_version()?;
        changed.choose_layer(call.text(name)?)?;
        call.write(setup, changed)
    })
}

/// Sets a value of the chosen law and layer by the name of its row (`staya_law_row`,
/// `staya_layer_row`). If both have the row, "SECTION.ROW" sets that of one, with its section in
/// scenario files. Rows that count or choose take the nearest whole number. `STAYA_STATUS_ROW` if
/// neither has it, `STAYA_STATUS_RANGE` if it cannot have the value; `staya_init` checks whether
/// values go together.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_set(setup: *mut StayaSetup, row: *const c_char, value: f32) -> StayaStatus {
    answers!(|call| {
        let mut changed = *call.shared(setup)?.check_version()?;
        changed.set(call.text(row)?, &|row| {
            let [least, greatest] = row.range;
            (least..=greatest).contains(&value).then_some(value)
        })?;
        call.write(setup, changed)
    })
}

/// Like `staya_set`, for a row whose values are words, such as "true" and "false".
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_set_word(
    setup: *mut StayaSetup,
    row: *const c_char,
    word: *const c_char,
) -> StayaStatus {
    answers!(|call| {
        let (mut changed, word) = (*call.shared(setup)?.check_version()?, call.text(word)?);
        changed.set(call.text(row)?, &|row| {
            let place = row.words.iter().position(|known| *known == word)?;
            u8::try_from(place).ok().map(f32::from)
        })?;
        call.write(setup, changed)
    })
}

/// Says why `staya_init` refuses the law or the layer of a setup.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_explain(setup: *const StayaSetup, fault: *mut StayaFault) -> StayaStatus {
    answers!(|call| {
        let setup = call.shared(setup)?.check_version()?;
        let found = setup.law_settings().and_then(|_| setup.layer_settings());
        let Fault { status, kind, wrong } = found.err().unwrap_or(StayaStatus::Ok.into());
        let fault = call.zeroed(fault)?;
        (fault.status, fault.what, fault.remedy) = (status as i32, text([wrong.what]), text([wrong.remedy]));
        fault.least = wrong.least.unwrap_or(f32::NAN);
        fault.row = text(if kind.is_empty() { ["", "", wrong.row] } else { [kind, ".", wrong.row] });
        Ok(())
    })
}

fn kind(mut all: impl Iterator<Item = &'static (&'static str, &'static str)>, index: u32) -> Checked<StayaKind> {
    let &(name, what) = all.nth(index as usize).ok_or(StayaStatus::Unknown)?;
    Ok(StayaKind { name: text([name]), text: text([what]) })
}

/// Writes law 0, 1, 2 and so on of this build; `STAYA_STATUS_UNKNOWN` beyond the last one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_law(index: u32, law: *mut StayaKind) -> StayaStatus {
    answers!(|call| call.write(law, kind(laws(), index)?))
}

/// Writes safety layer 0, 1, 2 and so on of this build; `STAYA_STATUS_UNKNOWN` beyond the last one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_layer(index: u32, layer: *mut StayaKind) -> StayaStatus {
    answers!(|call| call.write(layer, kind(LayerSettings::ALL.iter(), index)?))
}

fn row_at(index: u32, list: impl FnOnce(Rows<'_>) -> Checked<()>) -> Checked<StayaParameter> {
    let (mut left, mut found) = (index, None);
    list(&mut |_, row, usual, given| {
        if left == 0 && found.is_none() {
            found = Some(StayaParameter::new(row, if given.is_nan() { usual } else { *given }));
        }
        left = left.saturating_sub(1);
    })?;
    found.ok_or(StayaStatus::Unknown)
}

/// Writes row 0, 1, 2 and so on of the chosen law with its present value; NaN: it depends on other
/// values, or must be given. `STAYA_STATUS_UNKNOWN` beyond the last one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_law_row(setup: *const StayaSetup, index: u32, row: *mut StayaParameter) -> StayaStatus {
    answers!(|call| {
        let mut setup = *call.shared(setup)?.check_version()?;
        call.write(row, row_at(index, |visit| setup.law_rows(visit))?)
    })
}

/// Writes row 0, 1, 2 and so on of the chosen layer, as `staya_law_row` does.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_layer_row(
    setup: *const StayaSetup,
    index: u32,
    row: *mut StayaParameter,
) -> StayaStatus {
    answers!(|call| {
        let mut setup = *call.shared(setup)?.check_version()?;
        call.write(row, row_at(index, |visit| setup.layer_rows(visit))?)
    })
}
