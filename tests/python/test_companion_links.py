"""`staya companion` on links that cut frames, carry two vehicles with one number, or speak MAVLink 1
only, and with `staya bridge` as the autopilot."""

import json
import math
import time

import pytest
from companion_setup import RADIUS, ends_well, write_config, write_scenario
from conftest import wait_until
from fake_autopilot import GUIDED, ORIGIN, Fleet, Vehicle
from fake_line import Line


class SerialBridge(Line):
    """Sends datagrams of as many bytes as a UART at 38,400 baud gives in 4 ms."""

    BYTES = 15

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.uart = b""

    def _send(self, data):
        self.uart += data
        while len(self.uart) >= self.BYTES:
            super()._send(self.uart[: self.BYTES])
            self.uart = self.uart[self.BYTES :]


class Port1(Line):
    """Receives frames of MAVLink 1 only, as with SERIALn_PROTOCOL 1."""

    def turn(self, now):
        return [data for data in super().turn(now) if data[:1] == b"\xfe"]


class Old(Vehicle):
    """Sends MAVLink 1."""

    def pack(self, now, message):
        self.line.send(now, message.pack(self.codec, force_mavlink1=True))


class Behind:
    """The way of a second vehicle through the socket of the first one."""

    def __init__(self, line):
        self.line = line

    def send(self, now, data):
        self.line.send(now, data)

    def turn(self, now):
        return []

    def close(self):
        pass


def start(tmp_path, staya, port, rules='entry = "once"\narm = true', goal=(6.0, 0.0), *options):
    write_scenario(tmp_path, [((0.0, 0.0), goal)])
    return staya("companion", write_config(tmp_path, [port], "rover", rules), "--json", *options)


def report(process):
    output = ends_well(process)
    return json.loads(output[output.index("\n{") :])


def test_frames_cut_at_datagrams_are_read(tmp_path, free_port, staya):
    port = free_port()
    vehicle = Vehicle(1, "rover", SerialBridge("127.0.0.1", port))
    with Fleet([vehicle], RADIUS):
        process = start(tmp_path, staya, port)
        process.wait_for("arrived", 30)
        (link,) = report(process)["links"]
    # The first datagrams may be lost before the companion listens, and the last frame is cut.
    assert link["junk_bytes"] < 300 and link["frames_in"] > 100, link


@pytest.mark.parametrize("way", ["two peers", "one peer, 12 m", "one peer, 1.5 m", "two peers at one place"])
def test_two_vehicles_with_one_number_get_no_setpoint(tmp_path, free_port, staya, way):
    port = free_port()
    line = Line("127.0.0.1", port)
    other = Line("127.0.0.1", port) if "two" in way else Behind(line)
    place = {"two peers": (12.0, 3.0), "one peer, 12 m": (12.0, 0.0), "one peer, 1.5 m": (0.0, 1.5)}.get(way, (0.0, 0.0))
    vehicles = [Vehicle(1, "rover", line), Vehicle(1, "rover", other, place, mode=GUIDED, armed=True)]
    with Fleet(vehicles):
        process = start(tmp_path, staya, port)
        found = process.wait_for("two vehicles send as system 1", 8)
        assert f"udpin:127.0.0.1:{port}" in found and "no setpoints; give one another number" in found
        time.sleep(4.0)
        assert [len(vehicle.setpoints) for vehicle in vehicles] == [0, 0]
        assert all(command == 511 for vehicle in vehicles for _, command in vehicle.commands)
        assert sum("two vehicles have this system id" in text for _, text in vehicles[0].texts + vehicles[1].texts) >= 1
        # One of them is switched off, and its pilot gives the other one to the companion.
        vehicles[1].mute = True
        time.sleep(12.0)
        vehicles[0].armed = True
        vehicles[0].pilot(GUIDED)
        process.wait_for("companion has control", 25)
        process.wait_for("arrived", 20)
        (counts,) = report(process)["vehicles"]
    assert counts["hand_overs"] == 0 and not vehicles[1].setpoints, counts


def test_a_second_vehicle_ends_control_at_once(tmp_path, free_port, staya):
    port = free_port()
    line = Line("127.0.0.1", port)
    first, second = Vehicle(1, "rover", line), Vehicle(1, "rover", Behind(line), (0.0, 20.0))
    second.mute = True
    with Fleet([first, second]):
        process = start(tmp_path, staya, port, goal=(60.0, 0.0))
        process.wait_for("companion has control", 20)
        second.mute = False
        process.wait_for("two vehicles send as system 1", 8)
        count = len(first.setpoints)
        time.sleep(3.0)
        assert len(first.setpoints) <= count + 2, "no setpoint afterwards"
        ends_well(process)


def test_a_port_of_mavlink_1_is_named_with_the_remedy(tmp_path, free_port, staya):
    port = free_port()
    vehicle = Old(1, "rover", Port1("127.0.0.1", port))
    with Fleet([vehicle], RADIUS):
        began = time.monotonic()
        process = start(tmp_path, staya, port)
        process.wait_for("SERIALn_PROTOCOL 2", 10)
        assert time.monotonic() - began < 10.0
        assert "MAVLink 1 only" in ends_well(process)
    assert not vehicle.setpoints


def test_a_port_of_mavlink_2_is_not(tmp_path, free_port, staya):
    port = free_port()
    vehicle = Vehicle(1, "rover", Line("127.0.0.1", port))
    with Fleet([vehicle], RADIUS):
        process = start(tmp_path, staya, port)
        process.wait_for("arrived", 30)
        assert "SERIALn" not in ends_well(process)


def test_junk_is_named_if_no_autopilot_is_heard(tmp_path, free_port, staya):
    port = free_port()
    line = Line("127.0.0.1", port)
    process = start(tmp_path, staya, port, "", (6.0, 0.0), "--wait", "3")
    # The program may start late on a busy machine.
    end = time.monotonic() + 20
    while process.is_running() and time.monotonic() < end:
        line.send(time.monotonic(), bytes(range(60, 100)))
        line.turn(time.monotonic())
        time.sleep(0.1)
    assert process.wait(10) != 0
    assert "bytes that are not MAVLink: check the baud rate" in process.output(), process.output()
    line.close()


def test_a_companion_steers_a_vehicle_of_the_bridge(tmp_path, free_port, staya):
    port = free_port()
    scenario = tmp_path / "bridge.toml"
    scenario.write_text(
        'name = "one"\nticks = 100000\ntick_s = 0.05\n[plane]\nradius_m = 0.4\nmax_speed_mps = 2\n'
        "[[plane.robots.list]]\nstart_m = [0, 0]\ngoal_m = [0, 0]\n"
    )
    origin = ",".join(map(str, ORIGIN))
    bridge = staya("bridge", scenario, "--mavlink", f"udpout:127.0.0.1:{port}", "--disarmed", "--json", "--quiet", f"--origin={origin}")
    process = start(tmp_path, staya, port, goal=(8.0, 0.0))
    process.wait_for("companion has control", 20)
    process.wait_for("arrived", 20)
    place = wait_until(lambda: report(process)["vehicles"][0]["position_m"], 1)
    assert math.hypot(place[0] - 8.0, place[1]) < 0.5, place
    bridge.interrupt()
    commands = json.loads(bridge.output())["commands"]
    assert "denied" not in commands and commands["accepted"] >= 2, commands
