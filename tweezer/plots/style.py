"""Style of all figures: sizes, fonts, colours and line styles, and writing them to files.

Figures have the width of one column of a journal, 85 mm, or of two, 178 mm, with no text below 7
points. Colours differ in lightness, so they are distinguished in greyscale and with red-green
colour blindness. Curves in the same axes also differ by line or marker. Figures look the same in
any Matplotlib session and change no global state. Only `use` does, for notebooks. Text, axes,
light and bead have the colours of the interactive pages.
"""

from __future__ import annotations

import functools
import string
import textwrap
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import IO, Any, NamedTuple, ParamSpec, TypeVar

import matplotlib as mpl
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.figure import Figure, SubFigure
from matplotlib.legend import Legend

from tweezer.values.signs import typeset
from tweezer.values.version import __version__

_P = ParamSpec("_P")
_T = TypeVar("_T")

#: Widths of one and two columns, inches
COLUMN, PAGE = 85 / 25.4, 178 / 25.4
#: Sizes of normal and of the smallest text, points
TEXT, SMALL = 8.0, 7.0
#: Resolution of a PNG, dots per inch
DOTS = 200


class Mark(NamedTuple):
    """Colour, line and marker of one of several curves or point sets in the same axes."""

    colour: str
    line: Any
    """line style, in the form that Matplotlib accepts"""
    marker: str

    @property
    def curve(self) -> dict[str, Any]:
        """Arguments of `plot` for a line without markers."""
        return {"color": self.colour, "ls": self.line}

    @property
    def points(self) -> dict[str, Any]:
        """Arguments of `plot` for markers without a line."""
        return {"color": self.colour, "ls": "", "marker": self.marker}

    @property
    def both(self) -> dict[str, Any]:
        """Arguments of `plot` for a line with markers."""
        return {"color": self.colour, "ls": self.line, "marker": self.marker}


#: Marks of compared curves, in the order of use
SERIES = (
    Mark("#0b3c7d", "-", "o"),
    Mark("#c4495b", (0, (5, 1.5)), "s"),
    Mark("#d09a1c", (0, (4, 1.2, 1, 1.2)), "^"),
    Mark("#151515", (0, (1, 1)), "D"),
    Mark("#4a90e8", (0, (7, 1.5, 1, 1.5, 1, 1.5)), "v"),
    Mark("#6a2bc2", (0, (2.5, 1.2)), "P"),
)
#: The axes of the laboratory: blue, red and green as on pages, but of different lightness
AXES = {
    "x": Mark("#1f6fb8", "-", "o"),
    "y": Mark("#7a1f33", (0, (5, 1.5)), "s"),
    "z": Mark("#57c97d", (0, (4, 1.2, 1, 1.2)), "^"),
}
#: Speed of the bead, and its terminal speed
SPEED, TERMINAL = Mark("#5b3f9b", "-", "o"), Mark("#b4540a", (0, (5, 1.5)), "s")
#: Colours of text, axes frames and notes
INK, FRAME, NOTE = "#1b2230", "#566172", "#566172"
#: Colours of paths, the bead, the edges and foci of the light, and guide lines
PATH, BEAD, LIGHT, MUTED = "#16365f", "#4f7fbd", "#c92a2a", "#7b8593"
#: Fill of the cone of light
CONE: dict[str, Any] = {"color": "#ff5a36", "alpha": 0.09, "lw": 0, "zorder": 0}
#: Interior of an interval
SHADE = "#d8e2f1"
#: Style of what is solid
SOLID: dict[str, Any] = {"fc": "#e2e7ed", "ec": "#a9b6c3", "hatch": "////", "lw": 0, "zorder": 0}
#: Maps of colours: of a size from zero, and of any value. Their lightness goes one way
FROM_ZERO, VALUES = "Blues", "viridis"

#: Label that Matplotlib gives to the axes of a colour bar
_COLOURBAR = "<colorbar>"

_PARAMETERS: Any = {
    "axes.prop_cycle": cycler(color=[mark.colour for mark in SERIES]),
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "mathtext.fontset": "dejavusans",
    "font.size": TEXT,
    "axes.titlesize": TEXT,
    "axes.labelsize": TEXT,
    "xtick.labelsize": SMALL,
    "ytick.labelsize": SMALL,
    "legend.fontsize": SMALL,
    "legend.title_fontsize": SMALL,
    "figure.titlesize": TEXT + 1,
    "figure.labelsize": SMALL,
    "figure.facecolor": "white",
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.titlecolor": INK,
    "xtick.color": FRAME,
    "ytick.color": FRAME,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "figure.dpi": 100,
    "figure.constrained_layout.h_pad": 0.05,
    "figure.constrained_layout.w_pad": 0.05,
    "axes.linewidth": 0.6,
    "axes.edgecolor": FRAME,
    "axes.grid": False,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.5,
    "axes.axisbelow": True,
    "axes.titlepad": 4.0,
    "axes.labelpad": 2.5,
    "lines.linewidth": 1.2,
    "lines.markersize": 3.5,
    "lines.markeredgewidth": 0.7,
    "errorbar.capsize": 0.0,
    "hatch.linewidth": 0.5,
    "patch.linewidth": 0.8,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "xtick.major.size": 3.0,
    "ytick.major.size": 3.0,
    "xtick.minor.size": 1.6,
    "ytick.minor.size": 1.6,
    "xtick.direction": "out",
    "ytick.direction": "out",
    "legend.frameon": True,
    "legend.framealpha": 0.85,
    "legend.edgecolor": "none",
    "legend.fancybox": False,
    "legend.borderpad": 0.2,
    "legend.handlelength": 2.2,
    "legend.labelspacing": 0.3,
    "legend.columnspacing": 1.2,
    "image.cmap": VALUES,
    "axes.formatter.useoffset": False,
    "pdf.fonttype": 42,
    "ps.fonttype": 42,
    "svg.fonttype": "none",
    "svg.hashsalt": "tweezer",
    "savefig.dpi": DOTS,
    "savefig.bbox": None,
    "savefig.facecolor": "auto",
}


class _Styled(Figure):
    """Figure that is laid out, drawn and written in this style, in any Matplotlib session."""

    def draw(self, renderer: RendererBase) -> None:
        """Draw the figure in this style."""
        with mpl.rc_context(_PARAMETERS):
            super().draw(renderer)

    def savefig(self, fname: Any, **options: Any) -> None:
        """Write the figure in this style."""
        with mpl.rc_context(_PARAMETERS):
            super().savefig(fname, **options)


def new(width: float, height: float, *, layout: str = "constrained") -> Figure:
    """Return an empty figure of this size in inches, for drawing by a `styled` function."""
    with mpl.rc_context(_PARAMETERS):
        return _Styled(figsize=(width, height), layout=layout)  # type: ignore[arg-type]


def styled(function: Callable[_P, _T]) -> Callable[_P, _T]:
    """Make a function draw in this style, regardless of the session's style."""

    @functools.wraps(function)
    def inner(*args: _P.args, **keywords: _P.kwargs) -> _T:
        """Draw in the style of this module."""
        with mpl.rc_context(_PARAMETERS):
            return function(*args, **keywords)

    return inner


def use() -> None:
    """Use this style for everything that pyplot draws, at the size of a notebook's page.

    Curves in the same axes differ by colour and line, in the order of `SERIES`.
    """
    series = cycler(color=[mark.colour for mark in SERIES], ls=[mark.line for mark in SERIES])
    page = {"figure.figsize": (6, 3.5), "figure.dpi": 120, "axes.prop_cycle": series}
    mpl.rcParams.update(_PARAMETERS | page)


def save(figure: Figure, to: Path | IO[bytes], kind: str, title: str = "") -> None:
    """Write a figure as "png", "svg" or "pdf", with its title and without a date.

    In SVG text remains text, and PDF embeds its fonts. The same figure gives the same bytes.

    Parameters
    ----------
    figure : Figure
        Figure to write.
    to : Path or file
        File, or its name.
    kind : str
        "png", "svg" or "pdf".
    title : str, optional
        Title in the file's metadata. Default: the title above the panels.
    """
    title = title or " ".join(figure.get_suptitle().split())
    made_by = f"tweezer {__version__}"
    described = {
        "png": {"Title": title, "Software": made_by},
        "svg": {"Title": title, "Creator": made_by, "Date": None},
        "pdf": {"Title": title, "Creator": made_by, "CreationDate": None},
    }
    figure.savefig(to, format=kind, metadata=described[kind])


def add_title(figure: Figure | SubFigure, text: str, note: str = "") -> None:
    """Add a title above all panels, and a note below it, of up to two lines each.

    Both are literal text: a dollar sign in a name does not begin a formula.
    """
    width = round(13 * figure.bbox.width / figure.dpi)
    parts = [
        textwrap.fill(typeset(part), width, max_lines=2, placeholder=" …") for part in (text, note)
    ]
    figure.suptitle("\n".join(filter(None, parts)), parse_math=False)


def add_notes(figure: Figure | SubFigure, notes: Iterable[str]) -> None:
    """Add notes in small letters below all panels, each beginning a line; empty ones are left out.

    They are literal, as titles are.
    """
    width = round(19 * figure.bbox.width / figure.dpi)
    lines = [textwrap.fill(typeset(note), width) for note in notes if note]
    if lines:
        figure.supxlabel("\n".join(lines), fontsize=SMALL, color=NOTE, parse_math=False)


@styled
def add_letters(panels: Figure | Iterable[Axes]) -> None:
    """Add the letters a, b, c, ... above the left corners of panels, in their order.

    Parameters
    ----------
    panels : Figure or iterable of Axes
        Panels, or a figure: all its panels if it has several. Colour bars and invisible axes do not
        count as panels.
    """
    if isinstance(panels, Figure):
        panels = [axes for axes in panels.axes if axes.axison and axes.get_label() != _COLOURBAR]
        panels = panels if len(panels) > 1 else []
    for letter, axes in zip(string.ascii_lowercase, panels, strict=False):
        axes.set_title(letter, loc="left", fontweight="bold")


def headroom(axes: Axes, part: float, *, below: bool = False) -> None:
    """Lengthen the vertical axis by a fraction `part` of its length, to make room for a legend.

    The axis may be linear or logarithmic. It is lengthened downwards if `below`, else upwards.
    """
    scale = axes.yaxis.get_transform()
    low, high = scale.transform(axes.get_ylim())
    more = part * (high - low)
    low, high = (low - more, high) if below else (low, high + more)
    axes.set_ylim(*scale.inverted().transform([low, high]))


def legend_above(axes: Axes, columns: int, **options: Any) -> Legend:
    """Add a legend above the right corner of axes, away from the data and from the letter."""
    return axes.legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=columns, borderaxespad=0.2, **options
    )


def widen(legend: Legend) -> None:
    """Make thin lines in a legend so wide that their colours are visible."""
    for line in legend.get_lines():
        line.set_linewidth(max(line.get_linewidth(), 1.5))


def legend_below(figure: Figure | SubFigure, columns: int, **options: Any) -> None:
    """Add a legend for all panels, below them."""
    figure.legend(loc="outside lower center", ncols=columns, **options)
