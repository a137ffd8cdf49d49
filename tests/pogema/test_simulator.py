"""The simulator with POGEMA's moves: POGEMA's positions, and negotiation on its instances."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from instances import POINTS, SCENARIO, metrics, plan, write
from pogema import pogema_v0
from referee import ACTIONS, MAPS, config, processes
from staya._staya import GridBodies

MOVES = np.array(sorted(ACTIONS, key=ACTIONS.get), dtype=np.int16)


def walk(folder: Path, maps: str, number: int, steps: int, scenario: str = SCENARIO) -> None:
    """Moves 64 robots at random, also into walls and each other, in POGEMA and in the simulator."""
    write(folder, maps, [number])
    file = folder / f"{maps}-{number}.toml"
    file.write_text(scenario.replace("random/0", f"{maps}/{number}"))
    bodies = GridBodies(file)
    world = pogema_v0(config(maps, number, 64)).unwrapped
    world.reset()
    top = len(world.get_obstacles(ignore_borders=True)) - 1
    random = np.random.default_rng(number)
    for step in range(steps):
        actions = random.integers(len(MOVES), size=64)
        # POGEMA's rows count from the north.
        cells = bodies.step(MOVES[actions] * np.int16([1, -1]))
        world.move_agents(actions.tolist())
        expected = [[column, top - row] for row, column in world.get_agents_xy(ignore_borders=True)]
        assert cells.tolist() == expected, f"{maps} {number}, step {step}"


def test_robots_move_as_in_pogema(tmp_path):
    for number in range(16):
        walk(tmp_path, "random", number, 100)
        walk(tmp_path, "mazes", number, 100)


def test_robots_that_move_in_turn_move_otherwise(tmp_path):
    with pytest.raises(AssertionError, match="random 0, step 0"):
        walk(tmp_path, "random", 0, 1, SCENARIO.replace(", simultaneous = true", ""))


def sweep(folder: Path, maps: str, numbers: range, points: list[tuple[int, float]]) -> dict:
    """Runs instances in the simulator. Returns POGEMA's metrics by robots and loss."""
    out = folder / f"{maps}-rows"
    file = plan(folder, maps, numbers, points)
    command = [os.environ["STAYA"], "sweep", file, "--out", out, "--restart"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    rates = metrics(out / "rows.csv")
    print(maps, rates)
    return rates


@pytest.mark.parametrize("maps", ["random", "mazes"])
def test_16_robots_arrive_in_the_simulator(tmp_path, maps):
    assert sweep(tmp_path, maps, range(4), [(16, 0.0)])[16, 0.0]["CSR"] == 1


@pytest.mark.long
@pytest.mark.parametrize("maps", ["random", "mazes"])
def test_all_maps_in_the_simulator(maps):
    folder = Path(os.environ["STAYA_TABLES"]) / "pogema"
    rates = sweep(folder, maps, range(MAPS), POINTS)
    assert rates[16, 0.0]["CSR"] >= 0.98


@pytest.mark.long
def test_robots_move_as_in_pogema_in_a_million_steps(tmp_path):
    steps = 10**6 // (2 * MAPS) + 1
    with processes() as pool:
        walks = [pool.submit(walk, tmp_path, maps, n, steps) for maps in ("random", "mazes") for n in range(MAPS)]
        for one in walks:
            one.result()
