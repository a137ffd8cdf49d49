"""The time that a page costs a run while no browser shows it, beside the same run without a page.

    STAYA=target/release/staya python tests/python/bench_view.py

Exits with an error if the median of the ratios is above MOST.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

# The ratio of one pair depends on the machine, their median on the page.
PAIRS = 9
MOST = 1.03
ROOT = Path(__file__).resolve().parents[2]


def seconds(folder, *options):
    command = [os.environ["STAYA"], "run", "scenarios/twenty-discs.toml", "--json", "-q", "--out", folder, *options]
    return json.loads(subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout)["wall_seconds"]


def main():
    ratios = []
    with tempfile.TemporaryDirectory() as folder:
        for pair in range(PAIRS):
            # In turn, so that a machine that becomes slower is slower for both.
            if pair % 2:
                page = seconds(folder, "--view")
                alone = seconds(folder)
            else:
                alone = seconds(folder)
                page = seconds(folder, "--view")
            print(f"without {alone:.3f} s, with a page {page:.3f} s")
            ratios.append(page / alone)
    median = statistics.median(ratios)
    print(f"{median:.3f} times as long (median of {PAIRS} pairs), at most {MOST}: {'met' if median <= MOST else 'MISSED'}")
    return 0 if median <= MOST else 1


if __name__ == "__main__":
    sys.exit(main())
