use super::*;
use staya_controller::scalar::NumberFormat;
use staya_sim::engine::CheckpointInterval;
use staya_sim::engine::{Moment, Outcome, agents, simulate, simulate_from};
use staya_sim::record::RobotRow;
use staya_sim::scenario::{Movement, Overrides, Scenario};
use staya_sim::world::{Misplaced, MoveRules};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Mutex;

mod own;

fn on_ranks(scenario: &Scenario, ranks: usize, sharing: &Sharing) -> Vec<Result<Ended, RankError>> {
    resume_on(scenario, ranks, sharing, None, &Mutex::default())
}

fn resume_on(
    scenario: &Scenario,
    ranks: usize,
    sharing: &Sharing,
    state: Option<&[u8]>,
    saved: &Mutex<Vec<Vec<u8>>>,
) -> Vec<Result<Ended, RankError>> {
    std::thread::scope(|threads| {
        let ranks: Vec<_> = Threads::connected(ranks)
            .into_iter()
            .map(|mut exchange| {
                let run = move || {
                    let mut watch = |moment: &Moment<'_>, _: &mut dyn Iterator<Item = RobotRow>| {
                        if let Some(run) = moment.run {
                            let mut bytes = Vec::new();
                            run.save(&mut bytes).expect("every robot is on some rank");
                            saved.lock().expect("no thread panicked").push(bytes);
                        }
                        ControlFlow::Continue(())
                    };
                    simulate_on(scenario, agents(scenario), state, &mut exchange, sharing, &mut watch)
                };
                threads.spawn(run)
            })
            .collect();
        ranks.into_iter().map(|rank| rank.join().expect("no rank panics")).collect()
    })
}

fn load(name: &str, ticks: u32) -> Scenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").join(name);
    Scenario::load(&path, &Overrides { seed: None, ticks: Some(ticks) }).expect("a scenario")
}

fn compare(name: &str, scenario: &Scenario, ranks: &[usize]) {
    let alone = simulate(scenario, |_, _| ControlFlow::Continue(())).expect("room");
    for &ranks in ranks.iter().filter(|&&ranks| ranks <= scenario.robots.len()) {
        let sharing = Sharing { every_ticks: 3, above: 1.01, ..Sharing::default() };
        let ended = on_ranks(scenario, ranks, &sharing);
        let first: &Outcome = &ended[0].as_ref().expect("an outcome").outcome;
        assert_eq!(first.trace_hash, alone.trace_hash, "{name} on {ranks} ranks");
        assert_eq!(first, &alone, "{name} on {ranks} ranks");
    }
}

fn every_scenario(ticks: u32, most: usize, ranks: &[usize]) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    for entry in std::fs::read_dir(folder).expect("scenarios").flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if !name.ends_with(".toml") {
            continue;
        }
        let scenario = load(&name, ticks);
        if scenario.robots.len() > most {
            continue;
        }
        eprintln!("{name}");
        if scenario.torus_m().is_some() || scenario.sensing().is_some() {
            let refused = on_ranks(&scenario, 2, &Sharing::default());
            let is_said = |ended: &Result<_, _>| {
                matches!(ended, Err(RankError::Torus { ranks: 2 } | RankError::Sensing { ranks: 2 }))
            };
            assert!(refused.iter().all(is_said), "{name}");
            compare(&name, &scenario, &[1]);
            continue;
        }
        compare(&name, &scenario, ranks);
    }
}

#[test]
fn robots_that_move_at_once_are_refused() {
    let mut scenario = load("corridor.toml", 20);
    scenario.movement = Movement::Cells(MoveRules { simultaneous: true, ..MoveRules::default() });
    let ended = on_ranks(&scenario, 1, &Sharing::default());
    assert!(matches!(ended[..], [Err(RankError::Simultaneous)]));
}

#[test]
fn robots_in_another_number_format_are_refused() {
    let mut scenario = load("corridor.toml", 20);
    scenario.laws.numbers = NumberFormat::Q16;
    let ended = on_ranks(&scenario, 1, &Sharing::default());
    assert!(matches!(ended[..], [Err(RankError::Misplaced(Misplaced::Numbers(NumberFormat::Q16)))]));
}

#[test]
fn every_scenario_has_one_hash_on_any_number_of_ranks() {
    every_scenario(20, 500, &[1, 3]);
}

#[test]
#[ignore = "40 ticks of each scenario on up to 8 ranks: 10 s"]
fn every_scenario_has_one_hash_for_long_on_any_number_of_ranks() {
    every_scenario(40, 2000, &[1, 2, 3, 4, 8]);
}

fn parse(text: &str) -> Scenario {
    Scenario::parse(text, Path::new("here.toml"), &Overrides::default()).expect("a scenario")
}

/// A crowd on the grid with all radio faults, robots that go down, and interventions.
const GRID: &str = "name = 'grid'\nseed = 3\nticks = 60\n[terrain.natural]\nwidth = 40\nheight = 30\nobstacles = 60\n\
    [robots.scattered]\ncount = 260\ntravel = 25\n[radio]\nrange_m = 7\nloss = 0.1\ndelay_ms = 400\njitter_ms = 1500\n\
    duplicate = 0.1\nreorder = 0.1\nreorder_ms = 900\nbit_error_rate = 0.0005\nbandwidth_bytes_per_s = 90\n\
    blackout_s = [[9, 11]]\nburst = { share = 0.2, mean_ms = 3000 }\n\
    [[radio.fault]]\nfrom = [5, 150]\nboth_ways = true\nloss = 0.7\nat_s = 3\nfor_s = 30\n\
    [[fault]]\nrobot = 7\nat_s = 5\ndown_s = 9\n[[fault]]\nrobot = 200\nat_s = 8\ndown_s = 3\n\
    [[intervention]]\nat_s = 6\ndo = { kind = 'cell', cell = [20, 15], class = 0 }\n\
    [[intervention]]\nat_s = 6\ndo = { kind = 'cell', cell = [11, 10], class = 0 }\n\
    [[intervention]]\nat_s = 12\ndo = { kind = 'goal', robot = 100, place_m = [3, 3, 0] }\n\
    [[intervention]]\nat_s = 13\ndo = { kind = 'down', robot = 50, for_s = 4 }\n\
    [[intervention]]\nat_s = 20\ndo = { kind = 'radio', loss = 0.4, range_m = 9 }\n\
    [[intervention]]\nat_s = 25\ndo = { kind = 'goal', place_m = [20, 20, 0] }\n";

/// Crossing discs with radio faults, an intruder and interventions.
const PLANE: &str = "name = 'plane'\nseed = 5\nticks = 80\ntick_s = 0.1\n[radio]\nrange_m = 3\nloss = 0.1\ndelay_ms = 120\n\
    jitter_ms = 150\nduplicate = 0.1\nreorder = 0.1\nbit_error_rate = 0.0005\nbandwidth_bytes_per_s = 500\n\
    [[radio.fault]]\nfrom = [3]\nto = [4, 23, 24]\nat_s = 1\n\
    [plane]\nradius_m = 0.2\nmax_speed_mps = 1\n[plane.robots.circle]\ncount = 40\nradius_m = 5\nnoise_m = 0.1\n\
    [[plane.intruder]]\nstart_m = [-6, 0]\nvelocity_mps = [1, 0]\nradius_m = 0.3\n\
    [[fault]]\nrobot = 7\nat_s = 2\ndown_s = 2\n\
    [[intervention]]\nat_s = 1\ndo = { kind = 'solid', solid = { kind = 'circle', center_m = [1, 1], radius_m = 0.5 } }\n\
    [[intervention]]\nat_s = 2\ndo = { kind = 'goal', robot = 9, place_m = [2, 2, 0] }\n";

/// Robots that decide out of phase and late, with bytes that wait while they move between ranks.
const CLOCKS: &str = "name = 'clocks'\nseed = 5\nticks = 160\ntick_s = 0.02\n\
    [clocks]\nstep_s = 0.1\nphases = 'random'\ndrift_ppm = 20000\nlate = 0.1\nlate_s = 0.2\n\
    [radio]\nrange_m = 3\nloss = 0.1\ndelay_ms = 20\njitter_ms = 60\nduplicate = 0.1\nbit_error_rate = 0.0005\n\
    [plane]\nradius_m = 0.2\nmax_speed_mps = 1\nmax_acceleration_mps2 = 3\nlag_s = 0.1\n\
    [plane.robots.circle]\ncount = 40\nradius_m = 5\nnoise_m = 0.1\n\
    [[plane.intruder]]\nstart_m = [-6, 0]\nvelocity_mps = [1, 0]\nradius_m = 0.3\n\
    [[fault]]\nrobot = 7\nat_s = 1.03\ndown_s = 0.51\n\
    [[plane.order]]\nat_s = 1.13\nplace_m = [2, 1]\n";

/// A changing map of which the robots have an outdated copy.
const CHANGES: &str = "[scouting]\nradius = 9\nunknown = 0.2\nwrong = 0.2\npatch_cells = 3\n[[terrain.change]]\nat_s = 3\nevery_s = 9\n\
    for_s = 5\nclass = 0\nrectangle = { x = 12, y = 5, width = 6, height = 20 }\n\
    [[terrain.change]]\nevery_s = 2\ndrift = { share = 0.05, step = 2 }\n";

const PLANE_CHANGES: &str = "name = 'plane-on-land'\nseed = 5\nticks = 120\ntick_s = 0.1\n[radio]\nrange_m = 4\n\
    [terrain]\nuniform = { width = 20, height = 12, classes = 2 }\n[[terrain.change]]\nat_s = 2\nfor_s = 4\nclass = 0\n\
    rectangle = { x = 7, y = 0, width = 5, height = 11 }\n[scouting]\nunknown = 0.3\nwrong = 0.2\n\
    [plane]\nradius_m = 0.2\nmax_speed_mps = 1\nlaw = 'route'\n[robots.scattered]\ncount = 30\n";

#[test]
fn radio_faults_and_interventions_do_not_depend_on_ranks() {
    let changing = format!("{GRID}{CHANGES}");
    for text in [GRID, PLANE, CLOCKS, &changing, PLANE_CHANGES] {
        compare(text.lines().next().unwrap_or_default(), &parse(text), &[2, 5]);
    }
}

#[test]
fn robots_move_to_the_rank_of_their_position_and_blocks_follow_the_load() {
    let scenario = parse(GRID);
    let often = Sharing { every_ticks: 2, above: 1.0, records: false, ..Sharing::default() };
    let seldom = Sharing { every_ticks: 1000, above: 1e9, records: false, ..Sharing::default() };
    let [often, seldom] = [often, seldom].map(|sharing| {
        let ended = on_ranks(&scenario, 4, &sharing).into_iter().next().expect("four ranks").expect("an outcome");
        (ended.outcome.trace_hash, ended.traffic)
    });
    assert_eq!(often.0, seldom.0);
    let sum = |traffic: &[Traffic], of: fn(&Traffic) -> u64| traffic.iter().map(of).sum::<u64>();
    assert!(sum(&often.1, |t| t.moved_robots) > 50 && sum(&often.1, |t| t.cuts) > 4);
    assert_eq!(sum(&seldom.1, |t| t.moved_robots), 0);
    assert!(sum(&often.1, |t| t.halo) < sum(&seldom.1, |t| t.halo), "robots outside their block cost border traffic");
    assert_eq!(sum(&often.1, |t| t.recorded), sum(&seldom.1, |t| t.recorded), "only arrival times are recorded");
}

#[test]
fn too_many_ranks_and_a_missing_rank_are_errors() {
    let scenario = load("head-on.toml", 20);
    let robots = scenario.robots.len();
    for ended in on_ranks(&scenario, robots + 1, &Sharing::default()) {
        let error = ended.expect_err("too many");
        assert_eq!(
            error.to_string(),
            format!("{} ranks cannot share {robots} robots; start at most {robots} ranks", robots + 1)
        );
    }
    let mut ranks = Threads::connected(2);
    drop(ranks.pop());
    let mut first = ranks.pop().expect("rank 0");
    let mut watch = |_: &Moment<'_>, _: &mut dyn Iterator<Item = RobotRow>| ControlFlow::Continue(());
    let error = simulate_on(&scenario, agents(&scenario), None, &mut first, &Sharing::default(), &mut watch)
        .expect_err("rank 1 is gone");
    assert_eq!(error.to_string(), "rank 1 is gone");
}

#[test]
fn an_invalid_message_is_an_error_with_its_sender() {
    let scenario = load("head-on.toml", 20);
    let mut ranks = Threads::connected(2);
    let mut other = ranks.pop().expect("rank 1");
    let mut first = ranks.pop().expect("rank 0");
    let error = std::thread::scope(|threads| {
        threads.spawn(move || other.gather(vec![0xff; 9]).map(drop));
        let mut watch = |_: &Moment<'_>, _: &mut dyn Iterator<Item = RobotRow>| ControlFlow::Continue(());
        simulate_on(&scenario, agents(&scenario), None, &mut first, &Sharing::default(), &mut watch)
            .expect_err("garbage")
    });
    assert!(error.to_string().starts_with("rank 1 sent a region that cannot be decoded"), "{error}");
}

#[test]
fn a_checkpoint_continues_identically_on_any_number_of_ranks() {
    let scenarios = [
        parse(GRID),
        parse(PLANE),
        parse(CLOCKS),
        load("insider.toml", 60),
        load("revoked.toml", 60),
        load("six-robots.toml", 60),
        load("groups.toml", 60),
    ];
    for scenario in scenarios {
        let alone = simulate(&scenario, |_, _| ControlFlow::Continue(())).expect("room");
        let sharing =
            Sharing { every_ticks: 4, checkpoints: Some(CheckpointInterval::Ticks(25)), ..Sharing::default() };
        let saved = Mutex::default();
        let ended = resume_on(&scenario, 3, &sharing, None, &saved);
        assert_eq!(ended[0].as_ref().expect("an outcome").outcome, alone, "{}", scenario.name);
        let saved = saved.into_inner().expect("no thread panicked");
        assert_eq!(saved.len() as u32, alone.ticks / 25, "{}", scenario.name);
        for state in &saved[..2] {
            let here = simulate_from(&scenario, state, &mut |_, _| ControlFlow::Continue(()))
                .expect("the checkpoint is valid");
            assert_eq!(here, alone, "{} by one process", scenario.name);
            for ranks in [1, 4] {
                let ended = resume_on(&scenario, ranks, &Sharing::default(), Some(state), &Mutex::default());
                let outcome = &ended[0].as_ref().expect("an outcome").outcome;
                assert_eq!(outcome, &alone, "{} on {ranks} ranks", scenario.name);
            }
        }
        let mut cut = saved[1].clone();
        cut.truncate(cut.len() / 2);
        for ended in resume_on(&scenario, 2, &Sharing::default(), Some(&cut), &Mutex::default()) {
            let error = ended.expect_err("half a checkpoint").to_string();
            assert!(error.starts_with("byte ") && error.contains("cut off"), "{error}");
        }
    }
}
