//! A rollover of the swarm's key, with faults of the radio and restarts of robots.

use heapless::Vec as Bounded;
use staya_controller::auth::{Key, Master};
use staya_controller::robot::RobotId;
use staya_controller::wire::{Beacon, Header, KeyPhase, MAX_FRAME_LEN, Message, OperatorWire, Ring, Sealed, Wire};

type Bytes = Bounded<u8, MAX_FRAME_LEN>;

const LEFT_OUT: usize = 2;

fn robot(index: usize, generation: u16, starts: u32) -> Sealed<8> {
    let (master, id) = (master(), RobotId(index as u32 + 1));
    let ring = Ring::of_generation(generation, &master.seed(generation)).with_own(&master.own_key(id));
    Sealed::with_ring(ring, id, starts).expect("a low number")
}

fn master() -> Master {
    Master::new(&Key::of_passphrase(b"not the fuzzer's"))
}

fn hears(by: &mut Sealed<8>, bytes: &[u8]) -> bool {
    let mut rest = bytes;
    let mut is_heard = false;
    while let Some(frame) = by.next_frame(&mut rest) {
        is_heard |= by.decode(frame).is_ok();
    }
    is_heard
}

/// Frames are lost, duplicated, delayed, damaged, misdirected, and of any generation and phase.
/// Robots restart with or without their stored keys, but never return to an older key. The excluded
/// robot learns no new key; at the end all others hear each other and not that one.
pub fn keys(bytes: &[u8]) {
    let mut operator = OperatorWire::<8>::at_start(master(), RobotId(99), 0).expect("a low number");
    let mut robots = [robot(0, 0, 0), robot(1, 0, 0), robot(LEFT_OUT, 0, 0)];
    let mut sent: Vec<Bytes> = Vec::new();
    let mut starts = 0;
    for change in bytes.chunks_exact(4).take(200) {
        let [what, whom, which, with] = [change[0], change[1], change[2], change[3]];
        let index = usize::from(whom) % robots.len();
        let before = robots[index].held().expect("it has a key of its own").0;
        match what % 5 {
            0 if index != LEFT_OUT => {
                let phase = [KeyPhase::Hear, KeyPhase::Speak, KeyPhase::Forget][usize::from(which % 3)];
                let mut frame = Bytes::new();
                let to = RobotId(index as u32 + 1);
                operator.send_key(to, u16::from(with % 8), phase, &mut frame).expect("there is room");
                sent.push(frame);
            }
            1 => {
                starts += 1;
                let stored = robots[index].ring().seeds()[0].filter(|_| which % 2 == 0).map_or(0, |(stored, _)| stored);
                robots[index] = robot(index, stored, starts);
                continue;
            }
            2 => {
                if let Some(frame) = sent.get(usize::from(which) % sent.len().max(1)) {
                    let mut frame = frame.clone();
                    let at = usize::from(with) % frame.len();
                    let was = core::mem::replace(&mut frame[at], whom ^ which);
                    let is_heard = hears(&mut robots[index], &frame);
                    assert!(!is_heard || frame[at] == was || at + 1 == frame.len(), "it was damaged");
                }
            }
            3 => drop(hears(&mut robots[index], change)),
            _ => {
                if let Some(frame) = sent.get(usize::from(which) % sent.len().max(1)) {
                    hears(&mut robots[index], frame);
                }
            }
        }
        let held = robots[index].held().expect("it has a key of its own").0;
        assert!(held >= before && (index != LEFT_OUT || held == 0));
    }
    for (index, robot) in robots.iter_mut().enumerate().take(LEFT_OUT) {
        let mut frame = Bytes::new();
        operator.send_key(RobotId(index as u32 + 1), 9, KeyPhase::Forget, &mut frame).expect("there is room");
        assert!(hears(robot, &frame));
    }
    let said = |by: &mut Sealed<8>, index: usize| {
        let mut frame = Bytes::new();
        let header = Header { boot: 0, sender: RobotId(index as u32 + 1), sequence: 9 };
        by.encode(header, &Message::Beacon(Beacon::default()), &mut frame).expect("there is room");
        frame
    };
    let frames: Vec<Bytes> = robots.iter_mut().enumerate().map(|(index, robot)| said(robot, index)).collect();
    assert!(hears(&mut robots[0], &frames[1]) && hears(&mut robots[1], &frames[0]));
    assert!(!hears(&mut robots[0], &frames[LEFT_OUT]) && !hears(&mut robots[LEFT_OUT], &frames[0]));
}
