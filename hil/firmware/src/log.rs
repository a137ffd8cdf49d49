//! Output of logs (`defmt` frames) and prints: semihosting in the emulator, RTT on a board.

use core::fmt;
use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

/// Until a channel is selected, bytes are dropped.
const NONE: u8 = 0;
const SEMIHOSTING: u8 = 1;
const RTT: u8 = 2;
static CHANNEL: AtomicU8 = AtomicU8::new(NONE);
/// The host's console plus one; 0 while it is not open.
static CONSOLE: AtomicU32 = AtomicU32::new(0);

/// An emulator without semihosting gets no output.
pub fn choose(emulated: bool, is_mute: bool) {
    if emulated {
        if is_mute {
            return;
        }
        CHANNEL.store(SEMIHOSTING, Ordering::Relaxed);
    } else {
        rtt::start();
        CHANNEL.store(RTT, Ordering::Relaxed);
    }
}

/// RTT drops bytes when its buffer is full, since a reader may be absent.
fn write(bytes: &[u8]) {
    match CHANNEL.load(Ordering::Relaxed) {
        SEMIHOSTING => console::write(bytes),
        RTT => rtt::write(bytes),
        _ => {}
    }
}

mod console {
    use super::{CONSOLE, Ordering};
    use semihosting::fd::BorrowedFd;
    use semihosting::sys::arm_compat::{OpenMode, sys_open, sys_write_orig};

    pub fn write(bytes: &[u8]) {
        let mut handle = CONSOLE.load(Ordering::Relaxed);
        if handle == 0 {
            let Ok(opened) = sys_open(c":tt", OpenMode::WRONLY_TRUNC) else {
                return;
            };
            let raw = opened.as_raw_fd();
            core::mem::forget(opened); // stays open
            handle = u32::try_from(raw).unwrap_or(0).saturating_add(1);
            CONSOLE.store(handle, Ordering::Relaxed);
        }
        let Ok(raw) = i32::try_from(handle.wrapping_sub(1)) else {
            return;
        };
        // SAFETY: it was opened above and is never closed.
        let console = unsafe { BorrowedFd::borrow_raw(raw) };
        let _ = sys_write_orig(console, bytes);
    }
}

/// Replaces `rtt_init!`, which panics if it runs twice.
#[cfg(target_arch = "arm")]
mod rtt {
    use core::mem::MaybeUninit;
    use core::ptr::addr_of_mut;
    use rtt_target::rtt::{RttChannel, RttHeader};
    use rtt_target::{ChannelMode, UpChannel};

    #[repr(C)]
    struct Block {
        header: RttHeader,
        up: RttChannel,
    }

    // SAFETY: debuggers expect this name; no other symbol has it.
    #[unsafe(export_name = "_SEGGER_RTT")]
    static mut BLOCK: MaybeUninit<Block> = MaybeUninit::uninit();
    static mut BYTES: [u8; 256] = [0; 256];
    static mut UP: Option<UpChannel> = None;

    pub fn start() {
        // SAFETY: runs once, before any write. Zeros are a block without channels; the header comes
        // last because a debugger may read at any time.
        unsafe {
            let block = addr_of_mut!(BLOCK).cast::<Block>();
            block.write_bytes(0, 1);
            (*block).up.init(c"defmt".as_ptr().cast(), ChannelMode::NoBlockTrim, addr_of_mut!(BYTES));
            (*block).header.init(1, 0);
            *addr_of_mut!(UP) = Some(UpChannel::new(addr_of_mut!((*block).up)));
        }
    }

    pub fn write(bytes: &[u8]) {
        critical_section::with(|_| {
            // SAFETY: interrupts are disabled, and there is one core.
            if let Some(up) = unsafe { &mut *addr_of_mut!(UP) } {
                up.write(bytes);
            }
        });
    }
}

/// RISC-V is only emulated.
#[cfg(not(target_arch = "arm"))]
mod rtt {
    pub fn start() {}
    pub fn write(_: &[u8]) {}
}

/// Line buffer: the emulator stops once per line and not once per piece.
pub struct Text {
    bytes: [u8; 96],
    used: usize,
}

impl Text {
    pub const fn new() -> Self {
        Self { bytes: [0; 96], used: 0 }
    }

    fn add(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            if self.used == self.bytes.len() {
                self.flush();
            }
            if let Some(place) = self.bytes.get_mut(self.used) {
                *place = byte;
                self.used += 1;
            }
        }
    }

    pub fn flush(&mut self) {
        write(self.bytes.get(..self.used).unwrap_or(&[]));
        self.used = 0;
    }
}

impl fmt::Write for Text {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.add(text.as_bytes());
        Ok(())
    }
}

mod frames {
    use super::Text;
    use core::cell::UnsafeCell;
    use critical_section::RestoreState;

    struct Frame {
        restore: RestoreState,
        encoder: defmt::Encoder,
        text: Text,
    }

    struct Shared(UnsafeCell<Frame>);
    // SAFETY: accessed only with interrupts disabled, on one core.
    unsafe impl Sync for Shared {}
    static FRAME: Shared = Shared(UnsafeCell::new(Frame {
        restore: RestoreState::invalid(),
        encoder: defmt::Encoder::new(),
        text: Text::new(),
    }));

    #[defmt::global_logger]
    struct Logger;

    // SAFETY: `acquire` disables interrupts and `release` restores them, so that no other code can
    // acquire in between; defmt calls the other functions only in between.
    unsafe impl defmt::Logger for Logger {
        fn acquire() {
            // SAFETY: paired with the release in `release`.
            let restore = unsafe { critical_section::acquire() };
            // SAFETY: interrupts are disabled.
            let frame = unsafe { &mut *FRAME.0.get() };
            frame.restore = restore;
            frame.encoder.start_frame(|bytes| frame.text.add(bytes));
        }

        unsafe fn flush() {}

        unsafe fn release() {
            // SAFETY: interrupts have been disabled since `acquire`.
            let frame = unsafe { &mut *FRAME.0.get() };
            frame.encoder.end_frame(|bytes| frame.text.add(bytes));
            frame.text.flush();
            let restore = frame.restore;
            // SAFETY: paired with `acquire`.
            unsafe { critical_section::release(restore) };
        }

        unsafe fn write(bytes: &[u8]) {
            // SAFETY: interrupts have been disabled since `acquire`.
            let frame = unsafe { &mut *FRAME.0.get() };
            frame.encoder.write(bytes, |bytes| frame.text.add(bytes));
        }
    }
}
