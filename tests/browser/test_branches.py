"""Branches: a change in the past keeps the old future."""

import math
import re

from conftest import until
from test_view import SWAP, place_of, seek, summary, tick


def goal(page, place: list[float]):
    """Gives robot 0 a goal at the shown tick."""
    page.evaluate(
        "place_m => staya.send({ do: 'order', order: { kind: 'goal', robot: 0, place_m } })", place
    )


def play_to_the_end(page):
    page.evaluate("staya.send({ do: 'speed', x: null })")
    page.evaluate("staya.send({ do: 'play' })")
    until(lambda: not page.evaluate("staya.state.paused") or page.evaluate("staya.state.at_end"), what="ticks")
    until(lambda: page.evaluate("staya.state.at_end"), what="the end")
    until(lambda: tick(page) == page.evaluate("staya.state.tick"), what="the last frame")


def show_branch(page, number: int):
    page.locator("#branch").select_option(str(number))
    until(lambda: page.evaluate("staya.state.branch") == number, what="the branch")


def test_a_change_in_the_past_keeps_the_old_future(view, look, tmp_path):
    page = look(view(SWAP, "--paused").url)
    assert not page.locator("#branch-label").is_visible()
    play_to_the_end(page)
    last, end = tick(page), page.evaluate("staya.lastFigures.hash")
    series = page.evaluate("JSON.stringify(staya.series('Smallest gap'))")
    seek(page, 30)
    goal(page, [3, 3, 0])
    until(lambda: page.evaluate("staya.state.branch") == 2, what="a branch")
    assert page.evaluate("staya.state.last") == 30 and page.locator("#branch-label").is_visible()
    play_to_the_end(page)
    changed = page.evaluate("staya.lastFigures.hash")
    assert changed != end and math.dist(place_of(page, 0)[:2], [3, 3]) < 0.05
    # Both are shown at once: the robots of the old branch as outlines.
    until(lambda: page.evaluate("staya.otherPlace(0)"), what="the robots of the old branch")
    assert math.dist(page.evaluate("staya.otherPlace(0)")[:2], place_of(page, 0)[:2]) > 1
    assert "branch 1" in page.inner_text("#legend")
    # The old branch again, with all its figures.
    show_branch(page, 1)
    assert page.evaluate("staya.state.last") == last
    until(lambda: page.evaluate("JSON.stringify(staya.series('Smallest gap'))") == series, what="the old figures")
    seek(page, last)
    until(lambda: page.evaluate("staya.lastFigures.hash") == end, what="the old end")
    # The file says which branch it has.
    show_branch(page, 2)
    seek(page, page.evaluate("staya.state.last"))
    until(lambda: page.evaluate("staya.lastFigures.hash") == changed, what="the new end")
    with page.expect_download() as download:
        page.get_by_label("Save as a scenario").click()
    assert download.value.suggested_filename == "swap-circle-branch-2.toml"
    saved = tmp_path / "saved.toml"
    download.value.save_as(saved)
    text = saved.read_text()
    assert text.startswith("# Saved from a view: branch 2, which begins at 1.5 s, with 1 change by pages.")
    assert re.search(rf"Trace hash after tick \d+: {changed}", text)
    assert summary(str(saved), "--out", str(tmp_path / "out"))["trace_hash"] == changed
    assert "branch 2 with 1 change" in page.locator("#toasts").inner_text()


def test_undo_takes_back_the_last_change(view, look):
    page = look(view(SWAP, "--paused").url)
    undo = page.get_by_label("Undo", exact=True)
    assert undo.is_disabled()
    seek(page, 20)
    was = page.evaluate("Array.from(staya.target(0))")
    goal(page, [3, 3, 0])
    until(lambda: math.dist(page.evaluate("Array.from(staya.target(0))"), [3, 3, 0]) < 0.01, what="the new goal")
    undo.click()
    until(lambda: page.evaluate("Array.from(staya.target(0))") == was, what="the old goal")
    assert tick(page) == 20 and page.locator("#marks i").count() == 0
    until(lambda: undo.is_disabled(), what="nothing to undo")
    play_to_the_end(page)
    last, end = tick(page), page.evaluate("staya.lastFigures.hash")
    # A change in the past, undone: the old future is there without a new run.
    seek(page, 30)
    goal(page, [3, 3, 0])
    until(lambda: page.evaluate("staya.state.last") == 30, what="the branch")
    page.keyboard.press("z")
    until(lambda: page.evaluate("staya.state.last") == last, what="the old future")
    seek(page, last)
    until(lambda: page.evaluate("staya.lastFigures.hash") == end, what="the old end")


def test_playing_from_the_past_repeats_the_later_changes(view, look):
    page = look(view(SWAP, "--paused").url)
    seek(page, 20)
    goal(page, [3, 3, 0])
    play_to_the_end(page)
    end = page.evaluate("staya.lastFigures.hash")
    seek(page, 5)
    play_to_the_end(page)
    assert page.evaluate("staya.lastFigures.hash") == end
    assert len(page.evaluate("staya.state.branches")) == 1
