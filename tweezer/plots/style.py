"""Style of all figures: sizes, fonts, colours and line styles, and writing them to files.

A figure is drawn at the size at which it is printed: as wide as one column of a journal, 85 mm, or
as two, 178 mm, with no text below 7 points. Colours differ in lightness, so that they are
distinguished in grey and with red-green colour blindness. Curves in the same axes also differ by
line or marker. A figure has the same look whatever the style of the session, and changes no global
state; only `use` does, for notebooks.
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

from tweezer.values.version import __version__

_P = ParamSpec("_P")
_T = TypeVar("_T")

#: Width of one column and of two, inches: 85 mm and 178 mm
COLUMN, PAGE = 85 / 25.4, 178 / 25.4
#: Size of most text and of the smallest, points
TEXT, SMALL = 8.0, 7.0
#: Dots an inch of a PNG
DOTS = 200


class Mark(NamedTuple):
    """Colour, line and marker of one of several curves or point sets in the same axes."""

    colour: str
    line: Any
    """style of its line, as Matplotlib takes it"""
    marker: str

    @property
    def curve(self) -> dict[str, Any]:
        """Arguments of `plot` for a line alone."""
        return {"color": self.colour, "ls": self.line}

    @property
    def points(self) -> dict[str, Any]:
        """Arguments of `plot` for markers alone."""
        return {"color": self.colour, "ls": "", "marker": self.marker}

    @property
    def both(self) -> dict[str, Any]:
        """Arguments of `plot` for a line with markers."""
        return {"color": self.colour, "ls": self.line, "marker": self.marker}


#: Things that are compared, in the order in which they are used
SERIES = (
    Mark("#0b3c7d", "-", "o"),
    Mark("#c4495b", (0, (5, 1.5)), "s"),
    Mark("#d09a1c", (0, (4, 1.2, 1, 1.2)), "^"),
    Mark("#151515", (0, (1, 1)), "D"),
    Mark("#4a90e8", (0, (7, 1.5, 1, 1.5, 1, 1.5)), "v"),
    Mark("#6a2bc2", (0, (2.5, 1.2)), "P"),
)
#: The axes of the laboratory
AXES = dict(zip("xyz", SERIES, strict=False))
#: What moves, the light and its limits, what serves for orientation, and what is told beside
PATH, LIGHT, MUTED, NOTE = SERIES[0].colour, "#cc3311", "#777777", "#555555"
#: Interior of an interval
SHADE = "#d8e2f1"
#: Style of what is solid
SOLID: dict[str, Any] = {"fc": "#dddddd", "ec": "#aaaaaa", "hatch": "////", "lw": 0, "zorder": 0}
#: Maps of colours: of a size from zero, and of any value. Their lightness goes one way
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
    """A figure that is laid out, drawn and written in this style, whatever the session's style."""

    def draw(self, renderer: RendererBase) -> None:
        """Draw the figure in this style."""
        with mpl.rc_context(_PARAMETERS):
            super().draw(renderer)

    def savefig(self, fname: Any, **options: Any) -> None:
        """Write the figure in this style."""
        with mpl.rc_context(_PARAMETERS):
            super().savefig(fname, **options)


def new(width: float, height: float, *, layout: str = "constrained") -> Figure:
    """Return an empty figure of this size in inches, to be drawn on by a `styled` function."""
    with mpl.rc_context(_PARAMETERS):
        return _Styled(figsize=(width, height), layout=layout)  # type: ignore[arg-type]


def styled(function: Callable[_P, _T]) -> Callable[_P, _T]:
    """Let a function draw in this style, whatever the style of the session."""

    @functools.wraps(function)
    def inner(*args: _P.args, **keywords: _P.kwargs) -> _T:
        """Draw in the style of this module."""
        with mpl.rc_context(_PARAMETERS):
            return function(*args, **keywords)

    return inner


def use() -> None:
    """Use this style for all that pyplot draws from now on, at the size of a notebook's page.

    Curves in the same axes differ by colour and line, in the order of `SERIES`.
    """
    series = cycler(color=[mark.colour for mark in SERIES], ls=[mark.line for mark in SERIES])
    page = {"figure.figsize": (6, 3.5), "figure.dpi": 120, "axes.prop_cycle": series}
    mpl.rcParams.update(_PARAMETERS | page)


def save(figure: Figure, to: Path | IO[bytes], kind: str, title: str = "") -> None:
    """Write a figure as "png", "svg" or "pdf", with its title and without a date.

    title: by default the one above the panels. In SVG text remains text; PDF embeds its fonts. The
    same figure gives the same bytes.
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

    Both are literal: a dollar sign in a name begins no formula.
    """
    width = round(13 * figure.bbox.width / figure.dpi)
    parts = [textwrap.fill(part, width, max_lines=3, placeholder=" …") for part in (text, note)]
    figure.suptitle("\n".join(filter(None, parts)), parse_math=False)


def add_note(figure: Figure, text: str) -> None:
    """Add a note that a reader must know, in small letters below all panels."""
    width = round(figure.get_figwidth() * 17)
    figure.supxlabel(textwrap.fill(text, width), fontsize=SMALL, color=NOTE, parse_math=False)


def headroom(axes: Axes, part: float, *, below: bool = False) -> None:
    """Lengthen the vertical axis by a fraction `part` of its length, to make room for a legend.

    The axis may be linear or logarithmic. below: lengthen it downwards, not upwards.
    """
    scale = axes.yaxis.get_transform()
    low, high = scale.transform(axes.get_ylim())
    more = part * (high - low)
    low, high = (low - more, high) if below else (low, high + more)
    axes.set_ylim(*scale.inverted().transform([low, high]))


def legend_above(axes: Axes, columns: int, **options: Any) -> Legend:
    """Add a legend between axes and title, away from the data."""
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
