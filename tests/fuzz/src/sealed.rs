//! Bytes from an attacker without the key.

use heapless::Vec as Bounded;
use staya_controller::agent::{Grid, GridOrder, Protocol as _};
use staya_controller::auth::Key;
use staya_controller::grid::Cell;
use staya_controller::robot::RobotId;
use staya_controller::wire::{Frame, Header, MAX_FRAME_LEN, Sealed, Wire};
use staya_mavlink::signed::Signed;
use staya_mavlink::signing::Signing;

/// No frame that an attacker builds from two recorded ones is accepted, and no frame twice.
pub fn sealed(bytes: &[u8]) {
    let key = Key::of_passphrase(b"not the fuzzer's");
    let sealed = || Sealed::<2>::at_start(&key, 1).expect("a low number");
    refuses(sealed, bytes);
    refuses(|| Signed::<2>::new(Signing::new(key.clone(), 0, 1)), bytes);
}

fn refuses<W: Wire>(new: impl Fn() -> W, bytes: &[u8]) {
    let (mut sender, mut receiver) = (new(), new());
    let heard = [said(&mut sender, 0), said(&mut sender, 1)];
    for frame in &heard {
        assert!(read(&mut receiver, frame).is_some());
    }
    let judged = |receiver: &mut W, bytes: &[u8]| {
        let mut rest = bytes;
        while let Some(frame) = receiver.next_frame(&mut rest) {
            assert!(receiver.decode(frame).is_err(), "{frame:?}");
        }
    };
    judged(&mut receiver, bytes);
    // Each change is a position and a value.
    let mut forged = heard.clone();
    for change in bytes.chunks_exact(2).take(8) {
        let frame = &mut forged[usize::from(change[0] & 1)];
        let at = usize::from(change[0] >> 1) % frame.len();
        frame[at] = change[1];
    }
    let mut stranger = new();
    for (frame, true_one) in forged.iter().zip(&heard) {
        judged(&mut receiver, frame);
        if let Some(found) = read(&mut stranger, frame) {
            assert_eq!(Some(found), read(&mut new(), true_one));
        }
    }
    assert!(read(&mut receiver, &said(&mut sender, 2)).is_some());
}

fn said<W: Wire>(by: &mut W, sequence: u16) -> Bounded<u8, MAX_FRAME_LEN> {
    let header = Header { boot: 1, sender: RobotId(7), sequence };
    let goal = Grid::order(RobotId(2), 3, &GridOrder::FormationGoal(Cell::new(1, -2))).expect("a goal is short");
    let mut out = Bounded::new();
    by.encode(header, &goal, &mut out).expect("a goal is short");
    out
}

fn read<W: Wire>(by: &mut W, bytes: &[u8]) -> Option<Frame> {
    let mut rest = bytes;
    let frame = by.next_frame(&mut rest)?;
    by.decode(frame).ok()
}
