//! Finds the neighbours of the template (KUZ algorithm 5) and the one to follow (algorithm 6).

use crate::grid::{Cell, Dir};
use crate::robot::{Mode, RobotId};
use crate::template::Template;
use heapless::Vec;

/// Another robot as the formation sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Seen {
    /// Its number.
    pub id: RobotId,
    /// Its last known cell.
    pub cell: Cell,
    /// Its predicted cell at the end of the own next move.
    pub predicted: Cell,
    /// The move that it wants to make next.
    pub heading: Dir,
    /// Its leader.
    pub leader: RobotId,
    /// Its current activity.
    pub mode: Mode,
}

/// A neighbour of the template that was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Member {
    /// The robot.
    pub seen: Seen,
    /// Its place relative to this robot.
    pub offset: Cell,
    /// Geodesic distance in the formation's graph.
    pub hops: u8,
}

/// The result of looking for a template's entries.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Found<const F: usize> {
    /// The robots found, in the order of the template.
    pub members: Vec<Member, F>,
    /// Entries for which no robot was found: m0 of the graph distance.
    pub less: u8,
    /// Robots that stand in the place of another: m1 of the graph distance.
    pub more: u8,
    /// The first robot that `more` counts; [`RobotId::NONE`] if `more` is 0.
    pub surplus: RobotId,
}

/// Looks for each neighbour of the template within `eps` cells (Chebyshev) of its place, seen from
/// a robot in `cell` (KUZ algorithm 5).
///
/// An entry with a number takes that robot; one without takes the nearest robot (then the smallest
/// number) that the template does not name. A place whose robot is missing and on which a robot of
/// no entry stands counts in `more`. `robots` is called several times and must return the same
/// robots in the order of their numbers. O(F * robots).
#[must_use]
#[inline(never)]
pub fn find_neighbors<const F: usize>(
    template: &Template<F>,
    cell: Cell,
    eps: u8,
    robots: impl Iterator<Item = Seen> + Clone,
) -> Found<F> {
    let mut found = Found::default();
    let is_named = |id: RobotId| template.entries.iter().any(|entry| entry.id == id);
    for entry in &template.entries {
        let place = cell + entry.offset;
        let near = |seen: &Seen| seen.cell.chebyshev(place) <= u32::from(eps);
        let seen = if entry.id.is_some() {
            robots.clone().find(|seen| seen.id == entry.id).filter(near)
        } else {
            let is_taken = |id| found.members.iter().any(|m: &Member| m.seen.id == id);
            robots
                .clone()
                .filter(|seen| near(seen) && !is_named(seen.id) && !is_taken(seen.id))
                .min_by_key(|seen| (seen.cell.distance_squared(place), seen.id))
        };
        match seen {
            Some(seen) => {
                let _ = found.members.push(Member { seen, offset: entry.offset, hops: entry.hops });
            }
            None => {
                found.less = found.less.saturating_add(1);
                let is_foreign = |seen: &Seen| seen.cell == place && !is_named(seen.id);
                if let Some(stranger) = robots.clone().find(is_foreign) {
                    if found.more == 0 {
                        found.surplus = stranger.id;
                    }
                    found.more = found.more.saturating_add(1);
                }
            }
        }
    }
    found
}

/// The neighbour to follow (KUZ algorithm 6): the smallest number below the own one among the
/// direct neighbours, or without any, among all found. [`RobotId::NONE`]: the robot leads.
///
/// The paper considers direct neighbours only; robots behind a dead one would become leaders.
#[must_use]
pub fn find_leader(own: RobotId, members: &[Member]) -> RobotId {
    let smaller = members.iter().filter(|member| member.seen.id < own);
    smaller.min_by_key(|member| (member.hops != 1, member.seen.id)).map_or(RobotId::NONE, |member| member.seen.id)
}
