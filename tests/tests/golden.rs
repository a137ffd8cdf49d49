//! Golden tables of scenarios; `cargo xtask bless golden` rewrites them.

use staya_controller::robot::Mode;
use staya_fvm::orca::Sample;
use staya_sim::engine::Outcome;
use staya_sim::metrics::waits::WaitCount;
use staya_sim::record::{RobotRow, TickRow};
use staya_sim::scenario::Scenario;
use staya_tests::{gaps, golden, run, scenario};
use std::fmt::Write as _;

const SHOWN: usize = 6;

fn table(scenario: &Scenario, outcome: &Outcome, rows: &[(TickRow, Vec<RobotRow>)]) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    let packets = outcome.packets;
    writeln!(text, "scenario   {}, seed {}", scenario.name, scenario.seed)?;
    writeln!(text, "ticks      {} of {}", outcome.ticks, scenario.ticks)?;
    let robots = scenario.robots.len();
    writeln!(text, "arrived    {} of {robots}", outcome.arrived)?;
    writeln!(text, "collisions {}", outcome.collisions)?;
    if let Some(clearance) = outcome.clearance.filter(|clearance| clearance.intruders_m.is_finite()) {
        writeln!(text, "intruders  {} overlaps", clearance.intruder_overlaps)?;
    }
    if scenario.plane().is_some_and(|plane| plane.kinds().any(|group| group.downwash() > 1.0)) {
        let washed = outcome.clearance.map_or(0, |clearance| clearance.washed);
        writeln!(text, "downwash   {washed} in that of others")?;
    }
    writeln!(
        text,
        "packets    sent {}, delivered {}, lost {}, damaged {}, rejected {}",
        packets.sent, packets.delivered, packets.lost, packets.damaged, packets.rejected
    )?;
    for count in &outcome.waits {
        let WaitCount { wait, robots, now, robot_ticks, longest_ticks } = count;
        writeln!(text, "wait       {wait}: {robots} robots, {robot_ticks} ticks, at most {longest_ticks}, {now} now")?;
    }
    if let Some(keeping) = outcome.formation {
        writeln!(
            text,
            "formation  error {:.4} cells per robot, {:.4} by best fit, graph distance {:.4}",
            keeping.error_per_agent, keeping.best_fit_error_per_agent, keeping.graph_distance
        )?;
    }
    writeln!(text, "hash       {:016x}\n", outcome.trace_hash)?;

    writeln!(
        text,
        " tick arrived  delivered  error  graph  first robots: {}, mode",
        if scenario.plane().is_some() { "place (m)" } else { "cell" }
    )?;
    let every = (outcome.ticks / 24).max(1);
    let last = rows.len() - 1;
    for (index, (row, robots)) in rows.iter().enumerate() {
        if !row.tick.is_multiple_of(every) && index != last {
            continue;
        }
        let is_there = |r: &&RobotRow| match scenario.plane() {
            Some(_) => r.mode == Mode::Arrived,
            None => r.motion.cell == r.target,
        };
        let there = robots.iter().filter(is_there).count();
        write!(
            text,
            "{:5} {there:7} {:10} {:6.2} {:6.2} ",
            row.tick, row.packets.delivered, row.formation_error_per_agent, row.graph_distance
        )?;
        for robot in &robots[..robots.len().min(SHOWN)] {
            let mode = format!("{:?}", robot.mode).to_lowercase();
            let [x, y, _] = robot.motion.position_m;
            if scenario.plane().is_some() {
                write!(text, " {x:8.3},{y:<8.3} {mode:<7}")?;
                continue;
            }
            write!(text, " {:3},{:<3} {mode:<7}", robot.motion.cell.x, robot.motion.cell.y)?;
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
    }
    Ok(text)
}

fn check(name: &str, ticks: Option<u32>) {
    let scenario = scenario(name, ticks);
    let (outcome, rows) = run(&scenario);
    let table = table(&scenario, &outcome, &rows).expect("memory takes every line");
    golden(name, &table, &gaps(&scenario, &outcome));
}

#[test]
fn golden_six_robots() {
    check("six-robots", None);
}

#[test]
fn golden_ten_robots() {
    check("ten-robots", None);
}

#[test]
fn golden_figure_5() {
    check("figure-5", None);
}

#[test]
fn golden_figure_6() {
    check("figure-6", None);
}

#[test]
fn golden_gate() {
    check("gate", None);
}

#[test]
fn golden_corridor() {
    check("corridor", None);
}

#[test]
fn golden_office() {
    check("office", None);
}

#[test]
fn golden_crossing() {
    check("crossing", None);
}

#[test]
fn golden_moving_ai_20() {
    check("moving-ai-20", None);
}

#[test]
fn golden_blackout() {
    check("blackout", None);
}

#[test]
fn golden_scale_small() {
    check("scale-small", None);
}

#[test]
fn golden_scale_in_its_first_ticks() {
    check("scale", Some(3));
}

#[test]
fn golden_orca_table() {
    let sample = Sample { pairs: 20_000, seed: 1 };
    golden("orca-table", &sample.report().to_string(), &[]);
}

#[test]
fn golden_swap_circle() {
    check("swap-circle", None);
}

#[test]
fn golden_downwash() {
    check("downwash", None);
}

#[test]
fn golden_mixed() {
    check("mixed", None);
}

#[test]
fn golden_one_place() {
    check("one-place", None);
}

#[test]
fn golden_doorway() {
    check("doorway", None);
}

#[test]
fn golden_flock_squeeze() {
    check("flock-squeeze", None);
}

#[test]
fn golden_same_number() {
    check("same-number", None);
}

#[test]
fn golden_two_flocks() {
    check("two-flocks", None);
}

#[test]
fn golden_goal_flock() {
    check("goal-flock", None);
}

#[test]
fn golden_boids() {
    check("boids", None);
}

#[test]
fn golden_six_discs() {
    check("six-discs", None);
}

#[test]
fn golden_twenty_discs() {
    check("twenty-discs", None);
}

#[test]
fn golden_out_of_phase() {
    check("out-of-phase", None);
}
