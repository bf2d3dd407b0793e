"""Style of all figures: sizes, fonts, colours and line styles, and writing them to files.

Figures have the width of one column of a journal, 85 mm, or of two, 178 mm, with no text below 7
points. Colours differ in lightness, so they are distinguished in greyscale and with red-green
colour blindness. Curves in the same axes also differ by line or marker. Figures look the same in
any Matplotlib session and change no global state. Only `use` does, for notebooks.
"""

from __future__ import annotations

import functools
import textwrap
from collections.abc import Callable
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
#: Marks of the axes of the laboratory frame
AXES = dict(zip("xyz", SERIES, strict=False))
#: Colours of the path, of light and its limits, of orientation marks, and of notes
PATH, LIGHT, MUTED, NOTE = SERIES[0].colour, "#cc3311", "#777777", "#555555"
#: Colour of the inside of an interval
SHADE = "#d8e2f1"
#: Style of solid regions
SOLID: dict[str, Any] = {"fc": "#dddddd", "ec": "#aaaaaa", "hatch": "////", "lw": 0, "zorder": 0}
#: Colour maps for values from zero, and for any values, with monotonic lightness
FROM_ZERO, VALUES = "Blues", "viridis"

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
    "figure.dpi": 100,
    "figure.constrained_layout.h_pad": 0.05,
    "figure.constrained_layout.w_pad": 0.05,
    "axes.linewidth": 0.6,
    "axes.edgecolor": "#333333",
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
    """Add a title above all panels, and a note below it, of up to three lines each.

    Both are literal text: a dollar sign in a name does not begin a formula.
    """
    width = round(13 * figure.bbox.width / figure.dpi)
    parts = [
        textwrap.fill(typeset(part), width, max_lines=3, placeholder=" …") for part in (text, note)
    ]
    figure.suptitle("\n".join(filter(None, parts)), parse_math=False)


def add_note(figure: Figure, text: str) -> None:
    """Add a note in small letters below all panels, on limitations that a reader must know."""
    width = round(figure.get_figwidth() * 17)
    figure.supxlabel(
        textwrap.fill(typeset(text), width), fontsize=SMALL, color=NOTE, parse_math=False
    )


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
    """Add a legend between axes and title, outside the data."""
    return axes.legend(
        loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=columns, borderaxespad=0.2, **options
    )


def widen(legend: Legend) -> None:
    """Make thin lines in a legend so wide that their colours are visible."""
    for line in legend.get_lines():
        line.set_linewidth(max(line.get_linewidth(), 1.5))


def legend_below(figure: Figure | SubFigure, columns: int, **options: Any) -> None:
    """Add a legend for all panels, below them."""
    figure.legend(loc="outside lower center", ncols=columns, **options)
