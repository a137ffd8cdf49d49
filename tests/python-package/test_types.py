"""The type stubs match the compiled module."""

import subprocess
import sys


def test_stubs_match_the_module(tmp_path):
    command = [sys.executable, "-m", "mypy.stubtest", "staya._staya"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
