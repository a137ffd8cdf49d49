//! What robots say to each other: messages, and the frames that carry them.

mod message;

pub use message::{
    Ack, Beacon, CompactBeacon, GoalAssignment, Message, Mode, Request, RequestKind, RobotId,
    TEMPLATE_PART, TemplateAssignment, TemplateEntry,
};
