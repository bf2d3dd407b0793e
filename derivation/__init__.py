"""SymPy derivation of the equations of motion and the optical force of a bead.

The modules are symbolic; none is imported when a bead is simulated. `python -m derivation` emits
the results as Numba modules into `generated/`. A wheel contains this package as
`tweezer.derivation`.
"""

try:
    import jinja2  # noqa: F401
    import sympy  # noqa: F401
except ModuleNotFoundError as missing:
    raise ModuleNotFoundError(
        f'the derivation needs {missing.name}: pip install "tweezer[derive]"', name=missing.name
    ) from None
