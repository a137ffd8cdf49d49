"""ArduPilot's own code in its simulator, one process per vehicle, with the vehicles' pilots.

The first serial port of a vehicle (MAVLink 0) is its pilot's: it receives modes, arming, parameters
and faults, and sends the true state of the simulation (SIM_STATE), by which flights are judged. The
second port is the companion's. Both use UDP to 127.0.0.1; all other ports are closed.
"""

import bisect
import math
import os
import selectors
import socket
import threading
import time
from dataclasses import dataclass
from pathlib import Path

from conftest import wait_until
from pymavlink.dialects.v20 import ardupilotmega as mavlink

# ArduPilot's default home near Canberra, CMAC, which is also the origin of the examples in
# companions/.
ORIGIN = (-35.363261, 149.165230, 584.0)
# Custom modes.
ROVER = {"MANUAL": 0, "HOLD": 4, "GUIDED": 15}
COPTER = {"STABILIZE": 0, "GUIDED": 4, "LOITER": 5, "LAND": 9, "BRAKE": 17}
# A station that ArduPilot does not take for its ground station, whose silence would trigger a
# failsafe.
STATION = 250
# Speed-up until positions are available, limited by the load of the machine.
WARM_UP = 10
# Rate of the true state, Hz.
TRUTH_HZ = 20
READY_S = 240.0
ARMED = 128
# Bits of SYS_STATUS: GPS and AHRS, which a companion checks too, and readiness to arm.
TRUSTED, PREARM_CHECK = 1 << 5 | 1 << 21, 1 << 28
# Time without problems before the start: a companion needs 5 s, and the end of the warm-up delays
# GPS.
WELL_S = 6.0
# Parameters of this project beyond those of ArduPilot's own tests: no logs on disk.
PARAMETERS = """
LOG_BACKEND_TYPE 0
LOG_DISARMED 0
"""


def metres_per_degree():
    """Radii of curvature of WGS 84 at the origin, north and east."""
    squashed = 6.69437999014e-3
    s = math.sin(math.radians(ORIGIN[0]))
    w = 1.0 - squashed * s * s
    north = 6378137.0 * (1.0 - squashed) / w**1.5
    east = 6378137.0 / math.sqrt(w) * math.cos(math.radians(ORIGIN[0]))
    return math.radians(north), math.radians(east)


NORTH_M, EAST_M = metres_per_degree()


@dataclass(frozen=True)
class Truth:
    """True state of a vehicle: metres east and north of the origin and up from its start, m/s,
    radians from north to east."""

    at: float
    east: float
    north: float
    up: float
    speed: float
    yaw: float


class Autopilot:
    """One vehicle: its process, its pilot's actions, and received messages with their times
    (`time.time()`)."""

    def __init__(self, kind, number, start, folder: Path, run, companion_port, stick_port, *, model=None, heading=90, defaults=(), parameters=""):
        self.kind, self.number, self.start = kind, number, start
        self.modes = ROVER if kind == "rover" else COPTER
        self.binary = os.environ[f"STAYA_{kind.upper()}"]
        self.model = model or {"rover": "rover", "copter": "+"}[kind]
        self.heading, self.run = heading, run
        self.companion_port, self.stick_port = companion_port, stick_port
        self.folder = folder / f"vehicle-{number}"
        self.folder.mkdir()
        files = Path(os.environ["STAYA_AUTOPILOT_DEFAULTS"])
        own = self.folder / "staya.parm"
        own.write_text(PARAMETERS + parameters)
        self.defaults = ",".join(str(path) for path in [files / f"{kind}.parm", *(files / name for name in defaults), own])
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.setblocking(False)
        self.peer = None
        self.codec = mavlink.MAVLink(None, srcSystem=STATION, srcComponent=190)
        self.codec.robust_parsing = True
        self.last, self.beats, self.texts, self.states, self.landed, self.acknowledged = {}, [], [], [], [], []
        self.truth: list[Truth] = []
        self.process = None

    def switch_on(self, speedup=WARM_UP):
        """Starts the process."""
        latitude, longitude = ORIGIN[0] + self.start[1] / NORTH_M, ORIGIN[1] + self.start[0] / EAST_M
        ports = ["--rc-in-port", self.stick_port, "--serial0", f"udpclient:127.0.0.1:{self.socket.getsockname()[1]}", "--serial1", f"udpclient:127.0.0.1:{self.companion_port}"]
        for closed in (2, 5, 6, 7, 8):
            ports += [f"--serial{closed}", "none:0"]
        home = f"{latitude:.8f},{longitude:.8f},{ORIGIN[2]},{self.heading}"
        self.last, self.peer, self.unwell = {}, None, time.time()
        self.process = self.run(
            self.binary, "--model", self.model, "--home", home, "--defaults", self.defaults, "--sysid", self.number, "--instance", self.number,
            "--speedup", speedup, *ports, cwd=self.folder,
        )

    # Methods of the receiving thread.

    def hear(self):
        """Handles received messages."""
        while True:
            try:
                data, self.peer = self.socket.recvfrom(4096)
            except BlockingIOError:
                return
            except OSError:
                continue
            for message in self.codec.parse_buffer(data) or []:
                if message.get_srcComponent() == 1:
                    self._take(time.time(), message)

    def _take(self, now, message):
        kind = message.get_type()
        self.last[kind] = (now, message)
        if kind == "HEARTBEAT":
            self.beats.append((now, message.custom_mode, bool(message.base_mode & ARMED)))
        elif kind == "STATUSTEXT":
            self.texts.append((now, message.text))
        elif kind == "SYS_STATUS":
            is_well = TRUSTED | PREARM_CHECK
            if message.onboard_control_sensors_health & is_well != is_well:
                self.unwell = now
        elif kind == "EXTENDED_SYS_STATE":
            self.landed.append((now, message.landed_state))
        elif kind == "COMMAND_ACK":
            self.acknowledged.append((now, message.command, message.result))
        elif kind == "SIM_STATE":
            east, north = (message.lon_int / 1e7 - ORIGIN[1]) * EAST_M, (message.lat_int / 1e7 - ORIGIN[0]) * NORTH_M
            self.truth.append(Truth(now, east, north, message.alt - ORIGIN[2], math.hypot(message.vn, message.ve), message.yaw))

    # Actions of the pilot.

    def send(self, message):
        if self.peer is not None:
            self.socket.sendto(message.pack(self.codec), self.peer)

    def command(self, number, *parameters):
        parameters = (*parameters, *[0.0] * (7 - len(parameters)))
        self.send(mavlink.MAVLink_command_long_message(self.number, 1, number, 0, *parameters))

    def interval(self, message_id, hz):
        self.command(511, message_id, 1e6 / hz)

    def set(self, name, value, timeout=10.0):
        """Sets a parameter, with retries until the autopilot confirms it."""

        def is_so():
            self.send(mavlink.MAVLink_param_set_message(self.number, 1, name.encode(), value, 9))
            time.sleep(0.2)
            _, said = self.last.get("PARAM_VALUE", (0, None))
            return said is not None and said.param_id == name and abs(said.param_value - value) < 1e-3

        wait_until(is_so, timeout, f"{name} = {value} of vehicle {self.number}")

    def choose(self, mode, timeout=10.0):
        """Selects a mode. Returns the time of the heartbeat that confirms it."""
        number, asked = self.modes[mode], time.time()

        def is_so():
            self.command(176, 1, number)
            time.sleep(0.1)
            return next((at for at, custom, _ in self.beats if at > asked and custom == number), None)

        return wait_until(is_so, timeout, f"{mode} of vehicle {self.number}")

    def arm(self, timeout=60.0):
        def is_so():
            self.command(400, 1)
            time.sleep(0.3)
            return self.is_armed

        wait_until(is_so, timeout, f"arming vehicle {self.number} ({self.texts[-3:]})")

    def take_off(self, height):
        self.command(22, 0, 0, 0, 0, 0, 0, height)

    # Received messages.

    @property
    def is_armed(self):
        return bool(self.beats) and self.beats[-1][2]

    @property
    def mode(self):
        return self.beats[-1][1] if self.beats else None

    @property
    def height(self):
        """Height above home by the vehicle's estimate, metres."""
        return self.last["GLOBAL_POSITION_INT"][1].relative_alt / 1e3

    def place(self, at):
        """True position east, north, up at a time, interpolated; None outside of the recorded time."""
        after = bisect.bisect_left(self.truth, at, key=lambda truth: truth.at)
        if not 0 < after < len(self.truth):
            return None
        a, b = self.truth[after - 1], self.truth[after]
        share = (at - a.at) / max(b.at - a.at, 1e-6)
        return tuple(x + share * (y - x) for x, y in ((a.east, b.east), (a.north, b.north), (a.up, b.up)))

    def between(self, since, until=math.inf):
        return [truth for truth in self.truth if since <= truth.at <= until]

    def off(self, goal):
        """Horizontal distance to a point, metres."""
        return math.hypot(self.truth[-1].east - goal[0], self.truth[-1].north - goal[1]) if self.truth else math.inf

    def is_ready(self):
        """Whether the vehicle can be armed: it has a position, and its own checks pass."""
        _, place = self.last.get("GLOBAL_POSITION_INT", (0, None))
        if place is None or "SYS_STATUS" not in self.last or "SIM_STATE" not in self.last:
            return False
        return place.lat != 0 and self.unwell < self.last["SYS_STATUS"][0]

    def boot_ms(self):
        return self.last["GLOBAL_POSITION_INT"][1].time_boot_ms


class Simulation:
    """Vehicles and their receiving thread, for the duration of the `with` block."""

    RATES = {1: 2, 24: 2, 33: 10, 108: TRUTH_HZ, 124: 2, 193: 2, 245: 4}

    def __init__(self, vehicles):
        self.vehicles = list(vehicles)
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self.error = None

    def __enter__(self):
        for vehicle in self.vehicles:
            vehicle.switch_on()
        self._thread.start()
        self.ready()
        return self

    def __exit__(self, *_):
        self._over.set()
        self._thread.join()
        for vehicle in self.vehicles:
            vehicle.process.close()
            vehicle.socket.close()
        if self.error:
            raise self.error

    def __getitem__(self, number) -> Autopilot:
        return self.vehicles[number - 1]

    def _listen(self):
        selector = selectors.DefaultSelector()
        for vehicle in self.vehicles:
            selector.register(vehicle.socket, selectors.EVENT_READ, vehicle)
        try:
            while not self._over.is_set():
                for key, _ in selector.select(0.1):
                    key.data.hear()
        except Exception as error:  # The test's own thread tells of it.
            self.error = error

    def ready(self, vehicles=None):
        """Waits until all vehicles can be armed, at the highest speed of the machine. Then time is
        real time."""
        vehicles = vehicles or self.vehicles
        asked = 0.0

        def all_are():
            nonlocal asked
            for vehicle in vehicles:
                assert vehicle.process.is_running(), f"vehicle {vehicle.number} ended:\n{vehicle.process.output()}"
            if time.monotonic() - asked > 3.0:
                asked = time.monotonic()
                for vehicle in vehicles:
                    for number, hz in self.RATES.items():
                        vehicle.interval(number, hz)
            return all(vehicle.is_ready() for vehicle in vehicles)

        try:
            wait_until(all_are, READY_S, "readiness of all")
        except AssertionError as error:
            raise AssertionError(f"{error}; they say {[vehicle.texts[-4:] for vehicle in vehicles if not vehicle.is_ready()]}") from None
        for vehicle in vehicles:
            vehicle.set("SIM_SPEEDUP", 1)
        wait_until(lambda: all(time.time() - vehicle.unwell > WELL_S for vehicle in vehicles), READY_S, "all being well")
        self._from = [(time.time(), vehicle.boot_ms()) for vehicle in self.vehicles]

    def pace(self):
        """Speed of the slowest vehicle's simulation since `ready`, relative to real time."""
        now = time.time()
        return min((vehicle.boot_ms() - ms) / 1e3 / (now - at) for vehicle, (at, ms) in zip(self.vehicles, self._from))

    def nearest(self, since, until, only=None):
        """Smallest true distance between two vehicles, metres, with their numbers and the time;
        with `only` between one vehicle and the others."""
        best, steps = (math.inf, 0, 0, since), int((until - since) * TRUTH_HZ)
        places = {vehicle.number: [vehicle.place(since + step / TRUTH_HZ) for step in range(steps)] for vehicle in self.vehicles}
        for a in self.vehicles:
            for b in self.vehicles:
                if a.number >= b.number or only not in (None, a.number, b.number):
                    continue
                for step, (p, q) in enumerate(zip(places[a.number], places[b.number])):
                    if p and q:
                        best = min(best, (math.dist(p, q), a.number, b.number, since + step / TRUTH_HZ))
        return best
