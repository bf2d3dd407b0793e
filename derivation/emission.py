"""Emission of `generated/`: the same code writes the files or compares them with existing ones.

The bytes depend on the sources alone. They contain no dates, no paths and no hash order, and the
formatter runs as part of emission.
"""

from __future__ import annotations

import difflib
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

import jinja2
import sympy

from . import memory_poles, pair, wall, wall_coefficients
from .lowering import Argument, Function, lower
from .models import Module, catalogue
from .printing import code
from .symbols import Quantity

SOURCES = Path(__file__).parent
#: the committed output
GENERATED = SOURCES.parent / "generated"
_WIDTH = 100
#: sources of the table of poles
_POLES = ("memory_poles.py", "memory_poles.json")
#: sources of the mobilities beside a wall
_WALL = ("wall.py", "wall_coefficients.json")

_PACKAGE = '''"""Numba modules made by `python -m derivation`; do not edit.

One module a model and variant. They import math and numba only. `memory_poles` is a table.
"""
'''


def emit() -> dict[str, str]:
    """Return the text of every file of `generated/`, by name."""
    template = _environment().get_template("module.py.jinja")
    files = {"__init__.py": _PACKAGE}
    for module in catalogue():
        functions = [(function, lower(function)) for function in module.functions]
        text = template.render(
            module=module,
            functions=functions,
            inputs=list(_input_names(module)),
            sources=_sources(module.sources),
            sympy_version=sympy.__version__,
            operations=sum(block.operations for _, block in functions),
            temporaries=sum(len(block.temporaries) for _, block in functions),
        )
        if "math." not in text:
            text = text.replace("import math\n\n", "")
        files[f"{module.name}.py"] = _formatted(text)
    poles = _environment().get_template("memory_poles.py.jinja")
    text = poles.render(tables=memory_poles.load(), sources=_sources(_POLES))
    files["memory_poles.py"] = _formatted(text)
    beside = _environment().get_template("wall.py.jinja")
    text = beside.render(
        wall.tables(wall_coefficients.load()),
        sources=_sources(_WALL),
        sympy_version=sympy.__version__,
    )
    files["wall.py"] = _formatted(text)
    of_two = _environment().get_template("pair.py.jinja")
    text = of_two.render(
        pair.tables(), sources=_sources(("pair.py",)), sympy_version=sympy.__version__
    )
    files["pair.py"] = _formatted(text)
    return files


def _sources(names: Iterable[str]) -> str:
    return " and ".join(f"derivation/{name}" for name in names)


def differences(files: Mapping[str, str], folder: Path) -> Iterator[str]:
    """Yield a unified diff for every file that is missing or differs, or should not exist."""
    present = _present(folder)
    for name in sorted(present | set(files)):
        # bytes, so that line ends count; bytes that cannot be decoded appear as escapes
        old = (
            (folder / name).read_bytes().decode(errors="backslashreplace")
            if name in present
            else ""
        )
        new = files.get(name, "")
        if old != new:
            yield "".join(
                difflib.unified_diff(
                    old.splitlines(keepends=True),
                    new.splitlines(keepends=True),
                    f"{folder.name}/{name}" if name in present else "/dev/null",
                    f"emitted/{name}" if name in files else "/dev/null",
                )
            )


def write(files: Mapping[str, str], folder: Path) -> None:
    """Write every file into `folder`, and remove files that are no longer emitted."""
    folder.mkdir(exist_ok=True)
    for orphan in _present(folder) - set(files):
        (folder / orphan).unlink()
    for name, text in files.items():
        (folder / name).write_bytes(text.encode())


def _present(folder: Path) -> set[str]:
    """Return every file below `folder`, of any kind, without the caches of Python and Numba."""
    return {
        path.relative_to(folder).as_posix()
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }


def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(SOURCES / "templates"),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
    )
    environment.globals.update(
        code=code,
        names=_names,
        equation=_equation,
        signature=_signature,
        describe=_describe,
        result=_result,
        elements=_out_elements,
        horner=_horner,
        zip=zip,
    )
    return environment


def _horner(coefficients: list[str]) -> str:
    """Return a polynomial of x by Horner's rule, from its coefficients, the lowest power first."""
    *lower, text = coefficients
    for at, coefficient in enumerate(reversed(lower)):
        text = f"({text}) * x + {coefficient}" if at else f"{text} * x + {coefficient}"
    return text


def _formatted(text: str) -> str:
    command = [sys.executable, "-m", "ruff", "format", "--isolated", f"--line-length={_WIDTH}", "-"]
    return subprocess.run(command, input=text, capture_output=True, text=True, check=True).stdout


def _names(quantities: tuple[Quantity, ...]) -> str:
    return repr(tuple(quantity.name for quantity in quantities))


def _equation(quantity: Quantity) -> str:
    return f", ({quantity.equation})" if quantity.equation not in ("", "-") else ""


def _input_names(module: Module) -> Iterator[tuple[str, str]]:
    """Yield RHS_INPUTS and JACOBIAN_INPUTS: the arguments between `state` and `params`."""
    if module.state:
        functions = {function.name: function for function in module.functions}
        for name in ("rhs", "jacobian"):
            arguments = functions[name].arguments[2:-1] if name in functions else ()
            yield f"{name.upper()}_INPUTS", repr(tuple(argument.name for argument in arguments))


def _signature(function: Function) -> str:
    names = [argument.name for argument in function.arguments]
    return ", ".join(names if function.output_names else [*names, "out"])


def _describe(argument: Argument) -> str:
    first = argument.quantities[0]
    if not argument.shape:
        return f"{first.meaning} [{first.unit}]"
    names = ", ".join(quantity.name for quantity in argument.quantities)
    shape = ", ".join(str(length) for length in argument.shape)
    if len(argument.quantities) > 9:
        names = "as listed above"
    return f"({shape}) {names}"


def _result(function: Function) -> str:
    if function.output_names:
        return f"Returns {', '.join(function.output_names)}."
    shape = ", ".join(str(length) for length in _out_shape(function))
    return f"out: ({shape}) filled with the result."


def _out_shape(function: Function) -> tuple[int, ...]:
    rows, columns = function.outputs.shape
    return (rows,) if columns == 1 else (rows, columns)


def _out_elements(function: Function) -> tuple[str, ...]:
    return Argument("out", (), _out_shape(function)).elements
