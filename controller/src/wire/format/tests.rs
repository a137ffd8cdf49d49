use super::super::arbitrary;
use super::*;
use crate::digest::digest;
use proptest::collection::vec;
use proptest::prelude::*;

#[test]
fn a_format_without_state_adds_nothing_to_a_digest() {
    assert_eq!(size_of::<Postcard>(), 0);
    assert_eq!(digest(&(1_u8, Postcard)), digest(&1_u8));
}

fn stream() -> impl Strategy<Value = std::vec::Vec<u8>> {
    vec(prop_oneof![Just(0), 0..4_u8], 0..40)
}

proptest! {
    #[test]
    fn postcard_splits_a_stream_like_frames(bytes in stream()) {
        let mut rest = bytes.as_slice();
        let mut split = std::vec::Vec::new();
        while let Some(frame) = Postcard.next_frame(&mut rest) {
            split.push(frame);
        }
        let pieces = bytes.split(|byte| *byte == 0).filter(|piece| !piece.is_empty());
        prop_assert_eq!(&split, &pieces.collect::<std::vec::Vec<_>>());
        prop_assert_eq!(split, crate::wire::frames(&bytes).collect::<std::vec::Vec<_>>());
        prop_assert!(rest.is_empty());
    }

    #[test]
    fn postcard_decodes_its_own_frames(
        said in vec((arbitrary::header(), arbitrary::message()), 1..4)
    ) {
        let mut bytes = Vec::<u8, 256>::new();
        for (header, message) in &said {
            let before = bytes.len();
            let len = Postcard.encode(*header, message, &mut bytes).unwrap();
            prop_assert_eq!(bytes.len(), before + len);
        }
        let mut rest = bytes.as_slice();
        for (header, message) in said {
            let frame = Postcard.next_frame(&mut rest).unwrap();
            let tag = None;
            prop_assert_eq!(Postcard.decode(frame), Ok(Frame { header, message, tag }));
        }
        prop_assert_eq!(Postcard.next_frame(&mut rest), None);
    }
}
