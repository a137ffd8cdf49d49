//! Push-out without an agent.

use super::{StayaBody, StayaNearby, surroundings};
use crate::io::{StayaObstacle, array, vector};
use crate::memory::{self, shared};
use crate::setup::StayaPushOut;
use crate::status::{StayaStatus, answer};
use staya_controller::push_out::push_out;

/// Returns the velocity nearest to `wish_mps` by the rules of push-out, m/s, for the next `step_s`.
/// cbindgen:ptrs-as-arrays=[[wish_mps; 3], [velocity_mps; 3]]
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_push_out_velocity(
    params: *const StayaPushOut,
    body: *const StayaBody,
    wish_mps: *const f32,
    nearby: *const StayaNearby,
    nearby_count: usize,
    obstacles: *const StayaObstacle,
    obstacle_count: usize,
    velocity_mps: *mut f32,
) -> StayaStatus {
    let push = || {
        // SAFETY: all are valid by the caller's contract, or they are rejected.
        let (params, wish) = unsafe { (shared(params)?.params()?, vector(*shared::<[f32; 3]>(wish_mps.cast())?)) };
        // SAFETY: as above.
        let (body, others, obstacles) = unsafe { surroundings(body, nearby, nearby_count, obstacles, obstacle_count)? };
        let best = push_out(&params, &body, wish, &others, &obstacles);
        // SAFETY: valid space by the caller's contract, or `write` rejects it.
        unsafe { memory::write(velocity_mps.cast(), array(best)) }
    };
    answer(push())
}
