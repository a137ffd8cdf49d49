"""Links between fake autopilots and a companion that lose, delay and damage data."""

import heapq
import random
import socket
from dataclasses import dataclass, field


@dataclass
class Faults:
    """Faults of a link in either direction; equal seeds give equal faults."""

    drop: float = 0.0
    delay_s: float = 0.0
    corrupt: float = 0.0
    seed: int = 1
    dice: random.Random = field(init=False)

    def __post_init__(self):
        self.dice = random.Random(self.seed)

    def pass_on(self, data: bytes):
        """`(delay, data)`, or None for a lost datagram."""
        if self.dice.random() < self.drop:
            return None
        if self.dice.random() < self.corrupt:
            at = self.dice.randrange(len(data))
            data = data[:at] + bytes([data[at] ^ (1 << self.dice.randrange(8))]) + data[at + 1 :]
        return self.dice.random() * self.delay_s, data


class Line:
    """A UDP link to a companion with faults."""

    def __init__(self, host: str, port: int, faults: Faults | None = None):
        self.to = (host, port)
        self.faults = faults or Faults()
        self.is_cut = False
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1" if host.startswith("127.") or host == "localhost" else "0.0.0.0", 0))
        self.socket.setblocking(False)
        self.waiting = []
        self.count = 0

    def _queue(self, now, is_out, data):
        passed = None if self.is_cut else self.faults.pass_on(data)
        if passed is not None:
            self.count += 1
            heapq.heappush(self.waiting, (now + passed[0], self.count, is_out, passed[1]))

    def send(self, now: float, data: bytes):
        self._queue(now, True, data)

    def _receive(self) -> bytes | None:
        while True:
            try:
                return self.socket.recv(4096)
            except BlockingIOError:
                return None
            except OSError:
                # The companion does not listen yet.
                continue

    def _send(self, data: bytes):
        try:
            self.socket.sendto(data, self.to)
        except OSError:
            pass

    def turn(self, now: float) -> list[bytes]:
        """Sends due data and returns received data."""
        while data := self._receive():
            self._queue(now, False, data)
        arrived = []
        while self.waiting and self.waiting[0][0] <= now:
            _, _, is_out, data = heapq.heappop(self.waiting)
            if is_out:
                self._send(data)
            else:
                arrived.append(data)
        return arrived

    def close(self):
        self.socket.close()


class Server(Line):
    """A TCP link with faults; the companion connects, as to ArduPilot's simulator."""

    def __init__(self, host: str, port: int, faults: Faults | None = None):
        self.faults, self.is_cut, self.waiting, self.count = faults or Faults(), False, [], 0
        self.socket = socket.create_server((host, port))
        self.socket.setblocking(False)
        self.peer = None

    def _receive(self):
        try:
            if self.peer is None:
                self.peer, _ = self.socket.accept()
                self.peer.setblocking(False)
            data = self.peer.recv(4096)
        except BlockingIOError:
            return None
        except OSError:
            data = b""
        if not data:
            self._hang_up()
        return data

    def _send(self, data):
        try:
            if self.peer is not None:
                self.peer.sendall(data)
        except OSError:
            self._hang_up()

    def _hang_up(self):
        if self.peer is not None:
            self.peer.close()
        self.peer = None

    def close(self):
        self._hang_up()
        super().close()
