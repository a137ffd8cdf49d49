"""Runs all of `staya` under attack for any time, and checks that its resources do not grow.

`cargo xtask soak [--minutes N] [--json FILE] [PART...]` runs it. Parts: flood (a bridge without a
key), key (a bridge with a key), companion (six vehicles over bad links), hil (firmware on emulated
parts that are reset). By hand:

    STAYA=target/release/staya target/python/bin/python tests/python/soak.py --minutes 1 flood

Checks for each process of `staya`:

- Memory: a line through its resident memory, sampled at 1 Hz in the second half of the run, rises
  by less than GROWTH in total. One leaked byte per frame of the flood would exceed that within half
  a minute; queues are full long before.
- Threads and descriptors after the attack equal those before.
- Deadlines: none is missed beyond what the system's scheduler explains. A thread that waited D
  seconds for a processor (`/proc/PID/schedstat`) may have missed D / tick deadlines. Without other
  load that is none.
- Frames: all sent frames either arrived or were dropped by the system (`/proc/net/udp`); all frames
  that arrived were handled, or rejected for a counted reason.
- Exit: the process ends when told to, with the documented exit code, and leaves no process behind.
"""

import argparse
import json
import math
import multiprocessing
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import hostile
from companion_setup import RADIUS, write_config, write_scenario
from fake_autopilot import GUIDED, PILOT, Faults, Fleet, Line, Vehicle

ROOT = Path(__file__).resolve().parents[2]
VEHICLES = 100
BRIDGE = "scenarios/bridge-100.toml"
# In bytes, see the module's documentation.
GROWTH = 1 << 20
# Seconds before and after the attack.
QUIET_S = 3.0
TICK_S = {BRIDGE: 0.05}
RATE = 50_000


class Process:
    """A `staya` process with samples of its resources at 1 Hz."""

    def __init__(self, name, folder, *arguments):
        self.name, self.samples, self.children = name, [], set()
        self.out = folder / f"{name}.json"
        self.log = folder / f"{name}.log"
        program = os.environ.get("STAYA", str(ROOT / "target/release/staya"))
        with open(self.out, "wb") as out, open(self.log, "wb") as log:
            self.child = subprocess.Popen([program, *map(str, arguments)], cwd=ROOT, stdin=subprocess.DEVNULL, stdout=out, stderr=log)
        self.began = time.monotonic()

    def sample(self):
        proc = Path(f"/proc/{self.child.pid}")
        try:
            for task in (proc / "task").iterdir():
                self.children |= set(map(int, (task / "children").read_text().split()))
            pages = int((proc / "statm").read_text().split()[1])
            self.samples.append(
                dict(
                    s=time.monotonic() - self.began,
                    bytes=pages * os.sysconf("SC_PAGE_SIZE"),
                    threads=len(os.listdir(proc / "task")),
                    files=len(os.listdir(proc / "fd")),
                    # Seconds for which its main thread was ready but did not run.
                    waited_s=int((proc / "schedstat").read_text().split()[1]) / 1e9,
                )
            )
        except (OSError, IndexError):
            # The process has ended.
            pass

    def end(self, code):
        """Stops with Ctrl-C. Returns the report; raises an error if the process does not end
        properly."""
        if self.child.poll() is None:
            self.child.send_signal(signal.SIGINT)
        try:
            ended = self.child.wait(20)
        except subprocess.TimeoutExpired:
            self.child.kill()
            self.child.wait()
            ended = "does not end"
        text = self.out.read_text()
        if ended != code or not text:
            raise AssertionError(f"exit code {ended}, not {code}: {self.log.read_text()[-500:]}")
        return json.loads(text)

    def growth(self):
        """Bytes by which a line through the second half of the samples rises."""
        half = self.samples[len(self.samples) // 2 :]
        if len(half) < 2:
            return 0.0
        mean_s, mean = (sum(sample[of] for sample in half) / len(half) for of in ("s", "bytes"))
        spread = sum((sample["s"] - mean_s) ** 2 for sample in half)
        slope = sum((sample["s"] - mean_s) * (sample["bytes"] - mean) for sample in half) / spread
        return slope * (half[-1]["s"] - half[0]["s"])


class Judge:
    def __init__(self):
        self.rows = []

    def says(self, part, what, is_right, figures):
        self.rows.append(dict(part=part, what=what, passed=bool(is_right), figures=figures))

    def memory(self, process, begins_at=1):
        """Judges the resources; `begins_at` is the sample before the attack for threads and
        descriptors."""
        first, last = process.samples[begins_at], process.samples[-1]
        growth, most = process.growth(), max(sample["bytes"] for sample in process.samples)
        mib = 1 << 20
        self.says(process.name, "memory is flat", growth < GROWTH,
                  f"{growth / 1024:+.0f} KiB in the second half, {GROWTH // 1024} at most; {most / mib:.1f} MiB at most, {last['bytes'] / mib:.1f} at the end")
        peaks = [max(sample[of] for sample in process.samples) for of in ("threads", "files")]
        is_same = all(first[of] == last[of] for of in ("threads", "files"))
        self.says(process.name, "threads and descriptors are unchanged", is_same,
                  f"{first['threads']} and {first['files']}, at most {peaks[0]} and {peaks[1]}, then {last['threads']} and {last['files']}")

    def deadlines(self, process, missed, ticks, tick_s, slowest_s):
        waited = process.samples[-1]["waited_s"]
        self.says(process.name, "no deadline is missed", missed <= waited / tick_s,
                  f"{missed} in {ticks} ticks of {tick_s * 1e3:.0f} ms, {slowest_s * 1e3:.1f} ms at most; {waited:.1f} s of waiting for a processor explain {int(waited / tick_s)}")


def free_port():
    """An unused UDP and TCP port."""
    while True:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp, socket.socket() as tcp:
            udp.bind((hostile.HOST, 0))
            try:
                tcp.bind(udp.getsockname())
            except OSError:
                continue
            return udp.getsockname()[1]


def drops(port):
    """Datagrams for a local port that the system dropped."""
    for line in Path("/proc/net/udp").read_text().splitlines()[1:]:
        fields = line.split()
        if int(fields[1].split(":")[1], 16) == port and fields[2] == "00000000:0000":
            return int(fields[-1])
    return 0


class Clients:
    """Functions of `hostile`, each in a process, and their results."""

    def __init__(self):
        self.context = multiprocessing.get_context("spawn")
        self.manager = self.context.Manager()
        self.over, self.found, self.running = self.context.Event(), self.manager.dict(), []
        self.ready, self.go = self.context.Semaphore(0), self.context.Event()

    def start(self, name, work, *arguments):
        shared = (self.found, self.ready, self.go, self.over)
        process = self.context.Process(target=_work, args=(shared, name, work, *arguments), daemon=True)
        process.start()
        self.running.append(process)

    def begin(self):
        """Starts all when all processes are ready, which takes a while on a loaded machine."""
        for _ in self.running:
            if not self.ready.acquire(timeout=120):
                raise SystemExit("a client did not start")
        self.go.set()

    def end(self):
        self.over.set()
        for process in self.running:
            process.join(20)
        return dict(self.found)


def _work(shared, name, work, *arguments):
    found, ready, go, over = shared
    # Only the parent process handles Ctrl-C.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    ready.release()
    go.wait()
    found[name] = work(over, *arguments)


def accounts(judge, part, report):
    """Every received frame is counted exactly once."""
    came = sum(line["frames_in"] for line in report["lines"])
    lost = sum(line["lost_in"] for line in report["lines"])
    parts = [report[of] for of in ("frames_heard", "frames_ignored", "frames_refused", "frames_waiting")]
    judge.says(part, "every frame that came in is counted once", came == sum(parts) + lost,
               "{} in: {} handled, {} ignored, {} rejected, {} queued, {} lost".format(came, *parts, lost))


def waits(found):
    """The times in ms within which half, and all, of the answers arrived."""
    times = found["waits_ms"] or [math.nan]
    return f"half within {times[len(times) // 2]:.0f} ms, all within {times[-1]:.0f} ms"


class Flood:
    """A bridge without a key."""

    name = "flood"

    def __init__(self, folder):
        self.ports = dict(crowd=free_port(), junk=free_port(), tcp=free_port())
        lines = [f"udpin:127.0.0.1:{self.ports['crowd']}", f"udpin:127.0.0.1:{self.ports['junk']}", f"tcpin:127.0.0.1:{self.ports['tcp']}"]
        self.processes = [Process(self.name, folder, "bridge", BRIDGE, "--json", "-q", *(word for line in lines for word in ("--mavlink", line)))]

    def attack(self):
        self.clients = Clients()
        self.clients.start("station", hostile.station, self.ports["crowd"], 250, VEHICLES)
        self.clients.start("flood", hostile.flood, self.ports["crowd"], 251, VEHICLES, RATE)
        self.clients.start("junk", hostile.junk, self.ports["junk"])
        self.clients.start("half_open", hostile.half_open, self.ports["tcp"])
        self.clients.start("cut", hostile.cut_and_restored, self.ports["tcp"], 252)

    def stop(self):
        self.found = self.clients.end()

    def judge(self, judge):
        dropped = {line: drops(self.ports[line]) for line in ("crowd", "junk")}
        [process] = self.processes
        report = process.end(0)
        crowd, noise, _ = report["lines"]
        station, flood, junk = (self.found[of] for of in ("station", "flood", "junk"))
        sent = station["sent"] + flood["sent"]
        judge.says(self.name, "what was sent came in, or the system dropped it", sent == crowd["frames_in"] + dropped["crowd"],
                   f"{sent} frames, {flood['sent'] / flood['seconds']:.0f} a second of one peer: {crowd['frames_in']} in, {dropped['crowd']} dropped by the system")
        accounts(judge, self.name, report)
        judge.says(self.name, "well-behaved clients are answered", station["answered"] == station["requests"] > 0,
                   f"{station['answered']} of {station['requests']} requests in {station['tries']} tries, {waits(station)}")
        answers, seconds = sum(report["commands"].values()), report["wall_seconds"]
        judge.says(self.name, "a flooding client gets at most a peer's answers", answers <= 2 * (1000 + 1000 * seconds),
                   f"{answers} commands answered, {answers / seconds:.0f} a second")
        # The checksum of unknown messages is unknown, so a frame that looks like one counts as
        # ignored.
        judge.says(self.name, "every byte of junk is counted", junk["bytes"] == noise["junk_bytes"] + noise["bytes_in"] + dropped["junk"] * junk["size"],
                   f"{junk['bytes']} bytes from 200 ports: {noise['junk_bytes']} junk, {noise['frames_in']} unknown frames, {dropped['junk']} datagrams dropped")
        cut, opened = self.found["cut"], self.found["half_open"]["opened"]
        judge.says(self.name, "a cut link reconnects", cut["heard"] >= cut["links"] - 1 > 0,
                   f"{cut['heard']} of {cut['links']} times, among {opened} half-open connections, {waits(cut)}")
        judge.deadlines(process, report["deadlines_missed"], report["ticks"], TICK_S[BRIDGE], report["slowest_seconds"])
        judge.says(self.name, "no bodies overlapped", report["collisions"] == 0, f"{report['collisions']} overlaps")
        judge.memory(process)


class Key:
    """A bridge with a key and clients without it."""

    name = "key"

    def __init__(self, folder):
        self.port, self.key = free_port(), bytes(range(32))
        file = folder / "soak.key"
        file.write_text(self.key.hex())
        file.chmod(0o600)
        self.processes = [Process(self.name, folder, "bridge", BRIDGE, "--json", "-q", "--mavlink", f"udpin:127.0.0.1:{self.port}", "--key", file)]

    def attack(self):
        self.clients = Clients()
        self.clients.start("station", hostile.station, self.port, 250, VEHICLES, self.key)
        self.clients.start("impostors", hostile.impostors, self.port, self.key)

    def stop(self):
        self.found = self.clients.end()

    def judge(self, judge):
        dropped = drops(self.port)
        [process] = self.processes
        report = process.end(0)
        station, sent, refused = self.found["station"], self.found["impostors"], report["refused"]
        accounts(judge, self.name, report)
        judge.says(self.name, "clients with the key are answered", station["answered"] == station["requests"] > 0,
                   f"{station['answered']} of {station['requests']} requests, {waits(station)}")
        # Frames dropped by the system or a full queue are of unknown kind.
        lost = dropped + report["lines"][0]["lost_in"] + report["frames_waiting"]
        short = sum(abs(sent[kind] - refused[kind]) for kind in ("unsigned", "forged", "replayed", "ahead"))
        judge.says(self.name, "each rejection is counted by its reason", short <= lost and report["frames_refused"] > 0,
                   ", ".join(f"{refused[kind]} of {sent[kind]} {kind}" for kind in ("unsigned", "forged", "replayed", "ahead")) + f"; {lost} lost before")
        judge.deadlines(process, report["deadlines_missed"], report["ticks"], TICK_S[BRIDGE], report["slowest_seconds"])
        judge.memory(process)


class Companion:
    """Six vehicles with bad links, active pilots and restarting autopilots."""

    name = "companion"

    def __init__(self, folder):
        place = folder / self.name
        place.mkdir()
        count, port = 6, free_port()
        around = [(5 * math.cos(2 * math.pi * i / count), 5 * math.sin(2 * math.pi * i / count)) for i in range(count)]
        write_scenario(place, [(start, (-start[0], -start[1])) for start in around])
        config = write_config(place, [port] * count, "rover")
        lines = [Line(hostile.HOST, port, Faults(drop=0.1, delay_s=0.1, corrupt=0.02, seed=i)) for i in range(count)]
        self.vehicles = [Vehicle(i + 1, "rover", lines[i], start, mode=GUIDED, armed=True) for i, start in enumerate(around)]
        self.fleet, self.port, self.trouble = Fleet(self.vehicles, RADIUS), port, dict(taken=0, restarts=0, cuts=0)
        self.fleet.__enter__()
        self.processes = [Process(self.name, folder, "companion", config, "--json", "-q")]
        self.over = threading.Event()

    def attack(self):
        self.clients = Clients()
        self.clients.start("junk", hostile.junk, self.port, 50, 64, 100)
        self.thread = threading.Thread(target=self._interfere, daemon=True)
        self.thread.start()

    def _interfere(self):
        """For one vehicle after the other: its pilot takes over, its autopilot restarts, its link
        is cut; then it is given back."""
        number = 0
        while not self.over.wait(2.0):
            vehicle, kind = self.vehicles[number % len(self.vehicles)], number % 3
            with self.fleet.lock:
                if kind == 0:
                    vehicle.pilot(PILOT)
                    self.trouble["taken"] += 1
                elif kind == 1:
                    vehicle.reboot(0.5)
                    self.trouble["restarts"] += 1
                else:
                    vehicle.line.is_cut = True
                    self.trouble["cuts"] += 1
            self.over.wait(2.0)
            with self.fleet.lock:
                vehicle.line.is_cut = False
                vehicle.armed = True
                vehicle.pilot(GUIDED)
            number += 1

    def stop(self):
        self.over.set()
        self.thread.join()
        self.found = self.clients.end()
        self.over.clear()
        self.thread = threading.Thread(target=self._blow, daemon=True)
        self.thread.start()

    def _blow(self):
        """A wind that keeps vehicles away from their goals until the end."""
        while not self.over.wait(0.05):
            with self.fleet.lock:
                for vehicle in self.vehicles:
                    vehicle.east += 0.02

    def judge(self, judge):
        [process] = self.processes

        def stand():
            """Number of vehicles whose last setpoint is zero."""
            with self.fleet.lock:
                return sum(vehicle.setpoints[-1][1:] == (0.0, 0.0, 0.0) for vehicle in self.vehicles if vehicle.setpoints)

        stood = stand()
        # Stopped by Ctrl-C, its normal end.
        report = process.end(130)
        time.sleep(0.5)
        self.over.set()
        self.thread.join()
        self.fleet.__exit__()
        setpoints = [len(vehicle.setpoints) for vehicle in self.vehicles]
        vehicles = report["vehicles"]
        told = {of: sum(vehicle[of] for vehicle in vehicles) for of in ("setpoints", "hand_overs", "restarts", "stops", "packets_refused")}
        judge.says(self.name, "all vehicles are controlled to the end", min(setpoints) > 0 and all(vehicle["setpoints"] > 0 for vehicle in vehicles),
                   f"{told['setpoints']} setpoints, {sum(setpoints)} of them arrived; {told['hand_overs']} hand-overs, {told['restarts']} restarts, {told['stops']} stops")
        judge.says(self.name, "it hands over when a pilot takes a vehicle", told["hand_overs"] >= self.trouble["taken"] > 0,
                   f"{self.trouble['taken']} taken by pilots, {self.trouble['restarts']} restarted, {self.trouble['cuts']} links cut")
        judge.says(self.name, "no bodies overlapped", self.fleet.least_gap > 0, f"{self.fleet.least_gap:.2f} m at least between bodies")
        judge.says(self.name, "the last setpoint is zero", stood < stand() == len(self.vehicles), f"{stand()} of {len(self.vehicles)} vehicles, {stood} before the end")
        [noise] = report["links"]
        sent = self.found["junk"]["bytes"]
        is_counted = noise["junk_bytes"] + noise["bytes_in"] >= sent > 0 and noise["junk_bytes"] > sent // 2
        judge.says(self.name, "junk is counted", is_counted, f"{sent} bytes, {noise['junk_bytes']} counted including frames damaged by the links")
        judge.memory(process)


class Hil:
    """Two robots on emulated parts with lossy serial links and resets, run after run."""

    name = "hil"
    RESETS, DOWN, TICKS, DEVICES = (20, 60), 5, 100, 2

    def __init__(self, folder):
        self.folder, self.processes, self.reports, self.over = folder, [], [], threading.Event()
        self.trouble = None

    def attack(self):
        self.clients = Clients()
        self.thread = threading.Thread(target=self._run, daemon=True)
        self.thread.start()

    def _run(self):
        try:
            while not self.over.is_set():
                seed = len(self.reports) + 1
                resets = [word for tick in self.RESETS for word in ("--reset", tick)]
                process = Process(
                    f"hil-{seed}", self.folder, "hil", "scenarios/six-robots.toml", "--device", "qemu:stm32f405", "--devices", self.DEVICES, "--ticks", self.TICKS,
                    "--seed", seed, "--bit-errors", "1e-4", "--loss", "0.01", *resets, "--down", self.DOWN,
                    "--firmware", os.environ.get("STAYA_FIRMWARE", ROOT / "target/firmware"), "--json", "-q",
                )
                self.processes.append(process)
                # Runs end by themselves, after the other parts too.
                process.child.wait(300)
                self.reports.append(process.end(0))
        except (AssertionError, subprocess.TimeoutExpired) as trouble:
            self.trouble = trouble

    def stop(self):
        self.over.set()

    def judge(self, judge):
        while self.thread.is_alive():
            self.thread.join(0.5)
            self.processes[-1].sample()
        judge.says(self.name, "each run comes to its end", self.trouble is None and self.reports, f"{len(self.reports)} runs; {self.trouble or 'exit code 0'}")
        devices = [device for report in self.reports for device in report["devices"]]
        total = {of: sum(device[of] for device in devices) for of in ("steps", "mismatches", "resets", "resent", "damaged")}
        judge.says(self.name, "no bit differs from the shadow's", total["mismatches"] == 0 < total["steps"], f"{total['steps']} steps, {total['mismatches']} mismatches")
        runs = len(devices)
        steps = runs * (self.TICKS - len(self.RESETS) * self.DOWN)
        judge.says(self.name, "each step and each reset is there", (total["steps"], total["resets"]) == (steps, runs * len(self.RESETS)),
                   f"{total['steps']} of {steps} steps, {total['resets']} resets of {runs * len(self.RESETS)}; {total['resent']} frames sent again")
        started = set().union(*(process.children for process in self.processes))
        left = [child for child in started if Path(f"/proc/{child}").exists()]
        judge.says(self.name, "no emulator is left behind", started and not left, f"{len(left)} of {len(started)} that were seen")
        most = [max(sample["bytes"] for sample in process.samples) for process in self.processes if process.samples]
        judge.says(self.name, "a later run takes no more memory", most and max(most) - most[0] < GROWTH,
                   f"{most[0] / (1 << 20):.1f} MiB at most in the first, {max(most) / (1 << 20):.1f} in all")


PARTS = {part.name: part for part in (Flood, Key, Companion, Hil)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=3.0)
    parser.add_argument("--json", type=Path, help="write what was judged, and all samples, to this file")
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    options = parser.parse_args()
    if unknown := [name for name in options.parts if name not in PARTS]:
        parser.error(f"no part {unknown[0]}; there are {', '.join(PARTS)}")
    judge = Judge()
    with tempfile.TemporaryDirectory(prefix="staya-soak-") as folder:
        parts = [PARTS[name](Path(folder)) for name in options.parts or PARTS]

        def wait(seconds):
            until = time.monotonic() + seconds
            while (left := until - time.monotonic()) > 0:
                time.sleep(min(1.0, left))
                for part in parts:
                    for process in part.processes:
                        process.sample()

        wait(QUIET_S)
        for part in parts:
            part.attack()
        for part in parts:
            part.clients.begin()
        wait(60 * options.minutes)
        for part in parts:
            part.stop()
        wait(QUIET_S)
        for part in parts:
            try:
                part.judge(judge)
            except (AssertionError, KeyError, ValueError) as error:
                judge.says(part.name, "there is a report", False, repr(error))
        samples = {process.name: process.samples for part in parts for process in part.processes}
    width = max(len(row["what"]) for row in judge.rows)
    for row in judge.rows:
        print(f"{row['part']:<10}{'ok' if row['passed'] else 'WRONG':<6}  {row['what']:<{width}}  {row['figures']}")
    if options.json:
        options.json.write_text(json.dumps(dict(minutes=options.minutes, load=os.getloadavg(), judged=judge.rows, samples=samples), indent=1))
    failed = sum(not row["passed"] for row in judge.rows)
    print(f"soak: {len(judge.rows) - failed} passed, {failed} failed in {options.minutes} minutes; load of the machine {os.getloadavg()[0]:.1f}")
    return min(failed, 1)


if __name__ == "__main__":
    sys.exit(main())
