//! The branches of a run: courses with different actions of pages.

use super::Session;
use super::memory::{self, Memory};
use crate::series::Series;
use crate::server::Server;
use staya_sim::scenario::Intervention;

/// Limit of branches that are not shown.
const MOST: usize = 8;

/// One course of the run.
#[derive(Clone, Debug)]
pub(super) struct Branch {
    /// From 1, in the order of creation.
    pub number: u32,
    /// The tick at which it left another branch; 0 for the first one.
    pub from: u32,
    /// The actions with their ticks, in order.
    pub done: Vec<(u32, Intervention)>,
    /// Its frames.
    pub memory: Memory,
    /// Its figures.
    pub series: Series,
}

impl Default for Branch {
    fn default() -> Self {
        Self { number: 1, from: 0, done: Vec::new(), memory: Memory::default(), series: Series::default() }
    }
}

/// The branches that are not shown. Above the limit of number or memory, the oldest are dropped.
#[derive(Debug, Default)]
pub(super) struct Branches {
    others: Vec<Branch>,
    /// Branches made after the first one.
    made: u32,
}

impl Branches {
    pub fn iter(&self) -> impl Iterator<Item = &Branch> {
        self.others.iter()
    }

    pub fn put(&mut self, branch: Branch) {
        self.others.push(branch);
        let size = |others: &[Branch]| others.iter().map(|branch| branch.memory.bytes()).sum::<usize>();
        while self.others.len() > MOST || (self.others.len() > 1 && size(&self.others) > memory::MOST) {
            self.others.remove(0);
        }
    }

    pub fn take(&mut self, number: u32) -> Option<Branch> {
        let at = self.others.iter().position(|branch| branch.number == number)?;
        Some(self.others.remove(at))
    }

    /// Stores the branch and continues with a new one, which has the same past up to `tick`.
    pub fn fork(&mut self, branch: &mut Branch, tick: u32) {
        let old = branch.clone();
        self.made += 1;
        branch.number = self.made + 1;
        branch.from = tick;
        branch.done.retain(|(at, _)| *at <= tick);
        branch.memory.forget_from(tick + 1);
        branch.series.forget_from(tick + 1);
        self.put(old);
    }

    /// Takes back the last action, or the last stroke of painted cells. Returns its tick, or `None`
    /// without an action. The branch from before the action is shown again if it is stored. The
    /// branch with the action is stored if it went on after the action.
    pub fn undo(&mut self, branch: &mut Branch) -> Option<u32> {
        let (tick, what) = branch.done.last()?.clone();
        let is_part = |(at, other): &(u32, Intervention)| {
            matches!((&what, other), (Intervention::Cell { .. }, Intervention::Cell { .. })) && *at == tick
        };
        let mut left = branch.done.len() - 1;
        while left > 0 && is_part(&branch.done[left - 1]) {
            left -= 1;
        }
        let before = self.others.iter().position(|other| other.done == branch.done[..left]);
        let goes_on = branch.memory.last() > Some(tick);
        if let Some(before) = before {
            let before = self.others.remove(before);
            let old = std::mem::replace(branch, before);
            if goes_on {
                self.put(old);
            }
            return Some(tick);
        }
        if goes_on {
            self.fork(branch, tick);
        }
        branch.done.truncate(left);
        // The frame of this tick shows the action.
        branch.memory.forget_from(tick);
        branch.series.forget_from(tick);
        Some(tick)
    }
}

impl Session {
    pub(super) fn note(&mut self, what: Intervention, server: &Server) {
        let is_past = self.tick < self.last_tick();
        if is_past {
            self.branches.fork(&mut self.branch, self.tick);
        }
        let changes_scene = changes_scene(&what);
        self.branch.done.push((self.tick, what));
        self.is_over = false;
        self.take_frame();
        if is_past {
            self.tell(server);
            server.say(None, self.branch.series.all());
        }
        server.say(None, self.orders());
        if changes_scene {
            self.send_scene(None, server);
        }
    }

    /// Shows another branch at `tick`.
    pub(super) fn show_branch(&mut self, tick: u32, server: &Server) {
        self.pace.pause();
        self.show_past(tick);
        self.start_again(tick);
        server.say(None, self.orders());
        self.tell(server);
        server.say(None, self.branch.series.all());
    }

    /// Shows a stored frame until the engine has repeated the run up to it.
    pub(super) fn show_past(&mut self, tick: u32) {
        if let Some(frame) = self.branch.memory.at(tick) {
            self.bytes = frame.to_vec();
            self.is_new = true;
        }
    }
}

/// Whether pages need the scene again after an action.
pub(super) const fn changes_scene(what: &Intervention) -> bool {
    !matches!(
        what,
        Intervention::Goal { .. }
            | Intervention::Waypoint { .. }
            | Intervention::Down { .. }
            | Intervention::Radio { .. }
    )
}
