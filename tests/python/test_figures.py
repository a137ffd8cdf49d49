"""`cargo xtask figures` compares figures of runs before and after a change."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2] / "xtask"))
from figures import compare  # noqa: E402

LOST = {("s", "packets.lost"): ["5", "6", "7"]}


def rows(arrived, hashes):
    return {("s", "arrived"): arrived, ("s", "trace_hash"): hashes}


BEFORE = rows(["9", "9", "10"], ["a", "b", "c"])
NEAR = rows(["10", "9", "9"], ["x", "y", "z"])
FAR = rows(["1", "1", "2"], ["x", "y", "z"])


def test_without_loss_figures_are_equal():
    assert compare(BEFORE, BEFORE) is None
    assert "differ" in compare(BEFORE, NEAR)


def test_with_loss_nineteen_in_twenty_are_within_their_intervals():
    assert compare(BEFORE | LOST, NEAR | LOST) is None
    assert compare(BEFORE | LOST, FAR | LOST) is None, "one figure may be beyond"
    assert "differ" in compare(BEFORE | LOST, LOST), "a figure is missing"
    many = [{("s", f"figure{n}"): [value, value, end] for n in range(3)} | LOST for value, end in [("9", "8"), ("1", "2")]]
    assert "beyond" in compare(*many)


def test_a_part_of_an_experiment_can_lose_packets():
    part = {("e", "points[4].loss"): ["0.3"] * 3}
    before = part | {("e", "points[4].time"): ["1", "2", "3"]}
    assert compare(before, part | {("e", "points[4].time"): ["2", "2", "3"]}) is None
