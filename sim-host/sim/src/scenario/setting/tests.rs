use super::*;

const SCENARIO: &str = "name = 't'\nticks = 5\n\n[terrain]\nuniform = { width = 9, height = 9, classes = 1 }\n\n[radio]\nloss = 0.1\n\n\
    [[robots.list]]\nid = 1\nstart = [0, 0]\ngoal = [5, 5]\n";

fn load(settings: &[&str]) -> Result<Scenario, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("t.toml");
    std::fs::write(&path, SCENARIO).expect("written");
    let settings: Vec<Setting> = settings.iter().map(|text| text.parse().expect("a setting")).collect();
    Scenario::load_with(&path, &Overrides::default(), &settings)
        .map_err(|error| error.to_string().replace(&format!("{}", path.display()), "t.toml"))
}

#[test]
fn a_field_is_set_once() {
    assert_eq!(load(&[]).expect("sound").ticks, 5);
    let set = load(&["ticks=7", "radio.range_m = 3.5", "name=other", "robots.list[0].goal=[6, 5]"]);
    let set = set.expect("sound");
    assert_eq!((set.ticks, set.radio.range_m, &*set.name), (7, 3.5, "other"));
    assert_eq!((set.robots[0].goal.x, set.radio.loss), (6, 0.1));
    let part = load(&["radio={ loss = 0.3 }", "radio.range_m=2"]).expect("a table, then a field of it");
    assert_eq!((part.radio.loss, part.radio.range_m), (0.3, 2.0));
    for settings in [["radio.loss=0.2", " radio.loss = 0.2"], ["radio.loss=0.2", "radio={ loss = 0.3 }"]] {
        let error = load(&settings).expect_err("twice");
        assert_eq!(error, "t.toml:8:8: radio.loss: it is set twice (by --set); give one --set of this field");
    }
}

#[test]
fn errors_name_the_line_and_the_setting() {
    let error = |settings: &[&str]| load(settings).expect_err("wrong");
    let loss = error(&["radio.loss=1.5"]);
    assert!(loss.starts_with("t.toml:8:8: radio.loss: ") && loss.contains("(by --set)"), "{loss}");
    let unknown = error(&["radio.lost=1"]);
    assert!(unknown.contains("lost") && unknown.contains("scenarios/README.md"), "{unknown}");
    let none = error(&["robots.list[1].goal=[1, 1]"]);
    assert!(none.contains("list has 1 elements, counted from 0 (by --set)"), "{none}");
    let word = error(&["ticks=many"]);
    assert!(word.contains("ticks") && word.contains("is not a whole number"), "{word}");
    // Errors in the file itself are not attributed to the command line.
    let other = error(&["radio.range_m=5", "robots.list[0].start=[99, 0]"]);
    assert!(other.contains("robots.list[0].start"), "{other}");
}

#[test]
fn text_with_settings_parses_to_the_same_scenario() {
    let settings = ["ticks=7", "radio.loss=0.25"].map(|text| text.parse().expect("a setting"));
    let (path, none) = (Path::new("t.toml"), Overrides::default());
    let set = Scenario::parse_with(SCENARIO, path, &none, &settings).expect("sound");
    assert_eq!((set.ticks, set.radio.loss), (7, 0.25));
    let text = with_settings(SCENARIO, path, &settings).expect("a scenario");
    let read = Scenario::parse(&text, path, &none).expect("sound");
    assert_eq!((read.ticks, read.radio.loss), (7, 0.25));
    let wrong = ["radio.loss=2".parse().expect("a setting")];
    let error = Scenario::parse_with(SCENARIO, path, &none, &wrong).expect_err("wrong").to_string();
    assert!(error.starts_with("t.toml:8:8: radio.loss: ") && error.contains("(by --set)"), "{error}");
}

#[test]
fn settings_are_parsed_as_toml_or_as_strings() {
    let value = |text: &str| {
        let setting: Setting = text.parse().expect("a setting");
        let mut source = Source::new(Path::new("t.toml"), "").expect("TOML");
        source.set(&setting.field, &setting.value).expect("no obstruction");
        super::super::inline(source.get(setting.field.name()).expect("it is set").get_ref())
    };
    for (text, expected) in [
        ("a.b=3", "3"),
        ("a = 0.5", "0.5"),
        ("a=true", "true"),
        ("a='3'", "\"3\""),
        ("a=x = 3", "\"x = 3\""),
        ("a=1\nb=2", "\"1\\nb=2\""),
        ("a=1 2", "\"1 2\""),
        ("a=[1, 'b']", "[1, \"b\"]"),
        ("a=", "\"\""),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
    let error = |text: &str| text.parse::<Setting>().expect_err("wrong");
    assert!(error("a").contains("FIELD=VALUE"));
    assert!(error("a..b=1").contains("names no field"));
}

const PLANE: &str = "name = 't'\nticks = 5\ntick_s = 0.1\n[plane]\nradius_m = 0.1\nmax_speed_mps = 1\n\
    robots = { list = [{ start_m = [0, 0] }] }\n";

/// The error of a law and a layer by name with these values, or none.
fn by_name(text: &str, law: Option<&str>, layer: Option<&str>, settings: &[&str]) -> Result<Scenario, String> {
    let settings = settings.iter().map(|text| text.parse().expect("a setting")).collect();
    let (path, none) = (Path::new("t.toml"), Overrides::default());
    let scenario = named(text, path, law, layer, settings);
    scenario.and_then(|all| Scenario::parse_with(text, path, &none, &all)).map_err(|error| error.without_place())
}

#[test]
fn values_alone_are_those_of_the_named_law_or_layer() {
    let by = |law, layer, settings: &[&str]| by_name(PLANE, law, layer, settings);
    let flock = by(Some("goal_flock"), Some("orca"), &["k1=2", "min_distance_m=0.5", "horizon_s=3", "seed=4"]);
    let text = format!(
        "{PLANE}law = 'goal_flock'\ngoal_flock = {{ k1 = 2, min_distance_m = 0.5 }}\norca = {{ horizon_s = 3 }}\n"
    );
    let wanted = Scenario::parse_with(&text, Path::new("t.toml"), &Overrides { seed: Some(4), ticks: None }, &[]);
    let group = |scenario: Scenario| scenario.plane().map(|plane| plane.group(0).clone()).expect("a group");
    let (flock, wanted) = (flock.expect("sound"), wanted.expect("sound"));
    assert_eq!((flock.seed, group(flock)), (wanted.seed, group(wanted)));
    let both = by(Some("goal_flock"), Some("push_out"), &["min_distance_m=1"]).expect_err("two tables");
    assert_eq!(
        both,
        "min_distance_m: the law and the safety layer have such a value (by --set); \
            give plane.goal_flock.min_distance_m and plane.push_out.min_distance_m"
    );
    let paths = ["plane.goal_flock.min_distance_m=1", "plane.push_out.min_distance_m=1"];
    by(Some("goal_flock"), Some("push_out"), &paths).expect("by their paths");
}

#[test]
fn wrong_names_are_refused_by_the_reader_of_files() {
    let error = |text, law, layer, settings: &[&str]| by_name(text, law, layer, settings).expect_err("wrong");
    for (law, layer, setting, wanted) in [
        (Some("goal_flok"), None, "k1=1", "plane.law: this program has no law \"goal_flok\""),
        (None, Some("orka"), "share=1", "plane.safety: unknown value `orka`"),
        (Some("lattice"), Some("none"), "spacing=1", "plane.lattice.spacing: unknown field `spacing`"),
        (None, Some("none"), "share=1", "share: unknown field `share`"),
        (None, Some("fly"), "shares=1", "plane.orca.shares: unknown field `shares`"),
        (Some("waypoint"), None, "k1=1", "plane.waypoint.k1: unknown field `k1`"),
    ] {
        let text = error(PLANE, law, layer, &[setting]);
        assert!(text.starts_with(wanted), "{text}");
    }
    let cells = error(SCENARIO, None, Some("orca"), &[]);
    assert!(cells.starts_with("safety: robots that move from cell to cell have no safety layer"), "{cells}");
    by_name(SCENARIO, Some("route"), None, &["a1=5"]).expect("on the grid");
}
