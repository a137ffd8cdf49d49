//! `[plane.sensing]`: detection of other robots by sensors.

use super::super::Draft;
use super::super::ranges::duration;
use super::super::source::Checked;
use super::PlaneSetup;
use super::table::PlaneTable;
use crate::world::plane::Sensing;
use staya_controller::neighbor::TrackParams;

/// Beacons round to millimetres, and simulated robots know their exact position.
const HEARD_M: f64 = 0.002;
const HEARD_MPS: f64 = 0.01;

pub(super) fn sensing(draft: &Draft<'_>, table: &PlaneTable, setup: &PlaneSetup) -> Checked<Option<Sensing>> {
    let Some(sensing) = table.sensing else { return Ok(None) };
    let (field, what) = ("plane.sensing", "sensors do not see across the edges of a torus");
    draft.require(setup.torus_m.is_none(), field, what, "leave out plane.sensing or plane.torus_m")?;
    if let Some(group) = setup.kinds().find(|group| group.law.is_on_grid()) {
        let name = group.law.name();
        let what = format!("the law \"{name}\" moves between cells, which sensors do not observe");
        return Err(draft.error(field, what, "give a law that goes by velocities, or leave it out"));
    }
    // At least the age at which a beacon is stale, and at least three detections, of which a robot
    // takes one in a step at most.
    let step_ticks = draft.step_ticks();
    let usual_ticks = (3 * sensing.every_ticks.max(step_ticks) + sensing.delay_ticks).max(4 * step_ticks);
    let usual_s = f64::from(usual_ticks) * draft.file.tick_s;
    let forget_s = sensing.forget_s.unwrap_or(usual_s);
    draft.within("plane.sensing.forget_s", forget_s, draft.file.tick_s..=1000.0, "seconds")?;
    let abilities = setup.kinds().map(|group| group.abilities);
    let (speed_mps, most_mps2) = abilities.fold((0.0, 0.0), |(speed, most): (f64, f64), can| {
        (speed.max(can.max_speed_mps), most.max(can.max_acceleration_mps2))
    });
    // Unlimited acceleration: a reversal from full speed within a second, with a factor of two.
    let acceleration_mps2 = sensing.acceleration_mps2.unwrap_or_else(|| most_mps2.min(4.0 * speed_mps));
    Ok(Some(Sensing {
        range_m: sensing.range_m,
        noise_m: sensing.noise_m,
        is_occluded: sensing.occlusion,
        sees_names: sensing.names,
        every_ticks: sensing.every_ticks,
        delay_ticks: sensing.delay_ticks,
        has_beacons: sensing.beacons,
        tracking: TrackParams {
            acceleration_mps2: acceleration_mps2 as f32,
            speed_mps: speed_mps as f32,
            heard_m: HEARD_M as f32,
            heard_mps: HEARD_MPS as f32,
            gate: sensing.gate as f32,
            margin: sensing.margin as f32,
            forget: duration(forget_s),
        },
    }))
}
