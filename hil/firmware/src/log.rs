//! Where logs and prints go: semihosting in the emulator, RTT on a board. `defmt` frames use it.

use core::fmt;
use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

/// Channels. Until one is chosen bytes are dropped.
const NONE: u8 = 0;
const SEMIHOSTING: u8 = 1;
const RTT: u8 = 2;
static CHANNEL: AtomicU8 = AtomicU8::new(NONE);
/// The handle of the host's console, plus one; 0 while it is not open.
static CONSOLE: AtomicU32 = AtomicU32::new(0);

/// Chooses the channel. An emulator that serves no semihosting gets nothing.
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

/// Writes bytes to the chosen channel. RTT drops what has no room: nobody may be reading.
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
        // A host that takes no output changes nothing for the robot.
        let _ = sys_write_orig(console, bytes);
    }
}

/// `rtt_init!` would do it, but for a check that it runs once, which is a panic.
#[cfg(target_arch = "arm")]
mod rtt {
    use core::mem::MaybeUninit;
    use core::ptr::addr_of_mut;
    use rtt_target::rtt::{RttChannel, RttHeader};
    use rtt_target::{ChannelMode, UpChannel};

    /// What a debugger looks for in memory: the header, then the channels that it counts.
    #[repr(C)]
    struct Block {
        header: RttHeader,
        up: RttChannel,
    }

    // SAFETY: the name that debuggers have for it, and nobody else.
    #[unsafe(export_name = "_SEGGER_RTT")]
    static mut BLOCK: MaybeUninit<Block> = MaybeUninit::uninit();
    static mut BYTES: [u8; 256] = [0; 256];
    static mut UP: Option<UpChannel> = None;

    pub fn start() {
        // SAFETY: once, at the start, before anything writes; zeros are a block without channels. The header comes last: a
        // debugger may look at any time.
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
            // SAFETY: interrupts are off, and there is one core.
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

/// Gathers bytes, so that the emulator stops once per line and not once per piece.
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

    /// What is needed while one `defmt` frame is written. Interrupts are off meanwhile.
    struct Frame {
        restore: RestoreState,
        encoder: defmt::Encoder,
        text: Text,
    }

    struct Shared(UnsafeCell<Frame>);
    // SAFETY: only touched with interrupts off, on one core.
    unsafe impl Sync for Shared {}
    static FRAME: Shared = Shared(UnsafeCell::new(Frame {
        restore: RestoreState::invalid(),
        encoder: defmt::Encoder::new(),
        text: Text::new(),
    }));

    #[defmt::global_logger]
    struct Logger;

    // SAFETY: `acquire` turns interrupts off and `release` on again, so that between them nobody
    // else can acquire; defmt calls the others only between them.
    unsafe impl defmt::Logger for Logger {
        fn acquire() {
            // SAFETY: paired with the release in `release`.
            let restore = unsafe { critical_section::acquire() };
            // SAFETY: interrupts are off.
            let frame = unsafe { &mut *FRAME.0.get() };
            frame.restore = restore;
            frame.encoder.start_frame(|bytes| frame.text.add(bytes));
        }

        unsafe fn flush() {}

        unsafe fn release() {
            // SAFETY: interrupts have been off since `acquire`.
            let frame = unsafe { &mut *FRAME.0.get() };
            frame.encoder.end_frame(|bytes| frame.text.add(bytes));
            frame.text.flush();
            let restore = frame.restore;
            // SAFETY: pairs with `acquire`.
            unsafe { critical_section::release(restore) };
        }

        unsafe fn write(bytes: &[u8]) {
            // SAFETY: interrupts have been off since `acquire`.
            let frame = unsafe { &mut *FRAME.0.get() };
            frame.encoder.write(bytes, |bytes| frame.text.add(bytes));
        }
    }
}
