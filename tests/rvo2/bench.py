"""Time until the last robot arrives, beside RVO2, in 26 scenes.

    STAYA=target/release/staya python tests/rvo2/bench.py [--seed N] [--set FIELD=VALUE]

Robots of Staya know other robots by their beacons. Robots of RVO2 know the true positions and
velocities of their 16 nearest neighbours within the same range; they look 2 s ahead, 1 s at walls.
Both have the same starts, goals, walls, radii, speeds and ticks. A robot of RVO2 prefers to go
straight to its goal at full speed. A parked robot, or one within the tolerance of its goal, prefers
to stand.

The rule of arrival is Staya's: a robot has arrived since the first tick in which it begins within
the tolerance and then stands; a robot that leaves its goal has not arrived. A run ends when all
robots have arrived, or after the last tick. Parked robots never arrive, so their runs end with the
last tick. Gaps are the smallest between the surfaces of two robots, or of a robot and a wall, after
any tick.

Exits with an error unless RVO2 is nowhere more than SLOWEST times as quick, the geometric mean of
Staya's time over RVO2's is at most MEAN, and robots of Staya all arrive and never overlap. Times
are compared in scenes in which all robots of RVO2 arrive. If a robot of Staya does not arrive there, Staya's time
is the length of the run. The scenarios stay in target/rvo2.
"""

import argparse
import json
import math
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyrvo

from scenes import RADIUS_M, SPEED_MPS, TICK_S, TICKS, TOLERANCE_M, scenes

SLOWEST, MEAN = 1.3, 0.7
NEIGHBORS, HORIZON_S, WALL_HORIZON_S = 16, 2.0, 1.0
# A slower robot stands.
STANDS_MPS = 1e-3
ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "target" / "rvo2"


@dataclass
class Result:
    arrived: int
    last_s: float | None
    gap_m: float
    # Pairs that overlap, summed over ticks.
    overlaps: int = 0

    def row(self):
        last = "-" if self.last_s is None else f"{self.last_s:.1f}"
        # Adding zero drops the sign of a negative zero.
        return f"{self.arrived:>8}{last:>9}{round(self.gap_m * 1e3, 1) + 0.0:>9.1f}"


def by_staya(scene, settings):
    file = FOLDER / f"{scene.name}.toml"
    file.write_text(scene.to_toml())
    command = [os.environ.get("STAYA", ROOT / "target/release/staya"), "run", file, "--json", "--quiet", "--no-trace"]
    command += ["--out", FOLDER / scene.name, *(word for setting in settings for word in ("--set", setting))]
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, text=True)
    if done.returncode:
        raise SystemExit(f"{scene.name}: staya run ends with code {done.returncode}")
    summary = json.loads(done.stdout)
    gaps = [gap for gap in (summary["least_gap_m"], summary["least_obstacle_gap_m"]) if gap is not None]
    last_s = summary["arrival_last_seconds"] if summary["arrived"] else None
    return Result(summary["arrived"], last_s, min(gaps, default=math.inf), summary["collisions"])


def least_gap(places, segments):
    """Between the surfaces of two robots, or of a robot and a wall."""
    apart = np.linalg.norm(places[:, None] - places, axis=2)
    gaps = apart[~np.eye(len(places), dtype=bool)] - 2 * RADIUS_M
    least = gaps.min(initial=math.inf)
    for start, end in segments:
        along = np.clip((places - start) @ (end - start) / ((end - start) @ (end - start)), 0, 1)
        nearest = start + along[:, None] * (end - start)
        least = min(least, np.linalg.norm(places - nearest, axis=1).min() - RADIUS_M)
    return least


def by_rvo2(scene):
    sim = pyrvo.RVOSimulator(TICK_S, scene.range_m, NEIGHBORS, HORIZON_S, WALL_HORIZON_S, RADIUS_M, SPEED_MPS)
    segments = []
    for wall in scene.walls:
        # A segment becomes an obstacle with two sides.
        sim.add_obstacle(wall.points)
        corners = np.array(wall.points)
        segments += zip(corners, np.roll(corners, -1, axis=0))
    sim.process_obstacles()
    for index, robot in enumerate(scene.robots):
        sim.add_agent(robot.start)
        sim.set_agent_max_speed(index, robot.speed_mps)
    places = np.array([robot.start for robot in scene.robots])
    goals = np.array([robot.goal or (math.nan, math.nan) for robot in scene.robots])
    speeds = np.array([robot.speed_mps for robot in scene.robots])
    since = np.full(len(places), math.nan)
    least = math.inf
    for tick in range(1, TICKS + 1):
        ways = goals - places
        distances = np.linalg.norm(ways, axis=1)
        is_near = distances <= TOLERANCE_M
        # The last step ends at the goal.
        preferred = np.nan_to_num(ways / np.maximum(distances / speeds, TICK_S)[:, None])
        preferred[is_near] = 0
        for index, velocity in enumerate(preferred.tolist()):
            sim.set_agent_pref_velocity(index, velocity)
        sim.do_step()
        places = np.array([sim.get_agent_position(index).to_tuple() for index in range(len(places))])
        velocities = np.array([sim.get_agent_velocity(index).to_tuple() for index in range(len(places))])
        least = min(least, least_gap(places, segments))
        is_there = is_near & (np.abs(velocities) < STANDS_MPS).all(axis=1)
        since = np.where(is_there, np.fmin(since, tick), math.nan)
        if is_there.all():
            break
    arrived = since[~np.isnan(since)]
    return Result(len(arrived), arrived.max() * TICK_S if len(arrived) else None, least)


def ratio(scene, staya, rvo2):
    """Staya's time over RVO2's, if all robots of RVO2 arrive."""
    if rvo2.arrived < scene.goal_count():
        return None
    return (staya.last_s if staya.arrived == scene.goal_count() else TICKS * TICK_S) / rvo2.last_s


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seed", type=int, default=1, help="seed of the scenes")
    parser.add_argument("--set", action="append", default=[], dest="settings", metavar="FIELD=VALUE",
                        help="a field of Staya's scenarios, for example plane.orca.horizon_s=0.7")
    options = parser.parse_args()
    FOLDER.mkdir(parents=True, exist_ok=True)
    print(f"seed {options.seed}", *options.settings)
    columns = f"{'arrived':>8}{'last, s':>9}{'gap, mm':>9}"
    print(f"{'':<18}{'':>6}{'Staya':>26}{'RVO2':>26}")
    print(f"{'scene':<18}{'robots':>6}{columns}{columns}{'ratio':>8}")
    ratios, overlapping, missing = {}, [], []
    for scene in scenes(options.seed):
        staya, rvo2 = by_staya(scene, options.settings), by_rvo2(scene)
        times = ratio(scene, staya, rvo2)
        if times is not None:
            ratios[scene.name] = times
        overlapping += [scene.name] if staya.overlaps else []
        missing += [scene.name] if staya.arrived < scene.goal_count() else []
        shown = "-" if times is None else f"{times:.2f}"
        print(f"{scene.name:<18}{scene.goal_count():>6}{staya.row()}{rvo2.row()}{shown:>8}", flush=True)
    slow = [name for name, times in ratios.items() if times > SLOWEST]
    # Without a ratio the goal is missed.
    mean = math.exp(sum(map(math.log, ratios.values())) / len(ratios)) if ratios else math.nan
    goals = [
        (f"scenes in which RVO2 is more than {SLOWEST} times as quick: {', '.join(slow) or 'none'}; none", not slow),
        (f"geometric mean of {len(ratios)} ratios: {mean:.2f}; at most {MEAN}", mean <= MEAN),
        (f"scenes in which robots of Staya overlap: {', '.join(overlapping) or 'none'}; none", not overlapping),
        (f"scenes in which a robot of Staya does not arrive: {', '.join(missing) or 'none'}; none", not missing),
    ]
    for text, is_met in goals:
        print(f"{text}: {'met' if is_met else 'MISSED'}")
    return 0 if all(is_met for _, is_met in goals) else 1


if __name__ == "__main__":
    sys.exit(main())
