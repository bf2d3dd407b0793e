"""Emitted code against the expressions before common subexpressions, at 50 digits."""

import importlib
import re
from pathlib import Path

import mpmath
import numpy as np
import pytest
import sympy as sp

from derivation.models import catalogue
from tweezer.compiled import cache_functions

GENERATED = Path(__file__).parents[2] / "generated"
#: they call `rhs` and `jacobian`, and do nothing else
ALIKE = {"rates", "derivatives"}
#: series: `tests/fluid` compares them with sums of 30 digits, and the other functions of `pair`
SERIES = {"pair", "wall"}
FUNCTIONS = [
    (path.stem, name)
    for path in sorted(GENERATED.glob("[!_]*.py"))
    for name in re.findall(r"^def (\w+)", path.read_text(), re.MULTILINE)
    if name not in ALIKE and path.stem not in SERIES
]
DIGITS = 50
MOST_INDEX_RATIO = 1.6
TOLERANCE = 1e-14
#: dX and dY pass through zero at nearby angles, where their terms are some hundred times their sum;
#: they enter the derivative of the force beside dQ_sc, which is larger
TOLERANCES = {"split_rates": 1e-12}

#: arguments that are numbers of water and its mixtures, in SI
RANGES = {
    "T": (273.15, 373.12), "rho": (950.0, 1000.0), "wavelength": (0.2e-6, 1.1e-6),
    "refraction": (1e-4, 3e-4), "rho_w": (950.0, 1000.0), "n_w": (1.32, 1.34),
}  # fmt: skip


def emitted_module(name):
    """As the runtime has it, which keeps what is compiled."""
    return cache_functions(importlib.import_module(f"tweezer.generated.{name}"))


def random_arguments(function, rng, i):
    """Values for each argument; angles of incidence up to near grazing."""
    values = []
    for argument in function.arguments:
        if argument.name == "S":
            values.append(float(rng.uniform(0, 1) if i % 3 else 1 - 10 ** rng.uniform(-8, -1)))
        elif argument.name in RANGES:
            values.append(float(rng.uniform(*RANGES[argument.name])))
        elif argument.name == "n_mP":
            values.append(float(rng.uniform(0.4, 1.0 if i % 2 else MOST_INDEX_RATIO)))
            if values[-1] > 1:
                # below total reflection
                values[0] *= (1 - 1e-3) / values[-1] ** 2
        elif argument.shape:
            positive = argument.name == "params"
            size = argument.shape
            values.append(rng.uniform(0.3, 2.0, size) if positive else rng.normal(size=size))
            if argument.name == "mobility":
                # a positive matrix: b_roll^2 < b_parallel b_turn
                values[-1] = rng.uniform(0.3, 2.0, size) * [1, 1, 1, 1, 0.1]
        else:
            values.append(float(rng.uniform(0.2, 0.9)))
    return values


def condition(function, arguments):
    """Rounding of an input by 1 part is this many parts of cos^2(beta) = 1 - n_mP^2 S.

    1 for a bead of higher index, where the code has it as a sum; a difference otherwise.
    """
    named = dict(zip((argument.name for argument in function.arguments), arguments, strict=True))
    if named.get("n_mP", 0.0) <= 1:
        return 1.0
    return 1 / (1 - named["n_mP"] ** 2 * named["S"])


def exact(function):
    """The outputs as a function of all symbols, in mpmath: intermediates one after the other."""
    known = [q.symbol for argument in function.arguments for q in argument.quantities]
    needed = set().union(*(output.free_symbols for output in function.outputs))
    intermediates = []
    for quantity, expression in reversed(function.intermediates):
        if quantity.symbol in needed:
            intermediates.insert(0, (quantity.symbol, expression))
            needed |= expression.free_symbols
    steps = []
    for symbol, expression in intermediates:
        steps.append(sp.lambdify(known, expression, "mpmath", cse=False))
        known = [*known, symbol]
    outputs = sp.lambdify(known, list(function.outputs), "mpmath", cse=False)

    def evaluated(flat):
        values = [mpmath.mpf(value) for value in flat]
        for step in steps:
            values.append(step(*values))
        return [mpmath.mpf(value) for value in outputs(*values)]

    return evaluated


@pytest.mark.parametrize(("module_name", "name"), FUNCTIONS)
def test_against_50_digits(module_name, name):
    (module,) = (module for module in catalogue() if module.name == module_name)
    (function,) = (function for function in module.functions if function.name == name)
    emitted = getattr(emitted_module(module_name), name)
    reference, rng = exact(function), np.random.default_rng(30)
    worst = 0.0
    with mpmath.workdps(DIGITS):
        for i in range(200 if module_name == "ray" else 6):
            arguments = random_arguments(function, rng, i)
            if function.output_names:
                result = np.atleast_1d(emitted(*arguments))
            else:
                rows, columns = function.outputs.shape
                result = np.empty(rows if columns == 1 else (rows, columns))
                emitted(*arguments, result)
            flat = np.concatenate([np.zeros(0), *(np.ravel(value) for value in arguments)])
            expected = reference(flat)
            # values and their derivatives are of different sizes: each against its own kind
            for kind in (
                (slice(None, None, 2), slice(1, None, 2))
                if name.endswith("_rates")
                else (slice(None),)
            ):
                pairs = list(zip(result.flat[kind], expected[kind], strict=True))
                error = max(abs(mpmath.mpf(float(a)) - b) for a, b in pairs)
                relative = float(error / max(abs(b) for _, b in pairs))
                worst = max(worst, relative / condition(function, arguments))
    print(f"{module_name}.{name}: {worst:.1e}")
    assert worst < TOLERANCES.get(name, TOLERANCE)
