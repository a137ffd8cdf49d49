"""Staya's robots in POGEMA's world, on the instances of its published tables, which its packages
generate bit for bit (A. Skrynnik and others 2025, "POGEMA: A benchmark platform for cooperative
multi-agent pathfinding")."""

from __future__ import annotations

import multiprocessing
import warnings
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache

import numpy as np
import staya
from pogema import GridConfig, pogema_v0
from pogema_toolbox.generators.maze_generator import MazeGenerator, MazeRangeSettings
from pogema_toolbox.generators.random_generator import MapRangeSettings, generate_map

warnings.simplefilter("ignore")

MAPS = 128
COUNTS = (8, 16, 24, 32, 48, 64)
# POGEMA's actions for moves (x, y): its first coordinate is our y.
ACTIONS = {(0, 0): 0, (0, -1): 1, (0, 1): 2, (-1, 0): 3, (1, 0): 4}
RANGE = 8


@dataclass(frozen=True)
class Case:
    """A row of a table."""

    maps: str  # "random" or "mazes"
    robots: int
    lost: float = 0.0  # share of lost packets
    sensing: str = "nothing"
    lifelong: bool = False


@cache
def land(maps: str, number: int) -> str:
    if maps == "random":
        return generate_map(MapRangeSettings().sample(number))
    sizes = MazeRangeSettings(width_min=17, width_max=21, height_min=17, height_max=21)
    return MazeGenerator.generate_maze(**sizes.sample(number))


def config(maps: str, number: int, robots: int, lifelong: bool = False) -> GridConfig:
    """An instance."""
    return GridConfig(
        map=land(maps, number),
        seed=0,
        num_agents=robots,
        obs_radius=5,
        on_target="restart" if lifelong else "nothing",
        collision_system="soft",
        max_episode_steps=256 if lifelong and maps == "random" else 128,
        observation_type="MAPF",
    )


def play(case: Case, number: int, first_id: int = 1) -> dict[str, float]:
    """Runs one instance. Returns POGEMA's metrics."""
    world = pogema_v0(config(case.maps, number, case.robots, case.lifelong))
    seen, _ = world.reset()
    cells, goals = places(seen)
    robots = staya.Negotiation(cells, ids=np.arange(first_id, first_id + case.robots))
    random = np.random.default_rng([number, case.robots])
    while True:
        # A robot knows what it sees and hears: nothing else of POGEMA's answer is used.
        sights = np.array([one["obstacles"] for one in seen])
        far = np.abs(cells[:, None] - cells[None]).max(axis=2)
        beacons, reports = (received(far, case.lost, random) for _ in range(2))
        moves = robots(cells, goals, sights, beacons=beacons, reports=reports, sensing=case.sensing)
        seen, _, ended, stopped, infos = world.step([ACTIONS[x, y] for x, y in moves.tolist()])
        if all(ended) or all(stopped):
            return infos[0]["metrics"]
        cells, goals = places(seen)


def processes() -> ProcessPoolExecutor:
    """A copy of a process that has run robots would wait for threads that it does not have."""
    return ProcessPoolExecutor(mp_context=multiprocessing.get_context("spawn"))


def received(far: np.ndarray, lost: float, random: np.random.Generator) -> np.ndarray:
    return (far <= RANGE) & (random.random(far.shape) >= lost)


def places(seen: list[dict]) -> tuple[np.ndarray, np.ndarray]:
    def of(name: str) -> np.ndarray:
        return np.array([one[name][::-1] for one in seen], dtype=np.int64)

    return of("global_xy"), of("global_target_xy")
