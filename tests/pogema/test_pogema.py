"""Robots that negotiate, in POGEMA's world. The long tests run all maps of its tables; no parameter
was chosen on those."""

import csv
import os
from pathlib import Path

import numpy as np
import pytest
from referee import COUNTS, MAPS, Case, play, processes

FIELDS = ["maps", "robots", "lost", "sensing", "lifelong", "instances", "CSR", "ISR", "SoC", "avg_throughput"]


def table(case, numbers):
    """Runs the instances of a row, and adds it to target/pogema.csv."""
    with processes() as pool:
        results = list(pool.map(play, [case] * len(numbers), numbers))
    means = {name: float(np.mean([result[name] for result in results])) for name in results[0]}
    if target := os.environ.get("STAYA_TABLES"):
        file = Path(target) / "pogema.csv"
        is_new = not file.exists()
        with file.open("a", newline="") as out:
            rows = csv.DictWriter(out, FIELDS, extrasaction="ignore", restval="")
            if is_new:
                rows.writeheader()
            rows.writerow(vars(case) | means | {"instances": len(numbers)})
    print(case, means)
    return means


@pytest.mark.parametrize(("maps", "least"), [("random", 1.0), ("mazes", 0.75)])
def test_64_robots_arrive_on_a_few_maps_though_a_third_of_the_packets_is_lost(maps, least):
    assert table(Case(maps, 64, lost=0.3), range(4))["CSR"] >= least


def test_robots_with_new_goals_keep_reaching_them():
    assert table(Case("random", 32, lifelong=True), range(2))["avg_throughput"] > 2.5


def test_a_run_repeats():
    case = Case("mazes", 16, lost=0.5)
    assert play(case, 3) == play(case, 3)


@pytest.mark.long
@pytest.mark.parametrize("robots", COUNTS)
@pytest.mark.parametrize("maps", ["random", "mazes"])
def test_all_maps(maps, robots):
    least = {("random", 64): 0.98, ("mazes", 64): 0.83}
    assert table(Case(maps, robots), range(MAPS))["CSR"] >= least.get((maps, robots), 0.94)


@pytest.mark.long
@pytest.mark.parametrize(("lost", "random", "mazes"), [(0.1, 0.96, 0.82), (0.3, 0.93, 0.75), (0.6, 0.75, 0.40)])
def test_all_maps_by_radio_alone_with_loss(lost, random, mazes):
    for maps, least in [("random", random), ("mazes", mazes)]:
        assert table(Case(maps, 64, lost=lost), range(MAPS))["CSR"] >= least


@pytest.mark.long
@pytest.mark.parametrize(("lost", "mazes"), [(0.1, 0.84), (0.3, 0.84), (0.6, 0.80)])
def test_all_maps_with_sensed_robots_and_loss(lost, mazes):
    for maps, least in [("random", 0.96), ("mazes", mazes)]:
        assert table(Case(maps, 64, lost=lost, sensing="robots"), range(MAPS))["CSR"] >= least


@pytest.mark.long
@pytest.mark.parametrize(("maps", "least"), [("random", 1.8), ("mazes", 1.0)])
def test_throughput_with_new_goals(maps, least):
    rows = [table(Case(maps, robots, lifelong=True), range(MAPS)) for robots in COUNTS]
    assert np.mean([row["avg_throughput"] for row in rows]) >= least
