//! Attackers without the key change nothing, in either wire format; without authentication they take the swarm away.

use crate::engine::{Outcome, simulate};
use crate::scenario::{Overrides, Scenario};
use std::ops::ControlFlow;
use std::path::Path;

const HIJACK: &str = include_str!("../../../../../scenarios/hijack.toml");

fn run(text: &str) -> Outcome {
    let path = Path::new("hijack.toml");
    let scenario = Scenario::parse(text, path, &Overrides::default());
    let scenario = scenario.unwrap_or_else(|error| panic!("{error}"));
    simulate(&scenario, |_, _| ControlFlow::Continue(())).expect("free places")
}

/// Without the tables that begin with `[name]`.
fn without(text: &str, name: &str) -> String {
    let mut is_kept = true;
    let kept = text.lines().filter(|line| {
        if line.starts_with('[') {
            is_kept = line.trim_matches(['[', ']']) != name;
        }
        is_kept
    });
    kept.map(|line| format!("{line}\n")).collect()
}

#[test]
fn a_swarm_with_a_key_goes_as_if_nobody_attacked_it_and_counts_what_it_refused() {
    let mut hashes = Vec::new();
    for format in ["postcard", "mavlink"] {
        let text = HIJACK.replace("\"postcard\"", &format!("\"{format}\""));
        let alone = run(&without(&text, "attack"));
        let packets = alone.packets;
        assert_eq!(alone.arrived, 6, "{format}");
        assert_eq!((packets.unsigned, packets.forged, packets.replayed), (0, 0, 0));

        let attacked = run(&text);
        let packets = attacked.packets;
        assert_eq!(attacked.trace_hash, alone.trace_hash, "{format}");
        assert_eq!(attacked.ticks, alone.ticks);
        // Each of the three attackers is refused by six robots again and again.
        let ticks = u64::from(attacked.ticks);
        assert!(packets.unsigned > 3 * ticks, "{packets:?}");
        assert!(packets.forged > 3 * ticks, "{packets:?}");
        assert!(packets.replayed > 3 * ticks, "{packets:?}");

        let open = run(&without(&text, "authentication"));
        assert_ne!(open.trace_hash, alone.trace_hash, "{format}");
        assert!(open.arrived < 6, "{format}: {} arrived", open.arrived);
        hashes.push(alone.trace_hash);
    }
    assert_eq!(hashes[0], hashes[1], "tags and signatures are not news");
}

/// Each kind alone, without a key: orders are followed, and repeated packets are known for what they are by their numbers.
#[test]
fn without_a_key_orders_of_strangers_are_followed() {
    let open = without(HIJACK, "authentication");
    let alone = run(&without(&open, "attack"));
    for (kind, is_followed) in [("unsigned", true), ("forge", true), ("replay", false)] {
        let is_wanted = |table: &&str| table.contains(&format!("kind = \"{kind}\""));
        let wanted = open.split("[[attack]]").find(is_wanted);
        let wanted = wanted.and_then(|table| table.split("[[fault]]").next());
        let wanted = wanted.expect("one of each kind");
        let text = format!("{}[[attack]]{wanted}", without(&open, "attack"));
        let outcome = run(&text);
        assert_eq!(outcome.arrived < 6, is_followed, "{kind}");
        assert_eq!(outcome.trace_hash != alone.trace_hash, is_followed, "{kind}");
    }
}
