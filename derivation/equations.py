"""A named result of the derivation, carrying its equation number in the thesis."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp


@dataclass(frozen=True)
class Equation:
    """One equation: `lhs = rhs`, with its number in the thesis and what it says.

    `number` is the thesis's ("A.24"), or "-" where the thesis has no such equation.
    `lhs` is a LaTeX string, as many left-hand sides are names of whole vectors.
    """

    number: str
    title: str
    lhs: str
    rhs: sp.Expr | sp.MatrixBase

    def _repr_latex_(self) -> str:
        tag = rf" \tag{{{self.number}}}" if self.number != "-" else ""
        cosines = {sp.Symbol(f"cos_{a}", positive=True): rf"\cos\{a}" for a in ("alpha", "beta")}
        return rf"$${self.lhs} = {sp.latex(self.rhs, symbol_names=cosines)}{tag}$$"


def is_zero(expression: sp.Expr | sp.MatrixBase) -> bool:
    """Whether a rational expression, or each entry of a matrix of them, vanishes identically.

    A numerator that expands to 0 is a proof; no simplification heuristics are involved.
    """
    entries = expression if isinstance(expression, sp.MatrixBase) else [expression]
    return all(sp.expand(sp.numer(sp.together(entry))) == 0 for entry in entries)
