"""Processor time of `staya bridge` for a message, beside a vehicle on pymavlink that does the same work.

    STAYA=target/release/staya python tests/python/bench_bridge.py

A client streams velocity setpoints by UDP. The vehicle decodes and obeys each one. A PING follows every 199 setpoints, and
the client waits for its answer, so the client never sends more than the socket holds. The bridge limits answers to about a
thousand a second for each client; setpoints are not answered, and the PINGs of a whole run stay below the limit.

The figure is the processor time of the vehicle's process for each message, system calls included: the speed of the client
and other programs hardly affect it. Both vehicles run in turn, and the median of the ratios counts. Exits with an error if
the bridge takes more than 1/GOAL of pymavlink's time, or its own code without system calls more than 1/OWN_GOAL.
"""

import os
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ["MAVLINK20"] = "1"
from pymavlink.dialects.v20 import common  # noqa: E402

GOAL = 2.5
# Both make the same system calls.
OWN_GOAL = 5.0
# Messages for each answer.
BATCH = 200
# The bridge gives a thousand answers at once without a limit.
BATCHES = 900
LOST = 9
ROUNDS = 3
PING, SETPOINT, ACK = 4, 84, 77
VELOCITY, LOCAL_NED, GUIDED = 0xDC7, 1, 15
ROOT = Path(__file__).resolve().parents[2]
SCENARIO = """
name = "one"
ticks = 1
tick_s = 0.5
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
    mode, is_armed, wish = 0, False, None
    while True:
        data, peer = sink.recvfrom(2048)
        for message in mav.parse_buffer(data) or []:
            kind = message.get_msgId()
            if kind == SETPOINT and message.target_system == 1:
                if is_armed and mode == GUIDED and message.type_mask == VELOCITY:
                    wish = (message.vx, message.vy, message.vz)
            elif kind == PING and message.target_system == 0:
                reply = mav.ping_encode(message.time_usec, message.seq, message.get_srcSystem(), message.get_srcComponent())
                sink.sendto(reply.pack(mav), peer)
            elif message.get_type() == "COMMAND_LONG":
                if message.command == 176:
                    mode = int(message.param2)
                else:
                    is_armed = message.param1 == 1
                sink.sendto(mav.command_ack_encode(message.command, 0).pack(mav), peer)


def processor_seconds(pid):
    """A process's own time, and that of the system for it, with all threads."""
    stat = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    own, system = (int(field) for field in stat[11:13])
    threads = Path(f"/proc/{pid}/task").iterdir()
    # Nanoseconds; the other two are hundredths of seconds, good for the share of each.
    whole = sum(int((thread / "schedstat").read_text().split()[0]) for thread in threads) * 1e-9
    return whole, own, system


class Client:
    """A client that neither makes nor reads messages while it measures."""

    def __init__(self, port):
        self.mav = common.MAVLink(None, srcSystem=255, srcComponent=190)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(("127.0.0.1", port))
        self.socket.settimeout(0.5)

    def wait(self, kind):
        """The next message of this kind; raises TimeoutError without one."""
        deadline = time.monotonic() + 0.5
        while time.monotonic() < deadline:
            data = self.socket.recv(2048)
            if int.from_bytes(data[7:10], "little") == kind:
                return self.mav.parse_buffer(data)[0]
        raise TimeoutError

    def ask(self, message, kind):
        """Sends a message until it is answered."""
        deadline = time.monotonic() + 20
        while True:
            try:
                self.socket.send(message.pack(self.mav))
                return self.wait(kind)
            except (TimeoutError, ConnectionRefusedError):
                if time.monotonic() > deadline:
                    raise
                time.sleep(0.05)

    def prepare(self):
        """Arms the vehicle in the mode in which it obeys setpoints."""
        for command, params in [(176, (1, GUIDED)), (400, (1, 0))]:
            ack = self.ask(common.MAVLink_command_long_message(1, 1, command, 0, *params, 0, 0, 0, 0, 0), ACK)
            if ack.result != 0:
                raise SystemExit(f"command {command} is refused: {ack}")

    def measure(self, pid):
        """Seconds, processor seconds of the process, and those without system calls."""

        def setpoint(number):
            velocity = (0.1 + number * 1e-3, 0.1, 0)
            return common.MAVLink_set_position_target_local_ned_message(
                number, 1, 1, LOCAL_NED, VELOCITY, 0, 0, 0, *velocity, 0, 0, 0, 0, 0
            ).pack(self.mav)

        batch = [setpoint(number) for number in range(BATCH - 1)]
        ping = common.MAVLink_ping_message(1, 1, 0, 0).pack(self.mav)
        lost = 0
        began, busy = time.monotonic(), processor_seconds(pid)
        for _ in range(BATCHES):
            for message in batch:
                self.socket.send(message)
            self.socket.send(ping)
            try:
                self.wait(PING)
            except TimeoutError:
                lost += 1
        took = time.monotonic() - began
        whole, own, system = (after - before for after, before in zip(processor_seconds(pid), busy))
        if lost > LOST:
            raise SystemExit(f"{lost} of {BATCHES} PINGs were not answered")
        own = whole * max(own, 1) / max(own + system, 1)
        return took, whole, own


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

        print(f"{'setpoints obeyed over UDP':<26}{'a second':>12}{'us of processor each':>24}{'own':>8}{'system':>8}")
        count = BATCH * BATCHES
        ratios = []
        for _ in range(ROUNDS):
            each = {}
            for name, command in [("staya bridge", bridge), ("pymavlink", python)]:
                port = free_port()
                process = subprocess.Popen(command(port), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                try:
                    client = Client(port)
                    client.prepare()
                    took, whole, own = client.measure(process.pid)
                finally:
                    process.terminate()
                    process.wait()
                each[name] = whole, own
                us = [seconds / count * 1e6 for seconds in (whole, own, whole - own)]
                print(f"{name:<26}{count / took:>12.0f}{us[0]:>24.2f}{us[1]:>8.2f}{us[2]:>8.2f}")
            ratios.append([other / ours for other, ours in zip(each["pymavlink"], each["staya bridge"])])
    whole, own = (statistics.median(column) for column in zip(*ratios))
    is_met = whole >= GOAL and own >= OWN_GOAL
    print(f"per message {whole:.1f} times as fast as pymavlink, at least {GOAL}; without system calls {own:.1f} times, at least {OWN_GOAL}")
    print("met" if is_met else "MISSED")
    return 0 if is_met else 1


if __name__ == "__main__":
    sys.exit(answer(int(sys.argv[2])) if sys.argv[1:2] == ["answer"] else main())
