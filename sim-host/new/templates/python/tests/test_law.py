"""Runs the law in the simulator, with the robots and radio of scenario.toml."""

import my_swarm
import pytest
import staya


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_all_arrive_and_none_overlap(seed):
    sim = staya.Simulation(my_swarm.SCENARIO, seed=seed)
    figures = my_swarm.run(sim)
    assert figures["arrived"] == figures["robots"], f"not arrived after {sim.time_s} s"
    assert figures["collisions"] == 0
