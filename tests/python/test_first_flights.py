"""First flights with `staya bridge`: scripts that make the calls of the clients' own examples, in
their order, and without knowledge of Staya."""

import os
import sys
import time
from pathlib import Path

import pytest
from conftest import wait_until
from test_bridge_mavproxy import PROXY, Console

SCRIPTS = Path(__file__).with_name("first_flights")


@pytest.fixture
def fly(staya, free_port, run):
    """A function that starts a bridge with one vehicle, and a script with the variables of a user's
    shell. Returns the script's output after its end."""

    def start(script, kind, address, *options):
        port = free_port()
        bridge = staya("bridge", f"tests/cases/clients/{kind}.toml", "--mavlink", f"udpout:127.0.0.1:{port}", "--json", "--quiet", *options)
        user = {"MAVLINK_DIALECT": "ardupilotmega", "MAVLINK20": "", "PYTHONUNBUFFERED": "1"}
        program = run(sys.executable, SCRIPTS / script, address.format(port), kind, free_port(), cwd=SCRIPTS, env=user)
        code = program.wait(90)
        assert code == 0 and "done" in program.output(), f"{code}\n{program.output()}\n{bridge.output()}"
        bridge.interrupt()
        return program.output()

    return start


@pytest.mark.parametrize("script, kind", [
    ("dronekit_goto.py", "copter"), ("dronekit_rover.py", "rover"), ("dronekit_mission.py", "copter"),
    ("dronekit_mission.py", "rover"), ("dronekit_state.py", "copter"), ("dronekit_state.py", "rover"),
])
def test_dronekit(fly, script, kind):
    fly(script, kind, "udp:127.0.0.1:{}", "--disarmed")


@pytest.mark.parametrize("script, kind", [
    ("mavsdk_takeoff.py", "copter"), ("mavsdk_offboard.py", "copter"), ("mavsdk_offboard.py", "rover"),
    ("mavsdk_mission.py", "copter"), ("mavsdk_mission.py", "rover"),
])
def test_mavsdk(fly, script, kind):
    fly(script, kind, "udpin://127.0.0.1:{}", "--disarmed")


@pytest.mark.parametrize("kind", ["copter", "rover"])
def test_pymavlink(fly, kind):
    fly("pymavlink_guide.py", kind, "udpin:127.0.0.1:{}", "--disarmed")


MISSION = """QGC WPL 110
0	0	0	16	0	0	0	0	47.397742	8.545594	488	1
1	0	3	16	0	0	0	0	47.397842	8.545594	10	1
2	0	3	16	0	0	0	0	47.397842	8.545744	10	1
3	0	3	16	0	0	0	0	47.397742	8.545744	10	1
"""


@pytest.mark.skipif(not PROXY.is_file(), reason="no MAVProxy in this environment")
@pytest.mark.parametrize("kind", ["copter", "rover"])
def test_mavproxy(staya, free_port, tmp_path, kind):
    port = free_port()
    bridge = staya("bridge", f"tests/cases/clients/{kind}.toml", "--mavlink", f"udpout:127.0.0.1:{port}", "--disarmed", "--json", "--quiet")
    (tmp_path / "way.txt").write_text(MISSION)
    console = Console(tmp_path, port, system=1)
    try:
        # Until then MAVProxy has the mode numbers of another kind of vehicle.
        wait_until(lambda: "Detected vehicle" in console.text(), 25, "a heartbeat")
        console.type("mode GUIDED", "GUIDED>")
        console.type("arm throttle", "ARMED")
        if kind == "copter":
            console.type("takeoff 10", "NAV_TAKEOFF: ACCEPTED")
            time.sleep(4.0)
        console.type("guided 47.397792 8.545594 10", "DO_REPOSITION: ACCEPTED")
        console.type("wp load way.txt", "TYPE_MISSION: ACCEPTED", timeout=20)
        console.type("wp list", "Saved 4 waypoints", timeout=20)
        # A part of the mission, by MISSION_WRITE_PARTIAL_LIST.
        for change in ["wp changealt 2 15", "wp param 3 1 0.5"]:
            console.type(change, "TYPE_MISSION: ACCEPTED", timeout=20)
        console.type("wp list", "15.000000", timeout=20)
        console.type("wp set 2", "waypoint 2", timeout=20)
        console.type("mode AUTO", "AUTO>")
        console.type("wp status", "mission done", timeout=40)
        console.type("rtl", "RTL>")
        if kind == "copter":
            console.type("mode BRAKE", "BRAKE>")
            console.type("mode LAND", "DISARMED", timeout=40)
        else:
            console.type("mode HOLD", "HOLD>")
            console.type("disarm", "DISARMED")
        console.type("fence list", "fence", timeout=20)
        assert "ERROR" not in console.text() and "timed out" not in console.text().lower(), console.text()
    finally:
        console.close()
    bridge.interrupt()
    assert '"denied"' not in bridge.output(), bridge.output()
