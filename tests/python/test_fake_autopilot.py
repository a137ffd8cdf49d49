"""The fake autopilots behave like ArduPilot: they get a companion's messages from recorded flights
and give the same answers."""

import gzip
import math
import struct
from collections import Counter
from pathlib import Path

import pytest
from fake_autopilot import PILOT, Vehicle
from pymavlink.dialects.v20 import ardupilotmega as mavlink

FLIGHTS = Path(__file__).resolve().parents[1] / "data/ardupilot"
STEP_S = 0.02
# Messages that a companion reads, besides answers.
STREAMS = ["HEARTBEAT", "GLOBAL_POSITION_INT", "LOCAL_POSITION_NED", "EXTENDED_SYS_STATE"]


def recorded(name, system, until):
    """`(seconds, message)` of one vehicle's autopilot and companion, in order."""
    data = gzip.decompress((FLIGHTS / f"{name}.tlog.gz").read_bytes())
    codec, at, first = mavlink.MAVLink(None), 0, None
    while at < len(data):
        (micros,) = struct.unpack_from(">Q", data, at)
        first = first or micros
        size = 12 + data[at + 9]
        (message,) = codec.parse_buffer(data[at + 8 : at + 8 + size])
        at += 8 + size
        seconds = (micros - first) / 1e6
        if seconds > until:
            return
        if message.get_srcSystem() == system:
            yield seconds, message


class Wire:
    """A line without time and position."""

    def __init__(self):
        self.sent, self.arrived = [], []

    def send(self, now, data):
        self.sent.append((now, data))

    def turn(self, now):
        arrived, self.arrived = self.arrived, []
        return arrived


def answers(kind, system, messages, until):
    """Messages of a fake autopilot to the same companion: `(seconds, message)`."""
    wire = Wire()
    vehicle = Vehicle(system, kind, wire, mode=PILOT)
    waiting = [(at, message) for at, message in messages if message.get_srcComponent() == 191]
    for step in range(int(until / STEP_S)):
        now = step * STEP_S
        while waiting and waiting[0][0] <= now:
            wire.arrived.append(bytes(waiting.pop(0)[1].get_msgbuf()))
        vehicle.turn(now, STEP_S)
    codec = mavlink.MAVLink(None)
    return [(at, message) for at, data in wire.sent for message in codec.parse_buffer(data)]


def changes(values):
    """Without repetitions."""
    values = list(values)
    return [value for i, value in enumerate(values) if i == 0 or values[i - 1] != value]


def of(messages, kind):
    return [message for _, message in messages if message.get_type() == kind and message.get_srcComponent() == 1]


@pytest.mark.parametrize("name, kind, system, until", [("rovers-crossing", "rover", 1, 27.0), ("rovers-crossing", "rover", 4, 27.0), ("copter-crossing", "copter", 1, 60.0)])
def test_a_fake_answers_like_ardupilot(name, kind, system, until):
    real = list(recorded(name, system, until))
    fake = answers(kind, system, real, until)

    def acknowledged(messages):
        return [(ack.command, ack.result) for ack in of(messages, "COMMAND_ACK")]

    assert acknowledged(fake) == acknowledged(real)

    def states(messages):
        return changes((beat.type, beat.autopilot, beat.base_mode, beat.custom_mode) for beat in of(messages, "HEARTBEAT"))

    assert states(fake) == states(real)

    def landed(messages):
        return changes(state.landed_state for state in of(messages, "EXTENDED_SYS_STATE"))

    assert landed(fake) == landed(real)
    for stream in STREAMS:
        rates = [len(of(messages, stream)) / until for messages in (fake, real)]
        assert math.isclose(*rates, rel_tol=0.1, abs_tol=0.05), (stream, rates)

    def way(messages):
        first, *_, last = (at for at in of(messages, "GLOBAL_POSITION_INT") if at.lat != 0)
        east = (last.lon - first.lon) * math.cos(math.radians(last.lat / 1e7))
        return [0.0111319 * (last.lat - first.lat), 0.0111319 * east, (last.relative_alt - first.relative_alt) / 1e3]

    off = math.dist(way(fake), way(real))
    assert off < 0.05 * math.hypot(*way(real)) + 1.0, (way(fake), way(real))


@pytest.mark.parametrize("name, system", [("rovers-gps-lost", 3), ("rovers-crossing", 2)])
def test_a_fake_reports_health_like_ardupilot(name, system):
    """Health messages, in good condition and without GPS."""
    gps_and_ahrs = 1 << 5 | 1 << 21

    def health(messages):
        fixes = Counter((at.fix_type, at.satellites_visible) for at in of(messages, "GPS_RAW_INT"))
        flags = Counter(ekf.flags for ekf in of(messages, "EKF_STATUS_REPORT"))
        sensors = Counter(
            (s.onboard_control_sensors_present & s.onboard_control_sensors_enabled & ~s.onboard_control_sensors_health) & gps_and_ahrs
            for s in of(messages, "SYS_STATUS")
        )
        return set(fixes), set(flags), set(sensors)

    # Until dead reckoning ends, which the fake one does not model.
    real = list(recorded(name, system, 12.0))
    wire = Wire()
    vehicle = Vehicle(system, "rover", wire)
    vehicle.rates |= {24: 4.0, 193: 4.0, 1: 4.0}
    for step in range(200):
        vehicle.gps_lost = name == "rovers-gps-lost" and step > 100
        vehicle.turn(step * STEP_S, STEP_S)
    codec = mavlink.MAVLink(None)
    fake = [(at, message) for at, data in wire.sent for message in codec.parse_buffer(data)]
    assert health(fake) == health(real)
