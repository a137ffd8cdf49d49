//! Frames to send.

use staya_mavlink::dialect::MavMessage;
use staya_mavlink::frame::{MAX_FRAME_LEN, Sender, encode_message};
use staya_mavlink::signing::Signing;

pub(crate) type Frame = heapless::Vec<u8, MAX_FRAME_LEN>;

/// The next frame of `sender`, signed if there is a key. `None` if no timestamp is left for that.
pub(crate) fn framed(sender: &mut Sender, message: &MavMessage, signing: Option<&mut Signing>) -> Option<Frame> {
    let mut frame = Frame::new();
    encode_message(*sender, message, &mut frame).ok()?;
    sender.sequence = sender.sequence.wrapping_add(1);
    signed(frame, signing)
}

/// A frame with its signature, if there is a key. `None` if no timestamp is left for that.
pub(crate) fn signed(mut frame: Frame, signing: Option<&mut Signing>) -> Option<Frame> {
    if let Some(signing) = signing {
        let signature = signing.sign(&mut frame).ok()?;
        frame.extend_from_slice(&signature).ok()?;
    }
    Some(frame)
}
