"""Every emitted function as plain Python: out-of-range reads raise there, compiled they do not."""

import importlib
import math
from pathlib import Path

import numpy as np
import pytest

from derivation.models import catalogue
from tweezer.compiled import cache_functions

ROOT = Path(__file__).parents[2]
TABLES = {"memory_poles", "pair", "wall"}
#: arguments of water and of mixtures, in SI: any other number of theirs is no liquid
SIZES = {
    "T": 300.0, "rho": 1000.0, "wavelength": 1e-6, "refraction": 2e-4, "rho_w": 1000.0, "n_w": 1.33
}  # fmt: skip
#: all but the tables, which are of no equations of the catalogue
MODULES = sorted({path.stem for path in (ROOT / "generated").glob("[!_]*.py")} - TABLES)


def call_every_function(of=lambda function: function):
    """Call each with arrays of exactly the documented shapes; of: what to call of a function."""
    for module in catalogue():
        emitted = cache_functions(importlib.import_module(f"tweezer.generated.{module.name}"))
        for function in module.functions:
            arguments = [
                np.linspace(0.5, 0.4, math.prod(argument.shape)).reshape(argument.shape)
                if argument.shape
                else SIZES.get(argument.name, 0.4 + 0.001 * i)
                for i, argument in enumerate(function.arguments)
            ]
            if not function.output_names:
                rows, columns = function.outputs.shape
                out = np.full(rows if columns == 1 else (rows, columns), np.nan)
                arguments.append(out)
            result = of(getattr(emitted, function.name))(*arguments)
            filled = result if function.output_names else out
            assert np.isfinite(filled).all(), (module.name, function.name)


def test_no_emitted_function_reads_out_of_range():
    call_every_function(of=lambda function: getattr(function, "py_func", function))


def test_compiled_functions_fill_all_of_their_output():
    call_every_function()


@pytest.mark.parametrize("name", MODULES)
def test_emitted_data_match_the_catalogue(name):
    (module,) = (module for module in catalogue() if module.name == name)
    emitted = importlib.import_module(f"tweezer.generated.{module.name}")
    if module.state:
        assert tuple(quantity.name for quantity in module.state) == emitted.STATE
        assert tuple(quantity.name for quantity in module.params) == emitted.PARAMS
