"""Runs each Python block of docs/bridge.md against the bridge of the command above it."""

import re
import subprocess
import sys

import pytest
from conftest import ROOT

PAGE = (ROOT / "docs/bridge.md").read_text()
PORT = "14550"
DIALECT = r"```sh\npython3 (-m pymavlink.tools.mavgen .*)\n```"


def blocks():
    """Arguments of a bridge, and the script for it."""
    arguments = None
    for kind, text in re.findall(r"^```(\w*)\n(.*?)^```$", PAGE, re.M | re.S):
        if kind == "python":
            assert arguments, "no bridge above the script"
            yield pytest.param(arguments, text, id=re.search(r"[a-z-]+.toml", arguments).group() + f"-{len(text)}")
        elif command := re.search(r"-- (bridge scenarios/.*)", text):
            arguments = command.group(1)


def generate(folder):
    """The scripts of the page, in their own folder."""
    (command,) = re.findall(DIALECT, PAGE)
    arguments = command.replace("controller/", f"{ROOT}/controller/").split()
    made = subprocess.run([sys.executable, *arguments], cwd=folder, capture_output=True, text=True, timeout=60)
    assert made.returncode == 0, made.stdout + made.stderr


@pytest.mark.parametrize("arguments, script", list(blocks()))
def test_pasted_python_runs(arguments, script, staya, run, free_port, tmp_path):
    generate(tmp_path)
    port = str(free_port())
    staya(*arguments.replace(PORT, port).split(), "--quiet")
    assert PORT in script
    path = tmp_path / "pasted.py"
    path.write_text(script.replace(PORT, port))
    # Without the environment of these tests.
    pasted = run("env", "-u", "MAVLINK20", "-u", "MAVLINK_DIALECT", sys.executable, path, cwd=tmp_path)
    assert pasted.wait(90) == 0, pasted.output()
    assert "robot" in pasted.output() or "vehicle" in pasted.output() or "item" in pasted.output(), pasted.output()


def test_a_wedge_is_sent_and_confirmed(staya, free_port):
    port = free_port()
    staya("bridge", "scenarios/six-robots.toml", "--speed", 20, "--mavlink", f"udpin:127.0.0.1:{port}", "--quiet")
    sent = staya("formation", "wedge", "--to", f"udpout:127.0.0.1:{port}", "--goal", "60,40")
    assert sent.wait() == 0, sent.output()
    assert "wedge: 6 of 6 robots confirmed their places, 6 robots head for cell (60, 40)" in sent.output()
    # A second call is a new order, whatever the first one's version.
    sent = staya("formation", "column", "--to", f"udpout:127.0.0.1:{port}")
    assert sent.wait() == 0, sent.output()


def test_a_swarm_without_a_formation_refuses(staya, free_port):
    port = free_port()
    staya("bridge", "scenarios/bridge.toml", "--mavlink", f"udpin:127.0.0.1:{port}", "--quiet")
    sent = staya("formation", "line", "--to", f"udpout:127.0.0.1:{port}")
    assert sent.wait() == 1
    assert "not in a formation" in sent.output(), sent.output()


def test_an_absent_swarm_and_an_unknown_shape_are_errors(staya, free_port):
    port = free_port()
    sent = staya("formation", "line", "--to", f"udpout:127.0.0.1:{port}", "--wait", 1)
    assert sent.wait() == 1 and "no robot found" in sent.output(), sent.output()
    sent = staya("formation", "triangle", "--to", f"udpout:127.0.0.1:{port}")
    assert sent.wait() == 1 and "line, column, wedge, grid, circle" in sent.output(), sent.output()


def test_some_robots_form_a_separate_formation(staya, free_port):
    port = free_port()
    staya("bridge", "scenarios/six-robots.toml", "--speed", 20, "--mavlink", f"udpin:127.0.0.1:{port}", "--quiet")
    to = ("--to", f"udpout:127.0.0.1:{port}")
    for robots, goal in [("2,4-5", "60,40"), ("1,3,6", "40,20")]:
        sent = staya("formation", "wedge", *to, "--robots", robots, "--goal", goal)
        assert sent.wait() == 0, sent.output()
        assert "wedge: 3 of 3 robots confirmed their places, 3 robots head for cell" in sent.output()
    sent = staya("formation", "line", *to, "--robots", "5-8", "--wait", 2)
    assert sent.wait() == 1 and "robots 7, 8 not found" in sent.output(), sent.output()
    sent = staya("formation", "line", *to, "--robots", "6-2")
    assert sent.wait() == 2 and "as in 3,5,8-12" in sent.output(), sent.output()
