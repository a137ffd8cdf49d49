//! Tests of diagonal moves across those of other robots.

use super::*;

/// The first move of robot 2 in (5, 5), which heads north-east, `ticks` after it heard `others`.
fn first_move(others: &[(u32, Beacon)], cells: &[u8], ticks: u16) -> Dir {
    let (mut route, mut formation) = (route_agent(2), formation_agent(2));
    route.order(&GridOrder::Goal(Cell::new(60, 60)));
    formation.order(&GridOrder::Goal(Cell::new(60, 60)));
    let mut first = [Dir::Stay; 2];
    for n in 0..=ticks {
        // The formation of robots 1 to 3 takes the others for strangers.
        let inbox = [0, 3].map(|offset| match n {
            0 => others.iter().flat_map(|(id, it)| bytes(id + offset, 0, 0, &[Message::Beacon(it.clone())])).collect(),
            _ => Vec::new(),
        });
        let here = |inbox| inputs(cells, Cell::new(5, 5), inbox);
        let out = [
            route.step(&here(&inbox[0]), tick(n.into()), &mut workspace()),
            formation.step(&here(&inbox[1]), tick(n.into()), &mut workspace()),
        ];
        first = out.map(|out| match out.command {
            Command::Move(moves) => moves[0],
            Command::Hold | Command::Velocity(_) => Dir::Stay,
        });
    }
    assert_eq!(first[0] == Dir::NorthEast, first[1] == Dir::NorthEast, "both laws agree: {first:?}");
    first[0]
}

fn beacon(x: i16, y: i16, heading: Dir, busy_ms: u16) -> Beacon {
    on_grid(GridPayload { heading, busy_ms, ..in_cell(x, y) })
}

#[test]
fn a_diagonal_under_way_or_announced_is_not_crossed() {
    for id in [1, 3] {
        for crossing in [
            beacon(6, 5, Dir::NorthWest, 0),
            beacon(5, 6, Dir::SouthEast, 0),
            beacon(5, 6, Dir::NorthWest, 1410),
            beacon(5, 6, Dir::NorthWest, 7000),
            beacon(6, 5, Dir::SouthEast, 1410),
        ] {
            let first = first_move(&[(id, crossing.clone())], &FLAT, 0);
            assert!(!matches!(first, Dir::NorthEast | Dir::Stay), "{first:?} across {crossing:?}");
        }
        for beside in [
            beacon(6, 5, Dir::NorthEast, 0),
            beacon(6, 5, Dir::NorthWest, 1410),
            beacon(5, 6, Dir::NorthWest, 0),
            beacon(5, 6, Dir::North, 1410),
            beacon(5, 4, Dir::NorthEast, 0),
            beacon(4, 5, Dir::NorthEast, 0),
            beacon(6, 5, Dir::Stay, 0),
        ] {
            assert_eq!(first_move(&[(id, beside.clone())], &FLAT, 0), Dir::NorthEast, "beside {beside:?}");
        }
    }
}

#[test]
fn a_beacon_is_a_tick_old() {
    let ended = beacon(5, 6, Dir::NorthWest, 1000);
    assert_eq!(first_move(&[(1, ended)], &FLAT, 0), Dir::NorthEast, "it is free now");
    let longer = beacon(5, 6, Dir::NorthWest, 3500);
    assert_ne!(first_move(&[(1, longer.clone())], &FLAT, 2), Dir::NorthEast);
    assert_eq!(first_move(&[(1, longer)], &FLAT, 3), Dir::NorthEast);
}

#[test]
fn an_announced_diagonal_is_avoided_for_as_long_as_it_takes() {
    let announced = [(1, beacon(6, 5, Dir::NorthWest, 0))];
    for class in 1..4 {
        let cells = [class; 121];
        // A move begun at the tick before it was heard takes 1.41 ticks per class.
        let left = (99 * u16::from(class)).div_ceil(70) - 1;
        assert_ne!(first_move(&announced, &cells, left - 1), Dir::NorthEast, "class {class}");
        assert_eq!(first_move(&announced, &cells, left), Dir::NorthEast, "class {class}");
    }
}

#[test]
fn an_announced_move_into_an_occupied_cell_is_not_waited_for() {
    let others = [(1, beacon(6, 5, Dir::NorthWest, 0)), (3, beacon(5, 6, Dir::Stay, 0))];
    assert_eq!(first_move(&others, &FLAT, 0), Dir::NorthEast);
}
