mod channel;
mod fit;
mod frames;
mod messages;
mod own;
mod sessions;

use crate::message::{Hello, Stepped, kind};
use crate::robot::{Large, Small};
use crate::session::{About, Reaction, Session, content_bytes};
use staya_controller::agent::{
    AgentConfig, CELLS, LawSettings, LayerSettings, OrcaSettings, RouteSettings, Setup, Task, UnguardedSettings,
    WaypointSettings,
};
use staya_controller::grid::Cell;
use staya_controller::neighbor::StalenessInflation;
use staya_controller::orca::AvoidParams;
use staya_controller::robot::RobotId;
use staya_controller::route::RouteParams;
use staya_controller::time::Duration;
use staya_controller::wire::Format;
use std::vec::Vec;

pub const LARGE: usize = content_bytes(CELLS, 32, crate::robot::LARGE_INBOX);
pub const SMALL: usize = content_bytes(CELLS, 16, crate::robot::SMALL_INBOX);
pub const ABOUT: About =
    About { part: "stm32f405", firmware: "lockstep 0.1.0", boot: 1, ticks_per_second: 168_000_000 };

pub fn large() -> Session<Large, LARGE> {
    Session::new(Large::new(), ABOUT)
}

pub fn small() -> Session<Small, SMALL> {
    let part = "nrf51";
    Session::new(Small::new(), About { part, ..ABOUT })
}

pub fn in_plane() -> Setup {
    Setup {
        agent: AgentConfig {
            seed: 7,
            max_acceleration_mps2: 2.0,
            ..AgentConfig::new(RobotId(1), 0.25, Duration::from_millis(100))
        },
        law: LawSettings::Waypoint(WaypointSettings { speed_mps: 1.0, tolerance_m: 0.05 }),
        safety: LayerSettings::Orca(OrcaSettings {
            params: AvoidParams::default(),
            inflation: StalenessInflation { growth_mps: 0.5, max_m: 0.25 },
        }),
        format: Format::Postcard,
    }
}

pub fn on_grid(radius: u8) -> (Setup, Task) {
    let params = RouteParams { radius, ..RouteParams::default() };
    let setup = Setup {
        agent: AgentConfig { seed: 7, ..AgentConfig::new(RobotId(1), 0.0, Duration::from_millis(100)) },
        law: LawSettings::Route(RouteSettings { params, ..RouteSettings::default() }),
        safety: LayerSettings::None(UnguardedSettings),
        format: Format::Postcard,
    };
    (setup, Task::Cell(Cell::new(40, 17)))
}

pub fn frame<T: serde::Serialize>(kind: u8, body: &T) -> Vec<u8> {
    let mut frame = crate::frame::Frame::<16384>::new();
    frame.fill(kind, body).expect("it fits");
    frame.bytes().to_vec()
}

pub fn answers<B: crate::robot::Controller, const N: usize>(session: &mut Session<B, N>, bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut answers = Vec::new();
    for byte in bytes {
        match session.receive(*byte, &mut ()) {
            Reaction::None => {}
            Reaction::Answer(frame) => answers.push(frame.to_vec()),
            Reaction::Restart => panic!("no restart was requested"),
        }
    }
    answers
}

/// Decodes a frame, which must be of this kind.
pub fn read<T: serde::de::DeserializeOwned>(expected: u8, frame: &[u8]) -> T {
    let mut deframer = crate::frame::Deframer::<16384>::new();
    for byte in frame {
        if let Some(found) = deframer.push(*byte) {
            let (kind, body) = found.expect("sound");
            assert_eq!(kind, expected);
            return postcard::from_bytes(body).expect("readable");
        }
    }
    panic!("no frame");
}

pub fn stepped(frame: &[u8]) -> Stepped {
    read(kind::STEPPED, frame)
}

pub fn hello(frame: &[u8]) -> Hello {
    read(kind::HELLO, frame)
}
