//! Push-out without an agent.

use super::{StayaBody, StayaNearby, surroundings};
use crate::io::{StayaObstacle, array, vector};
use crate::memory::answers;
use crate::setup::StayaPushOut;
use crate::status::StayaStatus;
use staya_controller::push_out::push_out;

/// Returns the velocity nearest to `wish_mps` by the rules of push-out, m/s, for the next `step_s`.
/// cbindgen:ptrs-as-arrays=[[wish_mps; 3], [velocity_mps; 3]]
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
    answers!(|call| {
        let (params, wish) = (call.shared(params)?.params()?, vector(*call.shared::<[f32; 3]>(wish_mps.cast())?));
        let (body, others, obstacles) = surroundings(call, body, (nearby, nearby_count), (obstacles, obstacle_count))?;
        call.write(velocity_mps.cast(), array(push_out(&params, &body, wish, &others, &obstacles)))
    })
}
