"""A user's function as plain Python, to try it before compilation and to explain later errors.

A copy of the function is run, in which compiled helpers are replaced by plain Python functions and
arrays that it must not change are read-only. NumPy then checks every index. Floating-point errors
give the same values as in compiled code, infinity or NaN.
"""

from __future__ import annotations

import dis
import functools
import linecache
import math
import re
import sys
import traceback
from collections.abc import Callable, Iterator
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np
from numba import jit
from numba.core.dispatcher import Dispatcher
from numba.core.errors import NumbaError

from tweezer.forces.data import Data
from tweezer.forces.entries import READERS
from tweezer.forces.force import Pose, Wrench, no_wrench
from tweezer.values.arrays import Array
from tweezer.values.errors import ForceError

#: Attributes that read or write memory without a check of the index once compiled
_UNCHECKED = ("flat", "as_strided", "carray", "farray")
#: Numbers that fill a wrench before a trial, in units of the largest number that the function adds
_FILLED = 1e4
#: Smallest relative change of these numbers by a function that sets the wrench instead of adding
_ADDED = 1e-2
#: Relative difference by which the force on a bead may depend on the other beads
_SAME = 1e-9
#: Largest number of lines that a call may run: a second of plain Python, traced
_MOST_LINES = 10**7
#: Modules whose lines do not count: those of libraries
_LIBRARIES = ("tweezer", "numba", "numpy")
#: Exceptions that do not depend on the pose
_DEFINITE = (IndexError, NameError)
#: Names of entries by the number of their axes
_KINDS = ("a number", "an array of 1 axis", "an array of 2 axes", "an array of 3 axes")
#: The functions of NumPy that have another name than that of `math`
_NUMPY = {
    "acos": "arccos", "asin": "arcsin", "atanh": "arctanh", "acosh": "arccosh", "pow": "power",
}  # fmt: skip


#: What Numba says of `x -= 1` where x is read-only
_IN_PLACE = "'NoneType' object has no attribute 'args'"


class _MisreadError(IndexError):
    """Error of a function that reads an entry that does not exist, or by the wrong reader."""


class _EndlessError(BaseException):
    """Error of a function that runs too many lines, which it cannot catch as an `Exception`."""


def checked(function: Any) -> Any:
    """Return a user's compiled function as a copy that checks indices and the kinds of entries.

    The user's functions that it calls are replaced by such copies too. Raises `ForceError` for a
    use of memory that cannot be checked.
    """

    def replace(each: Any, copy: Callable[[Any], Any]) -> Any:
        """Return a compiled function with checks: a reader that checks, or a checked copy."""
        for reader, without in READERS.values():
            if each in (reader, without):
                return reader
        if _is_library(each.py_func):
            return each
        return jit(**{**each.targetoptions, "boundscheck": True})(copy(each.py_func))

    for name in _names(function.py_func.__code__):
        if name in _UNCHECKED:
            raise ForceError(
                f"forces: {function.__name__}: uses {name}, whose indices cannot be checked; "
                "index the array by its axes"
            )
    options = {
        **function.targetoptions, "boundscheck": True, "error_model": "python",
        "nogil": True, "no_cpython_wrapper": True, "no_cfunc_wrapper": True,
    }  # fmt: skip
    return jit(**options)(_Copies(replace)(function.py_func))


@functools.cache
def plain(function: Any) -> Any:
    """Return a user's compiled function, and all functions that it calls, as plain Python."""

    def replace(each: Any, copy: Callable[[Any], Any]) -> Any:
        """Return a compiled function as plain Python: a reader that checks, or a copy."""
        for axes, (name, readers) in enumerate(READERS.items()):
            if each in readers:
                return functools.partial(_read, name, readers[1].py_func, axes)
        return copy(each.py_func)

    return _Copies(replace, _mathematics())(function.py_func)


class _Copies:
    """Maker of copies of functions, in which the functions that they call are replaced.

    `replace(each, self)` returns the replacement of a function `each` that is compiled by Numba;
    `also` maps further objects, such as functions of `math`, to theirs. The globals, closures and
    modules of the originals remain as they are.
    """

    def __init__(
        self,
        replace: Callable[[Any, Callable[[Any], Any]], Any],
        also: dict[Any, Any] | None = None,
    ) -> None:
        self._replace, self._also = replace, also or {}
        self._made: dict[Any, Any] = {}

    def __call__(self, function: Any) -> Any:
        """Return the copy of a function, with replaced globals and closure; made once for each."""
        if function in self._made:
            return self._made[function]
        names = set(_names(function.__code__))
        everything = dict(function.__globals__)
        cells = function.__closure__ or ()
        closure = tuple(type(cell)(cell.cell_contents) for cell in cells)
        copy = FunctionType(
            function.__code__, everything, function.__name__, function.__defaults__, closure
        )
        copy.__kwdefaults__, copy.__module__ = function.__kwdefaults__, function.__module__
        copy.__qualname__ = function.__qualname__
        self._made[function] = copy
        for name in names & everything.keys():
            everything[name] = self._replaced(everything[name], names)
        for cell in closure:
            cell.cell_contents = self._replaced(cell.cell_contents, names)
        return copy

    def _replaced(self, value: Any, names: set[str]) -> Any:
        """Return the replacement of a global or a cell, or the value itself if it has none.

        names: all names that the function uses, among them attributes of modules. A module with
        compiled functions among these is replaced by a copy.
        """
        if isinstance(value, Dispatcher):
            if value not in self._made:
                self._made[value] = self._replace(value, self)
            return self._made[value]
        if isinstance(value, BuiltinFunctionType | ModuleType) and value in self._also:
            return self._also[value]
        if isinstance(value, ModuleType):
            inside = vars(value)
            compiled = [each for each in names if isinstance(inside.get(each), Dispatcher)]
            if compiled:
                module = ModuleType(value.__name__)
                vars(module).update(inside)
                for each in compiled:
                    setattr(module, each, self._replaced(inside[each], names))
                return module
        return value


def _names(code: CodeType) -> Iterator[str]:
    """Yield the global names and attributes that a function and the functions within it use."""
    yield from code.co_names
    for each in code.co_consts:
        if isinstance(each, CodeType):
            yield from _names(each)


def _is_library(function: Any) -> bool:
    """Return whether a function belongs to tweezer, Numba or NumPy, and not to the user."""
    return str(function.__module__).partition(".")[0] in _LIBRARIES


def _read(name: str, read: Any, axes: int, data: Data, entry: Any) -> Any:
    """Return an entry of a force's data, in plain Python; raise `_MisreadError` for a wrong one.

    `name` is the name of the reader, for messages, and `read` its function. It reads entries with
    `axes` axes. `entry` is the number of the entry that the user's function passes.
    """
    many = len(data.shapes)
    if isinstance(entry, bool) or not isinstance(entry, int | np.integer):
        raise _MisreadError(f"{name}(data, {entry!r}): the number of an entry is a whole number")
    if not 0 <= entry < many:
        allowed = f"allowed: 0 to {many - 1}" if many else "it has none"
        raise _MisreadError(
            f"{name}(data, {entry}): the force has {many} {'entry' if many == 1 else 'entries'}; "
            f"{allowed}"
        )
    found = int(data.shapes[entry, -1])
    if found != axes:
        reader = list(READERS)[found]
        raise _MisreadError(
            f"{name}(data, {entry}): entry {entry} is {_KINDS[found]}; read it by "
            f"{reader}(data, {entry})"
        )
    return read(data, entry)


def _as_compiled(function: Any) -> Any:
    """Return a function of `math` that raises nothing: infinity or NaN, as in compiled code."""
    name = function.__name__
    other = getattr(np, _NUMPY.get(name, name), None)

    def within(*arguments: Any) -> Any:
        """Return the value of the function, or NumPy's for arguments at which it raises."""
        try:
            return function(*arguments)
        except (ValueError, ArithmeticError):
            return math.nan if other is None else other(*arguments)

    return within


@functools.cache
def _mathematics() -> dict[Any, Any]:
    """Return replacements of `math` and of its functions, which raise nothing, by the originals."""
    module = ModuleType("math")
    found: dict[Any, Any] = {math: module}
    for name, each in vars(math).items():
        is_function = isinstance(each, BuiltinFunctionType)
        setattr(module, name, _as_compiled(each) if is_function else each)
        if is_function:
            found[each] = getattr(module, name)
    return found


def first_look(function: Any, data: Data, *, gradient: bool, turns: bool) -> str:
    """Run a user's function for one bead and for three; refuse it if it fails at every pose.

    Parameters
    ----------
    function : callable
        Function of a `UserForce`.
    data : Data
        Entries of the force.
    gradient : bool
        Whether the function sets force gradients.
    turns : bool
        Whether the force exerts a torque.

    Returns
    -------
    str
        Description of an exception that may depend on the pose, or "".

    Raises
    ------
    ForceError
        With the name of the function, the problem and the line.
    """
    found: list[Wrench] = []
    each = _some_pose(3, turns=turns)
    alone = [Pose(*(values[i : i + 1] for values in each)) for i in range(3)]
    for gradients in {False, gradient}:
        for pose in (each, *alone):
            wrench = no_wrench(len(pose.time), gradient=gradients)
            try:
                _run(function, data, pose, wrench)
            except _EndlessError as error:
                raise ForceError(_told(function, error)) from None
            except Exception as error:
                if isinstance(error, _DEFINITE) or _of_shapes(error):
                    raise ForceError(_told(function, error)) from None
                return _told(function, error)
            if not all(np.isfinite(values).all() for values in wrench):
                return ""
            found.append(wrench)
        filled = Wrench(*(
            np.full_like(values, _FILLED * np.abs(values).max(initial=0.0) or 1.0)
            for values in found[-4]
        ))  # fmt: skip
        before = Wrench(*(values.copy() for values in filled))
        line = _first_line(function, data, each, filled, functools.partial(_is_set, before))
        if line is not None:
            raise ForceError(
                f"{_place(function, line)}: sets the wrench, which contains the other forces; "
                "add to it with +="
            )
    together, *singly = found[:4]
    for i, one in enumerate(singly):
        if not alike(together.force[i], one.force[0]):
            raise ForceError(
                f"forces: {function.__name__}: the force on a bead depends on how many beads there "
                "are; add to every row of wrench.force, and compute nothing at random"
            )
    return ""


def alike(one: Array, other: Array) -> bool:
    """Return whether two forces are equal within rounding."""
    return bool(np.abs(one - other).max() <= _SAME * max(np.abs(one).max(), np.abs(other).max()))


def _is_set(before: Wrench, now: Wrench) -> bool:
    """Return whether a function has set a filled wrench instead of adding to it.

    The wrench was filled with numbers that are large compared with the force of the function.
    """
    return any(
        (np.abs(values - first) > _ADDED * np.abs(first)).any()
        for values, first in zip(now, before, strict=True)
    )


def _some_pose(n: int, *, turns: bool) -> Pose:
    """Return n beads at random within about 0.1 um; with `turns` also at random orientations."""
    rng = np.random.default_rng(n)
    orientation = rng.normal(size=(n if turns else 0, 4))
    orientation /= np.linalg.norm(orientation, axis=1, keepdims=True)
    return Pose(np.full(n, 1e-4), rng.normal(size=(n, 3)) * 1e-7, orientation, np.zeros((0, 3)))


def _run(
    function: Any,
    data: Data,
    pose: Pose,
    wrench: Wrench,
    before_line: Callable[[int], None] | None = None,
) -> None:
    """Add the force to `wrench` in plain Python, with read-only arguments.

    `before_line` is called with the number of each line of the function, before the line is run.
    Raises `_EndlessError` after `_MOST_LINES`, counted in the function and its helpers.
    """
    # `sys.settrace` calls `tracing` for each function, and what that returns for each of its lines
    shut = Pose(*(_shut(each) for each in pose)), Data(*(_shut(each) for each in data))
    code, before, left = function.py_func.__code__, sys.gettrace(), _MOST_LINES

    def counting(frame: Any, event: str, value: Any) -> Any:  # noqa: ARG001
        """Count a line that is run, and end a function that runs too many."""
        nonlocal left
        left -= 1
        if left < 0:
            raise _EndlessError
        return counting

    def telling(frame: Any, event: str, value: Any) -> Any:
        """Call `before_line` with the number of a line, and count it."""
        assert before_line is not None
        before_line(frame.f_lineno)
        counting(frame, event, value)
        return telling

    def tracing(frame: Any, event: str, value: Any) -> Any:  # noqa: ARG001
        """Return what is called for each line of a function that begins; None in a library."""
        if str(frame.f_globals.get("__name__")).partition(".")[0] in _LIBRARIES:
            return None
        frame.f_trace_opcodes = _has_empty_loop(frame.f_code)
        return telling if before_line is not None and frame.f_code is code else counting

    within = plain(function)
    sys.settrace(tracing)
    try:
        with np.errstate(all="ignore"):
            within(*shut, wrench)
    finally:
        sys.settrace(before)


@functools.cache
def _has_empty_loop(code: CodeType) -> bool:
    """Return whether an instruction leads to itself, as in `while True: pass`, without a trace."""
    return any(
        each.opname.startswith("JUMP") and each.argval == each.offset
        for each in dis.get_instructions(code)
    )


def _shut(values: Any) -> Any:
    """Return a read-only view of an array."""
    values = values.view()
    values.flags.writeable = False
    return values


def _of_shapes(error: Exception) -> bool:
    """Return whether an error comes from arrays of wrong shapes, or that are read-only."""
    said = str(error)
    return isinstance(error, ValueError) and any(
        each in said for each in ("broadcast", "read-only", "unpack", "shape")
    )


def explained(function: Any, data: Data, pose: Pose, *, gradient: bool, wrong_error: bool) -> str:
    """Return a description of the error in a function at a pose, with its line.

    Parameters
    ----------
    function, data, gradient
        As in `first_look`.
    pose : Pose
        Pose of one bead.
    wrong_error : bool
        Whether the error of the force, and not the force, is NaN or negative.
    """
    wrench = no_wrench(1, gradient=gradient)

    def is_wrong(now: Wrench) -> bool:
        """Return whether the wrench has become invalid, in the way that is to be explained."""
        if wrong_error:
            return not (np.isfinite(now.error).all() and now.error.min() >= 0)
        return not all(np.isfinite(values).all() for values in now[:4])

    x, y, z = pose.position[0]
    there = f"at the time {pose.time[0]:.6g} s and the place ({x:.4g}, {y:.4g}, {z:.4g}) m"
    try:
        line = _first_line(function, data, pose, wrench, is_wrong)
    except Exception as error:
        return f"{_told(function, error)}, {there}"
    where = f"forces: {function.__name__}" if line is None else _place(function, line)
    if wrong_error:
        return f"{where}: the error of the force must be finite and not negative, {there}"
    return f"{where}: the force is not finite, {there}"


def _first_line(
    function: Any,
    data: Data,
    pose: Pose,
    wrench: Wrench,
    is_wrong: Callable[[Wrench], bool],
) -> int | None:
    """Run a function, and return the number of the first line after which its wrench is wrong.

    `is_wrong` returns whether a wrench is wrong. The result is the number of a line, or None for a
    wrench that is never wrong.
    """
    line, found = 0, None

    def look(next_line: int) -> None:
        """Note the line before `next_line` if the wrench is wrong for the first time."""
        nonlocal line, found
        if found is None and line and is_wrong(wrench):
            found = line
        line = next_line

    _run(function, data, pose, wrench, look)
    return found


def _place(function: Any, line: int) -> str:
    """Return the name of a function with the number and text of a line, for messages."""
    source = linecache.getline(function.py_func.__code__.co_filename, line).strip()
    return f"forces: {function.__name__}, line {line}" + (f", `{source}`" if source else "")


def _told(function: Any, error: BaseException) -> str:
    """Return a message for an exception that a function raised, in one line, with its line number.

    For common mistakes it says what to do instead.
    """
    code = function.py_func.__code__
    line = code.co_firstlineno
    for frame, number in traceback.walk_tb(error.__traceback__):
        if frame.f_code.co_filename == code.co_filename and number is not None:
            line = number
    said = " ".join(str(error).split())
    where = _place(function, line)
    if isinstance(error, _EndlessError):
        return (
            f"{where}: does not end within {_MOST_LINES:,} lines of plain Python; allowed: loops "
            "that end at every position and time; limit the number of their rounds"
        )
    if "read-only" in said:
        return f"{where}: writes to the pose or to an entry; change a copy of it"
    if isinstance(error, _MisreadError | NameError):
        return f"{where}: {said}"
    hint = ""
    if isinstance(error, IndexError) and "size 0" in said:
        if "gradient" in where:
            hint = "; it is empty unless gradients are computed: test its length"
        elif "orientation" in where:
            hint = "; it is empty without turns=True"
    return f"{where}: raises {type(error).__name__}: {said}{hint}"


def refused(function: Any, error: Exception) -> ForceError:
    """Return a `ForceError` for a function that Numba cannot compile, from Numba's error."""
    said = re.sub(r"\x1b\[[0-9;]*m", "", str(error))
    if "readonly array" in said or "read-only" in said or said == _IN_PLACE:
        problem = "writes to the pose or to an entry; change a copy of it"
    else:
        lines = [each.strip() for each in said.splitlines() if each.strip()]
        useful = [each for each in lines if not each.startswith(("Failed in", "- ", ">>>"))]
        problem = f"Numba cannot compile it: {(useful or lines or [type(error).__name__])[0]}"
    found = re.search(r'File "[^"]*", line (\d+)', said)
    located = getattr(getattr(error, "loc", None), "line", None)
    line = int(found.group(1)) if found else located
    code = function.py_func.__code__
    return ForceError(f"{_place(function, line or code.co_firstlineno)}: {problem}")


COMPILING = (NumbaError, AttributeError, TypeError, ValueError, AssertionError, NotImplementedError)
"""what Numba raises for a function that it cannot compile"""
