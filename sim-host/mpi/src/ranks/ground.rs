//! Operations of a world of which each rank has a part.

use super::exchange::{RankError, decode, encode};
use super::region::Region;
use staya_controller::agent::Command;
use staya_controller::grid::Cell;
use staya_controller::robot::RobotId;
use staya_sim::engine::{AnyGround, Grid, Ground as _, PlaneGround};
use staya_sim::world::border::{Beside, DEPTH, Settled};
use staya_sim::world::plane::{self, Clearance, CommandAge};
use staya_sim::world::scouts::Scouts;

pub trait Talk {
    fn sum(&mut self, own: u64) -> Result<u64, RankError>;

    fn swap(&mut self, message: &dyn Fn(&Region) -> Vec<u8>) -> Result<Vec<(usize, Vec<u8>)>, RankError>;
}

/// A world of which this rank has some bodies. Everything except bodies is identical on all ranks.
pub trait Part {
    fn keep(&mut self, here: &[u32]);

    /// Appends a body of another rank; restoring the world's state moves it to its position.
    fn admit(&mut self, number: u32, id: RobotId);

    fn dismiss(&mut self, index: usize);

    fn hinders(&self, one: &Region, other: &Region) -> bool;

    /// Data that a neighbour needs about bodies near `region` before they move.
    fn wishes(&self, tick: u32, region: &Region, commands: &[Command<f32>]) -> Vec<u8>;

    /// Moves the bodies by commands with their ages. Returns the number of collisions of bodies of
    /// this rank with each other.
    fn advance_beside(
        &mut self,
        tick: u32,
        commands: (&[Command<f32>], &[CommandAge]),
        own: &Region,
        wishes: &[(usize, Vec<u8>)],
        talk: &mut dyn Talk,
    ) -> Result<u64, RankError>;

    fn touches(&self, one: &Region, other: &Region) -> bool;

    fn bodies(&self, tick: u32, region: &Region) -> Vec<u8>;

    fn count_collisions_beside(&mut self, tick: u32, bodies: &[(usize, Vec<u8>)]) -> Result<u64, RankError>;

    fn replace_clearance(&mut self, clearance: Clearance) -> Clearance;

    fn is_taken(&self, cell: Cell) -> bool;
}

/// The rank's part of the world.
pub fn part(ground: &AnyGround) -> &dyn Part {
    match ground {
        AnyGround::Cells(grid) => &**grid,
        AnyGround::Plane(plane) => &**plane,
    }
}

pub fn part_mut(ground: &mut AnyGround) -> &mut dyn Part {
    match ground {
        AnyGround::Cells(grid) => &mut **grid,
        AnyGround::Plane(plane) => &mut **plane,
    }
}

impl Part for Grid {
    fn keep(&mut self, here: &[u32]) {
        self.world.keep(here);
        self.scouts.iter_mut().for_each(|scouts| scouts.keep(here.len()));
        self.numbers = here.to_vec();
    }

    fn admit(&mut self, number: u32, id: RobotId) {
        self.world.admit(id);
        self.scouts.iter_mut().for_each(Scouts::admit);
        self.numbers.push(number);
    }

    fn dismiss(&mut self, index: usize) {
        self.world.dismiss(index);
        self.scouts.iter_mut().for_each(|scouts| scouts.dismiss(index));
        self.numbers.swap_remove(index);
    }

    fn hinders(&self, one: &Region, other: &Region) -> bool {
        one.is_beside_in_cells(other, DEPTH)
    }

    fn wishes(&self, tick: u32, region: &Region, commands: &[Command<f32>]) -> Vec<u8> {
        let near = region.cells.map(|cells| self.world.near(tick, &cells, DEPTH, Some(commands)));
        encode(&near.unwrap_or_default())
    }

    fn advance_beside(
        &mut self,
        tick: u32,
        (commands, _): (&[Command<f32>], &[CommandAge]),
        own: &Region,
        wishes: &[(usize, Vec<u8>)],
        talk: &mut dyn Talk,
    ) -> Result<u64, RankError> {
        self.look();
        let mut beside = Vec::<Beside>::new();
        for (rank, bytes) in wishes {
            beside.extend(decode::<Vec<Beside>>(*rank, "bodies", bytes)?);
        }
        let mut contest = self.world.contest(tick, commands, own.cells.as_ref(), beside);
        loop {
            let open = contest.round(&mut self.world);
            let is_decided = talk.sum(open)? == 0;
            if is_decided {
                let [moved, refused] = contest.result();
                // Two counts of ranks.
                let ranks = talk.sum(u64::from(moved) | u64::from(refused) << 32)?;
                if ranks as u32 == 0 || ranks >> 32 == 0 {
                    contest.finish(&mut self.world);
                    return Ok(self.world.count_collisions(tick));
                }
            }
            let settled =
                |region: &Region| encode(&region.cells.map(|cells| contest.settled(&cells)).unwrap_or_default());
            let heard = talk.swap(&settled)?;
            contest.tell();
            for (rank, bytes) in heard {
                contest.hear(&decode::<Vec<Settled>>(rank, "moves", &bytes)?);
            }
            if is_decided {
                contest.retry();
            }
        }
    }

    fn touches(&self, one: &Region, other: &Region) -> bool {
        one.is_beside_in_cells(other, 1)
    }

    fn bodies(&self, tick: u32, region: &Region) -> Vec<u8> {
        encode(&region.cells.map(|cells| self.world.near(tick, &cells, 1, None)).unwrap_or_default())
    }

    fn count_collisions_beside(&mut self, tick: u32, bodies: &[(usize, Vec<u8>)]) -> Result<u64, RankError> {
        let mut beside = Vec::<Beside>::new();
        for (rank, bytes) in bodies {
            beside.extend(decode::<Vec<Beside>>(*rank, "bodies", bytes)?);
        }
        Ok(self.world.count_collisions_beside(tick, &beside))
    }

    fn replace_clearance(&mut self, clearance: Clearance) -> Clearance {
        clearance
    }

    fn is_taken(&self, cell: Cell) -> bool {
        self.world.body_at(cell).is_some()
    }
}

impl Part for PlaneGround {
    fn keep(&mut self, here: &[u32]) {
        self.plane.keep(here);
        self.scouts.iter_mut().for_each(|scouts| scouts.keep(here.len()));
        self.numbers = here.to_vec();
    }

    fn admit(&mut self, number: u32, id: RobotId) {
        self.plane.admit(self.disc_of(number as usize, id));
        self.scouts.iter_mut().for_each(Scouts::admit);
        self.numbers.push(number);
    }

    fn dismiss(&mut self, index: usize) {
        self.plane.dismiss(index);
        self.scouts.iter_mut().for_each(|scouts| scouts.dismiss(index));
        self.numbers.swap_remove(index);
    }

    fn hinders(&self, _: &Region, _: &Region) -> bool {
        false // bodies do not obstruct moves
    }

    fn wishes(&self, _: u32, _: &Region, _: &[Command<f32>]) -> Vec<u8> {
        Vec::new()
    }

    fn advance_beside(
        &mut self,
        tick: u32,
        (commands, ages): (&[Command<f32>], &[CommandAge]),
        _: &Region,
        _: &[(usize, Vec<u8>)],
        _: &mut dyn Talk,
    ) -> Result<u64, RankError> {
        Ok(self.advance(tick, commands, ages))
    }

    fn touches(&self, one: &Region, other: &Region) -> bool {
        one.is_beside(other, self.plane.reach_m())
    }

    fn bodies(&self, _: u32, region: &Region) -> Vec<u8> {
        let near = |at_m: [f64; 3]| region.is_near([at_m[0], at_m[1]], self.plane.reach_m());
        let discs = self.plane.discs().iter().filter(|disc| near(disc.position_m));
        let bodies = discs.map(|disc| plane::Beside {
            id: disc.id,
            position_m: disc.position_m,
            radius_m: disc.radius_m,
            downwash: disc.downwash,
        });
        encode(&bodies.collect::<Vec<_>>())
    }

    fn count_collisions_beside(&mut self, _: u32, bodies: &[(usize, Vec<u8>)]) -> Result<u64, RankError> {
        let mut beside = Vec::<plane::Beside>::new();
        for (rank, bytes) in bodies {
            beside.extend(decode::<Vec<plane::Beside>>(*rank, "bodies", bytes)?);
        }
        let now = self.plane.clearance_beside(&beside);
        self.clearance.add(&now);
        let gap_m = self.gap_m.map_or(now.bodies_m, |gap_m| gap_m.min(now.bodies_m));
        self.gap_m = Some(gap_m).filter(|gap_m| gap_m.is_finite());
        Ok(now.overlaps)
    }

    fn replace_clearance(&mut self, clearance: Clearance) -> Clearance {
        std::mem::replace(&mut self.clearance, clearance)
    }

    fn is_taken(&self, cell: Cell) -> bool {
        self.plane.discs().iter().any(|disc| self.plane.cell(disc.position_m) == Some(cell))
    }
}
