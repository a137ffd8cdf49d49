"""Discs that negotiate in the mazes and forests of DLSC-GC, read from a clone of github.com/qwerty35/dlsc_gc_planner.

    STAYA=target/release/staya python tests/python/dlsc.py CLONE dense|sparse|forest [--loss 0.3] [--seeds 11,12] [--restarts 3]

Ten discs of 0.15 m at 1 m/s and 2 m/s^2 in cells of 0.5 m, radio range 3 m, at most 120 s. With --restarts, three of them at
random are down for that many seconds, from a second between the second and the twelfth. Prints each run that is not complete,
and for all of them how many are complete, the mean and greatest time of the last arrival, and the least gap of two discs.
"""

import argparse
import csv
import json
import math
import os
import random
import subprocess
import tempfile
from pathlib import Path

CELL_M = 0.5
RADIUS_M = 0.15
# Room for the curves of a disc between the blocks of a forest.
MARGIN_M = 0.02
SCENARIO = """name = "dlsc"
ticks = 2400
tick_s = 0.05
terrain = {{ file = "maze.map", cell_m = {cell_m} }}
radio = {{ range_m = 3, loss = {loss} }}
robots.list = [{robots}]
[plane]
radius_m = {radius_m}
max_speed_mps = 1
max_acceleration_mps2 = 2
tolerance_m = 0.1
law = "negotiation"
orca = {{ horizon_s = 1, wall_horizon_s = 0.3, alone_mps = 1 }}
{walls}"""
MISSIONS = {
    "dense": ("maze10_dense/maze10", "maze_icra2023/dense/maze"),
    "sparse": ("maze10_sparse/maze10", "maze_icra2023/sparse/maze"),
    "forest": ("forest10/forest10", "forest_icra2023/forest"),
}


def write(folder: Path, mission: Path, world: Path, loss: float, is_forest: bool) -> Path:
    """Writes a mission as scenario and map.

    In a maze, the cells whose centres blocks cover are walls. In a forest, blocks are polygons between cells, and cells are
    closed in whose centres a disc would be too near to a block.
    """
    read = json.loads(mission.read_text())
    west, south, _, east, north, _ = read["world"][0]["dimension"]
    # Cells in which a disc keeps within the world.
    first = [math.ceil((low + RADIUS_M) / CELL_M - 1e-9) for low in (west, south)]
    last = [math.floor((high - RADIUS_M) / CELL_M + 1e-9) for high in (east, north)]

    def cell(place: list[float]) -> tuple[int, ...]:
        cells = [place[axis] / CELL_M for axis in range(2)]
        assert all(abs(at - round(at)) < 1e-6 for at in cells), f"{mission}: {place} is between cells"
        return tuple(round(at) - low for at, low in zip(cells, first, strict=True))

    with world.open(newline="") as file:
        blocks = [[float(number) for number in row] for row in csv.reader(file)]

    def is_blocked(*cell: int) -> bool:
        center = [(low + at) * CELL_M for low, at in zip(first, cell, strict=True)]
        away_m = (math.hypot(*(max(0, abs(center[a] - block[a]) - block[a + 3] / 2) for a in range(2))) for block in blocks)
        return min(away_m) < (RADIUS_M + MARGIN_M if is_forest else 1e-9)

    def polygon(block: list[float]) -> str:
        # A cell's centre is half a cell from its corner.
        x, y = (block[a] - (first[a] - 0.5) * CELL_M for a in range(2))
        corners = [[x + sx * block[3] / 2, y + sy * block[4] / 2] for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        return f"[[plane.wall]]\nclosed = true\npoints_m = {corners}\n"

    width, height = (high - low + 1 for low, high in zip(first, last, strict=True))
    rows = ["".join("@" if is_blocked(x, y) else "." for x in range(width)) for y in reversed(range(height))]
    header = f"type octile\nheight {height}\nwidth {width}\nmap\n"
    (folder / "maze.map").write_text(header + "\n".join(rows) + "\n")
    ends = [[list(cell(agent[end])) for end in ("start", "goal")] for agent in read["agents"]]
    robots = ", ".join(f"{{ start = {start}, goal = {goal} }}" for start, goal in ends)
    scenario = folder / "dlsc.toml"
    walls = "".join(map(polygon, blocks)) if is_forest else ""
    scenario.write_text(SCENARIO.format(cell_m=CELL_M, radius_m=RADIUS_M, loss=loss, robots=robots, walls=walls))
    return scenario


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("clone", type=Path)
    parser.add_argument("kind", choices=MISSIONS)
    parser.add_argument("--loss", type=float, default=0)
    parser.add_argument("--restarts", type=float, help="seconds")
    parser.add_argument("--seeds", default="11,12,13")
    given = parser.parse_args()
    staya = os.environ.get("STAYA", "target/release/staya")
    lasts, gaps, runs = [], [], 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for number in range(1, 31):
            mission, world = MISSIONS[given.kind]
            mission = given.clone / f"missions/{mission}_{number}.json"
            world = given.clone / f"world/{world}{number}.csv"
            scenario = write(folder, mission, world, given.loss, given.kind == "forest")
            text = scenario.read_text()
            for seed in given.seeds.split(","):
                if given.restarts is not None:
                    chance = random.Random(f"{number} {seed}")
                    faults = [(chance.randint(1, 10), chance.randint(2, 12)) for _ in range(3)]
                    table = "[[fault]]\nrobot = {}\nat_s = {}\ndown_s = {}\n"
                    scenario.write_text(text + "\n" + "".join(table.format(*fault, given.restarts) for fault in faults))
                command = [staya, "run", scenario, "--seed", seed, "--json", "-q", "--out", folder / "out"]
                said = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
                runs += 1
                gaps.append(said["least_gap_m"])
                if said["arrived"] == said["robots"] and said["collisions"] == 0:
                    lasts.append(said["arrival_last_seconds"])
                    if number == 1:
                        print(f"mission 1, seed {seed}: {lasts[-1]:.1f} s")
                else:
                    print(f"mission {number}, seed {seed}: {said['arrived']} arrive, {said['collisions']} collisions")
    print(
        f"{len(lasts)} of {runs} complete, last arrival {sum(lasts) / len(lasts):.1f} s, at most {max(lasts):.1f} s, "
        f"least gap {min(gaps) * 1000:.1f} mm"
    )


if __name__ == "__main__":
    main()
