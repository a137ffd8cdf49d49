//! Live page of the controlled vehicles. Its thread gets copies of the controlling thread's state,
//! which never waits for the page.

use crate::companion::{Sight, Vehicle};
use anyhow::{Context as _, Result};
use staya_controller::grid::Cell;
use staya_controller::robot::Mode;
use staya_sim::engine::{Known, Moment};
use staya_sim::record::{Motion, PacketCounts, RobotRow, TickRow};
use staya_sim::scenario::{Robot, Scenario};
use staya_view::watch::{About, Insight, Watcher};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

const EVERY: Duration = Duration::from_millis(50);
/// A robot counts as heard with a beacon of at most this age.
const NOW_S: f64 = 1.0;

struct Copied {
    at: Duration,
    vehicles: Vec<Seen>,
}

/// A vehicle of this program at one moment.
struct Seen {
    /// Index among the scenario's robots, from 0.
    index: usize,
    /// The position is NaN before the first telemetry.
    row: RobotRow,
    has_arrived: bool,
    known: Vec<Known>,
    facts: Vec<(&'static str, String)>,
}

impl Seen {
    /// O(neighbours).
    fn new(vehicle: &Vehicle, sight: &Sight<'_>, unseen: &[RobotRow]) -> Self {
        let (index, controller) = (vehicle.setup.index, &vehicle.controller);
        let mut row = RobotRow {
            mode: controller.agent().mode(),
            leader: controller.agent().leader().0,
            target_m: controller.goal_m,
            wait: controller.wait(),
            ..unseen[index]
        };
        if let Some(body) = vehicle.body(sight.config, sight.now) {
            (row.motion.position_m, row.motion.velocity_mps) = (body.position_m, body.velocity_mps);
        }
        let age_s = vehicle.offboard.fix().map(|fix| sight.now.saturating_sub(fix.at).as_secs_f64());
        let telemetry = age_s.map_or_else(|| "none yet".to_owned(), |age_s| format!("{age_s:.2} s old"));
        let [x, y, z] = controller.velocity_mps();
        let facts = vec![
            ("companion", vehicle.offboard.state().words().to_owned()),
            ("telemetry", telemetry),
            ("commanded", format!("{:.2} m/s", libm::sqrt(x * x + y * y + z * z))),
            ("packets heard, refused", format!("{}, {}", vehicle.heard, vehicle.refused)),
        ];
        Self { index, row, has_arrived: vehicle.has_arrived, known: controller.known(), facts }
    }

    const fn is_measured(&self) -> bool {
        !self.row.motion.position_m[0].is_nan()
    }
}

pub struct Page {
    is_wanted: Arc<AtomicBool>,
    copies: Option<SyncSender<Copied>>,
    copied: Instant,
    thread: Option<JoinHandle<()>>,
    unseen: Vec<RobotRow>,
}

impl Page {
    pub fn new(mut watcher: Watcher, scenario: &Scenario) -> Result<Self> {
        let radius_m = |index| scenario.plane().map_or(0.0, |setup| setup.group(index).radius_m);
        let robot = |(index, robot): (usize, &Robot)| RobotRow {
            id: robot.id.0,
            // NaN hides a robot of which no beacon has arrived.
            motion: Motion { cell: Cell::default(), position_m: [f64::NAN; 3], velocity_mps: [0.0; 3] },
            mode: Mode::Passive,
            leader: 0,
            target: Cell::default(),
            target_m: None,
            wait: None,
            formation_error_cells: f32::NAN,
            radius_m: Some(radius_m(index)),
            has_cells: false,
        };
        let unseen: Vec<_> = scenario.robots.iter().enumerate().map(robot).collect();
        let (tick_s, rows) = (scenario.tick_s(), unseen.clone());
        let is_wanted = Arc::new(AtomicBool::new(false));
        let (sender, copies) = sync_channel(1);
        let wanted = Arc::clone(&is_wanted);
        let serve = move || {
            loop {
                let copy: Option<Copied> = match copies.recv_timeout(EVERY) {
                    Ok(copy) => Some(copy),
                    Err(RecvTimeoutError::Timeout) => None,
                    Err(RecvTimeoutError::Disconnected) => return,
                };
                let is_due = watcher.is_due();
                wanted.store(watcher.pages() > 0, Ordering::Relaxed);
                if let Some(copy) = copy.filter(|_| is_due) {
                    show(&mut watcher, &copy, tick_s, &rows);
                }
            }
        };
        let thread = thread::Builder::new().name("vehicles".to_owned()).spawn(serve);
        let thread = thread.context("cannot start a thread for the page")?;
        Ok(Self { is_wanted, copies: Some(sender), copied: Instant::now(), thread: Some(thread), unseen })
    }

    /// Hands over a copy of the present state if a page wants one, else returns in O(1).
    pub fn look(&mut self, sight: &Sight<'_>) {
        if !self.is_wanted.load(Ordering::Relaxed) || self.copied.elapsed() < EVERY {
            return;
        }
        self.copied = Instant::now();
        if let Some(copies) = &self.copies {
            let vehicles = sight.vehicles.iter().map(|vehicle| Seen::new(vehicle, sight, &self.unseen));
            let _ = copies.try_send(Copied { at: sight.now, vehicles: vehicles.collect() });
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

fn show(watcher: &mut Watcher, copy: &Copied, tick_s: f64, unseen: &[RobotRow]) {
    let time_s = copy.at.as_secs_f64();
    let row = TickRow {
        tick: (time_s / tick_s) as u32,
        time_s,
        formation_error_per_agent: f64::NAN,
        graph_distance: f64::NAN,
        packets: PacketCounts::default(),
    };
    let swarm = Swarm::new(&copy.vehicles, unseen);
    let gaps_m = swarm.gaps_m();
    let moment = Moment {
        row: &row,
        arrived: copy.vehicles.iter().filter(|seen| seen.has_arrived).count(),
        waiting: copy.vehicles.iter().filter(|seen| seen.row.wait.is_some()).count(),
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
    watcher.show(&moment, swarm.rows.iter().copied(), &swarm);
}

/// The latest beacon of a robot.
fn heard(vehicles: &[Seen], id: u32) -> Option<&Known> {
    let known = vehicles.iter().flat_map(|seen| &seen.known).filter(|known| known.id.0 == id);
    known.min_by(|a, b| a.age_s.total_cmp(&b.age_s))
}

/// Vehicles of this program by telemetry, the others by the beacons received from them.
struct Swarm<'a> {
    rows: Vec<RobotRow>,
    vehicles: &'a [Seen],
}

impl<'a> Swarm<'a> {
    fn new(vehicles: &'a [Seen], unseen: &[RobotRow]) -> Self {
        let mut rows = unseen.to_vec();
        vehicles.iter().for_each(|seen| rows[seen.index] = seen.row);
        for row in rows.iter_mut().filter(|row| row.motion.position_m[0].is_nan()) {
            if let Some(known) = heard(vehicles, row.id) {
                (row.motion.position_m, row.motion.velocity_mps) = (known.position_m, known.velocity_mps);
            }
        }
        Self { rows, vehicles }
    }

    fn seen(&self, index: usize) -> Option<&Seen> {
        self.vehicles.iter().find(|seen| seen.index == index)
    }

    fn gaps_m(&self) -> Vec<f64> {
        let bodies: Vec<_> = self.vehicles.iter().filter(|seen| seen.is_measured()).map(|seen| &seen.row).collect();
        let pairs = bodies.iter().enumerate().flat_map(|(at, a)| bodies[at + 1..].iter().map(move |b| (a, b)));
        let gaps = pairs.map(|(a, b)| {
            let off = [0, 1, 2].map(|axis| a.motion.position_m[axis] - b.motion.position_m[axis]);
            libm::sqrt(off.iter().map(|x| x * x).sum()) - a.radius_m.unwrap_or(0.0) - b.radius_m.unwrap_or(0.0)
        });
        gaps.collect()
    }
}

impl Insight for Swarm<'_> {
    fn about(&self, index: usize) -> About {
        if let Some(Seen { known, facts, .. }) = self.seen(index) {
            return About { known: Some(known.clone()), facts: facts.clone(), ..About::default() };
        }
        let known = self.rows.get(index).and_then(|row| heard(self.vehicles, row.id));
        let heard = known.map_or_else(|| "nothing".to_owned(), |known| format!("{:.1} s ago", known.age_s));
        About { facts: vec![("companion", "elsewhere".to_owned()), ("last beacon", heard)], ..About::default() }
    }

    fn is_measured(&self, index: usize) -> bool {
        self.seen(index).is_some_and(Seen::is_measured)
    }

    fn links(&self) -> Option<Vec<[u32; 2]>> {
        let heard = self.vehicles.iter().flat_map(|seen| {
            let known = seen.known.iter().filter(|known| known.age_s <= NOW_S);
            known.filter_map(|known| {
                let from = self.rows.binary_search_by_key(&known.id.0, |row| row.id).ok()?;
                Some([u32::try_from(from).ok()?, u32::try_from(seen.index).ok()?])
            })
        });
        Some(heard.collect())
    }
}
