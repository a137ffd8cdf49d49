use super::*;
use crate::frame::FrameData;
use crate::frame::tests::frames;
use crate::scene::{Mode, Scene};
use proptest::prelude::*;
use serde_json::json;
use staya_sim::engine::{Engine, operated, simulate};
use staya_sim::scenario::{Intervention, Overrides, Scenario};
use std::cell::Cell;
use std::io::{Cursor, Read, Seek, SeekFrom};
use std::ops::ControlFlow;

fn scene() -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/swap-circle.toml");
    Scene::new(&Scenario::load(&path, &Overrides::default()).unwrap(), Mode::Recording)
}

fn written(frames: &[FrameData], flush_every: usize) -> Vec<u8> {
    let mut writer = Writer::new(Vec::new(), Path::new("a.rec"), &scene()).unwrap();
    for (number, frame) in frames.iter().enumerate() {
        writer.frame(frame).unwrap();
        if number % flush_every == flush_every - 1 {
            writer.flush().unwrap();
        }
    }
    writer.finish(&json!([{"tick": 3, "order": {"kind": "goal"}}]), &json!({"arrived": 7})).unwrap()
}

fn read(bytes: &[u8]) -> Result<Reader<Cursor<&[u8]>>, RecordingError> {
    Reader::new(Cursor::new(bytes), Path::new("a.rec"))
}

fn all(bytes: &[u8]) -> Result<Vec<FrameData>, RecordingError> {
    let mut reader = read(bytes)?;
    reader.scene_text()?;
    reader.orders()?;
    reader.summary()?;
    let Some((first, last)) = reader.ticks() else {
        return Ok(Vec::new());
    };
    let (mut frames, mut tick) = (Vec::new(), first);
    loop {
        let frame = reader.frame(tick)?;
        if frames.last() != Some(&frame) {
            frames.push(frame);
        }
        if tick >= last {
            return Ok(frames);
        }
        tick += 1;
    }
}

fn runs() -> impl Strategy<Value = Vec<FrameData>> {
    prop::collection::vec((frames(), 1..4_u32), 1..12).prop_map(|frames| {
        let mut tick = 0;
        let with_ticks = frames.into_iter().map(|(frame, step)| {
            tick += step;
            FrameData { tick, ..frame }
        });
        with_ticks.collect()
    })
}

#[test]
fn every_part_is_read_back() {
    let frames: Vec<_> = (0..10).map(|tick| FrameData { tick: 5 + 2 * tick, ..FrameData::default() }).collect();
    let bytes = written(&frames, 3);
    let mut reader = read(&bytes).unwrap();
    assert_eq!((reader.ticks(), reader.torn_at()), (Some((5, 23)), None));
    for (asked, tick) in [(0, 5), (5, 5), (6, 5), (7, 7), (10, 9), (11, 11), (23, 23), (99, 23)] {
        assert_eq!(reader.frame(asked).unwrap().tick, tick, "{asked}");
    }
    assert_eq!(reader.scene().unwrap(), scene());
    assert_eq!(reader.orders().unwrap()[0]["tick"], 3);
    assert_eq!(reader.summary().unwrap(), Some(json!({"arrived": 7})));
}

#[test]
fn a_changed_scene_applies_to_later_frames() {
    let mut writer = Writer::new(Vec::new(), Path::new("a.rec"), &scene()).unwrap();
    let frame = |tick| FrameData { tick, ..FrameData::default() };
    writer.frame(&frame(1)).unwrap();
    writer.scene(&Scene { name: "other".into(), ..scene() }).unwrap();
    writer.frame(&frame(2)).unwrap();
    let bytes = writer.finish(&json!([]), &json!({})).unwrap();
    let mut reader = read(&bytes).unwrap();
    assert!(!reader.scene_text_at(1).unwrap().contains("\"other\""));
    assert!(reader.scene_text_at(2).unwrap().contains("\"other\""));
}

#[test]
fn a_changing_map_is_recorded() {
    let text = "name = \"t\"\nticks = 12\n[terrain]\nuniform = { width = 4, height = 1, classes = 1 }\n\
        [[terrain.change]]\nat_s = 4\nfor_s = 3\nclass = 0\ncells = [[2, 0]]\n[robots]\nlist = [{ start = [0, 0], goal = [3, 0] }]\n\
        [[fault]]\nrobot = 1\nat_s = 0\ndown_s = 9\n";
    let scenario = Scenario::parse(text, Path::new("t.toml"), &Overrides::default()).unwrap();
    let mut recorder = RunRecorder::new(Vec::new(), Path::new("a.rec"), &scenario, 1).unwrap();
    simulate(&scenario, |moment, robots| {
        recorder.tick(moment, robots).unwrap();
        ControlFlow::Continue(())
    })
    .unwrap();
    let bytes = recorder.finish(&json!({})).unwrap();
    let mut reader = read(&bytes).unwrap();
    let mut land = |tick| {
        let scene: serde_json::Value = serde_json::from_str(&reader.scene_text_at(tick).unwrap()).unwrap();
        scene["land"]["cells"].as_str().unwrap().to_owned()
    };
    let (open, closed) = (land(4), land(5));
    assert_ne!(open, closed, "it closes before the tick that begins at 4 s");
    assert_eq!([land(0), land(7), land(8), land(12)], [&open, &closed, &open, &open].map(String::from));
}

#[test]
fn interventions_are_recorded_and_a_copy_is_valid_at_any_time() {
    let text = "name = \"t\"\nticks = 9\n[terrain]\nuniform = { width = 4, height = 1, classes = 1 }\n\
        [robots]\nlist = [{ start = [0, 0], goal = [3, 0] }]\n";
    let scenario = Scenario::parse(text, Path::new("t.toml"), &Overrides::default()).unwrap();
    let mut engine = operated(&scenario).unwrap();
    let mut recorder = RunRecorder::new(Vec::new(), Path::new("a.rec"), &scenario, 1).unwrap();
    let take = |engine: &Engine, recorder: &mut RunRecorder<Vec<u8>>| {
        engine.show(&mut |moment, robots| recorder.tick(moment, robots).unwrap());
    };
    take(&engine, &mut recorder);
    let closed = Intervention::Cell { cell: [3, 0], class: 0 };
    for tick in 0..5 {
        if tick == 2 {
            engine.intervene(&closed).unwrap();
            recorder.note(&closed);
        }
        engine.step();
        take(&engine, &mut recorder);
    }
    let early = recorder.clone().finish(&json!({})).unwrap();
    engine.step();
    take(&engine, &mut recorder);
    for (bytes, last) in [(early, 5), (recorder.finish(&json!({})).unwrap(), 6)] {
        let mut reader = read(&bytes).unwrap();
        assert_eq!(reader.ticks(), Some((0, last)));
        assert_eq!(reader.orders().unwrap(), [json!({ "tick": 2, "order": closed })]);
        let mut land = |tick| {
            let scene: serde_json::Value = serde_json::from_str(&reader.scene_text_at(tick).unwrap()).unwrap();
            scene["land"]["cells"].as_str().unwrap().to_owned()
        };
        assert_ne!(land(2), land(3));
        assert_eq!(land(3), land(last));
    }
}

#[test]
fn errors_name_the_file_and_byte_of_the_damage() {
    let frames: Vec<_> = (0..4).map(|tick| FrameData { tick, ..FrameData::default() }).collect();
    let good = written(&frames, 2);
    let scene_end = 12 + 13 + u32::from_le_bytes(good[17..21].try_into().unwrap()) as usize;
    let spoilt = |at: usize| {
        let mut bytes = good.clone();
        bytes[at] ^= 0x40;
        all(&bytes).unwrap_err().to_string()
    };
    assert!(spoilt(0).starts_with("a.rec: byte 0: not a recording; give a file"), "{}", spoilt(0));
    assert!(spoilt(8).contains("byte 8: unsupported version 65"), "{}", spoilt(8));
    let damaged = spoilt(scene_end + 20);
    assert!(damaged.starts_with(&format!("a.rec: byte {scene_end}: this block is damaged")), "{damaged}");
    assert!(spoilt(scene_end + 3).contains("invalid block header"), "{}", spoilt(scene_end + 3));
    assert!(spoilt(scene_end + 4).contains("bytes of at most 268435456"), "{}", spoilt(scene_end + 4));
    assert!(all(b"").is_err() && all(&good[..12]).is_err());
    // An incomplete file is read up to its end.
    let mut torn = read(&good[..good.len() - 1]).unwrap();
    assert_eq!((torn.ticks(), torn.summary().unwrap()), (Some((0, 3)), None));
    assert!(torn.torn_at().is_some());
}

/// A recording of one block with this head and these packed bytes.
fn block(kind: u8, raw: u32, packed: &[u8]) -> Vec<u8> {
    let mut bytes: Vec<u8> = MAGIC.into_iter().chain(VERSION.to_le_bytes()).chain([kind]).collect();
    for word in [raw, packed.len() as u32, crc32fast::hash(packed)] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(packed);
    bytes
}

#[test]
fn too_large_blocks_are_refused_by_their_heads() {
    /// Counts the bytes read.
    #[derive(Debug)]
    struct Counted<'a>(Cursor<&'a [u8]>, &'a Cell<usize>);
    impl Read for Counted<'_> {
        fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
            let count = self.0.read(to)?;
            self.1.set(self.1.get() + count);
            Ok(count)
        }
    }
    impl Seek for Counted<'_> {
        fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
            self.0.seek(to)
        }
    }
    // A million bytes can unpack to 1 GiB.
    let packed = vec![0; 1 << 20];
    for kind in [SCENE, FRAMES, ORDERS, END] {
        for raw in [MOST_RAW + 1, 1 << 30, u32::MAX] {
            let (bytes, read) = (block(kind, raw, &packed), Cell::new(0));
            let error = Reader::new(Counted(Cursor::new(&bytes), &read), Path::new("a.rec")).unwrap_err().to_string();
            let expected = format!(
                "a.rec: byte 12: this block has {raw} uncompressed bytes of at most 268435456; make the recording again"
            );
            assert_eq!(error, expected);
            assert_eq!(read.get(), 12 + 13, "the packed bytes were read");
        }
    }
}

#[test]
fn blocks_are_unpacked_up_to_the_size_in_their_heads() {
    let packed = miniz_oxide::deflate::compress_to_vec(&vec![b' '; 1 << 24], 9);
    for raw in [0, 1, 1000, (1 << 24) - 1] {
        let error = read(&block(SCENE, raw, &packed)).unwrap().scene_text().unwrap_err().to_string();
        assert!(error.contains(&format!("byte 12: this block unpacks to more than {raw} bytes")), "{error}");
    }
    assert_eq!(read(&block(SCENE, 1 << 24, &packed)).unwrap().scene_text().unwrap().len(), 1 << 24);
    let error = read(&block(SCENE, (1 << 24) + 1, &packed)).unwrap().scene_text().unwrap_err().to_string();
    assert!(error.contains("this block is damaged (decompression failed)"), "{error}");
}

#[test]
fn a_full_disk_leaves_complete_blocks() {
    struct Full(Vec<u8>, usize);
    impl std::io::Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let room = (self.1 - self.0.len()).min(bytes.len());
            self.0.extend(&bytes[..room]);
            if room == 0 { Err(io::ErrorKind::StorageFull.into()) } else { Ok(room) }
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    impl Sink for &mut Full {
        fn cut(&mut self, length: u64) {
            self.0.cut(length);
        }
    }
    let mut disk = Full(Vec::new(), 3000);
    let mut writer = Writer::new(&mut disk, Path::new("full.rec"), &scene()).unwrap();
    let error = (0..100_000).find_map(|tick: u32| {
        let position_m = vec![[tick as f32 * 0.37, 1.0 / tick as f32, 0.0]; 9];
        let frame = FrameData { tick, position_m, ..FrameData::default() };
        writer.frame(&frame).and_then(|()| if tick % 5 == 4 { writer.flush() } else { Ok(()) }).err()
    });
    let error = error.unwrap().to_string();
    assert!(error.contains("full.rec") && error.contains("free some space"), "{error}");
    drop(writer);
    let frames = all(&disk.0).unwrap();
    assert!(!frames.is_empty() && frames.len().is_multiple_of(5));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn every_run_round_trips(frames in runs(), flush_every in 1..5_usize) {
        prop_assert_eq!(all(&written(&frames, flush_every)).unwrap(), frames);
    }

    #[test]
    fn a_damaged_file_is_an_error_or_has_fewer_frames(
        frames in runs(), flush_every in 1..5_usize, at: prop::sample::Index, bit in 0..8_u8,
    ) {
        let good = written(&frames, flush_every);
        let at = at.index(good.len());
        if let Ok(some) = all(&good[..at]) {
            prop_assert!(frames.starts_with(&some));
        }
        let mut flipped = good;
        flipped[at] ^= 1 << bit;
        if let Ok(some) = all(&flipped) {
            // The checksum does not cover the kind of a block.
            let mut left = frames.iter();
            prop_assert!(some.iter().all(|frame| left.any(|other| other == frame)), "{} of {}", some.len(), frames.len());
        }
    }
}
