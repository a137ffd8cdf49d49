"""Captures of `staya bridge` in Wireshark's dissector, which mavgen generates from the same
definitions."""

import shutil
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from bridge_client import Bridge

TSHARK = shutil.which("tshark")


def record(port, seconds, capture):
    """Captures datagrams to a port as raw IP packets, without privileges."""
    import struct

    sink = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sink.bind(("127.0.0.1", port))
    sink.settimeout(0.2)
    # The time counts from the first datagram: a busy machine starts programs late.
    deadline, count = time.monotonic() + 60.0, 0
    client = None
    with open(capture, "wb") as file:
        # Link type 228: raw IPv4.
        file.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 228))
        while time.monotonic() < deadline:
            try:
                data, (host, sender) = sink.recvfrom(2048)
            except TimeoutError:
                continue
            if client is None:
                client = (host, sender)
                deadline = time.monotonic() + seconds
                yield sink, client
            udp = struct.pack(">HHHH", sender, port, 8 + len(data), 0) + data
            local = socket.inet_aton("127.0.0.1")
            packet = struct.pack(">BBHHHBBH4s4s", 0x45, 0, 20 + len(udp), 0, 0, 64, 17, 0, local, local) + udp
            now = time.time()
            file.write(struct.pack("<IIII", int(now), int(now % 1 * 1e6), len(packet), len(packet)) + packet)
            count += 1
    sink.close()
    assert count > 100


@pytest.mark.skipif(TSHARK is None, reason="tshark is not installed")
def test_no_frame_is_malformed(staya, free_port, tmp_path, dialect):
    from pymavlink.generator import mavgen, mavparse

    # mavgen needs both files in one folder, as in the environment's dialect.
    definitions = Path(dialect.__file__)
    messages = Path(__file__).resolve().parents[2] / "controller/mavlink/messages/staya.xml"
    script = tmp_path / "staya.lua"
    options = mavgen.Opts(str(script), wire_protocol="2.0", language="WLua", validate=False)
    assert definitions.is_file() and mavgen.mavgen(options, [str(messages)]) is not False

    port = free_port()
    process = staya("bridge", "scenarios/bridge.toml", "--mavlink", f"udpout:127.0.0.1:{port}", "--quiet")
    capture = tmp_path / "bridge.pcap"
    mav = dialect.MAVLink(None, srcSystem=255, srcComponent=190)
    for sink, client in record(port, 3.0, capture):
        for message in [
            mav.param_request_list_encode(1, 1),
            mav.command_long_encode(1, 1, 512, 0, 148, 0, 0, 0, 0, 0, 0),
            mav.command_long_encode(1, 1, 400, 0, 0, 0, 0, 0, 0, 0, 0),
            mav.ping_encode(1, 2, 0, 0),
            mav.mission_request_list_encode(1, 1),
        ]:
            sink.sendto(message.pack(mav), client)
    process.close()

    arguments = [TSHARK, "-r", capture, "-X", f"lua_script:{script}", "-d", f"udp.port=={port},mavlink_proto", "-T", "fields"]
    fields = ["-e", "mavlink_proto.msgid", "-e", "_ws.malformed", "-e", "_ws.lua.error", "-e", "_ws.expert.severity"]
    # tshark refuses scripts as root by default.
    environment = {"HOME": str(tmp_path), "PATH": "/usr/bin:/bin", "WIRESHARK_RUN_FROM_BUILD_DIRECTORY": ""}
    found = subprocess.run(arguments + fields, capture_output=True, text=True, env=environment, timeout=60)
    assert found.returncode == 0, found.stderr
    rows = [line.split("\t") for line in found.stdout.splitlines()]
    assert len(rows) > 100
    kinds = {int(row[0]) for row in rows if row[0]}
    assert {0, 1, 22, 32, 33, 77, 147, 148, 242, 245} <= kinds, (kinds, found.stderr)
    bad = [row for row in rows if not row[0] or any(row[1:3])]
    assert not bad, bad[:5]
