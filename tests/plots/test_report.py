"""The page of a calibration: its numbers, what is not to be trusted, and its two forms."""

from __future__ import annotations

import dataclasses
import html
import re

import numpy as np
import pytest

import tweezer
from tests.reference.trapped_bead import trapped
from tweezer.calibration.left_out import LeftOut
from tweezer.plots.report import page_of
from tweezer.reading import Recording

DRAG = 9.4e-9


@pytest.fixture(scope="module")
def drifting():
    """A record of 40 and 10 pN/um, 2,000 samples a second, of which x drifts, and what it tells."""
    columns = [
        trapped(5e-4, 3000, k, DRAG, None, 293.15, seed, 1, exposure=0.0)[0]
        for seed, k in enumerate((40e-6, 10e-6), start=1)
    ]
    x = np.stack(columns, axis=1)
    x[:, 0] += np.linspace(0.0, 2e-7, len(x))
    recording = Recording(5e-4 * np.arange(len(x)), x, ("x", "y"), name="bead <1>.csv")
    return recording, tweezer.calibrate(recording, temperature=293.15, drag=DRAG, exposure=0.0)


def words(path):
    """The text of an HTML page."""
    text = re.sub(r"<style>.*?</style>|<[^>]*>", " ", path.read_text(encoding="utf-8"), flags=re.S)
    return " ".join(html.unescape(text).split())


def test_a_page_has_every_number_and_why_it_is_not_to_be_trusted(drifting, tmp_path):
    """The drift stands there once, the numbers of x refer to it, and those of y are trusted."""
    recording, found = drifting
    path = tweezer.write_report(recording, found, tmp_path / "page.html")
    text = words(path)
    x, y = found.axes
    assert text.startswith("Calibration of bead <1>.csv")
    assert {"drift"} <= {finding.name for finding in x.findings}
    assert not y.findings
    for number, finding in enumerate(x.findings, start=1):
        assert text.count(finding.text) == 2  # in the verdict, and as a note
        assert page_of(recording, found).notes[number - 1] == f"x: {finding.text}"
    assert "not trusted: 1" in text
    assert f"y: k = {y.estimates[0].stiffness * 1e6:.1f}" in text
    for axis in found.axes:
        for each in axis.estimates:
            digits = tweezer.values.rounding.with_uncertainty(
                1e6 * each.stiffness, 1e6 * each.uncertainty, "±"
            )
            assert digits in text
    for said in ("3,000 samples", "0.5 ms", "drag 9.4 nN·s/m", "293.15 K"):
        assert said in text
    source = path.read_text(encoding="utf-8")
    assert "http" not in source
    assert source.count("data:image/png;base64,") == 1


def test_the_numbers_of_a_page_are_those_of_its_notes(drifting):
    """Other notes of another axis may precede them."""
    recording, found = drifting
    x, y = found.axes
    other = dataclasses.replace(x.findings[0], text="y is another matter")
    mixed = dataclasses.replace(found, axes=(x, dataclasses.replace(y, findings=(other,))))
    page = page_of(recording, mixed)
    number = page.notes.index("y: y is another matter") + 1
    assert number > 1
    (line,) = (line for line in page.tables[1].lines if "corner frequency" in line)
    assert line.endswith(f"not trusted: {number}")


def test_a_free_bead_has_one_verdict_and_no_table():
    rng = np.random.default_rng(1)
    x = np.cumsum(1e-7 * rng.standard_normal((1000, 2)), axis=0)
    recording = Recording(np.arange(1000) / 100, x, ("x", "y"), name="free")
    page = page_of(recording, tweezer.calibrate(recording, temperature=293.15))
    assert not page.tables
    (verdict,) = page.verdicts
    assert verdict.text.startswith(
        "x, y: no trap is detected; treated as a free bead: diffusion 0."
    )


def test_a_page_says_what_was_left_out(drifting):
    recording, found = drifting
    left_out = LeftOut(((49.0, 51.0),), 0.5, (10.0, np.inf))
    facts = page_of(recording, dataclasses.replace(found, left_out=left_out)).facts
    usual = page_of(recording, found).facts
    assert ("frequencies left out", "49 to 51 Hz") in facts
    assert ("drift taken off", "slower than 0.5 Hz") in facts
    assert ("frequencies of the fit", "from 10 Hz on") in facts
    assert len(usual) == len(facts) - 3


def test_a_page_has_what_was_fitted_of_the_detector_and_what_was_given(tmp_path):
    """A record of 1 um/V with noise of 20 nm, of which both are fitted."""
    x = trapped(5e-4, 6000, 2e-6, DRAG, None, 293.15, 3, 1, exposure=0.0)[0]
    x += 2e-8 * np.random.default_rng(4).standard_normal(len(x))
    recording = Recording(
        5e-4 * np.arange(len(x)), 1e6 * x[:, None], ("x",), name="volts", unit="V"
    )
    radius, viscosity = 0.5e-6, DRAG / (6 * np.pi * 0.5e-6)
    found = tweezer.calibrate(
        recording, temperature=293.15, radius=radius, viscosity=viscosity, exposure=0.0,
        noise="fit",
    )  # fmt: skip
    (axis,) = found.axes
    (noise,) = axis.detector
    text = words(tweezer.write_report(recording, found, tmp_path / "page.html"))

    def number(of, end):
        """What the page says of it, with its uncertainty."""
        value, error = re.search(rf"{of} ?([0-9.]+) ± ([0-9.]+) {end}", text).groups()
        return pytest.approx(float(value), rel=1e-2), pytest.approx(float(error), rel=0.1)

    assert number("noise", "mV") == (1e3 * noise.value, 1e3 * noise.uncertainty)
    assert number("", "µm/V") == (1e6 * axis.sensitivity, 1e6 * axis.sensitivity_uncertainty)
    force = axis.force_sensitivity, axis.force_sensitivity_uncertainty
    assert number("", "pN/V") == (1e12 * force[0], 1e12 * force[1])
    assert noise.value == pytest.approx(20e-3, rel=0.2)
    for said in ("radius of the bead 0.5 µm", "viscosity 0.9974 mPa·s", "drag 9.4 nN·s/m"):
        assert said in text


def test_the_command_writes_one_page_of_one_recording(drifting, command_line, tmp_path):
    recording, _ = drifting
    table = np.column_stack([recording.times, recording.positions])
    for name in ("a.csv", "b.csv"):
        np.savetxt(tmp_path / name, table, delimiter=",", header="t,x,y", comments="")
    given = "--temperature", "293.15 K", "--blur", "0"
    done = command_line("calibrate", "a.csv", *given, "--report", "a.pdf")
    assert done.code == 1, done.err  # x drifts
    assert "wrote a.pdf" in done.err + done.out
    content = (tmp_path / "a.pdf").read_bytes()
    assert content.startswith(b"%PDF")
    assert re.findall(rb"/Type /Page\b(?!s)", content) == [b"/Type /Page"]
    for arguments, said in (
        (("a.csv", "b.csv", *given, "--report", "b.html"), "--report applies to one recording"),
        (("a.csv", *given, "--report", "a.txt"), "must end in .html, .pdf"),
    ):
        refused = command_line("calibrate", *arguments)
        assert refused.code == 2
        assert said in refused.err


def test_a_calibration_draws_its_recording(drifting):
    recording, found = drifting
    figure = found.plot(recording)
    curves = {line.get_label() for axes in figure.axes for line in axes.lines}
    for axis in found.axes:
        assert any(curve.startswith(f"{axis.axis}: $f_c$") for curve in curves)


def test_json_is_printed_as_it_is_saved(drifting, command_line, tmp_path):
    """Nothing else is on standard output, and the next command prints its tables again."""
    recording, _ = drifting
    table = np.column_stack([recording.times, recording.positions])
    np.savetxt(tmp_path / "a.csv", table, delimiter=",", header="t,x,y", comments="")
    asked = "calibrate", "a.csv", "--temperature", "293.15 K", "--blur", "0", "--json"
    printed, saved = command_line(*asked, "-"), command_line(*asked, "a.json")
    assert printed.out == (tmp_path / "a.json").read_text("utf-8")
    assert printed.code == saved.code == 1  # x drifts
    assert "y: stiffness by" in saved.out
    assert not (tmp_path / "-").exists()
