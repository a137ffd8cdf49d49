"""POGEMA's instances as files of the simulator: for each table a folder with Moving AI maps and
their starts and goals, and a plan for `staya sweep`.

By hand: `python tests/pogema/instances.py`, then `staya sweep target/pogema/random.toml`.
"""

from __future__ import annotations

import csv
import json
import sys
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from pogema.grid import Grid
from referee import COUNTS, MAPS, config

# Robots and shares of lost packets.
POINTS = [(robots, 0.0) for robots in COUNTS] + [(64, lost) for lost in (0.1, 0.3, 0.6)]
STEPS = 128

# A run ends when all robots are on their goals and stay there for a tick: the last move of POGEMA's
# 128 steps, and that tick. The radio reaches eight cells along both axes.
SCENARIO = f"""name = "pogema"
ticks = {STEPS + 1}
terrain.file = "random/0.map"
robots.scen = {{ file = "random/0.scen", count = {max(COUNTS)} }}
grid = {{ moves = 4, simultaneous = true, law = "negotiation" }}
radio.range_m = 11.4
"""

PLAN = """name = "pogema-{maps}"
scenario = "scenario.toml"
measures = ["arrived", "arrival_mean_seconds", "arrival_last_seconds", "collisions"]
[[zip]]
robots.scen.count = {counts}
radio.loss = {losses}
[[zip]]
terrain.file = {terrains}
robots.scen.file = {scens}
"""


def write(folder: Path, maps: str, numbers: Iterable[int]) -> None:
    """Writes instances `folder/maps/N.map` and `.scen`, and the scenario that runs them."""
    (folder / maps).mkdir(parents=True, exist_ok=True)
    (folder / "scenario.toml").write_text(SCENARIO)
    for number in numbers:
        grid = Grid(config(maps, number, max(COUNTS)), add_artificial_border=False)
        height, width = grid.obstacles.shape
        rows = ["".join("@" if cell else "." for cell in row) for row in grid.obstacles]
        header = f"type octile\nheight {height}\nwidth {width}\nmap\n"
        (folder / maps / f"{number}.map").write_text(header + "\n".join(rows) + "\n")
        # Shortest lengths are not computed: 0.
        ends = zip(grid.starts_xy, grid.finishes_xy, strict=True)
        queries = [f"0 {number}.map {width} {height} {x} {y} {to_x} {to_y} 0\n" for (y, x), (to_y, to_x) in ends]
        (folder / maps / f"{number}.scen").write_text("version 1\n" + "".join(queries))


def plan(folder: Path, maps: str, numbers: Iterable[int], points: list[tuple[int, float]] = POINTS) -> Path:
    """Writes instances, and a plan that runs each of them at these points."""
    write(folder, maps, numbers)
    terrains, scens = ([f"{maps}/{number}.{kind}" for number in numbers] for kind in ("map", "scen"))
    counts, losses = zip(*points, strict=True)
    fields = {"counts": counts, "losses": losses, "terrains": terrains, "scens": scens}
    # A list of strings or numbers is the same in JSON and in TOML.
    path = folder / f"{maps}.toml"
    path.write_text(PLAN.format(maps=maps, **{name: json.dumps(values) for name, values in fields.items()}))
    return path


def metrics(rows: Path) -> dict[tuple[int, float], dict[str, float]]:
    """POGEMA's metrics, from the rows of a sweep, by robots and loss."""
    points = defaultdict(list)
    with rows.open(newline="") as file:
        for row in csv.DictReader(file):
            robots, arrived = int(row["robots.scen.count"]), int(row["arrived"])
            assert int(row["collisions"]) == 0, row
            arrivals = arrived * float(row["arrival_mean_seconds"] or 0)
            cost = arrivals + STEPS * (robots - arrived)
            points[robots, float(row["radio.loss"])].append([arrived == robots, arrived / robots, cost])
    names = ("CSR", "ISR", "SoC")
    return {point: dict(zip(names, np.mean(values, axis=0), strict=True)) for point, values in points.items()}


if __name__ == "__main__":
    target = Path(sys.argv[1] if len(sys.argv) > 1 else "target/pogema")
    for table in ("random", "mazes"):
        plan(target, table, range(MAPS))
