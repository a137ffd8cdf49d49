use super::*;
use crate::engine::{Decision, ExternalController, Status, simulate_with};
use staya_controller::agent::{
    AnyAgent, AnyInputs, CELLS, GridWorkspace, HALF_PLANES, LEARNED, NEIGHBORS, Setup, Task, VISITS,
};
use staya_controller::wire::Postcard;

type Remote = AnyAgent<f32, CELLS, VISITS, NEIGHBORS, HALF_PLANES, Postcard, LEARNED>;

/// Agents in the same process behind the external interface. The agent of robot `restarts.0` loses
/// its state before tick `restarts.1` and is absent for three ticks.
struct Nearby {
    agents: Vec<(usize, Option<Remote>, Option<Decision>)>,
    restarts: Option<(usize, u32)>,
    boots: Arc<Mutex<Vec<(usize, u8)>>>,
    workspace: GridWorkspace<CELLS>,
    tick: u32,
}

impl Nearby {
    fn of(robots: &[usize]) -> Self {
        Self {
            agents: robots.iter().map(|&index| (index, None, None)).collect(),
            restarts: None,
            boots: Arc::default(),
            workspace: GridWorkspace::new(),
            tick: 0,
        }
    }

    fn slot(&mut self, index: usize) -> &mut (usize, Option<Remote>, Option<Decision>) {
        let found = self.agents.iter_mut().find(|(robot, ..)| *robot == index);
        found.expect("a robot of this fake")
    }
}

impl ExternalController for Nearby {
    fn robots(&self) -> Vec<usize> {
        self.agents.iter().map(|&(index, ..)| index).collect()
    }

    fn start(&mut self, index: usize, setup: Setup, task: Task) {
        let boots = self.boots.clone();
        boots.lock().expect("no test panics").push((index, setup.agent.boot));
        let mut agent = setup.agent().expect("postcard");
        agent.assign(&task).expect("a task for it");
        self.slot(index).1 = Some(agent);
    }

    fn has_restarted(&mut self, index: usize) -> bool {
        let tick = self.tick;
        self.restarts.is_some_and(|(robot, at)| robot == index && tick == at + 2)
    }

    fn send(&mut self, index: usize, tick: u32, now: Instant, inputs: &AnyInputs<'_, f32>) {
        self.tick = tick;
        let is_lost = self.restarts.is_some_and(|(robot, at)| robot == index && (at..at + 3).contains(&tick));
        let mut workspace = std::mem::take(&mut self.workspace);
        let slot = self.slot(index);
        slot.2 = slot.1.as_mut().filter(|_| !is_lost).map(|agent| {
            let out = agent.step(inputs, now, &mut workspace);
            Decision {
                command: out.command,
                outbox: out.outbox,
                rejected: out.rejected,
                status: Status {
                    mode: agent.mode(),
                    leader: agent.leader(),
                    target: agent.target().unwrap_or_default(),
                    wait: out.wait,
                },
            }
        });
        self.workspace = workspace;
    }

    fn collect(&mut self, index: usize) -> Option<Decision> {
        self.slot(index).2.take()
    }
}

fn outcome(scenario: &Scenario, elsewhere: Option<Nearby>) -> Outcome {
    let boxed = elsewhere.map(|nearby| Box::new(nearby) as Box<dyn ExternalController>);
    simulate_with(scenario, boxed, &mut |_, _| ControlFlow::Continue(())).expect("free starts")
}

fn shipped(name: &str, ticks: u32) -> Scenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let path = path.join(name).with_extension("toml");
    let mut scenario = Scenario::load(&path, &Overrides::default()).expect("a good scenario");
    scenario.ticks = ticks;
    scenario
}

#[test]
fn an_external_controller_does_not_change_the_run() {
    for name in ["six-robots", "figure-6", "six-discs", "swap-circle", "flock-squeeze", "goal-flock", "boids"] {
        let scenario = shipped(name, 60);
        let here = outcome(&scenario, None);
        let there = outcome(&scenario, Some(Nearby::of(&[0, 2])));
        assert_eq!(there, here, "{name}");
    }
}

#[test]
fn a_controller_that_lost_its_state_restarts_and_arrives() {
    let scenario = shipped("swap-circle", 2000);
    let nearby = Nearby { restarts: Some((1, 20)), ..Nearby::of(&[0, 1]) };
    let boots = nearby.boots.clone();
    let outcome = outcome(&scenario, Some(nearby));
    assert_eq!(outcome.arrived, scenario.robots.len());
    assert_eq!(outcome.collisions, 0);
    assert_eq!(*boots.lock().expect("no test panics"), [(0, 0), (1, 0), (1, 1)]);
}

#[test]
fn a_fault_restarts_an_external_controller_too() {
    let mut scenario = shipped("swap-circle", 200);
    scenario.events.faults = vec![Fault { robot: scenario.robots[2].id, from_tick: 10, to_tick: 30 }];
    let here = outcome(&scenario, None);
    assert_eq!(outcome(&scenario, Some(Nearby::of(&[2]))), here);
}
