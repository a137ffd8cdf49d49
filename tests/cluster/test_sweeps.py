"""Sweeps on the engines that clusters have, Slurm and GNU parallel: the rows of one machine.

`cargo xtask cluster` fetches both engines and runs these tests; by hand: STAYA=path/to/staya pytest tests/cluster. Slurm's
daemons run as the present user, without systemd, control groups or keys: one controller and one node with two cores, on
loopback. Everything that they write is in the test's folder.
"""

import os
import signal
import socket
import stat
import subprocess
import time
from pathlib import Path

import pytest

# Runs of about a tenth of a second: a task can be killed between two of them.
SCENARIO = """
name = 'swap'
ticks = 600
tick_s = 0.05
[radio]
range_m = 5
[plane]
radius_m = 0.15
max_speed_mps = 0.5
[plane.robots.circle]
count = 24
radius_m = 3
noise_m = 0.05
"""
PLAN = """
name = 'swap-loss'
scenario = 'swap.toml'
seeds = 10
measures = ['arrived', 'arrival_last_seconds', 'least_gap_m', 'packets.lost']
[axes]
radio.loss = { from = 0, to = 0.7, step = 0.1 }
"""
TASKS, RUNS_A_TASK = 20, 4
FILES = ["rows.csv", "aggregates.csv", "plots/arrived-over-radio.loss.png"]
STAYA = os.environ["STAYA"]
TOOLS = Path(os.environ.get("STAYA_TOOLS", "target/tools"))


def run(*command, check=True, **options):
    """The output of a command."""
    return subprocess.run([*map(str, command)], check=check, stdout=subprocess.PIPE, text=True, **options).stdout


def within(seconds, ask):
    """Asks until there is an answer."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        if answer := ask():
            return answer
        time.sleep(0.02)
    raise AssertionError(f"not within {seconds} s: {ask.__name__}")


@pytest.fixture
def sweep(tmp_path):
    """`staya sweep` in a folder where one machine has done the plan alone."""
    (tmp_path / "swap.toml").write_text(SCENARIO)
    (tmp_path / "plan.toml").write_text(PLAN)

    def sweep(*arguments):
        return run(STAYA, "sweep", *arguments, cwd=tmp_path)

    sweep("plan.toml", "--out", "alone", "--quiet")
    return sweep


def compare(sweep, folder, out):
    """Merges shards, and compares every file byte for byte with that of one machine."""
    sweep("merge", "plan.toml", "--out", out, "--quiet")
    for name in FILES:
        assert (folder / out / name).read_bytes() == (folder / "alone" / name).read_bytes(), name


def configure(folder):
    """Slurm's configuration."""
    for name in ("state", "spool"):
        (folder / name).mkdir(parents=True)
    user, host = run("id", "-un").strip(), run("uname", "-n").split(".")[0].strip()
    with socket.socket() as first, socket.socket() as second:
        ports = []
        for port in (first, second):
            port.bind(("127.0.0.1", 0))
            ports.append(port.getsockname()[1])
    plugins = next(TOOLS.glob("unpacked/usr/lib/*-linux-*/slurm-wlm"), None)
    file = folder / "slurm.conf"
    file.write_text(f"""
ClusterName=staya
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
CommunicationParameters=NoInAddrAny
AuthType=auth/none
CredType=cred/none
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/controller.pid
SlurmdPidFile={folder}/node.pid
SlurmctldLogFile={folder}/controller.log
SlurmdLogFile={folder}/node.log
{f"PluginDir={plugins}" if plugins else ""}
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
SlurmdParameters=config_overrides
SchedulerParameters=sched_interval=1,batch_sched_delay=0,sched_min_interval=0
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=main Nodes={host} Default=YES MaxTime=INFINITE State=UP
""")
    return file


@pytest.fixture
def slurm(tmp_path):
    """A cluster of this machine: a command of Slurm's, or nothing if it fails."""
    folder = tmp_path / "slurm"
    options = {"env": {**os.environ, "SLURM_CONF": str(configure(folder))}, "cwd": tmp_path}
    # The node starts each task with this program.
    step = TOOLS / "bin/slurmstepd-wlm"
    node = ["-d", step] if step.is_file() else []
    daemons = []
    for command in (["slurmctld-wlm", "-D", "-i"], ["slurmd-wlm", "-D", *node]):
        with open(folder / f"{command[0]}.out", "w") as log:
            daemons.append(subprocess.Popen(command, stdout=log, stderr=log, **options))

    def slurm(*command):
        return run(*command, check=False, **options).strip()

    yield slurm
    for daemon in reversed(daemons):
        # Asked first, so that it ends what it has started.
        daemon.terminate()
        try:
            daemon.wait(5)
        except subprocess.TimeoutExpired:
            daemon.kill()
            daemon.wait()


def rows(folder, task):
    """Rows of a task's shard so far."""
    file = folder / f"slurm-out/shards/{task}-of-{TASKS}.csv"
    return max(file.read_bytes().count(b"\n") - 1, 0) if file.is_file() else 0


def kill_one(folder):
    """Kills a task that has done some of its runs and not all. Returns its number."""
    for task in range(1, TASKS + 1):
        if not 1 <= rows(folder, task) < RUNS_A_TASK - 1:
            continue
        for process in Path("/proc").glob("[0-9]*"):
            try:
                words = (process / "cmdline").read_text().split("\0")
            except OSError:
                continue
            # `staya sweep` replaces itself with the program of sweeps.
            if Path(words[0]).name.startswith("staya") and f"{task}/{TASKS}" in words:
                os.kill(int(process.name), signal.SIGKILL)
                return task if rows(folder, task) < RUNS_A_TASK else None
    return None


def test_array_on_slurm_whose_task_is_killed_and_requeued(sweep, slurm, tmp_path):
    within(60, lambda: "State=IDLE" in slurm("scontrol", "show", "node"))
    script = tmp_path / "job.sh"
    script.write_text(sweep("slurm", "plan.toml", "--out", "slurm-out", "--tasks", TASKS))
    job = slurm("sbatch", "--parsable", script)
    assert job, "sbatch does not take the job"
    name = f"{job}_{within(60, lambda: kill_one(tmp_path))}"
    within(60, lambda: "JobState=FAILED" in slurm("scontrol", "show", "job", name))
    within(60, lambda: slurm("sh", "-c", f"scontrol requeue {name} && echo done"))
    # Slurm would let it wait for two minutes.
    within(60, lambda: slurm("sh", "-c", f"scontrol update JobId={name} StartTime=now && echo done"))
    within(60, lambda: not slurm("squeue", "--noheader"))
    said = slurm("scontrol", "show", "job", name)
    assert "Restarts=1" in said and "JobState=COMPLETED" in said, said
    compare(sweep, tmp_path, "slurm-out")


def test_jobs_of_gnu_parallel_on_this_machine_and_another_host(sweep, tmp_path):
    options = ["--tasks", 7, "--at-once", 1, "--host", ":", "--host", "1/elsewhere"]
    script, ssh, log = tmp_path / "parallel.sh", tmp_path / "ssh", tmp_path / "hosts.log"
    script.write_text(sweep("parallel", "plan.toml", "--out", "parallel-out", *options))
    # In place of ssh: a shell gets what ssh would have given to a shell there, the words joined by spaces.
    ssh.write_text(
        f"""#!/bin/sh
for word; do [ "$word" = elsewhere ] && break; shift; done
echo "$1" >> '{log}'
shift
exec sh -c "$*"
"""
    )
    ssh.chmod(ssh.stat().st_mode | stat.S_IXUSR)
    run("sh", script, cwd=tmp_path, env={**os.environ, "PARALLEL_SSH": str(ssh), "HOME": str(tmp_path)})
    assert "elsewhere" in log.read_text().split(), "no job went to the other host"
    compare(sweep, tmp_path, "parallel-out")
