"""The table of symbols in derivation/README.md names every symbol that reaches emitted code."""

import re
from pathlib import Path

import pytest

from derivation.models import catalogue

ROOT = Path(__file__).parents[2]
README = ROOT / "derivation" / "README.md"
TABLES = {"memory_poles", "pair", "wall"}
#: all but the tables, which are of no equations of the catalogue
MODULES = sorted({path.stem for path in (ROOT / "generated").glob("[!_]*.py")} - TABLES)


def described():
    """Names in backticks; `x1`.. stands for all of x1, x2, x3 or x11..x33."""
    names = re.findall(r"`(\w+)`", README.read_text().split("## Symbols")[1])
    return {re.sub(r"\d+$", "", name) or name for name in names} | set(names)


@pytest.mark.parametrize("name", MODULES)
def test_every_symbol_is_in_the_table(name):
    (module,) = (module for module in catalogue() if module.name == name)
    names = {
        quantity.name
        for function in module.functions
        for quantity in (
            *(quantity for argument in function.arguments for quantity in argument.quantities),
            *(quantity for quantity, _ in function.intermediates),
        )
    }
    missing = {
        name
        for name in names
        if name not in described() and name.rstrip("0123456789") not in described()
    }
    assert not missing
