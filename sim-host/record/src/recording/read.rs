use super::{
    BLOCK_HEAD, END, FILE_HEAD, FRAMES, MAGIC, MINDS, MOST_PACKED_BY, MOST_RAW, ORDERS, RecordingError, SCENE, VERSION,
};
use crate::frame::{self, FrameData};
use crate::scene::Scene;
use miniz_oxide::inflate::{TINFLStatus, decompress_to_vec_with_limit};
use serde::de::DeserializeOwned;
use serde_json::Value;
use staya_sim::file::open;
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Range of a frame in an uncompressed block.
pub type Span = Range<usize>;

#[derive(Clone, Copy, Debug)]
struct Block {
    at: u64,
    kind: u8,
    raw: u32,
    packed: u32,
    crc: u32,
    tick: u32,
    /// Index of the block with its scene.
    scene: usize,
}

#[derive(Debug)]
struct Unpacked {
    block: usize,
    bytes: Vec<u8>,
    frames: Vec<(u32, Span)>,
}

/// A recording. Its index and one block at a time are in memory.
#[derive(Debug)]
pub struct Reader<R = BufReader<File>> {
    source: R,
    path: PathBuf,
    blocks: Vec<Block>,
    frames: Vec<usize>,
    unpacked: Option<Unpacked>,
    last_tick: u32,
    torn_at: Option<u64>,
}

impl Reader {
    /// Reads the index of a recording and checks all blocks, in O(bytes) time and constant memory.
    /// A file that ends inside a block is read up to that block.
    ///
    /// # Errors
    /// The file cannot be read, is not a recording, or is damaged.
    pub fn open(path: &Path) -> Result<Self, RecordingError> {
        let file = open(path).map_err(RecordingError::reading(path))?;
        Self::new(BufReader::with_capacity(1 << 16, file), path)
    }
}

impl<R: Read + Seek> Reader<R> {
    /// Reads a recording from any source; errors call it `path`.
    ///
    /// # Errors
    /// See [`Reader::open`].
    pub fn new(mut source: R, path: &Path) -> Result<Self, RecordingError> {
        let io = RecordingError::reading(path);
        let length = source.seek(SeekFrom::End(0)).map_err(&io)?;
        source.rewind().map_err(&io)?;
        let mut head = [0; FILE_HEAD as usize];
        let is_one = length >= FILE_HEAD && {
            source.read_exact(&mut head).map_err(&io)?;
            head[..8] == MAGIC
        };
        if !is_one {
            let (what, remedy) = ("not a recording".to_owned(), "give a file made with `staya run --record`");
            return Err(RecordingError::Format { path: path.to_owned(), at: 0, what, remedy });
        }
        let version = word(&head, 8);
        if version != VERSION {
            let what = format!("unsupported version {version} (this program reads {VERSION})");
            return Err(RecordingError::damage(path, 8, what));
        }
        let (blocks, torn_at) = index(&mut source, path, length)?;
        let frames = (0..blocks.len()).filter(|&at| blocks[at].kind == FRAMES).collect();
        let mut this = Self { source, path: path.to_owned(), blocks, frames, unpacked: None, last_tick: 0, torn_at };
        this.place_frames()?;
        Ok(this)
    }

    fn place_frames(&mut self) -> Result<(), RecordingError> {
        let mut before = None;
        for at in self.frames.clone() {
            let block = self.blocks[at];
            // The first bytes of a block are enough; the rest is checked when it is read.
            let packed = self.packed(&block)?;
            let beginning = match decompress_to_vec_with_limit(&packed, 12) {
                Ok(bytes) => bytes,
                Err(error) => error.output,
            };
            let is_frame = beginning.len() >= 12 && beginning[4..8] == frame::MAGIC;
            let tick = if is_frame { word(&beginning, 8) } else { 0 };
            if !is_frame || before.is_some_and(|before| before >= tick) {
                return Err(RecordingError::damage(&self.path, block.at, "the frames of this block are out of order"));
            }
            before = Some(tick);
            self.blocks[at].tick = tick;
        }
        if let Some(&last) = self.frames.last() {
            let unpacked = self.unpack(last)?;
            self.last_tick = unpacked.frames.last().map_or(0, |(tick, _)| *tick);
        }
        Ok(())
    }

    /// The byte at which an incomplete file ends.
    #[must_use]
    pub const fn torn_at(&self) -> Option<u64> {
        self.torn_at
    }

    /// First and last tick; `None` without frames.
    #[must_use]
    pub fn ticks(&self) -> Option<(u32, u32)> {
        self.frames.first().map(|&first| (self.blocks[first].tick, self.last_tick))
    }

    /// JSON text of the first scene.
    ///
    /// # Errors
    /// The file cannot be read or is damaged.
    pub fn scene_text(&mut self) -> Result<String, RecordingError> {
        self.scene_text_at(0)
    }

    /// JSON text of the scene at a tick.
    ///
    /// # Errors
    /// See [`Reader::scene_text`].
    pub fn scene_text_at(&mut self, tick: u32) -> Result<String, RecordingError> {
        let block = self.blocks[self.block_of(tick).map_or(0, |at| self.blocks[at].scene)];
        let bytes = self.raw(&block)?;
        String::from_utf8(bytes).map_err(|_| RecordingError::damage(&self.path, block.at, "this scene is not UTF-8"))
    }

    /// The first scene.
    ///
    /// # Errors
    /// As [`Reader::scene_text`], or the JSON has another structure.
    pub fn scene(&mut self) -> Result<Scene, RecordingError> {
        self.json(self.blocks[0])
    }

    /// Bytes of the last frame at or before `tick`, else of the first frame; caches one block.
    ///
    /// # Errors
    /// There are no frames, or the file cannot be read or is damaged.
    pub fn frame_bytes(&mut self, tick: u32) -> Result<&[u8], RecordingError> {
        let Some(at) = self.block_of(tick) else {
            return Err(RecordingError::damage(&self.path, FILE_HEAD, "the recording has no frames"));
        };
        let Unpacked { bytes, frames, .. } = self.unpack(at)?;
        let number = frames.partition_point(|(first, _)| *first <= tick).saturating_sub(1);
        Ok(frames.get(number).and_then(|(_, span)| bytes.get(span.clone())).unwrap_or_default())
    }

    /// The last frame at or before `tick`, else the first frame.
    ///
    /// # Errors
    /// See [`Reader::frame_bytes`].
    pub fn frame(&mut self, tick: u32) -> Result<FrameData, RecordingError> {
        let decoded = FrameData::decode(self.frame_bytes(tick)?);
        let at = self.block_of(tick).map_or(0, |at| self.blocks[at].at);
        decoded.map_err(|error| RecordingError::damage(&self.path, at, error.to_string()))
    }

    /// Orders with their ticks; empty if the run was interrupted.
    ///
    /// # Errors
    /// See [`Reader::scene`].
    pub fn orders(&mut self) -> Result<Vec<Value>, RecordingError> {
        self.of_kind(ORDERS).map_or_else(|| Ok(Vec::new()), |block| self.json(block))
    }

    /// Summary of the run; `None` if the run was interrupted.
    ///
    /// # Errors
    /// See [`Reader::scene`].
    pub fn summary(&mut self) -> Result<Option<Value>, RecordingError> {
        self.of_kind(END).map(|block| self.json(block)).transpose()
    }

    fn of_kind(&self, kind: u8) -> Option<Block> {
        self.blocks.iter().rfind(|block| block.kind == kind).copied()
    }

    fn block_of(&self, tick: u32) -> Option<usize> {
        let number = self.frames.partition_point(|&at| self.blocks[at].tick <= tick).saturating_sub(1);
        self.frames.get(number).copied()
    }

    fn json<T: DeserializeOwned>(&mut self, block: Block) -> Result<T, RecordingError> {
        let bytes = self.raw(&block)?;
        let read = serde_json::from_slice(&bytes);
        read.map_err(|error| RecordingError::damage(&self.path, block.at, format!("this block is invalid: {error}")))
    }

    fn packed(&mut self, block: &Block) -> Result<Vec<u8>, RecordingError> {
        let io = RecordingError::reading(&self.path);
        self.source.seek(SeekFrom::Start(block.at + BLOCK_HEAD as u64)).map_err(&io)?;
        let mut packed = vec![0; block.packed as usize];
        self.source.read_exact(&mut packed).map_err(&io)?;
        if crc32fast::hash(&packed) == block.crc {
            return Ok(packed);
        }
        Err(RecordingError::damage(&self.path, block.at, "this block is damaged (wrong checksum)"))
    }

    fn raw(&mut self, block: &Block) -> Result<Vec<u8>, RecordingError> {
        let packed = self.packed(block)?;
        let what = match decompress_to_vec_with_limit(&packed, block.raw as usize) {
            Ok(raw) if raw.len() == block.raw as usize => return Ok(raw),
            Err(error) if error.status == TINFLStatus::HasMoreOutput => {
                format!("this block unpacks to more than {} bytes", block.raw)
            }
            _ => "this block is damaged (decompression failed)".to_owned(),
        };
        Err(RecordingError::damage(&self.path, block.at, what))
    }

    fn unpack(&mut self, at: usize) -> Result<&Unpacked, RecordingError> {
        let unpacked = match self.unpacked.take() {
            Some(unpacked) if unpacked.block == at => unpacked,
            _ => {
                let block = self.blocks[at];
                let mut bytes = self.raw(&block)?;
                let frames = spans(&mut bytes).ok_or_else(|| {
                    RecordingError::damage(&self.path, block.at, "the frames of this block are damaged")
                })?;
                Unpacked { block: at, bytes, frames }
            }
        };
        Ok(self.unpacked.insert(unpacked))
    }
}

/// Undoes the XOR and locates the frames; `None` if a length or tick is invalid.
fn spans(bytes: &mut [u8]) -> Option<Vec<(u32, Span)>> {
    let (mut frames, mut at, mut before) = (Vec::<(u32, Span)>::new(), 0, 0..0);
    while at < bytes.len() {
        let length = word(bytes.get(at..at + 4)?, 0) as usize;
        let span = at + 4..(at + 4).checked_add(length)?;
        let (done, now) = bytes.get_mut(..span.end)?.split_at_mut(span.start);
        now.iter_mut().zip(done.get(before)?).for_each(|(now, before)| *now ^= before);
        let tick = word(now.get(4..8)?, 0);
        if frames.last().is_some_and(|(last, _)| *last >= tick) {
            return None;
        }
        frames.push((tick, span.clone()));
        at = span.end;
        before = span;
    }
    (!frames.is_empty()).then_some(frames)
}

/// The caller has checked the length.
fn word(bytes: &[u8], at: usize) -> u32 {
    let four = bytes.get(at..at + 4).and_then(|four| four.try_into().ok());
    four.map_or(0, u32::from_le_bytes)
}

/// Returns the blocks, and the byte at which an incomplete file ends.
fn index(
    source: &mut (impl Read + Seek),
    path: &Path,
    length: u64,
) -> Result<(Vec<Block>, Option<u64>), RecordingError> {
    let io = RecordingError::reading(path);
    let (mut blocks, mut at, mut scene) = (Vec::new(), FILE_HEAD, None);
    while at < length {
        let mut head = [0; BLOCK_HEAD];
        if length - at < BLOCK_HEAD as u64 {
            break;
        }
        source.seek(SeekFrom::Start(at)).map_err(&io)?;
        source.read_exact(&mut head).map_err(&io)?;
        let (kind, raw, packed) = (head[0], word(&head, 1), word(&head, 5));
        if raw > MOST_RAW {
            let what = format!("this block has {raw} uncompressed bytes of at most {MOST_RAW}");
            return Err(RecordingError::damage(path, at, what));
        }
        let is_possible = u64::from(raw) <= u64::from(packed) * MOST_PACKED_BY;
        if !(SCENE..=MINDS).contains(&kind) || !is_possible {
            let what = format!("invalid block header (kind {kind}, {raw} bytes in {packed})");
            return Err(RecordingError::damage(path, at, what));
        }
        let next = at + BLOCK_HEAD as u64 + u64::from(packed);
        if next > length {
            break;
        }
        if kind == SCENE {
            scene = Some(blocks.len());
        }
        let Some(scene) = scene else {
            return Err(RecordingError::damage(path, at, "the first block is not a scene"));
        };
        blocks.push(Block { at, kind, raw, packed, crc: word(&head, 9), tick: 0, scene });
        at = next;
    }
    if blocks.is_empty() {
        return Err(RecordingError::damage(path, at, "the file ends inside the scene"));
    }
    Ok((blocks, (at < length).then_some(at)))
}
