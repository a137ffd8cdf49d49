//! What robots say to each other: messages, and the frames that carry them.

mod fixint;
mod frame;
mod message;
mod sequence;

pub use frame::{
    DecodeError, EncodeError, Frame, Header, MAX_FRAME_LEN, TAG_LEN, VERSION, decode,
    decode_verified, encode, encode_tagged, frames,
};
pub use message::{
    Ack, Beacon, CompactBeacon, GoalAssignment, Message, Mode, Request, RequestKind, RobotId,
    TEMPLATE_PART, TemplateAssignment, TemplateEntry,
};
pub use sequence::{Arrival, SEQUENCE_SPAN, SequenceWindow};

#[cfg(test)]
mod arbitrary;
