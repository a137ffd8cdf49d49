//! Assignment of robots to ranks: robots follow their position, and blocks follow the load.

use super::cut::{Cut, Sample};
use super::exchange::{RankError, decode, encode};
use super::ground::part_mut;
use super::run::Rank;
use staya_controller::agent::Command;
use staya_sim::engine::hash::StateHash;
use staya_sim::engine::{StateError, Status};
use staya_sim::world::plane::CommandAge;
use std::collections::{BTreeMap, HashMap};

/// Positions per rank for a new division of the world.
const SAMPLES_A_RANK: usize = 512;
/// Least interval of divisions, unit [`Sharing::every_ticks`](super::Sharing::every_ticks).
const REST: u32 = 8;

impl Rank<'_> {
    pub(super) fn share(&mut self) -> Result<(), RankError> {
        self.age += 1;
        if self.wire.exchange.ranks() == 1 || !self.engine.tick.is_multiple_of(self.sharing.every_ticks.max(1)) {
            return Ok(());
        }
        let (most, sum) = self.loads.iter().fold((0.0_f64, 0.0), |(most, sum), &load| (most.max(load), sum + load));
        let is_uneven = most * self.loads.len() as f64 > sum * self.sharing.above;
        if is_uneven && self.age >= self.sharing.every_ticks.saturating_mul(REST) {
            self.recut()?;
        }
        self.send_robots()?;
        self.tell_region()
    }

    fn recut(&mut self) -> Result<(), RankError> {
        let robots = self.engine.here.len();
        let stride = robots.div_ceil(SAMPLES_A_RANK).max(1);
        let load = self.loads[self.wire.rank()] / robots.div_ceil(stride).max(1) as f64;
        let places = self.places().step_by(stride).map(|(place_m, _)| Sample { place_m, load });
        let own: Vec<_> = places.collect();
        let mut samples = Vec::new();
        for (rank, bytes) in self.wire.gather(encode(&own))?.iter().enumerate() {
            samples.extend(decode::<Vec<Sample>>(rank, "places", bytes)?);
        }
        self.cut = Cut::new(&mut samples, self.wire.exchange.ranks());
        self.age = 0;
        self.wire.traffic.cuts += 1;
        Ok(())
    }

    fn send_robots(&mut self) -> Result<(), RankError> {
        let own = self.wire.rank();
        let mut leaving = BTreeMap::<usize, Vec<u32>>::new();
        for ((place_m, _), &number) in self.places().zip(&self.engine.here) {
            let rank = self.cut.rank(place_m);
            if rank != own {
                leaving.entry(rank).or_default().push(number);
            }
        }
        let to: Vec<usize> = leaving.keys().copied().collect();
        let all = self.wire.gather(encode(&to))?;
        let mut from = Vec::new();
        for (rank, bytes) in all.iter().enumerate() {
            if decode::<Vec<usize>>(rank, "its list of receivers", bytes)?.contains(&own) {
                from.push(rank);
            }
        }
        let mut places: HashMap<u32, usize> = HashMap::new();
        if !leaving.is_empty() {
            places = (0..).zip(&self.engine.here).map(|(index, &number)| (number, index)).collect();
        }
        let mut out = Vec::new();
        for (rank, numbers) in leaving {
            let mut robots = Vec::with_capacity(numbers.len());
            for number in numbers {
                let Some(index) = places.remove(&number) else { continue };
                let mut bytes = Vec::new();
                self.engine.pack(index, &mut bytes);
                self.dismiss(index);
                // The last robot has taken its index.
                if let Some(moved) = self.engine.here.get(index) {
                    places.insert(*moved, index);
                }
                robots.push((number, bytes));
            }
            self.wire.traffic.moved_robots += robots.len() as u64;
            out.push((rank, encode(&robots)));
        }
        self.wire.traffic.moved += out.iter().map(|(_, bytes)| bytes.len() as u64).sum::<u64>();
        let heard = self.wire.exchange.swap(out, &from)?;
        for (rank, bytes) in from.into_iter().zip(heard) {
            for (number, bytes) in decode::<Vec<(u32, Vec<u8>)>>(rank, "robots", &bytes)? {
                let index = self.admit(number);
                let unfit = |error: StateError| RankError::State { robot: number, rank, error: error.to_string() };
                self.engine.unpack(index, &bytes).map_err(unfit)?;
            }
        }
        Ok(())
    }

    fn admit(&mut self, number: u32) -> usize {
        let engine = &mut self.engine;
        let (index, robot) = (engine.here.len(), engine.robots[number as usize]);
        engine.here.push(number);
        part_mut(&mut engine.ground).admit(number, robot.id);
        engine.commands.push(Command::Hold);
        engine.ages.push(CommandAge::default());
        engine.statuses.push(Status::before(&robot));
        engine.chains.push(StateHash::new(robot.id));
        engine.positions_m.insert(index, [0.0; 3]);
        engine.arrivals.admit();
        engine.waits.admit();
        engine.radio.admit(index, robot.id);
        let computer = engine.computer(None, 0);
        engine.computers.push(computer);
        index
    }

    fn dismiss(&mut self, index: usize) {
        let engine = &mut self.engine;
        let robots = engine.here.len();
        engine.here.swap_remove(index);
        part_mut(&mut engine.ground).dismiss(index);
        engine.commands.swap_remove(index);
        engine.ages.swap_remove(index);
        engine.statuses.swap_remove(index);
        engine.chains.swap_remove(index);
        engine.positions_m.swap(index, robots - 1);
        engine.positions_m.remove(robots - 1);
        engine.arrivals.dismiss(index);
        engine.waits.dismiss(index);
        engine.radio.dismiss(index, robots);
        engine.computers.swap_remove(index);
    }
}
