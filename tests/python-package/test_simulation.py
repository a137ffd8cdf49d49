"""Runs: trace hashes, arrays, orders, faults, results, errors."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import staya


@pytest.mark.parametrize("name", ["six-robots", "swap-circle", "same-number", "flock-squeeze"])
def test_a_run_has_the_hash_of_the_command(scenario, golden, name):
    trace_hash, ticks = golden(name)
    result = staya.Simulation(scenario(name)).run()
    assert (result.trace_hash, result.summary["ticks"]) == (trace_hash, ticks)


def test_single_steps_equal_a_run(scenario, golden):
    sim = staya.Simulation(scenario("swap-circle"))
    trace_hash, ticks = golden("swap-circle")
    sim.step(7)
    while not sim.is_over:
        sim.step()
    assert (sim.trace_hash, sim.tick) == (trace_hash, ticks)
    assert sim.time_s == pytest.approx(ticks * sim.tick_s)


def test_arrays_have_a_row_per_robot(scenario):
    sim = staya.Simulation(scenario("swap-circle"))
    assert len(sim) == 16 and sim.ids.tolist() == list(range(1, 17))
    before = sim.positions
    assert before.shape == sim.velocities.shape == sim.goals.shape == (16, 3) and before.dtype == np.float64
    assert sim.modes.shape == sim.is_up.shape == sim.neighbors.shape == (16,)
    assert np.allclose(np.linalg.norm(before, axis=1), 2) and np.allclose(sim.goals, -before)
    assert (sim.radii == 0.15).all() and (sim.max_speeds == 0.5).all()
    sim.step(20)
    now = sim.positions
    assert (np.linalg.norm(now, axis=1) < 1.9).all() and (before != now).any()
    assert np.linalg.norm(sim.velocities, axis=1).max() <= 0.5 + 1e-6
    assert {staya.Mode(mode) for mode in sim.modes} == {staya.Mode.CRUISE}
    assert sim.is_up.all() and (sim.neighbors > 0).all()
    with pytest.raises(ValueError):
        sim.ids[0] = 5


def test_the_seed_and_other_fields_can_be_overridden(scenario, tmp_path):
    file = scenario("six-robots")
    first, other = (staya.Simulation(file, seed=seed, ticks=60).run().trace_hash for seed in (1, 2))
    assert first != other
    lossy = staya.Simulation(file, seed=1, ticks=60, radio__loss=1.0).run()
    assert lossy.summary["packets"]["delivered"] == 0 < lossy.summary["packets"]["lost"]
    four = staya.Simulation(scenario("swap-circle"), overrides={"plane.robots.circle.count": 4})
    assert len(four) == 4
    text = file.read_text()
    assert staya.Simulation.from_text(text, folder=file.parent, seed=1, ticks=60).run().trace_hash == first


def test_errors_of_a_scenario_are_named(scenario):
    with pytest.raises(staya.ScenarioError, match=r"six-robots.toml:\d+:\d+: radio.loss: .*by an argument"):
        staya.Simulation(scenario("six-robots"), radio__loss=1.5)
    with pytest.raises(staya.ScenarioError, match="scenarios/README.md"):
        staya.Simulation(scenario("six-robots"), radio__lost=1)
    with pytest.raises(staya.ScenarioError, match="cannot read nowhere.toml"):
        staya.Simulation("nowhere.toml")
    with pytest.raises(ValueError, match="seed is -1; give 0"):
        staya.Simulation(scenario("six-robots"), seed=-1)
    with pytest.raises(ValueError, match=r"radio.loss is <object"):
        staya.Simulation(scenario("six-robots"), radio__loss=object())
    with pytest.raises(ValueError, match="n is 1.5; give a whole number"):
        staya.Simulation(scenario("six-robots")).step(1.5)


def test_a_robot_that_is_down_stops_and_restarts(scenario):
    sim = staya.Simulation(scenario("swap-circle"))
    sim.step(20)
    sim.take_down(3, for_s=1.0)
    sim.step()
    there = sim.positions[2]
    assert not sim.is_up[2] and staya.Mode(sim.modes[2]) == staya.Mode.FAULT
    sim.step(10)
    assert (sim.positions[2] == there).all()
    sim.step(40)
    assert sim.is_up.all() and (sim.positions[2] != there).any()


def test_a_law_reports_arrival_and_the_run_ends(scenario):
    def to_goal(sim):
        way = (sim.goals - sim.positions)[:, :2]
        distance = np.linalg.norm(way, axis=1)
        velocities = way / np.maximum(distance, 1e-9)[:, None] * np.minimum(0.5, 2 * distance)[:, None]
        return velocities, distance < 0.02

    sim = staya.Simulation(scenario("swap-circle"), ticks=4000)
    summary = sim.run(guidance=to_goal).summary
    assert summary["arrived"] == summary["robots"] and sim.tick < 4000
    with pytest.raises(ValueError, match='robot: None is not a robot id; give an id of `ids`, or "all"'):
        sim.set_goal(None, [0, 0])


def test_orders_change_goals_parameters_and_the_radio(scenario):
    sim = staya.Simulation(scenario("swap-circle"), ticks=2000)
    sim.set_goal(1, [0.0, 3.0])
    assert sim.goals[0].tolist() == [0.0, 3.0, 0.0]
    sim.set_radio(loss=1.0, range_m=1)
    sim.set_parameter("all", "speed_mps", 0.25)
    sim.step(100)
    assert sim.run(until=101).summary["packets"]["lost"] > 0
    with pytest.raises(ValueError, match="there is no robot 99; give the number"):
        sim.set_goal(99, [0, 0])
    with pytest.raises(ValueError, match="unknown variant"):
        sim.order("gaol", place_m=[0, 0, 0])
    with pytest.raises(ValueError, match=r"loss: .*is not a probability"):
        sim.set_radio(loss=2)


def test_orders_are_saved_in_a_scenario(scenario, tmp_path):
    sim = staya.Simulation(scenario("swap-circle"), seed=5, radio__loss=0.2)
    sim.step(30)
    sim.set_goal(4, [0.5, 2.5])
    sim.take_down(7)
    result = sim.run(until=200)
    sim.save(tmp_path / "by-hand.toml")
    assert staya.Simulation(tmp_path / "by-hand.toml").run(until=200).trace_hash == result.trace_hash


def test_results_are_tables(scenario):
    result = staya.Simulation(scenario("swap-circle")).run(every=50)
    ticks = result.summary["ticks"]
    assert result.series["tick"].tolist() == list(range(ticks + 1))
    assert sorted(set(result.trace["tick"])) == sorted({*range(0, ticks, 50), ticks})
    trace, series = result.to_pandas(), result.to_pandas("series")
    assert len(trace) == 16 * trace["tick"].nunique() and series["arrived"].iloc[-1] == 16
    assert set(trace["mode"]) <= {mode.name.lower() for mode in staya.Mode}
    assert trace[trace["tick"] == ticks]["mode"].unique().tolist() == ["arrived"]
    assert result.to_polars().shape == trace.shape
    assert result.to_polars("series")["sent"].sum() == result.summary["packets"]["sent"]
    with pytest.raises(ValueError, match='give "trace" or "series"'):
        result.to_pandas("rows")


def test_own_guidance_keeps_the_safety_layer(scenario):
    sim = staya.Simulation(scenario("swap-circle"), ticks=800)

    def to_goal(sim):
        way = (sim.goals - sim.positions)[:, :2]
        distance = np.linalg.norm(way, axis=1, keepdims=True)
        return way / np.maximum(distance, 1e-9) * np.minimum(0.5, distance / sim.tick_s)

    result = sim.run(guidance=to_goal)
    assert np.linalg.norm(sim.goals - sim.positions, axis=1).max() < 0.2
    assert result.summary["collisions"] == 0 < result.summary["packets"]["delivered"]
    assert len(result.series["tick"]) == 801
    with pytest.raises(ValueError, match="cannot be saved in a scenario"):
        sim.save("nowhere.toml")


def test_commanded_velocities_persist_with_mask_and_release(scenario, golden):
    sim = staya.Simulation(scenario("swap-circle"))
    mask = np.arange(16) == 0
    sim.wish(np.tile([0.0, 0.3, 0.0], (16, 1)), mask=mask)
    # It listens first, then leans aside for its neighbour.
    sim.step(24)
    assert sim.velocities[0] == pytest.approx([0, 0.3, 0], abs=1e-3)
    assert np.linalg.norm(sim.positions[1:], axis=1).max() < 1.9
    sim.release()
    assert sim.run().summary["arrived"] == 16
    plain = staya.Simulation(scenario("swap-circle"))
    plain.release()
    assert plain.run().trace_hash == golden("swap-circle")[0]


def test_invalid_velocities_name_the_element(scenario):
    sim = staya.Simulation(scenario("swap-circle"))
    with pytest.raises(ValueError, match=r"velocities has the shape \(3, 2\); give an array of shape \(16, 2 or 3\)"):
        sim.wish(np.zeros((3, 2)))
    wishes = np.zeros((16, 2))
    wishes[4, 1] = np.nan
    with pytest.raises(ValueError, match=r"velocities\[4, 1\] is nan; give finite numbers"):
        sim.wish(wishes)
    sim.wish(np.full((16, 2), 1e300))
    with pytest.raises(ValueError, match="mask has the shape"):
        sim.wish(np.zeros((16, 2)), mask=[True])
    with pytest.raises(ValueError, match="velocities is not an array of numbers"):
        sim.wish([["a", "b"]] * 16)
    with pytest.raises(ValueError, match=r"robot 1 moves from cell to cell .* \[plane\]"):
        staya.Simulation(scenario("six-robots")).wish(np.zeros((6, 2)))


def test_a_page_shows_the_run(scenario, tmp_path):
    sim = staya.Simulation(scenario("swap-circle"), ticks=100, record=2)
    result = sim.run()
    for shown in (sim, result, result.page()):
        assert shown._repr_html_().startswith("<iframe")
    result.page().save(tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text()
    assert "<!doctype html" in text[:100].lower() and 'id="recording"' in text
    plain = staya.Simulation(scenario("swap-circle"), ticks=10)
    assert "trace_hash" in plain.run()._repr_html_() and plain._repr_html_() is None
    with pytest.raises(ValueError, match="give record=1"):
        plain.page()


def test_threads_share_the_interpreter(scenario):
    sim = staya.Simulation(scenario("swap-circle"))
    ticked = 0
    thread = threading.Thread(target=sim.step, args=(20_000,))
    thread.start()
    while thread.is_alive():
        ticked += 1
        time.sleep(0.001)
    assert sim.tick == 20_000 and ticked > 3


@pytest.mark.skipif(os.name != "posix", reason="signals are sent as POSIX has them")
def test_ctrl_c_ends_a_long_run(scenario):
    file = str(scenario("swap-circle"))
    code = f"import staya; sim = staya.Simulation({file!r}); print('go', flush=True); sim.step(4_000_000_000)"
    with subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as child:
        assert child.stdout.readline() == "go\n"
        time.sleep(0.3)
        child.send_signal(signal.SIGINT)
        _, errors = child.communicate(timeout=30)
    assert "KeyboardInterrupt" in errors
