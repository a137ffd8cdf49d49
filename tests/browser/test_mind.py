"""The decision of the selected robot, drawn around it and told in a sentence."""

import pytest
from conftest import until
from test_view import SWAP, seek


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
        (1, "Robot 5 waits: it does not know where silent robots are"),
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


def test_a_waiting_robot_says_why(view, look):
    page = look(view("scenarios/doorway.toml", "--paused").url)
    reasons = {
        "team": "its leader",
        "stopped": "another robot asked it to stop",
        "route": "terrain or walls block its way",
        "radio": "it does not know where silent robots are",
        "turn": "other robots go first",
        "robots": "other robots are in its way",
        "goal_taken": "occupies its goal",
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
    assert "slice" in page.inner_text("#robot-body h3 >> nth=0")
