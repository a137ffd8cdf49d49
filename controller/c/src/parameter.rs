//! Parameters that can be changed while a robot runs.

use crate::agent::StayaAgent;
use crate::memory::{answers, plain};
use crate::status::StayaStatus;
use core::ffi::c_char;
use staya_controller::parameters::{LONGEST_DESCRIPTION, Parameter};

const _: () = assert!(LONGEST_DESCRIPTION < 64);

/// A parameter of a running robot, or a row of a setup's law or layer. Texts end with a zero.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaParameter {
    /// The name, such as "speed_mps".
    pub name: [c_char; 20],
    /// The unit; empty for a plain number.
    pub unit: [c_char; 20],
    /// A description in a few words.
    pub text: [c_char; 64],
    /// If the row is a choice: the words for 0, 1, ..., separated by blanks.
    pub words: [c_char; 64],
    /// The least value.
    pub least: f32,
    /// The greatest value.
    pub greatest: f32,
    /// The present value.
    pub value: f32,
}

plain!(StayaParameter);

impl StayaParameter {
    pub(crate) fn new(row: &Parameter, value: f32) -> Self {
        let [least, greatest] = row.range;
        let words = text(row.words.iter().flat_map(|word| [" ", *word]).skip(1));
        Self { name: text([row.name]), unit: text([row.unit]), text: text([row.what]), words, least, greatest, value }
    }
}

/// Consecutive texts, as many letters as fit before a zero.
pub(crate) fn text<'a, const N: usize>(pieces: impl IntoIterator<Item = &'a str>) -> [c_char; N] {
    let mut letters = [0; N];
    for (letter, byte) in letters.iter_mut().take(N - 1).zip(pieces.into_iter().flat_map(str::bytes)) {
        *letter = byte as c_char;
    }
    letters
}

/// Writes parameter 0, 1, 2 and so on of an agent; `STAYA_STATUS_UNKNOWN` beyond the last one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_parameter(
    agent: *mut StayaAgent,
    index: u32,
    parameter: *mut StayaParameter,
) -> StayaStatus {
    answers!(|call| {
        let (mut left, mut found) = (index as usize, None);
        call.resident_mut(agent)?.inside_mut().parameters(&mut |table| {
            let rows = table.table();
            if let Some((row, value)) = rows.get(left).zip(table.get(left)).filter(|_| found.is_none()) {
                found = Some(StayaParameter::new(row, value));
            }
            left = left.wrapping_sub(rows.len());
        });
        call.write(parameter, found.ok_or(StayaStatus::Unknown)?)
    })
}

/// Returns the present value of a parameter; `STAYA_STATUS_PARAMETER` if the robot lacks it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_get_parameter(
    agent: *mut StayaAgent,
    name: *const c_char,
    value: *mut f32,
) -> StayaStatus {
    answers!(|call| {
        let (name, agent) = (call.text(name)?, call.resident_mut(agent)?);
        call.write(value, agent.inside_mut().parameter(name).ok_or(StayaStatus::Parameter)?)
    })
}

/// Changes a parameter, such as "speed_mps", from the next step on. `STAYA_STATUS_PARAMETER`, and
/// no change, if the robot lacks it, or the value is out of range or contradicts other parameters.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_set_parameter(agent: *mut StayaAgent, name: *const c_char, value: f32) -> StayaStatus {
    answers!(|call| {
        let (name, agent) = (call.text(name)?, call.resident_mut(agent)?);
        agent.inside_mut().set_parameter(name, value).map_err(|_| StayaStatus::Parameter)
    })
}
