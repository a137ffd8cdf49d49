//! State in RAM that survives a reset: no start-up code touches it.

use core::mem::MaybeUninit;
use core::ptr::addr_of_mut;

/// "STAY": not the contents of RAM after power-up.
const MAGIC: u32 = 0x5354_4159;

#[derive(Clone, Copy)]
#[repr(C)]
struct Kept {
    boots: u32,
    /// Not 0 if nothing serves semihosting calls.
    is_mute: u32,
    /// Exclusive or of the previous two and [`MAGIC`].
    check: u32,
}

#[unsafe(link_section = ".uninit.boots")]
static mut KEPT: MaybeUninit<Kept> = MaybeUninit::uninit();

fn read() -> Option<Kept> {
    // SAFETY: the section is RAM of this static alone. The read is volatile, so that it takes the
    // contents after power-up as they are, and any bits are a valid u32.
    let kept = unsafe { addr_of_mut!(KEPT).cast::<Kept>().read_volatile() };
    (kept.check == kept.boots ^ kept.is_mute ^ MAGIC).then_some(kept)
}

fn write(boots: u32, is_mute: u32) {
    let check = boots ^ is_mute ^ MAGIC;
    // SAFETY: as above. Called before interrupts are enabled, or right before a reset.
    unsafe {
        addr_of_mut!(KEPT).cast::<Kept>().write_volatile(Kept { boots, is_mute, check });
    }
}

/// Returns the number of starts, 1 after power-up. Call it once, at the start.
pub fn count() -> u32 {
    let (boots, is_mute) = read().map_or((0, 0), |kept| (kept.boots, kept.is_mute));
    let boots = boots.wrapping_add(1).max(1);
    write(boots, is_mute);
    boots
}

pub fn current() -> u32 {
    read().map_or(1, |kept| kept.boots)
}

/// Semihosting must not be used.
pub fn is_mute() -> bool {
    read().is_some_and(|kept| kept.is_mute != 0)
}

/// Records this for the next start, and does not count the current one.
pub fn mute() {
    write(current().wrapping_sub(1), 1);
}
