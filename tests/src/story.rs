//! Golden runs show what their scenarios tell, apart from named exceptions.

use staya_sim::engine::Outcome;
use staya_sim::scenario::Scenario;
use std::fmt::Write as _;

/// Golden file, gap and reason.
const EXCEPTIONS: &[(&str, &str, &str)] = &[
    ("boids", "not all robots arrive", "boids have no goals"),
    (
        "crossing-intruder",
        "seed 26101: robots overlap",
        "the intruder is as fast as the robots and drives into one that gives way to others",
    ),
    (
        "experiment-flock",
        "fragments: more than one component",
        "without a reference a flock breaks up, as in the paper",
    ),
    ("flock-squeeze", "not all robots arrive", "an alpha flock follows a reference"),
    ("scale", "not all robots arrive", "the first three ticks of a long run"),
    ("two-flocks", "not all robots arrive", "an alpha flock follows a reference"),
];

/// Parts of its scenario's story that a run lacks: each event lies before the last tick, all robots
/// arrive, and none collide.
#[must_use]
pub fn gaps(scenario: &Scenario, outcome: &Outcome) -> Vec<String> {
    let late = events(scenario).into_iter().filter(|(_, tick)| tick + 1 >= outcome.ticks);
    let mut gaps: Vec<String> = late.map(|(event, tick)| format!("{event} in tick {tick} comes too late")).collect();
    let touched = outcome.clearance.map_or(0, |clearance| clearance.intruder_overlaps);
    for (is_lacking, gap) in [
        (outcome.arrived < scenario.robots.len(), "not all robots arrive"),
        (outcome.collisions > 0, "robots collide"),
        (touched > 0, "robots touch an intruder"),
    ] {
        gaps.extend(is_lacking.then(|| gap.to_owned()));
    }
    gaps
}

/// Each event with the tick in which it ends, or begins if it lasts until the end of the run.
fn events(scenario: &Scenario) -> Vec<(&'static str, u32)> {
    let ends = |from: u32, to: u32| if to >= scenario.ticks { from } else { to };
    let tick = |at_s: f64| (at_s / scenario.tick_s()) as u32;
    let orders = scenario.plane().into_iter().flat_map(|plane| &plane.orders);
    let rolls = scenario.key_rotation().into_iter().flat_map(|keeping| &keeping.rolls);
    let blackouts = scenario.radio.blackout_s.iter().map(|&[from_s, to_s]| ends(tick(from_s), tick(to_s)));
    let radio_faults = scenario.radio.fault.iter().map(|fault| {
        let to = fault.for_s.map_or(scenario.ticks, |for_s| tick(fault.at_s + for_s));
        ends(tick(fault.at_s), to)
    });
    let mut events: Vec<_> = orders.map(|order| ("an order", order.tick)).collect();
    events.extend(rolls.map(|roll| ("a key change", roll.tick)));
    events.extend(blackouts.map(|tick| ("a blackout", tick)));
    events.extend(radio_faults.map(|tick| ("a fault of a radio", tick)));
    events.extend(scenario.events.interventions.iter().map(|(tick, _)| ("an intervention", *tick)));
    events.extend(scenario.land.changes.iter().map(|change| ("a change of the land", change.first)));
    events.extend(scenario.events.faults.iter().map(|fault| ("a fault", ends(fault.from_tick, fault.to_tick))));
    events.extend(scenario.events.attacks.iter().map(|attack| ("an attack", ends(attack.from_tick, attack.to_tick))));
    events
}

/// The lines of a golden file that name its gaps.
pub(crate) fn exceptions(name: &str, gaps: &[String]) -> String {
    let mut known: Vec<_> = EXCEPTIONS.iter().filter(|(file, ..)| *file == name).collect();
    let mut text = String::new();
    for gap in gaps {
        let at = known.iter().position(|(_, wanted, _)| wanted == gap);
        let at = at.unwrap_or_else(|| panic!("{name}: {gap}; fix the run, or name the reason in tests/src/story.rs"));
        let (_, gap, reason) = known.swap_remove(at);
        writeln!(text, "exception  {gap}: {reason}").expect("memory");
    }
    assert!(known.is_empty(), "{name}: exceptions that do not occur: {known:?}; remove them in tests/src/story.rs");
    text
}
