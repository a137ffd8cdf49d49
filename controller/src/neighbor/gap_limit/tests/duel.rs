//! Robots that follow the real [`GapLimit`] and [`NeighborTable`] in continuous time: each decides
//! by its own clock, moves in a straight line for a step, and is received late or not at all.

use super::*;

/// Properties that all robots of a duel share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rules {
    pub step_ms: i32,
    pub fastest_mps: f64,
    pub radius_m: f64,
    /// Steps of silence after which a robot is lost; 0: never.
    pub expires: i32,
    pub is_synchronous: bool,
    /// Age of a beacon when it is first used, steps; at least 1.
    pub latency: i32,
}

impl Rules {
    pub const COMMON: Self =
        Self { step_ms: 100, fastest_mps: 1.0, radius_m: RADIUS_M, expires: 0, is_synchronous: true, latency: 1 };

    fn step_us(&self) -> i64 {
        i64::from(self.step_ms) * 1000
    }

    fn step(&self) -> Duration {
        Duration::from_millis(self.step_ms)
    }

    fn latency(&self) -> Duration {
        self.step().saturating_mul(self.latency)
    }

    fn step_s(&self) -> f64 {
        f64::from(self.step_ms) / 1e3
    }

    fn limit<'a>(&self, body: &'a Body<f32>, own: Position, now: Instant, elapsed: Duration) -> GapLimit<'a, f32> {
        GapLimit {
            body,
            own,
            own_mps: Vec3::ZERO,
            lag_s: 0.0,
            now,
            tick: self.step(),
            elapsed,
            is_synchronous: self.is_synchronous,
            latency: self.latency(),
            inflation: StalenessInflation { growth_mps: self.fastest_mps as f32, max_m: self.radius_m as f32 },
            may_be_alone: false,
            // No silent robot counts as standing: all of them may move.
            stands_after: Duration::from_millis(2_000_000),
            is_agreed: false,
            is_heard: true,
            downwash: 1.0,
        }
    }
}

fn clock(at_us: i64) -> Instant {
    Instant::from_micros(1) + Duration::from_micros(i32::try_from(at_us).unwrap())
}

fn place(at_m: Vec3<f64>) -> Position {
    Position::from_metres([at_m.x, at_m.y, at_m.z]).unwrap()
}

#[derive(Clone)]
pub(super) struct Duelist {
    table: NeighborTable<f32, 4>,
    body: Body<f32>,
    /// Start and end of the path that it is on.
    from_m: Vec3<f64>,
    pub to_m: Vec3<f64>,
    /// When it decided and decides again.
    since_us: i64,
    pub due_us: i64,
    /// Its last beacons, and when each arrives at the other robots.
    said: StdVec<(i64, Neighbor<f32>)>,
    has_decided: bool,
}

impl Duelist {
    fn at_m(&self, rules: &Rules, now_us: i64) -> Vec3<f64> {
        let part = (now_us - self.since_us) as f64 / rules.step_us() as f64;
        self.from_m + (self.to_m - self.from_m) * part.min(1.0)
    }
}

#[derive(Clone)]
pub(super) struct Duel {
    pub rules: Rules,
    pub robots: StdVec<Duelist>,
    now_us: i64,
    /// Least gap between two bodies so far, metres.
    pub least_m: f64,
}

impl Duel {
    /// Robots at these places; robot `i` decides first at `first_us[i]`, above 0. All know all.
    pub fn new(rules: Rules, places_m: &[[f64; 2]], first_us: &[i64]) -> Self {
        let robot = |(index, (&[x, y], &first_us)): (usize, (&[f64; 2], &i64))| {
            let long = Duration::from_millis(1_000_000);
            let body = Body {
                id: RobotId(index as u32 + 1),
                velocity_mps: Vec3::ZERO,
                radius_m: rules.radius_m as f32,
                max_speed_mps: rules.fastest_mps as f32,
                max_acceleration_mps2: f32::MAX,
                step_s: rules.step_s() as f32,
            };
            let at_m = Vec3::new(x, y, 0.0);
            Duelist {
                table: NeighborTable::new(Ages { stale_after: long, expire_after: long }),
                body,
                from_m: at_m,
                to_m: at_m,
                since_us: 0,
                due_us: first_us,
                said: StdVec::new(),
                has_decided: false,
            }
        };
        let robots = places_m.iter().zip(first_us).enumerate().map(robot).collect();
        Self { rules, robots, now_us: 0, least_m: f64::MAX }
    }

    /// Numbers of the robots that decide next, all at one instant.
    pub fn next(&self) -> StdVec<usize> {
        let due_us = self.robots.iter().map(|robot| robot.due_us).min().unwrap();
        (0..self.robots.len()).filter(|&index| self.robots[index].due_us == due_us).collect()
    }

    /// Where a robot is.
    pub fn at_m(&self, index: usize) -> Vec3<f64> {
        self.robots[index].at_m(&self.rules, self.now_us)
    }

    /// Where a robot started on the path that it is on.
    pub fn begun_m(&self, index: usize) -> Vec3<f64> {
        self.robots[index].from_m
    }

    /// Moves on to the next instant at which robots decide, and returns these.
    pub fn wait(&mut self) -> StdVec<usize> {
        let deciding = self.next();
        let until_us = self.robots[deciding[0]].due_us;
        // All move straight on between the ends of paths.
        let ends = self.robots.iter().map(|robot| robot.since_us + self.rules.step_us());
        let mut moments: StdVec<i64> = ends.filter(|end| (self.now_us..until_us).contains(end)).collect();
        moments.extend([self.now_us, until_us]);
        moments.sort_unstable();
        for pair in moments.windows(2) {
            for one in 0..self.robots.len() {
                for other in 0..one {
                    let offset =
                        |at_us| self.robots[one].at_m(&self.rules, at_us) - self.robots[other].at_m(&self.rules, at_us);
                    let (before, way) = (offset(pair[0]), offset(pair[1]) - offset(pair[0]));
                    let part = if way.norm() > 0.0 { -before.dot(way) / way.dot(way) } else { 0.0 };
                    let nearest_m = (before + way * part.clamp(0.0, 1.0)).norm();
                    self.least_m = self.least_m.min(nearest_m - 2.0 * self.rules.radius_m);
                }
            }
        }
        self.now_us = until_us;
        deciding
    }

    /// The robots of this instant decide. `hears(to, from)` is false if what `from` said last is
    /// lost; the wish is in m/s. Each says its path, which arrives `delay_us` later, and decides
    /// again `late_us` after a step.
    pub fn decide(
        &mut self,
        deciding: &[usize],
        wishes_mps: &[Vec3<f64>],
        hears: impl Fn(usize, usize) -> bool,
        (delay_us, late_us): (i64, i64),
    ) {
        let (rules, now_us) = (self.rules, self.now_us);
        let first: StdVec<_> = self.robots.iter().map(|robot| beacon(robot, 0)).collect();
        for (&index, wish) in deciding.iter().zip(wishes_mps) {
            let others = self.robots.iter().enumerate().filter(|(other, _)| *other != index);
            let arrived = |(other, robot): (usize, &Duelist)| {
                let &(at_us, last) = robot.said.iter().rfind(|(at_us, _)| *at_us <= now_us)?;
                // Packets wait for the next decision, once.
                let is_new = at_us > self.robots[index].since_us;
                (is_new && hears(index, other)).then_some(last)
            };
            let heard: StdVec<_> = match self.robots[index].has_decided {
                true => others.filter_map(arrived).collect(),
                false => others.map(|(other, _)| first[other]).collect(),
            };
            let robot = &mut self.robots[index];
            let (own, now) = (place(robot.from_m + (robot.to_m - robot.from_m)), clock(now_us));
            if rules.expires > 0 {
                let longest = rules.step().saturating_mul(rules.expires);
                robot.table.expire((&robot.body, robot.body.step_s), now, (longest, true), |_| {});
            }
            let elapsed_us = if robot.has_decided { now_us - robot.since_us } else { rules.step_us() };
            let late_us_before = elapsed_us - rules.step_us();
            let late = if late_us_before > rules.step_us() / 8 { late_us_before } else { 0 };
            let elapsed = Duration::from_micros(elapsed_us as i32);
            for news in heard {
                // As an agent does: at its first use each beacon has the same age.
                let heard = now - rules.latency() - Duration::from_micros(late as i32);
                let _ = robot.table.put(Neighbor { heard, ..news }, own, now, |_| false);
            }
            let wish: Vec3<f32> = wish.cast();
            let wish = wish.clamp_norm(robot.body.max_speed_mps);
            let within = rules.limit(&robot.body, own, now, elapsed).limit(&mut robot.table, &[], wish);
            let velocity_mps = robot.body.reach(within.unwrap_or(Vec3::ZERO));
            robot.body.velocity_mps = velocity_mps;
            robot.from_m = robot.to_m;
            robot.to_m += velocity_mps.cast() * rules.step_s();
            robot.since_us = now_us;
            robot.due_us = now_us + rules.step_us() + late_us;
            robot.has_decided = true;
            let news = beacon(robot, now_us);
            robot.said.push((now_us + delay_us.max(1), news));
            // Earlier ones have arrived, or are superseded.
            let old = robot.said.len().saturating_sub(1 + rules.latency as usize);
            robot.said.drain(..old);
        }
    }
}

/// The beacon of the last decision: where the path starts, and its velocity.
fn beacon(robot: &Duelist, at_us: i64) -> Neighbor<f32> {
    let heard = Neighbor::from_beacon(robot.body.id, &Beacon::default(), ProtocolId::NONE, clock(at_us));
    let mmps = |v: f32| f32::from_milli(v.to_milli().unwrap());
    let Vec3 { x, y, z } = robot.body.velocity_mps;
    let velocity_mps = Vec3::new(mmps(x), mmps(y), mmps(z));
    Neighbor { position: place(robot.from_m), velocity_mps, radius_m: robot.body.radius_m, ..heard }
}

/// The direction from one robot to another, turned by an angle.
pub(super) fn towards(duel: &Duel, from: usize, to_m: Vec3<f64>, angle: f64) -> Vec3<f64> {
    let ahead = (to_m - duel.robots[from].to_m).normalized().unwrap_or(Vec3::ZERO);
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    Vec3::new(ahead.x * cos - ahead.y * sin, ahead.x * sin + ahead.y * cos, 0.0) * duel.rules.fastest_mps
}
