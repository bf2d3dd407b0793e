"""Arithmetic with twice the digits of a double (about 32), for compiled code.

A number is the exact sum of two doubles, (high, low), where the low part is at most half a unit in
the last place of the high part (Dekker, Numer. Math. 18, 224 (1971)). `add`, `times`, `over` and
`root` have relative errors of a few 1e-32; sums of terms that cancel are as exact as their largest
term. A complex number is ((high, low), (high, low)), with the operations `complex_add`,
`complex_minus`, `complex_times` and `complex_over`.
"""

from __future__ import annotations

import math
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from tweezer.compiled import named_njit

_OPTIONS: dict[str, Any] = {"error_model": "numpy", "inner": True}

#: ln(2)
LN_2 = (0.6931471805599453, 2.3190468138462996e-17)
#: pi/2
HALF_PI = (1.5707963267948966, 6.123233995736766e-17)
#: Number of terms in the power series, and of halvings before the series for exp
_TERMS, _HALVINGS = 14, 8


@intrinsic
def fused(typing: Any, a: Any, b: Any, c: Any) -> Any:  # noqa: ARG001
    """Return a b + c, rounded once.

    Parameters
    ----------
    typing : Context
        Typing context of numba.
    a, b, c : types.Float
        The numbers.
    """

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        double = ir.DoubleType()
        kind = ir.FunctionType(double, [double] * 3)
        name = "llvm.fma.f64"
        function = builder.module.globals.get(name) or ir.Function(builder.module, kind, name)
        return builder.call(function, values)

    return types.float64(types.float64, types.float64, types.float64), emitted


@named_njit(**_OPTIONS)
def normalised(high, low):  # type: ignore[no-untyped-def]
    """Return high + low as a number, for |high| >= |low|."""
    total = high + low
    return total, low - (total - high)


@named_njit(**_OPTIONS)
def add(a, b):  # type: ignore[no-untyped-def]
    """Return a + b."""
    total = a[0] + b[0]
    part = total - a[0]
    error = (a[0] - (total - part)) + (b[0] - part)
    low = a[1] + b[1]
    low_part = low - a[1]
    low_error = (a[1] - (low - low_part)) + (b[1] - low_part)
    high, rest = normalised(total, error + low)
    return normalised(high, rest + low_error)


@named_njit(**_OPTIONS)
def negative(a):  # type: ignore[no-untyped-def]
    """Return -a."""
    return -a[0], -a[1]


@named_njit(**_OPTIONS)
def minus(a, b):  # type: ignore[no-untyped-def]
    """Return a - b."""
    return add(a, (-b[0], -b[1]))


@named_njit(**_OPTIONS)
def times(a, b):  # type: ignore[no-untyped-def]
    """Return a b."""
    product = a[0] * b[0]
    error = fused(a[0], b[0], -product)
    return normalised(product, fused(a[0], b[1], fused(a[1], b[0], error)))


@named_njit(**_OPTIONS)
def scaled(a, factor):  # type: ignore[no-untyped-def]
    """Return a times a double."""
    product = a[0] * factor
    return normalised(product, fused(a[1], factor, fused(a[0], factor, -product)))


@named_njit(**_OPTIONS)
def over(a, b):  # type: ignore[no-untyped-def]
    """Return a/b."""
    first = a[0] / b[0]
    rest = minus(a, scaled(b, first))
    second = rest[0] / b[0]
    rest = minus(rest, scaled(b, second))
    third = rest[0] / b[0]
    return add(normalised(first, second), (third, 0.0))


@named_njit(**_OPTIONS)
def root(a):  # type: ignore[no-untyped-def]
    """Return the square root of a >= 0."""
    if a[0] <= 0.0:
        return 0.0, 0.0
    first = math.sqrt(a[0])
    rest = minus(a, times((first, 0.0), (first, 0.0)))
    return normalised(first, rest[0] / (2.0 * first))


@named_njit(**_OPTIONS)
def exponential(a):  # type: ignore[no-untyped-def]
    """Return exp(a)."""
    twos = math.floor(a[0] / LN_2[0] + 0.5)
    rest = scaled(minus(a, scaled(LN_2, twos)), 0.5**_HALVINGS)
    less_one = (0.0, 0.0)
    for term in range(_TERMS, 0, -1):  # exp(rest) - 1 keeps the digits of a small rest
        less_one = over(times(rest, add((1.0, 0.0), less_one)), (float(term), 0.0))
    for _ in range(_HALVINGS):
        less_one = add(scaled(less_one, 2.0), times(less_one, less_one))
    return scaled(add((1.0, 0.0), less_one), 2.0**twos)


@named_njit(**_OPTIONS)
def complex_add(a, b):  # type: ignore[no-untyped-def]
    """Return a + b of complex numbers."""
    return add(a[0], b[0]), add(a[1], b[1])


@named_njit(**_OPTIONS)
def complex_minus(a, b):  # type: ignore[no-untyped-def]
    """Return a - b of complex numbers."""
    return minus(a[0], b[0]), minus(a[1], b[1])


@named_njit(**_OPTIONS)
def complex_times(a, b):  # type: ignore[no-untyped-def]
    """Return a b of complex numbers."""
    return (
        minus(times(a[0], b[0]), times(a[1], b[1])),
        add(times(a[0], b[1]), times(a[1], b[0])),
    )


@named_njit(**_OPTIONS)
def complex_over(a, b):  # type: ignore[no-untyped-def]
    """Return a/b of complex numbers."""
    square = add(times(b[0], b[0]), times(b[1], b[1]))
    re, im = complex_times(a, (b[0], negative(b[1])))
    return over(re, square), over(im, square)


@named_njit(**_OPTIONS)
def sine_and_cosine(a):  # type: ignore[no-untyped-def]
    """Return sin(a) and cos(a), for |a| up to some hundreds."""
    quarters = math.floor(a[0] / HALF_PI[0] + 0.5)
    rest = minus(a, scaled(HALF_PI, quarters))
    square = times(rest, rest)
    sine, cosine = (1.0, 0.0), (1.0, 0.0)
    for term in range(2 * _TERMS, 0, -2):
        sine = minus((1.0, 0.0), over(times(square, sine), (term * (term + 1.0), 0.0)))
        cosine = minus((1.0, 0.0), over(times(square, cosine), (term * (term - 1.0), 0.0)))
    sine = times(rest, sine)
    turns = int(quarters) % 4
    if turns == 1:
        return cosine, negative(sine)
    if turns == 2:
        return negative(sine), negative(cosine)
    if turns == 3:
        return negative(cosine), sine
    return sine, cosine
