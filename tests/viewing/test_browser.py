"""Pages in a browser: they play, say nothing in the console, and show things where they are."""

import base64
import io
import re
from pathlib import Path
from urllib.parse import urlsplit
from urllib.request import url2pathname

import numpy as np
import pytest
from matplotlib.image import imread
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.support.wait import WebDriverWait

import tweezer
from tests.browsing import resize
from tests.reference.rigid_body import rotation_matrix
from tweezer.viewing import movie

#: fields of the camera that are matrices, by columns
MATRICES = ("projection", "view")
#: before numbers on a page
MINUS = "\N{MINUS SIGN}"


#: where the bead is and how it is turned, at a time
BEAD = "tweezer.seek(arguments[0]); return tweezer.bead()"
#: times, numbers beside the first curve, and words for screen readers of ten frames, while a clock
#: by which words are held back stands still
PLAYED = """
const done = arguments[0], found = [];
performance.now = () => 1e9;
tweezer.play();
const look = () => {
  found.push([
    tweezer.time(), document.querySelector(".plot .number").textContent,
    document.querySelector("input[type=range]").getAttribute("aria-valuetext")]);
  if (found.length < 11) return requestAnimationFrame(look);
  tweezer.pause();
  done([found.slice(1), document.querySelector("input[type=range]").getAttribute("aria-valuetext"),
        document.querySelector("output").textContent]);
};
requestAnimationFrame(look);"""
#: a browser whose canvas gives no context of WebGL
WITHOUT = """
const { getContext } = HTMLCanvasElement.prototype;
HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
  return kind.startsWith("webgl") ? null : getContext.call(this, kind, ...more);
};"""


@pytest.fixture(scope="module")
def turned_run(turning_run):
    """The run, with a bead that is turned from the start."""
    turned = np.tile([0.4, 0.3, -0.5, 0.7], (turning_run.sizes["time"], 1))
    turned /= np.linalg.norm(turned, axis=1, keepdims=True)
    return turning_run.assign(orientation=(("time", "euler_parameter"), turned))


@pytest.fixture(scope="module")
def address(turned_run, tmp_path_factory):
    """Its page, in a folder."""
    return tweezer.view(turned_run).save(tmp_path_factory.mktemp("page") / "run.html").as_uri()


@pytest.fixture
def shown(browser, address):
    """The page on a wide screen, at rest at its start."""
    open_page(browser, address, 1280, 800)
    browser.execute_script("tweezer.seek(0)")
    yield browser
    assert browser.get_log("browser") == []


def open_page(browser, address, width, height, *, moves=True, dark=False):
    resize(browser, width, height)
    wanted = [
        {"name": "prefers-reduced-motion", "value": "no-preference" if moves else "reduce"},
        {"name": "prefers-color-scheme", "value": "dark" if dark else "light"},
    ]
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": wanted})
    browser.get(address)
    WebDriverWait(browser, 30).until(
        lambda driver: driver.execute_script("return !!window.tweezer?.duration")
    )


def press(browser, name):
    """Press the button of that name in the head of the page."""
    buttons = browser.find_elements("css selector", "header button")
    next(each for each in buttons if each.text == name).click()


def at(turning_run, moment):
    """Position at a time, on straight lines between samples, um."""
    position = 1e6 * turning_run["position"].values
    return np.array([np.interp(moment, turning_run["time"], x) for x in position.T])


def camera(browser):
    found = browser.execute_script("return tweezer.camera()")
    for name in MATRICES:
        found[name] = np.array(found[name]).reshape(4, 4).T
    return found


def on_screen(found, position):
    """Where a position, um, is in the window, pixels."""
    x, y, _, w = found["projection"] @ found["view"] @ np.append(position, 1.0)
    return np.array([
        found["left"] + (1 + x / w) / 2 * found["width"],
        found["top"] + (1 - y / w) / 2 * found["height"],
    ])  # fmt: skip


def picture(browser):
    """The window as it is, 0 to 1, (height, width, 3)."""
    taken = browser.execute_cdp_cmd("Page.captureScreenshot", {"format": "png"})
    return imread(io.BytesIO(base64.b64decode(taken["data"])))[:, :, :3]


def test_it_plays(browser, address):
    open_page(browser, address, 1280, 800)
    before = browser.execute_script("return [tweezer.time(), tweezer.frames()]")
    WebDriverWait(browser, 30).until(
        lambda driver: all(
            now > then for now, then in zip(
                driver.execute_script("return [tweezer.time(), tweezer.frames()]"), before,
                strict=True,
            )
        )
    )  # fmt: skip
    assert browser.execute_script("return document.querySelector('.play').textContent") == "Pause"
    assert browser.get_log("browser") == []


def test_numbers_go_with_the_marker_and_words_do_not(shown, turning_run):
    found, told, words = shown.execute_async_script(PLAYED)
    times = [each[0] for each in found]
    assert times[-1] > times[0]
    for time, number, _ in found:
        x = at(turning_run, time)[0]
        assert float(number.replace(MINUS, "-")) == pytest.approx(x, abs=1e-3 * abs(x) + 1e-4)
    assert len({each[2] for each in found}) == 1
    assert told == words


def test_it_stays_still_for_who_wants_that(browser, address):
    open_page(browser, address, 1280, 800, moves=False)
    assert browser.execute_script(
        "return [tweezer.time(), document.querySelector('.play').textContent]"
    ) == [0, "Play"]


def test_the_bead_is_where_the_run_has_it(shown, turning_run):
    rng = np.random.default_rng(24)
    found, last = camera(shown), float(turning_run["time"][-1])
    for moment in rng.uniform(0, last, 10):
        there = shown.execute_script(
            "tweezer.seek(arguments[0]); return tweezer.bead().pixel", moment
        )
        assert np.abs(on_screen(found, at(turning_run, moment)) - there).max() < 1


def test_the_bead_is_seen_there_in_its_size(shown, turning_run):
    """Pixels that change with the bead, against the rays of the camera that meet its sphere."""
    moment = 0.6 * float(turning_run["time"][-1])
    shown.execute_script(
        """
      tweezer.seek(arguments[0]);
      for (const part of ["light", "path", "arrows"]) tweezer.show(part, false);
      document.querySelector(".forces").hidden = true;""",
        moment,
    )
    with_it = picture(shown)
    shown.execute_script("tweezer.show('bead', false)")
    changed = np.abs(with_it - picture(shown)).max(axis=2) > 0.02
    found, radius = camera(shown), 1e6 * tweezer.scene_of(turning_run).bead.radius
    y, x = np.mgrid[: changed.shape[0], : changed.shape[1]] + 0.5
    screen = np.stack([
        2 * (x - found["left"]) / found["width"] - 1, 1 - 2 * (y - found["top"]) / found["height"]
    ])  # fmt: skip
    ways = np.stack([*(screen / found["projection"].diagonal()[:2, None, None]), -np.ones_like(x)])
    ways /= np.linalg.norm(ways, axis=0)
    centre = (found["view"] @ np.append(at(turning_run, moment), 1.0))[:3]
    along = np.tensordot(centre, ways, 1)
    met = centre @ centre - along**2 < radius**2
    assert met.sum() > 5000
    assert abs(changed.sum() / met.sum() - 1) < 0.02
    for each in (x, y):
        assert each[changed].mean() == pytest.approx(each[met].mean(), abs=1)


def test_the_bead_is_turned_as_the_run_has_it(shown, turned_run):
    """At a sample with an orientation far from that of the picture."""
    first = browser_turned(shown, 0.0)
    assert first == pytest.approx(rotation_matrix(turned_run["orientation"].values[0]), abs=1e-6)
    assert np.abs(first - np.eye(3)).max() > 0.5
    assert np.abs(first - first.T).max() > 0.5


def browser_turned(browser, moment):
    """Axes of the bead as columns."""
    turned = browser.execute_script(BEAD, moment)["turned"]
    return np.array(turned).reshape(4, 4).T[:3, :3]


def test_a_click_in_a_plot_and_keys_move_it(shown, turning_run):
    first, last = turning_run["time"].values[[0, -1]]
    box = shown.execute_script("""
      const area = document.querySelectorAll(".plot .area")[1].getBoundingClientRect();
      return [area.left, area.top, area.width, area.height];""")
    left, top, width, height = box
    # between the margins of the plot
    x = left + 58 + 0.25 * (width - 58 - 12)
    chain = ActionChains(shown)
    chain.w3c_actions.pointer_action.move_to_location(int(x), int(top + height / 2)).click()
    chain.perform()
    clicked = shown.execute_script("return tweezer.time()")
    assert clicked == pytest.approx(0.25 * last, abs=0.01 * last)
    ActionChains(shown).send_keys("\ue010").perform()  # End
    assert shown.execute_script("return tweezer.time()") == pytest.approx(last, rel=1e-6)
    ActionChains(shown).send_keys("\ue012").perform()  # left
    before = float(turning_run["time"][-2])
    assert shown.execute_script("return tweezer.time()") == pytest.approx(before, rel=1e-6)
    seen = camera(shown)["view"]
    ActionChains(shown).send_keys("a").perform()  # turns the view
    assert np.abs(camera(shown)["view"] - seen).max() > 0.01
    ActionChains(shown).send_keys("\ue011 ").perform()  # Home, and space plays
    WebDriverWait(shown, 30).until(
        lambda driver: driver.execute_script("return tweezer.time()") > first
    )


def test_planes_are_seen_in_parallel_projection(shown):
    """Points one behind the other are one, and lengths on the screen do not depend on depth."""
    for view, depth, axes in ((2, 1, (0, 2)), (3, 0, (1, 2)), (4, 2, (0, 1))):
        shown.execute_script("tweezer.look(arguments[0])", view)
        found = camera(shown)
        near, far = np.zeros(3), np.zeros(3)
        near[depth], far[depth] = 0.4, -0.7
        assert on_screen(found, near) == pytest.approx(on_screen(found, far), abs=0.5)
        sizes = []
        for at_depth in (near, far):
            for axis in axes:
                aside = at_depth.copy()
                aside[axis] += 0.3
                sizes.append(np.linalg.norm(on_screen(found, aside) - on_screen(found, at_depth)))
        assert np.ptp(sizes) < 1e-3 * sizes[0]
        bar = shown.find_element("css selector", ".bar").size["width"]
        length, unit = shown.find_element("css selector", ".length").text.split()
        micrometres = float(length) * {"nm": 1e-3, "µm": 1.0}[unit]
        assert bar == pytest.approx(micrometres * sizes[0] / 0.3, rel=0.02)
    shown.execute_script("tweezer.look(1)")
    assert camera(shown)["projection"][3, 3] == 0  # perspective again


def test_parts_of_the_picture_are_hidden_until_reset(shown):
    stage = (slice(160, 640), slice(350, 760))  # without the buttons, which show the focus
    before = picture(shown)[stage]
    box = next(
        each
        for each in shown.find_elements("css selector", ".layers label")
        if each.text.strip() == "bead"
    )
    box.click()
    shown.execute_script("tweezer.draw()")
    without = picture(shown)[stage]
    assert np.abs(without - before).max() > 0.2
    press(shown, "Reset")
    shown.execute_script("tweezer.draw()")
    assert box.find_element("css selector", "input").is_selected()
    assert np.abs(picture(shown)[stage] - before).max() < 0.02


def test_a_link_opens_the_page_as_it_was(shown, address, turning_run):
    moment = float(turning_run["time"][-1]) / 3
    shown.execute_script("tweezer.seek(arguments[0]); tweezer.look(3)", moment)
    ActionChains(shown).send_keys("a").perform()  # turns the view
    kept, seen = shown.execute_script("return tweezer.link()"), camera(shown)
    shown.get("about:blank")
    open_page(shown, kept, 1280, 800)
    assert shown.execute_script("return tweezer.time()") == pytest.approx(moment, rel=1e-12)
    again = camera(shown)
    for name in MATRICES:
        np.testing.assert_allclose(again[name], seen[name], atol=1e-4)


def test_the_samples_are_saved_as_a_table(shown, turning_run, tmp_path):
    shown.execute_cdp_cmd(
        "Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(tmp_path)}
    )
    for name, ending in (("Data", "csv"), ("Picture", "png")):
        press(shown, name)
        WebDriverWait(shown, 30).until(lambda _, e=ending: list(tmp_path.glob(f"*.{e}")))
    (table,) = tmp_path.glob("*.csv")
    heading = table.read_text().split("\n")[0].split(",")
    assert heading[:4] == ["time (s)", "position x (m)", "position y (m)", "position z (m)"]
    rows = np.loadtxt(table, delimiter=",", skiprows=1)
    np.testing.assert_allclose(rows[:, 0], turning_run["time"], rtol=1e-6)
    np.testing.assert_allclose(rows[:, 1:4], turning_run["position"], rtol=1e-6, atol=1e-12)
    force = rows[:, heading.index("force_light x (N)")]
    np.testing.assert_allclose(force, turning_run["optical_force"][:, 0], rtol=1e-6, atol=1e-18)
    (saved,) = tmp_path.glob("*.png")
    assert np.ptp(imread(saved)[:, :, :3]) > 0.5


def test_values_under_the_mouse(shown, turning_run):
    """Position along z in the middle of the first plot, as the samples have it."""
    box = shown.execute_script("""
      const area = document.querySelector(".plot .area").getBoundingClientRect();
      return [area.left, area.top, area.width, area.height];""")
    left, top, width, height = box
    x = int(left + 58 + 0.5 * (width - 58 - 12))
    chain = ActionChains(shown)
    chain.w3c_actions.pointer_action.move_to_location(x, int(top + height / 2))
    chain.perform()
    tip = shown.find_element("css selector", ".tip")
    first, last = turning_run["time"].values[[0, -1]]
    moment = first + (x - left - 58) / (width - 58 - 12) * (last - first)
    value = tip.text.split(" z ")[1].replace(MINUS, "-")
    assert float(value) == pytest.approx(at(turning_run, moment)[2], abs=2e-3)


def test_words_for_who_does_not_see_it(shown, turning_run):
    said = shown.execute_script("""
      return {
        title: document.querySelector("h1").textContent,
        sub: document.querySelector(".sub").textContent,
        rows: [...document.querySelectorAll("#summary ~ * tbody tr")].map(
          (row) => [...row.children].slice(0, 2).map((cell) => cell.textContent)),
        pictures: [...document.querySelectorAll("canvas")].map(
          (canvas) => [canvas.getAttribute("role"), canvas.getAttribute("aria-label").length]),
        time: document.querySelector("input[type=range]").getAttribute("aria-valuetext"),
        unnamed: [...document.querySelectorAll("button, select, input")].filter(
          (control) => !control.textContent && !control.labels?.length
            && !control.getAttribute("aria-label")).length,
      };""")
    content = tweezer.view(turning_run).content
    assert said["title"] == content.title
    assert said["sub"].startswith("a run: ")
    shown_rows = [[row.name, re.sub(r"\bum\b", "µm", row.value)] for row in content.summary]
    assert said["rows"] == shown_rows
    assert len(said["pictures"]) == 4
    assert all(role == "img" and words > 20 for role, words in said["pictures"])
    assert said["time"].startswith("0.")
    assert said["time"].endswith("s")
    assert said["unnamed"] == 0


def test_speeds_below_the_axis_are_not_drawn(shown, turning_run):
    """The bead starts at rest: its dot is not there, and the plot says from where on it draws."""
    speed = turning_run["speed"].values
    assert speed[0] < 1e-6 * speed.max()
    dots = "return [...document.querySelectorAll('.plot')[1].querySelectorAll('.dot')].map("
    dots += "(dot) => dot.hidden)"
    assert shown.execute_script(dots) == [True, False]
    words = shown.find_element("css selector", ".below").text
    least, unit = re.fullmatch(r"not drawn below ([\d.]+) (\S+)", words).groups()
    least = float(least) * {"mm/s": 1e-3, "µm/s": 1e-6, "nm/s": 1e-9}[unit]
    slowest = max(speed[1:].min(), 1e-5 * speed.max())
    assert least == pytest.approx(slowest / 1.5, rel=0.05)
    shown.execute_script("tweezer.seek(arguments[0])", float(turning_run["time"][-1]))
    assert shown.execute_script(dots) == [False, False]


def test_a_frame_of_a_film_is_the_page(browser, address, turned_run, monkeypatch):
    """Its last one beside the page at the end."""
    monkeypatch.chdir(url2pathname(urlsplit(address).path.rpartition("/")[0]))
    taken = movie.frames(browser, Path("run.html"), 2)
    first, last = (imread(io.BytesIO(each))[:, :, :3] for each in taken)
    browser.execute_script("tweezer.seek(0)")
    browser.execute_script("tweezer.seek(arguments[0])", float(turned_run["time"][-1]))
    assert last.shape == (800, 1280, 3)
    assert np.abs(last - picture(browser)).max() < 0.02
    assert np.abs(last - first).max() > 0.2


def test_on_a_phone_and_in_the_dark(browser, address):
    """Dark as the system is, until the button says otherwise."""
    open_page(browser, address, 400, 800, dark=True)
    browser.execute_script("tweezer.seek(0)")
    assert browser.execute_script("return document.documentElement.scrollWidth") == 400
    # the whole table of the summary, with its judgements, is within the screen
    ends = "return [...document.querySelectorAll('.found :is(th, td)')].map("
    ends += "(cell) => cell.getBoundingClientRect().right)"
    assert max(browser.execute_script(ends)) < 400
    assert picture(browser).mean() < 0.4
    press(browser, "Light")
    WebDriverWait(browser, 30).until(lambda driver: picture(driver).mean() > 0.6)
    assert browser.get_log("browser") == []


def test_without_webgl_there_is_a_plain_picture(browser, address, turning_run):
    added = browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": WITHOUT})
    try:
        open_page(browser, address, 1280, 800)
        assert "WebGL is off" in browser.execute_script("return document.body.textContent")
        browser.execute_script("tweezer.look(2); tweezer.seek(0)")
        first = np.array(browser.execute_script("return tweezer.bead().pixel"))
        last = float(turning_run["time"][-1])
        moved = np.array(browser.execute_script(BEAD, last)["pixel"])
        way = (at(turning_run, last) - at(turning_run, 0))[[0, 2]] * (1, -1)
        assert (moved - first) / np.linalg.norm(moved - first) == pytest.approx(
            way / np.linalg.norm(way), abs=1e-6
        )
        assert browser.get_log("browser") == []
    finally:
        browser.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", added)
