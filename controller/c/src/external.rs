//! A law of the caller: a step in two halves, with a decision between them.

use crate::Number;
use crate::agent::{Part, StayaAgent, act};
use crate::choices::{StayaAction, StayaDir, StayaProgress, StayaWait};
use crate::io::{StayaInputs, StayaOutputs, finite};
use crate::law::Law;
use crate::memory::{Call, answers, plain};
use crate::status::{Checked, StayaStatus};
use staya_controller::agent::{Action, Decision, External, Progress};
use staya_controller::grid::Dir;
use staya_controller::robot::RobotId;
use staya_controller::time::Duration;
use staya_controller::wire::{MAX_CONTENT, MAX_MESSAGE, MAX_ORDER};

/// Maximum length of a message to one robot in bytes.
pub const STAYA_MESSAGE: usize = 12;
/// Maximum length of a message to all robots, and of an order, in bytes.
pub const STAYA_CONTENT: usize = 38;
/// Maximum number of received messages that wait for `staya_received`.
pub const STAYA_INBOX: usize = 4;

const _: () = assert!(STAYA_MESSAGE == MAX_MESSAGE && STAYA_CONTENT == MAX_CONTENT && STAYA_CONTENT >= MAX_ORDER);

/// The decision of a law of your own. All zeros: idle.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct StayaDecision {
    /// With STAYA_ACTION_VELOCITY: the preferred velocity, m/s; the safety layer may change it.
    pub velocity_mps: [f32; 3],
    /// With `has_way`: the vector to the point that the robot heads for, metres.
    pub way_m: [f32; 3],
    /// StayaAction.
    pub kind: u8,
    /// Other than 0: the robot heads straight for a point, and may turn aside to let others pass.
    pub has_way: u8,
    /// StayaProgress; does not count with STAYA_ACTION_IDLE.
    pub progress: u8,
    /// With STAYA_PROGRESS_WAITING, and only then: StayaWait.
    pub wait: u8,
    /// Other than 0: the robot carries out the action although it has arrived or waits.
    pub makes_way: u8,
    /// Length of `moves`, at most 8.
    pub move_count: u8,
    /// With STAYA_ACTION_MOVES: the moves (StayaDir), best first.
    pub moves: [u8; 8],
}

/// A message or an order that the robot received.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaMessage {
    /// The sender's number; 0 for an order.
    pub from: u32,
    /// Messages and orders that the robot has dropped so far, because others waited.
    pub dropped: u16,
    /// Other than 0: an order of the operator.
    pub is_order: u8,
    /// Length of `bytes`.
    pub count: u8,
    /// The content, `count` bytes.
    pub bytes: [u8; STAYA_CONTENT],
}

plain!(StayaDecision, StayaMessage);

impl StayaDecision {
    fn decision(&self) -> Checked<Decision<Number>> {
        let action = match StayaAction::of(self.kind)? {
            StayaAction::Idle | StayaAction::Stay => Action::Stay,
            StayaAction::Velocity => {
                let way_m = if self.has_way == 0 { None } else { Some(finite(self.way_m)?) };
                Action::Velocity { wish_mps: finite(self.velocity_mps)?, way_m }
            }
            StayaAction::Moves => {
                let mut moves = heapless::Vec::new();
                for number in self.moves.get(..self.move_count.into()).ok_or(StayaStatus::TooMany)? {
                    let dir = (*number <= StayaDir::Stay as u8).then(|| Dir::from_index(*number));
                    moves.push(dir.ok_or(StayaStatus::Choice)?).map_err(|_| StayaStatus::TooMany)?;
                }
                Action::Moves(moves)
            }
        };
        let progress = match (StayaProgress::of(self.progress)?, StayaWait::chosen(self.wait)?) {
            (StayaProgress::Waiting, Some(wait)) => Progress::Waiting(wait),
            (StayaProgress::Waiting, None) | (_, Some(_)) => return Err(StayaStatus::Choice),
            (StayaProgress::Going, None) => Progress::Going,
            (StayaProgress::Forming, None) => Progress::Forming,
            (StayaProgress::Stuck, None) => Progress::Stuck,
            (StayaProgress::Arrived, None) => Progress::Arrived,
        };
        if self.kind == StayaAction::Idle as u8 {
            return Ok(Decision::idle());
        }
        Ok(Decision { makes_way: self.makes_way != 0, ..Decision::new(action, progress) })
    }
}

/// The law of an agent that has an external one.
fn law<'a>(call: Call<'a>, agent: *mut StayaAgent) -> Checked<&'a mut External<Number>> {
    match call.resident_mut(agent)?.inside_mut().law_mut() {
        Law::External(law) => Ok(law),
        _ => Err(StayaStatus::Task),
    }
}

fn fits(fits: bool) -> Checked<()> {
    if fits { Ok(()) } else { Err(StayaStatus::TooMany) }
}

/// The first half of a step: receives. `staya_neighbors` and `staya_received` then tell a law of
/// your own what it needs for `staya_decide`. `staya_step` is both halves, for a decision that was
/// made before. Bounded work; rejected inputs change nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_hear(agent: *mut StayaAgent, inputs: *const StayaInputs) -> StayaStatus {
    answers!(|call| call.resident_mut(agent)?.run(call, inputs, Part::Hear))
}

/// The second half of a step, with the inputs of `staya_hear`, of which it does not read the inbox:
/// decides, avoids, sends. `STAYA_STATUS_NOT_HEARD` without a `staya_hear` since the last step.
/// Bounded work; rejected inputs change nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_act(
    agent: *mut StayaAgent,
    inputs: *const StayaInputs,
    outputs: *mut StayaOutputs,
) -> StayaStatus {
    answers!(|call| act(call, (agent, Part::Act), inputs, outputs))
}

/// Decides for the next step; before the first decision the robot is idle. A decision counts once:
/// if it is not renewed, the robot stays, so a law that hangs stops its robot. An idle robot
/// remains idle. A velocity needs `max_speed_mps`, moves need a `window` and no `cell_m`; without
/// them the robot is in STAYA_MODE_FAULT. `STAYA_STATUS_NUMBER`, `_CHOICE` or `_TOO_MANY` for an
/// invalid decision, which changes nothing. This function and those below do constant work and
/// return `STAYA_STATUS_TASK` if the agent's law is another one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_decide(agent: *mut StayaAgent, decision: *const StayaDecision) -> StayaStatus {
    answers!(|call| {
        law(call, agent)?.set_decision(call.shared(decision)?.decision()?);
        Ok(())
    })
}

/// Sets the payload of each beacon from the next one on: the state of the law that others may know,
/// since beacons get lost. `STAYA_STATUS_TOO_MANY` above STAYA_PAYLOAD bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_set_payload(agent: *mut StayaAgent, bytes: *const u8, count: usize) -> StayaStatus {
    answers!(|call| fits(law(call, agent)?.set_payload(call.row(bytes, count)?)))
}

/// Sends a message to robot `to` in the next step: at most STAYA_MESSAGE bytes, resent until it is
/// acknowledged, for `valid_us` at most, then STAYA_EVENT_KIND_MESSAGE_EXPIRED. A newer message to
/// the robot replaces it; those to more than four robots at a time are lost. `to` 0: to all, at
/// most STAYA_CONTENT bytes, once, if it fits into the frames of the step. `STAYA_STATUS_TOO_MANY`
/// for too many bytes, or if one message to all or four others wait for the step;
/// `STAYA_STATUS_NUMBER` if `valid_us` is not above 0 and `to` is.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_send(
    agent: *mut StayaAgent,
    to: u32,
    bytes: *const u8,
    count: usize,
    valid_us: i32,
) -> StayaStatus {
    answers!(|call| {
        let (law, bytes) = (law(call, agent)?, call.row(bytes, count)?);
        match to {
            0 => fits(law.broadcast(bytes)),
            _ if valid_us <= 0 => Err(StayaStatus::Number),
            _ => fits(law.send(RobotId(to), bytes, Duration::from_micros(valid_us))),
        }
    })
}

/// Takes out the oldest received messages and orders with the protocol of the law, `message_room`
/// at most, and returns their number in `*count`. STAYA_INBOX wait at most; another one replaces
/// the oldest.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_received(
    agent: *mut StayaAgent,
    messages: *mut StayaMessage,
    message_room: usize,
    count: *mut usize,
) -> StayaStatus {
    answers!(|call| {
        let (law, places) = (law(call, agent)?, call.room(messages, message_room)?);
        call.write(count, 0)?;
        let mut taken = 0;
        for place in places {
            let Some(message) = law.take() else { break };
            let mut bytes = [0; STAYA_CONTENT];
            bytes.iter_mut().zip(&message.bytes).for_each(|(to, byte)| *to = *byte);
            let (is_order, count) = (message.is_order.into(), message.bytes.len() as u8);
            place.write(StayaMessage { from: message.from.0, dropped: law.dropped(), is_order, count, bytes });
            taken += 1;
        }
        call.write(count, taken)
    })
}
