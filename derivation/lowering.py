"""From expressions to a block of straight-line code, with one pass of subexpression sharing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from .symbols import Quantity


@dataclass(frozen=True)
class Argument:
    """An argument of an emitted function: one scalar, or an array of `shape`."""

    name: str
    quantities: tuple[Quantity, ...]
    shape: tuple[int, ...] = ()

    @property
    def elements(self) -> tuple[str, ...]:
        """Expression for each quantity: `state[3]`, `force_gradient[0, 2]`, or the name itself."""
        if not self.shape:
            return (self.name,)
        if len(self.shape) == 1:
            return tuple(f"{self.name}[{i}]" for i in range(self.shape[0]))
        rows, columns = self.shape
        return tuple(f"{self.name}[{i}, {j}]" for i in range(rows) for j in range(columns))


@dataclass(frozen=True)
class Function:
    """A function to emit: outputs as expressions of its arguments and named intermediates.

    With `output_names` it returns that tuple of scalars; otherwise it fills the array `out`,
    of the shape of `outputs` (a column counts as one-dimensional).
    """

    name: str
    summary: str
    arguments: tuple[Argument, ...]
    outputs: sp.MatrixBase
    intermediates: tuple[tuple[Quantity, sp.Expr], ...] = ()
    output_names: tuple[str, ...] = ()

    def expanded(self) -> sp.MatrixBase:
        """The outputs as expressions of the arguments alone."""
        outputs = self.outputs
        for quantity, expression in reversed(self.intermediates):
            outputs = outputs.subs(quantity.symbol, expression)
        return outputs


@dataclass(frozen=True)
class Block:
    """Straight-line code: inputs, then named intermediates, temporaries, and outputs."""

    inputs: tuple[tuple[str, str], ...]
    intermediates: tuple[tuple[sp.Symbol, sp.Expr], ...]
    temporaries: tuple[tuple[sp.Symbol, sp.Expr], ...]
    outputs: tuple[sp.Expr, ...]

    @property
    def operations(self) -> int:
        """Arithmetic operations and square roots in the block."""
        expressions = [
            *(value for _, value in self.intermediates),
            *(value for _, value in self.temporaries),
            *self.outputs,
        ]
        return int(sum(sp.count_ops(expression) for expression in expressions))


def lower(function: Function) -> Block:
    """One common-subexpression pass over all outputs; what nothing uses is left out."""
    temporaries, outputs = sp.cse(
        list(function.outputs), symbols=sp.numbered_symbols("x"), order="canonical"
    )
    used = _free_symbols([*(value for _, value in temporaries), *outputs])
    intermediates: list[tuple[sp.Symbol, sp.Expr]] = []
    for quantity, expression in reversed(function.intermediates):
        if quantity.symbol in used:
            intermediates.insert(0, (quantity.symbol, expression))
            used |= _free_symbols([expression])
    known = {symbol for argument in function.arguments for symbol in _symbols(argument)}
    unknown = used - known - {name for name, _ in (*intermediates, *temporaries)}
    if unknown:
        names = ", ".join(sorted(str(symbol) for symbol in unknown))
        raise ValueError(f"{function.name}: no argument supplies {names}")
    taken = {str(symbol) for symbol in used}
    for name, output in zip(function.output_names, outputs, strict=False):
        if name in taken and str(output) != name:
            raise ValueError(
                f"{function.name}: the output {name} would overwrite what it is made of"
            )
    inputs = tuple(
        (quantity.name, element)
        for argument in function.arguments
        if argument.shape
        for quantity, element in zip(argument.quantities, argument.elements, strict=True)
        if quantity.symbol in used
    )
    return Block(inputs, tuple(intermediates), tuple(temporaries), tuple(outputs))


def _symbols(argument: Argument) -> tuple[sp.Symbol, ...]:
    return tuple(quantity.symbol for quantity in argument.quantities)


def _free_symbols(expressions: Sequence[sp.Expr]) -> set[sp.Basic]:
    return set().union(*(sp.sympify(expression).free_symbols for expression in expressions))
