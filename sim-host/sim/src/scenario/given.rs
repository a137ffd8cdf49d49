//! Fields of laws and safety layers that are parameters of the controller. Their units, ranges and
//! descriptions are those of the controller's tables.

use super::read::{Limits, Line, Table, Wrong};
use super::table::Fields;
use staya_controller::orca::AvoidParams;
use staya_controller::parameters::{Parameter, Parameters};
use staya_controller::push_out::PushOutParams;
use std::marker::PhantomData;

/// A field of a settings file that is a parameter.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    name: &'static str,
    /// Name in the controller's table.
    parameter: &'static str,
    is_needed: bool,
}

/// Parameters with fields in settings files.
pub trait Rows: Parameters {
    /// The fields.
    const ROWS: &'static [Row];

    /// The defaults; those of required fields do not count.
    fn usual() -> Self;
}

macro_rules! rows {
    ($($type:ty = $usual:expr, [$($needed:ident),*] [$($name:ident $(= $parameter:ident)?),*];)*) => { $(
        impl Rows for $type {
            const ROWS: &'static [Row] = &[
                $(Row { name: stringify!($needed), parameter: stringify!($needed), is_needed: true },)*
                $(Row {
                    name: stringify!($name),
                    parameter: last(&[stringify!($name) $(, stringify!($parameter))?]),
                    is_needed: false,
                },)*
            ];

            fn usual() -> Self {
                $usual
            }
        }
    )* };
}
// Required fields, then optional ones, with the names of the parameters if those are others.
rows! {
    AvoidParams<f32> = Self::default(), [] [horizon_s, wall_horizon_s, share, margin_m];
    PushOutParams<f32> = Self::new(1.0), [min_distance_m] [];
}

const fn last(names: &[&'static str]) -> &'static str {
    names[names.len() - 1]
}

/// The fields of a table that are parameters of `P`, as given in the file.
#[derive(Clone, Debug)]
pub struct Given<P> {
    values: Vec<Option<f64>>,
    params: PhantomData<P>,
}

impl<P: Rows> Given<P> {
    /// The value of a field, if it is given.
    pub(super) fn get(&self, name: &str) -> Option<f64> {
        *self.values.get(P::ROWS.iter().position(|row| row.name == name)?)?
    }

    /// Stores the given values. Values that contradict the other parameters are left out.
    pub(super) fn store(&self, params: &mut P) {
        for (row, value) in P::ROWS.iter().zip(&self.values) {
            if let Some(value) = value {
                let (index, _) = parameter(params, row);
                let _ = params.store(index, *value as f32, true);
            }
        }
    }
}

fn parameter(params: &impl Parameters, row: &Row) -> (usize, &'static Parameter) {
    let index = params.index(row.parameter).unwrap_or_else(|| panic!("no parameter {}", row.parameter));
    (index, &params.table()[index])
}

impl<P: Rows> Fields for Given<P> {
    fn names() -> Vec<&'static str> {
        P::ROWS.iter().map(|row| row.name).collect()
    }

    fn fields(table: &Table<'_>) -> Result<Self, Wrong> {
        let usual = P::usual();
        let read = |row: &Row| {
            let value = table.read(row.name, Some(&Limits::of(parameter(&usual, row).1)))?;
            if row.is_needed && value.is_none() { Err(table.missing(row.name)) } else { Ok(value) }
        };
        Ok(Self { values: P::ROWS.iter().map(read).collect::<Result<_, _>>()?, params: PhantomData })
    }

    fn part_lines() -> Vec<Line> {
        let usual = P::usual();
        let line = |row: &Row| {
            let (index, parameter) = parameter(&usual, row);
            // Beside a required field, other lengths depend on it.
            let depends = parameter.unit == "m" && P::ROWS.iter().any(|row| row.is_needed);
            super::law::line(parameter, usual.get(index).filter(|_| !row.is_needed && !depends))
        };
        P::ROWS.iter().map(line).collect()
    }
}
