//! How often the part has started since it got power: a word of RAM that no start-up code touches.

use core::mem::MaybeUninit;
use core::ptr::{addr_of, addr_of_mut};

/// Tells a count from what RAM holds after power-up. ASCII "STAY".
const MAGIC: u32 = 0x5354_4159;

/// The count and its check word.
#[unsafe(link_section = ".uninit.boots")]
static mut KEPT: MaybeUninit<[u32; 2]> = MaybeUninit::uninit();

/// Adds one start and returns how many there were, 1 after power-up. Call once, at the start.
pub fn count() -> u32 {
    let kept = addr_of_mut!(KEPT).cast::<[u32; 2]>();
    // SAFETY: the section is RAM that belongs to this static alone; volatile reads take whatever
    // is there, and any bits are a valid u32. Interrupts are not enabled yet.
    let [count, check] = unsafe { kept.read_volatile() };
    let boots = if check == count ^ MAGIC {
        count.wrapping_add(1).max(1)
    } else {
        1
    };
    // SAFETY: as above.
    unsafe { kept.write_volatile([boots, boots ^ MAGIC]) };
    boots
}

/// The count of this start, 1 after power-up.
pub fn current() -> u32 {
    // SAFETY: `count` wrote it, and nothing writes it since.
    unsafe { addr_of!(KEPT).cast::<u32>().read_volatile() }
}
