//! Identifies the sender of a frame and checks the plausibility of its beacon.

use super::super::duplicate_id::{is_ahead, is_within, place};
use super::super::io::{Event, Outputs};
use super::{Link, Protocol, ReceiveContext, report};
use crate::geom::Position;
use crate::neighbor::{Claim, Neighbor, PlausibilityLimits, Verdict};
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::Duration;
use crate::wire::{Frame, Header, Wire};

impl<S: Scalar, const N: usize, W: Wire, Q: Protocol> Link<S, N, W, Q> {
    /// Returns the sender's id, or [`RobotId::duplicate`] for a second robot. `None` for an own
    /// echo and for a beacon with an implausible id or position.
    pub(super) fn known_as(
        &mut self,
        frame: &Frame,
        listener: &ReceiveContext<'_, S>,
        out: &mut Outputs<S>,
    ) -> Option<RobotId> {
        let (header, own, place) = (frame.header, self.header, place(&frame.message));
        if header.sender == own.sender {
            let is_other = self.said.is_other(own, header, &frame.message);
            if is_other && is_ahead(own, header) {
                (self.header.boot, self.header.sequence) = (header.boot, header.sequence.wrapping_add(1));
                self.outgoing.set_boot(header.boot);
            }
            return is_other.then_some(own.sender.duplicate());
        }
        let Some(place) = place else {
            return Some(header.sender);
        };
        if header.sender > listener.plausibility.last {
            if out.implausible.numbers == 0 {
                report(out, Event::Implausible { id: header.sender, claim: Claim::Number });
            }
            out.implausible.count(Claim::Number);
            return None;
        }
        let is_double = listener.fastest_mps.is_some_and(|fastest| self.is_double(header, place, listener, fastest));
        let id = if is_double { header.sender.duplicate() } else { header.sender };
        self.is_believed(id, header, place, listener, out).then_some(id)
    }

    pub(super) fn known(&self, id: RobotId) -> Option<&Neighbor<S, Q::Payload>> {
        let all = self.table.as_slice();
        all.binary_search_by_key(&id, |known| known.id).ok().and_then(|at| all.get(at))
    }

    /// By the clock, or by its sequence numbers if its packets were delayed.
    fn time_since(
        &self,
        known: &Neighbor<S, Q::Payload>,
        header: Header,
        listener: &ReceiveContext<'_, S>,
    ) -> Duration {
        let sender = self.senders.iter().find(|sender| sender.id == known.id);
        let frames = sender.map_or(0, |sender| sender.window.distance(header));
        let periods = if self.wire.is_authenticated() { frames >> 1 } else { frames };
        let counted = listener.period.saturating_mul(periods.into());
        counted.max(known.age(listener.heard_at).unwrap_or(Duration::ZERO))
    }

    fn is_double(&self, header: Header, place: Position, listener: &ReceiveContext<'_, S>, fastest_mps: S) -> bool {
        let at = listener.heard_at;
        // Duplicate ids are the largest.
        let has_doubles = self.table.as_slice().last().is_some_and(|last| last.id.duplicate_of().is_some());
        let double = if has_doubles { self.known(header.sender.duplicate()) } else { None };
        match (self.known(header.sender), double) {
            (None, _) => false,
            (Some(known), None) => {
                let place = self.image(place, known.position);
                let is_within = |time| is_within(place, known, time, fastest_mps);
                // Numbers only add to the time, and take a search.
                !is_within(known.age(at).unwrap_or(Duration::ZERO))
                    && !is_within(self.time_since(known, header, listener))
            }
            (Some(known), Some(double)) => {
                let longest = self.table.ages().stale_after;
                let distance = |known: &Neighbor<S, Q::Payload>| {
                    let place = self.image(place, known.position);
                    known.offset_at(place, at, longest).length_key()
                };
                distance(double) < distance(known)
            }
        }
    }

    /// Whether `id` can be at `place`, or has reported consistent places for long enough.
    fn is_believed(
        &mut self,
        id: RobotId,
        header: Header,
        place: Position,
        listener: &ReceiveContext<'_, S>,
        out: &mut Outputs<S>,
    ) -> bool {
        let plausibility = listener.plausibility;
        if plausibility.believes_all_places() {
            return true;
        }
        // A second robot's first position is accepted, since both are avoided.
        let Some(known) = self.known(id) else {
            return true;
        };
        let place = self.image(place, known.position);
        if plausibility.can_go(known.position, place, self.time_since(known, header, listener)) {
            self.suspects.clear(id);
            return true;
        }
        out.implausible.count(Claim::Jump);
        let longest = self.table.ages().stale_after.max(plausibility.settle);
        let doubt = self.suspects.judge(id, place, listener.heard_at, plausibility, longest);
        if doubt == Verdict::Begins {
            report(out, Event::Implausible { id: header.sender, claim: Claim::Jump });
        }
        doubt == Verdict::Settled
    }

    /// Reduces radius and speed to the limits. Reports the first of consecutive violations.
    pub(super) fn cut(
        &self,
        said: &mut Neighbor<S, Q::Payload>,
        plausibility: &PlausibilityLimits<S>,
        out: &mut Outputs<S>,
    ) {
        let (is_large, is_fast) = plausibility.cut(said);
        if !is_large && !is_fast {
            return;
        }
        let known = self.known(said.id);
        let was_large = known.is_some_and(|known| known.radius_m >= plausibility.max_radius_m);
        let was_fast = known.is_some_and(|known| known.velocity_mps.norm() >= plausibility.max_speed_mps * S::HALF);
        for (is, was, claim) in [(is_large, was_large, Claim::Radius), (is_fast, was_fast, Claim::Speed)] {
            if is {
                out.implausible.count(claim);
            }
            if is && !was {
                report(out, Event::Implausible { id: said.id.duplicate_of().unwrap_or(said.id), claim });
            }
        }
    }
}
