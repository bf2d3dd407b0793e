"""What is in a page: the numbers of its result, and nothing from elsewhere."""

import base64
import hashlib
import html
import json
import math
import re
import shutil
import subprocess
from html.parser import HTMLParser
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from matplotlib.image import imread, imsave

import tweezer
from tests import vendored
from tweezer import viewing
from tweezer.viewing import movie, of_trap, setting
from tweezer.viewing.arrays import float32, uint16
from tweezer.viewing.rows import of_number

VENDOR = Path(viewing.__file__).parent / "static" / "vendor"
KT = 1.380649e-23 * 293.15

finite = arrays(np.float64, st.integers(1, 40), elements=st.floats(-1e30, 1e30))


@pytest.fixture(scope="module")
def page(turning_run):
    return tweezer.view(turning_run)


def shown(page, name):
    return page.content.arrays[name].values()


@given(finite)
def test_four_bytes_are_off_by_what_they_say(values):
    packed = float32(values / 3, "m")
    off = np.abs(packed.values() - values / 3)
    assert off.max() == packed.rounding
    assert (off <= 2**-24 * np.abs(values / 3) + 2.0**-150).all()


@given(finite)
def test_two_bytes_are_off_by_what_they_say(values):
    packed = uint16(values, "m")
    off = np.abs(packed.values() - values).max()
    assert off == packed.rounding
    half = (values.max() - values.min()) / 131068
    assert off <= half * (1 + 1e-6) + 1e-14 * np.abs(values).max() + 1e-300  # of its own rounding


def test_what_is_missing_stays_missing_and_what_is_too_large_is_refused():
    for pack in (float32, uint16):
        values = pack([1.0, np.nan, np.inf, -2.0], "m").values()
        assert np.isnan(values[1:3]).all()
        assert values[[0, 3]] == pytest.approx([1.0, -2.0])
    with pytest.raises(ValueError, match="too large"):
        float32([1e39], "m")


def test_numbers_of_the_page_are_those_of_the_run(page, turning_run):
    for name in ("time", "position", "orientation", "speed", "terminal_speed", "distance"):
        values = turning_run[name].values
        assert np.abs(shown(page, name) - values).max() <= 6e-8 * np.abs(values).max()
        assert page.content.arrays[name].unit == turning_run[name].attrs["units"]


def test_forces_are_those_of_the_equation_of_motion(page, turning_run):
    """Mass over a2 (none here) times acceleration, by differences of the velocity, is their sum."""
    scene = tweezer.scene_of(turning_run)
    bead = tweezer.bead_properties(scene)
    drag = -bead.drag * turning_run["velocity"].values
    assert shown(page, "force_drag") == pytest.approx(drag, rel=1e-6, abs=1e-18)
    light, weight = shown(page, "force_light"), shown(page, "force_weight")
    assert light == pytest.approx(turning_run["optical_force"].values, rel=1e-6)
    assert weight[3] == pytest.approx(bead.weight, rel=1e-6)
    assert shown(page, "force_sum") == pytest.approx(light + weight + drag, abs=1e-17)
    assert "force_wall" not in page.content.arrays


def test_without_inertia_the_sum_of_forces_is_zero(turning_run):
    """The force would be that of the run: a model without inertia has its velocity from it."""
    content = tweezer.view(turning_run.assign_attrs(model="overdamped")).content
    net = turning_run["net_force"].values
    assert (content.arrays["force_sum"].values() == 0).all()
    assert content.arrays["force_drag"].values() == pytest.approx(-net, rel=1e-6)
    assert any("no inertia" in note and "sum is zero" in note for note in content.notes)


def test_a_part_of_a_run_is_told_by_its_samples(turning_run):
    later = {"name": "closest approach", "position": [0.0, 0.0, 0.0], "time": 1.0}
    known = turning_run.assign_attrs(events=json.dumps([later]))
    part = tweezer.view(known.isel(time=slice(0, 4))).content
    assert not any("closest approach" in row.name for row in part.summary)
    rows = {row.name: row for row in part.summary}
    for name in ("at the time", "overshoot past the axis"):
        assert (rows[name].error, rows[name].trusted) == ("not known", False)
    assert not rows["outcome"].trusted
    assert any("samples only" in note for note in part.notes)
    whole = tweezer.view(turning_run).content
    assert not any("samples only" in note for note in whole.notes)


@pytest.mark.parametrize(
    ("given", "told"),
    [((math.nan, 1e-9, "m"), ("not known", "", False)),
     ((math.inf, None, "m"), ("not known", "", False)),
     ((3e-6, None, "m"), ("3 µm", "", True)),
     ((3e-6, 0.0, "m"), ("3 µm", "", True)),
     ((3e-6, math.nan, "m"), ("3 µm", "not known", True)),
     ((3e-6, math.inf, "m"), ("3 µm", "not known", True)),
     ((3e-6, 2.34e-8, "m"), ("3.000 µm", "± 0.023 µm", True)),
     ((0.0, 4.44e-11, "m"), ("0 pm", "± 44 pm", True)),
     ((2.5, 0.25), ("2.50", "± 0.25", True))],
)  # fmt: skip
def test_a_number_is_told_with_its_error(given, told):
    assert of_number("a number", *given) == ("a number", *told)
    value, error, trusted = told
    if given[0] == 3e-6:  # the unit of tables is the same
        assert of_number("", *given, in_tables=True) == ("", value, error, trusted)


def test_what_the_water_is_given_is_what_drag_takes(page, turning_run):
    """Power of the drag over time, beside forces over the way."""
    scene = tweezer.scene_of(turning_run)
    speed, time = turning_run["speed"].values, turning_run["time"].values
    power = tweezer.bead_properties(scene).drag * speed**2
    later = slice(2, None)  # the start is faster than the samples
    given = np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(time)) / KT
    lost = shown(page, "energy_lost")[1:]
    assert (lost - lost[0])[later] == pytest.approx((given - given[0])[later], rel=0.01)
    work = shown(page, "energy_work")
    assert work[0] == 0
    assert (np.diff(work) > 0).all()
    assert shown(page, "energy_kinetic") == pytest.approx(
        turning_run["kinetic_energy"].values / KT, rel=1e-6
    )


def test_samples_far_apart_are_points_and_have_no_work(turning_run):
    """A tenth of a second from one to the next: the trap relaxes in less."""
    run = turning_run.isel(time=[0, 20])
    run = run.assign_coords(time=run["time"] * 1e4)
    content = tweezer.view(run).content
    assert not content.facts["resolved"]
    assert "energy_work" not in content.arrays
    assert any("drawn as points" in note for note in content.notes)


@pytest.mark.parametrize(("status", "said"), [("failed", "failed"), ("interrupted", "stopped")])
def test_a_run_that_ended_early_says_so(turning_run, status, said):
    run = turning_run.assign_attrs(status=status, message="at 3 s: nothing went")
    assert said in tweezer.view(run).content.warning
    assert "at 3 s: nothing went" in tweezer.view(run).content.warning


class Parts(HTMLParser):
    """Scripts of a page, and what it loads or leads to."""

    def __init__(self, page):
        super().__init__()
        self.scripts, self.addresses, self.inside = [], [], False
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.inside = tag == "script"
        if self.inside:
            self.scripts.append("")
        self.addresses += [value for name, value in attrs if name in ("src", "href")]

    def handle_endtag(self, tag):
        self.inside = False

    def handle_data(self, data):
        if self.inside:
            self.scripts[-1] += data


def test_a_page_is_whole_and_loads_nothing(page, turning_run):
    parts = Parts(page.html)
    imports, content, program = parts.scripts
    assert parts.addresses == ["data:,"]
    assert (VENDOR / "LICENSE").read_text().strip() in page.html
    assert all(address.startswith("data:") for address in json.loads(imports)["imports"].values())
    assert json.loads(content)["title"] == page.content.title
    assert "http" not in re.sub(r"base64,[A-Za-z0-9+/=]*", "", page.html)
    names = set(re.findall(r'from "([^"]+)"', program))
    for path in (VENDOR.parent).glob("*.js"):
        names |= set(re.findall(r'from "([^"]+)"', path.read_text()))
    assert names <= set(json.loads(imports)["imports"]) | {"tweezer/kind"}


def test_a_title_ends_no_script(turning_run):
    title = '</script><script>alert("&lt;")</script><!-- \u2028'
    page = tweezer.view(turning_run.assign_attrs(title=title))
    _, content, _ = Parts(page.html).scripts
    assert json.loads(content)["title"] == title


def test_size_of_2001_samples(turning_run):
    times = np.linspace(0, turning_run["time"].values[-1], 2001)
    page = tweezer.view(turning_run.interp(time=times))
    assert len(page.html.encode()) < 3e6


def test_in_a_notebook_it_is_a_frame(page):
    frame = page._repr_html_()
    assert html.escape(page.html) in frame
    assert frame.startswith("<iframe srcdoc=")


def test_three_is_what_its_note_says():
    note = (VENDOR / "README.md").read_text()
    digest = hashlib.sha256((VENDOR / "three.module.min.js").read_bytes()).hexdigest()
    assert f"| SHA-256 | {digest} |" in note
    assert (VENDOR / "LICENSE").read_text().startswith("The MIT License")
    scripts = "".join(path.read_text() for path in VENDOR.parent.glob("*.js"))
    names = re.findall(r"\b[A-Z]\w+", vendored.ENTRY)
    assert [name for name in names if not re.search(rf"\b{name}\b", scripts)] == []


def test_a_browser_has_its_sandbox_but_for_root(monkeypatch):
    for user in (0, 1000):
        monkeypatch.setattr("os.geteuid", lambda user=user: user)
        assert ("--no-sandbox" in movie.options_of_browser()) == (user == 0)


def test_the_command_writes_a_page(turning_run, command_line, tmp_path, monkeypatch):
    tweezer.save_run(turning_run, tmp_path / "run.nc")
    outcome = command_line("view", "run.nc", "--out", "page.html")
    assert (outcome.code, outcome.out, outcome.err) == (0, "wrote page.html\n", "")
    assert (tmp_path / "page.html").read_text() == tweezer.view(turning_run).html
    assert command_line("view", "run.nc", "--out", "page.html").code == 0
    (tmp_path / "own.html").write_text("<h1>not of tweezer</h1>")
    outcome = command_line("view", "run.nc", "--out", "own.html")
    said = (
        "own.html: already exists and is not a page of tweezer; choose another --out or pass "
        "--overwrite\n"
    )
    assert (outcome.code, outcome.err) == (2, said)
    assert (tmp_path / "own.html").read_text() == "<h1>not of tweezer</h1>"
    assert command_line("view", "run.nc", "--out", "own.html", "--overwrite").code == 0
    assert (tmp_path / "own.html").read_text() == (tmp_path / "page.html").read_text()
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    outcome = command_line("view", "run.nc")
    (address,) = opened
    path = Path(outcome.out.removeprefix("the page is ").strip())
    assert path.as_uri() == address
    assert path.read_text() == (tmp_path / "page.html").read_text()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [(["silica"], "no scene file 'silica'"),
     (["there.nc"], "there.nc: no such file"),
     (["there.zarr"], "there.zarr: no such folder"),
     (["there.nc", "--set", "beam.power=1 W"], "--set: requires a scene, but there.nc is a result"),
     (["there.nc", "--trap"], "--trap: requires a scene"),
     (["silica-1um", "--out", "a.txt"], "a.txt: must end in .html"),
     (["silica-1um", "--movie", "a.avi"], "a.avi: must end in .mp4, .gif"),
     (["silica-1um", "--movie", "a.gif", "--seconds", "0"], "--seconds 0: must be above 0"),
     (["silica-1um", "--out", "a.html", "--seconds", "5"], "--seconds: requires --movie")],
)  # fmt: skip
def test_bad_input_is_one_line(command_line, arguments, said):
    outcome = command_line("view", *arguments)
    assert outcome.code == 2
    assert outcome.err.startswith(said)
    assert outcome.err.count("\n") == 1


def test_a_film_names_the_programs_that_are_missing(command_line, monkeypatch):
    monkeypatch.setattr("shutil.which", lambda name: None)
    outcome = command_line("view", "silica-1um", "--movie", "a.mp4")
    assert outcome.code == 2
    needed = (
        "a film requires Chromium and chromedriver and ffmpeg, not found on PATH; install them\n"
    )
    assert outcome.err == needed


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="no ffmpeg on this machine")
@pytest.mark.parametrize("ending", ["mp4", "gif"])
def test_a_film_has_the_pictures_in_their_order(page, ending, tmp_path, monkeypatch):
    """Of a browser that gives a dark picture and then light ones."""
    png = []
    for shade in np.linspace(0, 1, 5):
        png.append(BytesIO())
        imsave(png[-1], np.full((20, 40, 3), shade), format="png")
    monkeypatch.setattr(movie, "programs", lambda: {"ffmpeg": shutil.which("ffmpeg")})
    monkeypatch.setattr(movie, "_pictures", lambda *_: (each.getvalue() for each in png))
    path = movie.film(page, tmp_path / f"film.{ending}", 1.0)
    assert list(tmp_path.iterdir()) == [path]
    raw = subprocess.run(
        ["ffmpeg", "-loglevel", "error", "-i", path, "-f", "rawvideo", "-pix_fmt", "gray", "-"],
        capture_output=True, check=True,
    )  # fmt: skip
    shades = np.frombuffer(raw.stdout, np.uint8).reshape(-1, 20, 40).mean(axis=(1, 2))
    assert shades == pytest.approx(255 * np.linspace(0, 1, 5), abs=6)


def test_what_no_page_shows_is_refused():
    with pytest.raises(
        tweezer.ResultError,
        match="int: is not a known kind of result; `tweezer view` accepts a sweep, ",
    ):
        tweezer.view(3)


def test_force_of_the_inertia_of_the_fluid_is_that_of_half_its_mass(turning_run):
    """With added mass alone it is -m_fluid/2 times the acceleration."""
    scene = tweezer.scene_of(turning_run).replace(
        medium={"inertia": "added-mass"}, forces={"brownian": False},
        simulation={"duration": "2 us", "samples": 401, "method": "auto"},
    )  # fmt: skip
    content = tweezer.view(tweezer.simulate(scene)).content
    fluid, change = (content.arrays[f"force_{name}"].values() for name in ("fluid", "sum"))
    half = 0.5 * scene.medium.density / scene.bead.density
    middle = slice(40, 200)
    largest = np.abs(change[middle]).max()
    assert fluid[middle] == pytest.approx(-half * change[middle], abs=2e-3 * half * largest)
    assert any("added mass" in note for note in content.notes)


def test_page_of_a_hologram_has_a_table_over_the_box():
    """The force of the page's table is within 2 % of the largest of the force of the light."""
    trap = tweezer.characterise("three-foci")
    made = of_trap.content(trap)
    assert len(made.facts["beams"]) == 3
    assert made.facts["beams"][0]["focus"][:2] == [2e-6, 0.0]
    table = made.facts["tables"][0]
    assert len(table["low"]) == 3
    (note,) = (each for each in made.notes if "random positions" in each)
    assert made.arrays["errors_0"].values().max() < 0.02 * made.facts["largest"], note


def test_page_shows_the_pupil_of_uneven_light():
    """Astigmatism: the picture is the same after half a turn, and its phase is opposite at 90°."""
    facts = setting.scene_facts(tweezer.load_scene("astigmatic-trap"))
    (shown,) = facts["pupils"]
    picture = imread(BytesIO(base64.b64decode(shown["image"].partition(",")[2])))
    assert picture.shape == (128, 128, 4)
    np.testing.assert_allclose(picture, picture[::-1, ::-1], atol=0.02)
    assert picture[0, 0, 3] == 0
    assert np.abs(picture[64, 24] - picture[24, 64]).max() > 0.2
    assert setting.scene_facts(tweezer.load_scene("silica-1um"))["pupils"] == []
