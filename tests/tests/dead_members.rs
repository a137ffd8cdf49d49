//! Formations with failed robots: the others arrive, whichever robots fail.

use staya_controller::agent::LawSettings;
use staya_controller::robot::{Mode, RobotId};
use staya_sim::scenario::{Fault, LawSetup, Scenario};
use staya_tests::{run, scenario};

fn without(name: &str, seed: u64, dead: &[(u32, u32)], ticks: u32) -> Scenario {
    let mut scenario = scenario(name, Some(ticks));
    scenario.seed = seed;
    let faults = dead.iter().map(|&(robot, from_tick)| Fault { robot: RobotId(robot), from_tick, to_tick: ticks });
    scenario.events.faults.extend(faults);
    scenario
}

fn missing(scenario: &Scenario, dead: &[(u32, u32)]) -> Vec<usize> {
    let (_, rows) = run(scenario);
    let (_, robots) = rows.last().expect("at least the start");
    let is_dead = |index: usize| dead.iter().any(|(robot, _)| *robot as usize == index + 1);
    let late = (0..robots.len()).filter(|&index| !is_dead(index) && robots[index].mode != Mode::Arrived);
    late.map(|index| index + 1).collect()
}

#[test]
fn six_robots_arrive_without_any_one_or_two_of_them() {
    assert_eq!(scenario("figure-5", None).robots.len(), 6);
    for first in 1..=6_u32 {
        for second in first..=6 {
            let dead = [(first, 10), (second, 25)];
            let dead = if first == second { &dead[..1] } else { &dead[..] };
            let scenario = without("figure-5", 1, dead, 300);
            assert_eq!(missing(&scenario, dead), [0_usize; 0], "without {dead:?}");
        }
    }
}

#[test]
fn six_robots_with_a_bad_radio_arrive_without_any_one_of_them() {
    for robot in 1..=6 {
        let dead = [(robot, 100)];
        let scenario = without("six-robots", 1, &dead, 1500);
        assert_eq!(missing(&scenario, &dead), [0_usize; 0], "without {robot}");
    }
}

#[test]
fn ranks_close_the_gap_of_a_dead_robot() {
    for robot in 1..=6_usize {
        let dead = [(robot as u32, 10)];
        let mut scenario = without("figure-5", 1, &dead, 300);
        let goals: Vec<_> = scenario.robots.iter().map(|robot| robot.goal).collect();
        let mut ends = [false, true].map(|closes_ranks| {
            let LawSetup::BuiltIn(LawSettings::Formation(law)) = &mut scenario.laws.on_grid else {
                panic!("a formation")
            };
            law.params.closes_ranks = closes_ranks;
            assert_eq!(missing(&scenario, &dead), [0_usize; 0], "without {robot}");
            let (_, rows) = run(&scenario);
            let (_, robots) = rows.last().expect("at least the start").clone();
            let living = (0..robots.len()).filter(|index| index + 1 != robot);
            let place = |cell| goals.iter().position(|&goal| goal == cell);
            living.filter_map(|index| place(robots[index].motion.cell)).collect::<Vec<_>>()
        });
        ends.iter_mut().for_each(|places| places.sort_unstable());
        let [kept, closed] = ends;
        assert_eq!(kept, (0..6).filter(|place| place + 1 != robot).collect::<Vec<_>>(), "without {robot}");
        assert!(closed.len() == 5 && closed[..3] == [0, 1, 2], "without {robot}: {closed:?}");
    }
}
