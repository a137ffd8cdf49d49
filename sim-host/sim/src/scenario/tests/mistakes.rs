//! Mistakes in a file, each with its place and the remedy.

use super::*;

#[test]
fn every_mistake_is_named_with_line_field_and_remedy() {
    let robots = "[robots]\nlist = [{ start = [0, 0], goal = [3, 2] }]\n";
    let cases = [
        ("name = ", "s.toml:1:8: "),
        (&format!("colour = 1\n{HEAD}{robots}"), "s.toml:1:1: colour: unknown field `colour`"),
        (&format!("{HEAD}{robots}[radio]\nloss = \"much\"\n"), "s.toml:8:8: radio.loss: \"much\" is not a number"),
        (
            &format!("{HEAD}{robots}[radio]\nlosses = 0.5\n"),
            "s.toml:8:1: radio.losses: unknown field `losses`; did you mean `loss`?",
        ),
        (&format!("{HEAD}{robots}[radio.burst]\nshare = 0.5\n"), "s.toml:7:1: radio.burst: missing field `mean_ms`"),
        ("ticks = 3\n", "s.toml:1:1: missing field `name`"),
        ("name = \"t\"\nticks = -3\n", "s.toml:2:9: ticks: -3 is not a whole number"),
        (
            &format!("{HEAD}{robots}[radio]\nloss = 30\n"),
            "s.toml:8:8: radio.loss: 30 is not a probability; give a number from 0 to 1",
        ),
        (
            &format!("{HEAD}{robots}[radio]\n\nbit_error_rate = nan\n"),
            "s.toml:9:18: radio.bit_error_rate: NaN is not a probability",
        ),
        (
            &format!("{HEAD}{robots}[radio]\nformat = \"morse\"\n"),
            "s.toml:8:10: radio.format: unknown value `morse`; give one of `postcard`, `mavlink`",
        ),
        (
            &format!(
                "{HEAD}[robots]\nlist = [{{ start = [0, 0], goal = [3, 2], id = 255 }}]\n[radio]\nformat = \"mavlink\"\n"
            ),
            "s.toml:8:10: radio.format: robot 255 has no number in mavlink: systems are 1 to 254; give fewer robots",
        ),
        (&format!("{HEAD}{robots}[grid]\nmoves = 6\n"), "s.toml:8:9: grid.moves: a cell has 4 or 8 neighbours; give 4"),
        (
            &format!("{HEAD}{robots}[grid]\nmoves = 4\n"),
            "s.toml:8:9: grid.moves: routes and formations use eight neighbours; give law = \"negotiation\"",
        ),
        (
            &format!("{HEAD}{robots}[grid]\nmoves = 4\n[plane]\nradius_m = 0.3\nmax_speed_mps = 1\n"),
            "s.toml:8:9: grid.moves: robots in the plane do not move from cell to cell; leave it out",
        ),
        (
            &format!("{HEAD}{robots}[grid]\nsimultaneous = true\n"),
            "s.toml:8:16: grid.simultaneous: diagonal moves at once would cross each other; give moves = 4",
        ),
        (
            &format!("{HEAD}{robots}[radio]\nrange_m = nan\n"),
            "s.toml:8:11: radio.range_m: NaN is out of range; give 0 to inf metres",
        ),
        (
            &format!("{HEAD}{robots}[radio]\ndelay_ms = -1\n"),
            "s.toml:8:12: radio.delay_ms: -1 is out of range; give 0 to 600000 milliseconds",
        ),
        (
            &format!("{HEAD}{robots}[radio]\nblackout_s = [[0, 1], [5, 4]]\n"),
            "s.toml:8:23: radio.blackout_s[1]: [5, 4] is not a time span",
        ),
        (
            &format!("{HEAD}{robots}[radio]\nburst = {{ share = 0.5, mean_ms = 100 }}\n"),
            "s.toml:8:34: radio.burst.mean_ms: 100 is out of range; with this tick and share, give 2000.0",
        ),
        (
            &format!("tick_s = inf\n{HEAD}{robots}"),
            "s.toml:1:10: tick_s: inf is out of range; give 0.001 to 60 seconds",
        ),
        (&format!("{HEAD}{robots}").replace("ticks = 5", "ticks = 0"), "s.toml:2:9: ticks: a run needs"),
        (&format!("{HEAD}{robots}").replace("\"t\"", "\"../x\""), "s.toml:1:8: name: \"../x\" cannot name a folder"),
        (&format!("{HEAD}{robots}").replace("m.map", "no.map"), "s.toml:4:8: terrain.file: "),
        (&format!("{HEAD}crop = {{ x = 2, y = 0, width = 4, height = 1 }}\n{robots}"), "s.toml:5:8: terrain.crop: "),
        (&format!("{HEAD}cell_m = nan\n{robots}"), "s.toml:5:10: terrain.cell_m: NaN is out of range"),
        (
            &format!("name = \"t\"\nticks = 5\n[terrain]\n{robots}"),
            "s.toml:3:1: terrain: a field is missing; give exactly one of `file`, `uniform`",
        ),
        (&with_robots(""), "s.toml:5:1: robots: a field is missing; give exactly one of `list`"),
        (&with_robots("list = []"), "s.toml:5:1: robots: there are no robots"),
        (
            &with_robots("list = [\n{ start = [0, 0], goal = [3, 2] },\n{ start = [0, 0], goal = [3, 1] }]"),
            "s.toml:8:11: robots.list[1].start: robots 1 and 2 have the same start (0, 0); a cell holds one",
        ),
        (
            &with_robots("list = [{ start = [0, 0], goal = [1, 1] }]"),
            "s.toml:6:34: robots.list[0].goal: the goal (1, 1) of robot 1 is in a wall; the nearest free cell is [1, 0]",
        ),
        (
            &with_robots("list = [{ start = [0, 3], goal = [1, 2] }]"),
            "s.toml:6:19: robots.list[0].start: the start (0, 3) of robot 1 is not on the map; the map has columns 0 to 3 and rows 0 to 2",
        ),
        (
            &with_robots("list = [{ id = 0, start = [0, 0], goal = [1, 2] }]"),
            "s.toml:6:16: robots.list[0].id: 0 is not free",
        ),
        (
            &with_robots("formation = { rows = 2, columns = 2, start = [0, 2], goal = [0, 2] }"),
            "s.toml:6:46: robots.formation.start: the start (0, -1) of robot 3 is not on the map",
        ),
        (
            &with_robots("formation = { rows = 2, start = [0, 2], goal = [0, 2] }"),
            "s.toml:6:13: robots.formation: its shape is not clear",
        ),
        (
            &with_robots("formation = { rows = 60000, columns = 60000, start = [0, 2], goal = [0, 2] }"),
            "s.toml:6:13: robots.formation: 60000 rows of 60000 robots do not fit any map",
        ),
        (
            &with_robots("formation = { places = [[0, 0], [1, 0]], edges = [[1, 3]], start = [0, 2], goal = [0, 2] }"),
            "s.toml:6:51: robots.formation.edges[0]: [1, 3] joins no two robots",
        ),
        (&with_robots("scen = { file = \"none.scen\", count = 2 }"), "s.toml:6:17: robots.scen.file: "),
        (
            &with_robots("scattered = { count = 12 }"),
            "s.toml:6:23: robots.scattered.count: 12 robots on 11 passable cells",
        ),
        (
            &format!("{}[[fault]]\nrobot = 2\nat_s = 1\n", with_robots("list = [{ start = [0, 0], goal = [1, 2] }]")),
            "s.toml:8:9: fault[0].robot: there is no robot 2",
        ),
        (
            &format!("{}[[fault]]\nrobot = 1\nat_s = nan\n", with_robots("list = [{ start = [0, 0], goal = [1, 2] }]")),
            "s.toml:9:8: fault[0].at_s: NaN is out of range",
        ),
    ];
    for (text, expected) in cases {
        let refusal = refusal(text);
        assert!(refusal.starts_with(expected), "expected {expected}\n     got {refusal}\nfor\n{text}");
        assert!(refusal.contains("; "), "no remedy: {refusal}");
    }
}

#[test]
fn a_key_or_table_that_is_given_twice_is_named_with_both_lines() {
    let cases = [
        (
            "name = \"t\"\nticks = 5\nticks = 6\n",
            "s.toml:3:1: `ticks` is given twice, in lines 2 and 3; keep one of them",
        ),
        ("a = 1\n[plane]\na = 1\nx = 2\na = 3\n", "s.toml:5:1: `a` is given twice, in lines 3 and 5"),
        ("[[plane.wall]]\na = 1\n[[plane.wall]]\na = 1\n\na = 1\n", "s.toml:6:1: `a` is given twice, in lines 4 and 6"),
        ("radio = { loss = 1, loss = 2 }\n", "s.toml:1:21: `loss` is given twice, in line 1"),
        ("list = [{ id = 1 },\n  { id = 1, id = 2 }]\n", "s.toml:2:13: `id` is given twice, in line 2"),
        ("radio.loss = 1\nradio.loss = 2\n", "s.toml:2:7: `loss` is given twice, in lines 1 and 2"),
        ("[plane]\nx = 1\n[radio]\n[plane]\ny = 1\n", "s.toml:4:2: `plane` is given twice, in lines 1 and 4"),
        (
            "[plane.orca]\nx = 1\n[plane]\nradius_m = 1\n[plane.orca]\n",
            "s.toml:5:8: `orca` is given twice, in lines 1 and 5",
        ),
        ("a = 1\n[a]\n", "s.toml:2:2: `a` is given twice, in lines 1 and 2"),
        ("\"a\" = 1\na = 2\n", "s.toml:2:1: `a` is given twice, in lines 1 and 2"),
        ("a = \"1\nb = 2\n", "s.toml:1:"),
    ];
    for (text, expected) in cases {
        let message = Scenario::parse(text, Path::new("s.toml"), &Overrides::default()).unwrap_err().to_string();
        assert!(message.starts_with(expected), "{text}: {message}");
    }
}
