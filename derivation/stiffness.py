"""Force and stiffness of a sphere in light as forms of the amplitudes of its partial waves.

The sphere turns the incoming amplitudes p into S p, S = 1 + T. s is a component of the direction,
by which the momentum of a wave is measured. A displacement by x along this component turns p into
exp(i k x s) p.
"""

from __future__ import annotations

import sympy as sp
from sympy.physics.quantum import Dagger, HermitianOperator, Operator

from .equations import Equation

s, of_force = HermitianOperator("s"), HermitianOperator("F")
T = Operator("T")
k, x = sp.symbols("k x", real=True)


def force() -> sp.Expr:
    """Return F = s - S+ s S, the momentum that the light loses, in terms of T."""
    S = 1 + T
    return sp.expand(s - Dagger(S) * s * S)


def stiffness() -> sp.Expr:
    """Return K = -dF/dx at x = 0, of a force F(x) = exp(-i k x s) F exp(i k x s)."""
    first = sp.I * k * x * s  # higher powers of x do not count
    moved = sp.expand((1 - first) * of_force * (1 + first))
    return sp.expand(-sp.diff(moved, x).subs(x, 0))


FORCE = Equation("-", "force on a sphere", r"\hat F", force())
STIFFNESS = Equation("-", "stiffness along s", r"\hat K", stiffness())
