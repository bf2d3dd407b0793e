"""The user's options for reading a file whose headings do not suffice: columns, rate and scale."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Self

from tweezer.reading.headings import AXES, PIXEL, factor_of, understood
from tweezer.values.errors import ResultError
from tweezer.values.units import QuantityLike, as_given, bare, to_si

#: Quantities that the user may assign to a column
_QUANTITIES = ("t", "frame", "bead", *AXES)
#: Allowed range of a sampling rate, Hz
_RATES = (1e-6, 1e12)
#: Allowed range of the length of a pixel or a volt, m
_SCALES = (1e-13, 1.0)
#: Entries for a column that is not read
_OMITTED = ("", "-", "_")
_NUMBER = re.compile(r"(?P<number>[-+.0-9]+(?:[eE][-+]?[0-9]+)?)\s*(?P<unit>.*)")
_PER_SECOND = re.compile(r"(?P<number>.*?[0-9.])\s*(?:fps|/\s*s|1/s|frames\s*/\s*s)")


class Chosen(NamedTuple):
    """A column that the user chose for a quantity, by its index or by its heading."""

    quantity: str
    """t, frame, bead, x, y or z"""
    place: int | None
    """index of the column, from 0; None if it is chosen by its heading"""
    heading: str = ""
    """heading of the column; "" if it is chosen by its index"""
    unit: str | None = None
    """unit given by the user, as written"""


class Scale(NamedTuple):
    """Length that corresponds to a pixel or a volt."""

    metres: float
    """length, m"""
    of: str
    """unit with this length: "px" or "V\""""


@dataclass(frozen=True)
class Reading:
    """The user's options for reading a file."""

    columns: tuple[Chosen, ...] = ()
    """columns to read; if empty, they are found by their headings"""
    in_order: int = 0
    """number of columns in --columns if it lists them in file order; 0 if it names each by heading
    or number"""
    rate: float | None = None
    """rate of the rows, or of the frames counted by a column, Hz"""
    scale: Scale | None = None
    """length of a pixel or volt, for positions in these units"""
    drive: str | None = None
    """heading, without its unit, of the column with the motion of the stage"""
    bead: str | None = None
    """label of the bead to read from a table of several"""

    @classmethod
    def of(
        cls,
        columns: str | Sequence[str] | Mapping[str, str | int] | None = None,
        rate: QuantityLike | None = None,
        scale: QuantityLike | None = None,
        drive: str | None = None,
        bead: str | int | None = None,
    ) -> Self:
        """Return the options from arguments in the forms that `load_recording` accepts.

        Parameters
        ----------
        columns : str, sequence of str or mapping, optional
            Columns to read.
        rate : float or str, optional
            Sampling rate, Hz.
        scale : float or str, optional
            Length per pixel or per volt, m.
        drive : str, optional
            Heading of the column with the motion of the stage.
        bead : str or int, optional
            Bead to read from a table of several.

        Raises
        ------
        ResultError
            For an invalid value, with the name of the option.
        """
        chosen, in_order = ((), 0) if columns is None else _columns(columns)
        return cls(
            chosen, in_order,
            None if rate is None else _rate(rate),
            None if scale is None else _scale(scale),
            drive,
            None if bead is None else str(bead).strip(),
        )  # fmt: skip

    @property
    def given(self) -> list[str]:
        """Names of the options for tables that the user gave."""
        by_name = {
            "columns": self.columns, "rate": self.rate, "scale": self.scale, "bead": self.bead,
        }  # fmt: skip
        return [name for name, value in by_name.items() if value]


def _columns(
    given: str | Sequence[str] | Mapping[str, str | int],
) -> tuple[tuple[Chosen, ...], int]:
    """Return the columns chosen by --columns, and how many it lists in file order.

    The number is 0 if each column is chosen by its heading or number.
    """
    if isinstance(given, Mapping):
        entries = [f"{name}={place}" for name, place in given.items()]
    else:
        try:
            entries = given.split(",") if isinstance(given, str) else list(given)
        except TypeError:
            raise ResultError(
                f'columns = {given!r}: must be a text such as "t [s],x [um]", a list of such names '
                'or a mapping such as {"t": 1, "x": 4}'
            ) from None
    entries = [str(entry).strip() for entry in entries]
    named = ["=" in entry for entry in entries]
    if any(named) and not all(named):
        raise ResultError(
            f"columns = {','.join(entries)!r}: must name all columns in their order, such as "
            '"t [s],x [um]", or each by its heading or number, such as "t=1,x=4"'
        )
    chosen = tuple(
        _chosen(*entry.split("=", 1)) if all(named) else _in_order(index, entry)
        for index, entry in enumerate(entries)
        if all(named) or entry not in _OMITTED
    )
    quantities = [each.quantity for each in chosen]
    if twice := [each for each in quantities if quantities.count(each) > 1]:
        raise ResultError(f"columns = {','.join(entries)!r}: has two columns for {twice[0]}")
    if not set(quantities) & set(AXES):
        raise ResultError(f"columns = {','.join(entries)!r}: must have x, y or z among them")
    return chosen, 0 if all(named) else len(entries)


def _in_order(index: int, entry: str) -> Chosen:
    """Return column number `index`, from 0, for an entry in file order such as "x [um]"."""
    found = understood(entry)
    return Chosen(_known(found.quantity, entry), index, unit=found.unit)


def _chosen(name: str, place: str) -> Chosen:
    """Return the column for the quantity `name` at `place`: "4", "4 [um]" or a heading."""
    quantity, place = _known(understood(name).quantity, name), place.strip()
    number = re.fullmatch(r"([0-9]{1,9})\s*(?:[\[(]([^\[\]()]*)[\])])?", place)
    if number is None:
        return Chosen(quantity, None, place)
    if int(number[1]) < 1:
        raise ResultError(f"columns: {name}={place}: columns are counted from 1")
    return Chosen(quantity, int(number[1]) - 1, unit=number[2])


def _known(quantity: str | None, text: str) -> str:
    """Return a quantity that a table may have; otherwise raise `ResultError` quoting `text`."""
    if quantity not in _QUANTITIES:
        raise ResultError(
            f"columns: {text!r} is not known; must be t, frame, bead, x, y or z, optionally with a "
            'unit as in "x [um]", or - for a column to skip'
        )
    return quantity


def _rate(given: QuantityLike) -> float:
    """Return a rate in Hz, from a number, a quantity such as "2 kHz", or "100 fps"."""
    try:
        if isinstance(given, str) and (match := _PER_SECOND.fullmatch(given.strip())):
            given = f"{match['number']} Hz"
        return to_si(bare(given), "1/s", *_RATES)
    except ValueError as error:
        raise ResultError(f"rate = {given!r}: {error}") from None


def _scale(given: QuantityLike) -> Scale:
    """Return the length of a pixel or volt from a text or number.

    Examples are 8.58e-8, "85.8 nm", "85.8 nm/px", "11.66 px/um", "0.5 um/V" and "2 V/um".
    """
    above, _, below = re.sub(r" per | ?/ ?", "/", " ".join(as_given(given).split())).partition("/")
    try:
        match = _NUMBER.fullmatch(above)
        if match is None:
            raise ValueError(above)
        number, unit = float(match["number"]), match["unit"] or "m"
        factor, kind = factor_of(unit, "x")
        if kind == "m":
            signal, of = factor_of(below or PIXEL, "x")
            metres = number * factor / signal
        else:  # a number of pixels or volts per length
            of, metres = kind, to_si(f"1 {below}", "m") / (number * factor)
        if of == "m" or not _SCALES[0] <= metres <= _SCALES[1]:
            raise ValueError(f"{metres:g} m")
    except (ValueError, ZeroDivisionError):
        raise ResultError(
            f'scale = {given!r}: must be a length such as "85.8 nm", of a pixel, or "11.66 px/um" '
            f'or "0.5 um/V", from {_SCALES[0]:g} to {_SCALES[1]:g} m'
        ) from None
    return Scale(metres, of)
