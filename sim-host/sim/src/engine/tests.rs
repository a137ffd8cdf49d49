use super::*;
use crate::record::RobotRow;
use crate::scenario::Overrides;
use proptest::prelude::*;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{
    Action, AnySurroundings, BadInput, Decision, Grid as OnCells, GridOrder, GridPayload, Law, Progress, Radio, Report,
    Surroundings as _, Tools, View,
};
use staya_controller::grid::{Cell, Dir};
use staya_controller::rand::Rng;
use staya_controller::robot::Mode;
use staya_controller::time::{Duration, Instant};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::{Arc, Mutex};

fn scenario(robots: &str, rest: &str) -> Scenario {
    let text = format!(
        "name = \"t\"\nticks = 200\ntick_s = 0.5\n[terrain]\ncell_m = 2\n\
         uniform = {{ width = 20, height = 20, classes = 1 }}\n[robots]\n{robots}\n{rest}"
    );
    Scenario::parse(&text, Path::new("t.toml"), &Overrides::default()).expect("a good scenario")
}

const TWO: &str = "list = [{ start = [3, 3], goal = [12, 3] }, { start = [5, 3], goal = [12, 5] }]";

const LOSSY: &str = "[radio]\nrange_m = 9\nloss = 0.3\njitter_ms = 900\nduplicate = 0.1\n\
                     bit_error_rate = 0.001\nburst = { share = 0.2, mean_ms = 2000 }\n";

#[derive(Clone, Debug, PartialEq)]
struct Known {
    id: u32,
    now_us: u32,
    cell: Cell,
    position_mm: [i32; 3],
    window: (Cell, u16, u16),
    others: Vec<(u32, Cell)>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Scout(#[serde(skip)] Notes, Option<Cell>);

impl Law<f32> for Scout {
    type Surroundings<'a> = AnySurroundings<'a, f32>;
    type Protocol = OnCells;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, f32, OnCells>,
        here: &AnySurroundings<'_, f32>,
        _: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        let grid = here.on_grid().ok_or(BadInput)?;
        let cell = grid.cell.cell;
        let window = grid.window.ok_or(BadInput)?;
        let position = view.state.position;
        self.0.lock().expect("no test panics").push(Known {
            id: view.id.0,
            now_us: view.now.as_micros(),
            cell,
            position_mm: position.mm,
            window: (window.origin(), window.width(), window.height()),
            others: view.on_grid().map(|n| (n.id.0, n.cell)).collect(),
        });
        let action = Action::Moves([Dir::East].into_iter().collect());
        Ok(Decision::new(action, Progress::at_goal(cell == self.1.unwrap_or_default())))
    }

    fn payload(&mut self, here: &AnySurroundings<'_, f32>, heading: Dir, _: &mut Radio<'_, OnCells>) -> GridPayload {
        let cell = here.on_grid().map(|grid| grid.cell.cell).unwrap_or_default();
        GridPayload { cell, heading, ..GridPayload::default() }
    }

    fn order(&mut self, order: &GridOrder) -> bool {
        let GridOrder::Goal(goal) = order else { return false };
        self.1 = Some(*goal);
        true
    }

    fn report(&self) -> Report {
        Report { goal: self.1, target: self.1, ..Report::default() }
    }
}

type Notes = Arc<Mutex<Vec<Known>>>;

fn scouts(scenario: &Scenario) -> (Engine, Notes) {
    let known = Arc::new(Mutex::new(Vec::new()));
    let shared = known.clone();
    let agents = own_agents(scenario, move |_| Scout(shared.clone(), None)).expect("a grid");
    (Engine::new(scenario, agents).expect("free starts"), known)
}

fn watch_nothing(_: &Moment<'_>, _: &mut dyn Iterator<Item = RobotRow>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

#[test]
fn all_robots_decide_on_messages_of_the_previous_tick_in_any_order() {
    let scenario = scenario(TWO, "");
    let (mut engine, known) = scouts(&scenario);
    for _ in 0..4 {
        engine.step();
    }
    let known = known.lock().expect("no test panics");
    for tick in 0..4_i16 {
        let at = |id: u32| {
            let mut all = known.iter().filter(|k| k.id == id);
            all.nth(tick as usize).expect("it decides in each tick")
        };
        let (one, two) = (at(1), at(2));
        // Both move each tick, so a received cell is the one before the last move.
        let heard = |id, x: i16| {
            if tick == 0 { vec![] } else { vec![(id, Cell::new(x + tick - 1, 3))] }
        };
        assert_eq!((one.cell.x, &one.others), (3 + tick, &heard(2, 5)));
        assert_eq!((two.cell.x, &two.others), (5 + tick, &heard(1, 3)));
        assert_eq!(one.now_us, tick as u32 * 500_000);
    }
}

#[test]
fn a_robot_gets_its_pose_in_metres_and_a_full_window() {
    let rest = "[grid]\nradius = 3\n";
    let scenario = scenario("list = [{ start = [0, 19], goal = [9, 19] }]", rest);
    let (mut engine, known) = scouts(&scenario);
    engine.step();
    let known = known.lock().expect("no test panics");
    assert_eq!(known[0].position_mm, [1_000, 39_000, 0]);
    assert_eq!(known[0].window, (Cell::new(-3, 16), 7, 7));
}

#[test]
fn a_down_robot_is_stationary_and_silent_and_restarts_its_clock() {
    let fault = "[[fault]]\nrobot = 1\nat_s = 1\ndown_s = 1.5\n";
    let scenario = scenario(TWO, fault);
    let (mut engine, known) = scouts(&scenario);
    let rows: Vec<_> = (0..8).map(|_| engine.step()).collect();
    let sent: Vec<_> = rows.iter().map(|row| row.packets.sent).collect();
    assert_eq!(sent, [2, 2, 1, 1, 1, 2, 2, 2]);
    let known = known.lock().expect("no test panics");
    let own: Vec<_> = known.iter().filter(|k| k.id == 1).collect();
    let clocks: Vec<_> = own.iter().map(|k| k.now_us / 500_000).collect();
    assert_eq!(clocks, [0, 1, 0, 1, 2]);
    assert_eq!(own[2].cell, own[1].cell + Cell::new(1, 0), "it stood meanwhile");
    assert!(own[2].others.is_empty(), "it forgot all robots");
    assert_eq!(own[3].others.len(), 1);
    assert_eq!(engine.computers[0].starts, 1);
    // The other robot receives the first start, then nothing, then the restart.
    let heard: Vec<_> = known.iter().filter(|k| k.id == 2).map(|k| k.others[..].to_vec()).collect();
    assert_eq!(heard[2], heard[5]);
    assert_eq!(heard[6][0].1, own[2].cell);
}

#[test]
fn a_down_robot_has_fault_mode_and_keeps_its_target() {
    let fault = "[[fault]]\nrobot = 2\nat_s = 0\ndown_s = 1\n";
    let (mut engine, _) = scouts(&scenario(TWO, fault));
    engine.step();
    let row = engine.rows().nth(1).expect("robot 2");
    assert_eq!((row.mode, row.target), (Mode::Fault, Cell::new(12, 5)));
    engine.step();
    engine.step();
    let row = engine.rows().nth(1).expect("robot 2");
    assert_eq!((row.mode, row.motion.cell), (Mode::Cruise, Cell::new(6, 3)));
}

#[test]
fn the_formation_error_is_measured_from_the_first_robot_that_is_not_down() {
    let six = "formation = { rows = 2, columns = 3, spacing = [-2, -2], start = [5, 4], goal = [18, 17] }";
    for fault in ["robot = 1\nat_s = 1\n", "robot = 4\nat_s = 1\n"] {
        let scenario = scenario(six, &format!("[[fault]]\n{fault}down_s = 1000\n"));
        let outcome = simulate(&scenario, watch_nothing).expect("free starts");
        let error = outcome.formation.expect("a formation").error_per_agent;
        // Thirteen cells lie between start and goal.
        assert!(error < 2.0, "{error} cells with {fault}");
    }
}

#[test]
fn overlapping_faults_end_together_and_a_fault_without_length_is_a_restart() {
    let faults = "[[fault]]\nrobot = 1\nat_s = 1\ndown_s = 2\n[[fault]]\nrobot = 1\nat_s = 2\ndown_s = 2\n\
                  [[fault]]\nrobot = 2\nat_s = 1\n";
    let (mut engine, _) = scouts(&scenario(TWO, faults));
    let sent: Vec<_> = (0..10).map(|_| engine.step().packets.sent).collect();
    assert_eq!(sent, [2, 2, 1, 1, 1, 1, 1, 1, 2, 2]);
    assert_eq!(engine.computers[0].starts, 1);
    assert_eq!((engine.computers[1].starts, engine.computers[1].clock.epoch), (1, 2));
}

#[test]
fn a_run_ends_when_all_have_arrived() {
    let apart = "list = [{ start = [3, 3], goal = [12, 3] }, { start = [5, 13], goal = [12, 15] }]";
    let scenario = scenario(apart, "");
    let outcome = simulate(&scenario, watch_nothing).expect("free starts");
    assert_eq!(outcome.arrived, 2);
    // Nine cells of one tick each, and the tick in which robot 1 observes its arrival.
    assert_eq!(outcome.ticks, 10);
    assert_eq!(outcome.seconds, 5.0);
    assert_eq!(outcome.arrival_times, [Some(9 * 70), Some(5 * 70 + 2 * 99)]);
    assert_eq!(outcome.collisions, 0);
}

#[test]
fn a_robot_that_starts_at_its_goal_arrives_after_one_tick() {
    let at_goal = "list = [{ start = [4, 4], goal = [4, 4] }]";
    let outcome = simulate(&scenario(at_goal, ""), watch_nothing).expect("free starts");
    assert_eq!((outcome.ticks, outcome.arrived), (1, 1));
    assert_eq!(outcome.arrival_times, [Some(0)]);
}

#[test]
fn a_run_ends_at_its_tick_limit_or_when_the_watcher_breaks() {
    let mut scenario = scenario(TWO, "");
    scenario.ticks = 4;
    let mut seen = Vec::new();
    let outcome = simulate(&scenario, |moment, robots| {
        seen.push((moment.row.tick, robots.count()));
        ControlFlow::Continue(())
    });
    let outcome = outcome.expect("free starts");
    assert_eq!((outcome.ticks, outcome.arrived), (4, 0));
    assert_eq!(seen, [(0, 2), (1, 2), (2, 2), (3, 2), (4, 2)]);
    for enough in [0, 3] {
        let outcome = simulate(&scenario, |moment, _| {
            if moment.row.tick == enough { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert_eq!(outcome.expect("free starts").ticks, enough);
    }
}

#[test]
fn conflicting_starts_are_refused() {
    let mut scenario = scenario(TWO, "");
    scenario.robots[1].start = scenario.robots[0].start;
    assert!(simulate(&scenario, watch_nothing).is_err());
}

#[test]
fn busy_time_is_never_rounded_down_and_never_wraps() {
    let us = |free_at, now, tick_us| grid::busy(free_at, now, tick_us).as_micros();
    assert_eq!(us(70, 70, 1_000_000), 0);
    assert_eq!(us(0, 70, 1_000_000), 0);
    assert_eq!(us(71, 70, 1_000_000), 14_286);
    assert_eq!(us(71, 70, 1), 1);
    assert_eq!(us(255 * 99, 0, 60_000_000), i32::MAX);
}

#[test]
fn a_formation_is_measured_and_arrives() {
    let formation = "formation = { rows = 2, columns = 3, spacing = [-2, -2], start = [5, 5], goal = [16, 15] }";
    let scenario = scenario(formation, "");
    let outcome = simulate(&scenario, watch_nothing).expect("free starts");
    assert_eq!(outcome.arrived, 6);
    let keeping = outcome.formation.expect("a formation");
    assert!(keeping.error_per_agent > 0.0 && keeping.error_per_agent < 3.0, "{keeping:?}");
    assert!(keeping.best_fit_error_per_agent <= keeping.error_per_agent + 1.0);
}

fn trace(scenario: &Scenario, threads: usize) -> (Outcome, Vec<RobotRow>) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("threads").install(|| {
        let mut rows = Vec::new();
        let outcome = simulate(scenario, |_, robots| {
            rows.extend(robots);
            ControlFlow::Continue(())
        });
        (outcome.expect("free starts"), rows)
    })
}

#[test]
fn neither_a_run_nor_its_hash_depends_on_the_number_of_threads() {
    // More robots than a batch, so that several threads take part.
    let mut scenario = scenario("scattered = { count = 300, travel = 8 }", LOSSY);
    scenario.ticks = 40;
    let (one, rows) = trace(&scenario, 1);
    assert!(one.packets.rejected > 0 && one.packets.lost > 0);
    for threads in [2, 8] {
        let (other, other_rows) = trace(&scenario, threads);
        assert_eq!(other.trace_hash, one.trace_hash, "{threads} threads");
        assert_eq!((other.packets, &other.arrival_times, other.ticks), (one.packets, &one.arrival_times, one.ticks));
        let cells =
            |rows: &[RobotRow]| rows.iter().map(|r| (r.id, r.motion.cell, r.mode, r.target)).collect::<Vec<_>>();
        assert_eq!(cells(&other_rows), cells(&rows));
    }
}

#[test]
fn different_seeds_give_different_runs() {
    let mut scenario = scenario(TWO, LOSSY);
    let hash = |scenario: &Scenario| trace(scenario, 1).0.packets;
    let first = hash(&scenario);
    assert_eq!(hash(&scenario), first);
    scenario.seed = 1;
    assert_ne!(hash(&scenario), first);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_radio_and_any_fault_leave_a_sound_run(
        seed: u64,
        loss in 0.0..1.0_f64,
        bit_error_rate in 0.0..0.01_f64,
        jitter_ms in 0.0..3000.0_f64,
        bandwidth in prop::option::of(0..200_u32),
        faults in prop::collection::vec((1..=9_u32, 0.0..20.0_f64, 0.0..20.0_f64), 0..4),
        formation: bool,
    ) {
        let robots = if formation {
            "formation = { rows = 3, columns = 3, spacing = [2, 2], start = [1, 1], goal = [13, 12] }"
        } else {
            "scattered = { count = 9 }"
        };
        let mut rest = format!(
            "[radio]\nrange_m = 20\nloss = {loss}\nbit_error_rate = {bit_error_rate}\njitter_ms = {jitter_ms}\n"
        );
        if let Some(bandwidth) = bandwidth {
            rest += &format!("bandwidth_bytes_per_s = {bandwidth}\n");
        }
        for (robot, at_s, down_s) in faults {
            rest += &format!("[[fault]]\nrobot = {robot}\nat_s = {at_s}\ndown_s = {down_s}\n");
        }
        let mut scenario = scenario(robots, &rest);
        (scenario.seed, scenario.ticks) = (seed, 60);
        let mut last = 0;
        let mut sums = PacketCounts::default();
        let outcome = simulate(&scenario, |moment, robots| {
            sums += moment.row.packets;
            last = robots.count();
            ControlFlow::Continue(())
        }).expect("free starts");
        prop_assert_eq!(last, 9);
        prop_assert_eq!(sums, outcome.packets);
        prop_assert_eq!(outcome.collisions, 0);
        prop_assert!(outcome.packets.delivered >= outcome.packets.damaged);
        prop_assert_eq!(outcome.arrived, outcome.arrival_times.iter().flatten().count());
        prop_assert_eq!(outcome.formation.is_some(), formation);
    }
}

mod attack;
mod clocks;
mod crossing;
mod external;
mod gaps;
mod intervene;
mod intruder;
mod land;
mod operator;
mod own;
mod plane;
mod restarts;
mod round_scenes;
mod safety_scenes;
mod sensing;
mod state;
mod torus;
mod waiting_scenes;

/// A swarm may have a million robots, so the size of one is pinned; rare data is on the heap.
#[test]
fn a_robot_takes_no_more_memory_than_this() {
    let computer = size_of::<OnboardComputer>();
    let parts = [computer, size_of::<HostLaw>(), size_of::<HostSafety>(), size_of::<HostWire>()];
    assert!(parts[0] <= 1280 && parts[1] <= 376 && parts[2] <= 104, "{parts:?}");
}
