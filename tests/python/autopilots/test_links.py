"""Links to ArduPilot: signed, tunnelled, refused."""

import secrets
import socket
import threading
import time

import pytest
from flight import arrive, figures, fly, least, moving, needs  # noqa: F401
from pymavlink.dialects.v20 import ardupilotmega as mavlink

pytestmark = needs("rover")
# Side by side, so that no vehicle is in the way.
STARTS, GOALS = [(0.0, 0.0), (0.0, 8.0)], [(12.0, 0.0), (12.0, 8.0)]


def sign(simulation, key):
    """Gives all vehicles a key, as a ground station does by cable."""
    stamp = int((time.time() - 1420070400) * 1e5)
    for _ in range(3):
        for vehicle in simulation.vehicles:
            vehicle.send(mavlink.MAVLink_setup_signing_message(vehicle.number, 1, key, stamp))
        time.sleep(0.3)


@pytest.mark.parametrize("right", [True, False], ids=["right", "wrong"])
def test_signed_links_need_the_right_key(fly, free_port, right):
    key = secrets.token_bytes(32)
    with fly.vehicles("rover", STARTS, free_port) as simulation:
        sign(simulation, key)
        file = fly.folder / "link.key"
        file.write_text((key if right else secrets.token_bytes(32)).hex() + "\n")
        file.chmod(0o600)
        config = fly.config(fly.scenario(zip(STARTS, GOALS)), "ardupilot-rover", 'entry = "once"\narm = true')
        started = time.time()
        if right:
            companion = fly.companion(config, "--link-key", file)
            begun = moving(simulation, started)
            ended = arrive(simulation, GOALS, 90)
            words = least(simulation, begun)
            report = companion.finish()
            figures(f"right key: there in {ended - begun:.1f} s, {words}, {sum(link['refused'] for link in report['links'])} frames refused")
            return
        companion = fly.companion(config, "--link-key", file)
        companion.wait_for("messages rejected: not signed with the key", 15)
        time.sleep(5.0)
        speeds = [truth.speed for vehicle in simulation.vehicles for truth in vehicle.between(started)]
        report = companion.finish()
        refused = sum(link["refused"] for link in report["links"])
        figures(f"wrong key: {refused} frames refused, nothing armed, nothing moved, said within 15 s why")
        assert not any(vehicle.is_armed for vehicle in simulation.vehicles) and max(speeds) < 0.1 and refused > 20
        assert not any(m.get_srcComponent() == 1 for _, m in companion.messages()), "what was not believed is in the log"


def test_a_refused_tcp_link_is_reported_and_retried(fly, free_port):
    """The link is TCP, as in the examples. A relay starts after the companion and forwards bytes to
    the vehicle's port."""
    with fly.vehicles("rover", STARTS[:1], free_port) as simulation:
        port = free_port()
        config = fly.config(fly.scenario([(STARTS[0], GOALS[0])]), "ardupilot-rover", 'entry = "once"\narm = true')
        config.write_text(config.read_text().replace(f"udpin:127.0.0.1:{fly.ports[1]}", f"tcpout:127.0.0.1:{port}"))
        companion = fly.companion(config)
        companion.wait_for("no connection: ")
        refused = time.time()
        time.sleep(2.0)
        with Relay(port, fly.ports[1]):
            companion.wait_for(": connected")
            connected = time.time()
            begun = moving(simulation, refused)
            ended = arrive(simulation, GOALS[:1], 60)
            companion.finish()
        said = companion.process.output().count("no connection: ")
        figures(f"refusal reported once, connected {connected - refused - 2.0:.1f} s after the relay started; arrived in {ended - begun:.1f} s")
        assert said == 1, companion.process.output()


class Relay:
    """Relays between a local TCP port for the companion and a UDP port of a vehicle's autopilot."""

    def __init__(self, tcp, udp):
        self.server = socket.create_server(("127.0.0.1", tcp))
        self.server.settimeout(10.0)
        self.udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.udp.bind(("127.0.0.1", udp))
        self.udp.settimeout(0.05)
        self._over = threading.Event()
        self._threads = []

    def __enter__(self):
        self._start(self._up)
        return self

    def _start(self, work):
        thread = threading.Thread(target=work, daemon=True)
        thread.start()
        self._threads.append(thread)

    def _up(self):
        self.peer, self.vehicle = self.server.accept()[0], None
        self.peer.settimeout(0.05)
        self._start(self._down)
        while not self._over.is_set():
            try:
                data, self.vehicle = self.udp.recvfrom(4096)
                self.peer.sendall(data)
            except OSError:
                continue

    def _down(self):
        while not self._over.is_set():
            try:
                data = self.peer.recv(4096)
                if data and self.vehicle:
                    self.udp.sendto(data, self.vehicle)
            except OSError:
                continue

    def __exit__(self, *_):
        self._over.set()
        for thread in self._threads:
            thread.join()
        for each in (self.server, self.udp, getattr(self, "peer", None)):
            if each:
                each.close()
