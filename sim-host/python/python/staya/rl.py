"""Environments for reinforcement learning with any scenario in the plane or in space whose robots
have goals; needs the extra `rl`.

`SwarmEnv` is a Gymnasium environment in which one agent controls all robots, `SwarmVectorEnv` runs
many of these at once, and `RobotsEnv` is a PettingZoo parallel environment with one agent per
robot. Actions are preferred velocities: the collision avoidance and radio of each robot stay in
effect.

- Action: a velocity per robot, each component from -1 to 1 times the robot's highest speed.
- Observation per robot: its velocity over its highest speed, the vector to its goal over 10 m, then
  for each of the `neighbors` nearest robots the vector to it over 10 m and its velocity over the
  own highest speed. All values are clipped to -1 to 1, and 0 for missing neighbours. Positions are
  exact, not those received by radio.
- Reward per robot: the approach to its goal over the distance that it can move in a step, and -1
  for an overlap with another robot.
- A robot is done within `tolerance` metres of its goal, and then stops.
"""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import gymnasium
import numpy as np
import pettingzoo
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from . import _check
from .simulation import Simulation

Floats = NDArray[np.float32]
_FAR_M = 10.0


class _Swarm:
    """A scenario that can be restarted, with its state as numbers per robot."""

    def __init__(
        self, scenario: str | os.PathLike[str], neighbors: int, ticks_per_step: int, tolerance: float, fields: Any
    ) -> None:
        self._scenario, self._fields = scenario, fields
        self._neighbors = _check.whole("neighbors", neighbors, 0, 1000)
        self._ticks_per_step = _check.whole("ticks_per_step", ticks_per_step, 1)
        self._tolerance = _check.number("tolerance", tolerance, 0.0, above=True)
        self.begin(None)
        if not (np.isfinite(self.sim.goals).all() and np.isfinite(self.sim.max_speeds).all()):
            raise ValueError(
                "scenario has robots without a goal, or without [plane]; give one in which all robots have goals"
            )

    def begin(self, seed: int | None) -> None:
        """Restarts the run."""
        self.sim = Simulation(self._scenario, seed=seed, **self._fields)
        places = np.concatenate([self.sim.positions, self.sim.goals])
        self.axes = 3 if (places[:, 2] != 0).any() else 2
        self.done = np.zeros(len(self.sim), dtype=np.bool_)
        self._look()

    def _look(self) -> None:
        self._way = (self.sim.goals - self.sim.positions)[:, : self.axes]
        self._distance = np.linalg.norm(self._way, axis=1)
        places = self.sim.positions[:, : self.axes]
        self._offsets = places[None, :, :] - places[:, None, :]
        self._apart = np.linalg.norm(self._offsets, axis=2)
        np.fill_diagonal(self._apart, np.inf)

    @property
    def width(self) -> int:
        """Length of one robot's observation."""
        return self.axes * (2 + 2 * self._neighbors)

    def observe(self) -> Floats:
        """Observations of shape (n, width)."""
        sim, axes = self.sim, self.axes
        count, most = len(sim), min(self._neighbors, len(sim) - 1)
        top = sim.max_speeds[:, None]
        velocities = sim.velocities[:, :axes]
        seen = np.zeros((count, self.width), dtype=np.float32)
        seen[:, :axes] = velocities / top
        seen[:, axes : 2 * axes] = self._way / _FAR_M
        if most > 0:
            nearest = np.argsort(self._apart, axis=1, kind="stable")[:, :most]
            ways = np.take_along_axis(self._offsets, nearest[:, :, None], axis=1) / _FAR_M
            both = np.concatenate([ways, velocities[nearest] / top[:, :, None]], axis=2)
            seen[:, 2 * axes : 2 * axes + 2 * axes * most] = both.reshape(count, -1)
        return np.clip(seen, -1.0, 1.0, out=seen)

    def act(self, actions: NDArray[Any]) -> NDArray[np.float64]:
        """Does a step. Returns the rewards, shape (n,); robots that are done stop and get 0."""
        sim, was_done, before = self.sim, self.done, self._distance
        wishes = np.clip(actions, -1.0, 1.0) * sim.max_speeds[:, None]
        wishes = np.where(was_done[:, None], 0.0, wishes)
        sim.wish(wishes)
        sim.step(self._ticks_per_step)
        self._look()
        reach = sim.max_speeds * sim.tick_s * self._ticks_per_step
        overlaps = (self._apart < sim.radii[:, None] + sim.radii[None, :]).any(axis=1)
        rewards = (before - self._distance) / reach - overlaps
        self.done = was_done | (self._distance <= self._tolerance)
        return np.where(was_done, 0.0, rewards)

    @property
    def is_out_of_time(self) -> bool:
        """Whether the scenario's ticks are used up."""
        return self.sim.tick >= self.sim.ticks


def _box(*shape: int) -> spaces.Box:
    return spaces.Box(-1.0, 1.0, shape, np.float32)


class SwarmEnv(gymnasium.Env[Any, Any]):
    """A scenario in which one agent controls all robots: actions of shape (n, 2) or (n, 3), the
    reward is the mean over robots.

    Scenario fields can be overridden as in `Simulation`. An episode is terminated when all robots
    are done and truncated when the scenario's ticks are used up. Each episode has another seed.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(
        self,
        scenario: str | os.PathLike[str],
        *,
        neighbors: int = 5,
        ticks_per_step: int = 1,
        tolerance: float = 0.3,
        **fields: Any,
    ) -> None:
        self._swarm = _Swarm(scenario, neighbors, ticks_per_step, tolerance, fields)
        count = len(self._swarm.sim)
        self.observation_space = _box(count, self._swarm.width)
        self.action_space = _box(count, self._swarm.axes)

    @property
    def simulation(self) -> Simulation:
        """The run of this episode."""
        return self._swarm.sim

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Floats, dict[str, Any]]:
        """Starts an episode."""
        super().reset(seed=seed, options=options)
        self._swarm.begin(int(self.np_random.integers(2**31)))
        return self._swarm.observe(), self._info()

    def step(self, action: Floats) -> tuple[Floats, float, bool, bool, dict[str, Any]]:
        """Does a step of all robots."""
        reward = float(self._swarm.act(action).mean())
        swarm = self._swarm
        return swarm.observe(), reward, bool(swarm.done.all()), swarm.is_out_of_time, self._info()

    def _info(self) -> dict[str, Any]:
        return {"done": int(self._swarm.done.sum())}


class SwarmVectorEnv(VectorEnv[Any, Any, NDArray[Any]]):
    """`num_envs` independent swarms, stepped on all cores. The step after the end of an episode
    starts the next one (Gymnasium's `AutoresetMode.NEXT_STEP`). The numbers equal those of
    `gymnasium.vector.SyncVectorEnv` over `SwarmEnv`."""

    metadata: dict[str, Any] = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(self, scenario: str | os.PathLike[str], num_envs: int, **options: Any) -> None:
        self.num_envs = _check.whole("num_envs", num_envs, 1)
        self._envs = [SwarmEnv(scenario, **options) for _ in range(self.num_envs)]
        self.single_observation_space = self._envs[0].observation_space
        self.single_action_space = self._envs[0].action_space
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._is_over = np.zeros(self.num_envs, dtype=np.bool_)
        self._threads = ThreadPoolExecutor(max_workers=min(self.num_envs, os.cpu_count() or 1))

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Floats, dict[str, Any]]:
        """Starts an episode in each environment; one seed gives each environment a different one."""
        if seed is None or isinstance(seed, int):
            seeds = [None if seed is None else seed + index for index in range(self.num_envs)]
        else:
            seeds = list(seed)
            if len(seeds) != self.num_envs:
                raise ValueError(f"seed has {len(seeds)} entries; give one number, or {self.num_envs}")
        began = list(self._threads.map(lambda env, seed: env.reset(seed=seed), self._envs, seeds))
        self._is_over[:] = False
        return np.stack([seen for seen, _ in began]), self._infos([info for _, info in began])

    def step(self, actions: Floats) -> tuple[Floats, NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """Does a step of all swarms."""

        def one(index: int) -> tuple[Floats, float, bool, bool, dict[str, Any]]:
            env = self._envs[index]
            if self._is_over[index]:
                seen, info = env.reset()
                return seen, 0.0, False, False, info
            return env.step(actions[index])

        seen, rewards, terminated, truncated, infos = zip(*self._threads.map(one, range(self.num_envs)))
        terminated, truncated = np.array(terminated), np.array(truncated)
        self._is_over = terminated | truncated
        return np.stack(seen), np.array(rewards, dtype=np.float64), terminated, truncated, self._infos(infos)

    def _infos(self, infos: Any) -> dict[str, Any]:
        gathered: dict[str, Any] = {}
        for index, info in enumerate(infos):
            gathered = self._add_info(gathered, info, index)
        return gathered

    def close_extras(self, **_: Any) -> None:
        """Stops the threads."""
        self._threads.shutdown()


class RobotsEnv(pettingzoo.ParallelEnv[str, Any, Any]):
    """A scenario in which each robot is an agent, `robot_1` and so on by its number, with an action
    of shape (2,) or (3,).

    An agent is terminated when it is done; all are truncated when the scenario's ticks are used up.
    """

    metadata: dict[str, Any] = {"name": "staya_robots_v0", "render_modes": []}
    render_mode = None

    def __init__(
        self,
        scenario: str | os.PathLike[str],
        *,
        neighbors: int = 5,
        ticks_per_step: int = 1,
        tolerance: float = 0.3,
        **fields: Any,
    ) -> None:
        self._swarm = _Swarm(scenario, neighbors, ticks_per_step, tolerance, fields)
        self.possible_agents = [f"robot_{number}" for number in self._swarm.sim.ids]
        self._index = {agent: index for index, agent in enumerate(self.possible_agents)}
        self.agents: list[str] = []
        self._random = np.random.default_rng()
        self.observation_spaces = {agent: _box(self._swarm.width) for agent in self.possible_agents}
        self.action_spaces = {agent: _box(self._swarm.axes) for agent in self.possible_agents}

    @property
    def simulation(self) -> Simulation:
        """The run of this episode."""
        return self._swarm.sim

    def observation_space(self, agent: str) -> spaces.Space[Any]:
        """Observation space of an agent."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> spaces.Space[Any]:
        """Action space of an agent."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Floats], dict[str, dict[str, Any]]]:
        """Starts an episode."""
        if seed is not None:
            self._random = np.random.default_rng(seed)
        self._swarm.begin(int(self._random.integers(2**31)))
        self.agents = list(self.possible_agents)
        return self._observations(), {agent: {} for agent in self.agents}

    def step(
        self, actions: dict[str, Floats]
    ) -> tuple[dict[str, Floats], dict[str, float], dict[str, bool], dict[str, bool], dict[str, dict[str, Any]]]:
        """Does a step of all robots; robots without an action stop."""
        wishes = np.zeros((len(self.possible_agents), self._swarm.axes))
        for agent, action in actions.items():
            wishes[self._index[agent]] = action
        rewards = self._swarm.act(wishes)
        seen, is_out_of_time = self._observations(), self._swarm.is_out_of_time
        asked = {agent: self._index[agent] for agent in self.agents}
        terminated = {agent: bool(self._swarm.done[index]) for agent, index in asked.items()}
        truncated = {agent: is_out_of_time for agent in asked}
        gains = {agent: float(rewards[index]) for agent, index in asked.items()}
        self.agents = [agent for agent in self.agents if not (terminated[agent] or is_out_of_time)]
        return seen, gains, terminated, truncated, {agent: {} for agent in asked}

    def _observations(self) -> dict[str, Floats]:
        seen = self._swarm.observe()
        return {agent: seen[self._index[agent]].copy() for agent in self.agents}

    def render(self) -> None:
        """Draws nothing; use `simulation.page()` of a recording scenario."""

    def close(self) -> None:
        """Does nothing; there are no resources to release."""
