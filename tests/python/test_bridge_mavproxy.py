"""`staya bridge` with MAVProxy's command line."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

PROXY = Path(sys.executable).with_name("mavproxy.py")


class Console:
    """MAVProxy without a terminal: commands on its standard input, output in a file."""

    def __init__(self, folder, port, system=2):
        self.log = folder / "mavproxy.log"
        self.out = open(self.log, "wb")
        arguments = [
            sys.executable, str(PROXY), f"--master=udpin:127.0.0.1:{port}", "--dialect=ardupilotmega", f"--target-system={system}",
            "--default-modules=param,cmdlong,mode,arm,wp,fence,console", "--nowait", "--state-basedir", str(folder),
        ]
        environment = {**os.environ, "MAVLINK_DIALECT": "ardupilotmega", "HOME": str(folder), "PYTHONUNBUFFERED": "1", "TERM": "dumb"}
        self.child = subprocess.Popen(
            arguments, cwd=folder, env=environment, stdin=subprocess.PIPE, stdout=self.out, stderr=subprocess.STDOUT
        )

    def text(self):
        return self.log.read_text(errors="replace")

    def type(self, line, *answers, timeout=15.0):
        """Types a line, with retries until MAVProxy has printed one of the answers."""
        start, deadline, again = len(self.text()), time.monotonic() + timeout, 0.0
        while time.monotonic() < deadline:
            if time.monotonic() > again:
                self.child.stdin.write(f"{line}\n".encode())
                self.child.stdin.flush()
                again = time.monotonic() + 3.0
            if any(answer in self.text()[start:] for answer in answers):
                return
            time.sleep(0.05)
        raise AssertionError(f"no {answers} after {line!r}:\n{self.text()}")

    def close(self):
        self.child.terminate()
        try:
            self.child.wait(5)
        except subprocess.TimeoutExpired:
            self.child.kill()
            self.child.wait()
        self.child.stdin.close()
        self.out.close()


@pytest.mark.skipif(not PROXY.is_file(), reason="no MAVProxy in this environment")
def test_modes_arming_and_parameters(staya, free_port, tmp_path):
    port = free_port()
    bridge = staya("bridge", "scenarios/bridge.toml", "--mavlink", f"udpout:127.0.0.1:{port}", "--json", "--quiet")
    console = Console(tmp_path, port)
    try:
        console.type("param show SPEED_MPS", "SPEED_MPS        1.0", "SPEED_MPS        1.000000", timeout=25)
        console.type("mode GUIDED", "GUIDED>")
        console.type("disarm", "DISARMED")
        console.type("arm throttle", "ARMED")
        console.type("param set SPEED_MPS 0.5", "GUIDED>")
        console.type("param show SPEED_MPS", "SPEED_MPS        0.5")
        console.type("mode HOLD", "HOLD>")
        # By now its fence and console modules have received some SYS_STATUS.
        text = console.text().lower()
        assert "fence breach" not in text and "pre-arm fail" not in text and "prearm" not in text, console.text()
    finally:
        console.close()
    bridge.interrupt()
    assert '"denied"' not in bridge.output(), bridge.output()
