//! Files that are well-formed but contradict themselves.

use super::*;

const LIST: &str = "list = [{ start = [0, 0], goal = [3, 2] }]";

fn cells(rest: &str) -> String {
    format!("{}{rest}", with_robots(LIST))
}

#[test]
fn lists_of_another_length_and_lists_for_tables_are_refused() {
    let order = |what: &str| cells(&format!("[[intervention]]\nat_s = 1\ndo = {what}\n"));
    for (text, expected) in [
        (
            with_robots("list = [{ start = [0, 0, 77], goal = [3, 2] }]"),
            "s.toml:6: robots.list[0].start: the list has 3 values, 2 are needed; ",
        ),
        (
            with_robots("list = [{ start = [0], goal = [3, 2] }]"),
            "s.toml:6: robots.list[0].start: the list has 1 values, 2 are needed; ",
        ),
        (with_robots("list = [[1, [0, 0], [3, 2]]]"), "s.toml:6: robots.list[0]: a list is not a table; "),
        (cells("[radio]\nburst = [0.5, 2000, 1]\n"), "s.toml:8: radio.burst: a list is not a table; "),
        (order("[\"goal\", 1, [1, 1, 0]]"), "s.toml:9: intervention[0].do: a list is not a table; "),
        (order("\"goal\""), "s.toml:9: intervention[0].do: \"goal\" is not a table; "),
        (
            order("{ kind = \"goal\", place_m = [1, 1, 0, 4] }"),
            "s.toml:9: intervention[0].do: the list has 4 values, 3 are needed; ",
        ),
        (
            order("{ kind = \"goal\", place_m = [1, 1] }"),
            "s.toml:9: intervention[0].do: the list has 2 values, 3 are needed; ",
        ),
        (
            order("{ kind = \"solid\", solid = [\"circle\", [1, 2], 0.5] }"),
            "s.toml:9: intervention[0].do: a list is not a table; ",
        ),
        (order("{ kind = 3 }"), "s.toml:9: intervention[0].do.kind: 3 is not a name in quotes; "),
    ] {
        let refusal = refusal(&text);
        assert!(refusal.starts_with(expected), "expected {expected}\n     got {refusal}");
    }
}
