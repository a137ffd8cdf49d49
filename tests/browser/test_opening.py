"""The opening of a page, the camera, coordinates and the measuring line."""

import math

from conftest import until
from test_view import SWAP, on_page, place_of, seek, tick


def test_the_page_tells_what_the_scenario_is_about(view, look):
    url = view(SWAP, "--paused").url
    page = look(url)
    about = "Sixteen robots on a circle, each with its goal on the opposite side"
    assert page.locator("#about").is_visible() and about in page.locator("#about").inner_text()
    assert "scenarios/README.md" not in page.locator("#about").inner_text()
    # The panels of a narrow screen are closed.
    phone = look(url, viewport={"width": 390, "height": 844})
    phone.locator("#toasts").get_by_text(about).wait_for()


def test_the_camera_keeps_a_flock_in_sight_until_it_is_moved(view, look):
    page = look(view("scenarios/boids.toml", "--set", "ticks=400", "--paused").url)
    west, south, east, north = page.evaluate("staya.scene.bounds_m")
    box = page.locator("#overlay").bounding_box()
    places = "staya.scene.robots.id.map((_, i) => Array.from(staya.place(i)))"
    corner = "staya.project(...staya.scene.bounds_m.slice(0, 2))"
    opening = page.evaluate(corner)

    def outside() -> list:
        return [[x, y] for x, y, _ in page.evaluate(places) if not (west < x < east and south < y < north)]

    assert not outside()
    seek(page, 400)
    page.wait_for_timeout(300)
    assert outside()
    for place in page.evaluate(places):
        x, y = on_page(page, place)
        assert box["x"] < x < box["x"] + box["width"] and box["y"] < y < box["y"] + box["height"]
    # The camera depends on the moment, not on the way to it.
    seek(page, 0)
    page.wait_for_timeout(300)
    assert page.evaluate(corner) == opening
    page.locator("#zoom-in").click()
    page.wait_for_timeout(100)
    moved = page.evaluate(corner)
    seek(page, 400)
    page.wait_for_timeout(300)
    assert page.evaluate(corner) == moved != opening
    page.locator("#fit").click()
    page.wait_for_timeout(100)
    assert page.evaluate(corner) != moved


def test_coordinates_are_under_the_pointer(view, look):
    page = look(view("scenarios/six-robots.toml", "--paused").url)
    land = page.evaluate("staya.scene.land")
    x, y = [land["origin_m"][axis] + 10.5 * land["cell_m"] for axis in (0, 1)]
    page.mouse.move(*on_page(page, [x, y]))
    origin = page.evaluate("staya.scene.origin_m")
    text = until(lambda: page.locator("#pointer-place").inner_text(), what="coordinates")
    shown = [float(part.split()[1]) for part in text.split(" m")[0].split(", ")]
    assert math.dist(shown, [x + origin[0], y + origin[1]]) < land["cell_m"] / 2 and "cell 10, 10" in text


def test_a_line_measures_a_distance_in_every_page(view, look):
    page = look(view(SWAP, "--paused").url)
    centres = [place_of(page, 0), place_of(page, 8)]
    page.keyboard.press("m")
    assert page.locator("#measure").get_attribute("aria-pressed") == "true"
    a, b = [on_page(page, place) for place in centres]
    # Ends on robots are their centres.
    page.mouse.move(a[0] + 3, a[1])
    page.mouse.down()
    page.mouse.move(*b, steps=4)
    page.mouse.up()
    ruler = page.evaluate("staya.ruler")
    assert math.dist(ruler["from"], ruler["to"]) == math.dist(*centres) and tick(page) == 0
    assert ruler["text"] == f"{math.dist(*centres):.3g} m"
    page.keyboard.press("Escape")
    assert page.evaluate("staya.ruler") is None
    assert page.locator("#measure").get_attribute("aria-pressed") == "false"
