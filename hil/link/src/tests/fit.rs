use crate::capacities::{Capacities, window_cells};
use crate::fit::{Cut, WindowTooLarge};
use crate::robot::{Controller, Small};
use crate::surroundings::OBSTACLE_BYTES;
use proptest::collection::vec;
use proptest::prelude::*;
use staya_controller::agent::{AnyInputs, AnySurroundings, CellState, InPlane, Inputs, KinematicState, OnGrid};
use staya_controller::geom::{Vec2, Vec3};
use staya_controller::grid::{Cell, Window};
use staya_controller::obstacle::Obstacle;
use staya_controller::robot::RobotId;
use staya_controller::time::Instant;
use staya_controller::wire::{Beacon, Format, Header, Message, Postcard, Wire};
use staya_mavlink::any::AnyWire;
use std::vec::Vec;

const NOW: Instant = Instant::from_micros(5);

fn room(obstacles: u16, inbox_bytes: u16) -> Capacities {
    Capacities { obstacles, inbox_bytes, ..Small::new().capacities() }
}

fn inputs<'a>(inbox: &'a [u8], obstacles: &'a [Obstacle<f32>]) -> AnyInputs<'a, f32> {
    Inputs {
        state: KinematicState::default(),
        surroundings: AnySurroundings::InPlane(InPlane { max_speed_mps: 1.0, obstacles }),
        inbox,
    }
}

fn ball(x: f32) -> Obstacle<f32> {
    Obstacle::Ball { center_m: Vec3::new(x, 0.0, 0.0), radius_m: 0.5 }
}

#[test]
fn inbox_keeps_its_newest_whole_frames() {
    let inbox = [1, 1, 0, 2, 0, 3, 3, 3, 0];
    let kept = |bytes: u16| {
        let (step, cut) = room(0, bytes).fit(1, NOW, &inputs(&inbox, &[]), &Postcard, &mut []).expect("no window");
        assert_eq!(cut.inbox_bytes, inbox.len() - step.inbox.len());
        step.inbox.to_vec()
    };
    assert_eq!(kept(9), inbox);
    assert_eq!(kept(8), [2, 0, 3, 3, 3, 0]);
    assert_eq!(kept(6), [2, 0, 3, 3, 3, 0]);
    assert_eq!(kept(5), [3, 3, 3, 0]);
    assert_eq!(kept(4), [3, 3, 3, 0]);
    assert!(kept(3).is_empty() && kept(0).is_empty());
}

#[test]
fn nearest_obstacles_stay_in_their_order() {
    let far_first = [ball(9.0), ball(3.0), ball(-3.0), ball(1.0)];
    let kept = |count: u16| {
        let mut packed = [0; 4 * OBSTACLE_BYTES];
        let (step, cut) =
            room(count, 0).fit(1, NOW, &inputs(&[], &far_first), &Postcard, &mut packed).expect("no window");
        let surroundings = step.surroundings.expect("given");
        let kept: Vec<Obstacle<f32>> = surroundings.obstacles().map(|o| o.expect("known")).collect();
        assert_eq!(cut.obstacles, 4 - kept.len());
        kept
    };
    assert_eq!(kept(4), far_first);
    assert_eq!(kept(3), far_first[1..]);
    assert_eq!(kept(2), [ball(3.0), ball(1.0)]);
    assert_eq!(kept(1), [ball(1.0)]);
    assert!(kept(0).is_empty());
}

#[test]
fn obstacle_without_a_position_is_removed_first() {
    let nowhere = Obstacle::Wall([Vec2::new(f32::NAN, 0.0); 2]);
    let obstacles = [nowhere, ball(4.0), ball(2.0)];
    let mut packed = [0; 3 * OBSTACLE_BYTES];
    let (step, _) = room(2, 0).fit(1, NOW, &inputs(&[], &obstacles), &Postcard, &mut packed).expect("no window");
    let kept = step.surroundings.map(|packed| packed.obstacles().flatten().collect::<Vec<_>>());
    assert_eq!(kept, Some(std::vec![ball(4.0), ball(2.0)]));
}

#[test]
fn terrain_is_never_cut() {
    assert_eq!(window_cells(169), 121);
    assert_eq!((window_cells(0), window_cells(8), window_cells(9)), (0, 0, 1));
    let cells = [1; 144];
    for (side, fits) in [(11, true), (12, false)] {
        let land = &cells[..side * side];
        let window = Window::new(land, Cell::default(), side as u16, side as u16);
        let grid = OnGrid { cell: CellState::default(), window };
        let inputs = Inputs { surroundings: AnySurroundings::OnGrid(grid), ..inputs(&[], &[]) };
        let fitted = room(0, 0).fit(1, NOW, &inputs, &Postcard, &mut []).map(|(step, cut)| {
            let same = step.window.and_then(|window| window.window());
            assert_eq!(same.map(|w| w.cells()), Some(land));
            cut
        });
        let too_large = WindowTooLarge { cells: 144, room: 121 };
        let expected = if fits { Ok(Cut::default()) } else { Err(too_large) };
        assert_eq!(fitted, expected);
    }
}

proptest! {
    #[test]
    fn inbox_is_cut_between_frames(frames in vec(vec(1_u8..4, 1..8), 0..12), bytes in 0_u16..70) {
        let inbox: Vec<u8> = frames.iter().flat_map(|frame| frame.iter().copied().chain([0])).collect();
        let (step, _) = room(0, bytes).fit(1, NOW, &inputs(&inbox, &[]), &Postcard, &mut []).expect("no window");
        let kept = step.inbox;
        prop_assert!(kept.len() <= usize::from(bytes) && inbox.ends_with(kept));
        let cut = &inbox[..inbox.len() - kept.len()];
        prop_assert!(cut.last().is_none_or(|byte| *byte == 0));
        if !cut.is_empty() {
            let frame = cut.len() - cut[..cut.len() - 1].iter().rposition(|b| *b == 0).map_or(0, |at| at + 1);
            prop_assert!(kept.len() + frame > usize::from(bytes));
        }
    }
}

#[test]
fn inbox_of_another_format_is_cut_between_its_frames() {
    let (header, mut inbox) = (Header { boot: 0, sender: RobotId(2), sequence: 0 }, heapless::Vec::<u8, 256>::new());
    let mut wire: AnyWire = AnyWire::new(Format::Mavlink);
    let message = Message::Beacon(Beacon::default());
    let len = wire.encode(header, &message, &mut inbox).expect("fits");
    wire.encode(header, &message, &mut inbox).expect("fits");
    let kept = |bytes: usize| {
        let fitted = room(0, bytes as u16).fit(1, NOW, &inputs(&inbox, &[]), &wire, &mut []);
        fitted.expect("no window").0.inbox.len()
    };
    assert_eq!([2 * len, 2 * len - 1, len, len - 1].map(kept), [2 * len, len, len, 0]);
}
