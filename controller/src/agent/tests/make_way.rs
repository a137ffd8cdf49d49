//! Tests of robots that are asked to make way.

use super::*;

fn corridor() -> [u8; 121] {
    let mut cells = [BLOCKED; 121];
    cells[55..66].fill(1);
    cells
}

/// Returns the step in which robot 2, moving along `way`, asks robot `other` to redirect.
fn asks(other: u32, place: Cell, mode: Mode, way: &[Cell]) -> Option<u16> {
    let (mut agent, mut ws) = (route_agent(2), workspace());
    agent.order(&GridOrder::Goal(Cell::new(60, 5)));
    (0..20).find(|&n| {
        let beacon = Beacon { mode, ..beacon_at(place.x, place.y) };
        let inbox = bytes(other, 0, n, &[Message::Beacon(beacon)]);
        let at = way[usize::from(n) % way.len()];
        let out = agent.step(&inputs(&corridor(), at, &inbox), tick(n.into()), &mut ws);
        asked(&out) == [(RobotId(other), GridMessage::Redirect)]
    })
}

#[test]
fn of_two_robots_in_one_cell_the_smaller_id_asks_first() {
    let here = Cell::new(5, 5);
    assert_eq!(asks(3, here, Mode::Cruise, &[here]), Some(8));
    assert_eq!(asks(1, here, Mode::Cruise, &[here]), Some(12));
}

#[test]
fn an_arrived_robot_is_asked_by_a_robot_that_returns_repeatedly() {
    let dance = [Cell::new(5, 5), Cell::new(4, 5)];
    assert!(asks(1, Cell::new(6, 5), Mode::Arrived, &dance).is_some());
    assert_eq!(asks(1, Cell::new(6, 5), Mode::Cruise, &dance), None, "it will go by itself");
}

#[test]
fn a_robot_without_another_route_moves_back() {
    let (mut agent, mut ws) = (route_agent(2), workspace());
    agent.order(&GridOrder::Goal(Cell::new(60, 5)));
    let step = |agent: &mut RouteAgent, ws: &mut _, inbox: &[u8], n| match agent
        .step(&inputs(&corridor(), Cell::new(5, 5), inbox), tick(n), ws)
        .command
    {
        Command::Move(moves) => moves,
        Command::Hold | Command::Velocity(_) => heapless::Vec::new(),
    };
    assert_eq!(step(&mut agent, &mut ws, &[], 0)[0], Dir::East);
    let inbox = bytes(1, 0, 0, &[redirect(2, 0)]);
    assert_eq!(step(&mut agent, &mut ws, &inbox, 1), [Dir::West]);
    assert_eq!(step(&mut agent, &mut ws, &[], 2)[0], Dir::East, "once is enough");
}

#[test]
fn an_arrived_robot_makes_way_to_varying_cells() {
    let mut closed = corridor();
    (closed[55], closed[65]) = (BLOCKED, BLOCKED);
    for cells in [corridor(), closed] {
        let mut first = Vec::new();
        for seed in 0..32 {
            let mut agent = RouteAgent::new(
                &AgentConfig { seed, ..config(2) },
                RouteGuidance::new(RouteParams::default()),
                Unguarded,
                Postcard,
            );
            agent.order(&GridOrder::Goal(Cell::new(5, 5)));
            let inbox = bytes(1, 0, 0, &[redirect(2, 0)]);
            let out = agent.step(&inputs(&cells, Cell::new(5, 5), &inbox), tick(0), &mut workspace());
            let Command::Move(moves) = out.command else { panic!("{seed}: {:?}", out.command) };
            first.push(moves[0]);
        }
        assert!(first.contains(&Dir::East) && first.contains(&Dir::West), "{first:?}");
    }
}
