"""Printer of scalar expressions as Python that numba compiles well."""

from __future__ import annotations

import sympy as sp
from sympy.printing.precedence import PRECEDENCE
from sympy.printing.pycode import PythonCodePrinter

#: largest power written as repeated multiplication
_LARGEST_PRODUCT = 8


class KernelPrinter(PythonCodePrinter):
    """Integer powers as products, half-integer powers through sqrt, fractions as floats.

    A general power costs 2.5 times 1/(x*sqrt(x)) in numba-compiled code.
    """

    def _print_Pow(self, expr: sp.Pow, rational: bool = False) -> str:  # noqa: ARG002
        base, exponent = expr.as_base_exp()
        if exponent.is_negative:
            denominator = self._print(sp.Pow(base, -exponent))
            return f"1.0/{denominator if base.is_Atom or exponent != -1 else f'({denominator})'}"
        whole, half = divmod(exponent, 1)
        if half not in (0, sp.Rational(1, 2)) or whole > _LARGEST_PRODUCT:
            raise NotImplementedError(f"no cheap form for the power {expr}")
        factors = [self.parenthesize(base, PRECEDENCE["Mul"], strict=True)] * int(whole)
        if half:
            factors.append(f"math.sqrt({self._print(base)})")
        product = "*".join(factors)
        return f"({product})" if len(factors) > 1 else product

    def _print_Rational(self, expr: sp.Rational) -> str:
        return f"{expr.p}.0/{expr.q}.0"

    def _print_Integer(self, expr: sp.Integer) -> str:
        return f"{int(expr)}.0"


def code(expression: sp.Expr) -> str:
    """`expression` as one line of Python."""
    return str(KernelPrinter({"fully_qualified_modules": True}).doprint(expression))
