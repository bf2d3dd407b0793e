"""Emission: the same bytes each time, and stale, missing and orphan modules are caught."""

import ast
import re
import sys
from pathlib import Path

import pytest
import sympy as sp

from derivation import __main__ as command
from derivation import emission, printing
from derivation.lowering import Argument, Function, lower
from derivation.symbols import DRAG, MASS

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def files():
    return emission.emit()


@pytest.fixture
def folder(files, tmp_path):
    emission.write(files, tmp_path / "generated")
    return tmp_path / "generated"


def test_committed_modules_are_up_to_date(files):
    """Whatever the order of sets, which is that of hash seed 4711 in `make test`."""
    assert list(emission.differences(files, emission.GENERATED)) == []


def test_written_modules_are_up_to_date(files, folder):
    assert list(emission.differences(files, folder)) == []


def test_a_changed_module_is_caught(files, folder):
    changed = folder / "full_sphere.py"
    changed.write_text(changed.read_text().replace("force[0]", "force[1]", 1))
    (diff,) = emission.differences(files, folder)
    assert "--- generated/full_sphere.py" in diff


def test_a_missing_module_is_caught(files, folder):
    (folder / "ray.py").unlink()
    (diff,) = emission.differences(files, folder)
    assert "--- /dev/null" in diff
    assert "+++ emitted/ray.py" in diff


def test_an_orphan_is_caught_and_removed(files, folder):
    (folder / "full_cube.py").write_text("STATE = ()\n")
    (diff,) = emission.differences(files, folder)
    assert "--- generated/full_cube.py" in diff
    assert "+++ /dev/null" in diff
    emission.write(files, folder)
    assert not (folder / "full_cube.py").exists()


@pytest.mark.parametrize("name", ["extra/__init__.py", "old.json"])
def test_an_orphan_of_any_kind_is_caught(files, folder, name):
    (folder / name).parent.mkdir(exist_ok=True)
    (folder / name).write_text("{}\n")
    (diff,) = emission.differences(files, folder)
    assert f"--- generated/{name}" in diff


def test_other_line_ends_are_caught(files, folder):
    module = folder / "overdamped_translation.py"
    module.write_bytes(module.read_bytes().replace(b"\n", b"\r\n"))
    assert len(list(emission.differences(files, folder))) == 1


def test_command_tells_a_stale_module(files, folder, monkeypatch, capsys):
    """`python -m derivation --check` ends with 1 and a diff of what is stale; it writes nothing."""
    stale = folder / "overdamped_translation.py"
    text = stale.read_text()
    stale.write_text(text.replace("force[0]", "force[1]"))
    monkeypatch.setattr(command, "GENERATED", folder)
    monkeypatch.setattr(command, "emit", lambda: files)
    monkeypatch.setattr(sys, "argv", ["derivation", "--check"])
    assert command.main() == 1
    told = capsys.readouterr()
    added = re.findall(r"^\+(?!\+\+)(.*)", told.out, re.MULTILINE)
    assert added == [line for line in text.splitlines() if "force[0]" in line]
    assert f"1 of {len(files)} modules differ" in told.err
    assert stale.read_text() != text


def test_command_writes_every_module(files, tmp_path, monkeypatch, capsys):
    for name in files:
        (tmp_path / name).write_text("stale")
    monkeypatch.setattr(command, "GENERATED", tmp_path)
    monkeypatch.setattr(command, "emit", lambda: files)
    monkeypatch.setattr(sys, "argv", ["derivation"])
    assert command.main() == 0
    assert f"{len(files)} modules emitted, {len(files)} changed" in capsys.readouterr().err
    for path in emission.GENERATED.glob("*.py"):
        assert (tmp_path / path.name).read_bytes() == path.read_bytes()


def test_emitted_modules_import_math_and_numba_alone(files):
    for name, text in files.items():
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.Import):
                assert [alias.name for alias in node.names] == ["math"], name
            if isinstance(node, ast.ImportFrom):
                assert node.module == "numba", name


def test_emitted_modules_say_what_they_are(files):
    for name, text in files.items():
        if name == "__init__.py":
            continue
        docstring = ast.get_docstring(ast.parse(text))
        assert "Made by `python -m derivation`" in docstring
        assert "do not edit" in docstring
        (sources,) = re.findall(r"from (derivation/.*); do not edit", docstring)
        for source in sources.split(" and "):
            assert (ROOT / source).is_file()
        if name != "memory_poles.py":  # a table
            assert f"SymPy {sp.__version__}" in docstring
            # functions that are evaluated once are not compiled
            assert ("@njit(cache=True" in text) is (
                name not in {"water.py", "media.py", "spline.py", "heat.py", "chains.py"}
            )


def test_lowering_refuses_what_no_argument_supplies():
    function = Function(
        "f", "", (Argument("params", (MASS,), (1,)),), sp.Matrix([MASS.symbol + DRAG.symbol])
    )
    with pytest.raises(ValueError, match="no argument supplies beta_v"):
        lower(function)


def test_lowering_leaves_out_unused_inputs():
    function = Function(
        "f", "", (Argument("params", (MASS, DRAG), (2,)),), sp.Matrix([DRAG.symbol**2])
    )
    assert lower(function).inputs == (("beta_v", "params[1]"),)


x, y = sp.symbols("x y", positive=True)


@pytest.mark.parametrize(
    ("expression", "printed"),
    [
        (x**2, "x*x"),
        (x ** sp.Rational(-3, 2), "1.0/(x*math.sqrt(x))"),
        (sp.sqrt(x + y), "math.sqrt(x + y)"),
        (x / (3 * y), "(1.0/3.0)*x/y"),
        (2 * x - 1, "2.0*x - 1.0"),
    ],
)
def test_printer_avoids_general_powers(expression, printed):
    # compared as syntax trees: the formatter decides about parentheses
    assert ast.dump(ast.parse(printing.code(expression))) == ast.dump(ast.parse(printed))


@pytest.mark.parametrize("exponent", [sp.Rational(1, 3), sp.Symbol("n", positive=True), 20])
def test_printer_refuses_powers_it_has_no_cheap_form_for(exponent):
    with pytest.raises(NotImplementedError):
        printing.code(sp.Pow(x, exponent))
