use super::super::Source;
use super::*;
use std::path::Path;

const SCENARIO: &str = "ticks = 5\n[plane]\nradius_m = 1\n[[plane.group]]\nfrom_m = [1, 2]\n[[plane.group]]\n";

fn set(name: &str) -> Result<(), String> {
    let mut source = Source::new(Path::new("t.toml"), SCENARIO).expect("TOML");
    source.set(&Field::read(name).expect("a name"), "7")?;
    let number = source.get(name).and_then(|node| node.get_ref().as_integer());
    assert_eq!(number.expect("it is set").as_str(), "7");
    Ok(())
}

#[test]
fn a_field_is_set_and_made() {
    for name in ["ticks", "plane.radius_m", "plane.group[1].count", "radio.burst.share", "plane.group[0].from_m[1]"] {
        set(name).unwrap_or_else(|what| panic!("{name}: {what}"));
    }
    let source = Source::new(Path::new("t.toml"), SCENARIO).expect("TOML");
    assert!(source.get("plane.group[2].count").is_none());
}

#[test]
fn an_obstruction_on_the_path_is_named() {
    for (name, what) in [
        ("plane.group[2].count", "group has 2 elements, counted from 0"),
        ("plane.radius_m.x", "radius_m is not a table in the scenario"),
        ("ticks[0]", "ticks is not a list in the scenario"),
        ("plane.order[0]", "order is not a list in the scenario"),
        ("order[0].at_s", "order is not a list in the scenario"),
    ] {
        assert_eq!(set(name).expect_err(name), what);
    }
}

#[test]
fn malformed_paths_are_refused() {
    for bad in ["", ".", "a.", "a[", "a[]", "a[-1]", "a[+1]", "a[01]", "a]0[", "a b", "[0]", "a[0]b", "a..b"] {
        assert_eq!(Field::read(bad), None, "{bad:?}");
    }
}
