//! Invariants that must hold for arbitrary bytes.
//!
//! Each function interprets its bytes as data or actions and panics if an invariant is violated. A
//! fuzzer searches for such bytes (`cargo xtask fuzz`); the tests here try random ones and earlier
//! findings.

mod keys;
mod mavlink;
mod messages;
mod scenario;
mod sealed;
mod templates;
mod wire;

pub use keys::keys;
pub use mavlink::mavlink_decode;
pub use messages::messages_model;
pub use scenario::scenario;
pub use sealed::sealed;
pub use templates::templates;
pub use wire::wire_decode;

#[cfg(test)]
mod tests {
    use super::*;
    use staya_controller::rand::Rng;

    fn on_random_bytes(model: fn(&[u8]), rounds: u32, longest: u32) {
        for round in 0..rounds {
            let mut rng = Rng::keyed(0, u32::from_be_bytes(*b"fuzz"), round, 0);
            let len = rng.below(longest + 1);
            let limit = if round % 2 == 0 { 256 } else { 8 };
            let bytes: Vec<u8> = (0..len).map(|_| rng.below(limit) as u8).collect();
            model(&bytes);
        }
    }

    #[test]
    fn wire_decode_invariants_hold_for_random_bytes() {
        on_random_bytes(wire_decode, 20_000, 120);
    }

    #[test]
    fn mavlink_decode_invariants_hold_for_random_bytes() {
        on_random_bytes(mavlink_decode, 20_000, 300);
    }

    #[test]
    fn keys_invariants_hold_for_random_bytes() {
        on_random_bytes(keys, 1_000, 400);
    }

    #[test]
    fn sealed_invariants_hold_for_random_bytes() {
        on_random_bytes(sealed, 5_000, 120);
    }

    #[test]
    fn messages_model_invariants_hold_for_random_bytes() {
        on_random_bytes(messages_model, 300, 1_000);
    }

    #[test]
    fn templates_invariants_hold_for_random_bytes() {
        on_random_bytes(templates, 2_000, 1_000);
    }

    #[test]
    fn scenario_invariants_hold_for_random_bytes() {
        on_random_bytes(scenario, 3_000, 100);
    }
}
