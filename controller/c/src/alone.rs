//! Behaviours without an agent, for robots that sense each other or use their own radio: safety
//! layers.

#[cfg(feature = "flocks")]
pub mod flocks;

use crate::io::{StayaObstacle, array, read_obstacles, vector};
use crate::memory::{Call, Resident, answers, plain};
use crate::setup::StayaSetup;
use crate::status::{Checked, StayaStatus};
use crate::{Layer, Number, OBSTACLES};
use core::ffi::c_void;
use heapless::Vec;
use staya_controller::agent::{Safety, SafetyInput};
use staya_controller::body::Body;
use staya_controller::neighbor::Nearby;
use staya_controller::obstacle::Obstacle;
use staya_controller::rand::Rng;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::scalar::cast;

/// Bytes that suffice for an avoider.
pub const STAYA_AVOIDER_SIZE: usize = 256;
/// Maximum number of robots that these behaviours consider: the nearest of all that are given.
pub const STAYA_NEARBY: usize = 16;

const _: () = assert!(size_of::<StayaAvoider>() <= STAYA_AVOIDER_SIZE && align_of::<StayaAvoider>() <= 8);

/// The body of this robot. One that follows commands with a lag gives the point ahead of it, at its
/// velocity times the lag, as its position, and its last command as its velocity.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaBody {
    /// Its number, 1 or more. If two robots are in one place, it decides which way each goes.
    pub id: u32,
    /// Its velocity, m/s.
    pub velocity_mps: [f32; 3],
    /// Radius of the ball around it, metres.
    pub radius_m: f32,
    /// Its highest possible speed in its present place, m/s.
    pub max_speed_mps: f32,
    /// How fast it can change its velocity, m/s^2; FLT_MAX: at once.
    pub max_acceleration_mps2: f32,
    /// Time from one decision to the next, seconds; more than 0.
    pub step_s: f32,
}

/// The present state of another robot.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaNearby {
    /// Its number.
    pub id: u32,
    /// Its position minus that of this robot, metres.
    pub offset_m: [f32; 3],
    /// Its velocity, m/s.
    pub velocity_mps: [f32; 3],
    /// Radius of the ball around it, metres.
    pub radius_m: f32,
    /// 0: it does not give way, and this robot makes the whole correction.
    pub gives_way: u8,
    /// Other than 0: it has arrived and stays (STAYA_MODE_ARRIVED), so others do not wait for it.
    pub is_parked: u8,
    /// Other than 0: it belongs to another flock, and is only an obstacle.
    pub is_stranger: u8,
}

/// The point that a flock follows, as a robot sees it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaReference {
    /// Its position minus that of this robot, metres.
    pub offset_m: [f32; 3],
    /// Its velocity, m/s.
    pub velocity_mps: [f32; 3],
}

plain!(StayaBody, StayaNearby, StayaReference);

impl StayaBody {
    fn body(&self) -> Body<Number> {
        Body {
            id: RobotId(self.id),
            velocity_mps: vector(self.velocity_mps),
            radius_m: cast(self.radius_m),
            max_speed_mps: cast(self.max_speed_mps),
            max_acceleration_mps2: cast(self.max_acceleration_mps2),
            step_s: cast(self.step_s),
        }
    }
}

impl StayaNearby {
    fn nearby(&self) -> Nearby<Number> {
        Nearby {
            id: RobotId(self.id),
            offset_m: vector(self.offset_m),
            velocity_mps: vector(self.velocity_mps),
            radius_m: cast(self.radius_m),
            gives_way: self.gives_way != 0,
            mode: if self.is_parked == 0 { Mode::Cruise } else { Mode::Arrived },
            is_stranger: self.is_stranger != 0,
        }
    }
}

/// The nearest robots, nearest first, of equally near ones the earlier. O(all * STAYA_NEARBY).
fn nearest(all: &[StayaNearby]) -> Vec<Nearby<Number>, STAYA_NEARBY> {
    let mut kept = Vec::<(u64, Nearby<Number>), STAYA_NEARBY>::new();
    // A position that is not a number would count as the nearest.
    for other in all.iter().filter(|other| other.offset_m.iter().all(|component| component.is_finite())) {
        let other = other.nearby();
        let mut moved = (other.offset_m.length_key(), other);
        let mut is_nearer = false;
        for place in &mut kept {
            is_nearer |= moved.0 < place.0;
            if is_nearer {
                core::mem::swap(place, &mut moved);
            }
        }
        // The farthest one does not fit into a full list.
        let _ = kept.push(moved);
    }
    let mut nearest = Vec::new();
    for (_, other) in &kept {
        let _ = nearest.push(*other);
    }
    nearest
}

/// Reads the arguments that all behaviours share.
#[expect(clippy::type_complexity, reason = "cbindgen reads no alias of it")]
fn surroundings(
    call: Call<'_>,
    body: *const StayaBody,
    (nearby, nearby_count): (*const StayaNearby, usize),
    (obstacles, obstacle_count): (*const StayaObstacle, usize),
) -> Checked<(Body<Number>, Vec<Nearby<Number>, STAYA_NEARBY>, Vec<Obstacle<Number>, OBSTACLES>)> {
    let (body, others) = (call.shared(body)?.body(), call.row(nearby, nearby_count)?);
    let mut known = Vec::new();
    read_obstacles(call.row(obstacles, obstacle_count)?, &mut known)?;
    Ok((body, nearest(others), known))
}

/// The safety layer of one robot. Its contents are private to the library.
// A separate item, since cbindgen would otherwise export the fields.
#[cfg_attr(all(), repr(C))]
pub struct StayaAvoider {
    mark: u32,
    layer: Layer,
    rng: Rng,
}

// SAFETY: `repr(C)`, and the mark is its first field.
unsafe impl Resident for StayaAvoider {
    const MARK: u32 = u32::from_be_bytes(*b"avoi");
}

/// Creates the safety layer that a setup has chosen, for one robot, in the caller's memory:
/// STAYA_AVOIDER_SIZE bytes aligned to STAYA_ALIGN. The setup's `seed` draws random tie-breaks;
/// robots may share it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_avoider_init(
    memory: *mut c_void,
    memory_bytes: usize,
    setup: *const StayaSetup,
    avoider: *mut *mut StayaAvoider,
) -> StayaStatus {
    answers!(|call| {
        call.write(avoider, core::ptr::null_mut())?;
        let site = call.site::<StayaAvoider>(memory, memory_bytes)?;
        let setup = call.shared(setup)?.check_version()?;
        let (layer, rng) = (setup.layer_settings()?.layer(), Rng::new(setup.seed));
        // SAFETY: aligned space for the whole avoider, not used elsewhere.
        unsafe { site.write(StayaAvoider { mark: StayaAvoider::MARK, layer, rng }) };
        call.write(avoider, site)
    })
}

/// Returns the velocity to take until the next step, m/s: the one nearest to `wish_mps` that robots
/// and obstacles permit. Call it once per `step_s`, always for the same robot.
///
/// `way_m` is the vector to the goal, metres, or null; near the goal the robot does not turn aside.
/// Only the nearest STAYA_NEARBY robots count. A layer in the plane ignores heights and keeps that
/// of the wish.
/// cbindgen:ptrs-as-arrays=[[wish_mps; 3], [way_m; 3], [velocity_mps; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_avoider_velocity(
    avoider: *mut StayaAvoider,
    body: *const StayaBody,
    wish_mps: *const f32,
    way_m: *const f32,
    nearby: *const StayaNearby,
    nearby_count: usize,
    obstacles: *const StayaObstacle,
    obstacle_count: usize,
    velocity_mps: *mut f32,
) -> StayaStatus {
    answers!(|call| {
        let StayaAvoider { layer, rng, .. } = call.resident_mut(avoider)?;
        let wish_mps = vector(*call.shared::<[f32; 3]>(wish_mps.cast())?);
        let way_m = call.optional::<[f32; 3]>(way_m.cast())?.map(|way| vector(*way));
        let (body, others, known) = surroundings(call, body, (nearby, nearby_count), (obstacles, obstacle_count))?;
        let input = SafetyInput { body, wish_mps, way_m, nearby: &others, obstacles: &known };
        call.write(velocity_mps.cast(), array(layer.keep_clear(&input, rng)))
    })
}
