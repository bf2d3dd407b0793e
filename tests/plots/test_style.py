"""The look of figures: colours told apart by everybody and in grey, and files fit for a paper."""

from __future__ import annotations

import functools
import io
import itertools

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from tests import readable
from tests.benchmarks import fit_report, hydro_report, pages, wall_report
from tweezer.plots import style

#: Linear RGB as people see it who have no working cones for long or for middle wavelengths
#: (G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, IEEE Trans. Vis. Comput. Graph. 15, 1291
#: (2009), severity 1.0)
SEEN = {
    "usual": np.eye(3),
    "protanopia": np.array([
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ]),
    "deuteranopia": np.array([
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ]),
}  # fmt: skip
#: sRGB to CIE XYZ (IEC 61966-2-1)
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def linear(colour):
    """The parts of light of "#rrggbb", 0 to 1."""
    coded = np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
    return np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)


def lab(light):
    """CIE 1976 L*a*b* beside the white of sRGB; distances are the colour difference of 1976."""
    parts = TO_XYZ @ np.clip(light, 0, 1) / TO_XYZ.sum(axis=1)
    root = np.where(parts > (6 / 29) ** 3, np.cbrt(parts), parts * (29 / 6) ** 2 / 3 + 4 / 29)
    return np.array([116 * root[1] - 16, 500 * (root[0] - root[1]), 200 * (root[1] - root[2])])


def test_the_formulas_of_colour():
    """White, mid grey and red as they are tabulated."""
    assert lab(linear("#ffffff")) == pytest.approx([100, 0, 0], abs=1e-6)
    assert lab(linear("#777777")) == pytest.approx([50.03, 0, 0], abs=0.02)
    assert lab(linear("#ff0000")) == pytest.approx([53.2, 80.1, 67.2], abs=0.1)
    for matrix in SEEN.values():  # grey stays grey
        assert matrix @ np.ones(3) == pytest.approx(np.ones(3), abs=1e-5)


@pytest.mark.parametrize("who", SEEN)
@pytest.mark.parametrize(("marks", "least"), [(style.AXES.values(), 40), (style.SERIES, 17)])
def test_colours_are_told_apart(marks, least, who):
    seen = [lab(SEEN[who] @ linear(mark.colour)) for mark in marks]
    for one, two in itertools.combinations(seen, 2):
        assert np.linalg.norm(one - two) > least


def test_colours_are_told_apart_in_grey_and_looks_without_colour():
    for marks, least in ((style.AXES.values(), 18), (style.SERIES, 7.5)):
        lightness = sorted(lab(linear(mark.colour))[0] for mark in marks)
        assert min(np.diff(lightness)) > least
    assert len({str(mark.line) for mark in style.SERIES}) == len(style.SERIES)
    assert len({mark.marker for mark in style.SERIES}) == len(style.SERIES)


@style.styled
def drawn():
    figure = style.new(style.COLUMN, 3.5)
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    for i, mark in enumerate(style.SERIES):
        axes.plot([1, 2, 3], [i, 1, i], label=f"{i}: $f_c$", **mark.both)
    axes.set(xlabel="lag (µs)", ylabel="v (m/s)")
    style.legend_above(axes, 3)
    style.add_title(figure, r"a name without end " * 6 + r"\$\frac", "and how")
    style.add_notes(figure, ["what a reader must know, " * 8, "", "0.5 um"])
    return figure


def saved(kind):
    file = io.BytesIO()
    style.save(drawn(), file, kind)
    return file.getvalue()


#: the files as they are where nothing else sets a style, each written once
usual = functools.cache(saved)


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_a_figure_is_the_same_whatever_the_style_of_the_session(kind):
    before = dict(mpl.rcParams)
    expected = usual(kind)
    with mpl.rc_context({"font.size": 30, "axes.grid": True, "xtick.labelsize": 3, "svg.id": None}):
        assert saved(kind) == expected
    assert dict(mpl.rcParams) == before
    assert b"CreationDate" not in expected
    assert b"<dc:date>" not in expected


def test_a_figure_is_shown_as_it_is_written():
    """What a notebook draws: numbers of axes are made only then."""
    expected, shown = drawn(), drawn()
    expected.canvas.draw()
    with mpl.rc_context({"xtick.labelsize": 3, "xtick.major.size": 20}):
        shown.canvas.draw()
    assert np.array_equal(expected.canvas.buffer_rgba(), shown.canvas.buffer_rgba())


def test_text_of_a_drawing_is_text_with_its_fonts():
    page = usual("svg").decode()
    assert "v (m/s)" in page
    assert "<title>a name without end" in page or "<dc:title>a name without end" in page
    paper = usual("pdf")
    assert b"/FontFile2" in paper  # TrueType, embedded
    assert b"/Type3" not in paper


def test_letters_for_a_figure_skip_colour_bars_and_hidden_panels():
    figure = style.new(style.PAGE, 3.0)
    first, hidden, last = figure.subplots(1, 3)
    figure.colorbar(first.pcolormesh([[0.0, 1.0]]), ax=first)
    hidden.set_axis_off()
    style.add_letters(figure)
    assert [axes.get_title(loc="left") for axes in (first, hidden, last)] == ["a", "", "b"]


def test_a_single_panel_has_no_letter():
    figure = style.new(style.COLUMN, 3.0)
    axes = figure.subplots()
    style.add_letters(figure)
    assert axes.get_title(loc="left") == ""


def test_long_titles_stay_within():
    readable.check(drawn())


@pytest.mark.parametrize(
    ("name", "report"),
    [("fit", fit_report), ("hydro", hydro_report), ("wall", wall_report)],
)
def test_figures_of_benchmarks_are_readable(name, report):
    readable.check(report.figure(pages.committed(name)))
