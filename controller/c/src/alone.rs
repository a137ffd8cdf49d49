//! Behaviours by themselves, on arrays of the caller's, for robots that sense each other or have a radio of their own: ORCA here.

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

/// Bytes that are enough for an avoider.
pub const STAYA_ORCA_SIZE: usize = 256;
/// Robots that a behaviour by itself takes into account: the nearest of all that it is told of.
pub const STAYA_NEARBY: usize = 16;

const _: () = assert!(size_of::<StayaAvoider>() <= STAYA_ORCA_SIZE && align_of::<StayaAvoider>() <= 8);

/// The own body.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaBody {
    /// Own number, 1 or more: when two are in one place it says who goes which way.
    pub id: u32,
    /// Own velocity, m/s.
    pub velocity_mps: [f32; 3],
    /// Radius of the ball around it, metres.
    pub radius_m: f32,
    /// How fast it can go where it is, m/s.
    pub max_speed_mps: f32,
    /// How fast it can change its velocity, m/s^2; FLT_MAX: at once.
    pub max_acceleration_mps2: f32,
    /// Time from one decision to the next, seconds; more than 0.
    pub step_s: f32,
}

/// Another robot, as it is right now.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaNearby {
    /// Who it is.
    pub id: u32,
    /// Its place minus the own one, metres.
    pub offset_m: [f32; 3],
    /// Its velocity, m/s.
    pub velocity_mps: [f32; 3],
    /// Radius of the ball that it is in, metres.
    pub radius_m: f32,
    /// 0: it does not make way, and all of a correction is one's own.
    pub gives_way: u8,
    /// Other than 0: it stands at its place and will stay (STAYA_MODE_ARRIVED), so others need not wait for it.
    pub is_parked: u8,
    /// Other than 0: of another flock, and only in the way.
    pub is_stranger: u8,
}

/// Where a flock should be, as a robot sees it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaReference {
    /// Its place minus the own one, metres.
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

/// The nearest ones, nearest first, of equally near ones the earlier. O(all * STAYA_NEARBY).
fn nearest(all: &[StayaNearby]) -> Vec<Nearby<Number>, STAYA_NEARBY> {
    let mut kept = Vec::<(u64, Nearby<Number>), STAYA_NEARBY>::new();
    for other in all {
        // A place that is not a number would be the nearest one.
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
        // As many places as there are.
        let _ = nearest.push(*other);
    }
    nearest
}

/// Moves the last one up to its place.
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

/// What all of them are told.
///
/// # Safety
/// The pointers are null or misaligned, or lead to as many as is said, which nobody writes to meanwhile.
#[expect(clippy::type_complexity, reason = "cbindgen reads no alias of it")]
unsafe fn surroundings(
    body: *const StayaBody,
    nearby: *const StayaNearby,
    nearby_count: usize,
    obstacles: *const StayaObstacle,
    obstacle_count: usize,
) -> Checked<(Body<Number>, Vec<Nearby<Number>, STAYA_NEARBY>, Vec<Obstacle<Number>, OBSTACLES>)> {
    // SAFETY: the caller's promise.
    let (body, others, seen) =
        unsafe { (shared(body)?.body(), row(nearby, nearby_count)?, row(obstacles, obstacle_count)?) };
    let mut obstacles = Vec::new();
    read_obstacles(seen, &mut obstacles)?;
    Ok((body, nearest(others), obstacles))
}

/// ORCA of one robot. What is in it is the library's own business.
// So that cbindgen, which does not read it like this, takes what is in it for nobody's business.
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

/// The parameters of ORCA that suit most robots.
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_orca_defaults(orca: *mut StayaOrca) -> StayaStatus {
    // SAFETY: the caller gives room for it, or what `write` refuses.
    answer(unsafe { memory::write(orca, StayaOrca::defaults()) })
}

/// Makes ORCA for one robot in memory of the caller's, STAYA_ORCA_SIZE bytes aligned by STAYA_ALIGN: in the plane, or with `in_space`
/// other than 0 in space. `seed` is of the draws that end ties; robots may have the same.
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
        // SAFETY: the caller gives room for a pointer, or what `write` refuses.
        unsafe { memory::write(avoider, core::ptr::null_mut())? };
        // SAFETY: the caller gives so much memory, or what `site` refuses.
        let site = unsafe { site::<StayaAvoider>(memory, memory_bytes)? };
        // SAFETY: the caller gives parameters, or what `shared` refuses.
        let inside = AnyAvoider::new(unsafe { shared(orca)? }, in_space)?;
        // SAFETY: aligned room for all of it; nobody else uses it.
        unsafe { site.write(StayaAvoider { mark: StayaAvoider::MARK, avoider: inside, rng: Rng::new(seed) }) };
        // SAFETY: as above.
        unsafe { memory::write(avoider, site) }
    };
    answer(make())
}

/// The velocity to take until the next step, m/s: the nearest to `wish_mps` that robots and obstacles permit. To be called once a
/// `step_s` for the same robot.
///
/// `way_m` is the way to the goal, metres, null without one: near it nobody swerves. Of the robots the nearest STAYA_NEARBY count, in
/// any order. In the plane heights play no part, and the answer has the height of the wish.
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
        // SAFETY: the caller gives all of them, or what is refused.
        let (own, wish, way) =
            unsafe { (resident_mut(avoider)?, vector(*shared::<[f32; 3]>(wish_mps.cast())?), optional(way_m.cast())?) };
        // SAFETY: as above.
        let (body, others, obstacles) = unsafe { surroundings(body, nearby, nearby_count, obstacles, obstacle_count)? };
        let StayaAvoider { avoider, rng, .. } = own;
        let best = avoider.velocity(&body, wish, way.map(|way| vector(*way)), &others, &obstacles, rng);
        // SAFETY: the caller gives room for it, or what `write` refuses.
        unsafe { memory::write(velocity_mps.cast(), array(best)) }
    };
    answer(avoid())
}
