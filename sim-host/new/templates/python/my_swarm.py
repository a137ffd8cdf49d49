"""The guidance law of my-swarm: the preferred velocity of each robot, once per tick. The safety layers avoid collisions."""

from pathlib import Path

import numpy as np
import staya

SCENARIO = Path(__file__).parent / "scenario.toml"
SPEED_MPS = 0.5
# Distance to another robot, from centre to centre, below which the speed is halved, metres.
CAREFUL_M = 0.6
# Distance from the goal at which a robot has arrived, metres.
NEAR_M = 0.02


def law(sim: staya.Simulation) -> tuple[np.ndarray, np.ndarray]:
    """Straight to the goal, slower near other robots. Write your own law here.

    Returns velocities in m/s, shape (robots, 2), and for each robot whether it has arrived.
    """
    places = sim.positions[:, :2]
    way = sim.goals[:, :2] - places
    distance = np.linalg.norm(way, axis=1, keepdims=True)
    gaps = np.linalg.norm(places[:, None] - places[None], axis=2)
    np.fill_diagonal(gaps, np.inf)
    speed = np.where(gaps.min(axis=1, keepdims=True) < CAREFUL_M, SPEED_MPS / 2, SPEED_MPS)
    # Slows down over the last half second.
    velocities = way / np.maximum(distance, 1e-9) * np.minimum(speed, 2 * distance)
    return velocities, distance[:, 0] < NEAR_M


def run(sim: staya.Simulation) -> dict:
    """Runs until all robots have arrived or the scenario's ticks are over. Returns the summary of the run."""
    return sim.run(guidance=law).summary
