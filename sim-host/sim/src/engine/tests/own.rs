use super::*;
use crate::engine::{StartError, simulate};
use crate::scenario::{Movement, Overrides};
use crate::world::MoveRules;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{
    Action, BadInput, Decision, InAny, InPlane, Law, OnGrid, Progress, Protocol, Radio, Report, Tools, View,
    WaypointGuidance,
};
use staya_controller::grid::Dir;
use staya_controller::robot::RobotId;
use staya_controller::wire::{Format, Never, ProtocolId};
use std::path::Path;

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Highest(u32);

#[derive(Clone, Debug)]
enum Numbers {}

impl Protocol for Numbers {
    const ID: ProtocolId = ProtocolId(64);
    type Payload = u32;
    type Message = Never;
    type Order = Never;
}

impl InAny for Numbers {}

impl Law<f32> for Highest {
    type Surroundings<'a> = InPlane<'a, f32>;
    type Protocol = Numbers;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, f32, Numbers>,
        _: &InPlane<'_, f32>,
        _: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        let heard = view.peers().map(|(_, number)| number);
        self.0 = heard.fold(self.0.max(view.id.0), u32::max);
        Ok(Decision::new(Action::Stay, Progress::at_goal(self.0 == ROBOTS)))
    }

    fn payload(&mut self, _: &InPlane<'_, f32>, _: Dir, _: &mut Radio<'_, Numbers>) -> u32 {
        self.0
    }

    /// The leader field also shows the number, so that record rows contain it.
    fn report(&self) -> Report {
        Report { leader: RobotId(self.0), ..Report::default() }
    }
}

const ROBOTS: u32 = 9;

fn line(rest: &str) -> Scenario {
    let robots: Vec<_> = (0..ROBOTS).map(|i| format!("{{ start_m = [{i}, 0], goal_m = [{i}, 0] }}")).collect();
    let text = format!(
        "name = \"line\"\nseed = 3\nticks = 60\ntick_s = 0.1\n[radio]\nrange_m = 1.5\n{rest}\n[plane]\nradius_m = 0.1\n\
         max_speed_mps = 1.0\n[plane.robots]\nlist = [{}]\n",
        robots.join(", ")
    );
    Scenario::parse(&text, Path::new("line.toml"), &Overrides::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn run(scenario: &Scenario) -> Outcome {
    simulate_own(scenario, |_| Highest::default(), |_, _| ControlFlow::Continue(())).unwrap()
}

#[test]
fn payloads_spread_from_robot_to_robot_in_all_formats() {
    let passphrase = "[authentication]\nkey = \"passphrase: swarm\"\n";
    for (rest, format) in [
        (String::new(), Format::Postcard),
        ("format = \"mavlink\"".into(), Format::Mavlink),
        (passphrase.into(), Format::Postcard),
        (format!("format = \"mavlink\"\n{passphrase}"), Format::Mavlink),
    ] {
        let scenario = line(&rest);
        assert_eq!(scenario.radio.format, format);
        let outcome = run(&scenario);
        assert_eq!((outcome.arrived, outcome.packets.rejected), (ROBOTS as usize, 0), "{rest}");
    }
}

#[test]
fn lost_payloads_are_repeated() {
    let outcome = run(&line("loss = 0.5"));
    assert_eq!(outcome.arrived, ROBOTS as usize);
}

#[test]
fn a_built_in_law_given_by_the_caller_gives_the_identical_run() {
    let scenario = line("");
    let ours = simulate(&scenario, |_, _| ControlFlow::Continue(())).unwrap();
    let setup = scenario.plane().cloned().unwrap();
    let [speed_mps, tolerance_m] = [setup.general.cruise_mps, setup.general.tolerance_m].map(|x| x as f32);
    let law = move |_| WaypointGuidance::new(speed_mps, tolerance_m);
    let own = simulate_own(&scenario, law, |_, _| ControlFlow::Continue(())).unwrap();
    assert_eq!(own.clearance, ours.clearance);
    assert_eq!((own.arrived, own.packets), (ours.arrived, ours.packets));
}

#[test]
fn a_run_resumed_from_a_checkpoint_ends_identically() {
    let scenario = line("loss = 0.3");
    let whole = run(&scenario);
    let mut bytes = Vec::new();
    let until_five = |moment: &Moment<'_>, _: &mut dyn Iterator<Item = RobotRow>| {
        if moment.row.tick < 5 {
            return ControlFlow::Continue(());
        }
        moment.run.unwrap().save(&mut bytes).unwrap();
        ControlFlow::Break(())
    };
    let _ = simulate_own(&scenario, |_| Highest::default(), until_five).unwrap();
    let agents = own_agents(&scenario, |_| Highest::default()).unwrap();
    let engine = Engine::new(&scenario, agents).unwrap();
    let again = engine.resume(&bytes, scenario.ticks, &mut |_, _| ControlFlow::Continue(())).unwrap();
    assert_eq!(again, whole);
}

#[test]
fn a_scenario_of_the_grid_is_refused() {
    let scenario = Scenario { movement: Movement::Cells(MoveRules::default()), ..line("") };
    let refused = simulate_own(&scenario, |_| Highest::default(), |_, _| ControlFlow::Continue(()));
    assert_eq!(refused.err(), Some(StartError::World(WrongWorld::Grid)));
    assert!(WrongWorld::Grid.to_string().contains("give it one"));
}

/// Moves east, and knows the robots that it hears.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct East(u32);

impl Law<f32> for East {
    type Surroundings<'a> = OnGrid<'a>;
    type Protocol = Numbers;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, f32, Numbers>,
        here: &OnGrid<'_>,
        _: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        let (cell, _) = here.seen()?;
        let heard = view.peers().map(|(_, number)| number);
        self.0 = heard.fold(self.0.max(view.id.0), u32::max);
        let action = Action::Moves([Dir::East].into_iter().collect());
        Ok(Decision::new(action, Progress::at_goal(cell.x >= 9)))
    }

    fn payload(&mut self, _: &OnGrid<'_>, _: Dir, _: &mut Radio<'_, Numbers>) -> u32 {
        self.0
    }

    fn report(&self) -> Report {
        Report { leader: RobotId(self.0), ..Report::default() }
    }
}

#[test]
fn a_law_of_the_grid_runs_on_the_grid_and_nowhere_else() {
    let text = "name = \"t\"\nticks = 40\ntick_s = 1\n[terrain]\nuniform = { width = 12, height = 4, classes = 1 }\n\
        [robots]\nlist = [{ start = [1, 1], goal = [9, 1] }, { start = [1, 3], goal = [9, 3] }]\n";
    let scenario = Scenario::parse(text, Path::new("t.toml"), &Overrides::default()).unwrap();
    let mut leaders = Vec::new();
    let outcome = simulate_own(
        &scenario,
        |_| East::default(),
        |_, rows| {
            leaders = rows.map(|row| row.leader).collect();
            ControlFlow::Continue(())
        },
    );
    assert_eq!(outcome.unwrap().arrived, 2);
    assert_eq!(leaders, [2; 2], "each has heard the other");
    let refused = simulate_own(&line(""), |_| East::default(), |_, _| ControlFlow::Continue(()));
    assert_eq!(refused.err(), Some(StartError::World(WrongWorld::Plane)));
}
