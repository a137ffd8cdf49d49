"""The page of `staya view` in Chromium: what it shows is what runs, and what is done in it is done to the robots."""

import json
import re
import subprocess
import urllib.error
import urllib.request

from conftest import ROOT, STAYA, until

SIX = "scenarios/six-robots.toml"
SWAP = "scenarios/swap-circle.toml"


def tick(page) -> int:
    return page.evaluate("staya.currentTick")


def pixels(page, index: int) -> list[float]:
    """Where a robot is on the page."""
    place = "(([x, y, z]) => staya.project(x, y, z ?? 0))(Array.from(staya.place(%d)))"
    at = page.evaluate(place % index)
    return [at["x"], at["y"]] if isinstance(at, dict) else at[:2]


def final_hash(*arguments) -> str:
    said = subprocess.run([STAYA, "run", *arguments, "--json", "-q"], cwd=ROOT, capture_output=True, check=True)
    return json.loads(said.stdout)["trace_hash"]


def test_it_moves_and_its_figures_are_those_of_the_run(view, look, tmp_path):
    page = look(view(SIX, "--paused").url)
    before = page.screenshot()
    assert tick(page) == 0
    page.keyboard.press(".")
    until(lambda: tick(page) == 1, what="a step")
    page.keyboard.press(" ")
    until(lambda: tick(page) > 30, what="ticks")
    assert page.screenshot() != before
    page.keyboard.press(" ")
    until(lambda: page.evaluate("staya.state.paused"), what="a pause")
    stands = until(lambda: tick(page) == page.evaluate("staya.state.tick") and tick(page), what="the last frame")
    page.wait_for_timeout(300)
    assert tick(page) == stands
    shown = page.evaluate("staya.lastFigures")
    assert shown["hash"] == final_hash(SIX, "--ticks", str(stands), "--out", str(tmp_path))


def test_a_selected_robot_tells_what_it_knows(view, look):
    page = look(view(SWAP).url)
    until(lambda: tick(page) > 20, what="ticks")
    page.keyboard.press(" ")
    until(lambda: page.evaluate("staya.state.paused"), what="a pause")
    page.wait_for_timeout(300)
    page.mouse.click(*pixels(page, 4))
    until(lambda: page.evaluate("staya.robot?.index") == 4, what="its panel")
    robot = page.evaluate("staya.robot")
    assert len(robot["neighbors"]) == 15 and robot["orca"]["lines"]
    assert page.get_by_text("Robot 5", exact=True).first.is_visible()


def test_what_is_done_by_the_page_is_saved_and_done_again(view, look, tmp_path):
    page = look(view(SWAP, "--paused").url)
    for order in [
        {"kind": "goal", "robot": 0, "place_m": [3, 3, 0]},
        {"kind": "parameter", "name": "horizon_s", "value": 3},
        {"kind": "solid", "solid": {"kind": "circle", "center_m": [0, 3.5], "radius_m": 0.3}},
    ]:
        page.evaluate("order => staya.send({ do: 'order', order })", order)
    page.evaluate("staya.send({ do: 'speed', x: null })")
    page.keyboard.press(" ")
    until(lambda: page.evaluate("staya.state.at_end"), what="the end")
    end = until(lambda: tick(page) == page.evaluate("staya.state.tick") and page.evaluate("staya.lastFigures.hash"))
    with page.expect_download() as download:
        page.get_by_label("Save as a scenario").click()
    saved = tmp_path / "saved.toml"
    download.value.save_as(saved)
    assert re.search(rf"Trace hash after tick \d+: {end}", saved.read_text())
    assert final_hash(str(saved), "--out", str(tmp_path / "out")) == end


def test_strangers_get_nothing(view):
    url = view(SIX, "--paused").url
    host = url.split("/?")[0]
    for request in [
        urllib.request.Request(host + "/"),
        urllib.request.Request(host + "/?token=" + 32 * "0"),
        urllib.request.Request(url, headers={"Origin": "http://evil.example"}),
        urllib.request.Request(url, headers={"Host": "evil.example"}),
    ]:
        try:
            urllib.request.urlopen(request)
        except urllib.error.HTTPError as error:
            assert error.code == 403
        else:
            raise AssertionError("it was let in")
    with urllib.request.urlopen(url) as answer:
        assert "script-src 'self' 'nonce-" in answer.headers["Content-Security-Policy"]


def test_recordings_play_from_a_server_and_from_one_file(view, look, tmp_path):
    recording, page_file = tmp_path / "six.staya", tmp_path / "six.html"
    run = [STAYA, "run", SIX, "--out", tmp_path / "out", "--record", recording, "-q"]
    subprocess.run(run, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    subprocess.run([STAYA, "page", recording, "--out", page_file, "-q"], check=True, stdout=subprocess.DEVNULL)
    assert page_file.stat().st_size < 1_000_000
    for url in [view(recording, "--paused").url, page_file.as_uri()]:
        page = look(url)
        assert page.evaluate("staya.scene.mode") == "recording"
        page.evaluate("staya.send({ do: 'seek', tick: 400 })")
        until(lambda: tick(page) == 400, what="going to tick 400")
        page.keyboard.press(" ")
        until(lambda: tick(page) > 405, what="ticks")


def test_it_fits_a_phone_in_light_and_dark(view, look):
    url = view(SWAP, "--paused").url
    pictures = []
    for scheme in ["light", "dark"]:
        page = look(url, viewport={"width": 390, "height": 844}, color_scheme=scheme)
        assert page.evaluate("document.documentElement.scrollWidth") <= 390
        pictures.append(page.screenshot())
    assert pictures[0] != pictures[1]
