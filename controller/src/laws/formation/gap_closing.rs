//! Closing ranks: replacing a robot that has died.

use crate::grid::Cell;
use crate::list;
use crate::robot::RobotId;
use crate::template::{Template, TemplateEntry};
use serde::{Deserialize, Serialize};

/// The place that a robot holds in its formation, if it is not its own.
///
/// When the holder of the place in front (the nearest with a smaller number) is lost, by the
/// slot that it tells in its beacons, the robot steps into it, and the robot
/// behind does the same. If two robots hold one place, the smaller number keeps it and the other
/// returns to its own. So a robot that comes back finds its own place free.
///
/// Applies if robots are numbered consecutively by their places: robot k + i has place i, and each
/// computes k from its own number. A robot that receives a neighbour in a place that it could not
/// have reached this way keeps its own, so several formations need no identifier. The paper (A. V.
/// Kuznetsov 2017) leaves the place of a missing robot empty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GapClosing {
    /// The place held instead of the own one, and its distance, cells.
    taken: Option<(u8, Cell)>,
    /// The place in front, once its holder was received.
    front: Option<u8>,
}

impl GapClosing {
    /// Creates the state of a robot in its own place.
    #[must_use]
    pub const fn new() -> Self {
        Self { taken: None, front: None }
    }

    /// The vector from the own place to the one that is held, cells.
    #[must_use]
    pub fn shift(&self) -> Cell {
        self.taken.map_or(Cell::default(), |(_, shift)| shift)
    }

    /// Number of the place held by the robot with this template.
    #[must_use]
    pub fn slot<const F: usize>(&self, template: &Template<F>) -> u8 {
        self.taken.map_or(template.slot, |(slot, _)| slot)
    }

    /// Steps into the place in front if it is empty, or back if a smaller number holds the same
    /// place. `holders` are the robots received, with the places in their beacons. O(F x robots).
    pub fn close<const F: usize>(
        &mut self,
        own: RobotId,
        template: &Template<F>,
        holders: impl Iterator<Item = (RobotId, u8)> + Clone,
    ) {
        let Some(first) = first_of(own, template, holders.clone()) else {
            *self = Self::new();
            return;
        };
        let place_of = |id: RobotId| place_of(id, first);
        let named = |id: RobotId| template.entries.iter().any(|entry| entry.id == id);
        let held_by = |slot: u8| holders.clone().find(|&(id, holds)| holds == slot && named(id)).map(|(id, _)| id);
        if self.taken.is_some_and(|(slot, _)| held_by(slot).is_some_and(|id| id < own)) {
            *self = Self::new();
        }
        let (held, shift) = (self.slot(template), self.shift());
        let in_front = template.entries.iter().filter_map(|entry| {
            let slot = place_of(entry.id).filter(|&slot| slot < held)?;
            Some((entry.offset.distance_squared(shift), slot, entry.offset))
        });
        let Some((_, slot, offset)) = in_front.min() else {
            self.front = None;
            return;
        };
        if held_by(slot).is_some() {
            self.front = Some(slot);
        } else if self.front == Some(slot) {
            *self = Self { taken: Some((slot, offset)), front: None };
        }
    }

    /// The template from the place that is held, with the current holders of places. O(F * robots).
    #[must_use]
    pub fn view<const F: usize>(
        &self,
        own: RobotId,
        template: &Template<F>,
        holders: impl Iterator<Item = (RobotId, u8)> + Clone,
    ) -> Template<F> {
        let Some(first) = first_of(own, template, holders.clone()) else {
            return template.clone();
        };
        let place_of = |id: RobotId| place_of(id, first);
        let (held, shift) = (self.slot(template), self.shift());
        let named = |id: RobotId| template.entries.iter().any(|entry| entry.id == id);
        let holder = |slot: u8| holders.clone().find(|&(id, holds)| holds == slot && named(id)).map(|(id, _)| id);
        let is_elsewhere = |id: RobotId| holders.clone().any(|(other, _)| other == id);
        let others = template.entries.iter().filter_map(|entry| {
            let offset = entry.offset - shift;
            let id = match place_of(entry.id) {
                Some(slot) if slot == held => return None,
                Some(slot) => holder(slot).or_else(|| (!is_elsewhere(entry.id)).then_some(entry.id))?,
                None => entry.id,
            };
            Some(TemplateEntry { offset, id, ..*entry })
        });
        let behind = self.taken.and_then(|_| holder(template.slot));
        let behind = behind.map(|id| TemplateEntry { offset: Cell::default() - shift, id, hops: 1 });
        Template { slot: held, offset: template.offset + shift, entries: list::collect(others.chain(behind)) }
    }
}

/// The robot that owns the first place, if robots are numbered consecutively and those of the
/// template hold their own or smaller places.
fn first_of<const F: usize>(
    own: RobotId,
    template: &Template<F>,
    mut holders: impl Iterator<Item = (RobotId, u8)>,
) -> Option<u32> {
    let first = own.0.checked_sub(template.slot.into()).filter(|&first| first > 0)?;
    let named = |id: RobotId| template.entries.iter().any(|entry| entry.id == id);
    let is_below = |(id, slot): (RobotId, u8)| named(id) && id.0 < first.saturating_add(slot.into());
    (!holders.any(is_below)).then_some(first)
}

fn place_of(id: RobotId, first: u32) -> Option<u8> {
    u8::try_from(id.0.checked_sub(first)?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// Two columns, three cells apart: 0 1 / 2 3 / 4 5.
    fn template(own: usize) -> Template<8> {
        let places = [0, 1, 2, 3, 4, 5].map(|i: i16| Cell::new(3 * (i % 2), -3 * (i / 2)));
        let edges = [(0, 1), (0, 2), (1, 3), (2, 3), (2, 4), (3, 5), (4, 5)];
        Template::from_graph(&places, &edges, own, 3).unwrap()
    }

    struct File {
        ranks: [GapClosing; 6],
        is_alive: [bool; 6],
        numbers: [u32; 6],
    }

    impl File {
        fn new() -> Self {
            Self::numbered([1, 2, 3, 4, 5, 6])
        }

        fn numbered(numbers: [u32; 6]) -> Self {
            Self { ranks: [GapClosing::new(); 6], is_alive: [true; 6], numbers }
        }

        fn template(&self, own: usize) -> Template<8> {
            let mut template = template(own);
            for entry in &mut template.entries {
                entry.id = RobotId(self.numbers[entry.id.0 as usize - 1]);
            }
            template
        }

        fn slots(&self) -> [Option<u8>; 6] {
            core::array::from_fn(|own| self.is_alive[own].then(|| self.ranks[own].slot(&self.template(own))))
        }

        fn tick(&mut self) {
            let slots = self.slots();
            for own in (0..6).filter(|&own| self.is_alive[own]) {
                let others = (0..6).filter(|&other| other != own);
                let heard = others.filter_map(|other| Some((RobotId(self.numbers[other]), slots[other]?)));
                let template = self.template(own);
                self.ranks[own].close(RobotId(self.numbers[own]), &template, heard);
            }
        }

        fn ticks(&mut self, ticks: u32) -> [Option<u8>; 6] {
            (0..ticks).for_each(|_| self.tick());
            self.slots()
        }
    }

    #[test]
    fn without_a_death_all_robots_keep_their_places() {
        assert_eq!(File::new().ticks(20), [0, 1, 2, 3, 4, 5].map(Some));
    }

    #[test]
    fn robots_behind_a_dead_one_move_up_and_no_two_hold_one_place() {
        for dead in 0..6 {
            for second in 0..6 {
                let mut file = File::new();
                file.ticks(3);
                file.is_alive[dead] = false;
                file.ticks(2);
                file.is_alive[second] = false;
                let mut held: Vec<u8> = file.ticks(30).into_iter().flatten().collect();
                held.sort_unstable();
                let living = if dead == second { 5 } else { 4 };
                let unique = held.windows(2).all(|pair| pair[0] < pair[1]);
                assert!(unique && held.len() == living, "{dead} {second}: {held:?}");
                // At most a corner at the back is empty.
                assert!(held[0] == 0 && held[1] <= 2, "{dead} {second}: {held:?}");
            }
        }
    }

    #[test]
    fn a_second_formation_closes_ranks_by_its_own_numbers() {
        let deaths = |numbers: [u32; 6], dead: usize| {
            let mut file = File::numbered(numbers);
            file.ticks(3);
            file.is_alive[dead] = false;
            file.ticks(30)
        };
        for dead in 0..6 {
            assert_eq!(deaths([7, 8, 9, 10, 11, 12], dead), deaths([1, 2, 3, 4, 5, 6], dead), "{dead}");
        }
    }

    #[test]
    fn with_other_numbering_no_robot_takes_a_held_place() {
        for numbers in [[1, 2, 4, 5, 6, 7], [3, 5, 8, 9, 10, 12], [1, 3, 4, 5, 6, 7], [6, 5, 4, 3, 2, 1]] {
            for dead in 0..6 {
                for second in 0..6 {
                    let mut file = File::numbered(numbers);
                    file.ticks(3);
                    file.is_alive[dead] = false;
                    file.ticks(9);
                    file.is_alive[second] = false;
                    let slots = file.ticks(30);
                    let mut held: Vec<u8> = slots.into_iter().flatten().collect();
                    held.sort_unstable();
                    assert!(held.windows(2).all(|pair| pair[0] < pair[1]), "{numbers:?} {dead} {second}: {slots:?}");
                    for own in (0..6).filter(|&own| file.is_alive[own]) {
                        let others = (0..6).filter(|&other| other != own);
                        let heard = others.filter_map(|other| Some((RobotId(numbers[other]), slots[other]?)));
                        let template = file.template(own);
                        let view = file.ranks[own].view(RobotId(numbers[own]), &template, heard);
                        let mut ids: Vec<_> = view.entries.iter().map(|entry| entry.id).collect();
                        ids.sort_unstable();
                        assert!(ids.windows(2).all(|pair| pair[0] < pair[1]), "{numbers:?} {dead} {second}: {ids:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_returning_robot_finds_its_place() {
        for dead in 0..6 {
            let mut file = File::new();
            file.ticks(3);
            file.is_alive[dead] = false;
            file.ticks(20);
            (file.is_alive[dead], file.ranks[dead]) = (true, GapClosing::new());
            assert_eq!(file.ticks(30), [0, 1, 2, 3, 4, 5].map(Some), "{dead}");
        }
    }

    #[test]
    fn the_view_is_from_the_place_that_is_held() {
        // Robot 2 is dead; robot 4 steps into place 1, robot 6 into place 3.
        let holders = [(1, 0), (3, 2), (4, 1), (5, 4), (6, 3)].map(|(id, slot)| (RobotId(id), slot));
        let ranks = GapClosing { taken: Some((1, Cell::new(0, 3))), front: None };
        let others = holders.into_iter().filter(|(id, _)| *id != RobotId(4));
        let view = ranks.view(RobotId(4), &template(3), others);
        assert_eq!((view.slot, view.offset), (1, Cell::new(3, 0)));
        let mut seen: Vec<_> = view.entries.iter().map(|entry| (entry.id.0, entry.offset.x, entry.offset.y)).collect();
        seen.sort_unstable();
        assert_eq!(seen, [(1, -3, 0), (3, -3, -3), (5, -3, -6), (6, 0, -3)]);
        let view = GapClosing::new().view(RobotId(1), &template(0), holders.into_iter().skip(1));
        let beside = view.entries.iter().find(|entry| entry.id == RobotId(4)).unwrap();
        assert_eq!(beside.offset, Cell::new(3, 0));
    }

    #[test]
    fn robots_that_are_not_numbered_by_their_places_keep_them() {
        let mut ranks = GapClosing::new();
        for holders in [&[(RobotId(1), 0)][..], &[]] {
            ranks.close(RobotId(9), &template(3), holders.iter().copied());
        }
        assert_eq!(ranks, GapClosing::new());
    }
}
