"""A minimal WebSocket client (RFC 6455) for the pages of `staya ... --view`."""

import base64
import json
import os
import socket
import struct
from urllib.parse import urlsplit


class Page:
    """The WebSocket of a printed URL."""

    def __init__(self, url: str):
        address = urlsplit(url)
        self._socket = socket.create_connection((address.hostname, address.port), timeout=20)
        key = base64.b64encode(os.urandom(16)).decode()
        self._socket.sendall(
            f"GET /live?{address.query} HTTP/1.1\r\nHost: {address.netloc}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
        )
        self._stream = self._socket.makefile("rb")
        assert b" 101 " in self._stream.readline()
        while self._stream.readline() != b"\r\n":
            pass

    def say(self, word: dict):
        """Sends a message below 126 bytes."""
        text = json.dumps(word).encode()
        assert len(text) < 126
        # Masked with zeros, which leaves the data unchanged.
        self._socket.sendall(bytes([0x81, 0x80 | len(text), 0, 0, 0, 0]) + text)

    def read(self):
        """The next message: an object, the bytes of a frame, or None at the end."""
        head = self._stream.read(2)
        kind, length = (head[0] & 0xF, head[1]) if len(head) == 2 else (8, 0)
        if length == 126:
            (length,) = struct.unpack(">H", self._stream.read(2))
        elif length == 127:
            (length,) = struct.unpack(">Q", self._stream.read(8))
        body = self._stream.read(length)
        return {1: lambda: json.loads(body), 2: lambda: body, 8: lambda: None}[kind]()

    def until(self, is_it):
        """The next object for which `is_it` is true."""
        while (message := self.read()) is not None:
            if isinstance(message, dict) and is_it(message):
                return message
        raise AssertionError("the page was closed")

    def close(self):
        self._socket.close()
