//! Measures stack depth: paints the unused stack, and later finds how much paint was overwritten.

use core::ptr::addr_of;

const PAINT: u32 = 0xC5C5_C5C5;
/// Most bytes that are painted; two instructions per word painted, three per word checked.
const WINDOW: usize = 16 * 1024;
/// Not painted, below the frame of the painting function.
const MARGIN: usize = 64;

unsafe extern "C" {
    /// Lowest address, and the one above the highest; defined by the linker script.
    static _stack_end: u32;
    static _stack_start: u32;
}

/// A painted range of the stack.
#[derive(Clone, Copy, Debug)]
pub struct Painted {
    low: usize,
    high: usize,
}

/// Paints the unused stack, at most 16 KiB of it. Interrupts may occur. O(bytes).
#[inline(never)]
#[must_use]
pub fn paint() -> Painted {
    let here = 0u32;
    let high = (addr_of!(here) as usize).saturating_sub(MARGIN) & !3;
    let low = lowest().max(high.saturating_sub(WINDOW));
    let mut at = low;
    while at < high {
        // SAFETY: memory from the end of the statics to below this frame is unused: an interrupt
        // meanwhile has returned. Volatile, so that it does not become memset, whose frame would
        // lie there.
        unsafe { (at as *mut u32).write_volatile(PAINT) };
        at = at.wrapping_add(4);
    }
    Painted { low, high }
}

impl Painted {
    /// Most bytes of stack in use since, including interrupts, within the painted range. O(bytes).
    #[must_use]
    pub fn deepest(&self) -> u32 {
        let mut at = self.low;
        // SAFETY: the words that `paint` wrote.
        while at < self.high && unsafe { (at as *const u32).read_volatile() } == PAINT {
            at = at.wrapping_add(4);
        }
        u32::try_from(top().saturating_sub(at)).unwrap_or(u32::MAX)
    }

    /// Stack depth at the call of [`paint`].
    #[must_use]
    pub fn began(&self) -> u32 {
        u32::try_from(top().saturating_sub(self.high)).unwrap_or(u32::MAX)
    }

    /// Whether the last word of the stack still has its paint, else the stack has probably
    /// overwritten the statics. Always true if the painted range ends above the stack's end.
    #[must_use]
    pub fn has_room(&self) -> bool {
        // SAFETY: as above.
        self.low > lowest() || unsafe { (self.low as *const u32).read_volatile() } == PAINT
    }
}

/// Size of the stack, bytes: all RAM without statics.
#[must_use]
pub fn size() -> u32 {
    u32::try_from(top().saturating_sub(lowest())).unwrap_or(u32::MAX)
}

fn lowest() -> usize {
    addr_of!(_stack_end) as usize
}

fn top() -> usize {
    addr_of!(_stack_start) as usize
}
