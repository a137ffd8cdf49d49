use staya_controller::wire::{MAX_FRAME_LEN, Postcard, decode};

/// How the frames of a wire format follow each other on a line. Frames sealed with a key have the
/// framing of [`Postcard`], signed ones that of MAVLink.
pub trait Framing {
    /// The byte that ends each frame and does not occur elsewhere, if the format has one.
    const DELIMITER: Option<u8>;
    /// Length of the longest frame in bytes, including its delimiter.
    const LONGEST: usize;

    /// Classifies the beginning of the received bytes. Bounded work: O([`Self::LONGEST`]).
    fn first(bytes: &[u8]) -> Piece;

    /// Removes the next frame from whole frames, with its delimiter; `None` when nothing is left.
    fn next_frame<'a>(frames: &mut &'a [u8]) -> Option<&'a [u8]>;
}

/// A piece of the bytes received over a line, and its length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Piece {
    /// An intact frame that a robot's controller understands.
    Frame(usize),
    /// Nothing, or intact data for other receivers.
    Other(usize),
    /// Noise, damage or another version of the format.
    Noise(usize),
    /// The beginning of a frame, or no byte at all.
    Begun,
}

impl Framing for Postcard {
    const DELIMITER: Option<u8> = Some(0);
    const LONGEST: usize = MAX_FRAME_LEN;

    fn first(bytes: &[u8]) -> Piece {
        let mut rest = bytes;
        let Some(piece) = Self::next_frame(&mut rest) else {
            return Piece::Begun;
        };
        let len = piece.len();
        match piece.split_last() {
            Some((_, frame)) if decode(frame).is_ok() => Piece::Frame(len),
            Some((_, [_, ..])) => Piece::Noise(len),
            _ => Piece::Other(len),
        }
    }

    fn next_frame<'a>(frames: &mut &'a [u8]) -> Option<&'a [u8]> {
        let zero = frames.iter().position(|byte| *byte == 0)?;
        let (frame, rest) = frames.split_at_checked(zero.saturating_add(1))?;
        *frames = rest;
        Some(frame)
    }
}

#[cfg(feature = "mavlink")]
mod mavlink {
    use super::{Framing, Piece};
    use staya_controller::wire::DecodeError;
    use staya_mavlink::frame::{MAX_FRAME_LEN, Scan, next_frame, scan};
    use staya_mavlink::wire::{Mavlink, decode};

    impl Framing for Mavlink {
        const DELIMITER: Option<u8> = None;
        const LONGEST: usize = MAX_FRAME_LEN;

        fn first(bytes: &[u8]) -> Piece {
            match scan(bytes, false) {
                Scan::Frame { junk: 0, frame } => {
                    let len = frame.bytes().len();
                    match decode(frame.bytes()) {
                        Ok(_) => Piece::Frame(len),
                        Err(DecodeError::Foreign) => Piece::Other(len),
                        Err(_) => Piece::Noise(len),
                    }
                }
                Scan::Nothing { junk: 0 } => Piece::Begun,
                Scan::Frame { junk, .. } | Scan::Nothing { junk } => Piece::Noise(junk),
            }
        }

        fn next_frame<'a>(frames: &mut &'a [u8]) -> Option<&'a [u8]> {
            next_frame(frames).map(|frame| frame.bytes())
        }
    }
}
