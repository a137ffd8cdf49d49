"""How much sooner one world is done on more ranks: `cargo xtask mpi --scaling`. Times say something on a machine that does nothing else."""

import tempfile
from pathlib import Path

from ranks import figures, ranks

# As dense as scenarios/scale.toml.
SCENARIO = """
name = 'two-hundred-thousand'
ticks = 20
[terrain.natural]
width = 2121
height = 2121
obstacles = 31495
[robots.scattered]
count = 200000
travel = 10
[radio]
range_m = 8
loss = 0.05
"""
# The shortest time counts.
TIMES = 2


def main():
    first = None
    print("ranks   seconds   times sooner   processor, slowest rank   trace hash")
    with tempfile.TemporaryDirectory() as folder:
        scenario = Path(folder) / "scaling.toml"
        scenario.write_text(SCENARIO)
        for count in (1, 2, 4):
            command = ranks(count, scenario, "--no-trace", "--out", Path(folder) / "out")
            runs = [figures(command, ["wall_seconds", "busy_seconds", "trace_hash"]) for _ in range(TIMES)]
            best = min(runs, key=lambda run: run["wall_seconds"][0])
            wall, trace_hash = best["wall_seconds"][0], best["trace_hash"][0]
            first = first or (wall, trace_hash)
            busy = max(best.get("busy_seconds", [0]))
            print(f"{count:>5}{wall:>10.2f}{first[0] / wall:>15.2f}{busy:>26.2f}   {trace_hash}")
            if trace_hash != first[1]:
                raise SystemExit(f"{count} ranks have the hash {trace_hash}, one has {first[1]}")


main()
