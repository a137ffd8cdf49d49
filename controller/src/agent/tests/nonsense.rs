//! Tests of robots on the grid with arbitrary input at arbitrary times.

use super::*;
use crate::cost::Gain;
use crate::formation::{Prediction, Recovery};
use crate::grid::Norm;
use crate::land::{LandPatch, PATCH_TILES};
use crate::route::{ExitRule, Replan};
use crate::shuffle::Sharpness;
use crate::template::TemplateEntry;
use crate::wire::{Broadcast, Bytes, arbitrary};
use proptest::collection::vec;
use proptest::prelude::*;

const OWN: RobotId = RobotId(3);

fn cell() -> impl Strategy<Value = Cell> {
    let coordinate = || {
        prop_oneof![
            4 => -9_i16..9,
            1 => Just(i16::MIN),
            1 => Just(i16::MAX),
            1 => any::<i16>(),
        ]
    };
    (coordinate(), coordinate()).prop_map(|(x, y)| Cell::new(x, y))
}

/// A message or an order that robots on the grid understand.
fn content<const N: usize>(value: &impl Content) -> (ProtocolId, Bytes<N>) {
    value.encode(Grid::ID).unwrap()
}

fn grid_order() -> impl Strategy<Value = GridOrder> {
    let entry = (cell(), few(), any::<u8>()).prop_map(|(offset, id, hops)| TemplateEntry { offset, id, hops });
    let part = (any::<[u8; 4]>(), cell(), vec(entry, 0..=TEMPLATE_PART));
    let part = part.prop_map(|([version, part, parts, slot], offset, entries)| {
        let entries = entries.into_iter().collect();
        let part = TemplatePart { version, part: part % 4, parts: parts % 5, slot, offset, entries };
        GridOrder::Template { part, is_restarted: false }
    });
    prop_oneof![cell().prop_map(GridOrder::Goal), cell().prop_map(GridOrder::FormationGoal), part]
}

fn grid_message() -> impl Strategy<Value = GridMessage> {
    let stop = (few(), any::<u16>()).prop_map(|(origin, valid_ms)| GridMessage::Stop { origin, valid_ms });
    let resume = few().prop_map(|origin| GridMessage::Resume { origin });
    prop_oneof![stop, resume, Just(GridMessage::Redirect)]
}

fn grid_payload() -> impl Strategy<Value = GridPayload> {
    let place = (cell(), cell(), any::<u16>(), 0..=8_u8);
    (place, any::<u8>(), few()).prop_map(|((cell, target, busy_ms, heading), slot, leader)| {
        // Longer numbers do not fit.
        let leader = RobotId(leader.0 & 0x0FFF_FFFF);
        GridPayload { cell, target, busy_ms, heading: Dir::from_index(heading), slot, leader }
    })
}

fn few() -> impl Strategy<Value = RobotId> {
    prop_oneof![4 => (0..7_u32).prop_map(RobotId), 1 => arbitrary::robot()]
}

/// Messages of robots and operators to a robot on the grid.
fn sensible() -> impl Strategy<Value = Message> {
    let beacon = (arbitrary::beacon(), grid_payload()).prop_map(|(beacon, payload)| {
        let (protocol, payload) = content(&payload);
        Message::Beacon(Beacon { protocol, payload, ..beacon })
    });
    let law = (any::<u8>(), grid_message()).prop_map(|(number, message)| {
        let (protocol, content) = content(&message);
        Message::Law(Addressed { to: OWN, number, protocol, content })
    });
    let order = (few(), any::<u8>(), grid_order());
    let order = order.prop_map(|(to, number, order)| Grid::order(to, number, &order).unwrap());
    let land = (cell(), any::<[u8; PATCH_TILES]>()).prop_map(|(at, bytes)| {
        let patch = LandPatch::from_bytes(crate::land::tile_of(at), bytes);
        let (protocol, content) = content(&GridMessage::Land(patch));
        Message::Broadcast(Broadcast { protocol, content })
    });
    prop_oneof![4 => beacon, 2 => law, 2 => order, 1 => land]
}

/// Valid frames, mostly from few robots, which concern this one and refer to each other.
pub(super) fn frame() -> impl Strategy<Value = (Header, Message)> {
    let sender = few().prop_filter("it has a sender", |id| id.is_some());
    let header = (0..3_u8, sender, 0..40_u16);
    let message = prop_oneof![3 => sensible(), 1 => arbitrary::message()];
    (header, message, few()).prop_map(|(header, mut message, to)| {
        let (boot, sender, sequence) = header;
        match &mut message {
            Message::Law(message) => message.to = OWN,
            Message::Ack(ack) => (ack.to, ack.boot) = (OWN, 0),
            Message::Order(order) => order.to = if to == RobotId(1) { OWN } else { to },
            Message::Key(key) => key.to = to,
            Message::KeyHeld(held) => held.to = to,
            Message::Beacon(_) | Message::Broadcast(_) | Message::Lost(_) | Message::Relayed(_) => {}
        }
        let header = Header { boot, sender, sequence };
        (header, message)
    })
}

#[derive(Clone, Debug)]
struct Step {
    now: Instant,
    frames: Vec<(Header, Message)>,
    noise: Vec<u8>,
    own: CellState,
    /// South-west corner, width, height and content.
    window: Option<(Cell, u16, u16, Vec<u8>)>,
    pose: [u32; 6],
}

impl Step {
    fn makes_sense(&self) -> bool {
        let land = self.land();
        land.is_some_and(|land| land.get(self.own.cell).is_some())
    }

    fn land(&self) -> Option<Window<'_>> {
        let (origin, width, height, cells) = self.window.as_ref()?;
        Window::new(cells, *origin, *width, *height)
    }

    fn inbox(&self) -> Vec<u8> {
        noise_and_frames(&self.frames, &self.noise)
    }
}

pub(super) fn noise_and_frames(frames: &[(Header, Message)], noise: &[u8]) -> Vec<u8> {
    let mut inbox = heapless::Vec::<u8, 1024>::new();
    for (header, message) in frames {
        encode(*header, message, &mut inbox).unwrap();
    }
    [&inbox[..], noise].concat()
}

fn window() -> impl Strategy<Value = Option<(Cell, u16, u16, Vec<u8>)>> {
    let size = prop_oneof![
        3 => Just((11_u16, 11_u16)),
        1 => Just((1, 1)),
        1 => (0..24_u16, 0..24_u16),
        1 => (0..2_u16, 0..300_u16),
        1 => Just((13, 40_000)),
    ];
    let origin = prop_oneof![3 => Just(Cell::new(-5, -5)), 1 => cell()];
    let land = (origin, size, vec(prop_oneof![Just(0), Just(1), any::<u8>()], 1..140));
    let land = land.prop_map(|(origin, (width, height), pattern)| {
        let count = usize::from(width) * usize::from(height);
        let cells = pattern.iter().copied().cycle().take(count).collect();
        (origin, width, height, cells)
    });
    prop_oneof![1 => Just(None), 9 => land.prop_map(Some)]
}

fn own() -> impl Strategy<Value = CellState> {
    let busy = prop_oneof![4 => Just(0), 1 => 0..3 * TICK, 1 => any::<i32>()];
    (cell(), busy).prop_map(|(cell, busy)| CellState { cell, busy: Duration::from_micros(busy) })
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let later = prop_oneof![6 => Just(TICK as u32), 1 => any::<u32>()];
    let heard = (vec(frame(), 0..8), vec(any::<u8>(), 0..30));
    let step = (later, heard, own(), window(), any::<[u32; 6]>());
    (any::<u32>(), vec(step, 1..40)).prop_map(|(mut now, steps)| {
        let steps = steps.into_iter().map(|(later, (frames, noise), own, window, pose)| {
            now = now.wrapping_add(later);
            Step { now: Instant::from_micros(now), frames, noise, own, window, pose }
        });
        steps.collect()
    })
}

fn gain() -> impl Strategy<Value = Gain> {
    prop_oneof![
        3 => (0..100_u16).prop_map(Gain::from_sixteenths),
        1 => any::<u16>().prop_map(Gain::from_sixteenths),
    ]
}

fn route() -> impl Strategy<Value = RouteParams> {
    let shape = (0..12_u8, any::<[bool; 3]>());
    let gains = (gain(), gain(), gain(), gain());
    (shape, gains).prop_map(|((radius, [ray, chebyshev, corner_cutting]), (a0, a1, a2, a3))| RouteParams {
        radius,
        exit: if ray { ExitRule::Ray } else { ExitRule::Best },
        norm: if chebyshev { Norm::Chebyshev } else { Norm::Euclidean },
        corner_cutting,
        a0,
        a1,
        a2,
        a3,
    })
}

fn sharpness() -> impl Strategy<Value = Sharpness> {
    prop_oneof![Just(Sharpness::Greedy), gain().prop_map(Sharpness::HalvedPer)]
}

fn formation() -> impl Strategy<Value = FormationParams> {
    let numbers = any::<(u8, u16, u16, u8, u8)>();
    (numbers, gain(), any::<[bool; 3]>()).prop_map(|(numbers, gain, [reflexive, def, closes_ranks])| {
        let (eps, halt_lag, resume_lag, lead, footprint) = numbers;
        FormationParams {
            patience: 20,
            eps,
            gain,
            halt_lag,
            resume_lag,
            lead,
            footprint,
            closes_ranks,
            prediction: if reflexive { Prediction::Reflexive } else { Prediction::Constant },
            recovery: if def { Recovery::Def } else { Recovery::Wait },
        }
    })
}

fn template() -> impl Strategy<Value = Template<TEMPLATE>> {
    let id = prop_oneof![4 => (0..7_u32).prop_map(RobotId), 1 => arbitrary::robot()];
    let entry = (cell(), id, 1..4_u8);
    let entry = entry.prop_map(|(offset, id, hops)| TemplateEntry { offset, id, hops });
    (any::<u8>(), cell(), vec(entry, 0..=TEMPLATE)).prop_map(|(slot, offset, entries)| Template {
        slot,
        offset,
        entries: entries.into_iter().collect(),
    })
}

fn survives<G>(law: G, goal: Option<Cell>, steps: &[Step]) -> Result<(), TestCaseError>
where
    G: for<'a> Law<f32, Surroundings<'a> = OnGrid<'a>, Protocol = Grid, Workspace = GridWorkspace<CELLS>>,
{
    let config = config(OWN.0);
    let mut agent = Agent::<f32, G, NEIGHBORS>::new(&config, law, Unguarded, Postcard);
    let mut ws = workspace();
    if let Some(goal) = goal {
        agent.order(&GridOrder::Goal(goal));
    }
    for step in steps {
        let inbox = step.inbox();
        let [x, y, z] = [step.pose[0], step.pose[1], step.pose[2]].map(u32::cast_signed);
        let [vx, vy, vz] = [step.pose[3], step.pose[4], step.pose[5]].map(f32::from_bits);
        let inputs = Inputs {
            state: KinematicState {
                position: crate::geom::Position::from_mm([x, y, z]),
                velocity_mps: crate::geom::Vec3::new(vx, vy, vz),
            },
            surroundings: OnGrid { cell: step.own, window: step.land() },
            inbox: &inbox,
        };
        let out = agent.step(&inputs, step.now, &mut ws);

        for frame in frames(&out.outbox) {
            let frame = decode(frame);
            prop_assert!(frame.is_ok_and(|frame| frame.header.sender == OWN), "whole frames");
        }
        prop_assert!(out.outbox.last().is_none_or(|&last| last == 0));
        let count = usize::from(out.received) + usize::from(out.rejected);
        prop_assert_eq!(count, frames(&inbox).count());
        // Not immediately, which would keep the caller awake, and not after the next beacon.
        let pause = out.call_again.since(step.now);
        prop_assert!(Duration::ZERO < pause && pause <= config.beacon_period, "{:?}", pause);

        let is_free = step.own.busy <= Duration::ZERO;
        if is_free && agent.target().is_some() {
            prop_assert_eq!(agent.mode() == Mode::Fault, !step.makes_sense());
        }
        if let Command::Move(moves) = &out.command {
            prop_assert!(is_free && step.makes_sense());
            prop_assert!(!moves.is_empty() && !moves.contains(&Dir::Stay));
            let mut different: Vec<usize> = moves.iter().map(|dir| dir.index()).collect();
            different.sort_unstable();
            different.dedup();
            prop_assert_eq!(different.len(), moves.len());
        }
        prop_assert!(agent.leader() < OWN, "numbers fall along the leader chain");
        for neighbor in agent.neighbors() {
            prop_assert!(neighbor.id.is_some() && neighbor.id != OWN);
        }
    }
    Ok(())
}

proptest! {
    #[test]
    fn a_single_robot_tolerates_any_input(
        route in route(), sharpness in sharpness(), follows: bool,
        goal in proptest::option::of(cell()), steps in steps(),
    ) {
        let replan = if follows { Replan::UntilChanged } else { Replan::EachCell };
        let guidance = RouteGuidance::<CELLS, VISITS>::new(route).replan(replan).sharpness(sharpness);
        survives(guidance, goal, &steps)?;
    }

    #[test]
    fn a_robot_in_formation_tolerates_any_input(
        route in route(), formation in formation(), sharpness in sharpness(), template in template(),
        goal in proptest::option::of(cell()), steps in steps(),
    ) {
        let guidance = FormationGuidance::<CELLS, VISITS, TEMPLATE>::new(route, formation, template);
        survives(guidance.sharpness(sharpness), goal, &steps)?;
    }
}
