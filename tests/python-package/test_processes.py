"""Copies of runs, and processes that use the package."""

import copy
import importlib.metadata
import multiprocessing
import os
import pickle

import numpy as np
import pytest

import staya


def total(seed):
    places = np.random.default_rng(seed).uniform(0, 300, (3000, 2))
    return float(staya.flock.lattice(places, np.zeros_like(places), spacing_m=5.0).sum())


def finished(sim):
    return sim.run().trace_hash


def test_the_version_is_that_of_the_package():
    assert staya.__version__ == importlib.metadata.version("staya")


def test_a_pickled_run_continues_like_the_original(scenario, golden):
    for name, tick in [("swap-circle", 10), ("six-robots", 25), ("same-number", 0), ("flock-squeeze", 7)]:
        sim = staya.Simulation(scenario(name))
        sim.step(tick)
        twin = pickle.loads(pickle.dumps(sim))
        assert (twin.tick, twin.trace_hash, twin.ids.tolist()) == (tick, sim.trace_hash, sim.ids.tolist())
        assert np.array_equal(twin.positions, sim.positions) and not twin.ids.flags.writeable
        assert twin.run().trace_hash == sim.run().trace_hash == golden(name)[0]


def test_a_copy_keeps_orders_overrides_and_commands(scenario, tmp_path):
    sim = staya.Simulation(scenario("swap-circle"), seed=4, ticks=80, radio__loss=0.2)
    sim.step(5)
    sim.set_goal(3, [1.0, 0.5])
    sim.step(5)
    twin = copy.deepcopy(sim)
    assert twin.run().trace_hash == sim.run().trace_hash
    for one, file in [(sim, "sim.toml"), (twin, "twin.toml")]:
        one.save(tmp_path / file)
    assert (tmp_path / "sim.toml").read_text() == (tmp_path / "twin.toml").read_text()
    wished = staya.Simulation(scenario("swap-circle"), ticks=40)
    wished.wish(np.full((16, 2), 0.1))
    wished.step(3)
    twin = pickle.loads(pickle.dumps(wished))
    assert twin.run().trace_hash == wished.run().trace_hash != staya.Simulation(scenario("swap-circle"), ticks=40).run().trace_hash


def test_results_and_errors_can_be_pickled(scenario):
    result = staya.Simulation(scenario("swap-circle"), ticks=30, record=1).run()
    twin = pickle.loads(pickle.dumps(result))
    assert twin.summary == result.summary and repr(twin) == repr(result)
    for table in ["trace", "series"]:
        columns, copied = getattr(result, table), getattr(twin, table)
        assert list(columns) == list(copied)
        for name, column in columns.items():
            assert np.array_equal(copied[name], column, equal_nan=column.dtype.kind == "f"), name
    assert twin.page().html == result.page().html
    plain = pickle.loads(pickle.dumps(staya.Simulation(scenario("swap-circle"), ticks=30).run()))
    assert plain.trace_hash == result.trace_hash
    error = pickle.loads(pickle.dumps(staya.ScenarioError("s.toml:1:1: no")))
    assert isinstance(error, staya.ScenarioError) and str(error) == "s.toml:1:1: no"


def test_what_cannot_be_copied_is_refused(scenario):
    sim = staya.Simulation(scenario("swap-circle"), record=1)
    with pytest.raises(TypeError, match="leave record out"):
        pickle.dumps(sim)
    restored, (state,) = staya.Simulation(scenario("swap-circle"))._run.__reduce__()
    for damaged in [b"", state[:-1], state[: len(state) // 2], b"\xff" * 64]:
        with pytest.raises(ValueError, match="not a simulation of this version"):
            restored(damaged)


@pytest.mark.parametrize("method", [name for name in ["fork", "forkserver", "spawn"] if name in multiprocessing.get_all_start_methods()])
def test_worker_processes_have_threads_of_their_own(scenario, method):
    expected = [total(seed) for seed in range(3)]
    sim = staya.Simulation(scenario("swap-circle"), ticks=60)
    sim.step(5)
    with multiprocessing.get_context(method).Pool(2) as pool:
        assert pool.map_async(total, range(3)).get(120) == expected
        # A run that is handed over continues there.
        assert pool.apply_async(finished, (sim,)).get(120) == finished(sim)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_a_fork_of_a_fork_works_too():
    expected = total(1)

    def child(depth, queue):
        if depth == 0:
            return queue.put(total(1))
        process = context.Process(target=child, args=(depth - 1, queue))
        process.start()
        process.join(60)

    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    child(2, queue)
    assert queue.get(timeout=60) == expected


def test_gymnasium_runs_environments_in_processes(scenario):
    gymnasium = pytest.importorskip("gymnasium")
    from staya.rl import SwarmEnv

    total(0)
    make = lambda: SwarmEnv(scenario("swap-circle"))  # noqa: E731
    envs = gymnasium.vector.AsyncVectorEnv([make, make], context="fork")
    try:
        observations, _ = envs.reset(seed=1)
        envs.step_async(envs.action_space.sample())
        envs.step_wait(timeout=60)
        assert len(observations) == 2
    finally:
        envs.close(terminate=True)
