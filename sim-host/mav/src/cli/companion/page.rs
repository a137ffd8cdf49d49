//! Live page of the controlled vehicles. Its thread gets copies of the controlling thread's state,
//! which never waits for the page.

use crate::companion::{Seen, Sight};
use anyhow::{Context as _, Result};
use staya_controller::grid::Cell;
use staya_controller::robot::Mode;
use staya_sim::engine::{Known, Moment};
use staya_sim::record::{Motion, PacketCounts, RobotRow, TickRow};
use staya_sim::scenario::Scenario;
use staya_view::watch::{About, Insight, Watcher};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

const EVERY: Duration = Duration::from_millis(50);
/// A robot counts as heard with a beacon of at most this age.
const NOW_S: f64 = 1.0;

#[derive(Debug)]
struct Copied {
    at: Duration,
    vehicles: Vec<Seen>,
}

pub struct Page {
    is_wanted: Arc<AtomicBool>,
    copies: Option<SyncSender<Copied>>,
    copied: Instant,
    thread: Option<JoinHandle<()>>,
}

impl Page {
    pub fn new(watcher: Watcher, scenario: &Scenario) -> Result<Self> {
        let is_wanted = Arc::new(AtomicBool::new(false));
        let (sender, copies) = sync_channel(1);
        let shown = Shown::new(scenario);
        let wanted = Arc::clone(&is_wanted);
        let thread =
            thread::Builder::new().name("vehicles".to_owned()).spawn(move || shown.serve(watcher, &copies, &wanted));
        let thread = thread.context("cannot start a thread for the page")?;
        Ok(Self { is_wanted, copies: Some(sender), copied: Instant::now(), thread: Some(thread) })
    }

    /// Hands over a copy of the present state if a page wants one, else returns in O(1).
    pub fn look(&mut self, sight: &Sight<'_>) {
        if !self.is_wanted.load(Ordering::Relaxed) || self.copied.elapsed() < EVERY {
            return;
        }
        self.copied = Instant::now();
        if let Some(copies) = &self.copies {
            let _ = copies.try_send(Copied { at: sight.now(), vehicles: sight.vehicles() });
        }
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        self.copies = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

struct Shown {
    tick_s: f64,
    robots: Vec<(u32, f64)>,
}

impl Shown {
    fn new(scenario: &Scenario) -> Self {
        let radius_m = |index| scenario.plane.as_ref().map_or(0.0, |setup| setup.group(index).radius_m);
        let robots = scenario.robots.iter().enumerate();
        Self { tick_s: scenario.tick_s(), robots: robots.map(|(index, robot)| (robot.id.0, radius_m(index))).collect() }
    }

    fn serve(&self, mut watcher: Watcher, copies: &Receiver<Copied>, is_wanted: &AtomicBool) {
        loop {
            let copy = match copies.recv_timeout(EVERY) {
                Ok(copy) => Some(copy),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return,
            };
            let is_due = watcher.is_due();
            is_wanted.store(watcher.pages() > 0, Ordering::Relaxed);
            if let Some(copy) = copy.filter(|_| is_due) {
                self.show(&mut watcher, &copy);
            }
        }
    }

    fn show(&self, watcher: &mut Watcher, copy: &Copied) {
        let time_s = copy.at.as_secs_f64();
        let row = TickRow {
            tick: (time_s / self.tick_s) as u32,
            time_s,
            formation_error_per_agent: f64::NAN,
            graph_distance: f64::NAN,
            packets: PacketCounts::default(),
        };
        let swarm = Swarm { shown: self, vehicles: &copy.vehicles };
        let gaps_m = swarm.gaps_m();
        let moment = Moment {
            row: &row,
            arrived: copy.vehicles.iter().filter(|seen| seen.has_arrived).count(),
            waiting: copy.vehicles.iter().filter(|seen| seen.wait.is_some()).count(),
            // Collisions at this moment; earlier ones are not counted.
            collisions: gaps_m.iter().filter(|gap_m| **gap_m < 0.0).count() as u64,
            gap_m: gaps_m.into_iter().min_by(f64::total_cmp),
            intruders: &[],
            land: None,
            solids: &[],
            goals_m: Default::default(),
            trace_hash: 0,
            run: None,
        };
        watcher.show(&moment, (0..self.robots.len()).map(|index| swarm.row(index)), &swarm);
    }

    fn index_of(&self, id: u32) -> Option<usize> {
        self.robots.binary_search_by_key(&id, |(id, _)| *id).ok()
    }
}

/// Vehicles of this program by telemetry, the others by the beacons received from them.
struct Swarm<'a> {
    shown: &'a Shown,
    vehicles: &'a [Seen],
}

impl Swarm<'_> {
    fn seen(&self, index: usize) -> Option<&Seen> {
        self.vehicles.iter().find(|seen| seen.index == index)
    }

    fn heard(&self, id: u32) -> Option<&Known> {
        let known = self.vehicles.iter().flat_map(|seen| &seen.known).filter(|known| known.id.0 == id);
        known.min_by(|a, b| a.age_s.total_cmp(&b.age_s))
    }

    fn row(&self, index: usize) -> RobotRow {
        let id = self.shown.robots.get(index).map_or(0, |(id, _)| *id);
        let seen = self.seen(index);
        let measured = seen.and_then(|seen| Some((seen.position_m?, seen.velocity_mps)));
        let heard = || self.heard(id).map(|known| (known.position_m, known.velocity_mps));
        // NaN hides a robot of which no beacon has arrived.
        let (position_m, velocity_mps) = measured.or_else(heard).unwrap_or(([f64::NAN; 3], [0.0; 3]));
        RobotRow {
            id,
            motion: Motion { cell: Cell::default(), position_m, velocity_mps },
            mode: seen.map_or(Mode::Passive, |seen| seen.mode),
            leader: seen.map_or(0, |seen| seen.leader.0),
            target: Cell::default(),
            target_m: seen.and_then(|seen| seen.goal_m),
            wait: seen.and_then(|seen| seen.wait),
            formation_error_cells: f32::NAN,
            radius_m: self.shown.robots.get(index).map(|(_, radius_m)| *radius_m),
            has_cells: false,
        }
    }

    fn gaps_m(&self) -> Vec<f64> {
        let radius_m = |seen: &Seen| self.shown.robots.get(seen.index).map_or(0.0, |(_, radius_m)| *radius_m);
        let placed = |seen: &Seen| Some((seen.position_m?, radius_m(seen)));
        let bodies: Vec<_> = self.vehicles.iter().filter_map(placed).collect();
        let pairs = bodies.iter().enumerate().flat_map(|(at, a)| bodies[at + 1..].iter().map(move |b| (a, b)));
        let gaps = pairs.map(|((a_m, a_radius_m), (b_m, b_radius_m))| {
            let off = [0, 1, 2].map(|axis| a_m[axis] - b_m[axis]);
            libm::sqrt(off.iter().map(|x| x * x).sum()) - a_radius_m - b_radius_m
        });
        gaps.collect()
    }
}

impl Insight for Swarm<'_> {
    fn about(&self, index: usize) -> About {
        let Some(seen) = self.seen(index) else {
            let id = self.shown.robots.get(index).map_or(0, |(id, _)| *id);
            let heard =
                self.heard(id).map_or_else(|| "nothing".to_owned(), |known| format!("{:.1} s ago", known.age_s));
            return About {
                facts: vec![("companion", "elsewhere".to_owned()), ("last beacon", heard)],
                ..About::default()
            };
        };
        let telemetry = seen.age_s.map_or_else(|| "none yet".to_owned(), |age_s| format!("{age_s:.2} s old"));
        let [x, y, z] = seen.commanded_mps;
        let speed = libm::sqrt(x * x + y * y + z * z);
        About {
            known: Some(seen.known.clone()),
            facts: vec![
                ("companion", seen.state.words().to_owned()),
                ("telemetry", telemetry),
                ("commanded", format!("{speed:.2} m/s")),
                ("packets heard, refused", format!("{}, {}", seen.heard, seen.refused)),
            ],
            ..About::default()
        }
    }

    fn is_measured(&self, index: usize) -> bool {
        self.seen(index).is_some_and(|seen| seen.position_m.is_some())
    }

    fn links(&self) -> Option<Vec<[u32; 2]>> {
        let heard = self.vehicles.iter().flat_map(|seen| {
            let known = seen.known.iter().filter(|known| known.age_s <= NOW_S);
            known.filter_map(|known| {
                let from = self.shown.index_of(known.id.0)?;
                Some([u32::try_from(from).ok()?, u32::try_from(seen.index).ok()?])
            })
        });
        Some(heard.collect())
    }
}
