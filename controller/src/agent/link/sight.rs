//! Merges detected robots into the neighbour table.

use super::super::contact_loss::ContactState;
use super::super::io::{Event, Outputs};
use super::dates::Sender;
use super::{Link, Protocol, report};
use crate::geom::Position;
use crate::neighbor::{Put, Tracker};
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::Instant;
use crate::wire::Wire;

impl<S: Scalar, const N: usize, W: Wire, Q: Protocol> Link<S, N, W, Q> {
    /// Runs after the frames of a step. A detection counts as contact only for a robot that was in
    /// contact by radio; one that never was moves freely when no robot is in sight.
    pub(in super::super) fn see(
        &mut self,
        tracker: &mut Tracker<S>,
        own: Position,
        needed: &[RobotId],
        flock: u8,
        now: Instant,
        out: &mut Outputs<S>,
    ) {
        tracker.hear(&self.table, own);
        let senders = &mut self.senders;
        tracker.forget(&mut self.table, now, |gone| {
            senders.retain(|sender| sender.id != gone);
            report(out, Event::NeighborLost(gone));
        });
        for &neighbor in &tracker.seen(&self.table, flock, now) {
            let id = neighbor.id;
            if self.contact != ContactState::Never {
                self.contact = ContactState::InContact(now);
            }
            let put = self.table.put(neighbor, own, now, |id| needed.contains(&id));
            self.note_eviction(put, out);
            if matches!(put, Put::Inserted | Put::Evicted(_)) {
                self.note_sender(Sender::silent(id));
                report(out, Event::NeighborFound(id));
            }
        }
    }
}
