//! Panics and processor exceptions: report the reason, then reset or stop. Select a handler with
//! [`faults_go_over_the_link!`](crate::faults_go_over_the_link) or
//! [`faults_are_printed!`](crate::faults_are_printed).

use crate::{boots, runtime};
use core::fmt::{self, Display};
use core::panic::PanicInfo;
use core::ptr::addr_of;
use staya_link::message::FaultKind;
use staya_link::session::fault_frame;

/// Sends the reason over the link, cut to the capacity of a fault message, then resets.
pub fn over_the_link(reason: impl Display) -> ! {
    let frame = fault_frame(FaultKind::Panic, reason);
    runtime::send(frame.bytes());
    runtime::reset()
}

/// Prints the reason and ends the emulator with exit code 101.
pub fn printed(reason: impl Display) -> ! {
    runtime::print(format_args!("{reason}\n"));
    runtime::exit(101)
}

/// Message of a panic with the file name but not its folders: a fault holds 80 bytes of text.
pub struct Panic<'a>(pub &'a PanicInfo<'a>);

impl Display for Panic<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = self.0.location() {
            let path = place.file();
            let start = path.bytes().rposition(|byte| byte == b'/');
            let file = path.get(start.map_or(0, |at| at + 1)..).unwrap_or(path);
            write!(f, "{file}:{}: ", place.line())?;
        }
        write!(f, "{}", self.0.message())
    }
}

/// A processor exception at the address of this instruction.
pub struct Trap(u32);

impl Display for Trap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "exception of the processor at {:#010x}", self.0)
    }
}

/// Creates the report of an exception; after an unserved semihosting call, resets instead.
#[must_use]
pub fn trap(address: u32) -> Trap {
    if is_semihosting(address) {
        boots::mute();
        runtime::reset();
    }
    Trap(address)
}

/// BKPT 0xAB, or EBREAK between two shifts that do nothing.
fn is_semihosting(address: u32) -> bool {
    unsafe extern "C" {
        static __stext: u8;
        static __etext: u8;
    }
    let code = addr_of!(__stext) as usize..addr_of!(__etext) as usize;
    let address = address as usize;
    // Reading outside the code could raise the next exception.
    if !code.contains(&address) {
        return false;
    }
    // SAFETY: code is readable, and instructions begin at even addresses.
    let half = |at: usize| unsafe { (at as *const u16).read_volatile() };
    if cfg!(target_arch = "arm") {
        half(address) == 0xBEAB
    } else {
        half(address) == 0x0073 && half(address.wrapping_add(2)) == 0x0010
    }
}
