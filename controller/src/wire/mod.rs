//! What robots say to each other: messages, and the frames that carry them.

mod fixint;
mod frame;
mod message;

pub use frame::{
    DecodeError, EncodeError, Frame, Header, MAX_FRAME_LEN, TAG_LEN, VERSION, decode,
    decode_verified, encode, encode_tagged, frames,
};
pub use message::{
    Ack, Beacon, CompactBeacon, GoalAssignment, Message, Mode, Request, RequestKind, RobotId,
    TEMPLATE_PART, TemplateAssignment, TemplateEntry,
};
#[cfg(test)]
mod arbitrary;
