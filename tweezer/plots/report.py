"""Report on a calibration, one page of HTML or PDF: figures, numbers and findings."""

from __future__ import annotations

import base64
import math
import textwrap
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from tweezer.values.errors import ResultError
from tweezer.values.files import replacing
from tweezer.values.printed import in_unit, printed, signal_unit
from tweezer.values.signs import typeset
from tweezer.values.version import __version__

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tweezer.calibration import AxisCalibration, Calibration
    from tweezer.reading import Recording

FORMATS = ("html", "pdf")
_TEMPLATE = Path(__file__).with_name("report.html")

#: Width of a PDF and height of its drawings, inches
_WIDTH, _HEIGHT = 11.0, 7.6
#: Height of a line in a PDF, inches
_LINE = 0.18
#: Number of characters in a line across a PDF
_CHARACTERS = 150
#: Left margin of a PDF, over its width
_MARGIN = 0.03
#: Positions of the columns of a table in a PDF, over its width
_COLUMNS = (0.0, 0.5, 0.73)

#: Description of the figure.
_DRAWN = "Trajectory, density of positions, power spectrum, mean squared displacement, potential"
#: Explanation of the numbers.
_READING = (
    "Uncertainties are standard uncertainties (68 %) and include statistics only: temperature, "
    "drag and scale are assumed to be exact unless they were fitted. p is the probability that the "
    "spectrum of a trapped bead deviates from the model at least as much."
)


class Verdict(NamedTuple):
    """Result of a calibration for one axis, in one line."""

    text: str
    trusted: bool
    """whether it is free of findings"""


class AxisTable(NamedTuple):
    """Stiffness estimates along one axis, as text."""

    axis: str
    rows: list[tuple[str, str, str]]
    """method, stiffness and judgement of each estimate"""
    lines: list[str]
    """further results, one line each"""


@dataclass(frozen=True)
class Page:
    """Text of a report."""

    title: str
    verdicts: list[Verdict]
    notes: list[str]
    """findings, to which tables refer by their numbers, from 1"""
    tables: list[AxisTable]
    facts: list[tuple[str, str]]
    """data read, given and fitted, by name"""


def page_of(recording: Recording, calibration: Calibration) -> Page:
    """Return the text of a report on the calibration of a recording.

    A finding that several axes share is listed once, with the names of the axes.
    """
    free = calibration.free
    trapped = calibration.trapped
    verdicts = [_verdict(axis) for axis in trapped]
    against: dict[str, list[str]] = {}
    for axis in trapped:
        for note in axis.notes:
            axes = against.setdefault(note, [])
            axes += [axis.axis] if axis.axis not in axes else []
    if free is not None:
        said = typeset(free.line(calibration.unit))
        verdicts.insert(0, Verdict(said, trusted=not free.findings))
        for text in (*(each.text for each in free.findings), *free.remarks):
            against.setdefault(text, [each.axis for each in free.axes])
    every = len(calibration.axes)
    return Page(
        f"Calibration of {calibration.name}",
        verdicts,
        [
            text if len(axes) == every else f"{', '.join(axes)}: {text}"
            for text, axes in against.items()
        ],
        [_table(axis, calibration.unit, list(against)) for axis in trapped],
        _facts(recording, calibration),
    )


def _verdict(axis: AxisCalibration) -> Verdict:
    """Return the verdict on an axis: its first estimate without findings, or why it has none."""
    for each in axis.estimates:
        if not each.findings:
            text = f"{axis.axis}: k = {each.measured.words}, by {each.method}"
            return Verdict(typeset(text), trusted=True)
    reasons = "; ".join(finding.text for finding in axis.findings)
    text = f"{axis.axis}: no trustworthy stiffness"
    return Verdict(f"{text}: {reasons}" if reasons else text, trusted=False)


def _table(axis: AxisCalibration, unit: str, notes: list[str]) -> AxisTable:
    """Return the estimates of an axis as text; `notes` are the numbered findings they refer to."""
    rows = [
        (method, k if k == "-" else f"{k} ± {error}", judgement.partition("; ")[0])
        for method, k, error, judgement in axis.table(notes).rows
    ]
    return AxisTable(axis.axis, rows, [typeset(line) for line in axis.lines(unit, notes)])


def _facts(recording: Recording, calibration: Calibration) -> list[tuple[str, str]]:
    """Return the data read, given and fitted, as pairs of name and text."""
    samples, step = calibration.samples, calibration.step
    facts = [
        ("record", f"{samples:,} samples, one every {printed(step, 'ms')}: {samples * step:.4g} s"),
        ("temperature", f"{calibration.temperature:.5g} K"),
    ]
    if recording.scene is not None:
        facts.insert(0, ("run of", recording.scene.title))
    if calibration.radius is not None:
        facts.append(("radius of the bead", printed(calibration.radius, "µm")))
    if calibration.viscosity is not None:
        facts.append(("viscosity", printed(calibration.viscosity, "mPa s")))
    drag = calibration.drag
    facts.append(("drag", "fitted" if drag is None else printed(drag, "nN s/m")))
    if calibration.mass is not None:
        facts.append(("mass of the bead", printed(calibration.mass, "pg")))
    if calibration.displaced_mass is not None:
        facts.append(("mass of the fluid in its place", printed(calibration.displaced_mass, "pg")))
    exposure = calibration.exposure
    told = "not known" if exposure is None else f"{printed(exposure, 'ms')}"
    if exposure is None and calibration.free is None:
        told += ", taken as none"
    fitted = {each.name for axis in calibration.axes for each in axis.detector}
    facts.append(("exposure of each sample", "fitted" if "exposure" in fitted else told))
    if "diode_frequency" in fitted:
        facts.append(("diode", "fitted"))
    elif calibration.diode is not None:
        frequency, part = calibration.diode
        told = printed(frequency, "kHz")
        facts.append(("diode", f"{told}, {part:.3g} detected at once" if part else told))
    if "noise" in fitted:
        facts.append(("noise of the detector", "fitted"))
    elif calibration.noise is not None:
        unit, noises = signal_unit(calibration.unit), recording.noise or (calibration.noise,)
        each = ", ".join(dict.fromkeys(in_unit(noise, unit, 3) for noise in noises))
        facts.append(("noise of the detector", f"{each} {unit}"))
    if calibration.wall is not None:
        facts.append(("distance from a wall", printed(calibration.wall.distance, "µm")))
    left_out = calibration.left_out
    facts += [("frequencies left out", _band(*band)) for band in left_out.bands]
    if left_out.drift:
        facts.append(("drift taken off", f"slower than {left_out.drift:.4g} Hz"))
    if left_out.of_fit:
        facts.append(("frequencies of the fit", _band(*left_out.fit_range)))
    if calibration.note:
        facts.append(("omitted", calibration.note))
    facts = [(name, typeset(told)) for name, told in facts]
    return [*facts, ("made by", f"tweezer {__version__}")]


def _band(low: float, high: float) -> str:
    """Return a frequency band, Hz, as text; the upper end may be infinite."""
    return f"{low:.4g} to {high:.4g} Hz" if math.isfinite(high) else f"from {low:.4g} Hz on"


def write_report(recording: Recording, calibration: Calibration, path: str | Path) -> Path:
    """Write the calibration of a recording to one page: .html or .pdf.

    The page reports which numbers can be trusted, which cannot, and why. It has the numbers of
    every method with their uncertainties, figures, and the inputs. An HTML page is one file, which
    loads nothing from elsewhere.

    Parameters
    ----------
    recording : Recording
        Recording that was calibrated.
    calibration : Calibration
        Its calibration.
    path : str or Path
        Name of the file, ending in .html or .pdf.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    ResultError
        For another ending, or if the file cannot be written.
    """
    path = Path(path)
    kind = path.suffix.lstrip(".").lower()
    if kind not in FORMATS:
        raise ResultError(f"{path}: must end in .{', .'.join(FORMATS)}")
    page = page_of(recording, calibration)
    if kind == "pdf":
        from tweezer.plots import style

        with replacing(path) as whole:
            drawn = style.styled(_as_pdf)(page, recording, calibration)
            style.save(drawn, whole, "pdf", page.title)
        return path
    text = _as_html(page, recording, calibration)
    with replacing(path) as whole:
        whole.write(text.encode())
    return path


def _as_html(page: Page, recording: Recording, calibration: Calibration) -> str:
    """Return the report as HTML, with its figure embedded as PNG."""
    from jinja2 import Environment, StrictUndefined

    from tweezer.plots import calibration_figure, style

    drawn = BytesIO()
    style.save(calibration_figure(recording, calibration), drawn, "png")
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    template = environment.from_string(_TEMPLATE.read_text(encoding="utf-8"))
    figure = base64.b64encode(drawn.getvalue()).decode()
    return template.render(page=page, figure=figure, drawn=_DRAWN, reading=_READING)


def _as_pdf(page: Page, recording: Recording, calibration: Calibration) -> Figure:
    """Return the report as a figure for a PDF, with text above and drawings below.

    The height of the figure follows from the number of lines, which have a fixed height.
    """
    from tweezer.plots import draw_calibration, style

    notes = [
        line
        for number, note in enumerate(page.notes, start=1)
        for line in textwrap.wrap(f"{number}  {note}", _CHARACTERS, subsequent_indent="    ")
    ]
    verdicts = [
        (line, verdict.trusted)
        for verdict in page.verdicts
        for line in textwrap.wrap(verdict.text, _CHARACTERS - 25)
    ]
    narrow = _CHARACTERS // max(len(page.tables), 1) - 8
    lines = [
        [line for each in table.lines for line in textwrap.wrap(each, narrow)]
        for table in page.tables
    ]
    lengths = (len(table.rows) + len(told) for table, told in zip(page.tables, lines, strict=True))
    rows = max(lengths, default=0)
    facts = textwrap.wrap("; ".join(f"{name}: {value}" for name, value in page.facts), _CHARACTERS)
    facts += textwrap.wrap(_READING, _CHARACTERS)
    count = 8 + len(verdicts) + len(notes) + rows + len(facts)
    figure = style.new(_WIDTH, _HEIGHT + count * _LINE)
    parts = figure.subfigures(2, 1, squeeze=False, height_ratios=[count * _LINE, _HEIGHT])
    words, drawings = parts[:, 0]
    at = 1.0

    def write(text: str, x: float = _MARGIN, **look: object) -> None:
        """Write a text at the current height, with its left end at `x` of the width."""
        words.text(x, at, text, va="top", parse_math=False, **{"fontsize": style.TEXT, **look})

    def down(lines: float) -> None:
        """Move the current height down by a number of lines."""
        nonlocal at
        at -= lines / count

    down(1)
    write(page.title, fontsize=12, weight="bold")
    down(2)
    for text, trusted in verdicts:
        write(text, fontsize=9.5, color="#222222" if trusted else "#aa3333")
        down(1.2)
    down(0.4)
    if notes:
        write("What is not to be trusted, and why", weight="bold")
        down(1)
    for line in notes:
        write(line)
        down(1)
    down(0.5)
    top, width = at, (1 - 2 * _MARGIN) / max(len(page.tables), 1)
    for i, (table, told) in enumerate(zip(page.tables, lines, strict=True)):
        at, left = top, _MARGIN + i * width
        headings = f"{table.axis}: stiffness by", "pN/µm", ""
        for row in (headings, *table.rows):
            weight = "bold" if row is headings else "normal"
            for part, cell in zip(_COLUMNS, row, strict=True):
                write(cell, left + part * width, weight=weight, fontsize=style.SMALL)
            down(1)
        for line in told:
            write(line, left, color=style.NOTE)
            down(1)
    at = top
    down(rows + 1.5)
    for line in facts:
        write(line, color=style.NOTE, fontsize=style.SMALL)
        down(0.95)
    draw_calibration(drawings, recording, calibration)
    return figure
