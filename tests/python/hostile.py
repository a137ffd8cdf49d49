"""Hostile clients and a well-behaved one, each in its own process, for `soak.py`.

Each function runs until `over` is set, and returns the numbers of sent items, which the test
compares with the report of `staya`.
"""

import os
import random
import select
import socket
import struct
import time

os.environ["MAVLINK20"] = "1"
os.environ.setdefault("MAVLINK_DIALECT", "staya")
from pymavlink.dialects.v20 import staya as dialect  # noqa: E402

HOST = "127.0.0.1"
REQUEST_MESSAGE, AUTOPILOT_VERSION, HEARTBEAT_ID, ACK_ID = 512, 148, b"\0\0\0", b"\x4d\0\0"
# Seconds between 1970 and 2015, the start of MAVLink's timestamps.
MAVLINK_EPOCH = 1_420_070_400
DAY = 86_400


def codec(system, key=None, ahead_s=0.0, link=0):
    """Builds frames; with a key they are signed by a clock that is ahead by `ahead`."""
    made = dialect.MAVLink(None, srcSystem=system, srcComponent=190)
    if key:
        made.signing.secret_key, made.signing.sign_outgoing, made.signing.link_id = key, True, link
        made.signing.timestamp = int((time.time() + ahead_s - MAVLINK_EPOCH) * 1e5)
    return made


def heartbeat(made):
    return dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3).pack(made)


def request(made, system):
    return dialect.MAVLink_command_long_message(system, 1, REQUEST_MESSAGE, 0, AUTOPILOT_VERSION, 0, 0, 0, 0, 0, 0).pack(made)


def datagrams(port):
    sink = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sink.bind((HOST, 0))
    sink.connect((HOST, port))
    sink.setblocking(False)
    return sink


def send(sink, data):
    """Whether the system accepted the datagram."""
    try:
        sink.send(data)
        return True
    except (BlockingIOError, ConnectionRefusedError):
        return False


def station(over, port, system, vehicles, key=None):
    """A ground station with a heartbeat and five requests per second, each sent up to three times
    at intervals of 0.5 s. Returns the number and the delays of answers."""
    made, sink, dice = codec(system, key), datagrams(port), random.Random(system)
    sink.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
    found = dict(sent=0, requests=0, answered=0, tries=0, waits_ms=[])
    beat_at = 0.0

    def say(frame):
        found["sent"] += send(sink, frame)

    def is_answered(target, until):
        while (left := until - time.monotonic()) > 0:
            if not select.select([sink], [], [], left)[0]:
                return False
            try:
                data = sink.recv(2048)
            except (BlockingIOError, ConnectionRefusedError):
                continue
            # An acknowledgement of this vehicle for this station; the payload ends with the
            # station's ids.
            if data[7:10] == ACK_ID and data[5] == target and len(data) >= 22 and data[18] == system:
                return True
        return False

    while not over.is_set():
        began = time.monotonic()
        if began >= beat_at:
            say(heartbeat(made))
            beat_at = began + 1.0
        target = dice.randrange(1, vehicles + 1)
        found["requests"] += 1
        for _ in range(3):
            found["tries"] += 1
            say(request(made, target))
            if is_answered(target, time.monotonic() + 0.5):
                found["answered"] += 1
                found["waits_ms"].append((time.monotonic() - began) * 1e3)
                break
        over.wait(max(0.0, began + 0.2 - time.monotonic()))
    found["waits_ms"].sort()
    return found


def flood(over, port, system, vehicles, rate):
    """A peer that sends valid frames at a fixed rate: commands, parameter requests, PINGs,
    setpoints."""
    made, sink = codec(system), datagrams(port)
    frames = []
    for vehicle in range(1, vehicles + 1):
        frames.append(request(made, vehicle))
        frames.append(dialect.MAVLink_param_request_list_message(vehicle, 1).pack(made))
        frames.append(dialect.MAVLink_ping_message(1, vehicle, 0, 0).pack(made))
        frames.append(
            dialect.MAVLink_set_position_target_local_ned_message(0, vehicle, 1, 1, 0xDC7, 0, 0, 0, 0.5, 0, 0, 0, 0, 0, 0, 0).pack(made)
        )
    found = dict(sent=0, seconds=0.0)
    began, number = time.monotonic(), 0
    while not over.is_set():
        due = int((time.monotonic() - began) * rate) - number
        # Late frames are not made up for.
        number += max(0, due - rate // 50)
        for _ in range(min(due, rate // 50)):
            found["sent"] += send(sink, frames[number % len(frames)])
            number += 1
        time.sleep(0.001)
    found["seconds"] = time.monotonic() - began
    return found


def junk(over, port, ports=200, size=64, rate=500):
    """Random bytes from many ports."""
    dice, sinks = random.Random(port), [datagrams(port) for _ in range(ports)]
    found = dict(sent=0, bytes=0, size=size)
    while not over.is_set():
        for sink in dice.sample(sinks, 10):
            is_sent = send(sink, dice.randbytes(size))
            found["sent"] += is_sent
            found["bytes"] += size * is_sent
        over.wait(10 / rate)
    return found


def half_open(over, port, connections=60):
    """TCP connections that send nothing or junk, and end abruptly."""
    dice, held = random.Random(port), []
    found = dict(opened=0)

    def drop(sink):
        sink.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        sink.close()

    while not over.is_set():
        while len(held) > connections - 5:
            drop(held.pop(dice.randrange(len(held))))
        while len(held) < connections:
            sink = socket.socket()
            sink.settimeout(1.0)
            try:
                sink.connect((HOST, port))
                if dice.random() < 0.5:
                    # The start of a frame without an end.
                    sink.send(b"\xfd\xff\0\0" + dice.randbytes(20))
                found["opened"] += 1
                held.append(sink)
            except OSError:
                sink.close()
                break
        over.wait(0.5)
    for sink in held:
        drop(sink)
    return found


def cut_and_restored(over, port, system, every_s=4.0):
    """A station whose TCP link is cut every few seconds. Returns the delays until it receives the
    vehicles again."""
    made = codec(system)
    found = dict(links=0, heard=0, waits_ms=[], sent=0)
    while not over.is_set():
        began = time.monotonic()
        found["links"] += 1
        try:
            with socket.create_connection((HOST, port), 2.0) as sink:
                sink.settimeout(0.2)
                has_heard = False
                while time.monotonic() - began < every_s and not over.is_set():
                    if not has_heard:
                        sink.sendall(heartbeat(made))
                        found["sent"] += 1
                    try:
                        data = sink.recv(65536)
                    except TimeoutError:
                        continue
                    if not data:
                        break
                    if not has_heard:
                        has_heard = True
                        found["heard"] += 1
                        found["waits_ms"].append((time.monotonic() - began) * 1e3)
        except OSError:
            pass
        if over.is_set() and time.monotonic() - began < every_s:
            # Unknown, since the run ended first.
            found["links"] = found["heard"]
        over.wait(0.3)
    found["waits_ms"].sort()
    return found


def impostors(over, port, key, rate=50):
    """Frames without the key, replayed ones, and ones with future timestamps, at a fixed rate of
    each kind and each from its own port."""
    honest, stranger = codec(240, key, link=7), codec(241)
    forger, hasty = codec(242, bytes(32), link=8), codec(243, key, ahead_s=30 * DAY, link=9)
    sinks = {kind: datagrams(port) for kind in ("honest", "unsigned", "forged", "replayed", "ahead")}
    found = dict.fromkeys(sinks, 0)
    recorded = heartbeat(honest)
    while not found["honest"]:
        found["honest"] += send(sinks["honest"], recorded)
        time.sleep(0.1)
    # The original frames arrive before their replays.
    time.sleep(0.3)
    while not over.is_set():
        for kind, frame in [
            ("unsigned", request(stranger, 1)), ("forged", request(forger, 1)), ("replayed", recorded), ("ahead", request(hasty, 1))
        ]:
            found[kind] += send(sinks[kind], frame)
        over.wait(1 / rate)
    return found
