"""The cases of tests/cases/README.md that need a client of `staya bridge`. Each one sends what the
client of the report sends, byte by byte or through pymavlink."""

import socket
import struct
import time

import pytest
from conftest import wait_until
from pymavlink import mavutil
from pymavlink.dialects.v20 import ardupilotmega as mavlink

LAT, LON = 47.0, 8.0
STEP = 1e-4


class Client:
    """A client with one socket, a system and a component, that keeps all received messages."""

    def __init__(self, port, system=255, component=190):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setblocking(False)
        self.socket.bind(("127.0.0.1", 0))
        self.to = ("127.0.0.1", port)
        self.mav = mavlink.MAVLink(self, srcSystem=system, srcComponent=component)
        self.mav.robust_parsing = True
        self.heard = []
        self.system, self.component = system, component

    def write(self, data):
        self.socket.sendto(data, self.to)

    def beat(self):
        self.mav.heartbeat_send(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 0)

    def read(self):
        while True:
            try:
                data = self.socket.recv(65536)
            except BlockingIOError:
                return
            self.heard += self.mav.parse_buffer(data) or []

    def take(self, kinds, timeout=5.0, where=lambda message: True):
        """Removes and returns the next message of these types; None if there is none in time."""
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            self.read()
            for message in self.heard:
                if message.get_type() in kinds and where(message):
                    self.heard.remove(message)
                    return message
            time.sleep(0.01)
        return None

    def set_mode(self, mode):
        self.mav.command_long_send(1, 1, 176, 0, 1, mode, 0, 0, 0, 0, 0)
        assert self.take(["COMMAND_ACK"]).result == 0

    def item(self, seq, steps, current=0, target=(1, 1)):
        self.mav.mission_item_send(*target, seq, 3, 16, current, 0, 0, 0, 0, 0, LAT + steps * STEP, LON, 0)

    def upload(self, steps):
        """By MISSION_REQUEST and MISSION_ITEM alone."""
        self.mav.mission_count_send(1, 1, len(steps))
        for seq, step in enumerate(steps):
            assert self.take(["MISSION_REQUEST"], where=lambda asked: asked.seq == seq), f"item {seq}"
            self.item(seq, step)
        assert self.take(["MISSION_ACK"]).type == 0

    def download(self):
        """Steps from home of all items."""
        self.mav.mission_request_list_send(1, 1)
        count = self.take(["MISSION_COUNT"]).count
        places = []
        for seq in range(count):
            self.mav.mission_request_int_send(1, 1, seq)
            item = self.take(["MISSION_ITEM_INT"], where=lambda item: item.seq == seq)
            places.append(round((item.x / 1e7 - LAT) / STEP, 1))
        return places


@pytest.fixture
def client(staya, free_port):
    """A function that connects a client to a bridge with one rover, or to scenarios/bridge.toml."""
    ports = []

    def connect(system=255, component=190, scenario="tests/cases/clients/rover.toml"):
        if not ports:
            ports.append(free_port())
            staya("bridge", scenario, "--mavlink", f"udpin:127.0.0.1:{ports[0]}", "--origin", f"{LAT},{LON},400", "--quiet")
        connected = Client(ports[0], system, component)

        def heard():
            connected.beat()
            return connected.take(["HEARTBEAT"], 0.3)

        wait_until(heard, 15, "a heartbeat")
        return connected

    return connect


def test_a_guided_item_to_system_0_moves_the_rover(client):
    station = client()
    station.set_mode(15)
    station.item(0, 1, current=2, target=(0, 0))
    assert station.take(["MISSION_ACK"]).type == 0
    # A float of 47 degrees has steps of 0.4 m.
    assert station.take(["LOCAL_POSITION_NED"], 10, lambda at: abs(at.x - 11.1) < 0.4)


def test_a_guided_item_to_system_0_of_several_is_refused_by_each(client):
    station = client(scenario="scenarios/bridge.toml")
    station.item(0, 1, current=2, target=(0, 0))
    for _ in range(10):
        assert station.take(["MISSION_ACK"]).type == mavlink.MAV_MISSION_DENIED
        assert station.take(["STATUSTEXT"], where=lambda text: "system 0" in text.text)


def test_the_list_of_a_fresh_vehicle_is_its_home(client):
    station = client()
    assert station.download() == [0.0]
    station.mav.mission_request_send(1, 1, 0)
    item = station.take(["MISSION_ITEM"])
    assert (item.seq, item.command, round(item.x, 4), round(item.y, 4)) == (0, 16, LAT, LON)
    station.mav.command_long_send(1, 1, 300, 0, 0, 0, 0, 0, 0, 0, 0)
    assert station.take(["COMMAND_ACK"]).result != 0


def test_an_upload_without_int_messages(client):
    station = client()
    station.upload([0, 1, 2])
    assert station.download() == [0.0, 1.0, 2.0]


def test_one_item_is_replaced(client):
    station = client()
    station.upload([0, 1, 2, 3])
    station.mav.mission_write_partial_list_send(1, 1, 2, 2)
    assert station.take(["MISSION_REQUEST"], where=lambda asked: asked.seq == 2)
    station.item(2, 5)
    assert station.take(["MISSION_ACK"], 3).type == 0
    assert station.download() == [0.0, 1.0, 5.0, 3.0]
    station.mav.mission_write_partial_list_send(1, 1, 4, 4)
    assert station.take(["MISSION_ACK"], 3).type == mavlink.MAV_MISSION_INVALID_SEQUENCE
    assert "not in the list" in station.take(["STATUSTEXT"], where=lambda text: "mission" in text.text).text


def test_set_mode_is_answered_by_heartbeats_and_texts(client):
    station = client()
    station.mav.set_mode_send(1, 1, 15)
    assert station.take(["HEARTBEAT"], 3, lambda beat: beat.custom_mode == 15)
    station.mav.set_mode_send(1, 1, 77)
    assert station.take(["STATUSTEXT"], 3, lambda text: text.text == "mode 77 is unsupported")
    assert station.take(["COMMAND_ACK"], 0.3) is None


@pytest.mark.parametrize("sender", [(255, 190), (2, 1), (1, 240), (1, 191), (1, 0)])
def test_a_sender_is_a_system_and_a_component(client, sender):
    station = client(*sender)
    station.mav.command_long_send(1, 1, 512, 0, 148, 0, 0, 0, 0, 0, 0)
    ack = station.take(["COMMAND_ACK"], 2)
    assert (ack.result, ack.target_system, ack.target_component) == (0, *sender)


@pytest.mark.parametrize("cuts", [[37, 90], [1, 2, 125], [21, 42], [10, 60, 61], range(4, 126, 4), []])
@pytest.mark.parametrize("version", [1, 2])
def test_frames_cut_at_datagrams_are_answered(client, cuts, version):
    station = client()
    pings = b""
    for seq in range(1, 7):
        message = mavlink.MAVLink_ping_message(1 << 40, seq, 0, 0)
        pings += message.pack(station.mav, force_mavlink1=version == 1)
    edges = [0, *(cut for cut in cuts if cut < len(pings)), len(pings)]
    for begin, end in zip(edges, edges[1:]):
        station.write(pings[begin:end])
        time.sleep(0.01)
    answered = {station.take(["PING"], 2, lambda ping: ping.target_system == 255).seq for _ in range(6)}
    assert answered == set(range(1, 7))


def test_junk_costs_no_frame(client):
    station = client()
    frame = mavlink.MAVLink_ping_message(1 << 40, 9, 0, 0).pack(station.mav)
    for junk in [b"$GPGGA,1*00\r\n", bytes([0xFE]), bytes([0xFD, 9]), struct.pack("<20B", *range(20))]:
        station.write(junk + frame)
        assert station.take(["PING"], 3, lambda ping: ping.target_system == 255), junk


def test_a_request_that_is_not_modelled_is_refused_by_a_text(client):
    station = client()
    station.mav.rc_channels_override_send(1, 1, *[1500] * 8)
    assert station.take(["STATUSTEXT"], 3, lambda text: text.text == "RC_CHANNELS_OVERRIDE is unsupported")
    station.mav.mission_count_send(1, 1, 4, mavutil.mavlink.MAV_MISSION_TYPE_FENCE)
    assert station.take(["MISSION_ACK"]).type == mavlink.MAV_MISSION_UNSUPPORTED
