"""`staya companion` with simulated ArduPilot vehicles, and records of its messages."""

import json
import os
import re
import struct
import time
from pathlib import Path

import pytest
from conftest import ROOT, wait_until
from pymavlink.dialects.v20 import ardupilotmega as mavlink
from simulation import ORIGIN, Autopilot, Simulation

# From companions/crossing.toml: radius of the vehicles, their starts and goals.
RADIUS = 1.0
LINE = [((10.0 * i, 0.0), (50.0 - 10.0 * i, 0.0)) for i in range(6)]
STARTS, GOALS = [start for start, _ in LINE], [goal for _, goal in LINE]
LINK = re.compile(r'link = "[^"]*"')


def needs(kind):
    """A mark that skips a test, with a remedy, if the vehicle's simulator is missing."""
    variable = f"STAYA_{kind.upper()}"
    return pytest.mark.skipif(variable not in os.environ, reason=f"no simulation: `cargo xtask autopilots --{kind} PATH` names it (docs/autopilots.md)")


def figures(text):
    """Adds a line to the final table of `cargo xtask autopilots`."""
    print(f"\nfigures: {text}", flush=True)


class Companion:
    """A running `staya companion`, its log, and its report."""

    def __init__(self, staya, config, log, *arguments):
        self.log = log
        self.process = staya("companion", config, "--tlog", log, "--json", *arguments)

    def wait_for(self, text, timeout=20.0):
        return self.process.wait_for(text, timeout)

    def finish(self):
        """Stops with Ctrl-C and returns the report."""
        assert self.process.interrupt() == 130, self.process.output()
        text = self.process.output()
        return json.loads(text[text.index("\n{") if not text.startswith("{") else 0 :])

    def setpoints(self, number):
        """`(time, message)` of each setpoint sent to a vehicle."""
        return [(at, m) for at, m in self.messages() if m.get_type() == "SET_POSITION_TARGET_LOCAL_NED" and m.target_system == number]

    def messages(self):
        """All logged messages with times; to be called after the end."""
        data, at = self.log.read_bytes(), 0
        codec = mavlink.MAVLink(None)
        codec.robust_parsing = True
        while at + 12 <= len(data):
            (micros,) = struct.unpack_from(">Q", data, at)
            end = at + 8 + data[at + 9] + (25 if data[at + 10] & 1 else 12)
            for message in codec.parse_buffer(data[at + 8 : end]) or []:
                yield micros / 1e6, message
            at = end


@pytest.fixture
def fly(tmp_path, run, staya):
    """Functions that create a simulation of vehicles and start companions for them."""
    return Hangar(tmp_path, run, staya)


class Hangar:
    def __init__(self, folder, run, staya):
        self.folder, self.run, self.staya = folder, run, staya
        self.ports = {}
        self.count = 0

    def vehicles(self, kind, starts, free_port, **options) -> Simulation:
        vehicles = []
        for number, start in enumerate(starts, 1):
            self.ports[number] = free_port()
            vehicles.append(Autopilot(kind, number, start, self.folder, self.run, self.ports[number], free_port(), **options))
        return Simulation(vehicles)

    def example(self, name, edit=lambda text: text) -> Path:
        """An example of companions/, reduced to these vehicles and with their links."""
        head, *vehicles = (ROOT / "companions" / name).read_text().split("[[vehicle]]")
        head = re.sub(r'scenario = "([^"]*)"', lambda found: f'scenario = "{ROOT / "companions" / found[1]}"', head)
        linked = [LINK.sub(f'link = "udpin:127.0.0.1:{port}"', vehicle) for (_, port), vehicle in zip(sorted(self.ports.items()), vehicles)]
        return self._write("[[vehicle]]".join([edit(head), *linked]))

    def scenario(self, robots, safety="") -> Path:
        """companions/crossing.toml with other robots: `(start, goal)` of each in metres."""
        text = (ROOT / "companions/crossing.toml").read_text().split("[plane.robots]")[0].replace("[plane.orca]", f"{safety}\n[plane.orca]")
        text += "[plane.robots]\nlist = [\n"
        text += "".join(f"    {{ start_m = {list(start)}, goal_m = {list(goal)} }},\n" for start, goal in robots)
        path = self.folder / "scenario.toml"
        path.write_text(text + "]\n")
        return path

    def config(self, scenario, autopilot, rules="", air="", numbers=None) -> Path:
        """A custom configuration for the vehicles with these numbers (default: all)."""
        text = f'scenario = "{scenario}"\n[origin]\nlatitude_deg = {ORIGIN[0]}\nlongitude_deg = {ORIGIN[1]}\naltitude_m = {ORIGIN[2]}\n'
        text += f"[rules]\n{rules}\n{air}\n"
        for number in numbers or sorted(self.ports):
            text += f'[[vehicle]]\nrobot = {number}\nlink = "udpin:127.0.0.1:{self.ports[number]}"\nautopilot = "{autopilot}"\n'
        return self._write(text)

    def _write(self, text):
        self.count += 1
        path = self.folder / f"config-{self.count}.toml"
        path.write_text(text)
        return path

    def companion(self, config, *arguments) -> Companion:
        return Companion(self.staya, config, config.with_suffix(".tlog"), *arguments)


def rates(companion, simulation, until):
    """Setpoint rate of each vehicle from its first setpoint, Hz."""
    found = []
    for vehicle in simulation.vehicles:
        times = [at for at, _ in companion.setpoints(vehicle.number) if at < until]
        found.append((len(times) - 1) / (times[-1] - times[0]))
    return found


def moving(simulation, begun, timeout=60.0):
    """Waits until all vehicles move. Returns the time at which the first one started."""

    def all_are():
        return all(any(truth.speed > 0.3 for truth in vehicle.between(begun)) for vehicle in simulation.vehicles)

    wait_until(all_are, timeout, "setting off")
    return min(next(truth.at for truth in vehicle.between(begun) if truth.speed > 0.3) for vehicle in simulation.vehicles)


def arrive(simulation, goals, timeout, within=1.5, numbers=None):
    """Waits until all vehicles have stopped at their goals by their true positions. Returns the
    time."""
    wanted = [(vehicle, goal) for vehicle, goal in zip(simulation.vehicles, goals) if numbers is None or vehicle.number in numbers]

    def all_there():
        return all(vehicle.off(goal) < within and vehicle.truth[-1].speed < 0.2 for vehicle, goal in wanted)

    try:
        wait_until(all_there, timeout, "arrival of all")
    except AssertionError as error:
        raise AssertionError(f"{error}: {[round(vehicle.off(goal), 2) for vehicle, goal in wanted]} m off") from None
    return time.time()


def least(simulation, since, until=None, only=None, room=2.0 * RADIUS):
    """Text with the nearest pair. Fails if two vehicles overlapped by the scenario's radii."""
    distance, a, b, at = simulation.nearest(since, until or time.time(), only)
    assert distance > room, f"vehicles {a} and {b} came as near as {distance:.2f} m, {at - since:.1f} s after the start"
    return f"nearest pair {distance:.2f} m"

