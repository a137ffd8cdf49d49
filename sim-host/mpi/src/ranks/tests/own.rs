//! Laws of the caller with payloads, in both worlds.

use super::*;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{
    Action, AnySurroundings, BadInput, Decision, InAny, Law, Progress, Protocol, Radio, Surroundings as _, Tools, View,
};
use staya_controller::geom::Vec3;
use staya_controller::grid::Dir;
use staya_controller::wire::{Never, ProtocolId};
use staya_sim::engine::{Engine, own_agents, simulate_own};

/// Goes east, and stops when the sum of the payloads is large.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Sums(u32);

#[derive(Clone, Debug)]
enum Numbers {}

impl Protocol for Numbers {
    const ID: ProtocolId = ProtocolId(64);
    type Payload = u32;
    type Message = Never;
    type Order = Never;
}

impl InAny for Numbers {}

impl Law<f32> for Sums {
    type Surroundings<'a> = AnySurroundings<'a, f32>;
    type Protocol = Numbers;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, f32, Numbers>,
        here: &AnySurroundings<'_, f32>,
        _: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        let heard = view.peers().map(|(other, number)| number.wrapping_add(other.id.0));
        self.0 = heard.fold(self.0, |sum, number| sum.wrapping_mul(31).wrapping_add(number));
        let action = match here.in_plane() {
            Some(_) => Action::Velocity { wish_mps: Vec3::new(0.3, 0.0, 0.0), way_m: None },
            None => Action::Moves([Dir::East, Dir::North].into_iter().collect()),
        };
        Ok(Decision::new(action, Progress::at_goal(self.0.is_multiple_of(37))))
    }

    fn payload(&mut self, _: &AnySurroundings<'_, f32>, _: Dir, _: &mut Radio<'_, Numbers>) -> u32 {
        self.0
    }
}

fn continues(_: &Moment<'_>, _: &mut dyn Iterator<Item = RobotRow>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn on(scenario: &Scenario, ranks: usize, state: Option<&[u8]>) -> Outcome {
    let sharing = Sharing { every_ticks: 3, above: 1.01, ..Sharing::default() };
    let mut ended = std::thread::scope(|threads| {
        let run = |mut exchange: Threads| {
            let agents = own_agents(scenario, |_| Sums::default()).expect("any world");
            simulate_on(scenario, agents, state, &mut exchange, &sharing, &mut continues)
        };
        let ranks: Vec<_> =
            Threads::connected(ranks).into_iter().map(|exchange| threads.spawn(move || run(exchange))).collect();
        ranks.into_iter().map(|rank| rank.join().expect("no rank panics")).collect::<Vec<_>>()
    });
    ended.swap_remove(0).expect("an outcome").outcome
}

#[test]
fn a_law_of_the_caller_has_one_hash_on_any_number_of_ranks_and_from_a_checkpoint() {
    for text in [GRID, PLANE] {
        let scenario = parse(text);
        let mut saved = Vec::new();
        let watch = |moment: &Moment<'_>, _: &mut dyn Iterator<Item = RobotRow>| {
            if moment.row.tick == 20 {
                moment.run.expect("a run").save(&mut saved).expect("all robots are here");
            }
            ControlFlow::Continue(())
        };
        let alone = simulate_own(&scenario, |_| Sums::default(), watch).expect("room");
        let engine =
            Engine::new(&scenario, own_agents(&scenario, |_| Sums::default()).expect("any world")).expect("room");
        let resumed = engine.resume(&saved, scenario.ticks, &mut continues).expect("its state");
        assert_eq!(resumed, alone);
        for ranks in [1, 2, 3, 8] {
            assert_eq!(on(&scenario, ranks, None), alone, "{ranks} ranks");
        }
        assert_eq!(on(&scenario, 3, Some(&saved)), alone, "from a checkpoint");
    }
}
