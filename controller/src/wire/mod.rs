//! The messages that robots exchange, and the frames that carry them; `frame.rs` has the layout.

mod assembly;
mod format;
mod frame;
mod heard;
mod message;
mod newest;
#[cfg(feature = "auth")]
mod operator;
mod orders;
mod payload;
mod requests;
#[cfg(feature = "auth")]
mod ring;
#[cfg(feature = "auth")]
mod sealed;
mod sequence;

pub use assembly::{MAX_TEMPLATE, PartError, TemplateAssembler};
pub use format::{Format, FromFormat, Postcard, Wire};
pub use frame::{
    DecodeError, EncodeError, Frame, Header, MAX_FRAME_LEN, MAX_TAGGED_ROBOT, TAG_LEN, VERSION, decode,
    decode_verified, encode, encode_tagged, frames,
};
pub use message::{
    Ack, Beacon, GoalAssignment, KeyAssignment, KeyHeld, KeyPhase, LostRobot, Message, Request, RequestKind,
    TEMPLATE_PART, TemplateAssignment, WaypointAssignment,
};
pub use newest::Newest;
#[cfg(feature = "auth")]
pub use operator::OperatorWire;
pub use orders::{Answer, Orders};
pub use payload::{MAX_PAYLOAD, Payload, PayloadBytes};
pub use requests::{AskError, Due, Requests, Retry};
#[cfg(feature = "auth")]
pub use ring::{Ring, Signer};
#[cfg(feature = "auth")]
pub use sealed::{PEERS, REACH_STARTS, Sealed};
pub use sequence::{Arrival, SEQUENCE_SPAN, SequenceWindow};

#[cfg(test)]
pub(crate) mod arbitrary;
