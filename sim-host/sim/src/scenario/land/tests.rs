use super::*;
use crate::scenario::{Overrides, Scenario};
use std::path::Path;

fn parse(change: &str) -> Result<Scenario, String> {
    let text = format!(
        "name = \"t\"\nticks = 9\ntick_s = 0.5\n[terrain]\ncell_m = 2\nuniform = {{ width = 8, height = 6, classes = 4 }}\n\
         [[terrain.change]]\n{change}\n[robots]\nlist = [{{ start = [0, 0], goal = [7, 5] }}]\n"
    );
    Scenario::parse(&text, Path::new("t.toml"), &Overrides::default()).map_err(|error| error.to_string())
}

fn cells(change: &str) -> Vec<(i16, i16)> {
    match &parse(change).expect("good").land.changes[0].kind {
        ChangeKind::Become { cells, .. } => cells.iter().map(|(cell, _)| (cell.x, cell.y)).collect(),
        ChangeKind::Drift { cells, .. } => cells.iter().flatten().map(|cell| (cell.x, cell.y)).collect(),
    }
}

#[test]
fn cells_are_given_by_list_rectangle_or_polygon() {
    assert_eq!(cells("class = 0\ncells = [[3, 4], [7, 5]]"), [(3, 4), (7, 5)]);
    let rectangle = "class = 0\nrectangle = { x = 6, y = 1, width = 2, height = 2 }";
    assert_eq!(cells(rectangle), [(6, 1), (7, 1), (6, 2), (7, 2)]);
    assert_eq!(cells("class = 0\npolygon_m = [[0, 0], [6, 0], [0, 6]]"), [(0, 0), (1, 0), (0, 1)]);
    assert_eq!(cells("class = 0\npolygon_m = [[0, 0], [0, 6.1], [6.1, 0]]").len(), 6);
}

#[test]
fn times_are_converted_to_ticks() {
    let gate = parse("at_s = 2\nevery_s = 3\nfor_s = 1.2\nclass = 0\ncells = [[3, 4]]").expect("good");
    let LandChange { first, every, kind: ChangeKind::Become { lasts, .. } } = &gate.land.changes[0] else {
        panic!("it is a gate");
    };
    assert_eq!((*first, every.map(NonZeroU32::get), lasts.map(NonZeroU32::get)), (4, Some(6), Some(3)));
}

#[test]
fn a_drift_draws_its_share_of_cells_and_at_least_one() {
    for (share, expected) in [(0.5, 24), (0.0, 1), (1.0, 48)] {
        let scenario = parse(&format!("every_s = 1\ndrift = {{ share = {share} }}")).expect("good");
        let ChangeKind::Drift { cells: None, draws, step: 1, classes } = scenario.land.changes[0].kind else {
            panic!("it is a drift of all cells");
        };
        assert_eq!((draws, classes), (expected, 4));
    }
}

#[test]
fn invalid_changes_are_refused_with_place_and_remedy() {
    for (change, field, remedy) in [
        ("class = 0", ".class", "give cells"),
        ("cells = [[1, 1]]", "", "one of `class`, `drift`"),
        ("class = 0\ndrift = { share = 0.5 }\ncells = [[1, 1]]", ".drift", "one of `class`, `drift`"),
        ("class = 0\ncells = [[1, 1], [8, 1]]", ".cells[1]", "map of 8 x 6"),
        ("class = 0\ncells = [[1, -1]]", ".cells[0]", "map of 8 x 6"),
        ("class = 0\nrectangle = { x = 7, y = 0, width = 2, height = 1 }", ".rectangle", "part of the map"),
        ("class = 0\npolygon_m = [[0, 0], [1, 1]]", ".polygon_m", "three corners"),
        ("class = 0\npolygon_m = [[0, 0], [0.5, 0], [0, 0.5]]", ".polygon_m", "larger"),
        (
            "class = 0\ncells = [[1, 1]]\npolygon_m = [[0, 0], [5, 0], [0, 5]]",
            ".polygon_m",
            "one of `cells`, `rectangle`",
        ),
        ("class = 0\ncells = [[1, 1]]\nevery_s = 4", ".every_s", "for_s"),
        ("class = 0\ncells = [[1, 1]]\nevery_s = 4\nfor_s = 4", ".for_s", "less than every_s"),
        ("class = 0\ncells = [[1, 1]]\nat_s = -1", ".at_s", "seconds"),
        ("class = 0\ncells = [[1, 1]]\nfor_s = 0.1", ".for_s", "a tick at least"),
        ("drift = { share = 1.5 }", ".drift.share", "share"),
        ("drift = { share = 0.5, step = 0 }", ".drift.step", "1 to 254"),
        ("drift = { share = 0.5, step = 255 }", ".drift.step", "1 to 254"),
        ("drift = { share = 0.5, classes = 0 }", ".drift.classes", "1 to 255"),
        ("drift = { share = 0.5 }\nfor_s = 1", ".for_s", "leave it out"),
    ] {
        let message = parse(change).unwrap_err();
        assert!(message.contains(&format!("terrain.change[0]{field}: ")), "{change}: {message}");
        assert!(message.contains(remedy), "{change}: {message}");
    }
}
