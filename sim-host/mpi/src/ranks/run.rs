//! The run of one rank: its ticks and communication.

use super::cut::{Cut, Sample};
use super::exchange::{Exchange, RankError, Traffic, decode, encode};
use super::ground::{part, part_mut};
use super::outcome::{Part, Row, Sums, nothing};
use super::region::Region;
use super::wire::Wire;
use staya_controller::grid::Cell;
use staya_controller::robot::RobotId;
use staya_controller::scalar::NumberFormat;
use staya_controller::wire::Ring;
use staya_sim::engine::CheckpointInterval;
use staya_sim::engine::hash;
use staya_sim::engine::{Agents, AnyGround, End, Engine, Moment, Outcome, Saves, Watch};
use staya_sim::metrics::{FormationQuality, Member};
use staya_sim::radio::Sent;
use staya_sim::record::{PacketCounts, RobotRow, TickRow};
use staya_sim::scenario::{AttackKind, Intervention, Movement, Scenario};
use staya_sim::world::Misplaced;
use std::time::Instant;

/// A robot at the end: its number, arrival time and state.
type Arrival = (u32, Option<u64>, End);

/// How ranks share their work. No setting changes a result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sharing {
    /// Ticks between moves of robots to the rank of their block. A longer interval saves bytes for
    /// these robots but costs bytes for packets around them.
    pub every_ticks: u32,
    /// The world is divided again when a rank's load exceeds this multiple of the mean.
    pub above: f64,
    /// Whether rank 0 receives each robot in each tick, for its records.
    pub records: bool,
    /// Interval at which `watch` gets the whole run to save it ([`Moment::run`]), also when it is
    /// stopped; costs as much as sending all robots to rank 0.
    pub checkpoints: Option<CheckpointInterval>,
}

impl Default for Sharing {
    fn default() -> Self {
        Self { every_ticks: 8, above: 1.15, records: true, checkpoints: None }
    }
}

/// Result of a run on ranks.
#[derive(Clone, Debug)]
pub struct Ended {
    /// Outcome of the whole run; ranks other than 0 lack arrival times and formation statistics.
    pub outcome: Outcome,
    /// Traffic of each rank.
    pub traffic: Vec<Traffic>,
}

const SAMPLES: usize = 1 << 16;
/// Cost of a reception, as a fraction of a step.
const RECEPTION: f64 = 0.1;

/// Whether `ranks` ranks can share a scenario.
///
/// # Errors
/// [`RankError`] for more ranks than robots, or a feature that ranks do not support.
pub fn check(scenario: &Scenario, ranks: usize) -> Result<(), RankError> {
    let robots = scenario.robots.len();
    if ranks > 1 && scenario.torus_m().is_some() {
        return Err(RankError::Torus { ranks });
    }
    if ranks > 1 && scenario.sensing().is_some() {
        return Err(RankError::Sensing { ranks });
    }
    if matches!(&scenario.movement, Movement::Cells(rules) if rules.simultaneous) {
        return Err(RankError::Simultaneous);
    }
    if scenario.laws.numbers != NumberFormat::F32 {
        return Err(Misplaced::Numbers(scenario.laws.numbers).into());
    }
    if ranks > robots { Err(RankError::TooMany { ranks, robots }) } else { Ok(()) }
}

/// Why more ranks speed up a scenario little, if so. The results are correct in any case.
#[must_use]
pub fn remark(scenario: &Scenario) -> Option<String> {
    let around = |axis: usize| {
        let places = starts(scenario).map(|place_m| place_m[axis]);
        let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        high - low
    };
    let (range_m, extent_m) = (scenario.radio.range_m, around(0).max(around(1)));
    (range_m >= extent_m).then(|| {
        format!(
            "the radio reaches {range_m} m and the robots start within {extent_m:.0} m, so every rank receives every packet and only the \
            robots' own work is shared; reduce radio.range_m for more speed"
        )
    })
}

/// As [`simulate`](staya_sim::engine::simulate), on all ranks together, with the laws of `agents`;
/// from the state of a checkpoint of any number of ranks, if there is one. Rank 0 calls `watch`;
/// when it breaks, one more tick is done, because other ranks have already started it.
///
/// # Errors
/// Robots that cannot be placed, more ranks than robots, a rank that does not answer, or the state
/// of another scenario or program.
pub fn simulate_on(
    scenario: &Scenario,
    agents: Agents,
    state: Option<&[u8]>,
    exchange: &mut dyn Exchange,
    sharing: &Sharing,
    watch: &mut Watch<'_>,
) -> Result<Ended, RankError> {
    check(scenario, exchange.ranks())?;
    Rank::new(scenario, exchange, sharing, agents)?.run(state, watch)
}

pub(super) struct Rank<'a> {
    pub(super) scenario: &'a Scenario,
    pub(super) sharing: &'a Sharing,
    pub(super) engine: Engine,
    pub(super) cut: Cut,
    pub(super) wire: Wire<'a>,
    pub(super) age: u32,
    pub(super) loads: Vec<f64>,
    stops: bool,
    saved_at: Instant,
}

fn starts(scenario: &Scenario) -> impl Iterator<Item = [f64; 2]> + '_ {
    scenario.robots.iter().enumerate().map(|(index, robot)| match scenario.plane() {
        Some(plane) => {
            let [x, y, _] = plane.starts[index].position_m;
            [x, y]
        }
        None => scenario.land.terrain.center_m(robot.start),
    })
}

impl<'a> Rank<'a> {
    fn new(
        scenario: &'a Scenario,
        exchange: &'a mut dyn Exchange,
        sharing: &'a Sharing,
        agents: Agents,
    ) -> Result<Self, RankError> {
        let (rank, ranks) = (exchange.rank(), exchange.ranks());
        let stride = scenario.robots.len().div_ceil(SAMPLES).max(1);
        let samples = starts(scenario).step_by(stride).map(|place_m| Sample { place_m, load: 1.0 });
        let cut = Cut::new(&mut samples.collect::<Vec<_>>(), ranks);
        let here = (0..).zip(starts(scenario)).filter(|(_, place_m)| cut.rank(*place_m) == rank);
        let here: Vec<u32> = here.map(|(number, _)| number).collect();
        let mut ground = AnyGround::new(scenario)?;
        part_mut(&mut ground).keep(&here);
        let engine = Engine::part(scenario, ground, agents, here, rank == 0);
        let wire = Wire::new(exchange);
        let mut rank = Self {
            scenario,
            sharing,
            engine,
            cut,
            wire,
            age: 0,
            loads: Vec::new(),
            stops: false,
            saved_at: Instant::now(),
        };
        rank.tell_region()?;
        Ok(rank)
    }

    fn run(mut self, state: Option<&[u8]>, watch: &mut Watch<'_>) -> Result<Ended, RankError> {
        if let Some(state) = state {
            self.restore(state)?;
        }
        let keeping = self.keeping(false)?;
        let mut row = self.engine.row(keeping, PacketCounts::default());
        let mut sums = self.tell_sums(PacketCounts::default(), 0.0)?;
        let mut is_seen = state.is_some();
        loop {
            if !is_seen {
                self.watch(&row, &sums, watch)?;
            }
            is_seen = false;
            let engine = &self.engine;
            let is_over = engine.interventions.is_empty() && sums.arrived == engine.robots.len() as u64;
            if sums.stops || is_over || engine.ticks() >= self.scenario.ticks {
                return self.end();
            }
            (row, sums) = self.step()?;
        }
    }

    fn step(&mut self) -> Result<(TickRow, Sums), RankError> {
        self.agree_on_cells()?;
        let engine = &mut self.engine;
        engine.change_land();
        engine.apply_interventions();
        engine.apply_faults();
        let refused = engine.decide();
        self.hand_out_keys()?;
        let engine = &mut self.engine;
        engine.transmit();

        let tick = engine.tick;
        let sent = engine.send();
        let reach_m = engine.radio.range_m();
        self.wire.choose(|one, other| one.is_beside(other, reach_m));
        let engine = &self.engine;
        let packets = self.wire.halo(|region| {
            encode(&engine.radio.sent(|from_m| region.is_near(flat(from_m), reach_m)).collect::<Vec<_>>())
        })?;
        let mut elsewhere = Vec::new();
        for (rank, bytes) in packets {
            elsewhere.extend(decode::<Vec<Sent>>(rank, "packets", &bytes)?);
        }
        let engine = &mut self.engine;
        let land = engine.ground.view(tick).terrain;
        let carried = engine.radio.receive(tick, &engine.positions_m, land, &elsewhere, sent);
        let packets = engine.count(refused, carried);

        let (ground, commands) = (part(&engine.ground), &engine.commands);
        self.wire.choose(|one, other| ground.hinders(one, other));
        let wishes = self.wire.halo(|region| ground.wishes(tick, region, commands))?;
        let (own, ground) = (self.wire.regions[self.wire.rank()].clone(), part_mut(&mut engine.ground));
        engine.collisions +=
            ground.advance_beside(tick, (&engine.commands, &engine.ages), &own, &wishes, &mut self.wire)?;
        engine.observe();
        let keeping = self.keeping(true)?;
        self.engine.tick += 1;
        self.tell_region()?;
        self.collide()?;
        self.share()?;
        self.wire.traffic.ticks += 1;
        let load = self.engine.here.len() as f64 + RECEPTION * (carried.delivered + carried.lost) as f64;
        let sums = self.tell_sums(packets, load)?;
        Ok((self.engine.row(keeping, sums.packets), sums))
    }

    /// No rank may place a wall in a cell that is occupied on any rank.
    fn agree_on_cells(&mut self) -> Result<(), RankError> {
        let engine = &self.engine;
        let due = engine.interventions.iter().take_while(|(tick, _)| *tick <= engine.tick);
        let cells = due.filter_map(|(_, what)| match what {
            Intervention::Cell { cell: [x, y], .. } => Some(part(&engine.ground).is_taken(Cell::new(*x, *y))),
            _ => None,
        });
        let own: Vec<bool> = cells.collect();
        if own.is_empty() {
            return Ok(());
        }
        let mut taken = vec![false; own.len()];
        for (rank, bytes) in self.wire.gather(encode(&own))?.iter().enumerate() {
            let theirs = decode::<Vec<bool>>(rank, "cells", bytes)?;
            taken.iter_mut().zip(theirs).for_each(|(taken, theirs)| *taken |= theirs);
        }
        let (now, mut taken) = (engine.tick, taken.into_iter());
        self.engine.interventions.retain(|(tick, what)| {
            let is_asked = *tick <= now && matches!(what, Intervention::Cell { .. });
            !(is_asked && taken.next() == Some(true))
        });
        Ok(())
    }

    /// An attacker gets a captured robot's keys from that robot's rank.
    fn hand_out_keys(&mut self) -> Result<(), RankError> {
        let tick = self.engine.tick;
        let attacks = self.scenario.events.attacks.iter();
        let taken = attacks.filter(|attack| attack.kind == AttackKind::Insider && attack.from_tick == tick);
        let taken: Vec<RobotId> = taken.map(|attack| attack.claims).collect();
        if taken.is_empty() {
            return Ok(());
        }
        let rings: Vec<Option<Ring>> = taken.iter().map(|&robot| self.engine.ring_of(robot)).collect();
        let heard = self.wire.gather_first(encode(&rings))?;
        for (rank, bytes) in heard.iter().enumerate() {
            let rings = decode::<Vec<Option<Ring>>>(rank, "keys", bytes)?;
            let rings = taken.iter().zip(rings).filter_map(|(&robot, ring)| Some((robot, ring?)));
            self.engine.taken.extend(rings);
        }
        Ok(())
    }

    /// Formation quality: rank 0 has all positions and sums them in the order of robots.
    fn keeping(&mut self, counts: bool) -> Result<Option<FormationQuality>, RankError> {
        if self.scenario.formations.is_empty() {
            return Ok(None);
        }
        let own = self.engine.here.iter().copied().zip(self.engine.members());
        let heard = self.wire.gather_first(encode(&own.collect::<Vec<_>>()))?;
        let mut members = Vec::<(u32, Member)>::new();
        for (rank, bytes) in heard.iter().enumerate() {
            members.extend(decode::<Vec<(u32, Member)>>(rank, "places", bytes)?);
        }
        members.sort_unstable_by_key(|&(number, _)| number);
        let members: Vec<_> = members.into_iter().map(|(_, member)| member).collect();
        Ok(self.engine.formation_quality(&members, counts))
    }

    pub(super) fn places(&self) -> impl Iterator<Item = ([f64; 2], Cell)> + Clone + '_ {
        let engine = &self.engine;
        (0..engine.here.len()).map(|index| {
            let motion = engine.ground.motion(index, engine.tick);
            (flat(motion.position_m), motion.cell)
        })
    }

    pub(super) fn tell_region(&mut self) -> Result<(), RankError> {
        let engine = &self.engine;
        let intruders = engine.view().intruders;
        let own = Region::new(self.places(), engine.others.iter().map(|other| other.place_m(intruders)).map(flat));
        let all = self.wire.gather(encode(&own))?;
        let all = all.iter().enumerate().map(|(rank, bytes)| decode(rank, "a region", bytes));
        self.wire.regions = all.collect::<Result<_, _>>()?;
        Ok(())
    }

    fn collide(&mut self) -> Result<(), RankError> {
        // The tick of the last moves.
        let (ground, tick) = (part(&self.engine.ground), self.engine.tick.saturating_sub(1));
        self.wire.choose(|one, other| ground.touches(one, other));
        let bodies = self.wire.halo(|region| ground.bodies(tick, region))?;
        self.engine.collisions += part_mut(&mut self.engine.ground).count_collisions_beside(tick, &bodies)?;
        Ok(())
    }

    fn tell_sums(&mut self, packets: PacketCounts, load: f64) -> Result<Sums, RankError> {
        let saves = self.is_save_due();
        let engine = &self.engine;
        let own = Sums {
            arrived: engine.arrivals.count() as u64,
            waiting: engine.waits.now() as u64,
            collisions: engine.collisions,
            packets,
            hash: hash::sum(&engine.chains),
            gap_m: engine.view().gap_m,
            load,
            stops: self.stops,
            saves,
        };
        let all = self.wire.gather(encode(&own))?;
        let all = all.iter().enumerate().map(|(rank, bytes)| decode::<Sums>(rank, "sums", bytes));
        let all = all.collect::<Result<Vec<_>, _>>()?;
        self.loads = all.iter().map(|sums| sums.load).collect();
        Ok(Sums::of(&all))
    }

    fn is_save_due(&mut self) -> bool {
        let is_due = self.wire.rank() == 0
            && match self.sharing.checkpoints {
                None => false,
                Some(CheckpointInterval::Ticks(ticks)) => {
                    self.stops || self.engine.tick > 0 && self.engine.tick.is_multiple_of(ticks.max(1))
                }
                Some(CheckpointInterval::Time(time)) => self.stops || self.saved_at.elapsed() >= time,
            };
        if is_due {
            self.saved_at = Instant::now();
        }
        is_due
    }

    fn watch(&mut self, row: &TickRow, sums: &Sums, watch: &mut Watch<'_>) -> Result<(), RankError> {
        let rows = if self.sharing.records { self.rows()? } else { Vec::new() };
        let saved = if sums.saves { self.save()? } else { None };
        if self.wire.rank() == 0 {
            let moment = Moment {
                run: saved.as_ref().map(|saved| saved as &dyn Saves),
                arrived: sums.arrived as usize,
                waiting: sums.waiting as usize,
                collisions: sums.collisions,
                gap_m: sums.gap_m,
                trace_hash: sums.hash,
                ..self.engine.moment(row)
            };
            self.stops |= watch(&moment, &mut rows.into_iter()).is_break();
        }
        Ok(())
    }

    fn rows(&mut self) -> Result<Vec<RobotRow>, RankError> {
        let own: Vec<Row> = self.engine.rows().map(Row::from).collect();
        let heard = self.wire.gather_first(encode(&own))?;
        let mut rows = Vec::<Row>::new();
        for (rank, bytes) in heard.iter().enumerate() {
            rows.extend(decode::<Vec<Row>>(rank, "robots", bytes)?);
        }
        rows.sort_unstable_by_key(Row::id);
        let rows = rows.into_iter().enumerate();
        Ok(rows.map(|(number, row)| row.with_error(self.engine.formation_error(number) as f32)).collect())
    }

    fn end(mut self) -> Result<Ended, RankError> {
        let engine = &self.engine;
        let ends = engine.ends();
        let times = engine.here.iter().copied().zip(engine.arrivals.times().iter().copied()).zip(ends);
        let times: Vec<Arrival> = times.map(|((number, time), end)| (number, time, end)).collect();
        let (part, traffic) = (Part::of(engine), self.wire.traffic);
        let heard = self.wire.gather_first(encode(&times))?;
        let mut times = Vec::<Arrival>::new();
        for (rank, bytes) in heard.iter().enumerate() {
            times.extend(decode::<Vec<Arrival>>(rank, "arrivals", bytes)?);
        }
        times.sort_unstable_by_key(|&(number, ..)| number);
        let engine = &self.engine;
        let Outcome { formation, place_error, formations, clearance, .. } = engine.outcome();
        let mut outcome = Outcome {
            ticks: engine.tick,
            seconds: engine.seconds(),
            arrival_times: times.iter().map(|&(_, time, _)| time).collect(),
            ends: times.into_iter().map(|(.., end)| end).collect(),
            formation,
            place_error,
            formations,
            ..nothing(clearance.is_some())
        };
        let mut all = Vec::new();
        for (rank, bytes) in self.wire.gather(encode(&(part, traffic)))?.iter().enumerate() {
            let (part, traffic) = decode::<(Part, Traffic)>(rank, "its results", bytes)?;
            part.add_to(&mut outcome);
            all.push(traffic);
        }
        outcome.waits.retain(|count| count.robots > 0);
        Ok(Ended { outcome, traffic: all })
    }
}

/// Regions are bounds in the plane: what they leave out is farther away in space as well.
const fn flat([x, y, _]: [f64; 3]) -> [f64; 2] {
    [x, y]
}
