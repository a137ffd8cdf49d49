//! Tests of robots of a formation that relay the beacons of each other.

use super::*;
use crate::wire::Relayed;

/// Three robots in a row, from east to west; each steps in turn and hears what was said before.
struct Row {
    agents: Vec<FormationAgent>,
    outboxes: Vec<Vec<u8>>,
    ws: Box<GridWorkspace<CELLS>>,
    tick: u32,
}

const CELLS_OF_ROW: [Cell; 3] = [Cell::new(11, 5), Cell::new(8, 5), Cell::new(5, 5)];

impl Row {
    fn new(relays: u8) -> Self {
        let agent = |id: u32| {
            let template = formation_agent(id).law().template().clone();
            let law = FormationGuidance::new(RouteParams::default(), FormationParams::default(), template);
            let mut agent = FormationAgent::new(&AgentConfig { relays, ..config(id) }, law, Unguarded, Postcard);
            agent.order(&GridOrder::Goal(Cell::new(60, 5)));
            agent
        };
        Self { agents: (1..=3).map(agent).collect(), outboxes: vec![Vec::new(); 3], ws: workspace(), tick: 0 }
    }

    /// One tick of the robots that run; a robot hears those beside it. They stay in their cells.
    fn step(&mut self, runs: [bool; 3]) {
        let said = std::mem::replace(&mut self.outboxes, vec![Vec::new(); 3]);
        for index in (0..3).filter(|index| runs[*index]) {
            let beside = (0..3).filter(|other| index.abs_diff(*other) == 1);
            let inbox: Vec<u8> = beside.flat_map(|other| said[other].clone()).collect();
            let inputs = inputs(&FLAT, CELLS_OF_ROW[index], &inbox);
            self.outboxes[index] = self.agents[index].step(&inputs, tick(self.tick), &mut self.ws).outbox.to_vec();
        }
        self.tick += 1;
    }

    fn knows(&self, one: usize, other: u32) -> bool {
        self.agents[one].neighbors().iter().any(|known| known.id == RobotId(other))
    }

    fn relayed_by(&self, index: usize) -> Vec<Relayed> {
        let said = frames(&self.outboxes[index]).map(|frame| decode(frame).unwrap().message);
        said.filter_map(|said| if let Message::Relayed(said) = said { Some(said) } else { None }).collect()
    }
}

#[test]
fn members_that_do_not_hear_each_other_know_each_others_cells_and_leaders() {
    let mut row = Row::new(2);
    for _ in 0..6 {
        row.step([true; 3]);
    }
    let told = row.agents[2].neighbors().iter().find(|known| known.id == RobotId(1)).expect("relayed");
    assert_eq!(told.payload.map(|said| said.cell), Some(CELLS_OF_ROW[0]));
    assert_eq!(told.mode, Mode::Cruise);
    let told = row.agents[0].neighbors().iter().find(|known| known.id == RobotId(3)).expect("relayed");
    assert_eq!(told.payload.map(|said| said.leader), Some(RobotId(2)));
    // The robot between them heard it a tick before; ages are rounded up.
    assert_eq!(tick(row.tick - 1).since(told.heard), Duration::from_micros(TICK + 10_000));
}

#[test]
fn without_relays_no_beacon_is_relayed_and_none_is_received() {
    let mut row = Row::new(0);
    row.agents[1] = Row::new(2).agents.swap_remove(1);
    for _ in 0..6 {
        row.step([true; 3]);
    }
    assert_eq!(row.relayed_by(1).len(), 2);
    assert!(row.relayed_by(0).is_empty() && row.relayed_by(2).is_empty());
    assert!(!row.knows(2, 1) && !row.knows(0, 3));
}

#[test]
fn the_first_comes_each_time_and_the_others_in_turn() {
    let mut row = Row::new(1);
    let mut told = Vec::new();
    for _ in 0..9 {
        row.step([true; 3]);
        told.extend(row.relayed_by(1).iter().map(|said| said.id.0));
    }
    // In the first step it has heard no robot.
    let count = |id: u32| told.iter().filter(|told| **told == id).count();
    assert_eq!(count(1) + count(3), 8, "{told:?}");
    assert!(count(1) >= 3 && count(3) >= 3, "{told:?}");
    let mut row = Row::new(2);
    row.step([true; 3]);
    row.step([true; 3]);
    assert_eq!(row.relayed_by(1).iter().map(|said| said.id.0).collect::<Vec<_>>(), [1, 3]);
}

#[test]
fn no_robot_is_relayed_twice_behind_one_beacon() {
    for relays in [2, 3, u8::MAX] {
        let mut row = Row::new(relays);
        for _ in 0..9 {
            row.step([true; 3]);
            let mut ids: Vec<u32> = row.relayed_by(1).iter().map(|said| said.id.0).collect();
            let count = ids.len();
            ids.sort_unstable();
            ids.dedup();
            assert_eq!(ids.len(), count);
        }
        assert_eq!(row.relayed_by(1).len(), 2, "all that it hears");
    }
}

/// States that got younger from robot to robot would be relayed for ever.
#[test]
fn a_robot_that_falls_silent_is_forgotten_by_all() {
    for relays in 1..=3 {
        let mut row = Row::new(relays);
        for _ in 0..8 {
            row.step([true; 3]);
        }
        assert!(row.knows(2, 1) && row.knows(1, 1));
        for _ in 0..40 {
            row.step([false, true, true]);
        }
        assert!(!row.knows(2, 1) && !row.knows(1, 1), "{relays} relays");
    }
}

#[test]
fn only_robots_that_the_law_needs_are_relayed_and_only_newer_beacons_count() {
    let (mut agent, mut ws) = (Row::new(3).agents.swap_remove(0), workspace());
    let stranger = bytes(9, 0, 0, &[Message::Beacon(beacon_at(12, 5))]);
    let out = agent.step(&inputs(&FLAT, CELLS_OF_ROW[0], &stranger), tick(0), &mut ws);
    assert!(sent(&out).iter().all(|frame| !matches!(frame.message, Message::Relayed(_))));
    let Beacon { protocol, payload, .. } = beacon_at(8, 5);
    let said =
        |age_cs: u16| Relayed { id: RobotId(2), age_cs, protocol, payload: payload.clone(), ..Relayed::default() };
    let heard =
        |agent: &FormationAgent| agent.neighbors().iter().find(|known| known.id == RobotId(2)).map(|known| known.heard);
    for (n, age_cs, expected) in [(1, 100, 1), (2, 300, 1), (3, 100, 3), (4, 250, 3)] {
        let inbox = bytes(3, 0, n, &[Message::Relayed(said(age_cs))]);
        let _ = agent.step(&inputs(&FLAT, CELLS_OF_ROW[0], &inbox), tick(n.into()), &mut ws);
        // A tick old when it was relayed, and a tick under way.
        assert_eq!(heard(&agent), Some(tick(expected) - Duration::from_micros(2 * TICK)), "step {n}");
    }
    // Activity and flock are relayed, too, of a robot that was known before and of a new one.
    for (id, n) in [(2, 5), (3, 6)] {
        let other = Relayed { id: RobotId(id), mode: Mode::Hold, flock: 7, ..said(0) };
        let inbox = bytes(20, 0, n, &[Message::Relayed(other)]);
        let _ = agent.step(&inputs(&FLAT, CELLS_OF_ROW[0], &inbox), tick(n.into()), &mut ws);
        let known = agent.neighbors().iter().find(|known| known.id == RobotId(id)).expect("relayed");
        assert_eq!((known.mode, known.flock), (Mode::Hold, 7));
    }
    // A robot does not believe what others say of itself.
    let own = Relayed { id: RobotId(1), ..said(0) };
    let _ = agent.step(&inputs(&FLAT, CELLS_OF_ROW[0], &bytes(20, 0, 9, &[Message::Relayed(own)])), tick(7), &mut ws);
    assert!(agent.neighbors().iter().all(|known| known.id != RobotId(1)));
}

#[test]
fn a_stop_for_a_leader_that_is_not_heard_goes_to_a_robot_before_the_own_one() {
    let mut row = Row::new(2);
    for _ in 0..6 {
        row.step([true; 3]);
    }
    // The last robot follows the first one, of which it knows from the second one.
    let mut last = row.agents.swap_remove(2);
    let stop = bytes(4, 0, 0, &[stop(4, 3, 7)]);
    let leader = last.leader();
    let out = last.step(&inputs(&FLAT, CELLS_OF_ROW[2], &stop), tick(row.tick), &mut row.ws);
    assert_eq!(leader, RobotId(2), "the nearest before it");
    assert_eq!(asked(&out).iter().map(|(to, _)| *to).collect::<Vec<_>>(), [RobotId(2)]);
}
