"""Fixtures of the package's tests: scenarios and their golden results."""

import re
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[2]


@pytest.fixture
def top():
    """The top of the repository."""
    return TOP


@pytest.fixture
def scenario():
    """Path of a scenario by its name."""
    return lambda name: TOP / "scenarios" / f"{name}.toml"


@pytest.fixture
def golden():
    """Trace hash and number of ticks of `staya run`, from the golden table of a scenario."""

    def read(name):
        text = (TOP / "tests" / "golden" / f"{name}.txt").read_text()
        trace_hash = re.search(r"^hash +([0-9a-f]{16})$", text, re.MULTILINE).group(1)
        return trace_hash, int(re.search(r"^ticks +(\d+) of", text, re.MULTILINE).group(1))

    return read
