"""Results as they are read: short in a terminal, a table in Jupyter."""

import dataclasses
import xml.etree.ElementTree as ET

import numpy as np
import pytest

import tweezer
from tweezer.values.shown import Card, Row, Shown, Table, as_html, as_text


def cells(html: str) -> list[list[str]]:
    """Texts of the cells of all tables, by an XML parser: what is not well formed is refused."""
    rows = ET.fromstring(html).iter("tr")
    return [["".join(cell.itertext()) for cell in row] for row in rows]


CARD = Card(
    "Trap", 'a<b>&"c"',
    (
        Row("stiffness", "5.0 +- 0.1 pN/um", "not to be trusted: <noise>"),
        Row("drag", "9 nN s/m"),
        Row("inner", "detail", detail=True),
    ),
    (Table(("escape", "force, pN"), (("+x", "3 < 4"),)),),
    ("a note & more",),
)  # fmt: skip


def test_text_is_short_and_html_is_whole_and_escaped():
    assert as_text(CARD).splitlines() == [
        'Trap of a<b>&"c"',
        "  stiffness  5.0 ± 0.1 pN/µm, not to be trusted: <noise>",
        "  drag       9 nN·s/m",
        "  a note & more",
    ]
    html = as_html(CARD)
    assert cells(html) == [
        ["stiffness", "5.0 ± 0.1 pN/µm", "not to be trusted: <noise>"],
        ["drag", "9 nN·s/m", ""],
        ["inner", "detail", ""],
        ["escape", "force, pN"],
        ["+x", "3 < 4"],
    ]
    tree = ET.fromstring(html)
    assert tree.find("table/caption").text == 'Trap of a<b>&"c"'
    assert tree.find("p").text == "a note & more"
    colours = {part for each in tree.iter() for part in each.get("style", "").split("; ")
               if part.startswith(("color", "background"))}  # fmt: skip
    assert colours == {"color: inherit", "background: transparent"}  # of the page, light or dark


def test_long_text_is_broken_and_then_cut():
    text = as_text(dataclasses.replace(CARD, rows=(Row("changed", "word " * 400),)))
    assert max(map(len, text.splitlines())) <= 92
    assert len(text) < 400
    assert text.count("...") == 1


def test_every_result_is_shown(tmp_path):
    scene = tweezer.load_scene("silica-1um")
    draw = np.random.default_rng(2)
    times, places = 1e-3 * np.arange(200), 1e-8 * draw.standard_normal((200, 2))
    record = tweezer.Recording(times, places, ("x", "y"), name="<mine>")
    calibration = tweezer.calibrate(record, temperature=293)
    track = tweezer.Track(times, places, name="t")
    escapes = tweezer.escape_times(times, 1e-9 * np.ones((3, 200, 3)), 1e-6)
    results = [
        scene, tweezer.bead_properties(scene), record, calibration, track, escapes,
        calibration.axes[0], tweezer.potential(draw.standard_normal(3000) * 1e-8, 293),
        tweezer.Lifetime(3600.0, 30.0, 1e-5), tweezer.LeastPower(
            4e-3, 1e-5, tweezer.Lifetime(3600.0, 30.0, 1e-5)
        ),
    ]  # fmt: skip
    if calibration.free is not None:
        results.append(calibration.free)
    for result in results:
        assert isinstance(result, Shown | tweezer.Scene)
        assert len(repr(result)) < 1000
        assert max(map(len, repr(result).splitlines())) <= 92
        assert "nan" not in repr(result)
        told = cells(result._repr_html_())
        assert told
        for name, *values in told:  # every line of the text is in the table
            assert name
            assert any(values)
    assert "1.000 ± 0.008 h" in repr(results[8])
    assert "4.000 ± 0.010 mW" in repr(results[9])


@pytest.mark.parametrize("kind", ["Trap", "Summary", "SceneFit", "DepthFit", "Tuning", "Surface"])
def test_others_are_made_of_cards_too(kind):
    assert issubclass(getattr(tweezer, kind), Shown)
    assert "__repr__" not in vars(getattr(tweezer, kind))  # none of a dataclass before it
