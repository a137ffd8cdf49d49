//! Robots that decide out of phase, with slow clocks, and late.

use super::*;
use crate::world::plane::CommandAge;

/// A step of ten ticks of 0.01 s.
const STEP: &str = "step_s = 0.1\n";
const STEP_TICKS: u32 = 10;

fn parse(text: &str) -> Scenario {
    let scenario = Scenario::parse(text, Path::new("t.toml"), &Overrides::default());
    scenario.unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn with_clocks(clocks: &str, plane: &str) -> Scenario {
    parse(&format!(
        "name = \"t\"\nseed = 3\nticks = 2000\ntick_s = 0.01\n[clocks]\n{clocks}\n\
         [plane]\nradius_m = 0.2\nmax_speed_mps = 1\n{plane}\n"
    ))
}

const ALONE: &str = "safety = \"none\"\n[plane.robots]\nlist = [{ start_m = [0, 0], goal_m = [50, 0] }]\n";
const PAIR: &str =
    "[plane.robots]\nlist = [{ start_m = [0, 0], goal_m = [9, 0] }, { start_m = [3, 2], phase_s = 0.05 }]\n";
const CIRCLE: &str = "[plane.robots.circle]\ncount = 12\nradius_m = 4\nnoise_m = 0.01\n";
/// All that waits in a computer, and all that restarts one.
const BUSY: &str = "[plane.robots.circle]\ncount = 12\nradius_m = 4\nnoise_m = 0.01\n\
     [[plane.order]]\nat_s = 1.03\nplace_m = [2, 1]\n[[plane.intruder]]\nstart_m = [9, 9]\nvelocity_mps = [-1, -1]\nradius_m = 0.3\n\
     [radio]\nrange_m = 7\nloss = 0.1\ndelay_ms = 24\njitter_ms = 90\nduplicate = 0.1\nreorder = 0.1\nbit_error_rate = 0.0005\n\
     [[fault]]\nrobot = 3\nat_s = 0.77\ndown_s = 0.5\n[[fault]]\nrobot = 5\nat_s = 0.93\n\
     [[intervention]]\nat_s = 0.68\ndo = { kind = \"down\", robot = 7, for_s = 0.41 }\n\
     [[attack]]\nkind = \"replay\"\nplace_m = [1, 1]\ndelay_s = 0.2\n";
const ALL: &str = "step_s = 0.1\nphases = \"random\"\ndrift_ppm = 20000\nlate = 0.1\nlate_s = 0.25\n";

fn engine(scenario: &Scenario) -> Engine {
    Engine::new(scenario, agents(scenario)).expect("robots in the plane are placed")
}

fn steps(engine: &mut Engine, ticks: u32) {
    for _ in 0..ticks {
        engine.step();
    }
}

/// Ticks in which each robot decides.
fn decisions(scenario: &Scenario, ticks: u32) -> Vec<Vec<u32>> {
    let mut engine = engine(scenario);
    let mut decisions = vec![Vec::new(); scenario.robots.len()];
    for tick in 0..ticks {
        engine.step();
        for (decisions, age) in decisions.iter_mut().zip(&engine.ages) {
            decisions.extend((*age == CommandAge::New).then_some(tick));
        }
    }
    decisions
}

fn gaps(decisions: &[u32]) -> Vec<u32> {
    decisions.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

#[test]
fn clocks_of_one_tick_without_errors_change_nothing() {
    let text = |clocks: &str| {
        format!("name = \"t\"\nticks = 80\ntick_s = 0.1\n{clocks}[plane]\nradius_m = 0.2\nmax_speed_mps = 1\n{CIRCLE}")
    };
    let without = trace(&parse(&text("")), 1).0;
    for clocks in ["[clocks]\n", "[clocks]\nstep_s = 0.1\n", "[clocks]\nphases = \"equal\"\ndrift_ppm = 0\n"] {
        assert_eq!(trace(&parse(&text(clocks)), 1).0, without, "{clocks}");
    }
}

#[test]
fn robots_in_step_decide_once_in_a_step() {
    for robot in decisions(&with_clocks(STEP, CIRCLE), 50) {
        assert_eq!(robot, [0, 10, 20, 30, 40]);
    }
}

#[test]
fn random_phases_spread_the_decisions_over_a_step() {
    let robots = CIRCLE.replace("12", "200").replace('4', "40");
    let mut count = [0; STEP_TICKS as usize];
    let scenario = with_clocks("step_s = 0.1\nphases = \"random\"\n", &robots);
    for robot in decisions(&scenario, 40) {
        assert!(robot[0] < STEP_TICKS && gaps(&robot).iter().all(|&gap| gap == STEP_TICKS), "{robot:?}");
        count[robot[0] as usize] += 1;
    }
    assert!(count.iter().all(|&count| (5..40).contains(&count)), "{count:?}");
    let other = Scenario { seed: 4, ..scenario.clone() };
    assert_ne!(decisions(&other, 10), decisions(&scenario, 10));
}

#[test]
fn a_robot_with_a_phase_of_its_own_decides_then() {
    let [one, two] = &decisions(&with_clocks(STEP, PAIR), 30)[..] else { panic!("two robots") };
    assert_eq!((&one[..], &two[..]), (&[0, 10, 20][..], &[5, 15, 25][..]));
}

#[test]
fn a_robot_sends_one_beacon_in_each_step_of_its_own_clock() {
    for clocks in [STEP, ALL, "step_s = 0.1\ndrift_ppm = 100000\n", "step_s = 0.01\nlate = 0.5\nlate_s = 0.02\n"] {
        // None hears another one, or it would tell of it behind some beacons.
        let far = CIRCLE.replace("radius_m = 4", "radius_m = 400");
        let scenario = with_clocks(&format!("{clocks}[radio]\nrange_m = 100\n"), &far);
        let sent: u64 = {
            let mut engine = engine(&scenario);
            (0..700).map(|_| engine.step().packets.sent).sum()
        };
        let decisions: usize = decisions(&scenario, 700).iter().map(Vec::len).sum();
        assert_eq!(sent, decisions as u64, "{clocks}");
    }
}

#[test]
fn a_robot_takes_at_its_decision_what_arrived_since_the_last_one() {
    let mut engine = engine(&with_clocks(STEP, PAIR));
    let neighbors = |engine: &Engine| [0, 1].map(|index| engine.observation(index).neighbors);
    // Robot 1 sends in tick 0. The beacon is in the other's computer from tick 1 on.
    for tick in 0..5 {
        engine.step();
        assert_eq!(neighbors(&engine), [0, 0], "tick {tick}");
        assert_eq!(engine.computers[1].mail.is_empty(), tick < 1, "tick {tick}");
    }
    engine.step();
    assert_eq!(neighbors(&engine), [0, 1]);
    assert!(engine.computers[1].mail.is_empty());
    steps(&mut engine, 5);
    assert_eq!(neighbors(&engine), [1, 1]);
    assert_eq!(engine.packets.delivered, 5, "two of robot 1, one of robot 2, and a told state of each");
    assert_eq!(engine.packets.rejected, 0);
}

#[test]
fn a_restart_clears_what_waits() {
    let fault = "[[fault]]\nrobot = 2\nat_s = 0.03\ndown_s = 0.01\n";
    let mut engine = engine(&with_clocks(STEP, &format!("{PAIR}{fault}")));
    steps(&mut engine, 4);
    assert!(engine.computers[1].mail.is_empty());
    engine.step();
    let ages = [&engine.ages[0], &engine.ages[1]];
    assert_eq!(ages, [&CommandAge::Kept, &CommandAge::New], "it decides as soon as it has started");
    assert_eq!(engine.observation(1).neighbors, 0);
}

#[test]
fn an_order_reaches_robots_that_are_not_due() {
    let order = "[[plane.order]]\nat_s = 0.23\nplace_m = [0, 4]\n";
    let robots = "safety = \"none\"\n[plane.robots]\nlist = [{ start_m = [0, 0], goal_m = [4, 0] }]\n";
    let (outcome, rows) = {
        let mut rows = Vec::new();
        let outcome = simulate(&with_clocks(STEP, &format!("{robots}{order}")), |_, robots| {
            rows.push(robots.next().expect("a robot").motion);
            ControlFlow::Continue(())
        });
        (outcome.expect("placed"), rows)
    };
    assert_eq!(outcome.arrived, 1);
    // It takes the order in tick 30.
    assert!((rows[30].position_m[0] - 0.3).abs() < 1e-5 && rows[30].position_m[1] == 0.0, "{:?}", rows[30]);
    assert!(rows[31].velocity_mps[1] > 0.9, "{:?}", rows[31]);
}

#[test]
fn a_body_follows_its_last_command_for_a_step_and_then_stands() {
    let scenario = with_clocks("step_s = 0.1\nlate = 0.5\nlate_s = 0.25\n", ALONE);
    let mut engine = engine(&scenario);
    let (mut decided, mut stood, mut longest) = (0, 0, 0);
    for tick in 0..1500_u32 {
        engine.step();
        if engine.ages[0] == CommandAge::New {
            longest = longest.max(tick - decided);
            decided = tick;
        }
        let Motion { velocity_mps: [speed_mps, ..], .. } = engine.ground.motion(0, tick);
        let is_old = tick - decided >= STEP_TICKS;
        assert_eq!(engine.commands[0] == Command::Hold, is_old, "tick {tick}");
        assert!((speed_mps - if is_old { 0.0 } else { 1.0 }).abs() < 1e-6, "tick {tick}: {speed_mps}");
        stood += u32::from(is_old);
    }
    assert_eq!(longest, 35, "a step and the longest delay");
    assert!(stood > 300, "{stood}");
    let [x_m, ..] = engine.ground.motion(0, 1500).position_m;
    assert!((x_m - f64::from(1500 - stood) * 0.01).abs() < 1e-5, "{x_m}");
}

#[test]
fn a_late_body_with_inertia_brakes_within_its_acceleration() {
    for lag in ["", "lag_s = 0.2\n"] {
        let robots = ALONE.replace("safety", &format!("max_acceleration_mps2 = 2\n{lag}safety"));
        let mut engine = engine(&with_clocks("step_s = 0.1\nlate = 0.5\nlate_s = 0.5\n", &robots));
        let speed = |engine: &Engine| engine.ground.motion(0, 0).velocity_mps[0];
        let mut braked = 0;
        for tick in 0..1500 {
            let before_mps = speed(&engine);
            engine.step();
            let change_mps = speed(&engine) - before_mps;
            let most_mps = match engine.ages[0] {
                CommandAge::New => 2.0 * 0.1,
                CommandAge::Kept if lag.is_empty() => 0.0,
                CommandAge::Kept => 2.0 * 0.1,
                CommandAge::Expired => 2.0 * 0.01,
            };
            assert!(change_mps.abs() <= most_mps + 1e-6, "tick {tick}: {change_mps} m/s, {lag}");
            if engine.ages[0] == CommandAge::Expired && before_mps > 1e-3 {
                assert!(change_mps < 0.0, "tick {tick}: {change_mps} m/s");
                braked += 1;
            }
        }
        assert!(braked > 100, "{braked}");
    }
}

/// The same robots with ticks of 0.1 s, and with ticks of 0.01 s and steps of 0.1 s.
#[test]
fn finer_ticks_change_no_motion() {
    for body in ["", "max_acceleration_mps2 = 1.5\n", "max_acceleration_mps2 = 1.5\nlag_s = 0.3\n"] {
        let plane = format!("[plane]\nradius_m = 0.2\nmax_speed_mps = 1\n{body}{CIRCLE}");
        let coarse = parse(&format!("name = \"t\"\nticks = 100\ntick_s = 0.1\n{plane}"));
        let fine = parse(&format!("name = \"t\"\nticks = 1000\ntick_s = 0.01\n[clocks]\n{STEP}{plane}"));
        let (mut coarse, mut fine) = (engine(&coarse), engine(&fine));
        for step in 0..40 {
            coarse.step();
            steps(&mut fine, STEP_TICKS);
            for index in 0..12 {
                let [one, other] = [&coarse, &fine].map(|engine| engine.ground.motion(index, 0));
                let off_m =
                    (0..2).map(|axis| (one.position_m[axis] - other.position_m[axis]).abs()).fold(0.0, f64::max);
                assert!(off_m < 0.005, "robot {index} in step {step}: {off_m} m, {body}");
            }
        }
    }
}

#[test]
fn sensors_are_used_at_decisions() {
    let robots = |sensing: &str| format!("{PAIR}[plane.sensing]\nrange_m = 20\nbeacons = false\n{sensing}");
    for (sensing, uses) in [("", [20, 20]), ("every_ticks = 7\n", [19, 20]), ("every_ticks = 40\n", [4, 4])] {
        let mut engine = engine(&with_clocks(STEP, &robots(sensing)));
        let mut used = [0; 2];
        for tick in 0..200 {
            for index in [0, 1] {
                let clock = engine.computers[index].clock;
                let mut seen = Vec::new();
                engine.ground.sightings(index, tick, clock.since(tick), &mut seen);
                used[index] += usize::from(clock.is_due(tick) && !seen.is_empty());
            }
            engine.step();
        }
        assert_eq!(used, uses, "{sensing}");
        assert_eq!([0, 1].map(|index| engine.observation(index).neighbors), [1, 1], "{sensing}");
    }
}

#[test]
fn neither_threads_nor_a_saved_state_change_a_run_out_of_phase() {
    let mut scenario = with_clocks(ALL, BUSY);
    scenario.ticks = 300;
    let (one, rows) = trace(&scenario, 1);
    assert!(one.packets.lost > 0 && one.packets.rejected > 0);
    let (four, four_rows) = trace(&scenario, 4);
    assert_eq!(four, one);
    let places = |rows: &[RobotRow]| rows.iter().map(|row| row.motion.position_m).collect::<Vec<_>>();
    assert_eq!(places(&four_rows), places(&rows));
    for saved_at in [3, 78, 94, 101, 104, 111, 160] {
        let mut whole = engine(&scenario);
        steps(&mut whole, saved_at);
        let mut bytes = Vec::new();
        whole.save(&mut bytes).expect("all robots are here");
        let outcome = simulate_from(&scenario, &bytes, &mut watch_nothing).expect("its own state");
        assert_eq!(outcome, one, "saved at {saved_at}");
    }
}

#[test]
fn inspection_changes_nothing_at_any_tick() {
    let scenario = with_clocks(ALL, BUSY);
    let (mut one, mut other) = (engine(&scenario), engine(&scenario));
    for _ in 0..150 {
        one.step();
        other.step();
        for index in 0..12 {
            let inspection = other.inspect(index);
            assert!(inspection.known.iter().all(|known| known.age_s >= 0.0));
        }
    }
    assert_eq!(one.outcome(), other.outcome());
}

#[test]
fn robots_out_of_phase_do_not_collide() {
    for clocks in ["step_s = 0.1\nphases = \"random\"\n", ALL] {
        for body in ["", "max_acceleration_mps2 = 2\n"] {
            let scenario = with_clocks(clocks, &format!("{body}{CIRCLE}"));
            let outcome = simulate(&scenario, watch_nothing).expect("placed");
            assert_eq!(outcome.collisions, 0, "{clocks}{body}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn no_robot_decides_earlier_than_a_step_after_its_last_decision(
        seed: u64, step_ticks in 1_u32..20, drift_ppm in 0_u32..100_000, late in 0.0..1.0, late_ticks in 1_u32..40,
    ) {
        let late = if late < 0.5 { String::new() } else {
            format!("late = {late}\nlate_s = {}\n", f64::from(late_ticks) * 0.01)
        };
        let step_s = f64::from(step_ticks) * 0.01;
        let mut scenario = with_clocks(&format!("step_s = {step_s}\ndrift_ppm = {drift_ppm}\n{late}"), CIRCLE);
        scenario.seed = seed;
        for robot in decisions(&scenario, 300) {
            let most = step_ticks + if late.is_empty() { 0 } else { late_ticks };
            // A slow clock adds its rate, and the rest of a tick.
            let most = most + most * drift_ppm / 1_000_000 + 1;
            let gaps = gaps(&robot);
            prop_assert!(gaps.iter().all(|gap| (step_ticks..=most).contains(gap)), "{gaps:?}");
        }
    }
}

#[test]
fn a_slow_clock_slips_by_a_tick_now_and_then() {
    let robots = decisions(&with_clocks("step_s = 0.1\ndrift_ppm = 20000\n", CIRCLE), 2000);
    let slips: Vec<usize> =
        robots.iter().map(|robot| gaps(robot).iter().filter(|&&gap| gap > STEP_TICKS).count()).collect();
    // Up to 2 % of 200 steps of ten ticks.
    assert!(slips.iter().all(|&slips| slips <= 40) && slips.iter().sum::<usize>() > 100, "{slips:?}");
    assert!(robots.iter().flat_map(|robot| gaps(robot)).all(|gap| gap == STEP_TICKS || gap == STEP_TICKS + 1));
}
