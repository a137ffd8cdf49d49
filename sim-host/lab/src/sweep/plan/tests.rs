use super::*;
use proptest::prelude::*;
use staya_sim::scenario::Line;
use staya_sim::scenario::Read as _;
use std::fs;
use tempfile::TempDir;

const SCENARIO: &str = "name = 'duel'\nseed = 9\nticks = 20\ntick_s = 0.1\n\n[radio]\nrange_m = 5\n\n[plane]\nradius_m = 0.2\n\
    max_speed_mps = 1\n\n[plane.robots.circle]\ncount = 4\nradius_m = 3\n";

fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("duel.toml"), SCENARIO).expect("room");
    folder
}

fn parse(folder: &TempDir, text: &str) -> Result<Plan, String> {
    let text = format!("name = 'p'\nscenario = 'duel.toml'\n{text}");
    let path = folder.path().join("plan.toml");
    Plan::parse(&text, &path, &Changes::default()).map_err(|error| {
        let said = error.to_string();
        said.strip_prefix(&folder.path().display().to_string())
            .map_or_else(|| said.clone(), |rest| rest[1..].to_owned())
    })
}

fn plan(text: &str) -> Plan {
    parse(&folder(), text).unwrap_or_else(|what| panic!("{what}"))
}

fn error(text: &str) -> String {
    parse(&folder(), text).expect_err("something is wrong")
}

fn values(plan: &Plan, axis: &str) -> Vec<String> {
    plan.values(axis).expect("an axis").iter().map(ToString::to_string).collect()
}

#[test]
fn axes_are_crossed_in_the_order_of_the_file_and_seeds_change_first() {
    let plan = plan("seeds = [7, 5]\n[axes]\nradio.loss = [0.5, 0]\nradio.delay_ms = [1, 2, 3]\n");
    assert_eq!(plan.axes().collect::<Vec<_>>(), ["radio.loss", "radio.delay_ms"]);
    assert_eq!((plan.runs(), plan.seeds()), (12, 2));
    let run = |number| {
        let run = plan.run(number);
        (run.point, run.values.iter().map(|value| value.to_string()).collect::<Vec<_>>().join(" "), run.seed)
    };
    assert_eq!(run(0), (0, "0.5 1".into(), 7));
    assert_eq!(run(1), (0, "0.5 1".into(), 5));
    assert_eq!(run(2), (1, "0.5 2".into(), 7));
    assert_eq!(run(6), (3, "0 1".into(), 7));
    assert_eq!(run(11), (5, "0 3".into(), 5));
}

#[test]
fn axes_of_the_command_line_are_plotted_too() {
    let folder = folder();
    let text = "name = 'p'\nscenario = 'duel.toml'\n[axes]\nradio.loss = [0, 1]\n\
        [[plot]]\nfigure = 'arrived'\nover = 'radio.loss'\n";
    let fields = ["radio.delay_ms=1,2", "radio.loss=0,0.5", "ticks=5"].map(|change| change.parse().unwrap()).to_vec();
    let changes = Changes { fields, ..Changes::default() };
    let plan = Plan::parse(text, &folder.path().join("plan.toml"), &changes).unwrap();
    let plots = crate::sweep::pictures::plots(&plan);
    let axes: Vec<_> = plots.iter().map(|plot| (&*plot.over, plot.and.as_deref())).collect();
    assert_eq!(axes, [("radio.loss", None), ("radio.delay_ms", Some("radio.loss"))]);
}

#[test]
fn run_is_the_scenario_with_the_values_of_its_point() {
    let plan =
        plan("seeds = { from = 40, count = 2 }\n[set]\nticks = 33\n[axes]\nplane.robots.circle.count = [2, 6]\n");
    let scenario = plan.given(&plan.run(3)).unwrap().scenario().expect("a scenario");
    assert_eq!((scenario.robots.len(), scenario.seed, scenario.ticks), (6, 41, 33));
    let folder = folder();
    let plan = parse(&folder, "[axes]\nradio.loss = [0, 1]\n").expect("a plan");
    assert_eq!((plan.runs(), plan.run(1).seed), (2, 9));
}

#[test]
fn ranges_include_their_ends_and_have_short_decimals() {
    for (range, expected) in [
        ("{ from = 0, to = 0.3, count = 4 }", "0 0.1 0.2 0.3"),
        ("{ from = 0.1, to = 0.7, step = 0.2 }", "0.1 0.3 0.5 0.7"),
        ("{ from = 0, to = 0.55, step = 0.2 }", "0 0.2 0.4"),
        ("{ from = 0.9, to = 0.5, step = -0.2 }", "0.9 0.7 0.5"),
        ("{ from = 0.001, to = 1, count = 4, log = true }", "0.001 0.01 0.1 1"),
        ("{ from = 1, to = 0.25, count = 3, log = true }", "1 0.5 0.25"),
        ("{ from = 0, to = 1, count = 5, whole = true }", "0 1"),
    ] {
        let plan = plan(&format!("[axes]\nradio.loss = {range}\n"));
        assert_eq!(values(&plan, "radio.loss").join(" "), expected, "{range}");
    }
}

#[test]
fn zipped_fields_advance_together() {
    let plan = plan("[[zip]]\nradio.loss = [0, 0.5]\nradio.delay_ms = [9, 8]\n[[zip]]\nradio.range_m = [1, 2, 3]\n");
    assert_eq!(plan.runs(), 6);
    let at = |number| plan.run(number).values.iter().map(|value| value.to_string()).collect::<Vec<_>>().join(" ");
    assert_eq!((at(0), at(2), at(3)), ("0 9 1".into(), "0 9 3".into(), "0.5 8 1".into()));
}

#[test]
fn samples_depend_only_on_their_seed() {
    let text = |seed: u32, kind: &str| {
        format!(
            "[[sample]]\nkind = '{kind}'\ncount = 20\nseed = {seed}\n[sample.axes]\n\
             radio.loss = {{ from = 0.2, to = 0.4 }}\nradio.delay_ms = {{ from = 1, to = 1000, log = true }}\n\
             plane.robots.circle.count = {{ from = 2, to = 6, whole = true }}\nradio.range_m = [3, 8]\n"
        )
    };
    for kind in ["random", "latin_hypercube"] {
        let [a, b, c] = [1, 1, 2].map(|seed| plan(&text(seed, kind)));
        assert_eq!(a.runs(), 20);
        assert_eq!(values(&a, "radio.loss"), values(&b, "radio.loss"));
        assert_ne!(values(&a, "radio.loss"), values(&c, "radio.loss"));
        let within = |axis: &str, low: f64, high: f64| {
            a.values(axis).expect("an axis").iter().filter_map(Value::number).all(|value| (low..=high).contains(&value))
        };
        assert!(within("radio.loss", 0.2, 0.4) && within("radio.delay_ms", 1.0, 1000.0));
        assert!(within("plane.robots.circle.count", 2.0, 6.0));
        let ranges = values(&a, "radio.range_m");
        assert!(ranges.iter().any(|value| value == "3") && ranges.iter().any(|value| value == "8"));
    }
    let even = plan(&text(3, "latin_hypercube"));
    let delays = even.values("radio.delay_ms").expect("an axis").iter().filter_map(Value::number);
    assert_eq!(delays.filter(|&delay| delay < 31.62).count(), 10);
}

#[test]
fn errors_name_the_plan_the_line_and_the_field() {
    let axes = |text: &str| error(&format!("[axes]\n{text}\n"));
    for (said, expected) in [
        (axes("radio.los = [1]"), "plan.toml:4:7: radio.los: unknown field `los`"),
        (axes("radoi.loss = [1]"), "plan.toml:4:7: radoi.loss: unknown field `radoi`"),
        (
            axes("radio.delay_ms = [1]\nradio.loss = [0.1, 1.5]"),
            "plan.toml:5:7: radio.loss: 1.5 is not a probability; give a",
        ),
        (axes("name = ['a', 'b']"), "plan.toml:4:1: name: it is a text, and no run depends on it; leave it out"),
        (
            axes("radio.format = { from = 1, to = 2, count = 2 }"),
            "plan.toml:4:7: radio.format: it is a text, which has no range",
        ),
        (axes("radio.loss = ['a']"), "plan.toml:4:7: radio.loss: \"a\" is not a number"),
        (axes("radio.loss = [[1]]"), "plan.toml:4:7: radio.loss: [1] is neither a number nor a word"),
        (axes("radio = [1]"), "plan.toml:4:1: radio: it is a list or a table; name a field in it"),
        (axes("seed = [1, 2]"), "plan.toml:4:1: seed: seeds are not an axis; give `seeds`"),
        (axes("radio.loss = 0.5"), "plan.toml:4:7: radio.loss: one value is not an axis"),
        (axes("radio.loss = []"), "plan.toml:4:7: radio.loss: there are no values"),
        (axes("radio.loss = [0.1, 0.10]"), "plan.toml:4:7: radio.loss: 0.1 is listed twice"),
        (axes("radio.loss = { from = 0, to = 1 }"), "plan.toml:4:7: radio.loss: it is not clear how many"),
        (axes("radio.loss = { from = 0, to = 1, count = 1 }"), "plan.toml:4:7: radio.loss: 1 values are not a range"),
        (axes("radio.loss = { from = 0, to = 1, step = -1 }"), "plan.toml:4:7: radio.loss: steps of -1 do not lead"),
        (axes("radio.loss = { from = 0, to = 1, step = 0 }"), "plan.toml:4:7: radio.loss: steps of 0 do not lead"),
        (axes("radio.loss = { from = 0, to = nan, count = 2 }"), "plan.toml:4:7: radio.loss: 0 to NaN is not a range"),
        (
            axes("radio.loss = { from = 0, to = 1, count = 2, log = true }"),
            "plan.toml:4:7: radio.loss: 0 to 1 has no equal ratios",
        ),
        (axes("radio.loss = { from = 0, to = 1, counts = 2 }"), "plan.toml:4:7: radio.loss: unknown field `counts`"),
        (axes("\"radio loss\" = [1]"), "plan.toml:4:1: radio loss: it is not the name of a field"),
        (axes("ticks.x = [1]"), "plan.toml:4:7: ticks.x: ticks is not a table in the scenario"),
        (
            axes("\"plane.group[0].count\" = [1]"),
            "plan.toml:4:1: plane.group[0].count: group is not a list in the scenario",
        ),
        (
            axes("plane.radius_m = [0.2, 9]"),
            "duel.toml:13:8: plane.robots: robots 1 and 2 overlap at the start (with plane.radius_m = 9 of",
        ),
        (error("[set]\nradio.loss = 7\n[axes]\nradio.loss = [0]"), "plan.toml:4:7: radio.loss: it is named twice"),
        (error("[set]\nradio.loss = [7]"), "plan.toml:4:7: radio.loss: [7] is neither a number nor a word"),
        (
            error("[[zip]]\nradio.loss = [0, 1]\nradio.delay_ms = [1]"),
            "plan.toml:5:7: zip[0]: 2 values of radio.loss cannot",
        ),
        (error("[[zip]]"), "plan.toml:3:1: zip[0]: there are no fields"),
        (error("[[sample]]\nkind = 'random'\ncount = 0\naxes = {}"), "plan.toml:5:9: sample[0].count: 0 samples"),
        (
            error("[[sample]]\nkind = 'sobol'\ncount = 3\naxes = {}"),
            "plan.toml:4:8: sample[0].kind: unknown value `sobol`",
        ),
        (error("seeds = 0"), "plan.toml:3:9: seeds: there is none"),
        (error("seeds = [1, 2, 1]"), "plan.toml:3:9: seeds: 1 is listed twice"),
        (error("seeds = 2000000"), "plan.toml:3:9: seeds: there are too many"),
        (error("seeds = 'all'"), "plan.toml:3:9: seeds: \"all\" is not a number, a list"),
        (
            error("measures = ['arrivd']"),
            "plan.toml:3:13: measures[0]: arrivd is neither a figure of summary.json nor of a probe; did you mean arrived?",
        ),
        (error("measures = ['arrived', 'arrived']"), "plan.toml:3:24: measures[1]: arrived is listed twice"),
        (error("measures = []"), "plan.toml:3:12: measures: there is none"),
        (
            error("[[plot]]\nfigure = 'arrived'\nover = 'radio.loss'"),
            "plan.toml:5:8: plot[0].over: radio.loss is not an axis",
        ),
        (error("axs = 1"), "plan.toml:3:1: axs: unknown field `axs`"),
        (error("[axes"), "plan.toml:3:6: "),
    ] {
        assert!(said.starts_with(expected), "{said}\n{expected}");
    }
    let ranges = |range: &str| {
        let text = format!("[[sample]]\nkind = 'random'\ncount = 3\n[sample.axes]\nradio.range_m = {range}\n");
        (error(&text), axes(&format!("radio.range_m = {}", range.replace(" }", ", count = 3 }"))))
    };
    for (range, expected) in [
        ("{ from = -1e308, to = 1e308 }", "-1e308 to 1e308 is not a range; give finite ends, nearer to each other"),
        ("{ from = 1, to = inf }", "1 to inf is not a range; give finite ends"),
        ("{ from = nan, to = 1 }", "NaN to 1 is not a range; give finite ends"),
        ("{ from = 1e-300, to = 1e300, log = true }", "1e-300 to 1e300 is not a range; give finite ends"),
        ("{ from = 1e300, to = 1e-300, log = true }", "1e300 to 1e-300 is not a range; give finite ends"),
        ("{ from = 0, to = 1, log = true }", "0 to 1 has no equal ratios; give ends above 0"),
        ("{ from = -2, to = -1, log = true }", "-2 to -1 has no equal ratios; give ends above 0"),
    ] {
        let (sample, axis) = ranges(range);
        assert!(sample.starts_with(&format!("plan.toml:7:7: radio.range_m: {expected}")), "{sample}");
        assert!(axis.starts_with(&format!("plan.toml:4:7: radio.range_m: {expected}")), "{axis}");
    }
    let reversed = error("[[sample]]\nkind = 'random'\ncount = 3\n[sample.axes]\nradio.range_m = { from = 9, to = 2 }");
    let expected = "plan.toml:7:7: radio.range_m: 9 to 2 is a reversed range; give the smaller number first";
    assert!(reversed.starts_with(expected), "{reversed}");
    let step = axes("radio.range_m = { from = 1, to = 2, step = inf }");
    assert!(step.starts_with("plan.toml:4:7: radio.range_m: steps of inf do not lead from 1 to 2"), "{step}");
    let huge =
        axes("radio.loss = { from = 0, to = 1, count = 2000 }\nradio.delay_ms = { from = 0, to = 1, count = 2000 }");
    assert!(huge.starts_with("plan.toml:3:1: axes: more than a million runs"), "{huge}");
}

#[test]
fn errors_of_the_scenario_name_its_own_line() {
    let folder = folder();
    fs::write(folder.path().join("duel.toml"), SCENARIO.replace("range_m", "range")).expect("room");
    let said = parse(&folder, "[axes]\nradio.loss = [0]").expect_err("a wrong field");
    assert!(said.starts_with("duel.toml:7:1: radio.range: unknown field `range`"), "{said}");
    fs::write(folder.path().join("duel.toml"), "name = ").expect("room");
    assert!(parse(&folder, "").expect_err("no TOML").starts_with("duel.toml:1:8: "));
    fs::remove_file(folder.path().join("duel.toml")).expect("mine");
    assert!(parse(&folder, "").expect_err("no file").starts_with("plan.toml:2:12: scenario: "));
}

#[test]
fn text_fields_accept_lists_of_words() {
    let plan = plan("[axes]\nradio.format = ['postcard', 'mavlink']\n");
    assert_eq!(values(&plan, "radio.format"), ["postcard", "mavlink"]);
    assert!(error("[axes]\nradio.format = ['postcard', 'morse']").contains("unknown value `morse`"));
}

#[test]
fn fingerprint_covers_exactly_the_inputs_of_runs() {
    let folder = folder();
    let of = |text: &str| parse(&folder, text).expect("a plan").fingerprint();
    let text = "seeds = 2\n[axes]\nradio.loss = [0, 0.5]\n";
    let first = of(text);
    assert_eq!(of(&text.replace("seeds", "# remark\nseeds").replace("[0, 0.5]", "[0,0.5] # all")), first);
    for other in [
        text.replace("0.5", "0.6"),
        text.replace("= 2", "= 3"),
        text.replace("loss", "duplicate"),
        text.replace("seeds", "measures = ['arrived']\nseeds"),
        format!("{text}[set]\nticks = 21\n"),
    ] {
        assert_ne!(of(&other), first, "{other}");
    }
    fs::write(folder.path().join("duel.toml"), SCENARIO.replace("ticks = 20", "ticks = 21")).expect("room");
    assert_ne!(of(text), first);
    fs::write(folder.path().join("duel.toml"), SCENARIO.replace("[plane]", "# more\n[plane]")).expect("room");
    assert_eq!(of(text), first);
}

#[test]
fn changed_map_changes_the_fingerprint() {
    let folder = folder();
    let land = |rows: &str| format!("type octile\nheight 2\nwidth 3\nmap\n{rows}\n");
    fs::write(folder.path().join("land.map"), land("...\n...")).expect("room");
    let scenario =
        "name = 'walk'\nticks = 5\n[terrain]\nfile = 'land.map'\n[[robots.list]]\nstart = [0, 0]\ngoal = [2, 0]\n";
    fs::write(folder.path().join("duel.toml"), scenario).expect("room");
    let of = || parse(&folder, "[axes]\nradio.loss = [0, 0.5]\n").expect("a plan").fingerprint();
    let first = of();
    fs::write(folder.path().join("land.map"), land(".@.\n...")).expect("room");
    assert_ne!(of(), first);
}

fn names(lines: Vec<Line>) -> Vec<&'static str> {
    lines.into_iter().flat_map(|line| [vec![line.name], names(line.inner)].concat()).collect()
}

#[test]
fn every_field_of_a_plan_is_documented() {
    let tables = [table::PlanFile::lines(), table::SeedRange::lines(), table::RangeTable::lines()];
    let fields: Vec<&str> = tables.into_iter().flat_map(names).collect();
    assert!(fields.len() > 30, "{fields:?}");
    let page = include_str!("../../../../../docs/sweeps.md");
    for field in fields {
        let is_named = ["`", "[", "[[", " ", "{ "]
            .iter()
            .any(|before| ["`", "]", " ", " }"].iter().any(|after| page.contains(&format!("{before}{field}{after}"))));
        assert!(is_named, "{field} is not in docs/sweeps.md");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn numbers_denote_different_runs(
        losses in proptest::collection::btree_set(0u32..100, 1..5),
        delays in proptest::collection::btree_set(0u32..100, 1..4),
        seeds in 1u32..4,
        samples in 1u32..4,
    ) {
        let list = |values: &std::collections::BTreeSet<u32>| format!("{values:?}").replace('{', "[").replace('}', "]");
        let losses = list(&losses.iter().copied().collect());
        let plan = plan(&format!(
            "seeds = {seeds}\n[axes]\nradio.jitter_ms = {losses}\nradio.delay_ms = {}\n[[sample]]\nkind = 'random'\ncount = {samples}\n\
             [sample.axes]\nradio.loss = {{ from = 0, to = 1 }}\n", list(&delays),
        ));
        let mut seen = std::collections::BTreeSet::new();
        for number in 0..plan.runs() {
            let run = plan.run(number);
            prop_assert_eq!(run.number, number);
            prop_assert!(seen.insert((run.values.iter().map(|v| v.to_string()).collect::<Vec<_>>(), run.seed)));
        }
    }
}

fn changed(text: &str, changes: &Changes) -> Result<Plan, String> {
    let folder = folder();
    let text = format!("name = 'p'\nscenario = 'duel.toml'\n{text}");
    Plan::parse(&text, &folder.path().join("plan.toml"), changes).map_err(|error| error.to_string())
}

fn fields(texts: &[&str]) -> Changes {
    let fields = texts.iter().map(|text| text.parse().expect("a change")).collect();
    Changes { fields, ..Changes::default() }
}

#[test]
fn the_command_line_changes_axes_seeds_and_other_fields() {
    let text =
        "seeds = { from = 5, count = 9, quick = 2 }\n[axes]\nradio.loss = [0, 1]\nplane.robots.circle.count = [4]\n";
    let plan = changed(text, &fields(&["loss=0.5", "count=2..4", "plane.safety=none"])).expect("a plan");
    assert_eq!(plan.axes().collect::<Vec<_>>(), ["radio.loss", "plane.robots.circle.count", "plane.safety"]);
    assert_eq!((values(&plan, "loss").join(" "), values(&plan, "count").join(" ")), ("0.5".into(), "2 3 4".into()));
    let seeds = |changes: Changes| {
        let plan = changed(text, &changes).expect("a plan");
        (plan.run(0).seed, plan.seeds())
    };
    assert_eq!(seeds(Changes::default()), (5, 9));
    assert_eq!(seeds(Changes { is_quick: true, ..Changes::default() }), (5, 2));
    assert_eq!(seeds(Changes { seed: Some(7), ..Changes::default() }), (7, 9));
    assert_eq!(seeds(Changes { seeds: Some(20), ..Changes::default() }), (5, 20));
    for (change, expected) in [
        ("loss=0,0", "radio.loss=...: 0 is listed twice"),
        ("radio.los=1", "duel.toml:6:1: radio.los: unknown field `los`"),
        ("loss=2", "duel.toml:6:1: radio.loss: 2 is not a probability"),
    ] {
        let error = changed(text, &fields(&[change])).expect_err(change);
        assert!(error.contains(expected), "{error}");
    }
    assert!("loss".parse::<Change>().is_err() && "a b=1".parse::<Change>().is_err());
}

#[test]
fn several_scenarios_are_the_first_axis() {
    let folder = folder();
    fs::write(folder.path().join("six.toml"), SCENARIO.replace("count = 4", "count = 6")).expect("room");
    let text = "name = 'p'\nscenario = ['duel.toml', 'six.toml']\n[axes]\nradio.loss = [0, 0.5]\n";
    let load = |changes: &Changes| Plan::parse(text, &folder.path().join("plan.toml"), changes).expect("a plan");
    let plan = load(&Changes::default());
    assert_eq!((plan.runs(), plan.values_of(3)), (4, vec!["six".into(), "0.5".into()]));
    let robots = |plan: &Plan, run| plan.given(&plan.run(run)).unwrap().scenario().expect("a scenario").robots.len();
    assert_eq!((robots(&plan, 0), robots(&plan, 3)), (4, 6));
    assert_eq!(robots(&load(&fields(&["scenario=six"])), 0), 6);
}

#[test]
fn wrong_acceptances_and_references_are_refused() {
    let accept = |text: &str| error(&format!("measures = ['arrived']\n[axes]\nradio.loss = [0]\n[[accept]]\n{text}\n"));
    for (said, expected) in [
        (accept("measure = 'collisions'\nequals = 0"), "plan.toml:7:11: accept[0].measure: collisions is not measured"),
        (accept("measure = 'arrived'"), "plan.toml:6:1: accept[0]: it has no limit"),
        (accept("measure = 'arrived'\nat_least = 2\nat_most = 1"), "accept[0]: it has no limit"),
        (accept("measure = 'arrived'\nwithin = 0.1"), "plan.toml:8:10: accept[0].within: there is no reference"),
        (accept("measure = 'arrived'\nat_most = 1\nmean = true\nof_reference = true"), "are not shares of a reference"),
        (accept("measure = 'arrived'\nequals = 4\nwhere = { losses = 0 }"), "losses is not an axis"),
        (accept("measure = 'arrived'\nequals = 4\nwhere = { loss = 0.5 }"), "0.5 is not a value of loss"),
    ] {
        assert!(said.contains(expected), "{said}");
    }
    let folder = folder();
    for (table, expected) in [
        ("losses,arrived\n0,4\n", "paper.csv:1: \"losses\" is neither an axis nor a measure"),
        ("# comment\nloss,arrived\n0\n", "paper.csv:3: it does not fit the header"),
        ("loss,arrived\n0,four\n", "paper.csv:2: it does not fit the header"),
    ] {
        fs::write(folder.path().join("paper.csv"), table).expect("room");
        let text = "reference = 'paper.csv'\nmeasures = ['arrived']\n[axes]\nradio.loss = [0]\n";
        let said = parse(&folder, text).expect_err(table);
        assert!(said.contains(expected), "{said}");
    }
}

#[test]
fn a_plan_with_a_wrong_character_is_refused_with_its_place() {
    let folder = folder();
    let text = "title = 't'\nseeds = [1, 2]\nmeasures = ['arrived']\n[set]\nticks = 5\n[axes]\nradio.loss = [0, 0.5]\n[[zip]]\n\
                radio.delay_ms = [1, 2]\nplane.radius_m = [0.1, 0.2]\n[[sample]]\nkind = 'random'\ncount = 2\n\
                axes = { tick_s = { from = 0.1, to = 0.2 } }\n[[plot]]\nfigure = 'arrived'\nover = 'loss'\n[[picture]]\n\
                where = { loss = 0.5 }\n[[accept]]\nmeasure = 'arrived'\nwhere = { loss = [0, 0.5] }\nat_least = 0\n";
    parse(&folder, text).expect("a plan");
    let mut refused = 0;
    for (at, new) in (0..text.len()).flat_map(|at| ["", "x", "-", "["].map(|new| (at, new))) {
        let mut text = text.to_owned();
        text.replace_range(at..=at, new);
        let Err(error) = parse(&folder, &text) else { continue };
        let (place, what) = error.split_once(": ").unwrap_or_else(|| panic!("no place: {error}"));
        let line = place.strip_prefix("plan.toml:").or_else(|| place.strip_prefix("duel.toml:"));
        assert!(
            line.is_some_and(|line| line.split(':').all(|number| number.parse::<usize>().is_ok())),
            "no line: {error}"
        );
        assert!(what.contains("; "), "no remedy: {error}");
        let mut words = what.split(|c: char| !c.is_ascii_alphanumeric());
        assert!(!words.any(|word| ["u32", "u64", "usize", "f64", "struct", "enum"].contains(&word)), "a type: {error}");
        refused += 1;
    }
    assert!(refused > 500, "only {refused} were refused");
}
