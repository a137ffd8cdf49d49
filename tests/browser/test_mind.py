"""The decision of the selected robot, drawn around it and told in a sentence."""

import json
import subprocess

import pytest
from conftest import ROOT, STAYA, until
from test_view import SWAP, seek, summary


def select(page, number: int):
    page.evaluate("number => { location.hash = `robot=${number}` }", number)
    wanted = page.evaluate("staya.currentTick")
    until(lambda: page.evaluate("staya.robot?.id") == number, what="its knowledge")
    until(lambda: page.evaluate("staya.robot.tick") == wanted, what="its knowledge at this tick")


def around(page, index: int) -> dict:
    """The square around a robot that its permitted velocities cover."""
    x, y = page.evaluate("index => staya.project(...staya.place(index))", index)[:2]
    return {"x": max(0, x - 60), "y": max(0, y - 60), "width": 120, "height": 120}


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_decision_is_drawn_around_the_robot(view, look, scheme):
    page = look(view(SWAP, "--paused").url, color_scheme=scheme)
    seek(page, 70)
    select(page, 5)
    assert page.evaluate("staya.robot.orca.lines.length") > 0
    page.wait_for_timeout(300)
    with_it = page.screenshot(clip=around(page, 4))
    assert "Permitted velocities, ways of" in page.evaluate("staya.caption")
    assert "half-planes" in page.inner_text("#legend")
    page.locator("[data-layer='mind']").click()
    page.wait_for_timeout(300)
    assert page.screenshot(clip=around(page, 4)) != with_it
    assert page.evaluate("staya.caption") is None and "half-planes" not in page.inner_text("#legend")


def test_the_sentence_follows_from_the_state(view, look):
    page = look(view(SWAP, "--paused").url)
    seek(page, 1)
    select(page, 5)
    # Its neighbours are unknown; its preferred velocity is forbidden; it is past the others.
    for wanted, sentence in [
        (1, "Robot 5 waits: the places of silent robots are unknown"),
        (70, "Robot 5 moves to its goal and evades other robots"),
        (150, "Robot 5 moves to its goal"),
    ]:
        seek(page, wanted)
        robot = until(lambda: page.evaluate("staya.robot?.tick") == wanted and page.evaluate("staya.robot"), what="it")
        (x, y), lines = robot["orca"]["preferred_mps"], robot["orca"]["lines"]
        past = [(x - a) * n + (y - b) * m for (a, b), (n, m) in ((line["point"], line["normal"]) for line in lines)]
        if robot["wait"] is None:
            assert ("evades" in sentence) == (min(past, default=0) < 0)
        assert page.evaluate("staya.sentence") == sentence
        until(lambda: page.locator(".sentence").inner_text() == sentence, what="the panel")
    page.evaluate("staya.send({ do: 'order', order: { kind: 'down', robot: 4, for_s: null } })")
    page.keyboard.press(".")
    until(lambda: page.evaluate("staya.robot?.up") is False, what="the robot goes down")
    assert page.evaluate("staya.sentence") == "Robot 5 is down"


@pytest.mark.parametrize(
    ("scenario", "sentence"),
    [
        ("scenarios/boids.toml", "Robot 1 moves; its law has no goal"),
        ("scenarios/goal-flock.toml", "Robot 1 moves with its flock"),
    ],
)
def test_no_robot_of_a_flock_moves_to_a_goal_of_its_own(view, look, scenario, sentence):
    page = look(view(scenario, "--paused").url)
    seek(page, 10)
    select(page, 1)
    until(lambda: (page.evaluate("staya.sentence") or "").startswith(sentence), what="the sentence")


def test_a_waiting_robot_says_why(view, look):
    page = look(view("scenarios/doorway.toml", "--paused").url)
    reasons = {
        "team": "leader",
        "stopped": "another robot asked for a stop",
        "route": "terrain or walls block the way",
        "radio": "the places of silent robots are unknown",
        "turn": "other robots go first",
        "robots": "other robots are in the way",
        "goal_taken": "occupies",
    }
    page.evaluate("staya.send({ do: 'speed', x: null })")
    page.keyboard.press(" ")
    some = "staya.series('Waiting').find(([, robots]) => robots > 0)"
    seek(page, until(lambda: page.evaluate(some), what="a robot that waits")[0])
    waiting = page.evaluate("staya.waiting[0]")
    select(page, waiting)
    word = page.evaluate("staya.scene.words.waits[staya.robot.wait]")
    sentence = page.evaluate("staya.sentence")
    assert sentence.startswith(f"Robot {waiting} waits: ") and reasons[word] in sentence


def test_in_space_the_plot_says_that_it_is_a_slice(view, look):
    page = look(view("scenarios/downwash.toml", "--paused").url)
    seek(page, 100)
    select(page, 3)
    climb = page.evaluate("staya.robot.orca.climb_mps")
    assert f"a slice at a climb of {climb:.2f} m/s" in page.evaluate("staya.caption")
    until(lambda: "slice" in page.inner_text("#robot-body h3 >> nth=0"), what="the panel's title")


def exported(path, *options) -> dict:
    command = [STAYA, "page", SWAP, "--set", "ticks=200", "--out", path, "--json", *options]
    return json.loads(subprocess.run(command, cwd=ROOT, check=True, capture_output=True).stdout)


def test_an_exported_page_contains_the_chosen_minds(view, look, tmp_path):
    plain, chosen = exported(tmp_path / "plain.html"), exported(tmp_path / "minds.html", "--minds", "5,1")
    minds = chosen["recording_bytes"] - plain["recording_bytes"]
    assert 10_000 < minds < 200_000 and abs(chosen["bytes"] - plain["bytes"] - minds * 4 / 3) < 9
    page = look((tmp_path / "minds.html").as_uri() + "#t=3.5&robot=5", offline=True)
    until(lambda: page.evaluate("staya.robot?.tick") == 70, what="the moment")
    live = look(view(SWAP, "--set", "ticks=200", "--paused").url)
    seek(live, 70)
    select(live, 5)
    [recorded, robot] = [each.evaluate("staya.robot") for each in (page, live)]
    assert len(recorded["neighbors"]) == 15 and recorded["events"] == robot["events"]
    for name in ["preferred_mps", "chosen_mps"]:
        assert recorded["orca"][name] == pytest.approx(robot["orca"][name], abs=1e-4)
    for mine, other in zip(recorded["neighbors"], robot["neighbors"], strict=True):
        assert mine["id"] == other["id"] and mine["position_m"] == pytest.approx(other["position_m"], abs=1e-4)
    assert page.evaluate("[staya.sentence, staya.caption]") == live.evaluate("[staya.sentence, staya.caption]")
    # Its links are those of all links from or to it.
    for each in (page, live):
        each.locator("[data-layer='links']").click()
    until(lambda: (links := live.evaluate("staya.links")) and links["tick"] == 70, what="links")
    assert 0 < page.evaluate("staya.links.pairs") < live.evaluate("staya.links.pairs")
    assert page.locator("#velocity-plot").is_visible()
    page.evaluate("location.hash = 'robot=2'")
    until(lambda: page.evaluate("staya.robot?.id") == 2, what="another robot")
    assert page.evaluate("staya.robot.neighbors") is None
    page.get_by_text("This page contains the knowledge of robots 1, 5.").wait_for()


def test_a_selected_robot_has_plots_of_its_own(view, look, tmp_path):
    ticks = exported(tmp_path / "minds.html", "--minds", "5")["last_tick"] + 1
    page = look((tmp_path / "minds.html").as_uri() + "#t=3.5&robot=5", offline=True)
    until(lambda: len(page.evaluate("staya.robotSeries('Speed')")) == ticks, what="all ticks")
    until(lambda: page.evaluate("staya.robot?.tick") == 70, what="the moment")
    robot, age = page.evaluate("staya.robot"), dict(page.evaluate("staya.robotSeries('Oldest knowledge')"))[70]
    assert age == pytest.approx(max(other["age_s"] for other in robot["neighbors"]))
    # The least gap of the swarm is one of some robot.
    gaps = dict(page.evaluate("staya.robotSeries('Gap to the nearest')"))
    least = dict(page.evaluate("staya.series('Smallest gap')"))
    assert all(gaps[tick] >= gap - 1e-5 for tick, gap in least.items() if gap is not None and gap == gap)
    # A live view plots the ticks that it has shown.
    live = look(view(SWAP, "--paused").url)
    select(live, 5)
    live.keyboard.press(".")
    until(lambda: len(live.evaluate("staya.robotSeries('Speed')")) == 2, what="two ticks")
    for tick, speed in live.evaluate("staya.robotSeries('Speed')"):
        assert speed == dict(page.evaluate("staya.robotSeries('Speed')"))[tick]


def test_minds_do_not_change_the_run(look, tmp_path):
    last = exported(tmp_path / "minds.html", "--minds", "3")["last_tick"]
    page = look((tmp_path / "minds.html").as_uri() + "#t=1000", offline=True)
    until(lambda: page.evaluate("staya.currentTick") == last, what="the end")
    run = summary(SWAP, "--set", "ticks=200", "--out", str(tmp_path / "out"))
    assert page.evaluate("staya.lastFigures.hash") == run["trace_hash"]


def test_a_robot_that_does_not_exist_has_no_mind(tmp_path):
    command = [STAYA, "page", SWAP, "--out", tmp_path / "page.html", "--minds", "4,17"]
    told = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert told.returncode != 0 and not (tmp_path / "page.html").exists()
    assert "--minds 17: swap-circle has no robot 17; its robots have numbers 1 to 16" in told.stderr


def test_a_robot_without_a_free_velocity_says_so(view, look):
    page = look(view(SWAP, "--paused").url)
    told = """async ([kind, chosen, wait]) => {
        const { Mind } = await import("staya/mind.js");
        const lines = [{ point: [0.1, 0], normal: [1, 0] }, { point: [-0.1, 0], normal: [-1, 0] }];
        const orca = { lines, chosen_mps: chosen, preferred_mps: [0.5, 0], max_speed_mps: 0.5 };
        const robot = { id: 8, index: 7, mode: 2, wait, leader: null, orca };
        return new Mind({ robot, scene: { ...staya.scene, kind } }).sentence;
    }"""
    free = "No velocity is free: robot 8 takes the one that breaks the rules least"
    assert page.evaluate(told, ["plane", [0, 0.3], None]) == free
    assert page.evaluate(told, ["space", [0, 0.3], None]) == free.replace("velocity", "velocity of the slice")
    # A robot that stands takes none.
    assert page.evaluate(told, ["plane", [0, 0], 4]) == "Robot 8 waits: other robots go first"
