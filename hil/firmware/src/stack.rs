//! How deep the stack was: the unused part is painted before, and looked through after.

use core::ptr::addr_of;

const PAINT: u32 = 0xC5C5_C5C5;
/// How much below the caller is painted at most, in bytes: what is deeper is not told apart. More
/// costs two instructions per word painted and three per word looked at.
const WINDOW: usize = 16 * 1024;
/// Left alone right below the frame of the painting function.
const MARGIN: usize = 64;

unsafe extern "C" {
    /// The lowest address of the stack, and the one above its highest; the linker script has them.
    static _stack_end: u32;
    static _stack_start: u32;
}

/// A painted stretch of the stack.
#[derive(Clone, Copy, Debug)]
pub struct Painted {
    low: usize,
    high: usize,
}

/// Paints the unused stack, at most 16 KiB of it. Interrupts may go on. O(bytes).
#[inline(never)]
#[must_use]
pub fn paint() -> Painted {
    let here = 0u32;
    let high = (addr_of!(here) as usize).saturating_sub(MARGIN) & !3;
    let low = lowest().max(high.saturating_sub(WINDOW));
    let mut at = low;
    while at < high {
        // SAFETY: from the end of the statics up to below this frame nobody owns the memory: an
        // interrupt that comes meanwhile has left it again. Volatile, so that no call of memset
        // puts a frame there.
        unsafe { (at as *mut u32).write_volatile(PAINT) };
        at = at.wrapping_add(4);
    }
    Painted { low, high }
}

impl Painted {
    /// The most bytes of stack that were in use since, counted from the stack's start; interrupts
    /// included. If the painted stretch was used up it is the depth of its end. O(bytes).
    #[must_use]
    pub fn deepest(&self) -> u32 {
        let mut at = self.low;
        // SAFETY: the words that `paint` wrote, or what ran over them since.
        while at < self.high && unsafe { (at as *const u32).read_volatile() } == PAINT {
            at = at.wrapping_add(4);
        }
        u32::try_from(top().saturating_sub(at)).unwrap_or(u32::MAX)
    }

    /// How deep the stack was where [`paint`] was called, to within the frame of [`paint`].
    #[must_use]
    pub fn began(&self) -> u32 {
        u32::try_from(top().saturating_sub(self.high)).unwrap_or(u32::MAX)
    }

    /// Whether the stack's last word is still as it was painted; if not, the stack has probably run
    /// over the statics. Always true while the painted stretch ends above the stack's end.
    #[must_use]
    pub fn has_room(&self) -> bool {
        // SAFETY: as above.
        self.low > lowest() || unsafe { (self.low as *const u32).read_volatile() } == PAINT
    }
}

/// The size of the stack in bytes: all RAM that is no static.
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
