"""The page of `staya companion --view`: it shows the companions' knowledge, and control does not
depend on it."""

import math
import re
import struct

from companion_setup import RADIUS, ends_well, write_config, write_scenario
from conftest import wait_until
from fake_autopilot import GUIDED, Fleet, Vehicle
from fake_line import Line
from page_client import Page

ROBOTS = [((0.0, 0.0), (12.0, 0.0)), ((12.0, 0.2), (0.0, 0.2)), ((6.0, 30.0), (6.0, 30.0))]


def address(process) -> str:
    return wait_until(lambda: re.search(r"http://\S+token=\w+", process.output()), what="an address")[0]


def places(frame: bytes) -> list[tuple[float, float]]:
    (bodies,) = struct.unpack_from("<I", frame, 16)
    x, y = (struct.unpack_from(f"<{bodies}f", frame, 32 + 4 * bodies * axis) for axis in range(2))
    return list(zip(x, y))


def test_the_page_shows_vehicles_and_dead_pages_cost_nothing(tmp_path, free_port, staya):
    write_scenario(tmp_path, ROBOTS)
    ports, lan = [free_port(), free_port()], [free_port(), free_port()]
    vehicles = [Vehicle(i + 1, "rover", Line("127.0.0.1", ports[i]), ROBOTS[i][0], mode=GUIDED, armed=True) for i in range(2)]
    with Fleet(vehicles, RADIUS) as fleet:
        processes = []
        for i, pair in enumerate([lan, lan[::-1]]):
            air = '[air]\nbind = "127.0.0.1:%d"\npeers = ["127.0.0.1:%d"]' % tuple(pair)
            config = write_config(tmp_path, [ports[i]], "rover", air=air, name=f"config-{i}.toml", robots=[i + 1])
            processes.append(staya("companion", config, *(["--view"] if i == 0 else [])))
        url = address(processes[0])
        # These pages never read, and one of them is dead.
        deaf = [Page(url) for _ in range(10)]
        deaf[0].close()
        page = Page(url)
        scene = page.until(lambda message: message["type"] == "scene")
        assert scene["mode"] == "watch" and scene["robots"]["id"] == [1, 2, 3]
        page.say({"do": "select", "robot": 0})
        page.say({"do": "links", "on": True})

        def about(message):
            return message["type"] == "robot" and message["neighbors"] and ["companion", "companion has control"] in message["facts"]

        robot = page.until(about)
        (other,) = robot["neighbors"]
        # Its position comes from its own beacons, without an independent measurement.
        assert other["index"] == 1 and other["age_s"] < 2 and other["error_m"] is None
        page.until(lambda message: message["type"] == "links" and message["pairs"])
        while not isinstance(frame := page.read(), bytes):
            pass
        (x, y), heard, unheard = places(frame)
        assert math.hypot(x - vehicles[0].east, y - vehicles[0].north) < 1.0
        assert math.hypot(heard[0] - vehicles[1].east, heard[1] - vehicles[1].north) < 1.0
        assert all(map(math.isnan, unheard))
        wait_until(lambda: all(math.hypot(v.east - goal[0], v.north - goal[1]) < 0.5 for v, (_, goal) in zip(vehicles, ROBOTS)), 45)
        assert fleet.least_gap > 0.0
        ends_well(processes[0])
        while page.read() is not None:
            pass
        ends_well(processes[1])
