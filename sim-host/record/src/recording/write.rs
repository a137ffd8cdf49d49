use super::{BLOCK_HEAD, END, FRAMES, MAGIC, MINDS, MOST_RAW, ORDERS, RecordingError, SCENE, VERSION};
use crate::frame::FrameData;
use crate::scene::Scene;
use serde::Serialize;
use serde_json::Value;
use staya_sim::record::Output;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A page unpacks one block to show one moment.
const BLOCK: usize = 1 << 18;
const MINDS_BLOCK: usize = 1 << 20;
/// Packs within a few per cent of the slower levels.
const LEVEL: u8 = 6;

/// An output that can be truncated after a failed write.
pub trait Sink: Write {
    /// Truncates to `length` bytes, if possible.
    fn cut(&mut self, length: u64);
}

impl Sink for Output {
    fn cut(&mut self, length: u64) {
        Self::cut(self, length);
    }
}

impl Sink for Vec<u8> {
    fn cut(&mut self, length: u64) {
        self.truncate(usize::try_from(length).unwrap_or(usize::MAX));
    }
}

/// Writes a recording, which always ends with a complete block. Memory: one block and one frame.
#[derive(Clone, Debug)]
pub struct Writer<W: Sink> {
    out: W,
    path: PathBuf,
    written: u64,
    raw: Vec<u8>,
    /// JSON, without the last bracket.
    minds: Vec<u8>,
    /// The previous frame, for the XOR.
    before: Vec<u8>,
    frame: Vec<u8>,
}

impl<W: Sink> Writer<W> {
    /// Starts a recording in `out`; errors call it `path`.
    ///
    /// # Errors
    /// `out` cannot be written.
    pub fn new(out: W, path: &Path, scene: &Scene) -> Result<Self, RecordingError> {
        let mut this = Self {
            out,
            path: path.to_owned(),
            written: 0,
            raw: Vec::new(),
            minds: Vec::new(),
            before: Vec::new(),
            frame: Vec::new(),
        };
        let head: Vec<u8> = MAGIC.into_iter().chain(VERSION.to_le_bytes()).collect();
        this.write(&head)?;
        this.scene(scene)?;
        Ok(this)
    }

    /// Writes the scene of the next frames, after the map or obstacles changed.
    ///
    /// # Errors
    /// The recording cannot be written.
    pub fn scene(&mut self, scene: &Scene) -> Result<(), RecordingError> {
        self.flush()?;
        self.json(SCENE, scene)
    }

    /// Adds a frame; ticks must rise. O(bytes of the frame).
    ///
    /// # Errors
    /// The recording cannot be written. The file then ends with the previous block.
    pub fn frame(&mut self, frame: &FrameData) -> Result<(), RecordingError> {
        frame.encode(&mut self.frame);
        let fits = self.raw.len() + self.frame.len() + 4 <= MOST_RAW as usize;
        if !fits || self.raw.len() >= BLOCK || self.minds.len() >= MINDS_BLOCK {
            self.flush()?;
        }
        self.raw.extend((self.frame.len() as u32).to_le_bytes());
        let shared = self.frame.len().min(self.before.len());
        let pairs = self.frame.iter().zip(&self.before);
        self.raw.extend(pairs.map(|(now, before)| now ^ before));
        self.raw.extend_from_slice(&self.frame[shared..]);
        std::mem::swap(&mut self.frame, &mut self.before);
        Ok(())
    }

    /// Adds the message `robot` about a robot at the tick of the last frame.
    pub fn mind(&mut self, mind: &Value) {
        self.minds.push(if self.minds.is_empty() { b'[' } else { b',' });
        self.minds.extend(mind.to_string().bytes());
    }

    /// Writes the buffered frames and minds.
    ///
    /// # Errors
    /// The recording cannot be written.
    pub fn flush(&mut self) -> Result<(), RecordingError> {
        let raw = std::mem::take(&mut self.raw);
        self.before.clear();
        if raw.is_empty() {
            return Ok(());
        }
        let done = self.block(FRAMES, &raw);
        self.raw = raw;
        self.raw.clear();
        let mut minds = std::mem::take(&mut self.minds);
        if minds.is_empty() {
            return done;
        }
        minds.push(b']');
        done.and_then(|()| self.block(MINDS, &minds))
    }

    /// Writes the buffered frames, if possible, and returns the output.
    pub fn stop(mut self) -> W {
        let _ = self.flush();
        self.out
    }

    /// Writes the orders with their ticks and the summary. Returns the output.
    ///
    /// # Errors
    /// The recording cannot be written.
    pub fn finish(mut self, orders: &impl Serialize, summary: &impl Serialize) -> Result<W, RecordingError> {
        self.flush()?;
        self.json(ORDERS, orders)?;
        self.json(END, summary)?;
        self.out.flush().map_err(RecordingError::writing(&self.path))?;
        Ok(self.out)
    }

    fn json(&mut self, kind: u8, value: &impl Serialize) -> Result<(), RecordingError> {
        let text = serde_json::to_vec(value).map_err(io::Error::from).map_err(RecordingError::writing(&self.path))?;
        self.block(kind, &text)
    }

    fn block(&mut self, kind: u8, raw: &[u8]) -> Result<(), RecordingError> {
        let packed = miniz_oxide::deflate::compress_to_vec(raw, LEVEL);
        let lengths =
            u32::try_from(raw.len()).ok().filter(|raw| *raw <= MOST_RAW).zip(u32::try_from(packed.len()).ok());
        let Some((raw, length)) = lengths else {
            let text = format!("a block of {} bytes is too large; record a smaller scenario", raw.len());
            return Err(RecordingError::writing(&self.path)(io::Error::other(text)));
        };
        let mut bytes = Vec::with_capacity(BLOCK_HEAD + packed.len());
        bytes.push(kind);
        for word in [raw, length, crc32fast::hash(&packed)] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend(packed);
        self.write(&bytes)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), RecordingError> {
        self.out.write_all(bytes).map_err(|source| {
            self.out.cut(self.written);
            RecordingError::writing(&self.path)(source)
        })?;
        self.written += bytes.len() as u64;
        Ok(())
    }
}
