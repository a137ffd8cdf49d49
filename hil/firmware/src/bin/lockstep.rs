//! The device's end of the link: a robot with any built-in guidance law.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod robot {
    use staya_link::{robot, session::content_bytes};

    /// The robot that fits the part, and the content of its longest frame, bytes.
    #[cfg(not(part = "nrf51"))]
    pub type Robot = robot::LargeIn<staya_firmware::lockstep::Number>;
    #[cfg(not(part = "nrf51"))]
    pub const CONTENT: usize = content_bytes(169, 32, robot::LARGE_INBOX);
    #[cfg(part = "nrf51")]
    pub type Robot = robot::Small;
    #[cfg(part = "nrf51")]
    pub const CONTENT: usize = content_bytes(169, 16, robot::SMALL_INBOX);
}

staya_firmware::lockstep_as!(robot::Robot, robot::CONTENT, concat!("lockstep ", env!("CARGO_PKG_VERSION")));
