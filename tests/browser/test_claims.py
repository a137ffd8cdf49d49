"""The claims of a paper's figure beside its scenario, and the form for new runs."""

from conftest import until

GOALS = "papers/pav/goals/scenario.toml"
SIZES = [(1400, 900), (800, 600), (390, 844)]


def test_a_figure_shows_the_papers_value_the_recorded_one_and_that_of_the_run(view, look):
    page = look(view(GOALS, "--paused").url)
    panel = page.locator("#claims-panel")
    share = panel.locator(".claim", has_text="about equal shares, first goal")
    shown = share.inner_text()
    assert "about equal" in shown and "holds" in shown and "0.3156 to 0.3556" in shown, shown
    overlaps = panel.locator(".claim", has_text="robots overlap where K2")
    page.locator("#step").click()
    until(lambda: page.evaluate("staya.currentTick") == 1, what="the step")
    collisions = str(page.evaluate("staya.lastFigures.collisions"))
    value = overlaps.locator("dt:text-is('this run') + dd")
    until(lambda: value.inner_text() == collisions, what="the value of the run")
    # Values that only a study measures have no value of the run.
    assert share.locator("dt:text-is('this run')").count() == 0


def test_a_scenario_without_a_figure_has_no_claims(view, look):
    page = look(view("scenarios/swap-circle.toml", "--paused").url)
    assert page.locator("#claims-panel").is_hidden()


def test_claims_and_the_form_fit_on_every_screen(view, look):
    url = view(GOALS, "--paused").url
    for width, height in SIZES:
        page = look(url, viewport={"width": width, "height": height})
        if page.locator("#claims-panel").is_hidden() or not page.locator("#side").is_visible():
            page.locator("#toggle-side").click()
        page.locator("#claims-panel").wait_for()
        side = page.locator("#side").evaluate("e => [e.scrollWidth, e.clientWidth]")
        assert side[0] <= side[1], (width, side)
        page.locator("#open-new").click()
        page.locator("#new-places").select_option("given")
        box = page.locator("#new-run").bounding_box()
        assert box["x"] >= 0 and box["y"] >= 0, (width, box)
        assert box["x"] + box["width"] <= width and box["y"] + box["height"] <= height, (width, box)


def test_a_new_run_has_the_given_tick_model_and_obstacles(view, look):
    page = look(view(GOALS, "--paused").url)
    page.locator("#open-new").click()
    page.locator("#new-robots").fill("9")
    page.locator("#new-places").select_option("given")
    assert page.locator("#new-obstacles").is_disabled()
    page.locator("#new-discs").fill("12, 1, 0.5\n14 3 1\n")
    page.locator("#new-avoidance").select_option("tangential_single")
    page.locator("#new-tick").fill("0.05")
    page.locator("#new-run .primary").click()
    until(lambda: page.evaluate("staya.scene.name") == "new-run", what="the new run")
    assert page.evaluate("[staya.scene.tick_s, staya.scene.solids.length, staya.scene.robots.id.length]") == [0.05, 2, 9]
    assert page.locator("#claims-panel").is_hidden()
    names = page.evaluate("staya.scene.parameters.map((each) => each.name)")
    assert "min_distance_m" in names and "horizon_s" not in names
    # A mistake is shown, and the run stays.
    page.locator("#open-new").click()
    page.locator("#new-discs").fill("12, one, 0.5")
    page.locator("#new-run .primary").click()
    page.locator(".toast.error", has_text="obstacle 1 is not three numbers").wait_for()
    assert page.evaluate("staya.scene.solids.length") == 2
