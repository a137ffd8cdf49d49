//! The messages that robots exchange, and the frames that carry them; `frame.rs` has the layout.

mod content;
mod format;
mod frame;
mod heard;
mod incoming;
mod message;
mod newest;
#[cfg(feature = "auth")]
mod operator;
mod outgoing;
#[cfg(feature = "auth")]
mod ring;
#[cfg(feature = "auth")]
mod sealed;
mod sequence;

pub use content::{Bytes, Content, MAX_CONTENT, MAX_MESSAGE, MAX_ORDER, MAX_PAYLOAD, Never, ProtocolId};
pub use format::{Format, FromFormat, Postcard, Wire};
pub use frame::{
    DecodeError, EncodeError, Frame, Header, MAX_FRAME_LEN, MAX_TAGGED_ROBOT, TAG_LEN, VERSION, decode,
    decode_verified, encode, encode_tagged, frames,
};
pub use incoming::{IncomingMessages, IncomingOrders};
pub use message::{Ack, Addressed, Beacon, Broadcast, KeyAssignment, KeyHeld, KeyPhase, LostRobot, Message, Relayed};
pub use newest::Newest;
#[cfg(feature = "auth")]
pub use operator::OperatorWire;
pub use outgoing::{Due, OutgoingMessages, Retry, SendError};
#[cfg(feature = "auth")]
pub use ring::{Ring, Signer};
#[cfg(feature = "auth")]
pub use sealed::{PEERS, REACH_STARTS, Sealed};
pub use sequence::{Arrival, MOST_PERIODS, SEQUENCE_SPAN, SequenceWindow, next_beacon};

#[cfg(test)]
pub(crate) mod arbitrary;
