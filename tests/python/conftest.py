"""Fixtures of the tests with real MAVLink clients. `cargo xtask clients` runs the tests; by hand:
STAYA=path/to/staya pytest tests/python."""

import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

# pymavlink reads both variables during import.
os.environ["MAVLINK20"] = "1"
os.environ["MAVLINK_DIALECT"] = "staya"

import pytest

ROOT = Path(__file__).resolve().parents[2]


def pytest_configure(config):
    try:
        from pymavlink.dialects.v20 import staya  # noqa: F401
    except ImportError:
        subprocess.run([sys.executable, Path(__file__).with_name("dialect.py")], check=True, stdout=subprocess.DEVNULL)


@pytest.fixture(scope="session")
def dialect():
    """pymavlink's module of Staya's dialect."""
    from pymavlink.dialects.v20 import staya

    return staya


@pytest.fixture
def free_port():
    """A function that returns unused UDP and TCP ports of 127.0.0.1."""

    def pick() -> int:
        while True:
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp, socket.socket() as tcp:
                udp.bind(("127.0.0.1", 0))
                port = udp.getsockname()[1]
                try:
                    tcp.bind(("127.0.0.1", port))
                except OSError:
                    continue
                return port

    return pick


class Process:
    """A program that runs during the test, with its output in a file."""

    def __init__(self, arguments, log: Path, cwd=ROOT, env=None):
        self.log = log
        self.arguments = [str(argument) for argument in arguments]
        self._out = open(log, "wb")
        environment = {**os.environ, **(env or {})}
        self.child = subprocess.Popen(
            self.arguments, cwd=cwd, env=environment, stdin=subprocess.DEVNULL, stdout=self._out, stderr=subprocess.STDOUT
        )

    def output(self) -> str:
        return self.log.read_text(errors="replace")

    def is_running(self) -> bool:
        return self.child.poll() is None

    def wait_for(self, text: str, timeout: float = 20.0) -> str:
        """Waits until the program has printed `text`. Returns all output."""
        deadline = time.monotonic() + timeout
        while time.monotonic() < deadline:
            if text in self.output():
                return self.output()
            if not self.is_running():
                break
            time.sleep(0.05)
        raise AssertionError(f"no {text!r} from {' '.join(self.arguments)}:\n{self.output()}")

    def wait(self, timeout: float = 30.0) -> int:
        """Waits for the end. Returns the exit code."""
        try:
            return self.child.wait(timeout)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"{' '.join(self.arguments)} does not end:\n{self.output()}") from None

    def interrupt(self, timeout: float = 10.0) -> int:
        """Stops with Ctrl-C. Returns the exit code."""
        self.child.send_signal(signal.SIGINT)
        return self.wait(timeout)

    def close(self):
        if self.is_running():
            self.child.terminate()
            try:
                self.child.wait(5.0)
            except subprocess.TimeoutExpired:
                self.child.kill()
                self.child.wait()
        self._out.close()


@pytest.fixture
def run(tmp_path):
    """A function that starts a program. Each is stopped after the test by its process id."""
    started = []

    def start(*arguments, **options) -> Process:
        process = Process(arguments, tmp_path / f"process-{len(started)}.log", **options)
        started.append(process)
        return process

    yield start
    for process in reversed(started):
        process.close()


@pytest.fixture
def staya(run):
    """A function that starts `staya` with arguments in the repository's root."""
    program = os.environ.get("STAYA", str(ROOT / "target/debug/staya"))
    assert Path(program).is_file(), f"no {program}: run `cargo build`, or set STAYA"

    def start(*arguments, **options) -> Process:
        return run(program, *arguments, **options)

    return start


def wait_until(condition, timeout: float = 20.0, what: str = "it"):
    """Waits until `condition()` returns a true value, and returns it."""
    deadline = time.monotonic() + timeout
    while time.monotonic() < deadline:
        found = condition()
        if found:
            return found
        time.sleep(0.02)
    raise AssertionError(f"{what} did not happen in {timeout} s")
