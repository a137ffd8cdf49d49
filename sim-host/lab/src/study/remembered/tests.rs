use super::*;
use staya_sim::scenario::Source;
use std::collections::BTreeMap;
use std::path::Path;

const LAND: &str = "name = 't'\nticks = 4000\nterrain.natural = { width = 40, height = 44, classes = 9, obstacles = 12 }\n\
    robots.scattered = { count = 9, least = 15 }\nradio.range_m = inf\n";

fn read(rest: &str) -> Result<Job, String> {
    let text = format!("{LAND}{rest}");
    let source = Source::new(Path::new("t.toml"), &text).unwrap();
    RememberedLand.read(&Given { source, measures: &[], seed: 5 }).map_err(|error| error.to_string())
}

fn values(rest: &str) -> BTreeMap<String, Option<f64>> {
    read(&format!("maps.share = true\nstudy.goal = [38, 42]\n{rest}")).unwrap()(&|_| true).unwrap().values
}

#[test]
fn both_missions_arrive_and_the_whole_map_is_best() {
    let values = values("");
    assert_eq!((values["arrived"], values["crossed"]), (Some(9.0), Some(4.0)));
    assert!(values["known_percent"] > Some(40.0) && values["known_percent"] <= Some(100.0));
    assert!(values["whole_percent"] <= Some(2.0), "{values:?}");
    for name in RememberedLand.measures() {
        assert!(values[&name.0].is_some(), "{name:?}");
    }
}

#[test]
fn land_that_changes_between_the_missions_is_other_land_in_the_first_one_alone() {
    let [same, other] = ["", "study.wrong = 0.8\n"].map(values);
    assert_eq!(same["none_percent"], other["none_percent"]);
    assert_ne!(same["sharing_percent"], other["sharing_percent"]);
}

#[test]
fn a_run_that_is_stopped_is_cut() {
    let job = read("maps.share = true\nstudy.goal = [38, 42]\n").unwrap();
    assert!(job(&|tick| tick < 3).unwrap().is_cut);
}

#[test]
fn wrong_parameters_are_named() {
    let message = |rest: &str| read(rest).err().unwrap();
    assert!(message("").contains("maps.share = true"));
    for (field, remedy) in [
        ("goal = [40, 1]", "give a free cell"),
        ("start = [1, 44]", "give a free cell"),
        ("bytes = 31", "give 32 to 65536"),
        ("wrong = 1.5", "0 to 1"),
        ("other = 1", "study.other"),
    ] {
        let message = message(
            &format!("maps.share = true\nstudy.{field}\nstudy.goal = [38, 42]\n")
                .replace("study.goal = [40, 1]\nstudy.goal = [38, 42]", "study.goal = [40, 1]"),
        );
        assert!(message.contains(remedy), "{field}: {message}");
    }
}
