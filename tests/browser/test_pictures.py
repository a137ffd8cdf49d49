"""Content of the picture, addresses of moments, and saved pictures."""

import base64
import re
import subprocess
import xml.etree.ElementTree

from conftest import ROOT, STAYA, until
from test_view import SWAP, seek, tick

GROUPS = "scenarios/groups.toml"


def test_an_address_opens_a_moment(view, look):
    url = view(SWAP, "--paused").url
    page = look(f"{url}#t=2.5&robot=4")
    wanted = round(2.5 / page.evaluate("staya.scene.tick_s"))
    until(lambda: tick(page) == wanted, what="the moment")
    assert page.evaluate("staya.scene.robots.id[staya.selected]") == 4
    until(lambda: page.evaluate("staya.robot?.tick") == wanted, what="the robot")
    page.evaluate("location.hash = 't=1'")
    until(lambda: tick(page) == round(1 / page.evaluate("staya.scene.tick_s")), what="another moment")


def test_an_address_opens_a_moment_of_an_exported_page(look, tmp_path):
    page_file = tmp_path / "swap.html"
    command = [STAYA, "page", SWAP, "--out", page_file, "-q"]
    subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    page = look(page_file.as_uri() + "#t=1.5&robot=7", offline=True)
    wanted = round(1.5 / page.evaluate("staya.scene.tick_s"))
    until(lambda: tick(page) == wanted and page.evaluate("staya.state.paused"), what="the moment")
    assert page.evaluate("staya.robot.id") == 7


def test_pictures_are_saved_as_png_and_svg(view, look, tmp_path):
    page = look(view(SWAP, "--paused").url)
    seek(page, 60)
    saved = {}
    for kind in ["png", "svg"]:
        with page.expect_download() as download:
            page.locator(f"#save-{kind}").click()
        assert download.value.suggested_filename == f"swap-circle-60.{kind}"
        saved[kind] = tmp_path / f"picture.{kind}"
        download.value.save_as(saved[kind])
    png = saved["png"].read_bytes()
    stage = page.locator("#overlay")
    size = [int.from_bytes(png[at : at + 4], "big") for at in (16, 20)]
    assert png.startswith(b"\x89PNG") and size == stage.evaluate("canvas => [canvas.width, canvas.height]")
    root = xml.etree.ElementTree.parse(saved["svg"]).getroot()
    texts = [text.text for text in root.iter("{http://www.w3.org/2000/svg}text")]
    assert {str(number) for number in range(1, 17)} <= set(texts)
    assert any("swap-circle, seed" in text for text in texts)
    # Both show the same picture: a browser draws the SVG, and most pixels agree.
    share = page.evaluate(
        """async ([png, svg]) => {
            const pixels = async (kind, text) => {
                const image = new Image();
                image.src = `data:${kind};base64,${text}`;
                await image.decode();
                const canvas = document.createElement("canvas");
                [canvas.width, canvas.height] = [image.width, image.height];
                const context = canvas.getContext("2d");
                context.drawImage(image, 0, 0);
                return context.getImageData(0, 0, image.width, image.height).data;
            };
            const [a, b] = [await pixels("image/png", png), await pixels("image/svg+xml", svg)];
            let far = 0;
            for (let i = 0; i < a.length; i += 4)
                if (Math.abs(a[i] - b[i]) + Math.abs(a[i + 1] - b[i + 1]) + Math.abs(a[i + 2] - b[i + 2]) > 90) far++;
            return far / (a.length / 4);
        }""",
        [encoded(saved["png"]), encoded(saved["svg"])],
    )
    assert share < 0.01


def test_a_movie_is_recorded_while_the_run_plays(browser, view, look, tmp_path):
    page = look(view(SWAP, "--paused").url)
    page.locator("#save-movie").click()
    until(lambda: tick(page) > 10, what="the run to play")
    assert page.locator("#save-movie").inner_text() == "End movie"
    with page.expect_download() as download:
        page.locator("#play").click()
    movie = tmp_path / "movie.webm"
    download.value.save_as(movie)
    assert movie.read_bytes().startswith(b"\x1a\x45\xdf\xa3")
    assert page.locator("#save-movie").inner_text() == "Movie"
    # Its pictures change and have the size of the page's, which plays no movies itself.
    player = browser.new_page()
    size, differ = player.evaluate(
        """async movie => {
            const video = document.createElement("video");
            video.muted = true;
            const picture = () => {
                const canvas = document.createElement("canvas");
                [canvas.width, canvas.height] = [video.videoWidth, video.videoHeight];
                canvas.getContext("2d").drawImage(video, 0, 0);
                return canvas.toDataURL();
            };
            const pictures = new Set();
            const ended = new Promise(resolve => video.addEventListener("ended", resolve));
            video.addEventListener("timeupdate", () => pictures.add(picture()));
            video.src = `data:video/webm;base64,${movie}`;
            await video.play();
            await ended;
            return [[video.videoWidth, video.videoHeight], pictures.size];
        }""",
        encoded(movie),
    )
    player.close()
    assert size == page.locator("#overlay").evaluate("canvas => [canvas.width, canvas.height]")
    assert differ > 1


def encoded(path) -> str:
    return base64.b64encode(path.read_bytes()).decode()


def test_groups_have_the_colours_of_saved_pictures_at_once(view, look, tmp_path):
    page = look(view(GROUPS, "--paused").url, color_scheme="light")
    assert page.locator("#colour-by").input_value() == "group"
    groups = sorted(set(page.evaluate("staya.scene.robots.group")))
    assert len(groups) == 3 == len(re.findall(r"group \d|no group", page.inner_text("#legend")))
    with page.expect_download() as download:
        page.locator("#save-svg").click()
    download.value.save_as(tmp_path / "groups.svg")
    text = (tmp_path / "groups.svg").read_text()
    plots = (ROOT / "sim-host/plot/src/colour.rs").read_text().split("pub const PALETTE")[1]
    palette = ["#" + colour.replace("_", "") for colour in re.findall(r"0x([0-9a-f_]+)", plots)]
    robots = [text.count(f'fill="{palette[group]}"') for group in groups]
    assert robots == [page.evaluate("staya.scene.robots.group").count(group) for group in groups]


def test_columns_of_blown_air_are_below_flyers_only(view, look, tmp_path):
    for scenario, columns in [("scenarios/downwash.toml", 16), (SWAP, 0)]:
        page = look(view(scenario, "--paused").url, color_scheme="light")
        assert ("column of blown air" in page.inner_text("#legend")) == (columns > 0)
        with page.expect_download() as download:
            page.locator("#save-svg").click()
        download.value.save_as(tmp_path / "flyers.svg")
        assert (tmp_path / "flyers.svg").read_text().count('fill-opacity="0.25"') == columns


def test_small_plots_have_a_scale(view, look):
    page = look(view(SWAP, "--paused").url)
    seek(page, 60)
    # The numbers are to the right of the time line, which ends far after tick 60.
    upper = """() => [...document.querySelectorAll("#plots canvas")].some(canvas => {
        if (!canvas.clientWidth) return false;
        const wide = Math.round((24 * canvas.width) / canvas.clientWidth);
        const { data } = canvas.getContext("2d").getImageData(canvas.width - wide, 0, wide, canvas.height / 2);
        return data.some(part => part > 0);
    })"""
    until(lambda: page.evaluate(upper), what="the greatest value")


def test_many_robots_are_larger_than_their_goals(view, look):
    page = look(view("scenarios/scale-plane-small.toml", "--paused").url)
    assert page.evaluate("staya.marks.goal < staya.marks.robot && staya.marks.robot < 4")
    few = look(view(SWAP, "--paused").url)
    assert few.evaluate("staya.marks.goal") > 2


def test_goals_are_joined_to_their_robots(view, look):
    page = look(view(SWAP, "--paused").url)
    halfway = """() => {
        const [a, b] = [staya.place(0), staya.target(0)];
        const [x, y] = staya.project(...[0, 1].map(axis => 0.8 * a[axis] + 0.2 * b[axis]));
        return [Math.round(x) - 4, Math.round(y) - 4];
    }"""
    x, y = page.evaluate(halfway)
    clip = {"x": x, "y": y, "width": 9, "height": 9}
    with_line = page.screenshot(clip=clip)
    page.locator("[data-layer='targets']").click()
    page.wait_for_timeout(300)
    assert page.screenshot(clip=clip) != with_line


def test_labels_do_not_overlap(view, look):
    page = look(view("scenarios/six-robots.toml", "--paused").url, viewport={"width": 420, "height": 420})
    for x in range(5):
        page.keyboard.press("-")
    page.wait_for_timeout(300)
    boxes = page.evaluate("staya.labels")
    assert boxes
    for i, a in enumerate(boxes):
        for b in boxes[:i]:
            assert a[0] >= b[2] or b[0] >= a[2] or a[1] >= b[3] or b[1] >= a[3]


def test_the_tools_cover_no_part_of_the_scene_on_a_phone(view, look):
    for scenario in [SWAP, "scenarios/twenty-discs.toml"]:
        page = look(view(scenario, "--paused").url, viewport={"width": 390, "height": 844})
        box = page.locator("#tools").bounding_box()
        west, south, east, north = page.evaluate("staya.scene.bounds_m")
        (left, top), (right, bottom) = [
            page.evaluate("place => staya.project(...place)", place)[:2] for place in [[west, north], [east, south]]
        ]
        is_beside = box["x"] + box["width"] < left or right < box["x"]
        assert is_beside or box["y"] + box["height"] < top or bottom < box["y"]
