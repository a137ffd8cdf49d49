//! Behaviours without an agent, for robots that sense each other or use their own radio; ORCA.

#[cfg(feature = "flocks")]
pub mod flocks;
#[cfg(feature = "push-out")]
pub mod push_out;

use crate::io::{StayaObstacle, array, read_obstacles, vector};
use crate::layer::Source;
use crate::memory::{self, Resident, optional, plain, resident_mut, row, shared, site};
use crate::setup::StayaOrca;
use crate::status::{Checked, StayaStatus, answer};
use crate::{HALF_PLANES, Number, OBSTACLES};
use core::ffi::c_void;
use heapless::Vec;
use staya_controller::body::Body;
use staya_controller::geom::Vec3;
use staya_controller::neighbor::Nearby;
use staya_controller::obstacle::Obstacle;
use staya_controller::orca::Avoider;
#[cfg(feature = "space")]
use staya_controller::orca::InSpace;
use staya_controller::rand::Rng;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::scalar::cast;

/// Bytes that suffice for an avoider.
pub const STAYA_ORCA_SIZE: usize = 256;
/// Maximum number of robots that these behaviours consider: the nearest of all that are given.
pub const STAYA_NEARBY: usize = 16;

const _: () = assert!(size_of::<StayaAvoider>() <= STAYA_ORCA_SIZE && align_of::<StayaAvoider>() <= 8);

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
    for other in all {
        // A position that is not a number would count as the nearest.
        if !other.offset_m.iter().all(|component| component.is_finite()) {
            continue;
        }
        let other = other.nearby();
        let key = other.offset_m.length_key();
        if kept.is_full() && kept.last().is_some_and(|(farthest, _)| *farthest > key) {
            kept.pop();
        }
        if kept.push((key, other)).is_ok() {
            sink(&mut kept);
        }
    }
    let mut nearest = Vec::new();
    for (_, other) in kept.as_slice() {
        // There is space for all.
        let _ = nearest.push(*other);
    }
    nearest
}

fn sink(kept: &mut [(u64, Nearby<Number>)]) {
    let mut rest = kept;
    while let [.., before, last] = rest {
        if before.0 <= last.0 {
            return;
        }
        core::mem::swap(before, last);
        let shorter = rest.len().saturating_sub(1);
        match rest.get_mut(..shorter) {
            Some(front) => rest = front,
            None => return,
        }
    }
}

/// Reads the arguments that all behaviours share.
///
/// # Safety
/// Each pointer is null, misaligned, or valid for the given number of elements, which are not
/// modified during the call.
#[expect(clippy::type_complexity, reason = "cbindgen reads no alias of it")]
unsafe fn surroundings(
    body: *const StayaBody,
    nearby: *const StayaNearby,
    nearby_count: usize,
    obstacles: *const StayaObstacle,
    obstacle_count: usize,
) -> Checked<(Body<Number>, Vec<Nearby<Number>, STAYA_NEARBY>, Vec<Obstacle<Number>, OBSTACLES>)> {
    // SAFETY: the caller's contract.
    let (body, others, seen) =
        unsafe { (shared(body)?.body(), row(nearby, nearby_count)?, row(obstacles, obstacle_count)?) };
    let mut obstacles = Vec::new();
    read_obstacles(seen, &mut obstacles)?;
    Ok((body, nearest(others), obstacles))
}

/// ORCA for one robot. Its contents are private to the library.
// A separate item, since cbindgen would otherwise export the fields.
#[cfg_attr(all(), repr(C))]
pub struct StayaAvoider {
    mark: u32,
    avoider: AnyAvoider,
    rng: Rng,
}

// SAFETY: `repr(C)`, and the mark is its first field.
unsafe impl Resident for StayaAvoider {
    const MARK: u32 = u32::from_be_bytes(*b"orca");
}

enum AnyAvoider {
    Plane(Avoider<Number, HALF_PLANES, Source>),
    #[cfg(feature = "space")]
    Space(Avoider<Number, HALF_PLANES, InSpace<Number>>),
}

impl AnyAvoider {
    fn new(orca: &StayaOrca, in_space: u8) -> Checked<Self> {
        if !(orca.horizon_s > 0.0 && orca.wall_horizon_s > 0.0) {
            return Err(StayaStatus::Number);
        }
        if in_space == 0 {
            return Ok(Self::Plane(Avoider::with_source(orca.params(), Source::Formula)));
        }
        #[cfg(feature = "space")]
        {
            let source = InSpace { downwash: cast(orca.downwash) };
            Ok(Self::Space(Avoider::with_source(orca.params(), source)))
        }
        #[cfg(not(feature = "space"))]
        Err(StayaStatus::NotBuilt)
    }

    fn velocity(
        &mut self,
        body: &Body<Number>,
        wish_mps: Vec3<Number>,
        way_m: Option<Vec3<Number>>,
        nearby: &[Nearby<Number>],
        obstacles: &[Obstacle<Number>],
        rng: &mut Rng,
    ) -> Vec3<Number> {
        match self {
            Self::Plane(avoider) => {
                let way_m = way_m.map(Vec3::xy);
                let best = avoider.velocity(body, wish_mps.xy(), way_m, nearby, obstacles, rng);
                best.velocity_mps.extend(wish_mps.z)
            }
            #[cfg(feature = "space")]
            Self::Space(avoider) => avoider.velocity(body, wish_mps, way_m, nearby, obstacles, rng).velocity_mps,
        }
    }
}

/// Writes the parameters of ORCA that suit most robots.
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_orca_defaults(orca: *mut StayaOrca) -> StayaStatus {
    // SAFETY: valid space by the caller's contract, or `write` rejects it.
    answer(unsafe { memory::write(orca, StayaOrca::defaults()) })
}

/// Creates ORCA for one robot in the caller's memory, STAYA_ORCA_SIZE bytes aligned to STAYA_ALIGN;
/// in space if `in_space` is not 0. `seed` seeds random tie-breaks; robots may share it.
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_orca_init(
    memory: *mut c_void,
    memory_bytes: usize,
    orca: *const StayaOrca,
    in_space: u8,
    seed: u64,
    avoider: *mut *mut StayaAvoider,
) -> StayaStatus {
    let make = || {
        // SAFETY: a valid pointer by the caller's contract, or `write` rejects it.
        unsafe { memory::write(avoider, core::ptr::null_mut())? };
        // SAFETY: this much memory by the caller's contract, or `site` rejects it.
        let site = unsafe { site::<StayaAvoider>(memory, memory_bytes)? };
        // SAFETY: valid parameters by the caller's contract, or `shared` rejects them.
        let inside = AnyAvoider::new(unsafe { shared(orca)? }, in_space)?;
        // SAFETY: aligned space for the whole avoider, not used elsewhere.
        unsafe { site.write(StayaAvoider { mark: StayaAvoider::MARK, avoider: inside, rng: Rng::new(seed) }) };
        // SAFETY: as above.
        unsafe { memory::write(avoider, site) }
    };
    answer(make())
}

/// Returns the velocity to take until the next step, m/s: the one nearest to `wish_mps` that robots
/// and obstacles permit. Call it once per `step_s`, always for the same robot.
///
/// `way_m` is the vector to the goal, metres, or null; near the goal the robot does not turn aside.
/// Only the nearest STAYA_NEARBY robots count. The plane ignores heights and keeps that of the
/// wish.
/// cbindgen:ptrs-as-arrays=[[wish_mps; 3], [way_m; 3], [velocity_mps; 3]]
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_orca_velocity(
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
    let avoid = || {
        // SAFETY: all are valid by the caller's contract, or they are rejected.
        let (own, wish, way) =
            unsafe { (resident_mut(avoider)?, vector(*shared::<[f32; 3]>(wish_mps.cast())?), optional(way_m.cast())?) };
        // SAFETY: as above.
        let (body, others, obstacles) = unsafe { surroundings(body, nearby, nearby_count, obstacles, obstacle_count)? };
        let StayaAvoider { avoider, rng, .. } = own;
        let best = avoider.velocity(&body, wish, way.map(|way| vector(*way)), &others, &obstacles, rng);
        // SAFETY: valid space by the caller's contract, or `write` rejects it.
        unsafe { memory::write(velocity_mps.cast(), array(best)) }
    };
    answer(avoid())
}
