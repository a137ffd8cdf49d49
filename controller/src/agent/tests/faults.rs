//! Tests of stops along the chain, lost leaders, and orders during a run.

use super::*;
use crate::formation::Recovery;
use crate::template::TemplateEntry;

fn goal_at(number: u8, x: i16) -> Message {
    goal(0, number, Cell::new(x, 5))
}

/// A template for a robot `behind` cells west of robot 1, with `others` more neighbours.
fn parts(to: u32, version: u8, behind: i16, others: u32) -> Vec<Message> {
    let neighbors = std::iter::once((1, behind)).chain((20..20 + others).map(|id| (id, 9)));
    let entries: Vec<TemplateEntry> =
        neighbors.map(|(id, x)| TemplateEntry { offset: Cell::new(x, 0), id: RobotId(id), hops: 1 }).collect();
    let offset = Cell::new(-behind, 0);
    template_orders(to, TemplatePart::split(version, 1, offset, &entries).unwrap())
}

#[test]
fn a_leader_does_not_wait_for_a_failed_or_arrived_robot() {
    for (mode, expected) in [(Mode::Cruise, Mode::Hold), (Mode::Fault, Mode::Cruise), (Mode::Arrived, Mode::Cruise)] {
        let (mut agent, mut ws) = (formation_agent(1), workspace());
        agent.order(&GridOrder::Goal(Cell::new(60, 5)));
        let behind = Beacon { mode, ..behind(1, -5, 5) };
        for n in 0..2 {
            let inbox = bytes(2, 0, n, &[Message::Beacon(behind.clone())]);
            let inputs = inputs(&FLAT, Cell::new(5, 5), &inbox);
            let _ = agent.step(&inputs, tick(n.into()), &mut ws);
        }
        assert_eq!(agent.mode(), expected, "follower's mode {mode:?}");
    }
}

#[test]
fn a_leader_leaves_a_robot_that_stays_behind_for_too_long() {
    let (mut agent, mut ws) = (formation_agent(1), workspace());
    agent.order(&GridOrder::Goal(Cell::new(60, 5)));
    let behind = behind(1, -5, 5);
    let patience = u32::from(FormationParams::default().patience);
    let mut held = vec![];
    for n in 0..patience + 20 {
        let inbox = bytes(2, 0, n as u16, &[Message::Beacon(behind.clone())]);
        let _ = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(n), &mut ws);
        if agent.mode() == Mode::Hold {
            held.push(n);
        }
    }
    assert!(held.iter().copied().eq(0..patience), "{held:?}");
}

#[test]
fn a_leader_does_not_wait_for_a_robot_that_does_not_follow_it() {
    let (mut agent, mut ws) = (formation_agent(1), workspace());
    agent.order(&GridOrder::Goal(Cell::new(60, 5)));
    let alone = beacon_at(-5, 5);
    for n in 0..5 {
        let inbox = bytes(2, 0, n, &[Message::Beacon(alone.clone())]);
        let _ = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(n.into()), &mut ws);
        assert_eq!(agent.mode(), Mode::Cruise);
    }
}

#[test]
fn a_template_is_assembled_from_repeated_parts() {
    let (mut agent, mut ws) = (formation_agent(2), workspace());
    let repeated: Vec<Message> = parts(2, 1, 6, 7).into_iter().flat_map(|part| [part.clone(), part]).collect();
    assert_eq!(repeated.len(), 8);
    let inbox = bytes(99, 0, 0, &repeated);
    let _ = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(0), &mut ws);
    assert_eq!(agent.law.template().entries.len(), 8);
}

#[test]
fn a_new_template_moves_the_goal_that_was_given_to_the_formation() {
    let target_after = |orders: &[&[Message]]| {
        let (mut agent, mut ws) = (formation_agent(2), workspace());
        for (n, order) in (0..).zip(orders) {
            let inbox = bytes(99, 0, 10 * n, order);
            let _ = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(n.into()), &mut ws);
        }
        agent.target()
    };
    let (goal, parts) = ([goal_at(1, 60)], parts(2, 1, 6, 0));
    assert_eq!(target_after(&[&goal]), Some(Cell::new(57, 5)));
    assert_eq!(target_after(&[&goal, &parts]), Some(Cell::new(54, 5)));
    assert_eq!(target_after(&[&parts, &goal]), Some(Cell::new(54, 5)));
    let (mut agent, mut ws) = (formation_agent(2), workspace());
    agent.order(&GridOrder::Goal(Cell::new(40, 5)));
    let inbox = bytes(99, 0, 0, &parts);
    let _ = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(0), &mut ws);
    assert_eq!(agent.target(), Some(Cell::new(40, 5)));
}

#[test]
fn one_goal_for_all_robots_turns_the_whole_formation() {
    let mut agents = [1, 2, 3].map(formation_agent);
    let mut cells = [11, 8, 5].map(|x| Cell::new(x, 5));
    let mut ws = workspace();
    let mut air: Vec<u8> = vec![];
    for n in 0..120_u32 {
        let mut inbox = core::mem::take(&mut air);
        match n {
            0 => inbox.extend(bytes(99, 0, 0, &[goal_at(1, 40)])),
            12 => inbox.extend(bytes(99, 0, 1, &[goal_at(2, -30)])),
            _ => {}
        }
        for (agent, cell) in agents.iter_mut().zip(&mut cells) {
            let out = agent.step(&inputs(&FLAT, *cell, &inbox), tick(n), &mut ws);
            air.extend_from_slice(&out.outbox);
            if let Command::Move(moves) = out.command {
                *cell = *cell + moves[0].offset();
            }
        }
        if n == 12 {
            assert!(cells[0].x > 15, "on its way east: {cells:?}");
        }
    }
    assert_eq!(cells, [-30, -33, -36].map(|x| Cell::new(x, 5)));
    assert!(agents.iter().all(|agent| agent.mode() == Mode::Arrived));
}

#[test]
fn a_lost_leader_is_forgotten_and_followed_again_when_it_is_back() {
    let (mut agent, mut ws) = (formation_agent(3), workspace());
    agent.order(&GridOrder::Goal(Cell::new(60, 5)));
    let mut leaders = vec![];
    for n in 0..100_u32 {
        let silent = (20..60).contains(&n);
        let beacon = Message::Beacon(beacon_at(8, 5));
        let inbox = if silent { vec![] } else { bytes(2, 0, n as u16, &[beacon]) };
        let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(n), &mut ws);
        if leaders.last() != Some(&(agent.leader().0)) {
            leaders.push(agent.leader().0);
        }
        assert!(asked(&out).is_empty());
        assert_ne!(agent.mode(), Mode::Hold);
    }
    assert_eq!(leaders, [2, 0, 2]);
}

#[test]
fn cyclic_leader_chains_end() {
    for [second, first] in [[1, 2], [2, 1], [3, 3], [7, 7], [0, 0]] {
        let (mut agent, mut ws) = (formation_agent(3), workspace());
        agent.order(&GridOrder::Goal(Cell::new(60, 5)));
        for n in 0..3 {
            let beacon = |x, leader| Message::Beacon(behind(leader, x, 5));
            let mut inbox = bytes(2, 0, n, &[beacon(10, second)]);
            inbox.extend(bytes(1, 0, n, &[beacon(13, first)]));
            let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(n.into()), &mut ws);
            assert!(matches!(out.command, Command::Move(_)));
            assert_eq!(agent.leader(), RobotId(2));
        }
    }
}

/// Every second packet is lost, then robot 3 falls silent for good.
#[test]
fn a_stop_reaches_the_top_leader_over_a_lossy_radio_and_expires_with_its_origin() {
    let mut agents = [1, 2, 3].map(formation_agent);
    let mut ws = workspace();
    let mut air = [const { vec![] }; 3];
    let mut held = vec![];
    for n in 0..130_u32 {
        let heard = core::mem::take(&mut air);
        let ahead = if n < 6 { 0 } else { 6 };
        let cells = [16 + ahead, 13 + ahead, 10].map(|x| Cell::new(x, 5));
        for (i, agent) in agents.iter_mut().enumerate() {
            agent.order(&GridOrder::Goal(Cell::new(100, 5)));
            let inbox: Vec<u8> = (0..3_usize)
                .filter(|&from| Rng::keyed(5, from as u32, i as u32, n).below(2) == 0)
                .filter(|&from| from != 2 || n < 60)
                // Robots 1 and 3 are out of each other's range.
                .filter(|&from| from.abs_diff(i) == 1)
                .flat_map(|from| heard[from].clone())
                .collect();
            let out = agent.step(&inputs(&FLAT, cells[i], &inbox), tick(n), &mut ws);
            air[i].extend_from_slice(&out.outbox);
            if n > 20 && i == 0 && agent.mode() == Mode::Hold {
                held.push(n);
            }
        }
    }
    let (first, last) = (held[0], *held.last().unwrap());
    assert!(first < 45, "{held:?}");
    // Robot 3 falls silent at 60; its last stop is valid for 12 ticks and some retries.
    assert!((50..105).contains(&last), "{held:?}");
}

#[test]
fn a_stop_of_a_restarted_robot_holds_until_it_expires() {
    let (mut agent, mut ws) = (route_agent(1), workspace());
    agent.order(&GridOrder::Goal(Cell::new(60, 5)));
    let beacon = || Message::Beacon(beacon_at(2, 5));
    let inbox = bytes(2, 0, 0, &[beacon(), stop(2, 1, 7)]);
    let _ = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(0), &mut ws);
    assert_eq!(agent.mode(), Mode::Hold);
    for (n, mode) in [(1, Mode::Hold), (11, Mode::Hold), (13, Mode::Cruise)] {
        let inbox = bytes(2, 1, n as u16, &[beacon()]);
        let _ = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(n), &mut ws);
        assert_eq!(agent.mode(), mode);
    }
    let inbox = bytes(2, 1, 14, &[stop(2, 1, 0)]);
    let _ = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(14), &mut ws);
    assert_eq!(agent.mode(), Mode::Hold);
}

#[test]
fn a_restarted_robot_can_stop_another_one_again() {
    let (mut agent, mut ws) = (route_agent(1), workspace());
    agent.order(&GridOrder::Goal(Cell::new(60, 5)));
    let mut mode_after = |boot, sequence, message, n| {
        let inbox = bytes(2, boot, sequence, &[Message::Beacon(beacon_at(2, 5)), message]);
        let _ = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(n), &mut ws);
        agent.mode()
    };
    assert_eq!(mode_after(0, 0, stop(2, 1, 7), 0), Mode::Hold);
    assert_eq!(mode_after(1, 0, resume(2, 1, 7), 1), Mode::Cruise, "number 7 of another start");
    assert_eq!(mode_after(1, 2, stop(2, 1, 8), 2), Mode::Hold);
}

#[test]
fn a_repeated_redirection_is_followed_once() {
    let (mut agent, mut ws) = (route_agent(1), workspace());
    agent.order(&GridOrder::Goal(Cell::new(5, 5)));
    let mut moved = vec![];
    for n in 0..4 {
        let inbox = bytes(2, 0, n, &[redirect(1, 0)]);
        let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(n.into()), &mut ws);
        moved.push(out.command != Command::Hold);
        let ack = |frame: &Frame| matches!(frame.message, Message::Ack(_));
        assert!(sent(&out).iter().any(ack), "a repeat says that the answer was lost");
    }
    assert_eq!(moved, [true, false, false, false]);
}

#[test]
fn after_a_long_sleep_a_robot_sends_and_no_stop_is_active() {
    for sleep in [60_u32, 36 * 60, 50 * 60, 70 * 60] {
        let (mut agent, mut ws) = (formation_agent(2), workspace());
        agent.order(&GridOrder::Goal(Cell::new(60, 5)));
        let leader = Message::Beacon(beacon_at(13, 5));
        let inbox = [bytes(1, 0, 0, &[leader]), bytes(3, 0, 0, &[stop(3, 2, 0)])];
        let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox.concat()), tick(0), &mut ws);
        assert!(!asked(&out).is_empty());
        let woken = tick(sleep);
        let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &[]), woken, &mut ws);
        let is_beacon = |frame: &Frame| matches!(frame.message, Message::Beacon(_));
        assert!(sent(&out).iter().any(is_beacon), "after {sleep} s");
        assert!(out.call_again.since(woken) <= Duration::from_micros(TICK));
        assert_eq!(agent.mode(), Mode::Cruise, "after {sleep} s");
        let mut late = vec![];
        for n in 1..10 {
            let now = woken + Duration::from_micros(n * TICK);
            let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &[]), now, &mut ws);
            late.extend(asked(&out));
        }
        assert!(agent.link.is_quiet(), "after {sleep} s");
    }
}

#[test]
fn windows_without_the_robot_are_a_fault_and_tiny_ones_a_dead_end() {
    let one = |width, height, origin| {
        let cells = [1_u8; 1];
        let count = usize::from(width * height);
        let (mut agent, mut ws) = (formation_agent(1), workspace());
        agent.order(&GridOrder::Goal(Cell::new(60, 5)));
        let mut inputs = inputs(&FLAT, Cell::new(5, 5), &[]);
        inputs.surroundings.window = Window::new(&cells[..count], origin, width, height);
        let out = agent.step(&inputs, tick(0), &mut ws);
        assert_eq!(out.command, Command::Hold);
        agent.mode()
    };
    assert_eq!(one(0, 0, Cell::new(5, 5)), Mode::Fault);
    assert_eq!(one(1, 1, Cell::new(6, 5)), Mode::Fault);
    assert_eq!(one(1, 1, Cell::new(i16::MIN, i16::MAX)), Mode::Fault);
    assert_eq!(one(1, 1, Cell::new(5, 5)), Mode::Hold);
}

/// With `Recovery::Def`, even if asked to stop.
#[test]
fn a_recovering_leader_heads_for_its_scattered_followers() {
    let go = |recovery| {
        let mut agent = formation_agent(1);
        let template = agent.law.template().clone();
        let formation = FormationParams { recovery, ..FormationParams::default() };
        agent.law = FormationGuidance::new(RouteParams::default(), formation, template);
        let mut ws = workspace();
        agent.order(&GridOrder::Goal(Cell::new(60, 5)));
        let behind = behind(1, -5, 5);
        let inbox = bytes(2, 0, 0, &[Message::Beacon(behind), stop(2, 1, 0)]);
        let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(0), &mut ws);
        out.command
    };
    assert_eq!(go(Recovery::Wait), Command::Hold);
    let west = Command::Move([Dir::West].into_iter().collect());
    assert_eq!(go(Recovery::Def), west);
}

/// KUZ section 7, item 6.
#[test]
fn strangers_in_a_neighbour_s_place_are_asked_to_choose_another_direction() {
    let (mut agent, mut ws) = (formation_agent(1), workspace());
    agent.order(&GridOrder::Goal(Cell::new(60, 5)));
    let mut said = vec![];
    for n in 0..5 {
        let inbox = bytes(9, 0, n, &[Message::Beacon(beacon_at(2, 5))]);
        let at = Cell::new(5, 5);
        let out = agent.step(&inputs(&FLAT, at, &inbox), tick(n.into()), &mut ws);
        said.extend(asked(&out).into_iter().map(|(to, message)| (n, to, message)));
        let distance =
            agent.law().graph_distance(RobotId(1), at, agent.neighbors().iter().filter_map(GridNeighbor::told));
        assert_eq!((distance.less, distance.more), (2, 1));
    }
    assert_eq!(said, [(3, RobotId(9), GridMessage::Redirect)]);
}

#[test]
fn a_robot_leads_although_its_own_leader_is_out_of_range() {
    let (mut agent, mut ws) = (formation_agent(3), workspace());
    let anyone = [TemplateEntry { offset: Cell::new(3, 0), id: RobotId::NONE, hops: 1 }];
    let order = template_orders(3, TemplatePart::split(1, 2, Cell::new(-6, 0), &anyone).unwrap());
    agent.order(&GridOrder::Goal(Cell::new(5, 60)));
    let mut at = Cell::new(5, 5);
    for n in 0..6_i16 {
        let mut inbox = if n == 0 { bytes(99, 0, 0, &order) } else { vec![] };
        let beacon = on_grid(GridPayload { leader: RobotId(1), heading: Dir::East, ..in_cell(9 + n, 5) });
        inbox.extend(bytes(2, 0, n as u16, &[Message::Beacon(beacon)]));
        let out = agent.step(&inputs(&FLAT, at, &inbox), tick(n as u32), &mut ws);
        assert_eq!(agent.leader(), RobotId(2));
        let Command::Move(moves) = out.command else { panic!("it follows") };
        at = at + moves[0].offset();
    }
    assert_eq!(at.y, 5, "beside its leader, not to its own goal in the north");
}

#[test]
fn terrain_costs_of_the_whole_formation_count_in_any_window() {
    let first = |radius: i16| {
        let side = 2 * radius + 1;
        let at = Cell::new(0, 0);
        // Mud at y = -4 to -2, below robot 2's place, three cells south of the leader's.
        let cells: Vec<u8> = (-radius..=radius)
            .flat_map(|y| (-radius..=radius).map(move |x| (x, y)))
            .map(|(x, y)| if x > 0 && (-4..=-2).contains(&y) { 60 } else { 1 })
            .collect();
        let template = Template::from_graph(&[at, Cell::new(0, -3)], &[(0, 1)], 0, 1).unwrap();
        let formation = FormationParams { footprint: 16, ..FormationParams::default() };
        let guidance = FormationGuidance::new(RouteParams::default(), formation, template);
        let mut agent = FormationAgent::new(&config(1), guidance, Unguarded, Postcard);
        agent.order(&GridOrder::Goal(Cell::new(40, 0)));
        let mut inputs = inputs(&FLAT, at, &[]);
        let inbox = bytes(2, 0, 0, &[Message::Beacon(beacon_at(0, -3))]);
        inputs.inbox = &inbox;
        let (corner, side) = (at - Cell::new(radius, radius), side as u16);
        inputs.surroundings.window = Window::new(&cells, corner, side, side);
        match agent.step(&inputs, tick(0), &mut workspace()).command {
            Command::Move(moves) => moves[0],
            Command::Hold | Command::Velocity(_) => Dir::Stay,
        }
    };
    assert_ne!(first(5), Dir::East, "round the mud");
    assert_eq!(first(9), first(5));
}
