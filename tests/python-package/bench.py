"""Measures a thousand robots with ORCA from Python: `python tests/python-package/bench.py [STAYA]`,
on a machine without other load.

Compares a run through `Simulation.step`, with positions after each tick, with the command `staya`
(built with the wheel's profile, its path is the argument), and `staya.Orca` with RVO2's Python loop
(the package `pyrvo`) if it is installed. Reports the processor time on one thread, the smallest of
three.
"""

import json
import os
import resource
import subprocess
import sys
import time
from pathlib import Path

os.environ["RAYON_NUM_THREADS"] = "1"

import numpy as np

import staya

TOP = Path(__file__).resolve().parents[2]
SCENARIO = TOP / "scenarios" / "scale-plane-small.toml"
TICKS, STEPS, COUNT, TRIES = 200, 50, 1000, 3
RADIUS, SPEED, STEP, HORIZON, NEIGHBORS, SIGHT = 0.2, 1.0, 0.1, 2.0, 16, 4.8


def stepped():
    sim = staya.Simulation(SCENARIO)
    began = time.process_time()
    for _ in range(TICKS):
        sim.step()
        sim.positions.sum()
    return time.process_time() - began, sim.trace_hash


def in_one_call():
    sim = staya.Simulation(SCENARIO)
    began = time.process_time()
    sim.step(TICKS)
    return time.process_time() - began, sim.trace_hash


def commanded(staya_path, ticks):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [staya_path, "run", SCENARIO, "--ticks", ticks, "--no-trace", "--json", "--threads", 1, "--quiet"]
    command += ["--out", TOP / "target" / "bench-python"]
    text = subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True).stdout
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, json.loads(text)["trace_hash"]


def crowd():
    """Robots on a grid; the goal of each is the start of another robot."""
    places = 1.5 * np.stack(np.meshgrid(np.arange(32.0), np.arange(32.0)), axis=-1).reshape(-1, 2)[:COUNT]
    return places, np.random.default_rng(1).permutation(places)


def least_distance(places):
    apart = np.linalg.norm(places[:, None] - places, axis=2)
    return apart[~np.eye(len(places), dtype=bool)].min()


def by_orca():
    places, goals = crowd()
    avoid, velocities = staya.Orca(COUNT, horizon_s=HORIZON), np.zeros_like(places)
    spent, least = 0.0, np.inf
    for _ in range(STEPS):
        began = time.process_time()
        way = goals - places
        preferred = way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), SPEED)
        velocities = avoid(places, velocities, preferred, goals=goals, radii=RADIUS, max_speeds=SPEED, step_s=STEP)
        places = places + STEP * velocities
        spent += time.process_time() - began
        least = min(least, least_distance(places))
    return spent / STEPS, least


def by_rvo2(pyrvo):
    places, goals = crowd()
    sim = pyrvo.RVOSimulator(STEP, SIGHT, NEIGHBORS, HORIZON, HORIZON, RADIUS, SPEED)
    for place in places:
        sim.add_agent((float(place[0]), float(place[1])))
    spent, least = 0.0, np.inf
    for _ in range(STEPS):
        began = time.process_time()
        for index in range(COUNT):
            here = sim.get_agent_position(index)
            x, y = goals[index, 0] - here.x, goals[index, 1] - here.y
            length = max((x * x + y * y) ** 0.5, SPEED)
            sim.set_agent_pref_velocity(index, (float(x / length), float(y / length)))
        sim.do_step()
        now = [sim.get_agent_position(index) for index in range(COUNT)]
        spent += time.process_time() - began
        least = min(least, least_distance(np.array([[place.x, place.y] for place in now])))
    return spent / STEPS, least


def main():
    runs = {"Simulation.step and positions": stepped, f"Simulation.step({TICKS})": in_one_call}
    times = {name: [] for name in runs}
    hashes = set()
    if len(sys.argv) > 1:
        times["staya run"] = []
    for _ in range(TRIES):
        for name, work in runs.items():
            spent, trace_hash = work()
            times[name].append(spent)
            hashes.add(trace_hash)
        if len(sys.argv) > 1:
            whole, trace_hash = commanded(sys.argv[1], TICKS)
            times["staya run"].append(whole - commanded(sys.argv[1], 1)[0])
            hashes.add(trace_hash)
    print(f"{COUNT} robots of {SCENARIO.name}, {TICKS} ticks, hashes {', '.join(sorted(hashes))}")
    for name, spent in times.items():
        print(f"  {name:32} {min(spent) / TICKS * 1e3:8.3f} ms a tick")
    print(f"{COUNT} robots cross a grid, ORCA alone, {STEPS} steps")
    loops = {"staya.Orca": by_orca}
    try:
        import pyrvo
    except ImportError:
        print("  pyrvo is not installed; `pip install pyrvo`")
    else:
        loops["RVO2 by pyrvo"] = lambda: by_rvo2(pyrvo)
    spent = {name: [] for name in loops}
    least = {}
    for _ in range(TRIES):
        for name, work in loops.items():
            one, least[name] = work()
            spent[name].append(one)
    for name in loops:
        apart = f"least distance {least[name]:.3f} m (radii: {2 * RADIUS} m)"
        print(f"  {name:32} {min(spent[name]) * 1e3:8.3f} ms a step, {apart}")


if __name__ == "__main__":
    main()
