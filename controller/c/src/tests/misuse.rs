use super::{EMPTY, IDLE, Memory, PROTOCOL, nothing, own_law, setup, waypoint, with};
use crate::agent::*;
use crate::alone::{StayaAvoider, staya_avoider_init, staya_avoider_velocity};
use crate::choices::{StayaAction, StayaCommand, StayaMode, StayaWire};
use crate::chosen::*;
use crate::external::*;
use crate::io::{StayaInputs, StayaObstacle};
use crate::parameter::{staya_get_parameter, staya_parameter, staya_set_parameter};
use crate::row::StayaParameter;
use crate::setup::*;
use crate::status::{StayaStatus, staya_status_name, staya_status_text};
use core::ffi::CStr;
use core::mem::MaybeUninit;
use core::ptr::{null, null_mut};

#[test]
fn null_is_refused_by_every_function() {
    let (setup, mut memory) = (setup(1), Memory::new());
    let agent = memory.agent(&setup).unwrap();
    let mut memory_of_own = Memory::new();
    let own = memory_of_own.agent(&own_law(2)).unwrap();
    let (inputs, mut out) = nothing();
    let (mut agents, mut avoider) = (null_mut(), null_mut::<StayaAvoider>());
    let (mut kind, mut row, mut fault) = (MaybeUninit::uninit(), MaybeUninit::uninit(), MaybeUninit::uninit());
    let mut changed = setup;
    // SAFETY: pointers that are not null are valid.
    let answers = unsafe {
        [
            staya_setup_defaults(null_mut(), 1, 0.1, 1),
            staya_init(null_mut(), STAYA_AGENT_SIZE, &setup, &mut agents),
            staya_init((&raw mut *memory).cast(), STAYA_AGENT_SIZE, &setup, null_mut()),
            staya_step(null_mut(), &inputs, &mut out),
            staya_step(agent, null(), &mut out),
            staya_step(agent, &inputs, null_mut()),
            staya_assign_waypoint(agent, 0, null()),
            staya_assign_waypoint(null_mut(), 0, &waypoint(1)),
            staya_assign_cell(null_mut(), 1, 1),
            staya_mode(agent, null_mut()),
            staya_neighbors(agent, null_mut(), 0, null_mut()),
            staya_neighbors(agent, null_mut(), 1, &mut 0),
            staya_digest(agent, null_mut()),
            staya_move(null_mut(), [0.0f32; 3].as_ptr()),
            staya_get_parameter(agent, c"speed_mps".as_ptr(), null_mut()),
            staya_set_parameter(null_mut(), c"speed_mps".as_ptr(), 1.0),
            staya_set_parameter(agent, null(), 1.0),
            staya_parameter(agent, 0, null_mut()),
            staya_choose_law(null_mut(), c"boids".as_ptr()),
            staya_choose_law(&mut changed, null()),
            staya_formation_from_graph(null_mut(), null(), 0, null(), 0, 0, 1),
            staya_choose_layer(null_mut(), c"orca".as_ptr()),
            staya_choose_layer(&mut changed, null()),
            staya_set(null_mut(), c"orca".as_ptr(), 1.0),
            staya_set(&mut changed, null(), 1.0),
            staya_set_word(&mut changed, null(), c"true".as_ptr()),
            staya_set_word(&mut changed, c"waits".as_ptr(), null()),
            staya_explain(null(), fault.as_mut_ptr()),
            staya_explain(&changed, null_mut()),
            staya_law(0, null_mut()),
            staya_layer(0, null_mut()),
            staya_law_row(null(), 0, row.as_mut_ptr()),
            staya_layer_row(&changed, 0, null_mut()),
            staya_avoider_init(null_mut(), 256, &setup, &mut avoider),
            staya_avoider_velocity(null_mut(), null(), null(), null(), null(), 0, null(), 0, null_mut()),
            staya_hear(null_mut(), &inputs),
            staya_hear(own, null()),
            staya_act(null_mut(), &inputs, &mut out),
            staya_act(own, &inputs, null_mut()),
            staya_decide(null_mut(), &IDLE),
            staya_decide(own, null()),
            staya_set_payload(null_mut(), null(), 0),
            staya_set_payload(own, null(), 1),
            staya_send(null_mut(), 1, null(), 0, 1),
            staya_send(own, 1, null(), 1, 1),
            staya_received(null_mut(), null_mut(), 0, &mut 0),
            staya_received(own, null_mut(), 1, &mut 0),
            staya_received(own, null_mut(), 0, null_mut()),
        ]
    };
    // SAFETY: there is space.
    assert_eq!(unsafe { staya_law(99, kind.as_mut_ptr()) }, StayaStatus::Unknown);
    for (index, answer) in answers.into_iter().enumerate() {
        // An empty graph does not have a place 0, which is checked first.
        let wanted = if index == 20 { StayaStatus::Shape } else { StayaStatus::Null };
        assert_eq!(answer, wanted, "number {index}");
    }
}

#[test]
fn invalid_memory_is_refused() {
    let (setup, mut memory) = (setup(1), Memory::new());
    let base: *mut u8 = (&raw mut *memory).cast();
    let (bytes, mut agent) = (staya_agent_bytes(), null_mut());
    assert!(bytes <= STAYA_AGENT_SIZE);
    // SAFETY: within the memory, or rejected.
    unsafe {
        assert_eq!(staya_init(base.cast(), bytes - 1, &setup, &mut agent), StayaStatus::MemorySize);
        assert_eq!(staya_init(base.add(1).cast(), bytes, &setup, &mut agent), StayaStatus::Alignment);
        assert!(agent.is_null());
        let mut mode = 9;
        assert_eq!(staya_mode(base.cast(), &mut mode), StayaStatus::NotThere);
        assert_eq!(staya_mode(base.add(4).cast(), &mut mode), StayaStatus::Alignment);
        assert_eq!(staya_init(base.cast(), bytes, &setup, &mut agent), StayaStatus::Ok);
        assert_eq!((staya_mode(agent, &mut mode), mode), (StayaStatus::Ok, 0));
        let wrong = StayaSetup { id: 0, ..setup };
        assert_eq!(staya_init(base.cast(), bytes, &wrong, &mut agent), StayaStatus::NoRobot);
        assert_eq!(staya_mode(base.cast(), &mut mode), StayaStatus::NotThere);
    }
}

#[test]
fn invalid_setups_return_their_status() {
    let good = setup(3);
    let refused = |change: &dyn Fn(&mut StayaSetup)| {
        let (mut setup, mut memory) = (good, Memory::new());
        change(&mut setup);
        memory.agent(&setup).unwrap_err()
    };
    assert_eq!(refused(&|s| s.version = 0), StayaStatus::Version);
    assert_eq!(refused(&|s| s.tick_us = 0), StayaStatus::Number);
    assert_eq!(refused(&|s| s.radius_m = f32::NAN), StayaStatus::Number);
    assert_eq!(refused(&|s| s.speed_mps = 0.0), StayaStatus::Number);
    assert_eq!(refused(&|s| s.law = 200), StayaStatus::Law);
    assert_eq!(refused(&|s| s.layer = 200), StayaStatus::Law);
    assert_eq!(refused(&|s| s.wire = 200), StayaStatus::Choice);
    for protocol in [0, 1, 63] {
        assert_eq!(refused(&|s| *s = StayaSetup { protocol, ..own_law(1) }), StayaStatus::Choice);
    }
    #[cfg(feature = "grid")]
    {
        let formation = with(3, c"formation", c"none");
        let refused = |change: &dyn Fn(&mut StayaSetup)| {
            refused(&|s| {
                *s = formation;
                change(s);
            })
        };
        assert_eq!(refused(&|s| s.sight_cells = 6), StayaStatus::Search);
        assert_eq!(refused(&|s| s.formation.neighbor_count = 9), StayaStatus::TooMany);
        assert_eq!(refused(&|s| s.formation.neighbor_count = 1), StayaStatus::Shape);
    }
    #[cfg(feature = "mavlink")]
    assert_eq!(refused(&|s| (s.wire, s.id) = (StayaWire::Mavlink as u8, 255)), StayaStatus::Number);
    #[cfg(not(feature = "mavlink"))]
    assert_eq!(refused(&|s| s.wire = StayaWire::Mavlink as u8), StayaStatus::NotBuilt);
}

fn digest(agent: *const StayaAgent) -> u64 {
    let mut digest = 0;
    // SAFETY: there is an agent.
    assert_eq!(unsafe { staya_digest(agent, &mut digest) }, StayaStatus::Ok);
    digest
}

#[test]
fn invalid_inputs_change_nothing() {
    let mut memory = Memory::new();
    let agent = memory.agent(&setup(1)).unwrap();
    let (mut inputs, mut out) = nothing();
    out.leader = 77;
    let many = [StayaObstacle::default(); 33];
    let before = digest(agent);
    // SAFETY: pointers that are not null are valid.
    unsafe {
        (inputs.obstacles, inputs.obstacle_count) = (many.as_ptr(), many.len());
        assert_eq!(staya_step(agent, &inputs, &mut out), StayaStatus::TooMany);
        let strange = StayaObstacle { shape: 256, ..StayaObstacle::default() };
        (inputs.obstacles, inputs.obstacle_count) = (&strange, 1);
        assert_eq!(staya_step(agent, &inputs, &mut out), StayaStatus::Choice);
        (inputs.obstacles, inputs.obstacle_count) = (null(), 1);
        assert_eq!(staya_step(agent, &inputs, &mut out), StayaStatus::Null);
        (inputs.obstacles, inputs.obstacle_count) = (&strange, usize::MAX);
        assert_eq!(staya_step(agent, &inputs, &mut out), StayaStatus::TooMany);
        assert_eq!((digest(agent), out.leader), (before, 77));
        assert_eq!(staya_assign_cell(agent, 1, 1), StayaStatus::Task);
        assert_eq!(staya_assign_waypoint(agent, 9, &waypoint(1)), StayaStatus::Task);
        let nowhere = StayaWaypoint { velocity_mps: [f32::NAN; 3], ..waypoint(1) };
        assert_eq!(staya_assign_waypoint(agent, 0, &nowhere), StayaStatus::Number);
    }
}

#[test]
fn only_a_law_of_your_own_is_decided() {
    let (mut memory, mut count) = (Memory::new(), 77);
    let agent = memory.agent(&setup(1)).unwrap();
    // SAFETY: pointers that are not null are valid.
    let answers = unsafe {
        [
            staya_decide(agent, &IDLE),
            staya_set_payload(agent, null(), 0),
            staya_send(agent, 2, null(), 0, 1),
            staya_received(agent, null_mut(), 0, &mut count),
        ]
    };
    assert_eq!((answers, count), ([StayaStatus::Task; 4], 77));
}

#[test]
fn invalid_decisions_and_messages_change_nothing() {
    let (mut memory, bytes) = (Memory::new(), [1; 64]);
    let agent = memory.agent(&own_law(1)).unwrap();
    let velocity = StayaDecision { kind: StayaAction::Velocity as u8, ..IDLE };
    let moves = StayaDecision { kind: StayaAction::Moves as u8, ..IDLE };
    let before = digest(agent);
    // SAFETY: there is an agent, and all pointers are valid.
    unsafe {
        for (decision, status) in [
            (StayaDecision { kind: 4, ..IDLE }, StayaStatus::Choice),
            (StayaDecision { wait: 8, ..IDLE }, StayaStatus::Choice),
            (StayaDecision { progress: 5, ..IDLE }, StayaStatus::Choice),
            (StayaDecision { wait: 1, ..velocity }, StayaStatus::Choice),
            (StayaDecision { progress: 2, ..velocity }, StayaStatus::Choice),
            (StayaDecision { velocity_mps: [f32::NAN, 0.0, 0.0], ..velocity }, StayaStatus::Number),
            (StayaDecision { has_way: 1, way_m: [0.0, f32::INFINITY, 0.0], ..velocity }, StayaStatus::Number),
            (StayaDecision { move_count: 9, ..moves }, StayaStatus::TooMany),
            (StayaDecision { move_count: 1, moves: [9; 8], ..moves }, StayaStatus::Choice),
        ] {
            assert_eq!(staya_decide(agent, &decision), status, "{decision:?}");
        }
        assert_eq!(staya_set_payload(agent, bytes.as_ptr(), STAYA_PAYLOAD + 1), StayaStatus::TooMany);
        assert_eq!(staya_send(agent, 2, bytes.as_ptr(), STAYA_MESSAGE + 1, 1), StayaStatus::TooMany);
        assert_eq!(staya_send(agent, 0, bytes.as_ptr(), STAYA_CONTENT + 1, 1), StayaStatus::TooMany);
        assert_eq!(staya_send(agent, 2, bytes.as_ptr(), 1, 0), StayaStatus::Number);
        assert_eq!(digest(agent), before);
        for _ in 0..4 {
            assert_eq!(staya_send(agent, 2, bytes.as_ptr(), STAYA_MESSAGE, 1), StayaStatus::Ok);
        }
        assert_eq!(staya_send(agent, 2, bytes.as_ptr(), 1, 1), StayaStatus::TooMany);
        assert_eq!(staya_send(agent, 0, bytes.as_ptr(), STAYA_CONTENT, 0), StayaStatus::Ok);
        assert_eq!(staya_send(agent, 0, null(), 0, 0), StayaStatus::TooMany);
        assert_eq!(staya_set_payload(agent, bytes.as_ptr(), STAYA_PAYLOAD), StayaStatus::Ok);
        assert_eq!(staya_set_payload(agent, null(), 0), StayaStatus::Ok);
    }
}

#[test]
fn a_step_acts_once_after_it_has_heard() {
    let (mut memory, mut out) = (Memory::new(), nothing().1);
    let agent = memory.agent(&own_law(1)).unwrap();
    let inputs = StayaInputs { max_speed_mps: 1.0, ..nothing().0 };
    let wrong = StayaInputs { obstacle_count: 1, ..inputs };
    out.leader = 77;
    // SAFETY: all pointers that are not null are valid.
    unsafe {
        assert_eq!(staya_act(agent, &inputs, &mut out), StayaStatus::NotHeard);
        assert_eq!(staya_hear(agent, &wrong), StayaStatus::Null);
        assert_eq!(staya_act(agent, &inputs, &mut out), StayaStatus::NotHeard);
        for _ in 0..2 {
            assert_eq!(staya_hear(agent, &inputs), StayaStatus::Ok);
        }
        assert_eq!((staya_act(agent, &wrong, &mut out), out.leader), (StayaStatus::Null, 77));
        assert_eq!((staya_act(agent, &inputs, &mut out), out.leader), (StayaStatus::Ok, 0));
        assert_eq!(staya_act(agent, &inputs, &mut out), StayaStatus::NotHeard);
        assert_eq!(staya_hear(agent, &inputs), StayaStatus::Ok);
        assert_eq!(staya_step(agent, &inputs, &mut out), StayaStatus::Ok);
        assert_eq!(staya_act(agent, &inputs, &mut out), StayaStatus::NotHeard);
    }
}

#[test]
fn a_robot_whose_law_hangs_stays() {
    let (mut memory, mut out) = (Memory::new(), nothing().1);
    let agent = memory.agent(&StayaSetup { protocol: PROTOCOL, ..with(1, c"external", c"none") }).unwrap();
    let inputs = StayaInputs { max_speed_mps: 1.0, ..nothing().0 };
    let east = StayaDecision { velocity_mps: [0.5, 0.0, 0.0], kind: StayaAction::Velocity as u8, ..IDLE };
    let mut step = || {
        // SAFETY: all pointers are valid.
        assert_eq!(unsafe { staya_step(agent, &inputs, &mut out) }, StayaStatus::Ok);
        (out.command, out.mode, out.velocity_mps[0])
    };
    let goes = StayaCommand::Velocity as u8;
    assert_eq!(step(), (goes, StayaMode::Idle as u8, 0.0));
    // SAFETY: all pointers are valid.
    assert_eq!(unsafe { staya_decide(agent, &east) }, StayaStatus::Ok);
    assert_eq!(step(), (goes, StayaMode::Cruise as u8, 0.5));
    assert_eq!(step(), (goes, StayaMode::Cruise as u8, 0.0));
}

#[test]
fn received_messages_are_taken_out_oldest_first() {
    let (mut memories, inputs) = ([Memory::new(), Memory::new()], StayaInputs { max_speed_mps: 1.0, ..nothing().0 });
    let [one, two] = [1, 2].map(|id| memories[id - 1].agent(&own_law(id as u32)).unwrap());
    let (mut out, mut messages, mut count) = (nothing().1, [EMPTY; STAYA_INBOX], 77);
    // SAFETY: all pointers are valid.
    unsafe {
        for number in 0..6u8 {
            assert_eq!(staya_send(one, 0, [number, PROTOCOL].as_ptr(), 2, 0), StayaStatus::Ok);
            assert_eq!(staya_step(one, &inputs, &mut out), StayaStatus::Ok);
            let heard = StayaInputs { inbox: out.outbox.as_ptr(), inbox_bytes: out.outbox_bytes.into(), ..inputs };
            assert_eq!(staya_hear(two, &heard), StayaStatus::Ok);
        }
        assert_eq!((staya_received(two, null_mut(), 0, &mut count), count), (StayaStatus::Ok, 0));
        assert_eq!((staya_received(two, messages.as_mut_ptr(), 1, &mut count), count), (StayaStatus::Ok, 1));
        let StayaMessage { from, dropped, is_order, count: length, bytes } = messages[0];
        assert_eq!((from, dropped, is_order, &bytes[..length.into()]), (1, 2, 0, &[2, PROTOCOL][..]));
        assert_eq!((staya_received(two, messages.as_mut_ptr(), STAYA_INBOX, &mut count), count), (StayaStatus::Ok, 3));
        assert_eq!(messages.map(|message| message.bytes[0]), [3, 4, 5, 0]);
        assert_eq!((staya_received(two, messages.as_mut_ptr(), STAYA_INBOX, &mut count), count), (StayaStatus::Ok, 0));
    }
}

#[test]
fn parameters_are_listed_and_set_by_name() {
    let mut memory = Memory::new();
    let agent = memory.agent(&setup(1)).unwrap();
    let mut listed = Vec::new();
    // SAFETY: there is an agent, and texts end with a zero.
    unsafe {
        let mut row = MaybeUninit::<StayaParameter>::uninit();
        while staya_parameter(agent, listed.len() as u32, row.as_mut_ptr()) == StayaStatus::Ok {
            let StayaParameter { name, unit, text, least, greatest, value, .. } = row.assume_init();
            let [name, unit, text] =
                [&name[..], &unit, &text].map(|text| CStr::from_ptr(text.as_ptr()).to_str().unwrap());
            assert!(unit.len() <= 5 && text.len() > 5 && least <= value && value <= greatest, "{name}");
            listed.push(name.to_owned());
        }
        let end = listed.len() as u32;
        assert_eq!(staya_parameter(agent, end, row.as_mut_ptr()), StayaStatus::Unknown);
        assert_eq!(staya_parameter(agent, u32::MAX, row.as_mut_ptr()), StayaStatus::Unknown);
        assert_eq!(listed[..5], ["radius_m", "beacon_period_s", "speed_mps", "tolerance_m", "horizon_s"]);
        let (speed, mut value) = (c"speed_mps".as_ptr(), 0.0);
        assert_eq!(staya_set_parameter(agent, speed, 0.75), StayaStatus::Ok);
        assert_eq!((staya_get_parameter(agent, speed, &mut value), value), (StayaStatus::Ok, 0.75));
        assert_eq!(staya_set_parameter(agent, speed, f32::NAN), StayaStatus::Parameter);
        for other in [c"spacing_m", c"\xff"] {
            assert_eq!(staya_set_parameter(agent, other.as_ptr(), 1.0), StayaStatus::Parameter);
        }
    }
}

#[test]
fn every_status_has_a_name_and_a_text() {
    // SAFETY: the strings end with a zero.
    let text = |pointer| unsafe { CStr::from_ptr(pointer) }.to_str().unwrap();
    for status in 0..22 {
        assert!(text(staya_status_name(status)).starts_with("STAYA_STATUS_"), "{status}");
        assert!(text(staya_status_text(status)).len() > 5);
    }
    for none in [-1, 22, i32::MAX] {
        assert_eq!(text(staya_status_name(none)), "(no status)");
    }
}
