//! Random scenes in which radios fail: a seed gives a scenario, a run gives a row of figures.
//!
//! Seeds from 0 may be looked at while a controller is written. Seeds from [`UNSEEN`] are for the
//! end: run them once, when nothing is to be changed any more.

mod compare;
mod crowd;
mod draw;
mod kind;
mod radio;
mod row;
mod table;

pub use compare::comparison;
pub use crowd::{Crowd, Layout, Member, distance_m};
pub use draw::Draw;
pub use kind::{Kind, PERIOD};
pub use row::{HEADER, Row, run};
pub use table::{failures, table};

use crowd::{OPEN, Size};
use std::fmt::Write as _;

/// First seed of the scenes that are run only at the end.
pub const UNSEEN: u32 = 1000;

/// Tick of all scenes, seconds.
pub const TICK_S: f64 = 0.05;

/// A random scene.
#[derive(Debug)]
pub struct Scene {
    /// Seed, also of the scenario.
    pub seed: u32,
    /// The trouble of the scene.
    pub kind: Kind,
    /// The robots and walls.
    pub crowd: Crowd,
    /// The scenario.
    pub text: String,
}

/// Parts of a scenario that are drawn one after the other.
#[derive(Debug, Default)]
struct Parts {
    /// Fields of `[radio]`.
    radio: String,
    /// Further fields of `[plane]`.
    plane: String,
    /// Tables behind the robots.
    tables: String,
    /// Seconds that robots need beside their way.
    wait_s: f64,
}

impl Scene {
    /// Draws the scene with this seed. The same seed gives the same scene.
    #[must_use]
    pub fn new(seed: u32) -> Self {
        let (kind, mut draw) = (Kind::of(seed), Draw::new(seed));
        let draw = &mut draw;
        let size = size(draw, kind);
        let mut parts = Parts::default();
        let layout = layout(draw, kind);
        let mut crowd = Crowd::new(draw, layout, size);
        if kind == Kind::Mixed {
            mix(draw, &mut crowd);
        }
        let cross_s = crowd.longest_m() / size.speed_mps;
        bodies(draw, kind, &size, &mut parts);
        radio::faults(draw, kind, &crowd, cross_s, &mut parts);
        if kind == Kind::Intruder {
            intruders(draw, &crowd, &size, &mut parts);
        }
        let text = scenario(seed, kind, &size, &crowd, &parts);
        Self { seed, kind, crowd, text }
    }
}

fn size(draw: &mut Draw, kind: Kind) -> Size {
    let count = match kind {
        // Mostly below 100.
        Kind::Many => 64.0 + 137.0 * libm::pow(draw.within(0.0, 1.0), 3.0),
        Kind::Dense => draw.within(12.0, 49.0),
        Kind::Door => draw.within(6.0, 20.0),
        Kind::Corridor => draw.within(5.0, 14.0),
        _ => draw.spread(5.0, 40.0),
    };
    Size {
        count: count as usize,
        radius_m: rounded(draw.within(0.1, 0.5)),
        speed_mps: rounded(draw.within(0.3, 2.0)),
        downwash: if kind == Kind::Space && draw.chance(0.5) { rounded(draw.within(1.0, 3.0)) } else { 1.0 },
        is_dense: kind == Kind::Dense,
    }
}

fn layout(draw: &mut Draw, kind: Kind) -> Layout {
    match kind {
        Kind::Door => Layout::Door,
        Kind::Corridor => Layout::Corridor,
        Kind::Space => Layout::Room,
        Kind::Dense => Layout::Lattice,
        _ => draw.one(&OPEN),
    }
}

/// Millimetres are as precise as beacons.
fn rounded(value: f64) -> f64 {
    libm::round(value * 1000.0) / 1000.0
}

/// Makes robots smaller, and of all speeds.
fn mix(draw: &mut Draw, crowd: &mut Crowd) {
    for member in &mut crowd.members {
        member.radius_m = rounded(draw.within(0.1_f64.min(member.radius_m), member.radius_m));
        member.speed_mps = rounded(draw.within(0.3, 2.0));
    }
}

/// Inertia and safety layers.
fn bodies(draw: &mut Draw, kind: Kind, size: &Size, parts: &mut Parts) {
    let fields = &mut parts.plane;
    match kind {
        Kind::Inertia => {
            let brake_s = draw.within(0.2, 2.0);
            let _ = writeln!(fields, "max_acceleration_mps2 = {}", rounded(size.speed_mps / brake_s));
            if draw.chance(0.4) {
                let _ = writeln!(fields, "lag_s = {}", rounded(draw.within(0.05, 0.4)));
            }
            parts.wait_s += 20.0;
        }
        Kind::Blackout if draw.chance(0.3) => {
            let brake_s = draw.within(0.2, 1.0);
            let _ = writeln!(fields, "max_acceleration_mps2 = {}", rounded(size.speed_mps / brake_s));
        }
        Kind::Template => fields.push_str("safety = \"template_2k\"\n"),
        Kind::Space => {
            let _ = write!(fields, "safety = \"fly\"\n[plane.orca]\ndownwash = {}\n", size.downwash);
        }
        _ => {}
    }
}

/// Bodies that cross the middle of the crowd.
fn intruders(draw: &mut Draw, crowd: &Crowd, size: &Size, parts: &mut Parts) {
    let count = crowd.members.len() as f64;
    let mean = |axis: usize| crowd.members.iter().map(|member| member.start_m[axis] + member.goal_m[axis]).sum::<f64>();
    let middle_m = [0, 1].map(|axis| mean(axis) / 2.0 / count);
    let far_m = crowd.longest_m() + 4.0;
    for _ in 0..draw.whole(1, 2) {
        let (angle, speed_mps) = (draw.within(0.0, std::f64::consts::TAU), size.speed_mps * draw.within(0.2, 0.7));
        let radius_m = rounded(size.radius_m * draw.within(0.6, 2.0));
        let heading = [libm::cos(angle), libm::sin(angle)];
        let start_m = [0, 1].map(|axis| rounded(middle_m[axis] - far_m * heading[axis]));
        let velocity_mps = heading.map(|part| rounded(part * speed_mps));
        let _ = write!(
            parts.tables,
            "[[plane.intruder]]\nstart_m = {start_m:?}\nvelocity_mps = {velocity_mps:?}\nradius_m = {radius_m}\nheard = {}\n",
            draw.chance(0.5)
        );
    }
}

fn scenario(seed: u32, kind: Kind, size: &Size, crowd: &Crowd, parts: &Parts) -> String {
    let slowest_mps = crowd.members.iter().map(|member| member.speed_mps).fold(f64::INFINITY, f64::min);
    // Robots pass a narrow place one after the other.
    let queue_s = crowd.queue as f64 * (12.0 * size.radius_m / slowest_mps + 1.0);
    let lasts_s = 8.0 * crowd.longest_m() / slowest_mps + 30.0 + queue_s + parts.wait_s;
    let Size { radius_m, speed_mps, .. } = size;
    let mut text = format!(
        "name = \"{kind}-{seed}\"\nseed = {seed}\nticks = {}\ntick_s = {TICK_S}\n\n[radio]\n{}\n[plane]\n\
         radius_m = {radius_m}\nmax_speed_mps = {speed_mps}\n{}\n[plane.robots]\nlist = [\n",
        (lasts_s / TICK_S) as u32,
        parts.radio,
        parts.plane
    );
    let is_flat = kind != Kind::Space;
    let place = |place_m: [f64; 3]| {
        let [x, y, z] = place_m.map(rounded);
        if is_flat { format!("[{x}, {y}]") } else { format!("[{x}, {y}, {z}]") }
    };
    for member in &crowd.members {
        let _ = write!(text, "  {{ start_m = {}, goal_m = {}", place(member.start_m), place(member.goal_m));
        if kind == Kind::Mixed {
            let _ = write!(text, ", radius_m = {}, max_speed_mps = {}", member.radius_m, member.speed_mps);
        }
        text.push_str(" },\n");
    }
    text.push_str("]\n\n");
    for wall_m in &crowd.walls_m {
        let _ = writeln!(text, "[[plane.wall]]\npoints_m = {:?}", wall_m.map(|point_m| point_m.map(rounded)));
    }
    for (axis, sign) in crowd.room_m.iter().flat_map(|_| (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)])) {
        // The walls leave two radii to all starts and goals.
        let edge_m = 3.0 * radius_m;
        let (mut point_m, mut normal) = ([0.0; 3], [0.0; 3]);
        point_m[axis] = if sign < 0.0 { crowd.room_m.unwrap_or_default() + edge_m } else { -edge_m };
        normal[axis] = sign;
        let _ = writeln!(text, "[[plane.half_space]]\npoint_m = {:?}\nnormal = {normal:?}", point_m.map(rounded));
    }
    text + &parts.tables
}
