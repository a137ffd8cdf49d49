"""Compares `staya bridge` with a vehicle on pymavlink: both answer PINGs by UDP.

    STAYA=target/release/staya python tests/python/bench_bridge.py

One client with prepared messages queries both, with a fixed number of PINGs in transit. The measure
is the processor time of the server for one PING and its answer, system calls included, which hardly
depends on the client and on other programs. Fails if the bridge is not at least GOAL times as fast,
and without system calls at least OWN_GOAL times.
"""

import os
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ["MAVLINK20"] = "1"
from pymavlink.dialects.v20 import common  # noqa: E402

GOAL = 1.5
# System calls cost the same for both.
OWN_GOAL = 5.0
WINDOW = 64
ROOT = Path(__file__).resolve().parents[2]
SCENARIO = """
name = "one"
ticks = 1
tick_s = 1
[plane]
radius_m = 0.25
max_speed_mps = 1
[[plane.robots.list]]
start_m = [0, 0]
"""


def answer(port):
    """A vehicle on pymavlink."""
    sink = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sink.bind(("127.0.0.1", port))
    mav = common.MAVLink(None, srcSystem=1, srcComponent=1)
    while True:
        data, peer = sink.recvfrom(2048)
        for message in mav.parse_buffer(data) or []:
            if message.get_type() == "PING" and message.target_system == 0:
                reply = mav.ping_encode(message.time_usec, message.seq, message.get_srcSystem(), message.get_srcComponent())
                sink.sendto(reply.pack(mav), peer)


def processor_seconds(pid):
    """Processor time of a process and of the system on its behalf, all threads."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return [int(field) / os.sysconf("SC_CLK_TCK") for field in fields[11:13]]


def measure(process, port, count):
    """Seconds and processor seconds for `count` PINGs."""
    mav = common.MAVLink(None, srcSystem=255, srcComponent=190)
    pings = [common.MAVLink_ping_message(1, number, 0, 0).pack(mav) for number in range(256)]
    client = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    client.connect(("127.0.0.1", port))
    client.settimeout(0.5)
    ping_id = bytes([4, 0, 0])
    # Waits for the server.
    deadline = time.monotonic() + 20
    while True:
        try:
            client.send(pings[0])
            while client.recv(2048)[7:10] != ping_id:
                pass
            break
        except (TimeoutError, ConnectionRefusedError):
            if time.monotonic() > deadline:
                raise
            time.sleep(0.05)
    sent = answered = lost = 0
    began, busy = time.monotonic(), processor_seconds(process.pid)
    while answered + lost < count:
        while sent < count and sent - answered - lost < WINDOW:
            client.send(pings[sent % 256])
            sent += 1
        try:
            # Telemetry does not count.
            answered += client.recv(2048)[7:10] == ping_id
        except TimeoutError:
            lost = sent - answered
    took = time.monotonic() - began
    busy = [after - before for after, before in zip(processor_seconds(process.pid), busy)]
    client.close()
    if lost > count // 100:
        raise SystemExit(f"{lost} of {count} PINGs were not answered")
    return took, busy


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
        udp.bind(("127.0.0.1", 0))
        return udp.getsockname()[1]


def main():
    program = os.environ.get("STAYA", str(ROOT / "target/release/staya"))
    with tempfile.TemporaryDirectory() as folder:
        scenario = Path(folder) / "one.toml"
        scenario.write_text(SCENARIO)

        def bridge(port):
            return [program, "bridge", str(scenario), "--mavlink", f"udpin:127.0.0.1:{port}", "--rate", "0.1", "--quiet"]

        def python(port):
            return [sys.executable, __file__, "answer", str(port)]

        print(f"{'PINGs answered over UDP':<26}{'a second':>12}{'us of processor each':>24}{'own':>8}{'system':>8}")
        each = {}
        for name, command, count in [("staya bridge", bridge, 100_000), ("pymavlink", python, 20_000)]:
            port = free_port()
            process = subprocess.Popen(command(port), stdout=subprocess.DEVNULL)
            try:
                took, busy = measure(process, port, count)
            finally:
                process.terminate()
                process.wait()
            each[name] = [sum(busy) / count, max(busy[0], 0.01) / count]
            own, system = (seconds / count * 1e6 for seconds in busy)
            print(f"{name:<26}{count / took:>12.0f}{own + system:>24.1f}{own:>8.1f}{system:>8.1f}")
    whole, own = (other / ours for other, ours in zip(each["pymavlink"], each["staya bridge"]))
    is_met = whole >= GOAL and own >= OWN_GOAL
    print(f"per message {whole:.1f} times as fast as pymavlink, at least {GOAL}; without the system's calls {own:.1f} times, at least {OWN_GOAL}")
    print("met" if is_met else "MISSED")
    return 0 if is_met else 1


if __name__ == "__main__":
    sys.exit(answer(int(sys.argv[2])) if sys.argv[1:2] == ["answer"] else main())
