"""Signatures: staya-mavlink signs like pymavlink, byte for byte (its own tests use the same file)."""

import os
from pathlib import Path

os.environ["MAVLINK20"] = "1"

from pymavlink.dialects.v20 import common

GOLDEN = Path(__file__).parent.parent / "golden" / "signed-frames.txt"
KEY = bytes(range(32))
TIMESTAMP = 37_000_000_000_000


def golden():
    lines = [line for line in GOLDEN.read_text().splitlines() if not line.startswith("#")]
    return [(name, bytes.fromhex(frame)) for name, frame in map(str.split, lines)]


def codec(key, timestamp=TIMESTAMP):
    mav = common.MAVLink(None, srcSystem=7, srcComponent=1)
    mav.signing.secret_key = key
    mav.signing.sign_outgoing = True
    mav.signing.link_id = 3
    mav.signing.timestamp = timestamp
    mav.robust_parsing = True
    return mav


def heard(mav, frame):
    """Names of the messages that pymavlink accepts."""
    messages = mav.parse_buffer(frame) or []
    return [message.get_type() for message in messages if message.get_type() != "BAD_DATA"]


def test_pymavlink_signs_the_same_frames():
    mav = codec(KEY)
    messages = {
        "heartbeat": common.MAVLink_heartbeat_message(18, 8, 0, 0, 4, 3),
        "command_long": common.MAVLink_command_long_message(9, 0, 400, 0, 1.0, 0, 0, 0, 0, 0, 0),
        "statustext": common.MAVLink_statustext_message(6, b"arrived"),
        "setpoint": common.MAVLink_set_position_target_local_ned_message(
            5, 9, 0, 1, 2503, 0, 0, 0, 1.5, -2.25, 0, 0, 0, 0, 0, 0
        ),
    }
    assert [name for name, _ in golden()] == list(messages)
    for name, frame in golden():
        assert messages[name].pack(mav).hex() == frame.hex(), name
        mav.seq += 1


def test_frames_are_accepted_with_the_key_once():
    mav = codec(KEY)
    for name, frame in golden():
        assert len(heard(mav, frame)) == 1, name
        assert heard(mav, frame) == [], f"{name}, replayed"


def test_frames_are_refused_with_another_key_and_by_a_later_clock():
    for mav in (codec(bytes(32)), codec(KEY, TIMESTAMP + 2 * 60 * 100_000)):
        for name, frame in golden():
            assert heard(mav, frame) == [], name


def test_a_changed_frame_is_refused():
    for name, frame in golden():
        # The last bit of the signature, which the checksum does not cover.
        changed = frame[:-1] + bytes([frame[-1] ^ 1])
        assert heard(codec(KEY), changed) == [], name
