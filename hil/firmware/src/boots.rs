//! What outlives a reset: words of RAM that no start-up code touches.

use core::mem::MaybeUninit;
use core::ptr::addr_of_mut;

/// Tells these words from what RAM holds after power-up. ASCII "STAY".
const MAGIC: u32 = 0x5354_4159;

/// What is kept.
#[derive(Clone, Copy)]
#[repr(C)]
struct Kept {
    /// Starts since power-up.
    boots: u32,
    /// Not 0: a semihosting call made the part fault, because nobody serves it.
    is_mute: u32,
    /// The two before and [`MAGIC`], combined by exclusive or.
    check: u32,
}

#[unsafe(link_section = ".uninit.boots")]
static mut KEPT: MaybeUninit<Kept> = MaybeUninit::uninit();

fn read() -> Option<Kept> {
    // SAFETY: the section is RAM that belongs to this static alone; volatile, so that whatever is
    // there after power-up is taken as it is, and any bits are a valid u32.
    let kept = unsafe { addr_of_mut!(KEPT).cast::<Kept>().read_volatile() };
    (kept.check == kept.boots ^ kept.is_mute ^ MAGIC).then_some(kept)
}

fn write(boots: u32, is_mute: u32) {
    let check = boots ^ is_mute ^ MAGIC;
    // SAFETY: as above. Called before interrupts are on, or right before a reset.
    unsafe {
        addr_of_mut!(KEPT).cast::<Kept>().write_volatile(Kept { boots, is_mute, check });
    }
}

/// Adds one start and returns how many there were, 1 after power-up. Call once, at the start.
pub fn count() -> u32 {
    let (boots, is_mute) = read().map_or((0, 0), |kept| (kept.boots, kept.is_mute));
    let boots = boots.wrapping_add(1).max(1);
    write(boots, is_mute);
    boots
}

/// The count of this start, 1 after power-up.
pub fn current() -> u32 {
    read().map_or(1, |kept| kept.boots)
}

/// Whether semihosting is to be left alone.
pub fn is_mute() -> bool {
    read().is_some_and(|kept| kept.is_mute != 0)
}

/// Remembers over the reset that follows that nobody serves semihosting, and takes this start out
/// of the count.
pub fn mute() {
    write(current().wrapping_sub(1), 1);
}
