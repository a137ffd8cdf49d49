//! The shipped scenarios, with links that fade for two seconds or five ticks.

use staya_sim::scenario::{Overrides, Scenario, Setting, text_with};
use staya_tests::{root, run};

/// Larger swarms take long. A crowd of a thousand has robots with more neighbours than places in
/// their tables, and some touch (docs/limits.md).
const MOST: usize = 200;

/// The paper's law moves robots into each other without fades, too. A flock of the other scenario
/// uses push-out, which knows only what it hears. Sensors of the third one show wrong places, and
/// two robots touch by 1 mm (docs/limits.md).
const TOUCH: [&str; 3] = ["figure-6-paper.toml", "two-formations.toml", "sensing-swap.toml"];

#[test]
fn robots_of_the_shipped_scenarios_do_not_touch_while_links_fade() {
    let (mut count, mut failed) = (0, Vec::new());
    for entry in std::fs::read_dir(root().join("scenarios")).expect("scenarios") {
        let path = entry.expect("a file").path();
        if path.extension().is_none_or(|extension| extension != "toml") || TOUCH.iter().any(|name| path.ends_with(name))
        {
            continue;
        }
        let read = |settings: &[Setting]| {
            let text = text_with(&path, settings).expect("a scenario");
            Scenario::parse(&text, &path, &Overrides::default()).unwrap_or_else(|error| panic!("{error}"))
        };
        let calm = read(&[]);
        if calm.robots.len() > MOST {
            continue;
        }
        // Robots in cells have longer ticks; with this share a fade lasts for five at least.
        let mean_ms = (5000.0 * calm.tick_s()).max(2000.0);
        let fades = format!("radio.burst={{ share = 0.2, mean_ms = {mean_ms} }}");
        let (outcome, _) = run(&read(&[fades.parse().expect("a setting")]));
        count += 1;
        failed.extend((outcome.collisions > 0).then_some((path, outcome.collisions)));
    }
    assert!(failed.is_empty(), "{failed:#?}");
    assert!(count > 30, "{count} scenarios");
}
