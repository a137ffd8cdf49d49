//! Writes a run as an MCAP file with Foxglove's schemas, for Foxglove, Lichtblick and Rerun.
//!
//! | topic | schema | when |
//! | --- | --- | --- |
//! | `/tf` | `foxglove.FrameTransforms` | once: the origin of frame `map` in frame `world` |
//! | `/land` | `foxglove.Grid` | once: per cell 0 for a wall, otherwise the ticks to cross it |
//! | `/obstacles` | `foxglove.SceneUpdate` | once |
//! | `/bodies` | `foxglove.SceneUpdate` | each frame: robots and intruders |
//! | `/poses` | `foxglove.PosesInFrame` | each frame: robots, intruders, facing their velocity |
//! | `/goals` | `foxglove.SceneUpdate` | on change: crosses |
//! | `/events` | `foxglove.Log` | when a robot's mode changes |
//! | `/figures` | `staya.Figures` (JSON) | each frame |
//!
//! Positions are in frame `map`, metres; `world` has the scenario's coordinates. Times are
//! simulated and start at 0.

mod draw;
mod proto;
mod schema;

use crate::frame::FrameData;
use crate::recording::RecordingError;
use crate::scene::Scene;
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use draw::{looking, pose, stamp, vector};
use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions};
use proto::Bytes;
use staya_controller::robot::Mode;
use std::collections::BTreeMap;
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};

/// A killed run loses its last chunk.
const CHUNK: u64 = 1 << 20;
const INFO: u64 = 2;
const WARNING: u64 = 3;

/// Topic and schema (without package) of each channel.
const TOPICS: [(&str, &str); 7] = [
    ("/tf", "FrameTransforms"),
    ("/land", "Grid"),
    ("/obstacles", "SceneUpdate"),
    ("/bodies", "SceneUpdate"),
    ("/poses", "PosesInFrame"),
    ("/goals", "SceneUpdate"),
    ("/events", "Log"),
];
const TF: usize = 0;
const LAND: usize = 1;
const OBSTACLES: usize = 2;
const BODIES: usize = 3;
const POSES: usize = 4;
const GOALS: usize = 5;
const EVENTS: usize = 6;
const FIGURES: usize = 7;

/// Writes an MCAP file during a run. Memory: two chunks, a frame, and an entry for each chunk.
pub struct McapWriter<W: Write + Seek> {
    out: mcap::Writer<W>,
    path: PathBuf,
    scene: Scene,
    /// Number in the file, and messages so far.
    channels: Vec<(u16, u32)>,
    goals: Vec<[u32; 3]>,
    modes: Vec<u8>,
}

impl<W: Write + Seek> McapWriter<W> {
    /// Starts a file in `out`; errors call it `path`.
    ///
    /// # Errors
    /// `out` cannot be written.
    pub fn new(out: W, path: &Path, scene: &Scene) -> Result<Self, RecordingError> {
        let error = failed(path);
        // Without seeking, each complete chunk is final, so a file that is cut off is valid.
        let options = WriteOptions::new().compression(None).chunk_size(Some(CHUNK)).disable_seeking(true);
        let mut out = options.library(concat!("staya ", env!("CARGO_PKG_VERSION"))).create(out).map_err(&error)?;
        let (descriptors, mut channels) = (schema::descriptors(), Vec::new());
        for (topic, name) in TOPICS {
            let schema = out.add_schema(&format!("foxglove.{name}"), "protobuf", &descriptors).map_err(&error)?;
            channels.push((out.add_channel(schema, topic, "protobuf", &BTreeMap::new()).map_err(&error)?, 0));
        }
        let figures = out.add_schema("staya.Figures", "jsonschema", schema::FIGURES.as_bytes()).map_err(&error)?;
        channels.push((out.add_channel(figures, "/figures", "json", &BTreeMap::new()).map_err(&error)?, 0));
        let path = path.to_owned();
        Ok(Self { out, path, scene: scene.clone(), channels, goals: Vec::new(), modes: Vec::new() })
    }

    /// Writes a frame. O(bytes of the frame).
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn frame(&mut self, frame: &FrameData) -> Result<(), RecordingError> {
        let at_ns = nanos(frame.time_s);
        if self.channels[BODIES].1 == 0 {
            self.begin(at_ns)?;
        }
        let robots = self.scene.robots.id.len().min(frame.bodies());
        self.send(BODIES, at_ns, &draw::bodies(&self.scene, frame, at_ns))?;
        let mut poses = Bytes::default();
        poses.message(1, |out| stamp(out, at_ns));
        poses.text(2, draw::FRAME);
        for (position_m, velocity_mps) in frame.position_m.iter().zip(&frame.velocity_mps) {
            poses.message(3, |out| looking(out, position_m.map(f64::from), *velocity_mps));
        }
        self.send(POSES, at_ns, &poses.0)?;
        let goals: Vec<_> = frame.target_m.iter().take(robots).map(|goal| goal.map(f32::to_bits)).collect();
        if goals != self.goals {
            self.send(GOALS, at_ns, &draw::goals(&self.scene, &frame.target_m[..goals.len()], at_ns))?;
            self.goals = goals;
        }
        self.events(frame, robots, at_ns)?;
        let mut figures = serde_json::to_value(&frame.figures).unwrap_or_default();
        figures["tick"] = frame.tick.into();
        self.send(FIGURES, at_ns, figures.to_string().as_bytes())
    }

    /// Completes the file and returns the output.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn finish(mut self) -> Result<W, RecordingError> {
        self.out.finish().map_err(failed(&self.path))?;
        Ok(self.out.into_inner())
    }

    /// Ends the file early: writes its index, if possible. Returns the output.
    pub fn stop(mut self) -> W {
        let _ = self.out.finish();
        self.out.into_inner()
    }

    fn begin(&mut self, at_ns: u64) -> Result<(), RecordingError> {
        let origin_m = self.scene.origin_m;
        let mut frames = Bytes::default();
        frames.message(1, |out| {
            out.message(1, |out| stamp(out, at_ns));
            out.text(2, "world");
            out.text(3, draw::FRAME);
            out.message(4, |out| vector(out, origin_m));
            out.message(5, |out| out.double(4, 1.0));
        });
        self.send(TF, at_ns, &frames.0)?;
        if let Some(land) = &self.scene.land {
            let mut grid = Bytes::default();
            grid.message(1, |out| stamp(out, at_ns));
            grid.text(2, draw::FRAME);
            let [x, y] = land.origin_m;
            grid.message(3, |out| pose(out, [x, y, 0.0], 0.0));
            grid.fixed32(4, land.width.into());
            grid.message(5, |out| {
                out.double(1, land.cell_m);
                out.double(2, land.cell_m);
            });
            grid.fixed32(6, land.width.into());
            grid.fixed32(7, 1);
            grid.message(8, |out| {
                out.text(1, "ticks");
                out.fixed32(2, 0);
                out.int(3, 1);
            });
            grid.bytes(9, &BASE64_STANDARD.decode(&land.cells).unwrap_or_default());
            self.send(LAND, at_ns, &grid.0)?;
        }
        let obstacles = draw::obstacles(&self.scene, at_ns);
        self.send(OBSTACLES, at_ns, &obstacles)
    }

    /// The first frame only logs the number of robots.
    fn events(&mut self, frame: &FrameData, robots: usize, at_ns: u64) -> Result<(), RecordingError> {
        let now = frame.mode.get(..robots).unwrap_or_default();
        let before = std::mem::replace(&mut self.modes, now.to_vec());
        if before.is_empty() {
            let text = format!("{}, seed {}: {robots} robots", self.scene.name, self.scene.seed);
            return self.log(INFO, "run", &text, at_ns);
        }
        for (index, (mode, before)) in now.iter().zip(&before).enumerate() {
            let name = |mode: u8| Mode::from_number(mode).map_or("?", Mode::name);
            if mode != before {
                let level = if *mode == Mode::Fault as u8 { WARNING } else { INFO };
                let id = self.scene.robots.id[index];
                let text = format!("{} after {}", name(*mode), name(*before));
                self.log(level, &format!("robot {id}"), &text, at_ns)?;
            }
        }
        Ok(())
    }

    fn log(&mut self, level: u64, name: &str, text: &str, at_ns: u64) -> Result<(), RecordingError> {
        let mut log = Bytes::default();
        log.message(1, |out| stamp(out, at_ns));
        log.int(2, level);
        log.text(3, text);
        log.text(4, name);
        self.send(EVENTS, at_ns, &log.0)
    }

    fn send(&mut self, channel: usize, at_ns: u64, data: &[u8]) -> Result<(), RecordingError> {
        let (channel_id, sequence) = &mut self.channels[channel];
        let header =
            MessageHeader { channel_id: *channel_id, sequence: *sequence, log_time: at_ns, publish_time: at_ns };
        *sequence = sequence.wrapping_add(1);
        self.out.write_to_known_channel(&header, data).map_err(failed(&self.path))
    }
}

/// 0 for negative times and NaN.
fn nanos(time_s: f64) -> u64 {
    libm::round(time_s * 1e9) as u64
}

fn failed(path: &Path) -> impl Fn(McapError) -> RecordingError {
    let writing = RecordingError::writing(path);
    move |error| {
        writing(match error {
            McapError::Io(error) => error,
            other => io::Error::other(other.to_string()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mode;
    use staya_sim::scenario::{Overrides, Scenario};

    fn written(frames: &[FrameData]) -> Vec<u8> {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/twenty-discs.toml");
        let scene = Scene::new(&Scenario::load(&path, &Overrides::default()).unwrap(), Mode::Recording);
        let mut bytes = io::Cursor::new(Vec::new());
        let mut writer = McapWriter::new(&mut bytes, Path::new("a.mcap"), &scene).unwrap();
        frames.iter().for_each(|frame| writer.frame(frame).unwrap());
        writer.finish().unwrap();
        bytes.into_inner()
    }

    fn counts(bytes: &[u8]) -> BTreeMap<String, usize> {
        let mut counts = BTreeMap::new();
        for message in mcap::MessageStream::new(bytes).unwrap() {
            *counts.entry(message.unwrap().channel.topic.clone()).or_default() += 1;
        }
        counts
    }

    #[test]
    fn static_messages_are_written_once_and_others_each_frame() {
        let frame = |tick: u32, mode: u8| FrameData {
            tick,
            time_s: f64::from(tick) / 10.0,
            position_m: vec![[tick as f32, 0.0, 0.0]; 20],
            velocity_mps: vec![[1.0, 0.0, 0.0]; 20],
            target_m: vec![[9.0, 9.0, 0.0]; 20],
            mode: vec![mode; 20],
            ..FrameData::default()
        };
        let bytes = written(&[frame(0, 2), frame(1, 2), frame(2, 4)]);
        let expected = [("/bodies", 3), ("/events", 21), ("/figures", 3), ("/goals", 1), ("/land", 1)];
        let expected = expected.into_iter().chain([("/obstacles", 1), ("/poses", 3), ("/tf", 1)]);
        assert_eq!(counts(&bytes), expected.map(|(topic, count)| (topic.to_owned(), count)).collect());
    }

    #[test]
    fn invalid_times_are_zero() {
        assert_eq!([f64::NAN, -1.0, 0.05].map(nanos), [0, 0, 50_000_000]);
    }
}
