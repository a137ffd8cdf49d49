use super::*;
use proptest::collection::vec;
use proptest::prelude::*;
use std::collections::HashSet;
use std::format;
use std::string::String;
use std::vec::Vec;

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn sha256(message: &[u8]) -> String {
    let mut hash = Sha256::new();
    hash.update(message);
    hex(&hash.finish())
}

/// FIPS 180-4's examples, and the lengths at which the padding takes another block (`hashlib`).
#[test]
fn hashes_match_the_standard() {
    assert_eq!(sha256(b""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    assert_eq!(sha256(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    assert_eq!(
        sha256(b"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
        "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"
    );
    for (len, want) in [
        (55, "9f4390f8d30c2dd92ec9f095b65e2b9ae9b0a925a5258e241c9f1e910f734318"),
        (56, "b35439a4ac6f0948b6d6f9e3c6af0f5f590ce20f1bde7090ef7970686ec6738a"),
        (63, "7d3e74a05d7db15bce4ad9ec0658ea98e3f06eeecf16b4c6fff2da457ddc2f34"),
        (64, "ffe054fe7ae0cb6dc65c3af9b61d5209f439851db43d0ba5997337df154668eb"),
        (65, "635361c48bb9eab14198e76ea8ab7f1a41685d6ad62aa9146d301d4f17eb0ae0"),
    ] {
        assert_eq!(sha256(&[b'a'; 65][..len]), want, "{len}");
    }
}

/// RFC 4231, section 4, for keys of at most 32 bytes.
#[test]
fn codes_match_the_rfc() {
    let key = |bytes: &[u8]| {
        let mut key = [0; KEY_LEN];
        key[..bytes.len()].copy_from_slice(bytes);
        Mac::new(&Key::new(key))
    };
    let counting: Vec<u8> = (1..=25).collect();
    for (mac, message, want) in [
        (key(&[0x0B; 20]), &b"Hi There"[..], "b0344c61d8db38535ca8afceaf0bf12b881dc200c9833da726e9376c2e32cff7"),
        (
            key(b"Jefe"),
            b"what do ya want for nothing?",
            "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843",
        ),
        (key(&[0xAA; 20]), &[0xDD; 50], "773ea91e36800e46854db8ebd09181a72959098b3ef8c122d9635514ced565fe"),
        (key(&counting), &[0xCD; 50], "82558a389a443c0ea4cc819899f2083a85f0faa3e578f8077a2e3ff46729665b"),
    ] {
        assert_eq!(hex(&mac.of(&[message])), want);
        let (front, back) = message.split_at(7);
        assert_eq!(hex(&mac.of(&[front, &[], back])), want);
    }
}

#[test]
fn a_key_is_not_printed() {
    let key = Key::of_passphrase(b"abc");
    assert_eq!(hex(key.as_bytes()), sha256(b"abc"));
    assert_eq!(format!("{key:?} {:?}", Mac::new(&key)), "Key(secret) Mac(secret)");
}

#[test]
fn codes_are_compared_in_every_byte() {
    let code = [7_u8; 6];
    assert!(is_same(&code, &code));
    for at in 0..6 {
        let mut other = code;
        other[at] ^= 0x80;
        assert!(!is_same(&code, &other), "{at}");
    }
}

#[test]
fn late_frames_are_fresh_once_and_within_the_window() {
    let mut guard = ReplayGuard::<2>::new();
    assert_eq!(guard.admit(1, 100), Freshness::New);
    assert_eq!(guard.admit(1, 100), Freshness::Replayed);
    assert_eq!(guard.admit(1, 131), Freshness::New);
    assert_eq!(guard.admit(1, 100), Freshness::Replayed);
    assert_eq!(guard.admit(1, 99), Freshness::Replayed);
    assert_eq!(guard.admit(1, 101), Freshness::Late);
    assert_eq!(guard.admit(1, 101), Freshness::Replayed);
    assert_eq!(guard.admit(1, u64::MAX), Freshness::New);
    assert_eq!(guard.admit(1, 132), Freshness::Replayed);
    assert_eq!(guard.admit(1, 0), Freshness::Replayed);
}

#[test]
fn a_full_guard_refuses_new_senders_and_keeps_the_known_ones() {
    let mut guard = ReplayGuard::<3>::new();
    for sender in [9, 2, 5] {
        assert_eq!(guard.admit(sender, 10), Freshness::New);
    }
    assert_eq!(guard.admit(7, 1000), Freshness::NoRoom);
    assert!(!guard.knows(7) && guard.knows(5));
    for sender in [9, 2, 5] {
        assert_eq!(guard.admit(sender, 10), Freshness::Replayed);
        assert_eq!(guard.admit(sender, 11), Freshness::New);
    }
    assert!(!guard.import(7, 1));
}

#[test]
fn exported_counters_are_not_fresh_after_import() {
    let mut before = ReplayGuard::<3>::new();
    for (sender, counter) in [(4, 7), (1, 1 << 40), (4, 5)] {
        assert!(before.admit(sender, counter).is_fresh());
    }
    let mut after = ReplayGuard::<3>::new();
    for (sender, counter) in before.export() {
        assert!(after.import(sender, counter));
    }
    assert_eq!(after.admit(4, 6), Freshness::Replayed, "not told apart");
    assert_eq!(after.admit(4, 7), Freshness::Replayed);
    assert_eq!(after.admit(4, 8), Freshness::New);
    assert_eq!(after.admit(1, 1 << 40), Freshness::Replayed);
    assert!(after.import(4, 2));
    assert_eq!(after.admit(4, 8), Freshness::Replayed);
}

#[test]
fn an_import_of_the_newest_counter_ends_the_window() {
    for (imported, is_late) in [(7, true), (8, false), (9, false)] {
        let mut guard = ReplayGuard::<3>::new();
        assert_eq!(guard.admit(4, 8), Freshness::New);
        assert!(guard.import(4, imported));
        assert_eq!(guard.admit(4, 6), if is_late { Freshness::Late } else { Freshness::Replayed }, "{imported}");
        assert_eq!(guard.newest(4), Some(imported.max(8)));
    }
}

#[test]
fn counters_of_unknown_senders_start_at_the_floor() {
    let mut guard = ReplayGuard::<3>::new();
    guard.set_floor(50);
    assert_eq!(guard.admit(1, 49), Freshness::Replayed);
    assert_eq!(guard.admit(1, 50), Freshness::New);
    assert!(guard.import(2, 7));
    assert_eq!(guard.admit(2, 8), Freshness::New, "a known sender stays known");
}

proptest! {
    #[test]
    fn no_frame_is_fresh_twice(frames in vec((0_u32..6, 0_u64..80), 0..300)) {
        let mut guard = ReplayGuard::<4>::new();
        let mut seen = HashSet::new();
        let mut newest = std::collections::HashMap::<u32, u64>::new();
        for (sender, counter) in frames {
            let is_known = newest.contains_key(&sender);
            let fresh = guard.admit(sender, counter).is_fresh();
            if !is_known && newest.len() == 4 {
                prop_assert!(!fresh);
                continue;
            }
            let top = newest.entry(sender).or_insert(counter);
            *top = counter.max(*top);
            let is_in_window = counter + 32 > *top;
            prop_assert_eq!(fresh, is_in_window && seen.insert((sender, counter)));
        }
    }
}
