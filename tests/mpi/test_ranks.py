"""One world over ranks of OpenMPI: the figures and traces of one process on any number of ranks.

`cargo xtask mpi` fetches OpenMPI, builds `staya-mpi` and runs these tests.
"""

import os
import signal
import subprocess
import time
from pathlib import Path

import pytest
from ranks import alone, environment, figures, ranks

ROOT = Path(__file__).resolve().parents[2]
# A grid, the plane and attackers, each with every fault of a radio or nearly; small enough for eight ranks on two cores.
GRID = """
name = 'grid'
ticks = 120
[terrain.natural]
width = 40
height = 40
obstacles = 100
[radio]
range_m = 8
loss = 0.1
delay_ms = 300
jitter_ms = 900
duplicate = 0.1
reorder = 0.1
bit_error_rate = 0.0005
[robots.scattered]
count = 300
travel = 15
"""
PLANE = """
name = 'plane'
ticks = 150
tick_s = 0.1
[radio]
range_m = 4
loss = 0.2
delay_ms = 30
jitter_ms = 90
duplicate = 0.1
bandwidth_bytes_per_s = 600
[plane]
radius_m = 0.15
max_speed_mps = 0.5
[plane.robots.circle]
count = 60
radius_m = 8
noise_m = 0.05
"""
TWO = """
name = 'two'
ticks = 9
tick_s = 0.1
[plane]
radius_m = 0.3
max_speed_mps = 1
[plane.robots.circle]
count = 2
radius_m = 3
"""
ATTACKED = (ROOT / "scenarios/insider.toml").read_text()
# Figures that are the same on any number of ranks.
FIGURES = ["arrived", "collisions", "delivered", "rejected", "least_gap_m", "trace_hash"]
scenarios = pytest.mark.parametrize("text", [GRID, PLANE, ATTACKED], ids=["grid", "plane", "attacked"])


def write(folder, text):
    file = folder / "scenario.toml"
    file.write_text(text)
    return file


@scenarios
def test_one_hash_and_trace_on_any_number_of_ranks(tmp_path, text):
    scenario, out = write(tmp_path, text), tmp_path / "out"
    wanted = figures(alone(scenario, "--out", out), FIGURES)
    assert wanted["trace_hash"]
    trace = (out / "trace.csv").read_bytes()
    for count in (1, 2, 3, 4, 8):
        assert figures(ranks(count, scenario, "--out", out), FIGURES) == wanted, count
        assert (out / "trace.csv").read_bytes() == trace, count


@scenarios
def test_checkpoint_of_three_ranks_continues_on_two_and_by_one_process(tmp_path, text):
    scenario, out = write(tmp_path, text), tmp_path / "half"
    wanted = figures(alone(scenario, "--out", out), FIGURES)
    figures(ranks(3, scenario, "--ticks", 50, "--checkpoint", "50ticks", "--out", out), FIGURES)
    rest = [scenario, "--from", f"{out}.checkpoint", "--out", out]
    assert figures(ranks(2, *rest), FIGURES) == wanted
    assert figures(alone(*rest), FIGURES) == wanted


def series(folder):
    """How long the series is that a run under way, or one that failed, has beside its results."""
    return max((file.stat().st_size for file in folder.glob("*/series.csv")), default=0)


def process_of_rank(rank, out):
    for process in Path("/proc").glob("[0-9]*"):
        try:
            words = (process / "cmdline").read_bytes().split(b"\0")
            variables = (process / "environ").read_bytes().split(b"\0")
        except OSError:
            continue
        if str(out).encode() in words and f"OMPI_COMM_WORLD_RANK={rank}".encode() in variables:
            return int(process.name)
    raise AssertionError(f"there is no rank {rank}")


def test_killed_rank_ends_the_run_and_leaves_its_records(tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    command = ranks(4, write(tmp_path, GRID), "--ticks", 1_000_000, "--out", folder / "killed")
    run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment())
    try:
        deadline = time.monotonic() + 60
        # Once it has written something, so that there is something to leave.
        while series(folder) < 4096:
            assert time.monotonic() < deadline and run.poll() is None, "the run wrote nothing"
            time.sleep(0.05)
        os.kill(process_of_rank(2, folder / "killed"), signal.SIGKILL)
        _, said = run.communicate(timeout=60)
    finally:
        run.kill()
    assert run.returncode != 0
    assert "rank 2" in said and "signal 9" in said, said
    assert series(folder) > 0


@pytest.mark.parametrize(["text", "remedy"], [(TWO, "start at most 2"), (None, "scenario.toml")])
def test_ranks_that_cannot_share_a_scenario_say_why_once(tmp_path, text, remedy):
    scenario = write(tmp_path, text) if text else tmp_path / "scenario.toml"
    command = ranks(3, scenario, "--out", tmp_path / "refused")
    done = subprocess.run(command, capture_output=True, text=True, env=environment())
    said = [line for line in done.stderr.splitlines() if line.startswith("staya-mpi:")]
    assert done.returncode != 0 and len(said) == 1 and remedy in said[0], done.stderr
