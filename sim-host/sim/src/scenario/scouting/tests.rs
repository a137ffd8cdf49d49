use crate::scenario::{Overrides, Scenario};
use std::path::Path;

const LAND: &str = "[terrain]\nuniform = { width = 8, height = 6, classes = 4 }\n[robots]\nlist = [{ start = [0, 0], goal = [7, 5] }]\n";

fn parse(rest: &str) -> Result<Scenario, String> {
    let text = format!("name = \"t\"\nticks = 9\ntick_s = 0.5\n{rest}");
    Scenario::parse(&text, Path::new("t.toml"), &Overrides::default()).map_err(|error| error.to_string())
}

#[test]
fn scouting_extends_planning_but_not_sight() {
    let scenario = parse(&format!("{LAND}[grid]\nradius = 4\n[scouting]\nradius = 9\n")).expect("good");
    let scouting = scenario.land.scouting.as_ref().expect("scouted");
    assert_eq!((scouting.sight, scenario.laws.radius), (4, 9));
    assert_eq!(*scouting.map, scenario.land.terrain, "nothing is unknown or wrong unless said");
    let scenario = parse(&format!("{LAND}[scouting]\n")).expect("good");
    assert_eq!((scenario.land.scouting.map(|known| known.sight), scenario.laws.radius), (Some(5), 16));
    assert!(parse(LAND).expect("good").land.scouting.is_none());
}

#[test]
fn known_terrain_is_part_of_the_fingerprint() {
    let print = |rest: &str| parse(&format!("{LAND}{rest}")).expect("good").fingerprint();
    let prints = [
        print(""),
        print("[scouting]\n"),
        print("[scouting]\nradius = 9\n"),
        print("[scouting]\nunknown = 0.5\n"),
        print("[scouting]\nmodel_bytes = 400\n"),
        print("[scouting]\nmodel_bytes = 401\n"),
        print("[scouting]\nunknown = 0.5\nmodel_bytes = 400\n"),
        print("[scouting]\nunknown = 0.5\nseed = 9\n"),
        print("[[terrain.change]]\nclass = 0\ncells = [[3, 3]]\n"),
        print("[[terrain.change]]\nclass = 0\ncells = [[3, 4]]\n"),
    ];
    let mut different = prints.to_vec();
    different.sort_unstable();
    different.dedup();
    assert_eq!(different.len(), prints.len());
}

#[test]
fn invalid_scouting_is_refused_with_place_and_remedy() {
    for (rest, field, remedy) in [
        ("[scouting]\nunknown = 1.5\n", "scouting.unknown", "0 to 1"),
        ("[scouting]\nwrong = -0.5\n", "scouting.wrong", "0 to 1"),
        ("[scouting]\nunknown = 0.6\nwrong = 0.6\n", "scouting.wrong", "sum of at most 1"),
        ("[scouting]\npatch_cells = 0\n", "scouting.patch_cells", "1 to 1000"),
        ("[scouting]\nassumed = 0\n", "scouting.assumed", "1 to 255"),
        ("[scouting]\nradius = 4\n", "scouting.radius", "5 to 16"),
        ("[scouting]\nradius = 17\n", "scouting.radius", "5 to 16"),
        ("[scouting]\nmap = \"none.map\"\n", "scouting.map", "relative to the scenario"),
        ("[scouting]\nmodel_bytes = 31\n", "scouting.model_bytes", "32 to 65536"),
        ("[scouting]\nmodel_bytes = 400\nradius = 9\n", "scouting.radius", "leave one of radius and model_bytes out"),
        ("[grid.route]\nexit = \"ray\"\n[scouting]\nmodel_bytes = 400\n", "scouting.model_bytes", "exit = \"best\""),
        ("[grid]\nlaw = \"negotiation\"\n[scouting]\nmodel_bytes = 400\n", "scouting.model_bytes", "give a law"),
    ] {
        let message = parse(&format!("{LAND}{rest}")).unwrap_err();
        assert!(message.contains(&format!("{field}: ")) && message.contains(remedy), "{rest}: {message}");
    }
    let plane =
        "[plane]\nradius_m = 0.2\nmax_speed_mps = 1\n[plane.robots.circle]\ncount = 4\nradius_m = 3\n[scouting]\n";
    let message = parse(plane).unwrap_err();
    assert!(message.contains("scouting: these robots plan on no land"), "{message}");
}

#[test]
fn an_old_map_must_have_the_size_of_the_land() {
    let dir = tempfile::tempdir().expect("a folder");
    for (name, row) in [("now.map", "...."), ("old.map", "..@.."), ("good.map", ".@..")] {
        let text = format!("type octile\nheight 1\nwidth {}\nmap\n{row}\n", row.len());
        std::fs::write(dir.path().join(name), text).expect("it can be written");
    }
    let with = |map: &str| {
        let text = format!(
            "name = \"t\"\nticks = 9\n[terrain]\nfile = \"now.map\"\n[robots]\nlist = [{{ start = [0, 0], goal = [3, 0] }}]\n\
             [scouting]\nmap = \"{map}\"\n"
        );
        Scenario::parse(&text, &dir.path().join("t.toml"), &Overrides::default()).map_err(|error| error.to_string())
    };
    assert_eq!(with("good.map").expect("good").land.scouting.expect("scouted").map.cells(), [1, 0, 1, 1]);
    let message = with("old.map").unwrap_err();
    assert!(message.contains("it has 5 x 1 cells, the land has 4 x 1 cells; give a map of the same"), "{message}");
}

#[test]
fn a_model_takes_the_place_of_the_map_and_can_be_beside_shared_ones() {
    let scenario = parse(&format!("{LAND}[grid]\nradius = 4\n[maps]\nshare = true\n[scouting]\nmodel_bytes = 400\n"));
    let scenario = scenario.expect("good");
    assert!(scenario.land.scouting.is_none() && scenario.laws.maps.is_some());
    assert!(scenario.remarks().is_empty());
    let known = scenario.land.known.expect("a model");
    let many = "[terrain]\nuniform = { width = 1000, height = 1100 }\n[robots.scattered]\ncount = 1000\n";
    let message = parse(&format!("{many}[scouting]\nmodel_bytes = 400\n")).unwrap_err();
    assert!(
        message.contains("1000 robots, each from 1000 x 1100 cells") && message.contains("fewer robots"),
        "{message}"
    );
    assert_eq!((known.bytes, scenario.laws.radius, &*known.map), (400, 4, &scenario.land.terrain));
}

#[test]
fn robots_without_a_way_on_the_map_are_named_and_a_line_of_cells_is_refused() {
    let dir = tempfile::tempdir().expect("a folder");
    for (name, rows) in [("now.map", "....\n...."), ("old.map", "...@\n....")] {
        let text = format!("type octile\nheight 2\nwidth 4\nmap\n{rows}\n");
        std::fs::write(dir.path().join(name), text).expect("it can be written");
    }
    let text = "name = \"t\"\nticks = 9\n[terrain]\nfile = \"now.map\"\n[robots]\n\
        list = [{ start = [0, 0], goal = [3, 1] }, { start = [1, 1], goal = [3, 0] }]\n\
        [scouting]\nmap = \"old.map\"\nmodel_bytes = 64\n";
    let scenario = Scenario::parse(text, &dir.path().join("t.toml"), &Overrides::default()).expect("good");
    let remarks = scenario.remarks();
    assert!(matches!(&remarks[..], [one] if one.contains("1 robots plan without a table (robot 1)")), "{remarks:?}");
    let line = "[terrain]\nuniform = { width = 8, height = 1, classes = 4 }\n[robots]\n\
        list = [{ start = [0, 0], goal = [7, 0] }]\n[scouting]\nmodel_bytes = 64\n";
    assert!(parse(line).unwrap_err().contains("scouting.model_bytes: the land is one cell wide"));
}
