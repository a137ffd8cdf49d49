//! A law over the C interface equals its twin in Rust, step by step.

use super::{EMPTY, IDLE, Memory, PROTOCOL, TICK_US, nothing, own_law, setup, shows};
use crate::Layer;
use crate::agent::*;
use crate::choices::{StayaAction, StayaCommand, StayaEventKind, StayaMode};
use crate::external::*;
use crate::io::{StayaInputs, StayaOutputs};
use crate::setup::StayaCell;
use crate::status::StayaStatus;
use crate::{NEIGHBORS, Number};
use serde::{Deserialize, Serialize};
use staya_controller::agent::{
    Action, Agent, BadInput, Decision, InPlane, Inputs, KinematicState, Law, Progress, Protocol, Radio, Tools, View,
};
use staya_controller::geom::{Position, Vec3};
use staya_controller::grid::Dir;
use staya_controller::rand::Rng;
use staya_controller::robot::RobotId;
use staya_controller::scalar::cast;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::{Content, Header, Postcard, ProtocolId, encode, frames};
use std::collections::BTreeMap;

const OWN: ProtocolId = ProtocolId(PROTOCOL);
const VALID_US: i32 = 200_000;
/// The robots turn at both ends of this beat.
const BEAT_MM: i32 = 3_000;
const ROOM_MM: i32 = 1_200;

/// The law in both languages: all robots patrol at the pace of the slowest one, and a robot asks
/// the one ahead to make room.
#[derive(Clone, Debug, Default, Serialize)]
struct Patrol {
    own_mmps: u16,
    goes_west: bool,
    makes_room: u8,
}

/// Its actions in a step.
struct Act {
    east_mps: f32,
    asks: Option<u32>,
    turns: bool,
}

impl Patrol {
    fn act(&mut self, x_mm: i32, peers: impl Iterator<Item = (u32, i32, u16)>) -> Act {
        let (mut pace_mmps, mut ahead) = (self.own_mmps, None);
        let sign = if self.goes_west { -1 } else { 1 };
        for (id, other_mm, other_mmps) in peers {
            pace_mmps = pace_mmps.min(other_mmps);
            if (1..ROOM_MM).contains(&(sign * (other_mm - x_mm))) {
                ahead = Some(id);
            }
        }
        let turns = sign * x_mm > BEAT_MM;
        self.goes_west ^= turns;
        self.makes_room = self.makes_room.saturating_sub(1);
        let factor = if self.makes_room > 0 { 2.0 } else { 1.0 };
        Act { east_mps: f32::from(pace_mmps) / 1000.0 * factor * sign as f32, asks: ahead, turns }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Pace([u8; 2]);

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Say {
    MakeRoom { steps: u8 },
    Turn { goes_west: bool },
}

impl Content for Pace {}
impl Content for Say {}

#[derive(Clone, Debug)]
enum Patrols {}

impl Protocol for Patrols {
    const ID: ProtocolId = OWN;
    type Payload = Pace;
    type Message = Say;
    type Order = Pace;
}

impl Law<Number> for Patrol {
    type Surroundings<'a> = InPlane<'a, Number>;
    type Protocol = Patrols;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, Number, Patrols>,
        _: &InPlane<'_, Number>,
        mut tools: Tools<'_, Number, Self>,
    ) -> Result<Decision<Number>, BadInput> {
        view.can_move()?;
        let peers =
            view.peers().map(|(other, Pace(mmps))| (other.id.0, other.position.mm[0], u16::from_le_bytes(mmps)));
        let act = self.act(view.state.position.mm[0], peers);
        if let Some(ahead) = act.asks {
            tools.radio.send(RobotId(ahead), &Say::MakeRoom { steps: 9 }, Duration::from_micros(VALID_US));
        }
        if act.turns {
            tools.radio.broadcast(&Say::Turn { goes_west: self.goes_west });
        }
        let wish_mps = Vec3::new(cast(act.east_mps), cast(0.0), cast(0.0));
        let way_m = Some(wish_mps);
        Ok(Decision::new(Action::Velocity { wish_mps, way_m }, Progress::Going))
    }

    fn payload(&mut self, _: &InPlane<'_, Number>, _: Dir, _: &mut Radio<'_, Patrols>) -> Pace {
        Pace(self.own_mmps.to_le_bytes())
    }

    fn receive(&mut self, _: RobotId, message: &Say, _: &mut Radio<'_, Patrols>) -> bool {
        match message {
            Say::MakeRoom { steps } => self.makes_room = *steps,
            Say::Turn { goes_west } => self.goes_west = *goes_west,
        }
        true
    }

    fn order(&mut self, Pace(mmps): &Pace) -> bool {
        self.own_mmps = u16::from_le_bytes(*mmps);
        true
    }
}

/// The same law as a program in C would have it.
fn step_in_c(agent: *mut StayaAgent, law: &mut Patrol, inputs: &StayaInputs) -> StayaOutputs {
    let (mut messages, mut robots, mut count, mut out) =
        ([EMPTY; STAYA_INBOX], [StayaNeighbor::default(); 16], 0, nothing().1);
    let must = |status| assert_eq!(status, StayaStatus::Ok);
    // SAFETY: all pointers are valid.
    unsafe {
        must(staya_hear(agent, inputs));
        must(staya_received(agent, messages.as_mut_ptr(), STAYA_INBOX, &mut count));
        for message in &messages[..count] {
            match (message.is_order, &message.bytes[..message.count.into()]) {
                (0, [0, steps]) => law.makes_room = *steps,
                (0, [1, west]) => law.goes_west = *west == 1,
                (1, [low, high]) => law.own_mmps = u16::from_le_bytes([*low, *high]),
                other => panic!("{other:?}"),
            }
            assert_eq!((message.from == 0, message.dropped), (message.is_order == 1, 0));
        }
        must(staya_neighbors(agent, robots.as_mut_ptr(), robots.len(), &mut count));
        let peers = robots[..count].iter().filter(|other| (other.protocol, other.payload_count) == (OWN.0, 2));
        let pace = |other: &StayaNeighbor| u16::from_le_bytes([other.payload[0], other.payload[1]]);
        let act = law.act(inputs.position_mm[0], peers.map(|other| (other.id, other.position_mm[0], pace(other))));
        if let Some(ahead) = act.asks {
            must(staya_send(agent, ahead, [0, 9].as_ptr(), 2, VALID_US));
        }
        if act.turns {
            must(staya_send(agent, 0, [1, law.goes_west.into()].as_ptr(), 2, 0));
        }
        must(staya_set_payload(agent, law.own_mmps.to_le_bytes().as_ptr(), 2));
        let velocity_mps = [act.east_mps, 0.0, 0.0];
        let kind = StayaAction::Velocity as u8;
        let decision = StayaDecision { velocity_mps, way_m: velocity_mps, kind, has_way: 1, ..IDLE };
        must(staya_decide(agent, &decision));
        must(staya_act(agent, inputs, &mut out));
    }
    out
}

/// A radio that loses four of ten frames for each receiver.
fn heard(said: &[Vec<u8>], receiver: usize, step: u32) -> Vec<u8> {
    let mut air = Vec::new();
    for (sender, bytes) in said.iter().enumerate().filter(|(sender, _)| *sender != receiver) {
        for (number, frame) in (0..).zip(frames(bytes)) {
            let link = (sender * 16 + receiver) as u32;
            if Rng::keyed(7, number, link, step).below(10) >= 4 {
                air.extend_from_slice(frame);
                air.push(0);
            }
        }
    }
    air
}

#[test]
fn a_law_in_c_equals_its_twin_in_rust_over_a_radio_that_loses_frames() {
    let paces = [300, 250, 400];
    let (mut memories, mut laws, mut twins, mut places) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (own_mmps, id) in paces.into_iter().zip(1..) {
        let (setup, law) = (own_law(id), Patrol { own_mmps, ..Patrol::default() });
        let mut memory = Memory::new();
        memory.agent(&setup).unwrap();
        memories.push(memory);
        let (config, layer) = (setup.config().unwrap(), setup.layer_settings().unwrap().layer());
        twins.push(Agent::<Number, _, NEIGHBORS, Layer>::new(&config, law.clone(), layer, Postcard));
        laws.push(law);
        places.push([id as i32 * 900, 0, 0]);
    }
    // Robot 4 has another law.
    let mut stranger = Memory::new();
    let stranger = stranger.agent(&setup(4)).unwrap();
    let mut said = vec![Vec::new(); 5];
    let mut events = BTreeMap::new();
    let mut rooms = 0;
    for step in 0..600u32 {
        let now = Instant::from_micros(step * TICK_US as u32);
        let mut next = said.clone();
        for own in 0..paces.len() {
            let inbox = heard(&said, own, step);
            let (mut inputs, agent) = (nothing().0, (&raw mut *memories[own]).cast());
            (inputs.position_mm, inputs.now_us, inputs.max_speed_mps) = (places[own], now.as_micros(), 1.0);
            (inputs.inbox, inputs.inbox_bytes) = (inbox.as_ptr(), inbox.len());
            let out = step_in_c(agent, &mut laws[own], &inputs);
            let position = Position::from_mm(places[own]);
            let twin_inputs = Inputs {
                state: KinematicState { position, ..KinematicState::default() },
                surroundings: InPlane { max_speed_mps: cast(1.0), obstacles: &[] },
                inbox: &inbox,
            };
            let twin = twins[own].step(&twin_inputs, now, &mut ());
            shows(&out, &twin, twins[own].mode(), &format!("step {step} of {own}"));
            assert_eq!(format!("{:?}", laws[own]), format!("{:?}", twins[own].law()));
            assert_eq!(out.command, StayaCommand::Velocity as u8);
            rooms += u32::from(laws[own].makes_room > 0);
            let way_mm = out.velocity_mps.map(|mps| (mps * TICK_US as f32 / 1000.0) as i32);
            places[own] = [0, 1, 2].map(|axis| places[own][axis] + way_mm[axis]);
            next[own] = out.outbox[..out.outbox_bytes.into()].to_vec();
            for event in &out.events[..out.event_count.into()] {
                *events.entry(event.kind).or_insert(0) += 1;
            }
        }
        let (mut inputs, mut out) = nothing();
        (inputs.position_mm, inputs.now_us, inputs.max_speed_mps) = ([0, 9000, 0], now.as_micros(), 1.0);
        // SAFETY: all pointers are valid.
        assert_eq!(unsafe { staya_step(stranger, &inputs, &mut out) }, StayaStatus::Ok);
        next[3] = out.outbox[..out.outbox_bytes.into()].to_vec();
        next[4].clear();
        if (300..320).contains(&step) {
            let header = Header { boot: 0, sender: RobotId(1000), sequence: step as u16 };
            let order = Patrols::order(RobotId(3), 1, &Pace(150u16.to_le_bytes())).unwrap();
            let mut frame = heapless::Vec::<u8, 64>::new();
            encode(header, &order, &mut frame).unwrap();
            next[4] = frame.to_vec();
        }
        said = next;
    }
    let kinds = |kind: StayaEventKind| events.get(&(kind as u8)).copied().unwrap_or(0);
    let counts = [kinds(StayaEventKind::MessageExpired), kinds(StayaEventKind::NeighborFound), rooms];
    assert!(counts.iter().all(|count| *count > 4), "{counts:?}");
    assert_eq!(laws.iter().map(|law| law.own_mmps).collect::<Vec<_>>(), [300, 250, 150], "the order came");
    assert!(laws.iter().any(|law| law.goes_west) || places.iter().any(|place| place[0] < 900), "no robot turned");
    let mut known = [StayaNeighbor::default(); 4];
    // SAFETY: all pointers are valid.
    unsafe {
        let first = (&raw mut *memories[0]).cast();
        assert_eq!(staya_neighbors(first, known.as_mut_ptr(), 4, &mut 0), StayaStatus::Ok);
    }
    let told = known.map(|robot| (robot.id, robot.protocol, robot.payload[..robot.payload_count.into()].to_vec()));
    let pace = |mmps: u16| mmps.to_le_bytes().to_vec();
    assert_eq!(told, [(2, 200, pace(250)), (3, 200, pace(150)), (4, 2, vec![]), (0, 0, vec![])]);
}

#[test]
fn moves_from_cell_to_cell_reach_the_body() {
    let (mut memory, land, cell) = (Memory::new(), [1; 9], StayaCell { x: 4, y: 4 });
    let agent = memory.agent(&own_law(1)).unwrap();
    let moves =
        StayaDecision { kind: StayaAction::Moves as u8, move_count: 2, moves: [2, 8, 0, 0, 0, 0, 0, 0], ..IDLE };
    let step = |inputs: &StayaInputs| {
        let mut out = nothing().1;
        // SAFETY: all pointers are valid.
        unsafe {
            assert_eq!(staya_decide(agent, &moves), StayaStatus::Ok);
            assert_eq!(staya_step(agent, inputs, &mut out), StayaStatus::Ok);
        }
        (out.command, out.mode, out.moves[..out.move_count.into()].to_vec())
    };
    let mut inputs = StayaInputs { max_speed_mps: 1.0, cell, window_width: 3, window_height: 3, ..nothing().0 };
    inputs.window_origin = StayaCell { x: 3, y: 3 };
    let is_fault = (StayaCommand::Hold as u8, StayaMode::Fault as u8, vec![]);
    assert_eq!(step(&inputs), is_fault, "no window");
    inputs.window = land.as_ptr();
    let _ = step(&inputs);
    assert_eq!(step(&inputs), (StayaCommand::Move as u8, StayaMode::Cruise as u8, vec![2, 8]));
    inputs.cell_m = 1.0;
    assert_eq!(step(&inputs), is_fault, "it moves by velocities there");
}
