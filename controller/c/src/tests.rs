mod external;
mod header;
mod laws;
mod misuse;
mod steps;

use crate::Number;
use crate::agent::{STAYA_AGENT_SIZE, StayaAgent, StayaWaypoint, staya_init};
use crate::choices::StayaMode;
use crate::chosen::{staya_choose_law, staya_choose_layer};
use crate::external::{STAYA_CONTENT, StayaDecision, StayaMessage};
use crate::io::{StayaInputs, StayaOutputs};
use crate::setup::{StayaSetup, staya_setup_defaults};
use crate::status::StayaStatus;
use core::ffi::CStr;
use core::mem::MaybeUninit;
use core::ptr::null_mut;
use staya_controller::agent::Outputs;
use staya_controller::robot::Mode;

const TICK_US: i32 = 50_000;
/// The protocol of the tests' own law.
const PROTOCOL: u8 = 200;
const EMPTY: StayaMessage = StayaMessage { from: 0, dropped: 0, is_order: 0, count: 0, bytes: [0; STAYA_CONTENT] };
const IDLE: StayaDecision = StayaDecision {
    velocity_mps: [0.0; 3],
    way_m: [0.0; 3],
    kind: 0,
    has_way: 0,
    progress: 0,
    wait: 0,
    makes_way: 0,
    move_count: 0,
    moves: [0; 8],
};

#[repr(align(8))]
struct Memory([u8; STAYA_AGENT_SIZE]);

impl Memory {
    fn new() -> Box<Self> {
        Box::new(Self([0xA5; STAYA_AGENT_SIZE]))
    }

    fn agent(&mut self, setup: &StayaSetup) -> Result<*mut StayaAgent, StayaStatus> {
        let mut agent = null_mut();
        // SAFETY: valid memory, not used elsewhere.
        let status = unsafe { staya_init((&raw mut self.0).cast(), STAYA_AGENT_SIZE, setup, &mut agent) };
        assert_eq!(agent.is_null(), status != StayaStatus::Ok);
        if status == StayaStatus::Ok { Ok(agent) } else { Err(status) }
    }
}

fn setup(id: u32) -> StayaSetup {
    let mut setup = MaybeUninit::uninit();
    // SAFETY: valid space, which is filled.
    unsafe {
        assert_eq!(staya_setup_defaults(setup.as_mut_ptr(), id, 0.1, TICK_US), StayaStatus::Ok);
        setup.assume_init()
    }
}

/// A setup with this law behind this layer.
fn with(id: u32, law: &CStr, layer: &CStr) -> StayaSetup {
    let mut setup = setup(id);
    // SAFETY: all pointers are valid.
    unsafe {
        assert_eq!(staya_choose_law(&mut setup, law.as_ptr()), StayaStatus::Ok);
        assert_eq!(staya_choose_layer(&mut setup, layer.as_ptr()), StayaStatus::Ok);
    }
    setup
}

fn own_law(id: u32) -> StayaSetup {
    StayaSetup { protocol: PROTOCOL, latency_us: TICK_US, ..with(id, c"external", c"orca") }
}

fn nothing() -> (StayaInputs, StayaOutputs) {
    // SAFETY: numbers and pointers, for which zeros are valid.
    unsafe { (MaybeUninit::zeroed().assume_init(), MaybeUninit::zeroed().assume_init()) }
}

fn waypoint(x_mm: i32) -> StayaWaypoint {
    StayaWaypoint { position_mm: [x_mm, 0, 0], ..StayaWaypoint::default() }
}

/// C shows what the agent in Rust returned.
fn shows(out: &StayaOutputs, twin: &Outputs<Number>, mode: Mode, whose: &str) {
    assert_eq!(out.outbox[..out.outbox_bytes.into()], twin.outbox[..], "{whose}");
    let StayaOutputs { leader, target, has_target, .. } = *out;
    let mut expected = StayaOutputs { leader, target, has_target, mode: StayaMode::from(mode) as u8, ..nothing().1 };
    expected.fill(twin);
    assert_eq!(format!("{out:?}"), format!("{expected:?}"), "{whose}");
}
