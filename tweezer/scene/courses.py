"""Sections of a scene for a beam's motion, and for the course of its power and its phase."""

from __future__ import annotations

import csv
import itertools
import math
from collections.abc import Mapping
from io import StringIO
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from tweezer.values.errors import FrozenError
from tweezer.values.files import read_text
from tweezer.values.units import (
    Angle,
    Frequency,
    Length,
    PositiveLength,
    PositiveTime,
    Quantity,
    Speed,
    Time,
    entries,
)

Vector = Annotated[tuple[Length, Length, Length], entries(3)]
Velocity = Annotated[tuple[Speed, Speed, Speed], entries(3)]
Times = Annotated[tuple[Time, ...], entries(1, 100_000)]
Places = Annotated[tuple[Vector, ...], entries(1, 100_000)]
Factor = Annotated[float, Quantity("", 0, 1e6)]
Phases = Annotated[tuple[Angle, ...], entries(1, 100_000)]
Factors = Annotated[tuple[Factor, ...], entries(1, 100_000)]

#: Pattern of a name
NAME = r"^\w[^/\\\x00-\x1f\x7f]{0,99}$"


class Section(BaseModel):
    """Base of a section of a scene: immutable, and without unknown keys."""

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)

    def __setattr__(self, name: str, value: Any) -> None:
        """Raise `FrozenError`: a scene is changed by `replace`, not in place."""
        if not name.startswith("_"):
            raise FrozenError(
                f"{name}: a scene is not changed in place; use scene.replace(...), such as "
                'scene.replace(bead={"diameter": "2 um"})'
            )
        super().__setattr__(name, value)


def refusal(reason: str) -> PydanticCustomError:
    """Return the Pydantic error of a scene for a reason, in one line."""
    return PydanticCustomError("scene", "{reason}", {"reason": reason})


class _Course(Section):
    """Base of a course of a position, a power or a phase in time: its kind, and its keys."""

    kind: str

    @property
    def last_change(self) -> float:
        """Time after which nothing changes, s; infinite if changes never end."""
        if getattr(self, "period", None) is not None:
            return math.inf
        times, end = getattr(self, "times", None), getattr(self, "end", None)
        return times[-1] if times else math.inf if end is None else end

    @model_validator(mode="after")
    def _keys_of_the_kind(self) -> Self:
        """Refuse keys that do not belong to the kind of course, and missing required keys."""
        needed, possible = _KEYS[type(self).__name__][self.kind]
        for key in type(self).model_fields:
            if key == "kind":
                continue
            given = getattr(self, key) is not None
            if given and key not in (*needed, *possible):
                raise refusal(f"{key}: does not apply to kind = {self.kind!r}; remove it")
            if not given and key in needed:
                raise refusal(f"{key}: missing; kind = {self.kind!r} requires it")
        return self

    @model_validator(mode="after")
    def _sound(self) -> Self:
        """Refuse times that do not ascend, times and values that differ in number, and ends out of
        order.
        """
        key, _ = _COLUMNS[type(self).__name__.lower()]
        keys = "times", key, "period", "begin", "end"
        times, values, period, begin, end = (getattr(self, each) for each in keys)
        if times is not None:
            if len(times) != len(values):
                raise refusal(f"{key}: has {len(values)} entries; must have as many as times")
            if any(b < a for a, b in itertools.pairwise(times)):
                raise refusal("times: must ascend")
            if period is not None and period < times[-1]:
                last = f"at least the last time, {times[-1]:g} s"
                raise refusal(f"period = {period:g} s: must be {last}")
        if end is not None and end <= (begin or 0.0):
            raise refusal(f"end = {end:g}: must be later than begin")
        return self


#: Keys that each kind requires, and keys that it may have
_KEYS: dict[str, dict[str, tuple[tuple[str, ...], tuple[str, ...]]]] = {
    "Motion": {
        "sine": (("amplitude", "frequency"), ("phase",)),
        "circle": (("radius", "frequency"), ("phase",)),
        "ramp": (("velocity",), ("begin", "end")),
        "steps": (("times", "positions"), ("period",)),
        "table": (("times", "positions"), ("period",)),
    },
    "Phasing": {
        "sine": (("amplitude", "frequency"), ("phase",)),
        "ramp": (("rate",), ("begin", "end")),
        "steps": (("times", "phases"), ("period",)),
        "table": (("times", "phases"), ("period",)),
    },
    "Modulation": {
        "sine": (("depth", "frequency"), ("phase",)),
        "ramp": (("factor", "end"), ("begin",)),
        "steps": (("times", "factors"), ("period",)),
        "on-off": (("frequency",), ("duty", "phase")),
        "table": (("times", "factors"), ("period",)),
    },
}


class Motion(_Course):
    """Motion of a beam in time, relative to its `position`."""

    kind: Literal["sine", "circle", "ramp", "steps", "table"] = Field(
        description="sine: amplitude sin(2 pi frequency t + phase); circle: x = radius cos(2 pi "
        "frequency t + phase), y = radius sin(2 pi frequency t + phase); ramp: at `velocity` from "
        "`begin` to `end`; steps: a jump to each of `positions` at its time, from 0 before the "
        "first; table: linear interpolation between `positions`, also from a CSV `file`"
    )
    amplitude: Vector | None = Field(None, description="amplitude of a sine")
    radius: PositiveLength | None = Field(None, description="radius of a circle")
    frequency: Frequency | None = Field(None, description="frequency of a sine or a circle")
    phase: Angle | None = Field(None, description="phase of a sine or a circle. Default: 0")
    velocity: Velocity | None = Field(None, description="velocity of a ramp")
    begin: Time | None = Field(None, description="time at which a ramp begins. Default: 0")
    end: Time | None = Field(None, description="time at which a ramp ends. Default: never")
    times: Times | None = Field(None, description="ascending times of steps or a table")
    positions: Places | None = Field(
        None, description="displacements from the beam's position at these times"
    )
    period: PositiveTime | None = Field(
        None,
        description="period after which steps or a table repeat. Default: no repetition",
    )

    @property
    def along_light(self) -> bool:
        """Whether the focus moves along z, the axis of the light, at any time."""
        ways = (self.amplitude, self.velocity, *(self.positions or ()))
        return any(way is not None and way[2] != 0 for way in ways)


class Modulation(_Course):
    """Factor of a beam's power in time."""

    kind: Literal["sine", "ramp", "steps", "on-off", "table"] = Field(
        description="sine: 1 + depth sin(2 pi frequency t + phase); ramp: from 1 at `begin` to "
        "`factor` at `end`; steps: a jump to each of `factors` at its time, from 1 before the "
        "first; on-off: on while frequency t + phase/(2 pi) is less than `duty` above a whole "
        "number; table: linear interpolation between `factors`, also from a CSV `file`"
    )
    depth: Annotated[float, Quantity("", 0, 1)] | None = Field(
        None, description="modulation depth of a sine"
    )
    frequency: Frequency | None = Field(None, description="frequency of a sine or of on-off")
    phase: Angle | None = Field(None, description="phase of a sine or of on-off. Default: 0")
    factor: Factor | None = Field(None, description="factor at the end of a ramp")
    begin: Time | None = Field(None, description="time at which a ramp begins. Default: 0")
    end: Time | None = Field(None, description="time at which a ramp ends")
    duty: Annotated[float, Quantity("", 1e-6, 1)] | None = Field(
        None, description="fraction of a period with light. Default: 0.5"
    )
    times: Times | None = Field(None, description="ascending times of steps or a table")
    factors: Factors | None = Field(None, description="factors of the power at these times")
    period: PositiveTime | None = Field(
        None,
        description="period after which steps or a table repeat. Default: no repetition",
    )


class Phasing(_Course):
    """Phase of a coherent beam in time."""

    kind: Literal["sine", "ramp", "steps", "table"] = Field(
        description="sine: amplitude sin(2 pi frequency t + phase); ramp: 2 pi rate t from `begin` "
        "to `end`, as from two beams whose frequencies differ by `rate`; steps: a jump to each of "
        "`phases` at its time, from 0 before the first; table: linear interpolation between "
        "`phases`, also from a CSV `file`"
    )
    amplitude: Angle | None = Field(None, description="amplitude of a sine")
    frequency: Frequency | None = Field(None, description="frequency of a sine")
    phase: Angle | None = Field(None, description="phase of a sine. Default: 0")
    rate: Annotated[float, Quantity("1/s", -1e9, 1e9)] | None = Field(
        None, description="periods of the phase per time of a ramp; may be negative"
    )
    begin: Time | None = Field(None, description="time at which a ramp begins. Default: 0")
    end: Time | None = Field(None, description="time at which a ramp ends. Default: never")
    times: Times | None = Field(None, description="ascending times of steps or a table")
    phases: Phases | None = Field(None, description="phases at these times")
    period: PositiveTime | None = Field(
        None,
        description="period after which steps or a table repeat. Default: no repetition",
    )


#: Key of the values that follow the time in each row of a file, and their number
_COLUMNS = {"motion": ("positions", 3), "modulation": ("factors", 1), "phasing": ("phases", 1)}


def with_tables(data: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return the data of a scene with the tables from files that its beams name.

    File names are relative to `folder`; masks and the bead's mesh and T-matrix are named by the
    whole path. A
    row of the CSV file has a time, s, and then x, y, z, m,
    or a factor. The first row may be a heading. Raises `ValueError` for an invalid file.
    """
    found = {
        key: _with_tables_of(key, value, folder) if key.partition("[")[0] == "beam" else value
        for key, value in data.items()
    }
    bead = found.get("bead")
    if isinstance(bead, Mapping):
        named = {key: bead[key] for key in ("file", "t_matrix") if isinstance(bead.get(key), str)}
        found["bead"] = {**bead, **{
            key: str((folder / file).absolute()) for key, file in named.items()
        }}  # fmt: skip
    return found


def _with_tables_of(name: str, beam: Any, folder: Path) -> Any:
    """Return the data of a beam, or of a list of beams, with the tables in its files."""
    if isinstance(beam, list | tuple):
        named = enumerate(beam, start=1)
        return [_with_tables_of(f"{name}[{i}]", each, folder) for i, each in named]
    if not isinstance(beam, Mapping):
        return beam
    beam = dict(beam)
    if isinstance(beam.get("mask"), str) and beam["mask"]:
        beam["mask"] = str((folder / beam["mask"]).absolute())
    for section, (key, columns) in _COLUMNS.items():
        course = beam.get(section)
        if isinstance(course, Mapping) and isinstance(course.get("file"), str):
            course = dict(course)
            if "times" in course or key in course:
                raise ValueError(f"{name}.{section}: give either file, or times and {key}")
            rows = _rows(folder / course.pop("file"), columns + 1)
            values = [row[1:] if columns > 1 else row[1] for row in rows]
            beam[section] = {**course, "times": [row[0] for row in rows], key: values}
    return beam


def _rows(path: Path, columns: int) -> list[list[float]]:
    """Return the rows of numbers in a CSV file, without its heading.

    `columns` is the number of values that each row must have.
    """
    try:
        lines = [line for line in csv.reader(StringIO(read_text(path), newline="")) if line]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or error
        raise ValueError(f"{path}: cannot be read: {reason}") from None
    rows = []
    for number, line in enumerate(lines, start=1):
        try:
            row = [float(each) for each in line]
        except ValueError:
            if number == 1:  # headings
                continue
            raise ValueError(f"{path}, row {number}: must be numbers") from None
        if len(row) != columns:
            raise ValueError(f"{path}, row {number}: must have {columns} numbers")
        rows.append(row)
    return rows
