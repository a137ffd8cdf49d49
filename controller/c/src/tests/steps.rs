//! Steps through C; `cargo xtask c` compares whole swarms of the plane.

#[cfg(all(feature = "grid", not(feature = "fixed"), not(feature = "small")))]
use super::shows;
use super::{Memory, nothing, setup, waypoint, with};
use crate::agent::*;
use crate::alone::*;
use crate::choices::{StayaCommand, StayaDir, StayaMode};
use crate::setup::StayaSetup;
use crate::status::StayaStatus;
use core::ptr::{null, null_mut};

#[test]
fn two_robots_hear_each_other() {
    let (mut first, mut second) = (Memory::new(), Memory::new());
    let other = StayaSetup { flock: 3, ..setup(2) };
    let agents = [first.agent(&setup(1)).unwrap(), second.agent(&other).unwrap()];
    let (mut inputs, mut out) = nothing();
    let mut air = Vec::new();
    for tick in 0..3 {
        for (place, agent) in (0i32..).zip(agents) {
            (inputs.now_us, inputs.max_speed_mps) = (tick * 50_000, 0.5);
            inputs.position_mm = [place * 1000, 0, 0];
            (inputs.inbox, inputs.inbox_bytes) = (air.as_ptr(), air.len());
            // SAFETY: all pointers are valid.
            unsafe {
                assert_eq!(staya_assign_waypoint(agent, 0, &waypoint(5000)), StayaStatus::Ok);
                assert_eq!(staya_step(agent, &inputs, &mut out), StayaStatus::Ok);
            }
            assert_eq!((out.command, out.mode), (StayaCommand::Velocity as u8, StayaMode::Cruise as u8));
            air = out.outbox[..out.outbox_bytes.into()].to_vec();
        }
    }
    let (mut known, mut count) = ([StayaNeighbor::default(); 2], 0);
    // SAFETY: all pointers are valid.
    let status = unsafe { staya_neighbors(agents[0], known.as_mut_ptr(), known.len(), &mut count) };
    assert_eq!((status, count, known[0].id, known[0].position_mm), (StayaStatus::Ok, 1, 2, [1000, 0, 0]));
    let StayaNeighbor { flock, leader, cell, heading, .. } = known[0];
    assert_eq!((flock, leader, cell.x, heading), (3, 0, 0, StayaDir::Stay as u8), "not across land in cells");
}

#[test]
fn orca_without_an_agent_keeps_clear_in_any_order() {
    #[repr(align(8))]
    struct Room([u8; STAYA_AVOIDER_SIZE]);
    let setup = with(1, c"waypoint", c"orca");
    let body = StayaBody {
        id: 1,
        velocity_mps: [1.0, 0.0, 0.0],
        radius_m: 0.2,
        max_speed_mps: 1.0,
        max_acceleration_mps2: f32::MAX,
        step_s: 0.1,
    };
    let other = |id: u32, x: f32| StayaNearby {
        id,
        offset_m: [x, 0.05, 0.0],
        velocity_mps: [-1.0, 0.0, 0.0],
        radius_m: 0.2,
        gives_way: 1,
        is_parked: 0,
        is_stranger: 0,
    };
    // More than are considered, with the nearest one last.
    let far: Vec<_> = (2..40).rev().map(|id| other(id, id as f32 / 2.0)).collect();
    let near: Vec<_> = far.iter().rev().copied().collect();
    let velocity = |all: &[StayaNearby]| {
        let (mut room, mut avoider, mut best) = (Room([0; STAYA_AVOIDER_SIZE]), null_mut(), [0.0f32; 3]);
        let wish = [1.0f32, 0.0, 0.0];
        // SAFETY: all pointers are valid.
        unsafe {
            let place = (&raw mut room.0).cast();
            let made = staya_avoider_init(place, STAYA_AVOIDER_SIZE, &setup, &mut avoider);
            assert_eq!(made, StayaStatus::Ok);
            let (first, count) = (all.as_ptr(), all.len());
            let (to, none) = (best.as_mut_ptr(), null());
            let status = staya_avoider_velocity(avoider, &body, wish.as_ptr(), none, first, count, null(), 0, to);
            assert_eq!(status, StayaStatus::Ok);
        }
        best
    };
    assert_eq!(velocity(&far), velocity(&near));
    assert_eq!(velocity(&[]), [1.0, 0.0, 0.0]);
    assert_ne!(velocity(&near), [1.0, 0.0, 0.0]);
}

#[cfg(all(feature = "grid", not(feature = "fixed"), not(feature = "small")))]
#[test]
fn a_formation_on_the_grid_equals_that_of_rust() {
    use crate::setup::{StayaCell, StayaEdge, staya_formation_from_graph};
    use staya_controller::agent::*;
    use staya_controller::formation::FormationParams;
    use staya_controller::grid::{Cell, Window};
    use staya_controller::robot::RobotId;
    use staya_controller::route::RouteParams;
    use staya_controller::template::Template;
    use staya_controller::time::{Duration, Instant};
    use staya_controller::wire::Postcard;

    let places = [(0, 0), (-2, 0), (0, -2)];
    let edges = [(0u16, 1u16), (0, 2)];
    let tick = Duration::from_micros(50_000);
    let (mut twins, mut memories) = (Vec::new(), Vec::new());
    for own in 0..3usize {
        let mut setup = with(own as u32 + 1, c"formation", c"none");
        (setup.on_grid, setup.seed) = (1, 5);
        let cells = places.map(|(x, y)| StayaCell { x, y });
        let graph = edges.map(|(a, b)| StayaEdge { a, b });
        // SAFETY: all pointers are valid.
        let status =
            unsafe { staya_formation_from_graph(&mut setup.formation, cells.as_ptr(), 3, graph.as_ptr(), 2, own, 2) };
        assert_eq!(status, StayaStatus::Ok);
        let mut memory = Memory::new();
        memory.agent(&setup).unwrap();
        memories.push(memory);
        let template = Template::from_graph(&places.map(|(x, y)| Cell::new(x, y)), &edges, own, 2).unwrap();
        let law = FormationGuidance::new(RouteParams::default(), FormationParams::default(), template);
        let config = AgentConfig { seed: 5, ..AgentConfig::new(RobotId(own as u32 + 1), 0.1, tick) };
        twins.push(FormationAgent::new(&config, law, Unguarded, Postcard));
    }
    let land: Vec<u8> = (0..121u32).map(|cell| (cell.wrapping_mul(2_654_435_761) >> 30) as u8 + 1).collect();
    let (mut workspace, mut said) = (GridWorkspace::new(), vec![Vec::new(); 3]);
    let mut cells = places.map(|(x, y)| Cell::new(x + 20, y + 20));
    for (place, (memory, twin)) in places.iter().zip(memories.iter_mut().zip(&mut twins)) {
        let goal = Cell::new(30 + place.0, 28 + place.1);
        // SAFETY: there is an agent.
        assert_eq!(unsafe { staya_assign_cell((&raw mut **memory).cast(), goal.x, goal.y) }, StayaStatus::Ok);
        twin.order(&GridOrder::Goal(goal));
    }
    for step in 0..40u32 {
        let heard: Vec<u8> = said.concat();
        for own in 0..3 {
            let (mut inputs, mut out) = nothing();
            let (cell, origin) = (cells[own], cells[own] - Cell::new(5, 5));
            inputs.position_mm = [i32::from(cell.x) * 1000, i32::from(cell.y) * 1000, 0];
            inputs.now_us = step * 50_000;
            inputs.cell = cell.into();
            inputs.window_origin = origin.into();
            (inputs.window_width, inputs.window_height, inputs.window) = (11, 11, land.as_ptr());
            (inputs.inbox, inputs.inbox_bytes) = (heard.as_ptr(), heard.len());
            let agent: *mut StayaAgent = (&raw mut *memories[own]).cast();
            // SAFETY: all pointers are valid.
            assert_eq!(unsafe { staya_step(agent, &inputs, &mut out) }, StayaStatus::Ok);
            let position = staya_controller::geom::Position::from_mm(inputs.position_mm);
            let own_inputs = Inputs {
                state: KinematicState { position, ..KinematicState::default() },
                surroundings: OnGrid {
                    cell: CellState { cell, busy: Duration::ZERO },
                    window: Window::new(&land, origin, 11, 11),
                },
                inbox: &heard,
            };
            let twin = twins[own].step(&own_inputs, Instant::from_micros(step * 50_000), &mut workspace);
            shows(&out, &twin, twins[own].mode(), &format!("step {step} of {own}"));
            if let Command::Move(moves) = &twin.command {
                assert_eq!((out.moves[0], out.move_count), (moves[0].index() as u8, moves.len() as u8));
                cells[own] = cell + moves[0].offset();
            }
            said[own] = twin.outbox.to_vec();
        }
    }
    assert_ne!(cells, places.map(|(x, y)| Cell::new(x + 20, y + 20)), "no robot moved");
    let (mut known, mut count) = ([StayaNeighbor::default(); 2], 0);
    // SAFETY: all pointers are valid.
    let status = unsafe { staya_neighbors((&raw mut *memories[1]).cast(), known.as_mut_ptr(), 2, &mut count) };
    assert_eq!((status, count), (StayaStatus::Ok, 2));
    for (shown, twin) in known.iter().zip(twins[1].neighbors()) {
        let GridPayload { cell, target, heading, slot, leader, .. } = twin.payload.unwrap();
        let (shown_cell, shown_target) = (Cell::from(shown.cell), Cell::from(shown.target));
        assert_eq!((shown_cell, shown_target), (cell, target), "{shown:?}");
        assert_eq!((shown.heading, shown.slot, shown.leader), (heading.index() as u8, slot, leader.0));
    }
    assert_eq!((known[0].id, known[1].id, known[1].slot), (1, 3, 2));
}
