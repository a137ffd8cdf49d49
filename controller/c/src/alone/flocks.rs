//! The laws of the flocks without an agent.

use super::{StayaBody, StayaNearby, StayaReference, nearest, surroundings};
use crate::io::{StayaObstacle, array, vector};
use crate::memory::{self, optional, row, shared};
use crate::setup::{StayaBoids, StayaGoalFlock, StayaLattice};
use crate::status::{StayaStatus, answer};
use staya_controller::flock::goal::wish;
use staya_controller::flock::lattice::{Reference, acceleration};
use staya_controller::geom::{Position, Vec2};
use staya_controller::robot::RobotId;
use staya_controller::scalar::cast;

/// Returns the acceleration in an alpha flock, m/s^2, not limited by the body. `reference` may
/// be null.
/// cbindgen:ptrs-as-arrays=[[acceleration_mps2; 3]]
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_lattice_acceleration(
    lattice: *const StayaLattice,
    body: *const StayaBody,
    nearby: *const StayaNearby,
    nearby_count: usize,
    obstacles: *const StayaObstacle,
    obstacle_count: usize,
    reference: *const StayaReference,
    acceleration_mps2: *mut f32,
) -> StayaStatus {
    let flock = || {
        // SAFETY: all are valid by the caller's contract, or they are rejected.
        let (params, reference) = unsafe { (shared(lattice)?.params()?, optional(reference)?) };
        // SAFETY: as above.
        let (body, others, obstacles) = unsafe { surroundings(body, nearby, nearby_count, obstacles, obstacle_count)? };
        let reference = reference.map(|reference| Reference {
            offset_m: vector(reference.offset_m),
            velocity_mps: vector(reference.velocity_mps),
        });
        let answer = acceleration(&params, &body, &others, &obstacles, reference.as_ref());
        // SAFETY: valid space by the caller's contract, or `write` rejects it.
        unsafe { memory::write(acceleration_mps2.cast(), array(answer)) }
    };
    answer(flock())
}

/// Returns the preferred velocity of a robot in a goal flock, m/s. `goal_mm` may be null.
/// cbindgen:ptrs-as-arrays=[[own_mm; 3], [goal_mm; 3], [wish_mps; 3]]
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_goal_flock_wish(
    goal_flock: *const StayaGoalFlock,
    speed_mps: f32,
    body: *const StayaBody,
    own_mm: *const i32,
    goal_mm: *const i32,
    nearby: *const StayaNearby,
    nearby_count: usize,
    wish_mps: *mut f32,
) -> StayaStatus {
    let flock = || {
        // SAFETY: all are valid by the caller's contract, or they are rejected.
        let (params, own, goal) =
            unsafe { (shared(goal_flock)?.params(speed_mps)?, *shared(own_mm.cast())?, optional(goal_mm.cast())?) };
        // SAFETY: as above.
        let (body, others, _) = unsafe { surroundings(body, nearby, nearby_count, core::ptr::null(), 0)? };
        let (own, goal) = (Position::from_mm(own), goal.map(|goal| Position::from_mm(*goal)));
        let wish = wish(&params, &body, own, goal, &others);
        // SAFETY: valid space by the caller's contract, or `write` rejects it.
        unsafe { memory::write(wish_mps.cast(), array(wish)) }
    };
    answer(flock())
}

/// Turns a boid's heading, a unit vector, to its value one step later.
/// cbindgen:ptrs-as-arrays=[[heading; 2]]
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_boids_steer(
    boids: *const StayaBoids,
    id: u32,
    nearby: *const StayaNearby,
    nearby_count: usize,
    heading: *mut f32,
) -> StayaStatus {
    let flock = || {
        // SAFETY: all are valid by the caller's contract, or they are rejected.
        let (params, others, [x, y]) =
            unsafe { (shared(boids)?.params(), row(nearby, nearby_count)?, *shared(heading.cast::<[f32; 2]>())?) };
        let next = params.steer(RobotId(id), Vec2::new(cast(x), cast(y)), &nearest(others));
        // SAFETY: as above; the references have ended.
        unsafe { memory::write(heading.cast::<[f32; 2]>(), [cast(next.x), cast(next.y)]) }
    };
    answer(flock())
}
