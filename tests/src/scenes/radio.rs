//! Faults of radios and robots in a scene.

use super::crowd::Crowd;
use super::draw::Draw;
use super::{Kind, Parts, rounded};
use std::fmt::Write as _;

/// Adds the faults of the kind. The robots cross in about `cross_s` seconds.
pub(super) fn faults(draw: &mut Draw, kind: Kind, crowd: &Crowd, cross_s: f64, parts: &mut Parts) {
    let mut scene = Faults { draw, crowd, cross_s, parts };
    match kind {
        Kind::Fades | Kind::Inertia | Kind::Dense | Kind::Template | Kind::Space => scene.fades(),
        Kind::Many => {
            scene.fades();
            if scene.draw.chance(0.5) {
                scene.range();
            }
        }
        Kind::FadesAndLoss => {
            scene.fades();
            scene.loss(0.1, 0.7);
        }
        Kind::Loss => scene.loss(0.8, 0.97),
        Kind::Jitter => scene.jitter(),
        Kind::DeathsInFades => {
            scene.fades();
            if scene.draw.chance(0.25) {
                let span_s = scene.blackouts(1, false);
                scene.deaths(span_s);
            } else {
                scene.deaths([0.4, cross_s]);
            }
        }
        Kind::Door | Kind::Corridor => scene.some_fades(0.7),
        Kind::Range => {
            scene.fades();
            scene.range();
        }
        Kind::Blackout => {
            let count = scene.draw.whole(1, 3);
            scene.blackouts(count, true);
            if scene.draw.chance(0.3) {
                scene.loss(0.1, 0.6);
            }
        }
        Kind::SameNumber => {
            scene.some_fades(0.6);
            scene.same_number();
        }
        Kind::Intruder | Kind::Mixed => scene.some_fades(0.6),
        Kind::Deaths => {
            scene.some_loss();
            scene.deaths([0.4, cross_s]);
        }
        Kind::Restarts => {
            scene.some_loss();
            scene.restarts();
        }
        Kind::LateStarts => scene.late_starts(),
        Kind::Reorder => scene.reorder(),
        Kind::WeakRadios => scene.weak_radios(),
        Kind::Mute => scene.dead_ends("from", 0.0),
        Kind::MuteForATime => scene.dead_ends("from", 1.0),
        Kind::Deaf => scene.dead_ends("to", 0.5),
        Kind::DeadLink => scene.dead_links(true),
        Kind::OneWay => scene.dead_links(false),
    }
}

struct Faults<'a> {
    draw: &'a mut Draw,
    crowd: &'a Crowd,
    cross_s: f64,
    parts: &'a mut Parts,
}

impl Faults<'_> {
    fn radio(&mut self, field: &str, value: f64) {
        let _ = writeln!(self.parts.radio, "{field} = {}", rounded(value));
    }

    fn fades(&mut self) {
        let (share, mean_s) = (self.draw.within(0.05, 0.6), self.draw.spread(0.2, 10.0));
        let (share, mean_ms) = (rounded(share), libm::round(mean_s * 1000.0));
        let _ = writeln!(self.parts.radio, "burst = {{ share = {share}, mean_ms = {mean_ms} }}");
        self.parts.wait_s += 30.0 + 20.0 * mean_s * share;
    }

    fn loss(&mut self, low: f64, high: f64) {
        let loss = self.draw.within(low, high);
        self.radio("loss", loss);
        self.parts.wait_s += 60.0 * loss;
    }

    fn some_loss(&mut self) {
        if self.draw.chance(0.5) {
            self.loss(0.0, 0.3);
        }
    }

    /// Fades with this probability; otherwise a blackout, loss, or a perfect radio.
    fn some_fades(&mut self, probability: f64) {
        if self.draw.chance(probability) {
            return self.fades();
        }
        match self.draw.whole(0, 2) {
            0 => {
                self.blackouts(1, false);
            }
            1 => self.loss(0.1, 0.9),
            _ => {}
        }
    }

    fn jitter(&mut self) {
        let (delay_ms, jitter_ms) = (self.draw.within(0.0, 300.0), self.draw.within(50.0, 400.0));
        self.radio("delay_ms", libm::round(delay_ms));
        self.radio("jitter_ms", libm::round(jitter_ms));
        self.parts.wait_s += 30.0;
    }

    /// The range is twice the way in which robots stop and see others, or more.
    fn range(&mut self) {
        let member = self.crowd.members[0];
        let range_m =
            6.0 * member.radius_m + member.speed_mps * self.draw.within(3.0, 6.0) + self.draw.within(0.0, 3.0);
        self.radio("range_m", range_m);
    }

    /// A time from `from` to `to` of the time in which robots cross.
    fn during(&mut self, from: f64, to: f64) -> f64 {
        rounded(self.draw.within(from, to) * self.cross_s)
    }

    /// Adds times in which all packets are lost and returns the first one. If it `may_precede` all
    /// packets, robots begin without knowing each other.
    fn blackouts(&mut self, count: u32, may_precede: bool) -> [f64; 2] {
        // Some begin while robots listen, most of them on the way.
        let mut at_s = match self.draw.within(0.0, 1.0) {
            share if share < 0.1 && may_precede => 0.0,
            share if share < 0.4 => self.draw.within(0.1, 0.5),
            _ => 0.15 + self.during(0.05, 0.9),
        };
        let mut spans_s = Vec::new();
        for _ in 0..count {
            let end_s = at_s + self.draw.within(0.5, 10.0);
            spans_s.push([at_s, end_s].map(rounded));
            self.parts.wait_s += 2.0 * (end_s - at_s) + 10.0;
            at_s = end_s + self.draw.within(0.2, 5.0);
        }
        let _ = writeln!(self.parts.radio, "blackout_s = {spans_s:?}");
        spans_s[0]
    }

    fn reorder(&mut self) {
        let (reorder, reorder_ms) = (self.draw.within(0.05, 0.5), self.draw.within(200.0, 2000.0));
        let duplicate = self.draw.within(0.0, 0.3);
        self.radio("reorder", reorder);
        self.radio("reorder_ms", libm::round(reorder_ms));
        self.radio("duplicate", duplicate);
        self.parts.wait_s += 30.0;
    }

    /// The numbers of all robots in random order.
    fn numbers(&mut self) -> Vec<u32> {
        let mut numbers: Vec<_> = (1..).take(self.crowd.members.len()).collect();
        self.draw.shuffle(&mut numbers);
        numbers
    }

    /// Adds a fault to some robots.
    fn robots_fail(&mut self, most: u32, mut times_s: impl FnMut(&mut Self, u32) -> [f64; 2]) {
        let most = most.min(self.crowd.members.len() as u32 / 2);
        let count = self.draw.whole(1, most.max(1)) as usize;
        for robot in self.numbers().into_iter().take(count) {
            let [at_s, down_s] = times_s(self, robot).map(rounded);
            let _ = write!(self.parts.tables, "[[fault]]\nrobot = {robot}\nat_s = {at_s}\ndown_s = {down_s}\n");
        }
    }

    /// Robots die between two times.
    fn deaths(&mut self, [from_s, to_s]: [f64; 2]) {
        self.robots_fail(4, |scene, _| [scene.draw.within(from_s, to_s.max(from_s)), 100_000.0]);
        self.parts.wait_s += 30.0;
    }

    fn restarts(&mut self) {
        self.robots_fail(6, |scene, _| {
            let down_s = if scene.draw.chance(0.3) { 0.0 } else { scene.draw.within(0.0, 5.0) };
            [0.3 + scene.during(0.1, 1.0), down_s]
        });
        self.parts.wait_s += 40.0;
    }

    /// A robot that has never sent is unknown to all others. So it is silent from the start only if
    /// it is far from their ways; any other one is heard first.
    fn late_starts(&mut self) {
        let crowd = self.crowd;
        self.robots_fail(8, |scene, robot| {
            let at_s = if crowd.is_aside(robot as usize - 1) { 0.0 } else { 0.25 };
            [at_s, scene.draw.within(0.2, 8.0)]
        });
        self.parts.wait_s += 40.0;
    }

    /// Two robots that come close to each other, first of `tries` pairs.
    fn pair(&mut self, tries: u32) -> [u32; 2] {
        let pairs: Vec<_> = (0..tries).map(|_| self.numbers()).map(|numbers| [numbers[0], numbers[1]]).collect();
        let miss_m = |pair: &[u32; 2]| self.crowd.miss_m(pair[0] as usize - 1, pair[1] as usize - 1);
        let nearest = pairs.iter().min_by(|a, b| miss_m(a).total_cmp(&miss_m(b)));
        *nearest.expect("at least one try")
    }

    fn same_number(&mut self) {
        let [robot, number] = self.pair(3);
        let _ = write!(self.parts.tables, "[[misnumbered]]\nrobot = {robot}\nnumber = {number}\n");
        self.parts.wait_s += 20.0;
    }

    fn fault(&mut self, fields: &str, lasts: bool) {
        let _ = write!(self.parts.tables, "[[radio.fault]]\n{fields}");
        if lasts {
            return;
        }
        let (at_s, for_s) = (self.during(0.0, 0.8), rounded(self.draw.within(1.0, 20.0)));
        let _ = write!(self.parts.tables, "at_s = {at_s}\nfor_s = {for_s}\n");
        self.parts.wait_s += for_s;
    }

    fn weak_radios(&mut self) {
        let pair = self.pair(6);
        let lasts = self.draw.chance(0.5);
        self.fault(&format!("from = {pair:?}\nboth_ways = true\nloss = 0.95\n"), lasts);
        self.parts.wait_s += 60.0;
    }

    /// One or two transmitters (`from`) or receivers (`to`) are dead, for a time with this
    /// probability.
    fn dead_ends(&mut self, end: &str, for_a_time: f64) {
        let numbers = self.numbers();
        let dead = &numbers[..if self.draw.chance(0.7) { 1 } else { 2 }];
        let lasts = !self.draw.chance(for_a_time);
        self.fault(&format!("{end} = {dead:?}\n"), lasts);
        self.parts.wait_s += 30.0;
    }

    fn dead_links(&mut self, both_ways: bool) {
        for _ in 0..self.draw.whole(1, 4) {
            let [from, to] = self.pair(12);
            let lasts = self.draw.chance(0.6);
            let both = if both_ways { "both_ways = true\n" } else { "" };
            self.fault(&format!("from = [{from}]\nto = [{to}]\n{both}"), lasts);
        }
        self.parts.wait_s += 30.0;
    }
}
