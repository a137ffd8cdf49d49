"""The page of `staya view` in Chromium: it shows the run, and its actions reach the robots."""

import http.server
import json
import math
import re
import subprocess
import threading
import urllib.error
import urllib.request

import pytest
from conftest import ROOT, STAYA, until

SIX = "scenarios/six-robots.toml"
SWAP = "scenarios/swap-circle.toml"


def tick(page) -> int:
    return page.evaluate("staya.currentTick")


def on_page(page, place: list[float]) -> list[float]:
    """Position of a point of the world on the page, pixels."""
    return page.evaluate("([x, y, z]) => staya.project(x, y, z ?? 0)", place)[:2]


def place_of(page, index: int) -> list[float]:
    """Position of a robot, metres."""
    return page.evaluate("index => Array.from(staya.place(index))", index)


def select(page, index: int):
    page.mouse.click(*on_page(page, place_of(page, index)))
    until(lambda: page.evaluate("staya.robot?.index") == index, what="its panel")


def seek(page, wanted: int):
    page.evaluate("tick => staya.send({ do: 'seek', tick })", wanted)
    until(lambda: tick(page) == wanted and page.evaluate("staya.state.paused"), what=f"going to tick {wanted}")


def play_to_the_end(page):
    page.evaluate("staya.send({ do: 'speed', x: null })")
    page.keyboard.press(" ")
    until(lambda: page.evaluate("staya.state.at_end"), what="the end")
    until(lambda: tick(page) == page.evaluate("staya.state.tick"), what="the last frame")


def summary(*arguments) -> dict:
    """Summary of a run without a page."""
    said = subprocess.run([STAYA, "run", *arguments, "--json", "-q"], cwd=ROOT, capture_output=True, check=True)
    return json.loads(said.stdout)


def test_the_page_shows_the_summary_of_the_run(view, look, tmp_path):
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
    assert page.locator("#tick").text_content() == f"tick {stands}"
    shown, run = page.evaluate("staya.lastFigures"), summary(SIX, "--ticks", str(stands), "--out", str(tmp_path))
    assert [shown["hash"], shown["collisions"]] == [run["trace_hash"], run["collisions"]]
    assert shown["arrived"] == run["arrived"]


def test_a_selected_robot_shows_its_knowledge(view, look):
    page = look(view(SWAP).url)
    until(lambda: tick(page) > 70, what="ticks")
    # All sixteen robots are in radio range of each other by then.
    seek(page, 70)
    select(page, 4)
    robot = until(lambda: (robot := page.evaluate("staya.robot")) and robot["tick"] == 70 and robot, what="its tick")
    assert len(robot["neighbors"]) == 15 and robot["orca"]["lines"]
    assert page.get_by_text("Robot 5", exact=True).first.is_visible()


def test_a_robot_arrives_at_its_dragged_goal(view, look):
    page = look(view(SWAP, "--paused").url)
    select(page, 4)
    was, wanted = page.evaluate("Array.from(staya.target(4))"), [2.7, 0.5, 0]
    assert math.dist(was[:2], wanted[:2]) > 1
    page.mouse.move(*on_page(page, was))
    page.mouse.down()
    page.mouse.move(*on_page(page, [1, 1, 0]), steps=3)
    page.mouse.move(*on_page(page, wanted), steps=3)
    page.mouse.up()
    page.keyboard.press(".")
    until(lambda: tick(page) == 1, what="a step")
    target = page.evaluate("Array.from(staya.target(4))")
    assert math.dist(target[:2], wanted[:2]) < 0.05
    play_to_the_end(page)
    assert page.evaluate("staya.lastFigures.arrived") == 16
    assert math.dist(place_of(page, 4)[:2], target[:2]) < 0.05


def test_a_slider_changes_a_parameter_in_the_controllers(view, look):
    page = look(view(SWAP, "--paused").url)
    select(page, 4)
    before = page.evaluate("staya.robot.parameters.horizon_s")
    greatest = page.evaluate("staya.scene.parameters.find(each => each.name === 'horizon_s').greatest")
    assert before < greatest
    panel = page.locator("#parameters-panel")
    if panel.get_attribute("open") is None:
        panel.locator("summary").click()
    panel.locator("label.slider", has=page.get_by_text("horizon", exact=True)).locator("input").press("End")
    page.locator("#step").click()
    until(lambda: page.evaluate("staya.robot.parameters.horizon_s") == greatest, what="the change")
    # The change was for all robots.
    select(page, 9)
    assert page.evaluate("staya.robot.parameters.horizon_s") == greatest


def test_actions_of_the_page_are_saved_and_repeated(view, look, tmp_path):
    page = look(view(SWAP, "--paused").url)
    for order in [
        {"kind": "goal", "robot": 0, "place_m": [3, 3, 0]},
        {"kind": "parameter", "name": "horizon_s", "value": 3},
        {"kind": "solid", "solid": {"kind": "circle", "center_m": [0, 3.5], "radius_m": 0.3}},
    ]:
        page.evaluate("order => staya.send({ do: 'order', order })", order)
    play_to_the_end(page)
    end = page.evaluate("staya.lastFigures.hash")
    with page.expect_download() as download:
        page.get_by_label("Save as a scenario").click()
    saved = tmp_path / "saved.toml"
    download.value.save_as(saved)
    assert re.search(rf"Trace hash after tick \d+: {end}", saved.read_text())
    assert summary(str(saved), "--out", str(tmp_path / "out"))["trace_hash"] == end


def test_requests_without_the_token_are_refused(view):
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


@pytest.fixture
def elsewhere():
    """URL of a page of another origin."""

    class Empty(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()

        def log_message(self, *_):
            pass

    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Empty) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


def test_only_the_own_page_gets_a_socket(browser, view, elsewhere):
    url = view(SIX, "--paused").url
    live = url.replace("http://", "ws://").replace("/?", "/live?")
    wrong = re.sub("token=.*", "token=" + 32 * "0", live)
    page = browser.new_page()
    for address, socket, how in [(url, live, "open"), (url, wrong, "error"), (elsewhere, live, "error")]:
        page.goto(address)
        ended = page.evaluate(
            """url => new Promise(resolve => {
                const socket = new WebSocket(url);
                socket.onopen = () => resolve("open");
                socket.onerror = () => resolve("error");
            })""",
            socket,
        )
        assert ended == how, (address, socket)
    page.close()


def test_recordings_play_from_a_server_and_from_one_file(view, look, tmp_path):
    recording, page_file = tmp_path / "six.staya", tmp_path / "six.html"
    run = [STAYA, "run", SIX, "--out", tmp_path / "out", "--record", recording, "-q"]
    subprocess.run(run, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    subprocess.run([STAYA, "page", recording, "--out", page_file, "-q"], check=True, stdout=subprocess.DEVNULL)
    assert page_file.stat().st_size < 1_000_000
    # The page comes from a file and would log an error if it used the network.
    for url, options in [(view(recording, "--paused").url, {}), (page_file.as_uri(), {"offline": True})]:
        page = look(url, **options)
        assert page.evaluate("staya.scene.mode") == "recording"
        seek(page, 400)
        before = page.screenshot()
        page.keyboard.press(" ")
        until(lambda: tick(page) > 405, what="ticks")
        assert page.screenshot() != before


def test_the_page_fits_a_phone_in_light_and_dark(view, look):
    url = view(SWAP, "--paused").url
    pictures = []
    for scheme in ["light", "dark"]:
        page = look(url, viewport={"width": 390, "height": 844}, color_scheme=scheme)
        assert page.evaluate("document.documentElement.scrollWidth") <= 390
        pictures.append(page.screenshot())
    assert pictures[0] != pictures[1]


def test_a_robot_that_negotiates_shows_its_plan(view, look):
    page = look(view("scenarios/corridor.toml", "--paused").url)
    for step in range(1, 11):
        page.keyboard.press(".")
        until(lambda wanted=step: tick(page) == wanted, what=f"tick {step}")
    select(page, 1)
    until(lambda: page.evaluate("staya.robot?.tick") == 10, what="its knowledge")
    assert len(page.evaluate("staya.robot.plan")) == 4
    assert "planned moves" in page.inner_text("#legend")
