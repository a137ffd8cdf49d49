use super::link::PIECE;
use super::{Framing, PacketLink};
use core::convert::Infallible;
use core::future::pending;
use embassy_futures::{select, yield_now};
use embedded_io_async::{Read, Write};

impl<R: Read, W: Write, F: Framing, const IN: usize, const OUT: usize> PacketLink<(R, W), F, IN, OUT> {
    /// Moves bytes both ways until it is cancelled, for example by
    /// `select(ticker.next(), link.serve()).await`. Line errors are counted. Reading and writing
    /// must be cancellable without losing bytes, as in buffered UARTs.
    pub async fn serve(&mut self) -> Infallible {
        let Self { line: (reader, writer), receiver, sender } = self;
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
