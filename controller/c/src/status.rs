//! The result of a function.

use core::ffi::{CStr, c_char};

/// The result of a function. Unless it is `STAYA_STATUS_OK` nothing has changed, except that
/// `staya_init` then leaves no agent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum StayaStatus {
    /// Success.
    Ok = 0,
    /// A required pointer is null, or null with a length above 0.
    Null = 1,
    /// A pointer is misaligned for its type; memory of agents and avoiders needs STAYA_ALIGN.
    Alignment = 2,
    /// The memory is too small: see STAYA_AGENT_SIZE and STAYA_AVOIDER_SIZE.
    MemorySize = 3,
    /// This memory does not hold an agent or avoider: call `staya_init` or `staya_avoider_init`.
    NotThere = 4,
    /// The structure was not filled by `staya_setup_defaults` of this version of the header.
    Version = 5,
    /// The robot's number is 0; numbers begin at 1.
    NoRobot = 6,
    /// A number that must be above 0, or finite, is not.
    Number = 7,
    /// A field that selects one of several choices has an invalid number.
    Choice = 8,
    /// The library was built without this feature.
    NotBuilt = 9,
    /// The guidance law does not support this order.
    Task = 10,
    /// `sight_cells` is 0, or above STAYA_MAX_RADIUS.
    Search = 11,
    /// There are more elements than fit.
    TooMany = 12,
    /// The window has no width or no height, or a graph or a template is invalid.
    Shape = 13,
    /// The robot does not have this parameter, or the value is out of range or contradicts others.
    Parameter = 14,
    /// The name or number does not exist.
    Unknown = 15,
    /// `staya_act` needs a `staya_hear` before.
    NotHeard = 16,
    /// This build has no law or layer of this name, or the setup has chosen another one.
    Law = 17,
    /// The chosen law and layer do not have this row; fields of the setup are not rows.
    Row = 18,
    /// A row cannot have this value or word.
    Range = 19,
    /// A row without a default is not given: `staya_explain` names it.
    Needed = 20,
    /// Values or fields contradict each other: `staya_explain` says which.
    Contradiction = 21,
}

/// The statuses with their names and texts.
const TEXTS: [(StayaStatus, &CStr, &CStr); 22] = {
    use StayaStatus::*;
    [
        (Ok, c"STAYA_STATUS_OK", c"it is done"),
        (Null, c"STAYA_STATUS_NULL", c"a pointer that is needed is null"),
        (Alignment, c"STAYA_STATUS_ALIGNMENT", c"a pointer is not aligned; memory needs STAYA_ALIGN"),
        (MemorySize, c"STAYA_STATUS_MEMORY_SIZE", c"too little memory: see STAYA_AGENT_SIZE and STAYA_AVOIDER_SIZE"),
        (NotThere, c"STAYA_STATUS_NOT_THERE", c"nothing is in this memory: call staya_init or staya_avoider_init"),
        (Version, c"STAYA_STATUS_VERSION", c"call staya_setup_defaults of this version of the header first"),
        (NoRobot, c"STAYA_STATUS_NO_ROBOT", c"0 is not a robot id: use 1 and up"),
        (Number, c"STAYA_STATUS_NUMBER", c"a number that must be above 0, or finite, is not"),
        (Choice, c"STAYA_STATUS_CHOICE", c"a field that names one of several has another number"),
        (NotBuilt, c"STAYA_STATUS_NOT_BUILT", c"the library was built without it: see its features"),
        (Task, c"STAYA_STATUS_TASK", c"the guidance law has no use for this"),
        (Search, c"STAYA_STATUS_SEARCH", c"sight_cells is 0, or above STAYA_MAX_RADIUS"),
        (TooMany, c"STAYA_STATUS_TOO_MANY", c"more of them than there is room for"),
        (Shape, c"STAYA_STATUS_SHAPE", c"a window, a graph or a template makes no sense"),
        (Parameter, c"STAYA_STATUS_PARAMETER", c"no such parameter here, or a value that it cannot have"),
        (Unknown, c"STAYA_STATUS_UNKNOWN", c"there is no such name or number"),
        (NotHeard, c"STAYA_STATUS_NOT_HEARD", c"call staya_hear before staya_act"),
        (Law, c"STAYA_STATUS_LAW", c"not a law or layer of this build, or not the chosen one: see staya_law"),
        (Row, c"STAYA_STATUS_ROW", c"the law and the layer lack this row: see staya_law_row"),
        (Range, c"STAYA_STATUS_RANGE", c"a row cannot have this value or word: see staya_law_row"),
        (Needed, c"STAYA_STATUS_NEEDED", c"a row must be given: staya_explain names it"),
        (Contradiction, c"STAYA_STATUS_CONTRADICTION", c"values contradict each other: see staya_explain"),
    ]
};

pub(crate) type Checked<T> = Result<T, StayaStatus>;

fn texts(status: i32) -> Option<(&'static CStr, &'static CStr)> {
    TEXTS.iter().find(|(known, ..)| *known as i32 == status).map(|(_, name, text)| (*name, *text))
}

/// The name of a status, such as "STAYA_STATUS_NULL". Never null.
#[unsafe(no_mangle)]
pub extern "C" fn staya_status_name(status: i32) -> *const c_char {
    texts(status).map_or(c"(no status)", |(name, _)| name).as_ptr()
}

/// The meaning of a status and its remedy, in one line. Never null.
#[unsafe(no_mangle)]
pub extern "C" fn staya_status_text(status: i32) -> *const c_char {
    texts(status).map_or(c"no status of this library", |(_, text)| text).as_ptr()
}
