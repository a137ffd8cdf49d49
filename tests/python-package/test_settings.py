"""Laws, safety layers and settings by name: Python refuses what files refuse, in the same words."""

import re
import typing

import numpy as np
import pytest

import staya
from staya import flock
from staya.settings import Law, Layer

PLANE = """name = "t"
ticks = 3
tick_s = 0.1
[plane]
radius_m = 0.2
max_speed_mps = 1
robots = { list = [{ start_m = [0, 0] }] }
"""
CELLS = """name = "t"
ticks = 3
[terrain]
uniform = { width = 20, height = 20, classes = 1 }
[robots]
"""
ROUTE = CELLS + "list = [{ start = [2, 2], goal = [5, 5] }]\n"
FORMATION = CELLS + "formation = { rows = 2, columns = 1, start = [4, 4], goal = [9, 9] }\n"
# Values without a default, and those that others have to agree with.
NEEDED = {
    "lattice": {"spacing_m": 1},
    "goal_flock": {"min_distance_m": 0.001},
    "boids": {"crowded_m": 1, "closest_m": 5},
    "push_out": {"min_distance_m": 1},
}
FIELD = re.compile(r"^(plane|grid)\.(\w+)\.(\w+): ([^,;]+)(?:, (-?[\d.]+) to (-?[\d.]+|inf)\b[^,;]*)?((?:, \"\w+\")*)")
LAYERS = {"orca": "orca", "template_2k": "orca", "fly": "orca", "push_out": "push_out"}


def fields(top):
    """Place, table, row, kind, ends and words of each value of a law or a layer."""
    for line in (top / "tests/golden/scenario-fields.txt").read_text().splitlines():
        found = FIELD.match(line)
        if found and (found[2] in typing.get_args(Law) or found[2] in ("orca", "push_out")):
            place, table, row, kind, least, most, words = found.groups()
            ends = None if least is None else (float(least), float(most))
            yield place, table, row, kind, ends, re.findall(r"\w+", words)


def text_of(place, table):
    if place == "plane":
        return PLANE
    return FORMATION if table.startswith("formation") else ROUTE


def toml(value):
    if isinstance(value, str):
        return f'"{value}"'
    return str(value).lower() if isinstance(value, (bool, float)) else str(value)


def plain(error):
    """An error without its place in a file."""
    text = re.sub(r"^\S*:\d+:\d+: ", "", str(error))
    return text.replace(" (by an argument)", "")


def refused(make):
    try:
        make()
    except ValueError as error:
        return plain(error)
    return None


def by_file(text, place, kind, name, table, values):
    """The error of the reader of files about a law or a layer with these values."""
    inside = ", ".join(f"{row} = {toml(value)}" for row, value in values.items())
    lines = f'{kind} = "{name}"\n{table} = {{ {inside} }}\n'
    text = text + lines if place == "plane" else text.replace("[terrain]", f"[grid]\n{lines}[terrain]")
    return refused(lambda: staya.Simulation.from_text(text))


def by_name(text, kind, name, values):
    return refused(lambda: staya.Simulation.from_text(text, **{kind: name}, **values))


def tried(kind, ends, words):
    """Values at and beyond the ends, of other types, and unknown words."""
    if ends is not None:
        least, most = ends
        outer = [np.nextafter(least, -np.inf), least - 1]
        if np.isfinite(most):
            outer += [np.nextafter(most, np.inf), 2 * most + 1]
        return [least, min(most, 1e30)], [*outer, np.nan, -np.inf, "word", True]
    if words:
        return words, ["wrod", words[0][:-1], 1.0, True]
    return [True, False], [1.0, "true"]


def test_each_value_is_refused_by_name_as_in_a_file(top):
    good = bad = 0
    tables = set()
    for place, table, row, kind, ends, words in fields(top):
        names = [(kind, name) for name in LAYERS if LAYERS[name] == table for kind in ["safety"]] or [("law", table)]
        for choice, name in names:
            text, needed = text_of(place, table), NEEDED.get(table, {})
            inner, outer = tried(kind, ends, words)
            for value in [*inner, *outer]:
                values = {**needed, row: value if isinstance(value, (str, bool)) else float(value)}
                named, wanted = by_name(text, choice, name, values), by_file(text, place, choice, name, table, values)
                assert named == wanted, (name, row, value)
                if value in inner:
                    assert named is None or "out of range" not in named, (name, row, value, named)
                    good += named is None
                else:
                    assert named is not None, (name, row, value)
                    bad += 1
            tables.add((place, name))
    assert good > 150 and bad > 600 and len(tables) >= 12, (good, bad, sorted(tables))


def test_each_law_and_each_layer_can_be_named(top):
    alone = {"formation": FORMATION, "formation_paper": FORMATION, "formation_lookahead": FORMATION, "route": ROUTE}
    for law in typing.get_args(Law):
        text = alone.get(law, ROUTE if law == "negotiation" else PLANE)
        sim = staya.Simulation.from_text(text, law=law, **NEEDED.get(law, {}))
        sim.step(2)
    for layer in typing.get_args(Layer):
        staya.Simulation.from_text(PLANE, safety=layer, **NEEDED.get(layer, {})).step(2)


def test_values_by_name_make_the_run_of_a_file(scenario):
    named = staya.Simulation(scenario("swap-circle"), law="goal_flock", min_distance_m=0.4, k2=0.1, ticks=60).run()
    text = scenario("swap-circle").read_text()
    written = text.replace("[plane]\n", '[plane]\nlaw = "goal_flock"\ngoal_flock = { min_distance_m = 0.4, k2 = 0.1 }\n')
    assert written != text
    assert named.trace_hash == staya.Simulation.from_text(written, ticks=60).run().trace_hash
    assert named.trace_hash != staya.Simulation(scenario("swap-circle"), ticks=60).run().trace_hash
    longer = staya.Simulation(scenario("swap-circle"), safety="orca", horizon_s=3.0, ticks=60).run()
    dotted = staya.Simulation(scenario("swap-circle"), plane__orca__horizon_s=3.0, ticks=60).run()
    assert longer.trace_hash == dotted.trace_hash


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"law": "goal_flok", "k1": 1}, 'plane.law: this program has no law "goal_flok"; did you mean "goal_flock"'),
        ({"safety": "orka"}, "plane.safety: unknown value `orka`; did you mean `orca`"),
        ({"law": "goal_flock", "k11": 1}, "plane.goal_flock.k11: unknown field `k11`; did you mean `k1`"),
        ({"law": "lattice", "spacing": 1}, "plane.lattice.spacing: .*the field is called `spacing_m` now"),
        ({"law": "lattice"}, 'the law "lattice" needs `spacing_m`: .*; give spacing_m, 0.01 to 100 metres'),
        (
            {"law": "goal_flock", "safety": "push_out", "min_distance_m": 1},
            "give plane.goal_flock.min_distance_m and plane.push_out.min_distance_m",
        ),
        ({"law": 3}, "law is 3; give a name in quotes"),
        ({"k1": 1}, "unknown field `k1`"),
    ],
)
def test_wrong_names_are_refused_with_the_right_one(arguments, message):
    with pytest.raises(ValueError) as error:
        staya.Simulation.from_text(PLANE, **arguments)
    assert re.search(message, plain(error.value)), error.value


# Behaviours alone, with the table of files that has the same rows.
PLACES = np.array([[0.0, 0.0], [1.0, 0.5]])
MOVES = {"radii": 0.2, "max_speeds": 1.0, "step_s": 0.1}
LAND = np.ones((4, 4), dtype=np.uint8)
ALONE = [
    ("plane", "law", "lattice", lambda **given: flock.lattice(PLACES, PLACES, reference=[1, 1], **given)),
    ("plane", "law", "goal_flock", lambda **given: flock.goal(PLACES, PLACES, step_s=0.1, speed_mps=1, **given)),
    ("plane", "law", "boids", lambda **given: flock.boids(PLACES, PLACES, **given)),
    ("grid", "law", "route", lambda **given: staya.route(LAND, [[0, 0]], [[3, 3]], **given)),
    ("plane", "safety", "orca", lambda **given: staya.orca(PLACES, PLACES, PLACES, **MOVES, **given)),
]
# Of a run, not of a step.
OF_RUNS = {"tolerance_m", "inflation_mps", "inflation_m", "model"}
OF_RUNS |= {"stands_after_s", "listen_s", "expects_others", "alone_mps"}


@pytest.mark.parametrize(("place", "choice", "name", "call"), ALONE, ids=[name for _, _, name, _ in ALONE])
def test_behaviours_refuse_what_files_refuse_in_the_same_words(top, place, choice, name, call):
    rows = [field for field in fields(top) if field[:2] == (place, name) and field[2] not in OF_RUNS]
    text, needed, tries = text_of(place, name), NEEDED.get(name, {}), 0
    for _, _, row, kind, ends, words in rows:
        inner, outer = tried(kind, ends, words)
        for value in [*inner, *outer]:
            values = {**needed, row: value}
            wanted = by_file(text, place, choice, name, name, values)
            alone = refused(lambda: call(**values))
            if row == "downwash":
                assert "unknown field `downwash`" in alone
                continue
            assert alone == (wanted and wanted.replace(f"{place}.{name}.", "")).replace("scenarios/README.md lists all fields", "help(staya.settings) lists all fields") if wanted else alone is None, (row, value, alone, wanted)
            tries += 1
    assert tries > 20
    wrong = refused(lambda: call(**needed, **{rows[0][2] + "x": 1}))
    assert f"unknown field `{rows[0][2]}x`; did you mean `{rows[0][2]}`?" in wrong


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: staya.Orca(3, lean_rad=1.6), "lean_rad: 1.6 is out of range; give 0 to 1.5 radians"),
        (lambda: staya.Orca(3, horizon_s=0.001), "horizon_s: 0.001 is out of range; give 0.01 to 60 seconds"),
        (lambda: staya.Orca(3, horizon_s=np.nan), "horizon_s: NaN is out of range"),
        (lambda: staya.Orca(3, horizon_s=None), "horizon_s is None; give a number"),
        (lambda: staya.Orca(3, margin=0.1), "the field is called `margin_m` now"),
        (lambda: staya.Orca(3, downwash=2), "unknown field `downwash`"),
        (lambda: staya.Orca(3, in_space=True, downwash=0.5), "downwash: 0.5 is out of range; give 1 to 10"),
        (lambda: flock.goal(PLACES, PLACES, step_s=1, min_distance_m=1), "missing `speed_mps`: .*; give 0 to 32 m/s"),
        (lambda: flock.goal(PLACES, PLACES, step_s=1, speed=1), "the field is called `speed_mps` now"),
        (lambda: flock.goal(PLACES, PLACES, step_s=1, center_gain=1), "the field is called `k2` now"),
        (lambda: flock.lattice(PLACES, PLACES, alpha=1), "the field is called `c1_alpha` now"),
        (
            lambda: flock.lattice(PLACES, PLACES, spacing_m=1, goal_rest_m=1),
            "goal_rest_m: a goal that moves gives no rest; give goal_moves = false",
        ),
        (lambda: flock.boids(PLACES, PLACES, crowded=1, closest_m=1), "the field is called `crowded_m` now"),
        (lambda: staya.route(LAND, [[0, 0]], [[3, 3]], replan="never"), "replan: unknown value `never`"),
        (lambda: staya.route(LAND, [[0, 0]], [[3, 3]], radius=2.5), "radius: 2.5 is not a whole number; give 3"),
    ],
)
def test_errors_of_settings_name_field_cause_and_remedy(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_settings_of_behaviours_have_an_effect():
    places, still = np.array([[0.0, 0.0], [0.9, 0.1]]), np.zeros((2, 2))
    pulls = [
        flock.lattice(places, still, reference=[5, 0], reference_velocity=[1, 0], spacing_m=1, **more)
        for more in [{}, {"c1_alpha": 2.0}, {"takes_turns": True}, {"algorithm": 2}, {"goal_moves": False}]
    ]
    assert all((pulls[0] != other).any() for other in pulls[1:4]) and (pulls[0] == pulls[4]).all()
    behind = [
        flock.lattice(places, still, reference=[-5, 0], reference_velocity=[1, 0], spacing_m=1, **more)
        for more in [{}, {"goal_moves": False, "goal_rest_m": 10}]
    ]
    assert (behind[0] != behind[1]).all(axis=0).any()
    land = np.ones((30, 30), dtype=np.uint8)
    shuffled = [
        staya.route(land, [[2, 2]], [[25, 20]], halved_per_ticks=4, seed=seed).paths[0].tolist() for seed in (1, 1, 2)
    ]
    assert shuffled[0] == shuffled[1] != shuffled[2]
    assert staya.route(land, [[2, 2]], [[25, 20]], replan="until_changed").arrived[0]


def test_the_help_has_each_setting():
    for of in (staya.settings.Orca, staya.settings.Lattice, staya.settings.Goal, staya.settings.Boids, staya.settings.Route):
        names = re.findall(r"- `(\w+)`", of.__doc__)
        assert names == list(of.__annotations__) and len(names) > 3
