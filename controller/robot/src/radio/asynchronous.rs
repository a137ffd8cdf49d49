//! The link for asynchronous HALs.

use super::{Counts, Inbound, Outbound, Receiver, Sender};
#[cfg(feature = "mavlink")]
use super::{MavlinkReceiver, MavlinkSender};
use core::convert::Infallible;
use core::future::pending;
use embassy_futures::{select, yield_now};
use embedded_io_async::{Read, Write};

/// Bytes that one call moves at a time.
const PIECE: usize = 32;

/// Frames over the two halves of an asynchronous line.
///
/// Between two steps let [`Self::serve`] run beside the wait for the next one, for example
/// `select(ticker.next(), link.serve()).await`.
///
/// Reading and writing must stand being cancelled without losing bytes, as buffered UARTs do (those with a ring
/// that an interrupt or a DMA fills).
#[derive(Clone, Debug)]
pub struct AsyncLink<R, W, I, O> {
    reader: R,
    writer: W,
    receiver: I,
    sender: O,
}

/// [`AsyncLink`] for robots that speak postcard; `IN` and `OUT` as for [`PacketLink`](super::PacketLink).
pub type AsyncPacketLink<R, W, const IN: usize = 1024, const OUT: usize = 512> =
    AsyncLink<R, W, Receiver<IN>, Sender<OUT>>;

/// [`AsyncLink`] for robots that speak MAVLink; `IN` and `OUT` as for [`PacketLink`](super::PacketLink).
#[cfg(feature = "mavlink")]
pub type AsyncMavlinkLink<R, W, const IN: usize = 1536, const OUT: usize = 512> =
    AsyncLink<R, W, MavlinkReceiver<IN>, MavlinkSender<OUT>>;

impl<R, W, const IN: usize, const OUT: usize> AsyncPacketLink<R, W, IN, OUT> {
    /// Over the line's two halves, with nothing received and nothing to send.
    #[must_use]
    pub const fn new(reader: R, writer: W) -> Self {
        Self {
            reader,
            writer,
            receiver: Receiver::new(),
            sender: Sender::new(),
        }
    }
}

#[cfg(feature = "mavlink")]
impl<R, W, const IN: usize, const OUT: usize> AsyncMavlinkLink<R, W, IN, OUT> {
    /// Over the line's two halves, with nothing received and nothing to send.
    #[must_use]
    pub const fn new(reader: R, writer: W) -> Self {
        Self {
            reader,
            writer,
            receiver: MavlinkReceiver::new(),
            sender: MavlinkSender::new(),
        }
    }
}

impl<R: Read, W: Write, I: Inbound, O: Outbound> AsyncLink<R, W, I, O> {
    /// The frames since the last call, for [`Inputs::inbox`](staya_controller::agent::Inputs::inbox).
    #[must_use]
    pub fn take(&mut self) -> &[u8] {
        self.receiver.take()
    }

    /// Queues the frames of [`Outputs::outbox`](staya_controller::agent::Outputs::outbox); [`Self::serve`] sends them.
    pub fn send(&mut self, outbox: &[u8]) {
        self.sender.send(outbox);
    }

    /// What came in, and what went out.
    #[must_use]
    pub fn counts(&self) -> (Counts, Counts) {
        (self.receiver.counts(), self.sender.counts())
    }

    /// Moves bytes both ways until it is cancelled. Errors of the line are counted, what they spoiled is forgotten, and after
    /// each one other tasks have their turn.
    pub async fn serve(&mut self) -> Infallible {
        let Self {
            reader,
            writer,
            receiver,
            sender,
        } = self;
        let hear = async {
            let mut piece = [0; PIECE];
            loop {
                let len = reader.read(&mut piece).await.unwrap_or(0);
                match piece.get(..len) {
                    Some(bytes) if !bytes.is_empty() => receiver.push(bytes),
                    _ => {
                        receiver.line_error();
                        yield_now().await;
                    }
                }
            }
        };
        let say = async {
            while !sender.unsent().is_empty() {
                match writer.write(sender.unsent()).await {
                    Ok(len) if len > 0 => sender.sent(len),
                    _ => {
                        sender.line_error();
                        yield_now().await;
                    }
                }
            }
            pending().await
        };
        match select::select(hear, say).await {
            select::Either::First(never) | select::Either::Second(never) => never,
        }
    }
}
