"""A minimal ground station on pymavlink for tests of `staya bridge`."""

import json
import math
import time

from pymavlink import mavutil

LAT, LON, ALT = 47.397742, 8.545594, 488.0
POSITION, VELOCITY, BOTH = 0xDF8, 0xDC7, 0xDC0
LOCAL_NED = 1
AUTO, GUIDED, HOLD, RTL = 10, 15, 4, 11


class Bridge:
    """A running bridge and a client of it."""

    def __init__(self, staya, port, scenario, *options, speed=5):
        self.link = mavutil.mavlink_connection(f"udpin:127.0.0.1:{port}", source_system=255, source_component=190)
        self.sink = self.link.mav
        line = f"udpout:127.0.0.1:{port}"
        self.process = staya("bridge", scenario, "--mavlink", line, "--speed", speed, "--json", "--quiet", *options)

    def close(self):
        self.link.close()

    def next(self, kind, system=None, timeout=10.0, where=lambda message: True):
        """The next message of a type (or of several) from one vehicle that fulfils a condition."""
        deadline = time.monotonic() + timeout
        while time.monotonic() < deadline:
            message = self.link.recv_match(type=kind, blocking=True, timeout=0.2)
            if message is None:
                continue
            if system in (None, message.get_srcSystem()) and where(message):
                return message
        raise AssertionError(f"no {kind} of {system} in {timeout} s; {self.process.output()}")

    def text(self, system, part, timeout=10.0):
        """Waits until a vehicle sends a text that contains these words."""
        return self.next("STATUSTEXT", system, timeout, lambda text: part in text.text)

    def drop(self):
        """Drops received messages."""
        while self.link.recv_msg() is not None:
            pass

    def command(self, system, command, *params, component=1):
        """Result of a COMMAND_LONG."""
        params = (list(params) + [0.0] * 7)[:7]
        self.drop()
        self.sink.command_long_send(system, component, command, 0, *params)
        return self.next("COMMAND_ACK", system or None, where=lambda ack: ack.command == command).result

    def command_int(self, system, command, params=(), x=0, y=0, z=0.0, frame=6):
        """Result of a COMMAND_INT."""
        params = (list(params) + [0.0] * 4)[:4]
        self.drop()
        self.sink.command_int_send(system, 1, frame, command, 0, 0, *params, x, y, z)
        return self.next("COMMAND_ACK", system or None, where=lambda ack: ack.command == command).result

    def mode(self, system, mode):
        assert self.command(system, 176, 1, mode) == 0
        self.next("HEARTBEAT", system, where=lambda beat: beat.custom_mode == mode)

    def reposition(self, system, north, east, up=0.0, flags=1):
        """DO_REPOSITION to metres from the origin, accurate within some tens of metres."""
        latitude = LAT + math.degrees(north / 6_367_500.0)
        longitude = LON + math.degrees(east / (6_388_000.0 * math.cos(math.radians(LAT))))
        return self.command_int(system, 192, (-1, flags, 0, math.nan), round(latitude * 1e7), round(longitude * 1e7), up)

    def set_local(self, system, mask, position=(0, 0, 0), velocity=(0, 0, 0), frame=LOCAL_NED):
        self.sink.set_position_target_local_ned_send(
            0, system, 1, frame, mask, *position, *velocity, 0, 0, 0, math.nan, math.nan
        )

    def position(self, system, where=lambda message: True, timeout=10.0):
        return self.next("LOCAL_POSITION_NED", system, timeout, where)

    def arrives(self, system, north, east, near=0.3, timeout=15.0):
        """Waits until a vehicle reaches a position."""
        return self.position(system, lambda at: math.hypot(at.x - north, at.y - east) < near, timeout)

    def end(self):
        """Stops with Ctrl-C. Returns the report."""
        assert self.process.interrupt() == 0, self.process.output()
        return json.loads(self.process.output())
