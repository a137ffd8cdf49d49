//! Encoders on plain pins, since this part has no timers that count them.

use core::cell::Cell;
use core::convert::Infallible;
use embassy_futures::select::select;
use embedded_hal::digital::InputPin;
use embedded_hal_async::digital::Wait;

/// Counts the edges of both channels of an encoder into `edges` and never returns. Edges are lost
/// if the processor is busy until the next one.
pub async fn count<P: InputPin + Wait>(mut a: P, mut b: P, edges: &Cell<u16>) -> Infallible {
    let mut was = phase(&mut a, &mut b);
    loop {
        select(a.wait_for_any_edge(), b.wait_for_any_edge()).await;
        let is = phase(&mut a, &mut b);
        let turned = match is.wrapping_sub(was) & 3 {
            1 => 1,
            3 => u16::MAX,
            _ => 0,
        };
        edges.set(edges.get().wrapping_add(turned));
        was = is;
    }
}

/// Quarter of a line, 0 to 3.
fn phase<P: InputPin>(a: &mut P, b: &mut P) -> u8 {
    let (a, b) = (a.is_high().unwrap_or(false), b.is_high().unwrap_or(false));
    u8::from(a) << 1 | u8::from(a != b)
}
