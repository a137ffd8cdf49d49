"""Two vehicles approach each other while the network between their companions fails at any moment:
they do not collide."""

import math
import socket
import threading
import time

import pytest
from companion_setup import RADIUS, ends_well, write_config, write_scenario
from conftest import wait_until
from fake_autopilot import GUIDED, Fleet, Vehicle
from fake_line import Line

SPEED = 1.5
# Initial distance in metres; at full speed they meet after four seconds.
WAY = 12.0
STANDS = 0.05


class Lan:
    """A network between two companions, `[air]` for each of them, that can be interrupted."""

    def __init__(self, free_port):
        self.is_cut, self._over = False, threading.Event()
        self._sockets = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2)]
        for each in self._sockets:
            each.bind(("127.0.0.1", 0))
            each.settimeout(0.1)
        self._companions = [("127.0.0.1", free_port()) for _ in range(2)]
        self._threads = [threading.Thread(target=self._relay, args=way, daemon=True) for way in ((0, 1), (1, 0))]

    def air(self, one):
        return '[air]\nbind = "%s:%d"\npeers = ["%s:%d"]' % (*self._companions[one], *self._sockets[one].getsockname())

    def _relay(self, one, other):
        while not self._over.is_set():
            try:
                data = self._sockets[one].recv(4096)
            except OSError:
                # No data, or no receiver yet.
                continue
            if not self.is_cut:
                self._sockets[other].sendto(data, self._companions[other])

    def __enter__(self):
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, *_):
        self._over.set()
        for thread in self._threads:
            thread.join()
        for each in self._sockets:
            each.close()


# Each second until they are side by side.
@pytest.mark.parametrize("after_s", [1.0, 2.0, 3.0, 4.0])
def test_two_vehicles_without_contact_stop_before_they_touch(tmp_path, free_port, staya, after_s):
    robots = [((0.0, 0.0), (WAY, 0.0)), ((WAY, 0.1), (0.0, 0.1))]
    write_scenario(tmp_path, robots, speed=SPEED)
    ports = [free_port(), free_port()]
    vehicles = [Vehicle(i + 1, "rover", Line("127.0.0.1", ports[i]), robots[i][0], armed=True) for i in range(2)]
    with Lan(free_port) as lan, Fleet(vehicles, RADIUS) as fleet:
        processes = []
        for i in range(2):
            config = write_config(tmp_path, [ports[i]], "rover", air=lan.air(i), name=f"config-{i}.toml", robots=[i + 1])
            processes.append(staya("companion", config))
        for i, process in enumerate(processes):
            process.wait_for(f"found robot {2 - i}")
        for vehicle in vehicles:
            vehicle.pilot(GUIDED)
        wait_until(lambda: all(abs(v.east - start[0]) > 0.05 for v, (start, _) in zip(vehicles, robots)), 5, "setting off")
        time.sleep(after_s)
        lan.is_cut = True

        def stand():
            return all(math.hypot(*v.velocity[:2]) < STANDS and v.setpoints[-1][1:] == (0.0, 0.0, 0.0) for v in vehicles)

        wait_until(stand, 12, "standing")
        for process in processes:
            process.wait_for("lost contact to all robots")
        print(f"cut after {after_s} s: {fleet.least_gap:.2f} m between them at least")
        assert fleet.least_gap > 0.0, f"they touched: {fleet.least_gap} m"
        for process in processes:
            ends_well(process)
