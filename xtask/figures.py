"""The figures of all scenarios and experiments, recorded before a change of the code and compared after it:
`cargo xtask figures [--out FILE] [--against FILE]`. The variable STAYA names the program."""

import argparse
import json
import os
import statistics
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

# Of its own: no parameter was chosen on them, and no other table has them.
SEEDS = range(7001, 7006)
# Small versions of the experiments, with the first seeds.
EXPERIMENTS = [
    "route --seeds 10",
    "scouting --seeds 5",
    "formation --seeds 3",
    "swap --axis count=4,8,16,32 --axis radius_m=2,2,2,3.2 --set plane.robots.circle.noise_m=0.05",
    "doorway",
    "crossing --seeds 3",
    "flock --seeds 1 --set plane.robots.cloud.count=30",
    "goals --seeds 1 --set plane.robots.cloud.count=25",
]
SEEDS_OF_EXPERIMENTS = SEEDS[:2]
# Runs of minutes.
LARGE = {"million", "scale", "scale-plane"}
# Results that depend on the machine.
LEFT_OUT = {"wall_seconds", "seed", "pictures", "tables", "parameters"}
# The difference of two means is within this many standard errors in 95 % of cases, if nothing has changed (Student's t for
# two times five values).
T = 2.306
HASH = "trace_hash"


def numbers(value, path=""):
    """The path and the text of each number and of the trace hash."""
    if isinstance(value, dict):
        for name in value.keys() - LEFT_OUT:
            yield from numbers(value[name], f"{path}.{name}".lstrip("."))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from numbers(item, f"{path}[{index}]")
    elif path == HASH or isinstance(value, (int, float)) and not isinstance(value, bool):
        yield path, str(value)


def measured():
    """Values by scenario or experiment and figure, in the order of the seeds."""
    scenarios = [path for path in sorted(Path("scenarios").rglob("*.toml")) if path.stem not in LARGE]
    jobs = [(path.stem, ["run", str(path), "--no-trace"], SEEDS) for path in scenarios]
    for words in EXPERIMENTS:
        jobs.append((f"experiment-{words.split()[0]}", ["experiment", *words.split(), "--restart"], SEEDS_OF_EXPERIMENTS))
    figures = defaultdict(list)
    for name, arguments, seeds in jobs:
        for seed in seeds:
            command = [os.environ["STAYA"], *arguments, "--json", "--quiet", "--seed", str(seed), "--out", f"target/figures/{name}"]
            result = subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout
            for figure, value in numbers(json.loads(result)):
                figures[name, figure].append(value)
        print(name, flush=True)
    return figures


def is_lossy(figures, name, figure):
    """Whether packets are lost in a scenario or an experiment, or in the part of it with this figure."""
    parts = [f"{figure[:end]}.loss" for end, mark in enumerate(figure) if mark == "."]
    losses = ["packets.lost", "packets.damaged", "loss", "conditions.loss", *parts]
    return any(float(value) != 0 for loss in losses for value in figures.get((name, loss), []))


def is_near(before, now):
    """Whether the difference of two means is as small as chance makes it."""
    before, now = [[float(value) for value in values] for values in (before, now)]
    error = sum(statistics.variance(values) / len(values) for values in (before, now))
    return (statistics.mean(before) - statistics.mean(now)) ** 2 <= T**2 * error


def compare(before, now):
    """Figures of runs that lose no packet are equal; of others, nineteen in twenty are within their 95 % intervals. Returns
    what is wrong, or nothing."""
    within, beyond, unlike = [], [], []
    for key in sorted(before.keys() | now.keys()):
        values, values_now = before.get(key, []), now.get(key, [])
        if values == values_now:
            continue
        if not (is_lossy(before, *key) or is_lossy(now, *key)) or min(len(values), len(values_now)) < 2:
            unlike.append(key)
        elif key[1] != HASH:
            (within if is_near(values, values_now) else beyond).append(key)
    print(f"{len(within)} within their intervals, {len(beyond)} beyond, {len(unlike)} unlike")
    for key in beyond + unlike:
        print(*key, "before:", *before.get(key, []), "now:", *now.get(key, []))
    if unlike:
        return f"{len(unlike)} figures without loss of packets differ"
    if len(beyond) * 20 > max(len(within) + len(beyond), 20):
        return f"{len(beyond)} of {len(within) + len(beyond)} figures are beyond their intervals"
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("target/figures.csv"))
    parser.add_argument("--against", type=Path)
    options = parser.parse_args()
    before = None
    if options.against:
        rows = [line.split(",") for line in options.against.read_text().splitlines()]
        before = {(name, figure): values for name, figure, *values in rows}
    figures = measured()
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text("".join(f"{','.join([*key, *figures[key]])}\n" for key in sorted(figures)))
    print(f"{len(figures)} figures: {options.out}")
    return None if before is None else compare(before, figures)


if __name__ == "__main__":
    sys.exit(main())
