//! Parameters that can be changed while a robot runs.

use crate::agent::StayaAgent;
use crate::memory::answers;
use crate::row::StayaParameter;
use crate::status::StayaStatus;
use core::ffi::c_char;

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
