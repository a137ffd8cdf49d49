//! The laws of the flocks without an agent.

use super::{StayaBody, StayaNearby, StayaReference, nearest, surroundings};
use crate::Number;
use crate::io::{StayaObstacle, array, vector};
use crate::memory::answers;
use crate::setup::StayaSetup;
use crate::status::StayaStatus;
use staya_controller::agent::{BoidsSettings, GoalFlockSettings, LatticeSettings};
use staya_controller::geom::{Position, Vec2};
use staya_controller::goal_flock::wish;
use staya_controller::lattice::{Reference, acceleration};
use staya_controller::robot::RobotId;
use staya_controller::scalar::cast;

/// Returns the acceleration in an alpha flock, m/s^2, not limited by the body. The setup has chosen
/// the law "lattice". `reference` may be null.
/// cbindgen:ptrs-as-arrays=[[acceleration_mps2; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_lattice_acceleration(
    setup: *const StayaSetup,
    body: *const StayaBody,
    nearby: *const StayaNearby,
    nearby_count: usize,
    obstacles: *const StayaObstacle,
    obstacle_count: usize,
    reference: *const StayaReference,
    acceleration_mps2: *mut f32,
) -> StayaStatus {
    answers!(|call| {
        let params = call.shared(setup)?.settings::<LatticeSettings>()?.params.cast();
        let reference = call.optional(reference)?.map(|reference| Reference {
            offset_m: vector(reference.offset_m),
            velocity_mps: vector(reference.velocity_mps),
        });
        let (body, others, obstacles) = surroundings(call, body, (nearby, nearby_count), (obstacles, obstacle_count))?;
        let answer = acceleration(&params, &body, &others, &obstacles, reference.as_ref());
        call.write(acceleration_mps2.cast(), array(answer))
    })
}

/// Returns the preferred velocity of a robot in a goal flock, m/s. The setup has chosen the law
/// "goal_flock". `goal_mm` may be null.
/// cbindgen:ptrs-as-arrays=[[own_mm; 3], [goal_mm; 3], [wish_mps; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_goal_flock_wish(
    setup: *const StayaSetup,
    body: *const StayaBody,
    own_mm: *const i32,
    goal_mm: *const i32,
    nearby: *const StayaNearby,
    nearby_count: usize,
    wish_mps: *mut f32,
) -> StayaStatus {
    answers!(|call| {
        let params = call.shared(setup)?.settings::<GoalFlockSettings>()?.params.cast();
        let own = Position::from_mm(*call.shared(own_mm.cast())?);
        let goal = call.optional(goal_mm.cast())?.map(|goal| Position::from_mm(*goal));
        let (body, others, _) = surroundings(call, body, (nearby, nearby_count), (core::ptr::null(), 0))?;
        call.write(wish_mps.cast(), array(wish(&params, &body, own, goal, &others)))
    })
}

/// Turns a boid's heading, a unit vector, to its value one step later. The setup has chosen the law
/// "boids".
/// cbindgen:ptrs-as-arrays=[[heading; 2]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_boids_steer(
    setup: *const StayaSetup,
    id: u32,
    nearby: *const StayaNearby,
    nearby_count: usize,
    heading: *mut f32,
) -> StayaStatus {
    answers!(|call| {
        let params = call.shared(setup)?.settings::<BoidsSettings>()?.params::<Number>();
        let others = call.row(nearby, nearby_count)?;
        let [x, y] = *call.shared(heading.cast::<[f32; 2]>())?;
        let next = params.steer(RobotId(id), Vec2::new(cast(x), cast(y)), &nearest(others));
        call.write(heading.cast::<[f32; 2]>(), [cast(next.x), cast(next.y)])
    })
}
