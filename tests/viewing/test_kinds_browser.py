"""Pages of an ensemble, a trap and a sweep in a browser."""

import base64
import io
import re

import numpy as np
import pytest
from matplotlib.image import imread
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.select import Select
from selenium.webdriver.support.wait import WebDriverWait

import tweezer

#: Equilibria of a sweep of one key, of which one is far off, m
FAR_OFF = [[1e-7, 1.2e-7, 3e-4, 0.9e-7]]
#: Before numbers on a page
MINUS = "\N{MINUS SIGN}"


@pytest.fixture(scope="module")
def pages(cloud, gathered, trap, diagram, tmp_path_factory):
    folder = tmp_path_factory.mktemp("pages")
    tweezer.save(trap, folder / "trap.json")
    curve = diagram.isel({"bead.diameter": [1]}).copy(deep=True)
    curve["equilibrium"].loc[{"axis": "z"}] = FAR_OFF
    given = {"cloud": cloud, "gathered": gathered, "trap": folder / "trap.json",
             "diagram": diagram, "curve": curve}  # fmt: skip
    return {
        name: tweezer.view(each).save(folder / f"{name}.html").as_uri()
        for name, each in given.items()
    }


@pytest.fixture
def show(browser, pages):
    """Open a page, which says nothing in the console while it is open."""

    def opened(name, width=1280, height=800):
        screen = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", screen)
        calm = [{"name": "prefers-reduced-motion", "value": "reduce"}]
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": calm})
        browser.get(pages[name])
        ready = {"trap": "place", "diagram": "picked", "curve": "picked"}.get(name, "duration")
        WebDriverWait(browser, 30).until(
            lambda driver: driver.execute_script(f"return !!window.tweezer?.{ready}")
        )
        return browser

    yield opened
    assert browser.get_log("browser") == []


def picture(browser):
    taken = browser.execute_cdp_cmd("Page.captureScreenshot", {"format": "png"})
    return imread(io.BytesIO(base64.b64decode(taken["data"])))[:, :, :3]


def taken(browser, key):
    """Whether the page takes a key from the browser, which scrolls by it, where none has focus."""
    return browser.execute_script(
        """
      const how = {key: arguments[0], bubbles: true, cancelable: true};
      const event = new KeyboardEvent("keydown", how);
      document.body.dispatchEvent(event);
      return event.defaultPrevented;""",
        key,
    )


def click(browser, spot):
    chain = ActionChains(browser)
    chain.w3c_actions.pointer_action.move_to_location(*(round(x) for x in spot))
    chain.w3c_actions.pointer_action.click()
    chain.perform()


def projected(browser, position):
    """Where positions (n, 3) um are in the window, pixels (n, 2), by the camera alone."""
    camera = browser.execute_script("return tweezer.camera()")
    projection, view = (np.array(camera[name]).reshape(4, 4).T for name in ("projection", "view"))
    x, y, _, w = projection @ view @ np.column_stack([position, np.ones(len(position))]).T
    return np.column_stack([
        camera["left"] + (1 + x / w) / 2 * camera["width"],
        camera["top"] + (1 - y / w) / 2 * camera["height"],
    ])  # fmt: skip


def test_beads_are_seen_where_the_ensemble_has_them(show, cloud):
    """Ten beads drawn at random: the middle of the pixels that change with the cloud."""
    browser, sample = show("cloud"), 7
    time = float(cloud["time"][sample])
    browser.execute_script("tweezer.seek(arguments[0]); tweezer.show('bead', false)", time)
    with_it = picture(browser)
    browser.execute_script("tweezer.show('cloud', false)")
    changed = np.abs(with_it - picture(browser)).max(axis=2) > 0.05
    position = 1e6 * cloud["position"].values[:, sample]
    there = position[~np.isnan(position[:, 0])]
    assert len(there) == 14
    drawn = np.random.default_rng(24).permutation(there)[:10]
    row, column = np.nonzero(changed)
    for spot in projected(browser, drawn):
        near = np.hypot(column + 0.5 - spot[0], row + 0.5 - spot[1]) < 4
        middle = np.array([column[near].mean() + 0.5, row[near].mean() + 0.5])
        assert np.abs(middle - spot).max() < 1
    words = browser.find_element("css selector", ".counts").text
    assert words.startswith("14 of 15 beads are left, 1 lost")
    outside = browser.find_element("css selector", ".outside").text.replace(MINUS, "-")
    assert outside == "Outside the picture: the wall at z = -20.0 µm, below"
    # the density in the plane x-z: cells as wide as the cloud, over its number and their area
    x, z = there[:, 0], there[:, 2]
    room = 3.5 * max(np.std(x, ddof=1), np.std(z, ddof=1))
    ends = [[each.mean() - room, each.mean() + room] for each in (x, z)]
    counted, _, _ = np.histogram2d(x, z, 8, ends)  # the fewest, for so few beads
    most = counted.max() / len(there) / (2 * room / 8) ** 2
    told = browser.find_element("css selector", ".density canvas").get_attribute("aria-label")
    assert f"at most {most:.2f} /µm², over {2 * room:.1f} µm" in told
    assert browser.find_element("css selector", ".ramp-numbers").text.endswith(f"{most:.2f} /µm²")


def test_a_lost_bead_is_a_ring_where_it_was_last(show, cloud):
    browser = show("cloud")
    browser.execute_script("tweezer.seek(arguments[0])", float(cloud["time"][-1]))
    rings = np.array(browser.execute_script("return tweezer.rings()")).reshape(-1, 3)
    position = 1e6 * cloud["position"].values
    assert rings[:2] == pytest.approx(position[[3, 8], [4, 8]], abs=1e-4)
    assert (rings[2:] == 0).all()
    box = browser.find_element("css selector", ".counts + label input")
    before = box.is_selected()
    box.click()
    assert box.is_selected() != before


def test_a_page_of_statistics_shows_mean_and_spread(show, gathered):
    browser = show("gathered", 400, 800)
    browser.execute_script("tweezer.seek(arguments[0])", float(gathered["time"][20]))
    shown = browser.find_element("css selector", ".plot .entry .number").text
    assert float(shown.replace(MINUS, "-")) == pytest.approx(
        1e6 * float(gathered["position_mean"][20, 0]), abs=2e-3
    )
    assert browser.execute_script("return document.documentElement.scrollWidth") <= 400


def test_the_page_of_a_trap_has_its_force(show, trap):
    """Anywhere in the box, against the evaluator, within what the page says itself."""
    browser, scene = show("trap"), trap.scene
    sub = browser.find_element("css selector", ".sub").text
    assert f"saved in trap.json, computed by tweezer {tweezer.__version__}" in sub
    box = browser.execute_script("return tweezer.content.facts.box")
    rng, across = np.random.default_rng(24), box["across"]
    low, high = [-across, -across, box["low"]], [across, across, box["high"]]
    places = np.vstack([rng.uniform(low, high, (20, 3)), rng.normal(0, 2e-7, (20, 3))])
    shown, off = (
        np.array(
            browser.execute_script(f"return arguments[0].map(tweezer.{name})", places.tolist())
        )
        for name in ("force", "off")
    )
    force = tweezer.optical_force(scene, places) + np.array(tweezer.bead_properties(scene).weight)
    assert (np.linalg.norm(shown - force, axis=1) <= 2 * off + 1e-20).all()
    assert off.max() < 1e-3 * np.linalg.norm(force, axis=1).max()
    found = browser.execute_script("return tweezer.work([3e-7, 1e-7, -2e-7])")
    centre = np.array(trap.equilibrium.position)
    way = centre + np.linspace(0, 1, 2001)[:, None] * ([3e-7, 1e-7, -2e-7] - centre)
    along = tweezer.optical_force(scene, way) + np.array(tweezer.bead_properties(scene).weight)
    work = -np.trapezoid(along @ ([3e-7, 1e-7, -2e-7] - centre), dx=1 / 2000)
    assert found == pytest.approx(work, rel=1e-4, abs=0)


def test_moving_the_slice_changes_the_numbers(show, trap):
    browser, weight = show("trap"), np.array(tweezer.bead_properties(trap.scene).weight)

    def told(name):
        words = browser.find_element("css selector", f"[data-name={name}]").text.replace(MINUS, "-")
        return np.array([float(x) for x in re.findall(r"-?[\d.]+", words)])

    wanted = [2e-7, trap.equilibrium.position[1], -1e-7]
    click(browser, browser.execute_script("return tweezer.spot(arguments[0])", wanted))
    first = browser.execute_script("return tweezer.place()")
    assert first == pytest.approx(wanted, abs=1e-8)  # about a pixel
    assert not any(taken(browser, name) for name in ("PageDown", "ArrowDown", "Home"))
    assert browser.execute_script("return tweezer.place()") == first
    canvas = browser.find_element("css selector", ".slice canvas")
    canvas.send_keys(Keys.SHIFT, Keys.PAGE_UP)
    canvas.send_keys(Keys.SHIFT, Keys.ARROW_LEFT)
    second = browser.execute_script("return tweezer.place()")
    across = browser.execute_script("return tweezer.content.facts.box.across")
    step = 0.2 * across
    assert second == pytest.approx([first[0] - step, first[1] + step, first[2]], abs=1e-12)
    assert 1e-6 * told("place") == pytest.approx(second, abs=1e-10)
    force = tweezer.optical_force(trap.scene, second) + weight
    assert told("force") == pytest.approx(1e12 * force, abs=6e-4)
    before = tweezer.optical_force(trap.scene, first) + weight
    assert np.abs(1e12 * before - told("force")).max() > 0.1


def test_a_click_opens_the_case(show, diagram):
    browser = show("diagram")
    given = diagram.sortby("bead.diameter")
    # bead diameter goes up, and the power across
    click(browser, browser.execute_script("return tweezer.cell(2, 1)"))
    case = given.isel({"bead.diameter": 1, "beam.power_through_pupil": 2})

    def cells(name):
        row = browser.find_element("css selector", f'[data-name="{name}"]')
        return [cell.text for cell in row.find_elements("css selector", "td")]

    for name, at, factor in (("stiffness", "z", 1e6), ("escape_force", "-z", 1e12)):
        along = "axis" if name == "stiffness" else "direction"
        value, error, _ = cells(f"{name} {at}")
        expected = factor * float(case[name].sel({along: at}))
        uncertainty = factor * float(case[f"{name}_error"].sel({along: at}))
        plain = error.strip("± ").replace("·10", "e").translate(
            str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
        )  # fmt: skip
        assert float(plain) == pytest.approx(uncertainty, rel=0.06)
        assert float(value) == pytest.approx(expected, rel=5e-4, abs=0.06 * uncertainty)
    assert browser.find_element("css selector", ".case .outcome").text == "held"
    assert not taken(browser, "ArrowDown")
    browser.find_element("css selector", ".chart canvas").send_keys(
        Keys.ARROW_RIGHT, Keys.ARROW_DOWN
    )
    assert browser.execute_script("return tweezer.picked()") == [0, 3]
    assert "longer than" in cells("lifetime")[0]


def test_cells_without_a_number_are_named(show):
    browser = show("diagram", 400, 800)
    words = browser.find_element("css selector", ".kinds").text
    for word in ("not held", "failed", "not computed"):
        assert f"no number: {word}" in words
    click(browser, browser.execute_script("return tweezer.cell(2, 2)"))
    assert "bead.diameter: of no use" in browser.find_element("css selector", ".case").text
    browser.execute_script("document.querySelector('.table details').open = true")
    WebDriverWait(browser, 10).until(
        lambda driver: len(driver.find_elements("css selector", ".table td")) == 12
    )
    # the least of the directions that are known
    assert "2.000" in [cell.text for cell in browser.find_elements("css selector", ".table td")]
    assert browser.execute_script("return document.documentElement.scrollWidth") <= 400


def test_one_key_gives_a_curve(show, diagram):
    browser = show("curve")
    click(browser, browser.execute_script("return tweezer.cell(0)"))
    row = browser.find_element("css selector", '[data-name="stiffness x"] td')
    expected = 1e6 * float(diagram["stiffness"][1, 0].sel(axis="x"))
    assert float(row.text) == pytest.approx(expected, rel=0.01)
    # a case far off does not hide how the others differ: it is beyond the axis, and it is said
    words = "equilibrium relative to the focus, z"
    Select(browser.find_element("css selector", ".tools select")).select_by_visible_text(words)
    low, high = browser.execute_script("return tweezer.axis()")
    assert low < 0.09 < 0.12 < high < 0.13
    assert "1 of 4 cases" in browser.find_element("css selector", ".kinds").text
    choices = Select(browser.find_element("css selector", ".tools select"))
    for choice in [option.text for option in choices.options]:
        choices.select_by_visible_text(choice)
    choices.select_by_visible_text("outcome")
    assert browser.execute_script("return tweezer.axis()") == [-0.5, 0.5]  # all are held
    assert browser.get_log("browser") == []
