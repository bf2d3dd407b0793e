"""Selection of the columns of a table that are read, and their conversion to SI units."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence, Set
from typing import Any, NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from tweezer.reading.headings import (
    AROUND,
    AXES,
    PIXEL,
    SI,
    factor_of,
    is_unit,
    of_a_spectrum,
    of_the_drive,
    understood,
)
from tweezer.reading.options import Chosen, Reading
from tweezer.reading.order import in_order, refuse_another_order
from tweezer.reading.table import Array, Table, refuse_too_long
from tweezer.reading.times import at_even_times, of_frames
from tweezer.values.errors import ResultError, SeveralBeadsError

#: Relative deviation of the given rate from unread times, above which a note reports it
_ANOTHER_RATE = 0.05
#: Largest number of headings in an error message
_NAMES_TOLD = 10


class Wanted(NamedTuple):
    """Requirements of the caller: which coordinates a table must have, and in which units."""

    axes: tuple[str, ...]
    """coordinates that the table must have, such as ("x", "y")"""
    volts: bool = False
    """whether positions may be voltages"""


class Columns(NamedTuple):
    """Numbers from a table: the times, positions and stage motion of one bead."""

    times: Array
    """(n,) times, s"""
    columns: dict[str, Array]
    """(n,) coordinates "x", "y" and "z" that the table contains, in `unit`, and the motion of the
    stage, "drive", m"""
    unit: str
    """unit of x, y and z: "m" or "V\""""
    note: str
    """changes to the numbers, such as rows that were sorted or omitted; "" for none"""
    dated: bool
    """whether times or frame numbers were read, which determine the order of the rows"""


class _Place(NamedTuple):
    """A column to read, and the units stated for it."""

    column: int
    """index of the column in the table, from 0"""
    units: tuple[str, ...] = ()
    """units stated in the option --columns, in the heading and in a line or attribute of units;
    they must agree"""


def read(table: Table, reading: Reading, wanted: Wanted) -> dict[str, Columns]:
    """Read the required columns from a table, and return them by the label of the bead.

    A table of one bead has the label "". Numbers are in SI units, or in V. Raises `ResultError`
    with the name of the file and, if possible, the remedy. `reading` contains the user's options,
    and `wanted` the requirements of the caller.
    """
    _refuse_spectrum(table, reading)
    places = _places(table, reading, wanted)
    # with frame numbers and a rate, a column of times is only compared with them
    beside = places.pop("t", None) if "frame" in places else None
    of_bead = places.pop("bead", None)
    axes = [axis for axis in AXES if axis in places]
    factors = {
        name: (1.0, "") if name == "frame" else _factor(table, name, place, reading, wanted)
        for name, place in places.items()
    }
    units = {axis: factors[axis][1] for axis in axes}
    if other := [axis for axis in axes if units[axis] != units[axes[0]]]:
        raise ResultError(
            f"{table.name}: {axes[0]} is in {units[axes[0]]}, and {other[0]} in "
            f"{units[other[0]]}; must be in the same unit"
        )
    for place in places.values():
        column = table.columns[place.column]
        refuse_too_long(table.name, column.name, column.samples)
    values = dict(
        zip(places, table.numbers([place.column for place in places.values()]), strict=True)
    )
    lengths = {name: len(each) for name, each in values.items()}
    if len(set(lengths.values())) > 1:
        told = " and ".join(f"{each:,} values of {name}" for name, each in lengths.items())
        raise ResultError(
            f"{table.name}: columns have different lengths: {told}; choose columns of the same "
            "length with --columns"
        )
    values = {name: factors[name][0] * each for name, each in values.items()}
    chosen = [table.columns[place.column] for place in places.values()]
    notes = dict.fromkeys(column.note for column in chosen)
    steps = {column.step for column in chosen if column.step is not None}
    if len(steps) > 1:
        raise ResultError(f"{table.name}: {', '.join(values)}: have different rates; must be equal")
    if beside is not None:
        notes[_said_by_times(table, reading, wanted, values["frame"], beside)] = None
    found = {}
    for label, rows, note in _beads(table, places, reading, of_bead, lengths[axes[0]]):
        name = f"{table.name}, bead {label}" if label else table.name
        part = {quantity: each[rows] for quantity, each in values.items()}
        part, sorted_ = _sorted(name, table, places, part, reading.rate)
        unread = ""
        if not {"t", "frame"} & set(places) and reading.rate is not None:
            unread = _unread_stamps(name, table, places, rows, reading.rate)
        times, said = _times(table, reading, part, min(steps, default=None))
        every = "; ".join(filter(None, dict.fromkeys([*notes, note, sorted_, said, unread])))
        columns = {name: each for name, each in part.items() if name not in ("t", "frame")}
        dated = bool(steps or {"t", "frame"} & set(part))
        found[label] = Columns(times, columns, units[axes[0]], every, dated)
    return found


def only(name: str, found: dict[str, Columns]) -> Columns:
    """Return the columns of the only bead; raises `SeveralBeadsError` if there are several."""
    if len(found) > 1:
        raise SeveralBeadsError(
            f"{name}: has {len(found)} beads; name the one to be read, such as --bead "
            f'"{next(iter(found))}"'
        )
    return next(iter(found.values()))


def _sorted(
    name: str,
    table: Table,
    places: dict[str, _Place],
    values: dict[str, Array],
    rate: float | None,
) -> tuple[dict[str, Array], str]:
    """Return the values with rows sorted by time, and a note on what was done.

    `name` describes file and bead in messages. `places` has the columns that were read and `values`
    their numbers (n,), in SI units, by quantity. `rate` is the given rate of the rows, Hz, or None.
    """
    stamps = values.get("frame", values.get("t"))
    if stamps is None:
        return values, ""
    others = {name: each for name, each in values.items() if name not in ("t", "frame")}
    without = _option(table, {each: places[each] for each in others if each in places})
    rows, note = in_order(name, stamps, others, without, rate if "t" in values else None)
    return {name: each[rows] for name, each in values.items()}, note


def _option(table: Table, places: dict[str, _Place]) -> str:
    """Return text for the option --columns that reads these columns, such as "x=Bead 1 [um]"."""
    named = []
    for quantity, place in places.items():
        column = table.columns[place.column]
        called = column.name.strip(AROUND) or f"{place.column + 1}"
        own = understood(column.heading).unit, column.unit
        unit = next((f" [{each}]" for each in place.units[:1] if each not in own), "")
        named.append(f"{quantity}={called}{unit}")
    return ",".join(named)


def _unread_stamps(
    name: str, table: Table, places: dict[str, _Place], rows: NDArray[Any], rate: float
) -> str:
    """Compare the given rate with a column of times that is not read, and return a note.

    The note is "" unless the rates differ by more than 5 %. Raises `ResultError` if an unread
    column of times or frame numbers shows that the rows are out of order.

    `name` describes file and bead in messages, `places` has the columns that are read, by quantity,
    `rows` (n,) selects the rows of the bead, and `rate` is in Hz.
    """
    groups = {table.columns[place.column].group for place in places.values()}
    for index, column in enumerate(table.columns):
        heading = understood(column.heading)
        if heading.quantity not in ("t", "frame") or column.group not in groups:
            continue
        try:
            (stamps,) = table.numbers([index])
        except ResultError:  # not numbers, for example dates
            continue
        if len(stamps) != len(rows):
            continue
        called = column.name.strip(AROUND)
        way = f'--columns "{_option(table, {heading.quantity: _Place(index), **places})}"'
        refuse_another_order(name, called, stamps[rows], way)
        units = [each for each in (heading.unit, column.unit) if each]
        if heading.quantity == "t" and all(is_unit(each, "t") for each in units):
            factor = factor_of(units[0], "t")[0] if units else 1.0
            dated = stamps[rows & np.isfinite(stamps)]
            lasts = factor * float(np.ptp(dated)) if len(dated) > 1 else 0.0
            found = (len(dated) - 1) / lasts if lasts else rate
            if abs(rate / found - 1) > _ANOTHER_RATE:
                return f"its column {called!r}, which is not read, has {found:.6g} Hz"
    return ""


def _beads(
    table: Table, places: dict[str, _Place], reading: Reading, chosen: _Place | None, length: int
) -> Iterator[tuple[str, NDArray[Any], str]]:
    """Yield each bead to read: its label, its rows as (n,) booleans, and a note.

    Labels come from the column `chosen` in --columns, otherwise from the first column whose heading
    denotes beads. That column must be as long as the columns that are read, and be in the same
    group of the file as one of them. Without labels, the only bead "" has all rows. `places` has
    the columns that are read, by quantity, and `length` is the number n of their rows.
    """
    groups = {table.columns[place.column].group for place in places.values()}
    of_beads = [
        index for index, column in enumerate(table.columns)
        if understood(column.heading).quantity == "bead" and column.group in groups
    ]  # fmt: skip
    for index in [chosen.column] if chosen else of_beads:
        labels = _labels(table, index)
        if len(labels) != length:
            if chosen:
                raise ResultError(
                    f"{table.name}: has {length:,} positions and {len(labels):,} bead names; must "
                    "be equal"
                )
            continue
        distinct = [each for each in dict.fromkeys(labels.tolist()) if each]
        if len(distinct) == length > 1:  # the column numbers the rows
            continue
        if reading.bead is not None and distinct:
            if _label(reading.bead) not in distinct:
                there = ", ".join(distinct[:_NAMES_TOLD]) + ", ..." * (len(distinct) > _NAMES_TOLD)
                raise ResultError(
                    f"{table.name}: bead = {reading.bead!r}: is not in the column "
                    f"{table.columns[index].name.strip(AROUND)!r}; must be one of {there}"
                )
            distinct = [_label(reading.bead)]
        none = int((labels == "").sum())
        if reading.bead is None and len(distinct) < 2:
            if len(distinct) == 1 and 0 < none < length / 2:
                yield "", labels != "", f"{none:,} rows without a bead omitted"
                return
            continue
        note = f"{none:,} rows without a bead omitted" if none else ""
        for label in distinct:
            yield label, labels == label, note
        return
    if reading.bead is not None:
        raise ResultError(
            f"{table.name}: bead = {reading.bead!r}: no column distinguishes beads; name it, such "
            'as --columns "bead=ID,..."'
        )
    yield "", np.ones(length, bool), ""


def _labels(table: Table, index: int) -> NDArray[Any]:
    """Return the label of the bead in each row of column `index`, (n,); "" for a row without one.

    Labels that are numbers have a standard form, so that 1 and 1.0 are equal.
    """
    try:
        (numbers,) = table.numbers([index])
    except ResultError:
        if table.labels is None:
            raise
        return np.array(table.labels(index), object)
    distinct, of = np.unique(numbers, return_inverse=True)
    return np.array(["" if np.isnan(x) else f"{x:.15g}" for x in distinct], object)[of]


def _label(text: str) -> str:
    """Return the label of a bead as given by the user, in the form that `_labels` uses."""
    try:
        return f"{float(text):.15g}"
    except ValueError:
        return text


def _places(table: Table, reading: Reading, wanted: Wanted) -> dict[str, _Place]:
    """Return the columns to read, by quantity: t, frame, bead, x, y, z or drive.

    They are named by --columns, or found by their headings. Raises `ResultError` if a required
    coordinate or the stage is missing, or if times are missing and no rate is given.
    """
    if reading.columns:
        places = {each.quantity: _place(table, each) for each in reading.columns}
        if not {"t", "frame"} & set(places) and reading.rate is None:
            groups = {table.columns[place.column].group for place in places.values()}
            places |= _by_headings(table, ("t", "frame"), groups)
    elif not table.headed:
        count = len(table.columns)
        names = ["t [s]", "x [um]", "y [um]", *["-"] * count][:count]
        if count == 1 or reading.rate:
            names = ["x [um]", "y [um]", "z [um]", *["-"] * count][:count]
        raise ResultError(
            f"{table.name}: has no headings over its {count} column{'s' * (count > 1)}; name them "
            f'in their order: --columns "{",".join(names)}"'
        )
    else:
        places = _by_headings(table, ("t", "frame", *AXES))
    if reading.drive is not None:
        driving = [
            (index, found.unit)
            for index, column in enumerate(table.columns)
            if (found := of_the_drive(column.heading, reading.drive)) is not None
        ]
        if len(driving) > 1:
            raise ResultError(f"{table.name}: has two columns for {reading.drive}")
        for index, unit in driving:
            places = {name: place for name, place in places.items() if place.column != index}
            beside = table.columns[index].unit
            places["drive"] = _Place(index, tuple(each for each in (unit, beside) if each))
    missing = [axis for axis in wanted.axes if axis not in places]
    if reading.drive is not None and "drive" not in places:
        missing.append(reading.drive)
    waveforms = any(column.step is not None for column in table.columns)
    timed = bool({"t", "frame"} & set(places)) or reading.rate is not None
    timed |= waveforms if missing else _has_rate(table, places)
    if missing or not timed:
        lacking = [*([] if timed else ["t"]), *missing]
        _refuse_missing(table, places, lacking, reading.drive, wanted)
    if "t" in places and reading.rate is None:
        places.pop("frame", None)
    if "frame" in places and reading.rate is None and not _has_rate(table, places):
        raise ResultError(
            f'{table.name}: has frames and no times; give their rate: --rate "... Hz"'
        )
    return places


def _refuse_spectrum(table: Table, reading: Reading) -> None:
    """Raise `ResultError` for the table of a power spectrum, unless --columns names other columns.

    A spectrum has columns of frequencies and powers. If a heading begins with "freq", any other
    column counts as powers.
    """
    quantities = {understood(column.heading).quantity for column in table.columns}
    kinds = [of_a_spectrum(column.heading, column.unit) for column in table.columns]
    if quantities & {"t", "frame"} or "frequency" not in kinds:
        return
    if "power" not in kinds:
        heading = next(
            each.heading for each, kind in zip(table.columns, kinds, strict=True) if kind
        )
        if not heading.lower().startswith("freq") or len(kinds) < 2:
            return
        kinds = [each or "power" for each in kinds]
    elif reading.columns:
        with contextlib.suppress(ResultError):  # for a column that does not exist
            if not any(kinds[_place(table, each).column] for each in reading.columns):
                return
    frequency, power = (
        table.columns[kinds.index(each)].name.strip(AROUND) for each in ("frequency", "power")
    )
    raise ResultError(
        f"{table.name}: is a spectrum: {short(power)!r} over {short(frequency)!r}; a calibration "
        "requires the recording itself, positions or voltages over time"
    )


def are_headings(cells: list[str], reading: Reading, wanted: Wanted) -> bool:
    """Return whether the cells of a line of text are the headings of the required columns.

    This finds the line of headings below other lines at the beginning of a file.
    """
    names = [_folded(cell) for cell in cells]
    if called := [_folded(each.heading) for each in reading.columns if each.heading]:
        begins = [each.partition("[")[0].rstrip() for each in called]
        return all(any(name.startswith(each) for name in names) for each in begins)
    named = {understood(cell).quantity for cell in cells}
    driven = reading.drive is None or any(of_the_drive(cell, reading.drive) for cell in cells)
    return driven and bool(named & {*AXES}) and named >= {*wanted.axes}


def _has_rate(table: Table, places: dict[str, _Place]) -> bool:
    """Return whether the file states the sampling interval of a column that is read."""
    return any(table.columns[place.column].step is not None for place in places.values())


def _place(table: Table, chosen: Chosen) -> _Place:
    """Return the column that the user chose by number, name or heading, with its units.

    Units that do not fit the quantity are ignored if another one does.
    """
    unit = chosen.unit
    if chosen.place is None:
        index, unit = _called(table, chosen)
    elif chosen.place < len(table.columns):
        index = chosen.place
    else:
        raise ResultError(
            f"{table.name}: {chosen.quantity}={chosen.place + 1}: the table has only "
            f"{len(table.columns)} columns"
        )
    column = table.columns[index]
    units = unit, understood(column.heading).unit, column.unit
    given = tuple(each for each in units if each)
    return _Place(index, tuple(each for each in given if is_unit(each, chosen.quantity)) or given)


def _called(table: Table, chosen: Chosen) -> tuple[int, str | None]:
    """Return the index of the column with the chosen name, and a unit in brackets after the name.

    The name may be the column's full name, its heading, or its heading without the unit. Raises
    `ResultError` unless it denotes exactly one column.
    """
    names = [_folded(column.name) for column in table.columns]
    headings = [_folded(column.heading) for column in table.columns]
    called, unit = chosen.heading, None
    if called.endswith("]") and _folded(called) not in names + headings:
        called, _, unit = called[:-1].rpartition("[")
    name = _folded(called)
    alike = [index for index, each in enumerate(names) if each == name]
    alike = alike or [index for index, each in enumerate(headings) if each == name]
    alike = alike or [
        index for index, each in enumerate(headings)
        if each.startswith(name) and each[len(name) :].lstrip().startswith(("[", "("))
    ]  # fmt: skip
    if len(alike) != 1:
        which = "two columns are" if alike else "no column is"
        raise ResultError(
            f"{table.name}: {which} called {called.strip()!r}{_there(table)}; columns have numbers "
            f'too, such as "{chosen.quantity}={alike[0] + 1 if alike else "N"}"'
        )
    return alike[0], unit


def _folded(name: str) -> str:
    """Return a name for comparison: lower case, single spaces, nothing around it."""
    return " ".join(name.strip(AROUND).lower().split())


def _by_headings(
    table: Table, quantities: Sequence[str], groups: Set[str] = frozenset()
) -> dict[str, _Place]:
    """Return the columns whose headings denote one of `quantities`, by quantity.

    If several columns denote the same quantity, those in one of `groups` of the file are preferred,
    then those whose heading has no other words. Raises `ResultError` if several remain.
    """
    found: dict[str, list[tuple[bool, _Place]]] = {}
    for index, column in enumerate(table.columns):
        heading = understood(column.heading)
        if heading.quantity is None or heading.quantity not in quantities:
            continue
        units = tuple(each for each in (heading.unit, column.unit) if each)
        units = units or tuple(each for each in (heading.assumed,) if each)
        found.setdefault(heading.quantity, []).append((heading.plain, _Place(index, units)))
    places = {}
    for quantity, every in found.items():
        near = [each for each in every if table.columns[each[1].column].group in groups]
        alike = near or every
        first = [place for plain, place in alike if plain] or [place for _, place in alike]
        if len(first) > 1:
            names = [table.columns[place.column].name.strip(AROUND) for place in first]
            unique = len({_folded(name) for name in names}) == len(names)
            called = names[0] if unique else first[0].column + 1
            others = [
                f"{each}={table.columns[of[0][1].column].name.strip(AROUND)}"
                for each, of in found.items() if each != quantity and each in AXES
            ] if quantity not in AXES else []  # fmt: skip
            way = ",".join([f"{quantity}={called}", *others])
            raise ResultError(
                f"{table.name}: has two columns for {quantity}: {names[0]!r} and {names[1]!r}; "
                "name "
                f'those to be read, such as --columns "{way}"'
            )
        places[quantity] = first[0]
    return places


def _refuse_missing(
    table: Table,
    places: dict[str, _Place],
    missing: list[str],
    drive: str | None,
    wanted: Wanted,
) -> NoReturn:
    """Raise `ResultError` for a table that lacks columns, with ways to read it.

    `places` has the columns found, by quantity, and `missing` the quantities without a column.
    `drive` is the heading of the stage's column, if it is required.
    """
    used = {place.column for place in places.values()}
    others = [each.name for i, each in enumerate(table.columns) if i not in used]
    there = [f"{each}={table.columns[places[each].column].name}" for each in places if each in AXES]
    lacking = [each for each in missing if each != drive]
    ways = ['headings are such as "t [s]" and "x [um]"']
    if lacking and len(others) >= len(lacking):
        named = ",".join([*_others(table, lacking, used), *there])
        ways += [f'name others, such as --columns "{named}"']
    if missing == ["x"] == [*wanted.axes] and there:
        ways += [f'read it without: --columns "{",".join(there)}"']
    if missing == ["t"] and table.rate_beside:
        rate = table.rate_beside.rpartition(" ")[2]
        ways += [f'{table.rate_beside} is perhaps the rate of its rows: --rate "{rate} Hz"']
    elif missing == ["t"]:
        ways += ['give the rate of rows at even times: --rate "... Hz"']
    columns = " and ".join(f"no column {each}" for each in missing)
    raise ResultError(f"{table.name}: has {columns}{_there(table)}; {'; '.join(ways)}")


def _others(table: Table, lacking: list[str], used: Set[int]) -> Iterator[str]:
    """Yield an entry for --columns, such as "x=Channel 3", for each quantity that is `lacking`.

    A column is suggested by its numbers: times ascend, positions do not, and numbers that increase
    by 1 are frames. Columns with a unit of the quantity are preferred. Without a suitable column
    the entry is "x=...". `used` contains the numbers of the columns that are read already.
    """
    left = [index for index in range(len(table.columns)) if index not in used]

    def fits(index: int, quantity: str) -> bool:
        """Return whether the unit of a column belongs to a quantity."""
        column = table.columns[index]
        unit = understood(column.heading).unit or column.unit or column.heading.rpartition("[")[2]
        return is_unit(unit.rstrip("]"), quantity)

    for quantity in lacking:
        for index in sorted(left, key=lambda each: not fits(each, quantity)):
            with contextlib.suppress(ResultError):
                (numbers,) = table.numbers([index])
                steps = np.diff(numbers[np.isfinite(numbers)])
                ascends = len(steps) > 0 and bool((steps > 0).all())
                counts = ascends and bool((steps == 1).all())
                if len(steps) and ascends == (quantity == "t") and np.ptp(numbers):
                    name = table.columns[index].name.strip(AROUND)
                    yield f"{'frame' if counts else quantity}={name}"
                    left.remove(index)
                    break
        else:
            yield f"{quantity}=..."


def _there(table: Table) -> str:
    """Return " among ..." with the names of up to 10 columns, for messages; "" without names."""
    names = [short(column.name.strip(AROUND)) for column in table.columns]
    more = ", ..." if len(names) > _NAMES_TOLD else ""
    return f" among {', '.join(map(repr, names[:_NAMES_TOLD]))}{more}" if any(names) else ""


def short(text: str) -> str:
    """Return a text, shortened to 40 characters for a message."""
    return text if len(text) <= 40 else text[:37] + "..."


def _factor(
    table: Table, quantity: str, place: _Place, reading: Reading, wanted: Wanted
) -> tuple[float, str]:
    """Return the factor that converts a column to SI units or V, and that unit: "m", "V" or "s".

    Raises `ResultError` for unknown or contradictory units, and for pixels or volts that require
    --scale.
    """
    heading = short(table.columns[place.column].heading.strip(AROUND)) or quantity
    found: dict[tuple[float, str], str] = {}
    for unit in place.units:
        try:
            found[factor_of(unit, quantity)] = unit
        except ValueError as error:
            raise ResultError(f"{table.name}: {heading}: {short(unit)!r} {error}") from None
    if len(found) > 1:
        first, second, *_ = found.values()
        raise ResultError(f"{table.name}: {heading}: is in {first}, and in {second}")
    scale = reading.scale if quantity in AXES else None
    factor, unit = next(iter(found), (1.0, scale.of if scale else SI[quantity]))
    if scale is not None:
        if unit != scale.of:
            of = "pixels" if scale.of == PIXEL else "volts"
            raise ResultError(
                f"{table.name}: {heading}: is in {unit}, and --scale applies to positions in {of}; "
                "omit it"
            )
        return factor * scale.metres, "m"
    if unit == PIXEL:
        raise ResultError(
            f'{table.name}: {heading}: is in pixels; give the length of a pixel: --scale "... nm"'
        )
    if unit == "V" and not wanted.volts:
        raise ResultError(
            f'{table.name}: {heading}: is in volts; give the length of a volt: --scale "... um/V"'
        )
    return factor, unit


def _times(
    table: Table, reading: Reading, values: dict[str, Array], step: float | None
) -> tuple[Array, str]:
    """Return the times of the rows, (n,), s, and a note on them.

    They come from frame numbers and their rate, from the rate or `step` alone, or from a column of
    times. `values` has the numbers (n,) by quantity, and `step` is the sampling interval stated in
    the file, s.
    """
    rate = reading.rate if reading.rate is not None else step and 1 / step  # None without both
    if "frame" in values:
        frames = values["frame"]
        assert rate is not None
        if (frames[np.isfinite(frames)] % 1 != 0).any():
            raise ResultError(f"{table.name}: frame: must be whole numbers")
        return frames / rate, ""
    if "t" not in values:
        assert rate is not None
        return np.arange(len(next(iter(values.values())))) / rate, ""
    times = values["t"]
    if reading.rate is None:
        return times, ""
    return at_even_times(table.name, times, reading.rate)


def _said_by_times(
    table: Table, reading: Reading, wanted: Wanted, frames: Array, place: _Place
) -> str:
    """Compare the frames and their rate with a column of times, and return a note.

    The note is "" if they agree, or if the column `place` cannot be compared, for example because
    it contains dates. `frames` are the frame numbers (n,).
    """
    assert reading.rate is not None
    try:
        factor, _ = _factor(table, "t", place, reading, wanted)
        (times,) = table.numbers([place.column])
    except ResultError:
        return ""
    if len(times) != len(frames):
        return ""
    return of_frames(table.name, frames, factor * times, reading.rate)
