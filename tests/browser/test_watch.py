"""Read-only pages of a run, and settings that pages store."""

import subprocess

import pytest

from conftest import ROOT, STAYA, View, until

CIRCLE = "scenarios/swap-circle.toml"


@pytest.fixture
def watched():
    """A function that starts a command with `--view` and returns its URL. Each process is stopped
    by its id."""
    started = []

    def start(*arguments) -> str:
        command = [STAYA, *map(str, arguments), "--view"]
        child = subprocess.Popen(command, cwd=ROOT, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        started.append(child)
        return until(lambda: next((line.strip() for line in child.stderr if "token=" in line), None), what="an address")

    yield start
    for child in started:
        child.terminate()
        child.wait(10)


def middle(page, x: float, y: float) -> list[float]:
    return page.evaluate("([x, y]) => staya.project(x, y)", [x, y])


def test_a_live_page_shows_the_run_and_its_end(watched, look):
    url = watched("bridge", "scenarios/bridge.toml", "--mavlink", "udpout:127.0.0.1:9", "--seconds", "6", "-q")
    page = look(url)
    assert page.evaluate("staya.scene.mode") == "watch"
    first = page.evaluate("staya.currentTick")
    until(lambda: page.evaluate("staya.currentTick") > first, what="a tick")
    # The page has no controls.
    assert not page.locator("#play").is_visible() and not page.locator("#tools").is_visible()
    page.keyboard.press("n")
    until(lambda: page.evaluate("staya.robot?.index") == 0, what="its panel")
    until(lambda: page.locator("#status").inner_text() == "Ended", what="the end")
    assert "last picture" in page.locator("#banner").inner_text()


def test_the_chosen_theme_is_kept_on_any_port(browser):
    context = browser.new_context(color_scheme="light")
    themes = []
    for _ in range(2):
        view = View(CIRCLE, "--paused")
        try:
            page = context.new_page()
            page.goto(view.url)
            until(lambda: page.evaluate("window.staya?.frames.drawn > 0"), what="a picture")
            themes.append(page.evaluate("document.documentElement.dataset.theme"))
            if len(themes) == 1:
                page.keyboard.press("d")
                until(lambda: page.evaluate("document.documentElement.dataset.theme") == "dark", what="the dark")
            page.close()
        finally:
            view.close()
    context.close()
    assert themes == ["light", "dark"]


def test_a_polygon_is_drawn_corner_by_corner(view, look):
    page = look(view(CIRCLE, "--paused").url)
    before = len(page.evaluate("staya.scene.solids"))
    page.keyboard.press("6")
    west, south, east, north = page.evaluate("staya.scene.bounds_m")
    x, y, side = (west + east) / 2, (south + north) / 2, (east - west) / 12
    # Two corners and Escape cancel the polygon.
    for corner in [(x, y), (x + side, y)]:
        page.mouse.click(*middle(page, *corner))
    page.keyboard.press("Escape")
    for corner in [(x, y), (x + side, y), (x + side / 2, y + side), (x, y)]:
        page.mouse.click(*middle(page, *corner))
    until(lambda: len(page.evaluate("staya.scene.solids")) == before + 3, what="three walls")
    # Now with Enter.
    for corner in [(x - side, y), (x - side / 2, y), (x - side, y + side), (x - 2 * side, y + side)]:
        page.mouse.click(*middle(page, *corner))
    page.keyboard.press("Enter")
    until(lambda: len(page.evaluate("staya.scene.solids")) == before + 7, what="four walls more")
    walls = page.evaluate("staya.scene.solids")[before:]
    assert all(wall["kind"] == "segment" for wall in walls)
    assert abs(walls[0]["from_m"][0] - x) < side / 10 and abs(walls[0]["from_m"][1] - y) < side / 10
