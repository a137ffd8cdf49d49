use super::*;
use crate::engine::{Moment, Outcome, operated, simulate, simulate_from, simulate_own};
use crate::record::RobotRow;
use crate::scenario::{Overrides, Scenario};
use staya_controller::agent::{Action, Progress, Protocol};
use staya_controller::geom::Vec3;
use staya_controller::parameters::{Parameter, row};
use staya_controller::wire::{Content, ProtocolId};
use std::ops::ControlFlow;
use std::path::Path;

/// Drives east at the slowest pace of all; each robot once asks the next one to halve its own.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Convoy {
    pace_mps: f32,
    asked: bool,
    halved: u32,
}

impl Default for Convoy {
    fn default() -> Self {
        Self { pace_mps: 0.5, asked: false, halved: 0 }
    }
}

const PACE: Parameter = row("pace_mps", "CON_PACE", "m/s", [0.1, 2.0], "Pace of the convoy.");

staya_controller::parameters! {
    impl[] Convoy { PACE => pace_mps }
}

#[derive(Clone, Debug)]
enum Paces {}

#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Pace(u16);
impl Content for Pace {}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Halve;
impl Content for Halve {}

impl Protocol for Paces {
    const ID: ProtocolId = ProtocolId(200);
    type Payload = Pace;
    type Message = Halve;
    type Order = staya_controller::wire::Never;
}

impl InAny for Paces {}

impl Law<f32> for Convoy {
    type Surroundings<'a> = InPlane<'a, f32>;
    type Protocol = Paces;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, f32, Paces>,
        _: &InPlane<'_, f32>,
        mut tools: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        view.can_move()?;
        let next = view.peers().find(|(other, _)| other.id > view.id);
        if let Some((next, _)) = next.filter(|_| !self.asked) {
            let valid = tools.radio.valid;
            self.asked = tools.radio.send(next.id, &Halve, valid);
        }
        let others = view.peers().map(|(_, pace)| f32::from(pace.0) / 1000.0);
        let wish_mps = Vec3::new(others.fold(self.pace_mps, f32::min), 0.0, 0.0);
        Ok(Decision::new(Action::Velocity { wish_mps, way_m: None }, Progress::Going))
    }

    fn payload(&mut self, _: &InPlane<'_, f32>, _: Dir, _: &mut Radio<'_, Paces>) -> Pace {
        Pace((self.pace_mps * 1000.0) as u16)
    }

    fn receive(&mut self, _: RobotId, _: &Halve, _: &mut Radio<'_, Paces>) -> bool {
        self.pace_mps *= 0.5;
        self.halved += 1;
        true
    }

    fn report(&self) -> Report {
        Report { leader: RobotId(self.halved), ..Report::default() }
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        visit(self);
    }
}

fn text(law: &str) -> String {
    let robots: Vec<_> = (0..5).map(|i| format!("{{ start_m = [{i}, 0] }}")).collect();
    format!(
        "name = \"convoy\"\nseed = 3\nticks = 60\ntick_s = 0.1\n[radio]\nrange_m = 1.5\nloss = 0.2\n[plane]\n\
         radius_m = 0.1\nmax_speed_mps = 1.0\n{law}\n[plane.robots]\nlist = [{}]\n",
        robots.join(", ")
    )
}

fn scenario(law: &str) -> Result<Scenario, String> {
    add_law::<Convoy>("convoy");
    let read = Scenario::parse(&text(law), Path::new("convoy.toml"), &Overrides::default());
    read.map_err(|error| error.to_string())
}

fn on(_: &Moment<'_>, _: &mut dyn Iterator<Item = RobotRow>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn named_run(law: &str) -> (Outcome, Vec<u32>) {
    let mut halved = Vec::new();
    let watch = |_: &Moment<'_>, rows: &mut dyn Iterator<Item = RobotRow>| {
        halved = rows.map(|row| row.leader).collect();
        ControlFlow::Continue(())
    };
    let outcome = simulate(&scenario(law).unwrap(), watch).unwrap();
    (outcome, halved)
}

#[test]
fn a_named_law_runs_as_one_given_by_the_caller() {
    let (named, halved) = named_run("law = \"convoy\"");
    let own = simulate_own(
        &scenario("law = \"boids\"\nboids = { crowded_m = 0.4, closest_m = 2 }").unwrap(),
        |_| Convoy::default(),
        on,
    )
    .unwrap();
    assert_eq!(named, own);
    assert_eq!(halved, [0, 1, 1, 1, 1], "each message arrives once, although packets are lost");
    let (slow, _) = named_run("law = \"convoy\"\nconvoy = { pace_mps = 0.2 }");
    assert_ne!(slow.trace_hash, named.trace_hash);
}

#[test]
fn a_checkpoint_has_the_state_of_a_named_law() {
    let scenario = scenario("law = \"convoy\"").unwrap();
    let whole = simulate(&scenario, on).unwrap();
    let mut bytes = Vec::new();
    let until_nine = |moment: &Moment<'_>, _: &mut dyn Iterator<Item = RobotRow>| {
        if moment.row.tick < 9 {
            return ControlFlow::Continue(());
        }
        moment.run.unwrap().save(&mut bytes).unwrap();
        ControlFlow::Break(())
    };
    let _ = simulate(&scenario, until_nine).unwrap();
    assert_eq!(simulate_from(&scenario, &bytes, &mut on).unwrap(), whole);
}

#[test]
fn an_operator_sees_and_tunes_a_named_law() {
    let scenario = scenario("law = \"convoy\"").unwrap();
    let mut run = operated(&scenario).unwrap();
    for _ in 0..scenario.ticks {
        run.step();
    }
    assert_eq!(run.outcome(), simulate(&scenario, on).unwrap());
    assert_eq!(run.parameter(0, "pace_mps"), Some(0.5));
    run.set_parameter(0, "pace_mps", 0.3).unwrap();
    assert_eq!(run.parameter(0, "pace_mps"), Some(0.3));
    assert_eq!(run.inspect(0).known.len(), 1);
}

#[test]
fn a_wrong_name_place_or_parameter_is_refused_with_a_remedy() {
    let refused = |law: &str| scenario(law).unwrap_err();
    let spelled = refused("law = \"convoi\"");
    assert!(
        spelled.contains("convoy.toml:11:7: plane.law: ") && spelled.contains("did you mean \"convoy\"?"),
        "{spelled}"
    );
    let unknown = refused("law = \"convoy\"\nconvoy = { pase_mps = 1 }");
    assert!(unknown.contains("plane.convoy.pase_mps") && unknown.contains("`pace_mps`"), "{unknown}");
    let fast = refused("law = \"convoy\"\nconvoy = { pace_mps = 9 }");
    assert!(fast.contains("give 0.1 to 2 m/s"), "{fast}");
    let grid = "name = \"t\"\nticks = 4\n[grid]\nlaw = \"convoy\"\n[terrain]\nuniform = { width = 9, height = 4, classes = 1 }\n\
        [robots]\nlist = [{ start = [1, 1], goal = [8, 1] }]\n";
    let grid = Scenario::parse(grid, Path::new("t.toml"), &Overrides::default()).unwrap_err().to_string();
    assert!(grid.contains("grid.law") && grid.contains("give [plane]"), "{grid}");
    add_law::<staya_controller::negotiation::NegotiationGuidance<16>>("convoy_on_foot");
    let on_foot = "name = \"t\"\nticks = 4\ntick_s = 0.1\n[terrain]\nuniform = { width = 9, height = 4, classes = 1 }\n\
        [robots]\nlist = [{ start = [1, 1], goal = [8, 1] }]\n[plane]\nradius_m = 0.1\nmax_speed_mps = 1\n\
        law = \"convoy_on_foot\"\n";
    let on_foot = Scenario::parse(on_foot, Path::new("t.toml"), &Overrides::default()).unwrap_err().to_string();
    assert!(on_foot.contains("plane.law: the law \"convoy_on_foot\" goes from cell to cell"), "{on_foot}");
}
