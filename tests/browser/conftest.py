"""Fixtures of the browser tests. `cargo xtask browser` runs the tests; by hand: STAYA=path/to/staya
pytest tests/browser."""

import json
import os
import shutil
import subprocess
import time
from pathlib import Path

import pytest
from playwright.sync_api import sync_playwright

ROOT = Path(__file__).resolve().parents[2]
STAYA = os.environ.get("STAYA", str(ROOT / "target/debug/staya"))
CHROMIUM = shutil.which(os.environ.get("CHROMIUM", "chromium"))
# Software rendering, since test machines have no GPU.
OPTIONS = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


def until(condition, timeout: float = 30.0, what: str = "it"):
    """Waits until `condition()` returns a true value, and returns it. The page's security policy
    forbids evaluating strings in the page, so the wait loop is here."""
    deadline = time.monotonic() + timeout
    while time.monotonic() < deadline:
        found = condition()
        if found:
            return found
        time.sleep(0.05)
    raise AssertionError(f"{what} did not happen in {timeout} s")


@pytest.fixture(scope="session")
def browser():
    with sync_playwright() as playwright:
        # Chromium has no sandbox as root.
        sandbox = os.geteuid() != 0
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=OPTIONS, chromium_sandbox=sandbox)
        yield browser
        browser.close()


class View:
    """A `staya view` process and its URL."""

    def __init__(self, *arguments):
        command = [STAYA, "view", *map(str, arguments), "--no-open", "--json"]
        self.child = subprocess.Popen(command, cwd=ROOT, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE)
        text = b""
        while b"}" not in text:
            line = self.child.stdout.readline()
            assert line, "it ended"
            text += line
        self.url = json.loads(text)["url"]

    def close(self):
        self.child.terminate()
        self.child.wait(10)


@pytest.fixture
def view():
    """A function that starts a view. Each view is stopped after the test by its process id."""
    started = []

    def start(*arguments) -> View:
        started.append(View(*arguments))
        return started[-1]

    yield start
    for view in started:
        view.close()


@pytest.fixture
def look(browser):
    """A function that opens a URL. The test fails if the page logs errors."""
    pages, complaints = [], []

    def open_page(url: str, **options):
        page = browser.new_page(**({"viewport": {"width": 1280, "height": 720}} | options))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("console", lambda said: said.type == "error" and complaints.append(said.text))
        page.goto(url)
        until(lambda: page.evaluate("window.staya?.frames.drawn > 0"), what="a picture")
        pages.append(page)
        return page

    yield open_page
    for page in pages:
        page.close()
    assert complaints == []
