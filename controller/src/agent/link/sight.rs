//! Those who are seen, among those who are heard.

use super::super::io::{Event, Outputs};
use super::super::silence::Company;
use super::{Link, report};
use crate::geom::Position;
use crate::neighbor::{Put, Tracker};
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::Instant;
use crate::wire::{Payload, SequenceWindow, Wire};

impl<S: Scalar, const N: usize, W: Wire, P: Payload> Link<S, N, W, P> {
    /// Puts those who are seen among those who are known, each merged with what was heard of it. Behind the frames of a step. Those who are `needed`
    /// stay in a full table.
    ///
    /// Who has heard others and sees somebody is in company, though the radio be silent; who has never heard anybody goes
    /// on when nobody is to be seen.
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
        let windows = &mut self.windows;
        tracker.forget(&mut self.table, now, |gone| {
            windows.retain(|(id, _)| *id != gone);
            report(out, Event::NeighborLost(gone));
        });
        for &neighbor in &tracker.seen(&self.table, flock, now) {
            let id = neighbor.id;
            if self.company != Company::Unknown {
                self.company = Company::Heard(now);
            }
            let put = self.table.put(neighbor, own, now, |id| needed.contains(&id));
            if let Put::Evicted(evicted) = put {
                self.windows.retain(|(id, _)| *id != evicted);
                report(out, Event::NeighborEvicted(evicted));
            }
            if matches!(put, Put::Inserted | Put::Evicted(_)) {
                // Its frames will be told from repeated ones as those of one that was heard first; as many windows as entries.
                let _ = self.windows.push((id, SequenceWindow::new()));
                report(out, Event::NeighborFound(id));
            }
        }
    }
}
