"""Time on the page: a fixed time line, plots of all ticks, and pictures that depend on the tick
alone."""

import json
import math
import subprocess

import pytest
from conftest import ROOT, STAYA, until
from test_view import SIX, SWAP, play_to_the_end, seek, select, tick


def ends(page) -> list[int]:
    """The ends of the time line."""
    return page.evaluate("['min', 'max'].map(end => Number(document.getElementById('timeline')[end]))")


def tap(page, share: float):
    """Clicks the time line."""
    box = page.locator("#timeline").bounding_box()
    page.mouse.click(box["x"] + 7 + share * (box["width"] - 14), box["y"] + box["height"] / 2)


def picture(page) -> bytes:
    """The pixels of the picture without the panels, once it has settled."""
    until(lambda: page.evaluate("staya.settled"), what="a complete picture")
    page.mouse.move(1, 1)
    page.wait_for_timeout(500)
    return page.locator("#stage").screenshot()


def test_the_time_line_has_all_ticks_of_the_scenario(view, look):
    page = look(view(SIX, "--paused").url)
    all_ticks = [0, page.evaluate("staya.scene.ticks")]
    assert ends(page) == all_ticks
    play_to_the_end(page)
    assert page.evaluate("staya.state.last") < all_ticks[1] and ends(page) == all_ticks
    for wanted in [20, 300, 0]:
        seek(page, wanted)
        assert ends(page) == all_ticks
    assert page.evaluate("staya.plotted") == all_ticks


def test_the_time_line_runs_on_to_an_unknown_tick(view, look):
    page = look(view(SIX, "--paused").url)
    page.evaluate("staya.send({ do: 'seek', tick: 60 })")
    until(lambda: tick(page) == 60, what="a tick that was not computed before")
    assert page.evaluate("staya.state.paused")
    until(lambda: page.evaluate("staya.series('Arrived').length") == 61, what="the figures of all ticks")


def test_the_first_tap_on_the_time_line_goes_there(view, look):
    page = look(view(SWAP).url)
    until(lambda: tick(page) > 40, what="ticks")
    wanted = round(0.01 * ends(page)[1])
    tap(page, 0.01)
    until(lambda: page.evaluate("staya.state.paused"), what="a pause")
    until(lambda: abs(tick(page) - wanted) <= 3, timeout=5, what="the tapped tick")


def test_the_time_line_marks_orders(view, look):
    page = look(view(SWAP, "--paused").url)
    seek(page, 10)
    page.evaluate("staya.send({ do: 'order', order: { kind: 'goal', robot: 0, place_m: [1, 1, 0] } })")
    mark = page.locator("#marks i")
    until(lambda: mark.count() == 1, what="a mark")
    assert mark.get_attribute("title") == "goal at tick 10"


def test_plots_at_full_speed_equal_the_recorded_series(view, look, tmp_path):
    page = look(view(SWAP, "--paused").url)
    play_to_the_end(page)
    last = tick(page)
    recording, page_file = tmp_path / "swap.staya", tmp_path / "swap.html"
    run = [STAYA, "run", SWAP, "--ticks", str(last), "--out", tmp_path / "out", "--record", recording, "-q"]
    subprocess.run(run, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    subprocess.run([STAYA, "page", recording, "--out", page_file, "-q"], check=True, stdout=subprocess.DEVNULL)
    recorded = look(page_file.as_uri(), offline=True)
    until(lambda: len(recorded.evaluate("staya.series('Arrived')")) == last + 1, what="the recorded series")
    for name in ["Arrived", "Waiting", "Collisions", "Group order", "Packets delivered, lost", "Smallest gap"]:
        series = page.evaluate("name => JSON.stringify(staya.series(name))", name)
        assert len(json.loads(series)) == last + 1, name
        assert series == recorded.evaluate("name => JSON.stringify(staya.series(name))", name), name
    # The same after a seek and in a page that was opened late.
    seek(page, 30)
    late = look(page.url)
    for other in [page, late]:
        assert other.evaluate("staya.series('Arrived').length") == last + 1
    assert late.evaluate("staya.lines('Smallest gap')") == page.evaluate("staya.lines('Smallest gap')")


def test_plots_do_not_join_values_across_gaps(view, look):
    page = look(view("scenarios/twenty-discs.toml", "--paused").url)
    play_to_the_end(page)
    known = [(at, value) for at, value in page.evaluate("staya.series('Smallest gap')") if not math.isnan(value)]
    pieces = 1 + sum(after[0] - before[0] > 1 for before, after in zip(known, known[1:]))
    assert pieces > 1
    assert page.get_by_text("Smallest gap", exact=True).is_visible()
    drawn = page.evaluate("staya.lines('Smallest gap')")
    assert len(drawn) == pieces
    # No piece begins before the one before it ends.
    assert all(before[-1][0] <= after[0][0] for before, after in zip(drawn, drawn[1:]))


@pytest.mark.parametrize("scenario", [SIX, SWAP])
def test_a_picture_depends_on_the_tick_alone(view, look, scenario):
    page = look(view(scenario, "--paused").url)
    wanted = 45
    pictures = {}
    for step in range(1, wanted + 1):
        page.keyboard.press(".")
        until(lambda step=step: tick(page) == step, what="a step")
    pictures["step by step"] = picture(page)
    play_to_the_end(page)
    seek(page, wanted)
    pictures["after a fast run"] = picture(page)
    seek(page, 0)
    seek(page, wanted)
    pictures["after a jump"] = picture(page)
    pictures["on a new page"] = picture(look(page.url))
    for way, pixels in pictures.items():
        assert pixels == pictures["step by step"], way
    seek(page, 0)
    assert picture(page) != pictures["step by step"]


def test_a_recording_has_trails_after_a_jump(view, look, tmp_path):
    recording = tmp_path / "swap.staya"
    run = [STAYA, "run", SWAP, "--ticks", "80", "--out", tmp_path / "out", "--record", recording, "-q"]
    subprocess.run(run, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    page = look(view(recording, "--paused").url)
    seek(page, 60)
    picture(page)
    trail = page.evaluate("staya.trail")
    assert len(trail) > 4 and trail[-1] <= 60


def test_plots_and_velocities_are_drawn_when_their_panel_opens(view, look):
    page = look(view(SWAP, "--paused").url)
    seek(page, 40)
    select(page, 4)
    until(lambda: page.evaluate("staya.robot.tick") == 40, what="its knowledge")
    page.keyboard.press("p")
    page.keyboard.press(".")
    until(lambda: page.evaluate("staya.robot.tick") == 41, what="a step")
    page.keyboard.press("p")
    inked = """() => {
        const canvas = document.getElementById('velocity-plot');
        const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
        return data.some(part => part !== 0);
    }"""
    until(lambda: page.evaluate(inked), timeout=5, what="the velocities")
    plot = "document.getElementById('velocity-plot').toDataURL()"
    before = page.evaluate(plot)
    panel = page.locator("#robot-panel > summary")
    panel.click()
    page.keyboard.press(".")
    until(lambda: page.evaluate("staya.robot.tick") == 42, what="a step")
    panel.click()
    until(lambda: page.evaluate(plot) != before, timeout=5, what="new velocities")


def test_links_appear_while_paused(view, look):
    page = look(view(SWAP, "--paused").url)
    seek(page, 40)
    page.keyboard.press("l")
    links = until(lambda: page.evaluate("staya.links"), timeout=5, what="links")
    assert links["tick"] == 40 and links["pairs"] > 0
    seek(page, 20)
    until(lambda: page.evaluate("staya.links?.tick") == 20 and page.evaluate("staya.links.pairs") > 0, what="links")


def test_the_picture_stays_when_panels_toggle(view, look):
    page = look(view(SWAP, "--paused").url)
    blank = page.evaluate("""() => new Promise(resolve => {
        const ground = document.getElementById('ground');
        // Called after the page's own observer and before the browser paints.
        let calls = 0;
        new ResizeObserver(() => {
            if (++calls === 1) {
                setTimeout(() => document.getElementById('toggle-side').click());
                return;
            }
            const { data } = ground.getContext('2d').getImageData(0, 0, ground.width, ground.height);
            resolve(data[0] + data[1] + data[2] === 0);
        }).observe(document.getElementById('stage'));
    })""")
    assert not blank


def test_an_exported_page_shows_the_same_picture_after_a_jump(look, tmp_path):
    recording, page_file = tmp_path / "swap.staya", tmp_path / "swap.html"
    run = [STAYA, "run", SWAP, "--ticks", "90", "--out", tmp_path / "out", "--record", recording, "-q"]
    subprocess.run(run, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    subprocess.run([STAYA, "page", recording, "--out", page_file, "-q"], check=True, stdout=subprocess.DEVNULL)
    page = look(page_file.as_uri(), offline=True)
    seek(page, 60)
    jumped = picture(page)
    assert len(page.evaluate("staya.trail")) > 4
    seek(page, 0)
    page.evaluate("staya.send({ do: 'speed', x: null })")
    page.evaluate("staya.send({ do: 'play' })")
    until(lambda: page.evaluate("staya.state.at_end"), what="the end")
    seek(page, 60)
    assert picture(page) == jumped
