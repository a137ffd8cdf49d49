"""Environments: the checkers of Gymnasium and PettingZoo, and tests beyond them."""

import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import SyncVectorEnv
from pettingzoo.test import parallel_api_test, parallel_seed_test

from staya.rl import RobotsEnv, SwarmEnv, SwarmVectorEnv

FOUR = {"overrides": {"plane.robots.circle.count": 4}}


def to_goals(seen):
    ways = seen[..., 2:4] * 10.0
    return ways / np.maximum(np.linalg.norm(ways, axis=-1, keepdims=True), 0.05)


def test_gymnasiums_checker_passes(scenario):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", message=".*(recommend using a symmetric|spec|render).*")
        check_env(SwarmEnv(scenario("swap-circle"), **FOUR), skip_render_check=True)


def test_pettingzoos_checkers_pass(scenario):
    parallel_api_test(RobotsEnv(scenario("swap-circle"), ticks=60, **FOUR), num_cycles=100)
    parallel_seed_test(lambda: RobotsEnv(scenario("swap-circle"), ticks=60, radio__loss=0.5, **FOUR), num_cycles=20)


def test_moving_to_the_goal_is_rewarded_until_arrival(scenario):
    env = SwarmEnv(scenario("swap-circle"), ticks_per_step=2, **FOUR)
    seen, _ = env.reset(seed=3)
    assert seen.shape == env.observation_space.shape == (4, 2 * (2 + 2 * 5)) and seen.dtype == np.float32
    gain = 0.0
    for _ in range(400):
        seen, reward, terminated, truncated, info = env.step(to_goals(seen))
        gain += reward
        if terminated or truncated:
            break
    assert terminated and info["done"] == 4
    # Four metres less the tolerance, in steps of 0.05 m.
    assert gain == pytest.approx(3.7 / 0.05, rel=0.02)
    standing = SwarmEnv(scenario("swap-circle"), ticks=10, **FOUR)
    standing.reset(seed=3)
    ends = [standing.step(np.zeros((4, 2)))[1:4] for _ in range(10)]
    assert all(abs(reward) < 1e-6 for reward, *_ in ends) and [end[2] for end in ends] == [False] * 9 + [True]


def test_parallel_swarms_are_independent(scenario):
    def one():
        return SwarmEnv(scenario("swap-circle"), ticks=30, radio__loss=0.5, **FOUR)

    both = [
        SwarmVectorEnv(scenario("swap-circle"), 3, ticks=30, radio__loss=0.5, **FOUR),
        SyncVectorEnv([one] * 3),
    ]
    assert both[0].observation_space == both[1].observation_space and both[0].action_space == both[1].action_space
    assert both[0].metadata["autoreset_mode"] == gymnasium.vector.AutoresetMode.NEXT_STEP
    seen = [env.reset(seed=7)[0] for env in both]
    assert (seen[0] == seen[1]).all() and seen[0].shape == (3, 4, 24)
    ends = 0
    for step in range(70):
        actions = np.random.default_rng(step).uniform(-1, 1, both[0].action_space.shape).astype(np.float32)
        own, known = (env.step(actions) for env in both)
        for mine, theirs in zip(own[:4], known[:4]):
            assert (mine == theirs).all() and mine.dtype == theirs.dtype
        assert (own[4]["done"] == known[4]["done"]).all()
        ends += own[3].sum()
    assert ends == 6
    for env in both:
        env.close()


def test_robots_leave_when_they_are_done(scenario):
    env = RobotsEnv(scenario("swap-circle"), **FOUR)
    seen, _ = env.reset(seed=1)
    assert env.agents == ["robot_1", "robot_2", "robot_3", "robot_4"]
    left = []
    while env.agents:
        # Only the first robot moves.
        actions = {agent: to_goals(seen[agent]) * (1.0 if agent == "robot_1" else 0.5) for agent in env.agents}
        seen, rewards, terminated, truncated, _ = env.step(actions)
        left += [agent for agent, is_done in terminated.items() if is_done]
        assert set(rewards) == set(terminated) == set(truncated) == set(seen)
    assert left[0] == "robot_1" and sorted(left) == env.possible_agents


def test_scenarios_without_goals_are_refused(scenario):
    with pytest.raises(ValueError, match="robots without a goal"):
        SwarmEnv(scenario("six-robots"))
    with pytest.raises(ValueError, match="neighbors is -1; give 0"):
        SwarmEnv(scenario("swap-circle"), neighbors=-1)
