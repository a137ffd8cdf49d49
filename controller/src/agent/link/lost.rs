//! Lost robots, told to robots that never heard them.

use super::{Link, Outputs, Protocol, ReceiveContext};
use crate::neighbor::{Neighbor, Trace};
use crate::robot::{Mode, RobotId};
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use crate::wire::{Beacon, LostRobot, Wire};
use serde::{Deserialize, Serialize};

/// Least time between two lost robots in the frames of one sender.
const TELL_EVERY: Duration = Duration::from_millis(250);
/// Unit of [`LostRobot::age_cs`]. Ages are rounded up, and a state is newer only if it is newer by
/// more than this, so that no state gets younger on its way.
const UNIT: Duration = Duration::from_millis(10);

/// The next announcement.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct LostNews {
    /// The lost robot announced last.
    told: RobotId,
    /// A robot in contact that another robot takes for lost.
    refuted: RobotId,
    /// When to tell the next one; kept within [`TELL_EVERY`] from now.
    due: Instant,
}

impl LostNews {
    pub(super) const NEW: Self = Self { told: RobotId::NONE, refuted: RobotId::NONE, due: Instant::from_micros(0) };
}

impl<S: Scalar, const N: usize, W: Wire, Q: Protocol> Link<S, N, W, Q> {
    /// The newest state counts: adds, moves or clears a lost robot. Another robot's error about a
    /// robot in contact is corrected with the next beacon. O(N).
    pub(super) fn hear_lost(
        &mut self,
        told: &LostRobot,
        now: Instant,
        listener: &ReceiveContext<'_, S>,
        out: &mut Outputs<S>,
    ) {
        let id = told.id;
        if !told.is_lost && self.lost.refuted == id {
            self.lost.refuted = RobotId::NONE;
        }
        let heard = listener.heard_at - UNIT.saturating_mul(told.age_cs.into());
        let is_fresh = self.table.get(id, now).fresh().is_some();
        if told.is_lost && (is_fresh || id == self.header.sender) {
            self.lost.refuted = id;
        }
        let is_known = self.table.get(id, now).known().is_some();
        if is_known || id == self.header.sender || id > listener.plausibility.last || !id.is_some() {
            return;
        }
        let known = self.table.lost().iter().find(|lost| lost.id == id);
        let is_old = |known: &Neighbor<S, Q::Payload>| heard.since(known.heard) <= UNIT;
        if now.since(heard) < Duration::ZERO || known.is_some_and(is_old) {
            return;
        }
        self.table.clear_lost(id);
        if told.is_lost {
            let LostRobot { position_mm, radius_mm, .. } = *told;
            let beacon = Beacon { position_mm, radius_mm, mode: Mode::Fault, ..Beacon::default() };
            let mut lost = Neighbor { trace: Trace::Lost, ..Neighbor::from_beacon(id, &beacon, Q::ID, heard) };
            lost.position = self.image(lost.position, listener.position);
            let _ = listener.plausibility.cut(&mut lost);
            let put = self.table.put(lost, listener.position, now, listener.needs);
            self.note_eviction(put, out);
        }
    }

    /// The next lost robot to tell, if one is due; a correction comes first. O(N).
    pub(super) fn lost_to_tell(&mut self, now: Instant) -> Option<LostRobot> {
        let refuted = core::mem::replace(&mut self.lost.refuted, RobotId::NONE);
        if refuted == self.header.sender && refuted.is_some() {
            return Some(LostRobot { id: refuted, is_lost: false, age_cs: 0, position_mm: [0; 3], radius_mm: 0 });
        }
        if let Some(known) = self.table.get(refuted, now).fresh() {
            return Some(tell(known, now));
        }
        if !now.has_reached(self.lost.due, TELL_EVERY) {
            return None;
        }
        let lost = self.table.lost();
        let after = lost.iter().find(|lost| lost.id > self.lost.told && lost.id.duplicate_of().is_none());
        let next = after.or_else(|| lost.iter().find(|lost| lost.id.duplicate_of().is_none()))?;
        (self.lost.told, self.lost.due) = (next.id, now + TELL_EVERY);
        Some(tell(next, now))
    }
}

fn tell<S: Scalar, P>(known: &Neighbor<S, P>, now: Instant) -> LostRobot {
    let micros = known.age(now).unwrap_or(Duration::MAX).as_micros();
    let units = micros.checked_div(UNIT.as_micros()).unwrap_or(0).saturating_add(1);
    LostRobot {
        id: known.id,
        is_lost: known.is_lost(),
        age_cs: u16::try_from(units).unwrap_or(u16::MAX),
        position_mm: known.position.mm,
        radius_mm: u16::try_from(known.radius_m.to_milli().unwrap_or(0).max(0)).unwrap_or(u16::MAX),
    }
}
