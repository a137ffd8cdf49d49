use super::*;
use proptest::prelude::*;

pub fn frames() -> impl Strategy<Value = FrameData> {
    let float = any::<i32>().prop_map(|n| n as f32 / 1024.0);
    let body = ((prop::array::uniform3(float.clone()), prop::array::uniform3(float)), any::<(u32, u8, u8)>());
    let bodies = prop::collection::vec(body, 0..9);
    let figures = (any::<u16>(), any::<u32>(), prop::option::of(any::<i16>()));
    (any::<u32>(), any::<i32>(), any::<bool>(), any::<bool>(), bodies, figures).prop_map(
        |(tick, time, has_z, has_targets, bodies, (arrived, sent, order))| {
            let flat = |[x, y, z]: [f32; 3]| [x, y, if has_z { z } else { 0.0 }];
            let targets = has_targets && !bodies.is_empty();
            FrameData {
                tick,
                time_s: f64::from(time) / 64.0,
                has_z,
                position_m: bodies.iter().map(|((at, _), _)| flat(*at)).collect(),
                velocity_mps: bodies.iter().map(|((_, by), _)| flat(*by)).collect(),
                target_m: bodies.iter().filter(|_| targets).map(|((at, by), _)| flat([by[0], at[1], by[2]])).collect(),
                leader: bodies.iter().map(|(_, (leader, ..))| *leader).collect(),
                mode: bodies.iter().map(|(_, (_, mode, _))| *mode).collect(),
                wait: bodies.iter().map(|(_, (.., wait))| *wait).collect(),
                figures: Figures {
                    arrived: arrived.into(),
                    packets: PacketCounts { sent: sent.into(), ..PacketCounts::default() },
                    order: order.map(|order| f64::from(order) / 256.0),
                    hash: format!("{sent:016x}"),
                    ..Figures::default()
                },
            }
        },
    )
}

fn encoded(frame: &FrameData) -> Vec<u8> {
    let mut bytes = Vec::new();
    frame.encode(&mut bytes);
    bytes
}

#[test]
fn bytes_follow_the_protocol() {
    let frame = FrameData {
        tick: 7,
        time_s: 3.5,
        position_m: vec![[1.0, 2.0, 0.0], [3.0, 4.0, 0.0]],
        velocity_mps: vec![[0.5, -0.5, 0.0]; 2],
        target_m: vec![[9.0, 8.0, 0.0], [f32::NAN; 3]],
        leader: vec![NONE, 0],
        mode: vec![2, 4],
        wait: vec![NO_WAIT, 3],
        ..FrameData::default()
    };
    let bytes = encoded(&frame);
    let float = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    assert_eq!(&bytes[..8], b"STF1\x07\0\0\0");
    assert_eq!(f64::from_le_bytes(bytes[8..16].try_into().unwrap()), 3.5);
    assert_eq!(&bytes[16..24], [2, 0, 0, 0, 2, 0, 0, 0]);
    assert_eq!([32, 36, 40, 44].map(float), [1.0, 3.0, 2.0, 4.0]);
    assert_eq!([48, 52, 56, 60].map(float), [0.5, 0.5, -0.5, -0.5]);
    assert_eq!([64, 72].map(float), [9.0, 8.0]);
    assert!(float(68).is_nan() && float(76).is_nan());
    assert_eq!(&bytes[80..88], [255, 255, 255, 255, 0, 0, 0, 0]);
    assert_eq!(&bytes[88..96], [2, 4, 0, 0, 255, 3, 0, 0]);
    let figures: serde_json::Value = serde_json::from_slice(&bytes[96..]).unwrap();
    assert_eq!(bytes[24..28], (bytes.len() as u32 - 96).to_le_bytes());
    assert!(figures["gap_m"].is_null() && figures["packets"]["sent"] == 0);
}

#[test]
fn headers_with_too_many_bodies_are_refused_without_allocation() {
    let mut bytes = encoded(&FrameData::default());
    bytes[16..20].fill(0xff);
    bytes[24..28].fill(0xff);
    let error = FrameData::decode(&bytes).unwrap_err();
    assert!(matches!(error, FrameError::Length { expected, .. } if expected > 1 << 36), "{error}");
    assert_eq!(FrameData::decode(&bytes[..31]), Err(FrameError::Magic));
    assert_eq!(FrameData::decode(b""), Err(FrameError::Magic));
}

proptest! {
    #[test]
    fn every_frame_round_trips(frame in frames()) {
        prop_assert_eq!(FrameData::decode(&encoded(&frame)), Ok(frame));
    }

    #[test]
    fn damaged_bytes_give_a_frame_or_an_error(frame in frames(), at: prop::sample::Index, flip: u8, cut: prop::sample::Index) {
        let mut bytes = encoded(&frame);
        let at = at.index(bytes.len());
        bytes[at] ^= flip;
        let _ = FrameData::decode(&bytes);
        let cut = cut.index(bytes.len());
        prop_assert!(FrameData::decode(&bytes[..cut]).is_err());
    }
}
