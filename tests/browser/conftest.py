"""What the tests in a real browser share. `cargo xtask browser` runs them; by hand: STAYA=path/to/staya pytest tests/browser."""

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
# Rendering by software: the machines that run this have no GPU.
OPTIONS = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


def until(condition, timeout: float = 30.0, what: str = "it"):
    """Waits until `condition()` gives something true, and returns it. In a page nothing may be evaluated from strings by
    itself, so that waiting is done here."""
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
        # As root Chromium has no sandbox.
        sandbox = os.geteuid() != 0
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=OPTIONS, chromium_sandbox=sandbox)
        yield browser
        browser.close()


class View:
    """`staya view`, and its address."""

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
    """A function that starts a view; it is ended with the test, by its own process id."""
    started = []

    def start(*arguments) -> View:
        started.append(View(*arguments))
        return started[-1]

    yield start
    for view in started:
        view.close()


@pytest.fixture
def look(browser):
    """A function that opens an address; the page must not complain in the end."""
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
