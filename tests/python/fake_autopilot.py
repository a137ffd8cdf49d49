"""Fake autopilots with ArduPilot's and PX4's behaviour towards a companion, and vehicles that
follow velocities.

By hand, six rovers at the companion's port, armed and in GUIDED:

    python fake_autopilot.py --kind rover --count 6 --link udpout:127.0.0.1:14550 --mode guided
--armed

Modelled behaviour: ArduPilot stops 3 s after the last velocity. PX4 refuses OFFBOARD without a
stream of setpoints, and leaves it 1 s after the last one. A lost ground station (system 255)
changes the mode after 5 s. Copters ignore velocities before their takeoff. Before the position is
ready, ArduPilot sends 0, 0 and PX4 nothing, and neither arms. A restart resets modes, rates and
arming.
"""

import argparse
import math
import os
import threading
import time

from fake_line import Faults, Line, Server

os.environ.setdefault("MAVLINK20", "1")
from pymavlink.dialects.v20 import ardupilotmega as mavlink

# ArduPilot's default home, CMAC.
ORIGIN = (-35.363261, 149.165230, 584.0)

GUIDED, PILOT, FAILSAFE = "guided", "pilot", "failsafe"
MODES = {
    # MANUAL, HOLD.
    "rover": {GUIDED: 15, PILOT: 0, FAILSAFE: 4},
    # STABILIZE, RTL.
    "copter": {GUIDED: 4, PILOT: 0, FAILSAFE: 6},
    # OFFBOARD, POSCTL, AUTO.LOITER.
    "px4": {GUIDED: 6 << 16, PILOT: 3 << 16, FAILSAFE: (4 << 16) | (3 << 24)},
}
VELOCITY_VALID_S = 3.0
OFFBOARD_LOSS_S = 1.0
STREAM_S = 0.5
# Time from the command until a copter leaves the ground.
SPOOL_UP_S = 2.4
# Flags of a heartbeat's base mode.
CUSTOM, GUIDES, STABILIZES, TAKES_STICKS, IS_ARMED = 1, 8, 16, 64, 128
GROUND_STATION_S = 5.0


class Vehicle:
    """An autopilot and its vehicle. Positions are metres east, north, up of the origin."""

    def __init__(self, system, kind, line, start=(0.0, 0.0), *, mode=PILOT, armed=False, position_after=0.0, origin=ORIGIN, airborne=False,
                 key=None):
        self.system, self.kind, self.line, self.origin = system, kind, line, origin
        self.mode, self.armed = mode, armed
        self.east, self.north = start
        self.up = 5.0 if airborne else 0.0
        self.velocity = [0.0, 0.0, 0.0]
        self.wish = [0.0, 0.0, 0.0]
        self.climb_to, self.spools_up = None, 0.0
        # Heading of a rover, radians from north to east.
        self.heading = math.radians(90.0)
        self.position_after = position_after
        self.max_speed, self.max_acceleration, self.lag = 5.0, 3.0, 0.3
        self.mute = False
        self.mute_position = False
        # Whether its estimator uses dead reckoning, and reports that.
        self.gps_lost = False
        self.down_until = None
        self.key = key
        self.setpoints, self.commands, self.heard = [], [], []
        self.texts = []
        self.started = None
        # A real autopilot with a position has been running for this time.
        self.uptime_s = 45.0
        self._start()

    def _start(self):
        self.codec = mavlink.MAVLink(None, srcSystem=self.system, srcComponent=1)
        self.codec.robust_parsing = True
        if self.key:
            self.codec.signing.secret_key = self.key
            self.codec.signing.sign_outgoing = True
            self.codec.signing.link_id = 0
            self.codec.signing.timestamp = int((time.time() - 1420070400) * 1e5)
        self.rates = {0: 1.0, 33: 4.0, 32: 4.0, 2: 1.0}
        self.due = {}
        self.booted = None
        self.last_setpoint = None
        self.stream_since = None
        self.ground_station = None
        self.wish = [0.0, 0.0, 0.0]

    # Actions of the pilot.

    def pilot(self, mode=PILOT):
        """Selects a mode and sends a heartbeat at once."""
        self.mode = mode
        self.due[0] = time.monotonic()

    def reboot(self, down_s=1.0, mode=PILOT):
        self.down_until = time.monotonic() + down_s
        self.uptime_s = 0.0
        self.mode, self.armed = mode, False

    def take_off(self, height):
        """Takes off to a height. Returns whether it does; a vehicle in the air refuses."""
        does = self.kind == "copter" and self.mode == GUIDED and self.armed and self.up < 0.1
        if does and self.climb_to is None:
            self.climb_to, self.spools_up = height, SPOOL_UP_S
        return does

    # Behaviour of the autopilot.

    @property
    def is_ready(self):
        return time.monotonic() - self.started >= self.position_after

    def boot_ms(self, now):
        return int((now - self.booted) * 1000)

    def pack(self, now, message):
        self.line.send(now, message.pack(self.codec))

    def turn(self, now: float, dt: float):
        """Advances by one step. Returns broadcast frames for the links of other vehicles."""
        if self.started is None:
            self.started = now
        if self.down_until is not None:
            self.line.turn(now)
            if now < self.down_until:
                self._move(dt)
                return []
            self.down_until = None
            self._start()
        if self.booted is None:
            self.booted = now - self.uptime_s
        forward = []
        for data in self.line.turn(now):
            for message in self.codec.parse_buffer(data) or []:
                if message.get_type() == "BAD_DATA":
                    continue
                self._hear(now, message)
                if message.get_type() == "TUNNEL" and message.target_system == 0:
                    forward.append(bytes(message.get_msgbuf()))
        self._watch(now)
        self._move(dt)
        if not self.mute:
            self._tell(now)
        return forward

    def _hear(self, now, message):
        kind, source = message.get_type(), (message.get_srcSystem(), message.get_srcComponent())
        self.heard.append((now, kind, source))
        if kind == "HEARTBEAT" and source[0] == 255:
            self.ground_station = now
        elif kind == "STATUSTEXT":
            self.texts.append((now, message.text))
        elif kind == "COMMAND_LONG" and message.target_system == self.system:
            self.commands.append((now, message.command))
            result = self._command(now, message)
            self.pack(now, mavlink.MAVLink_command_ack_message(message.command, result, 0, 0, *source))
        elif kind == "SET_POSITION_TARGET_LOCAL_NED" and message.target_system == self.system:
            self._setpoint(now, message)

    def _setpoint(self, now, message):
        velocity, velocity_and_yaw_rate = 0xDC7, 0x5C7
        assert message.coordinate_frame == 1 and message.type_mask in (velocity, velocity_and_yaw_rate), message
        self.setpoints.append((now, message.vx, message.vy, message.vz))
        if self.last_setpoint is None or now - self.last_setpoint > STREAM_S:
            self.stream_since = now
        self.last_setpoint = now
        if self.mode == GUIDED and self.armed and (self.kind == "rover" or self.up > 0.3 or self.kind == "px4"):
            # A velocity aborts a takeoff, as in ArduCopter.
            self.climb_to = None
            if self.kind == "rover" and message.type_mask == velocity:
                # ArduRover derives its heading from the velocity; zero means north.
                self.heading = math.atan2(message.vy, message.vx)
            self.wish = [message.vy, message.vx, -message.vz if self.kind != "rover" else 0.0]

    def _command(self, now, message):
        accepted, rejected, denied, unsupported, failed = 0, 1, 2, 3, 4
        p1, p2 = message.param1, message.param2
        if message.command == 511:
            self.rates[int(p1)] = 1e6 / p2 if p2 > 0 else 0.0
            return accepted
        if message.command == 176:
            number = int(p2) << 16 if self.kind == "px4" else int(p2)
            wanted = [name for name, mode in MODES[self.kind].items() if mode == number]
            if not wanted or not int(p1) & 1:
                return denied
            if wanted == [GUIDED] and self.kind == "px4" and not self._has_stream(now):
                return rejected
            self.mode = wanted[0]
            self.pack(now, self._message(now, 0))
            return accepted
        if message.command == 400:
            if p1 and not self.is_ready:
                return failed
            self.armed = bool(p1)
            return accepted
        if message.command == 22:
            return accepted if self.take_off(message.param7) else failed
        return unsupported

    def _has_stream(self, now):
        return self.last_setpoint is not None and now - self.last_setpoint < STREAM_S and now - self.stream_since >= STREAM_S

    def _watch(self, now):
        """The documented timeouts."""
        age = math.inf if self.last_setpoint is None else now - self.last_setpoint
        if self.kind == "px4":
            if self.mode == GUIDED and age > OFFBOARD_LOSS_S:
                self.mode = FAILSAFE
        elif age > VELOCITY_VALID_S:
            self.wish = [0.0, 0.0, 0.0]
        if self.mode != GUIDED or not self.armed:
            self.wish = [0.0, 0.0, 0.0]
            self.climb_to = None
        if self.ground_station is not None and now - self.ground_station > GROUND_STATION_S and self.mode == GUIDED:
            self.mode = FAILSAFE

    def _move(self, dt):
        wish = list(self.wish)
        if self.climb_to is not None:
            self.spools_up -= dt
            left = self.climb_to - self.up
            wish = [0.0, 0.0, max(-2.0, min(2.0, 2.0 * left)) if self.spools_up <= 0.0 else 0.0]
            if left < 0.1:
                self.climb_to = None
        speed = math.hypot(*wish)
        if speed > self.max_speed:
            wish = [v * self.max_speed / speed for v in wish]
        change = [(w - v) / self.lag for w, v in zip(wish, self.velocity)]
        size = math.hypot(*change)
        if size > self.max_acceleration:
            change = [c * self.max_acceleration / size for c in change]
        self.velocity = [v + c * dt for v, c in zip(self.velocity, change)]
        self.east += self.velocity[0] * dt
        self.north += self.velocity[1] * dt
        self.up = max(0.0, self.up + self.velocity[2] * dt)

    def place(self):
        """Converts metres to degrees by the radii of curvature of WGS 84 at the origin."""
        lat, lon, alt = self.origin
        s = math.sin(math.radians(lat))
        w = 1.0 - 6.69437999014e-3 * s * s
        north = 6378137.0 * (1.0 - 6.69437999014e-3) / w**1.5
        east = 6378137.0 / math.sqrt(w) * math.cos(math.radians(lat))
        return lat + math.degrees(self.north / north), lon + math.degrees(self.east / east), alt + self.up

    def _tell(self, now):
        for number, hz in self.rates.items():
            if hz <= 0.0 or now < self.due.get(number, 0.0):
                continue
            self.due[number] = max(self.due.get(number, now) + 1.0 / hz, now - 1.0 / hz)
            message = self._message(now, number)
            if message is not None:
                self.pack(now, message)

    def _message(self, now, number):
        m, ms = mavlink, self.boot_ms(now)
        ve, vn, vu = self.velocity
        if number == 0:
            types = {"rover": 10, "copter": 2, "px4": 2}
            base = CUSTOM | (IS_ARMED if self.armed else 0) | (GUIDES if self.mode == GUIDED else 0)
            base |= {"rover": TAKES_STICKS if self.mode == PILOT else 0, "copter": TAKES_STICKS | STABILIZES, "px4": 0}[self.kind]
            return m.MAVLink_heartbeat_message(types[self.kind], 12 if self.kind == "px4" else 3, base, MODES[self.kind][self.mode], 4, 3)
        if number == 2:
            return m.MAVLink_system_time_message(0, ms)
        if number == 245:
            on_ground, in_air, taking_off = 1, 2, 3
            flies = on_ground if self.up < 0.1 else in_air if self.climb_to is None else taking_off
            return m.MAVLink_extended_sys_state_message(0, flies)
        if number == 24:
            no_fix, rtk_fixed = 1, 6
            fix = rtk_fixed if self.is_ready and not self.gps_lost else no_fix
            return m.MAVLink_gps_raw_int_message(0, fix, 0, 0, 0, 121, 200, 0, 0, 10 if fix == rtk_fixed else 3)
        if number == 1:
            gps, ahrs = 1 << 5, 1 << 21
            enabled = gps | ahrs if self.is_ready else gps
            return m.MAVLink_sys_status_message(gps | ahrs, enabled, gps | ahrs, 0, 12600, 0, 0, 0, 0, 0, 0, 0, 0)
        if number == 193 and self.kind != "px4":
            return m.MAVLink_ekf_status_report_message(0x33F if self.is_ready else 0xA7, 0.01, 0.0, 0.02, 0.03, 0.0)
        if number == 230 and self.kind == "px4":
            return m.MAVLink_estimator_status_message(0, 0x33F if self.is_ready else 0xA7, *[0.01] * 8)
        if self.mute_position or number not in (32, 33) or (not self.is_ready and self.kind == "px4"):
            return None
        if number == 32:
            return m.MAVLink_local_position_ned_message(ms, self.north, self.east, -self.up, vn, ve, -vu)
        if not self.is_ready:
            return m.MAVLink_global_position_int_message(ms, 0, 0, 0, 0, 0, 0, 0, 65535)
        lat, lon, alt = self.place()
        cm = [int(round(100 * v)) for v in (vn, ve, -vu)]
        return m.MAVLink_global_position_int_message(
            ms, round(lat * 1e7), round(lon * 1e7), round(alt * 1e3), round(self.up * 1e3), *cm, 65535
        )


class Fleet:
    """Vehicles that move in real time on their own thread, for the duration of the `with` block."""

    STEP_S = 0.02

    def __init__(self, vehicles, radius=0.0):
        self.vehicles, self.radius = list(vehicles), radius
        self.least_gap = math.inf
        self.lock = threading.RLock()
        self._over = threading.Event()
        self.error = None
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._over.set()
        self._thread.join()
        for vehicle in self.vehicles:
            vehicle.line.close()
        if self.error:
            raise self.error

    def _run(self):
        last = time.monotonic()
        try:
            while not self._over.is_set():
                time.sleep(self.STEP_S / 2)
                now = time.monotonic()
                with self.lock:
                    self._turn(now, min(now - last, 0.1))
                last = now
        except Exception as error:  # The test's own thread tells of it.
            self.error = error

    def _turn(self, now, dt):
        for vehicle in self.vehicles:
            for frame in vehicle.turn(now, dt):
                # As in a mesh of telemetry radios.
                for other in self.vehicles:
                    if other is not vehicle:
                        other.line.send(now, frame)
        for i, a in enumerate(self.vehicles):
            for b in self.vehicles[:i]:
                gap = math.hypot(a.east - b.east, a.north - b.north) - 2.0 * self.radius
                self.least_gap = min(self.least_gap, gap)


def main():
    parser = argparse.ArgumentParser(description="Fake autopilots for `staya companion`.")
    parser.add_argument("--kind", choices=sorted(MODES), default="rover")
    parser.add_argument("--link", default="udpout:127.0.0.1:14550", help="where the companion listens, or tcpin:HOST:PORT, where it connects (further vehicles: 10 ports on each)")
    parser.add_argument("--count", type=int, default=1, help="vehicles in a row, 3 m apart, systems 1, 2, ...")
    parser.add_argument("--system", type=int, default=1, help="system of the first")
    parser.add_argument("--start", default="0,0", help="metres east,north of the origin, of the first")
    parser.add_argument("--origin", default=",".join(map(str, ORIGIN)), help="latitude,longitude,altitude")
    parser.add_argument("--mode", choices=[PILOT, GUIDED], default=PILOT)
    parser.add_argument("--armed", action="store_true")
    parser.add_argument("--position-after", type=float, default=0.0, help="seconds until the position is ready")
    parser.add_argument("--drop", type=float, default=0.0)
    parser.add_argument("--delay", type=float, default=0.0, help="seconds at most")
    parser.add_argument("--corrupt", type=float, default=0.0)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    scheme, host, port = options.link.split(":")
    if scheme not in ("udpout", "tcpin"):
        parser.error("only udpout:HOST:PORT and tcpin:HOST:PORT")
    east, north = map(float, options.start.split(","))
    vehicles = []
    for i in range(options.count):
        faults = Faults(options.drop, options.delay, options.corrupt, options.seed + i)
        line = Line(host, int(port), faults) if scheme == "udpout" else Server(host, int(port) + 10 * i, faults)
        vehicles.append(
            Vehicle(
                options.system + i, options.kind, line, (east + 3.0 * i, north), mode=options.mode, armed=options.armed,
                position_after=options.position_after, origin=tuple(map(float, options.origin.split(","))),
            )
        )
    with Fleet(vehicles) as fleet:
        try:
            while fleet.error is None:
                time.sleep(1.0)
                with fleet.lock:
                    for v in vehicles:
                        print(f"system {v.system}: {v.mode}, {'armed' if v.armed else 'disarmed'}, {v.east:.2f} m east, {v.north:.2f} m north, "
                              f"{v.up:.2f} m up, {len(v.setpoints)} setpoints", flush=True)
        except KeyboardInterrupt:
            pass


if __name__ == "__main__":
    main()
