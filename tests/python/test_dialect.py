"""The dialect: its public messages equal the public dialect's, and Rust and Python understand each
other's frames."""

import struct
from pathlib import Path

import pytest
from pymavlink.generator import mavparse

ROOT = Path(__file__).resolve().parents[2]
MESSAGES = ROOT / "controller" / "mavlink" / "messages"
GOLDEN = ROOT / "tests" / "golden" / "mavlink-frames.txt"


def rust_frames():
    lines = [line for line in GOLDEN.read_text().splitlines() if not line.startswith("#")]
    return [line.split(" ", 2) for line in lines]


def value(text):
    numbers = [int(number) for number in text.split(",")]
    return numbers if "," in text else numbers[0]


@pytest.mark.parametrize("file, count", [("common.xml", 48), ("ardupilotmega.xml", 1)])
def test_public_messages_equal_the_public_dialects(dialect, file, count):
    ours = mavparse.MAVXML(str(MESSAGES / file), wire_protocol_version=mavparse.PROTOCOL_2_0)
    assert len(ours.message) >= count
    for message in ours.message:
        public = dialect.mavlink_map[message.id]
        assert message.name == public.msgname, message.id
        assert message.crc_extra == public.crc_extra, message.name
        assert ours.message_lengths[message.id] == public.unpacker.size, message.name
        assert [field.name for field in message.fields] == public.fieldnames, message.name
        # Extension fields are not part of the checksum.
        assert [field.type for field in message.fields] == public.fieldtypes, message.name


@pytest.mark.parametrize("name, frame, fields", rust_frames())
def test_frames_of_rust_round_trip_through_python(dialect, name, frame, fields):
    frame = bytes.fromhex(frame)
    receiver = dialect.MAVLink(None)
    (message,) = receiver.parse_buffer(frame)
    assert message.get_type() == name
    assert (message.get_srcSystem(), message.get_srcComponent(), message.get_seq()) == (42, 191, 777 & 0xFF)
    said = {"boot": 3, "sequence": 777}
    said |= {key: value(text) for key, text in (field.split("=") for field in fields.split())}
    for key, wanted in said.items():
        assert getattr(message, key) == wanted, key
    sender = dialect.MAVLink(None, srcSystem=42, srcComponent=191)
    sender.seq = 777 & 0xFF
    again = dialect.mavlink_map[message.get_msgId()](**{key: getattr(message, key) for key in message.fieldnames})
    assert again.pack(sender) == frame


def test_the_cell_of_a_robot_on_the_grid_needs_no_library_but_struct(dialect):
    name, frame, _ = rust_frames()[0]
    (beacon,) = dialect.MAVLink(None).parse_buffer(bytes.fromhex(frame))
    assert (name, beacon.protocol) == ("STAYA_BEACON", 1)
    cell_x, cell_y, target_x, target_y, busy_ms, heading, slot = struct.unpack_from("<4hH2B", bytes(beacon.bytes))
    assert (cell_x, cell_y, target_x, target_y, busy_ms, heading, slot) == (98, -98, -32768, 70, 400, 7, 4)
    # The leader has 7 bits per byte.
    assert (beacon.bytes[12], beacon.count) == (1, 13)


def test_every_message_of_the_dialect_exists(dialect):
    own = {message.msgname for message in dialect.mavlink_map.values() if message.msgname.startswith("STAYA_")}
    assert own == {name for name, _, _ in rust_frames()}


def test_a_damaged_frame_is_refused(dialect):
    _, frame, _ = rust_frames()[0]
    frame = bytearray.fromhex(frame)
    frame[12] ^= 4
    with pytest.raises(dialect.MAVError):
        dialect.MAVLink(None).parse_buffer(bytes(frame))
